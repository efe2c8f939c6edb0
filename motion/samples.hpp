#pragma once

#include <vector>

#include "motion/decisions.hpp"
#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {

/// What controllers with a period decide at the times k T, and hold from there on (ControllerOf). All that decide at
/// one time know what those decide that they follow or read. Private to simulate().
class Samples {
 public:
  /// The model must outlive this.
  Samples(const MotionModel& model, const std::vector<Variation>& variations, const std::vector<Influence>& influences);

  bool act() const { return !sampled_.empty(); }
  /// The first time of a sample after t, by more than `apart`; infinite without any.
  double next(double t, double apart) const;
  /// Whether some decide at t, to within `apart`.
  bool are_at(double t, double apart) const;

  /// A coordinate that is the state of a controller, with the rate that it has from the samples at t on.
  struct Held {
    int coordinate;
    double rate;
  };
  std::vector<Held> take(const ReducedMotion<double>& motion, double t, double apart);
  /// The derivatives of these rates where places and rates change by dq and dv, n values each, and by an influence if
  /// its index is not negative.
  std::vector<Held> take_by(ReducedMotion<double>& motion, double t, double apart, const std::vector<double>& dq,
                            const std::vector<double>& dv, int influence);

 private:
  struct One {
    int element;
    double period;
    std::vector<int> held;  // coordinates of what it holds (Feedback::held), -1 of what it does not
  };
  bool is_at(const One& one, double t, double apart) const;
  template <class Use>
  void for_each_decided(double t, double apart, const Use& use) const;

  const MotionModel& model_;
  Decisions decisions_;
  std::vector<One> sampled_;  // those that others depend on at once come before these
  std::vector<Planar<double>> pose_;
};

}  // namespace poise
