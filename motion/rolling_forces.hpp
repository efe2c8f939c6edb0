#pragma once

#include <cstddef>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {

/// The normal forces of the wheels and profiles of a scene that roll. These only push: where one would have to pull,
/// its wheel lifts off, and the equations of the motion, which keep it on its line or circle, hold no longer. Where
/// joints repeat what they hold, as a carrier does that keeps a wheel at its distance, they are not determined.
class RollingForces {
 public:
  explicit RollingForces(const MotionModel& model);

  bool act() const { return !contacts_.empty(); }
  /// After accelerate(): the least of these forces over the largest sum of all multipliers yet, and rounding more:
  /// negative where one would have to pull, infinite where they are not determined.
  double margin(const ReducedMotion<double>& motion);
  /// The stop of the scene that the last margin() is of.
  int least() const { return contacts_[least_].stop; }

 private:
  struct Contact {
    int stop = 0;
    int row = 0;  // of ReducedMotion::drive_force()
    double sense = 1.0;
  };
  int closures_ = 0;  // rows of loops
  std::vector<Contact> contacts_;
  std::size_t least_ = 0;
  double strongest_ = 0.0;
};

}  // namespace poise
