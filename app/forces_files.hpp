#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/quantity.hpp"
#include "motion/force_courses.hpp"
#include "motion/forces_along.hpp"

namespace poise::app {

/// What `poise forces` answers.
struct ForcesAnswer {
  std::string how;  ///< in words: "held where it stands", "driven at 1 rad/s", ...
  ForcesAlong found;
};

/// The value of `along`, then force_courses, in the units of the scene, times in seconds.
std::string forces_csv(const Scene& scene, const ForcesAnswer& answer);

/// A JSON object: poise, scene {file, title, source, set}, units {...}, how, complete, why, stop (null, or {name,
/// limit: "min" or "max", value} of the stop that is met in the last pose and ends the range), dead_points [{drive:
/// value}] where no effort holds the load, balanced, along, at [values], forces {NAME: [value per pose]} as
/// force_courses, undetermined [names of reactions and drives that are shared with others in some pose], idle_stops
/// [names of stops that are touched in some pose where the drives carry all], work_error, power_error (largest).
std::string forces_json(const MotionModel& model, const ForcesAnswer& answer, const std::vector<std::string>& settings);

/// Charts over `along`: what drives give, and the size of the joints' reactions, at most twelve of them.
std::vector<Panel> forces_panels(const Scene& scene, const ForcesAnswer& answer);

}  // namespace poise::app
