#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "motion/contact_forces.hpp"
#include "motion/fluctuation.hpp"
#include "motion/forces_along.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// What `poise forces` found.
struct ForcesAnswer {
  std::string how;  ///< in words: "standing still in every pose", "driven, crank at 1 rad/s", ...
  ForcesAlong found;
  std::optional<Fluctuation> fluctuation{};  ///< where a flywheel was asked for
  double coefficient = 0.0;                  ///< of fluctuation of the speed, that it is to hold
  std::vector<ContactCourse> contacts{};
  std::vector<LiftOff> lift_offs{};   ///< where they were asked for
  std::vector<std::string> drives{};  ///< what the drives of the command line are: "upper: angle of upper in the world"
};

/// The unit of power: "W", "N mm/s".
std::string power_unit(const Units& units);

/// What `poise forces` shows. One pose: drives, springs, dampers and all joint forces. More poses: the efforts of the
/// drives from place to place and the largest of everything else. In all of them the quantities of `show`.
Result forces_result(const MotionModel& model, const ForcesAnswer& answer, const std::vector<SoughtQuantity>& show,
                     const std::vector<std::string>& settings);

}  // namespace poise::app
