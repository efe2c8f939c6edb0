#include "motion/rolling_forces.hpp"

#include <algorithm>
#include <limits>

#include "model/couplings.hpp"

namespace poise {

RollingForces::RollingForces(const MotionModel& model) : closures_(model.mechanism().equalities()) {
  const Scene& scene = model.scene();
  int row = static_cast<int>(scene.drives.size());
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    if (!stop.holds()) continue;
    const bool presses = stop.table.starts_with("rolling") && coupling_kind(stop)->row == 0;
    if (presses) contacts_.push_back({static_cast<int>(s), row, stop.sense});
    ++row;
  }
}

double RollingForces::margin(const ReducedMotion<double>& motion) {
  // Without weight or load wheels roll without a normal force, but for rounding.
  constexpr double rounding = 1e-9;
  constexpr double unknown = std::numeric_limits<double>::infinity();
  if (motion.rank() < closures_ + motion.drives()) return unknown;
  strongest_ = std::max(strongest_, motion.work_of_gaps());
  if (strongest_ == 0.0) return rounding;
  double least = unknown;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const double force = contacts_[k].sense * motion.drive_force(contacts_[k].row);
    if (force >= least) continue;
    least = force;
    least_ = k;
  }
  return least / strongest_ + rounding;
}

}  // namespace poise
