#pragma once

#include <vector>

#include "app/draw/figure.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"

namespace poise::app {

/// The mechanism in an equilibrium, which need not be confirmed, with its forces and, as a shadow, the position at the
/// scaled coordinates `start` (none where empty).
Figure equilibrium_figure(const StaticModel& model, const Equilibrium& equilibrium, const std::vector<double>& start);

/// The mechanism as it is assembled, or where its loops remain open, which is then said.
Figure assembled_figure(const StaticModel& model, const Mobility& mobility);

}  // namespace poise::app
