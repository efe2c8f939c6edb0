#pragma once

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {

/// The picture (SVG) of a path that has points: its charts, of no measures of the one that changes most, and below it
/// the mechanism at the places marked there, eight at most. `heading` is the verdict, a warning where it is not
/// `confirmed`.
std::string path_picture(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures,
                         const std::string& heading, bool confirmed);

/// The mechanism along a path that has points, with the charts of path_picture().
Figure path_figure(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures);

}  // namespace poise::app
