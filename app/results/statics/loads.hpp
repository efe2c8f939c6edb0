#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "motion/loads_in_motion.hpp"
#include "statics/equilibrium/link_loads.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// What `poise loads` found: the equilibrium, and the links with a section in it; none where no equilibrium was found.
struct LoadsAnswer {
  Equilibrium equilibrium;
  std::vector<LinkLoads> links;

  /// Every body is in balance, and every link has its internal loads.
  bool is_complete() const;
};

/// What `poise loads` shows: the largest internal loads, stresses and deflections of every link, what acts on each, and
/// the diagrams as data, with so many parts of every piece; and the quantities of `show`.
Result loads_result(const StaticModel& model, const LoadsAnswer& answer, int steps,
                    const std::vector<SoughtQuantity>& show, const std::vector<std::string>& settings);

/// What `poise loads --time` found: the links at that time of the motion, s.
struct MovingLoadsAnswer {
  double time = 0.0;
  LoadsInMotion found;

  /// The motion reached that time, every body is in balance, and every link has its internal loads.
  bool is_complete() const;
};

/// The same of links in motion.
Result loads_result(const MotionModel& model, const MovingLoadsAnswer& answer, int steps,
                    const std::vector<std::string>& settings);

/// The unit of stress: "N/mm²".
std::string stress_unit(const Units& units);

}  // namespace poise::app
