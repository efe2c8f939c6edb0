#pragma once

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "statics/friction/held.hpp"

namespace poise::app {

/// The mechanism at the scaled coordinates x, with a mark where something slips first, as an SVG document. `heading` is
/// the verdict, a warning where it is not `decided`.
std::string hold_picture(const StaticModel& model, const std::vector<double>& x, const HeldPose& pose,
                         const std::string& heading, bool decided);

/// The same as a still picture.
Figure hold_figure(const StaticModel& model, const std::vector<double>& x, const HeldPose& pose,
                   const std::string& heading, bool decided);

/// The same pose while the number of that name grows, from below the range in which friction holds to above it, as far
/// as it may go; a still picture where no value is held.
Figure hold_figure(const StaticModel& model, const std::vector<double>& x, const HeldRange& range,
                   const std::string& number, const std::string& heading, bool decided);

}  // namespace poise::app
