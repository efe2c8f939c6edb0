#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "motion/modes.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::app {

/// What `poise modes` found.
struct ModesAnswer {
  Equilibrium equilibrium;
  std::vector<double> x;  ///< scaled coordinates of the motion model; empty without an equilibrium
  Modes modes;
};

/// What `poise modes` shows: whether it is stable, frequencies, damping and shapes.
Result modes_result(const MotionModel& model, const ModesAnswer& answer, const std::vector<std::string>& settings);

}  // namespace poise::app
