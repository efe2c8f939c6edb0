#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "app/results/motion/quantities.hpp"
#include "motion/steady_running.hpp"

namespace poise::app {

/// What `poise running` was asked, and found.
struct RunningAnswer {
  std::string turning;  ///< the body whose turns make the period
  int turns = 1;
  SteadyRunning found;
  std::vector<SoughtQuantity> motors;  ///< the effort of each, with which it resists its measure
  std::vector<double> power;           ///< mean of each over the period, W
  std::vector<SoughtQuantity> joints;  ///< the size of each force
  std::vector<QuantityRange> ranges;   ///< of the motors, then of the joints
  QuantitiesInTime shown;              ///< over the period: motors, joints, and what was asked for
  std::vector<double> angle, speed;    ///< at its times, rad and rad/s
};

/// What `poise running` shows. `scene` is the one before resisted_by_joints().
Result running_result(const MotionModel& model, const RunningAnswer& answer, const std::vector<std::string>& settings);

/// The speed, and the quantities, over the angle turned within the period.
std::vector<Panel> running_panels(const Units& units, const RunningAnswer& answer);

}  // namespace poise::app
