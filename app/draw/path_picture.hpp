#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "statics/path.hpp"
#include "statics/path_measures.hpp"

namespace poise::app {

/// The charts of a path that has points: of no measures they take the one that changes most.
std::vector<Panel> path_charts(const VariedScene& varied, const Path& path, const std::vector<PathMeasure>& measures);

/// The picture (SVG) of a path that has points: its charts, and below it the mechanism at the places marked there,
/// eight at most. `heading` is the verdict, a warning where it is not `confirmed`.
std::string path_picture(const VariedScene& varied, const Path& path, const std::vector<PathMeasure>& measures,
                         const std::string& heading, bool confirmed);

}  // namespace poise::app
