#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "statics/paths/fold_curve.hpp"

namespace poise::app {

/// What `poise path --curve fold` shows: cusps, points and curves; everything in JSON and, of the points, in CSV,
/// docs/json.md.
Result fold_curve_result(const VariedPair& pair, const FoldCurve& found, const std::vector<std::string>& settings);

/// The curves in the plane of both numbers, in their units, with the cusps marked by their numbers.
Panel fold_curve_panel(const VariedPair& pair, const FoldCurve& found);

}  // namespace poise::app
