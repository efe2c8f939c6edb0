#pragma once

#include <vector>

#include "app/draw/figure.hpp"
#include "motion/modes.hpp"

namespace poise::app {

/// The shapes of the first six modes about an equilibrium at the scaled coordinates x of the model, one swing of each,
/// magnified to 8 % of the mechanism's size at most, with loops closed. `confirmed`: the equilibrium is. Nothing is
/// drawn where no modes are known.
Figure modes_figure(const MotionModel& model, const std::vector<double>& x, const Modes& modes, bool confirmed);

}  // namespace poise::app
