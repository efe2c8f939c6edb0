#pragma once

#include <vector>

#include "motion/motion_writer.hpp"

namespace poise {

/// How large the errors of a step are relative to what the accuracy of a motion allows. Private to simulate().
class StepError {
 public:
  /// All must outlive this. `acts_at_rest`: something may begin to act on a mechanism at rest, and let it go.
  StepError(const ReducedMotion<double>& reduced, const MotionStep& step, const MotionWriter& nodes,
            const SensitivityColumns& columns, const std::vector<double>& q_start, bool acts_at_rest)
      : reduced_(reduced),
        step_(step),
        nodes_(nodes),
        columns_(columns),
        q_start_(q_start),
        acts_at_rest_(acts_at_rest) {}

  /// The fastest rate of change at the start of the motion, 1/s.
  void set_fastest(double fastest) { fastest_ = fastest; }

  /// Error of the step just made, of length h from t, relative to the tolerance `accuracy`. Rounding errors, which
  /// shorter steps do not reduce, are left out.
  double of_state(double t, double h, double accuracy) const;
  /// Interpolation error within the step, relative to the travel of each coordinate. It also covers steps for which the
  /// method's own estimate fails: that may vanish by chance, and always does for coordinates that depend on time only.
  /// It does not shorten steps twentyfold.
  double of_reading(double t, double h) const;

 private:
  double of_work(double t, double h, double accuracy) const;
  double of_coordinates(double h, double accuracy) const;
  double of_sensitivities(double accuracy) const;
  double uncertain_acceleration() const;
  double reach_of(int k, double h) const;
  double speed_of(int k, double h) const;
  double acceleration_of(int k) const;

  const ReducedMotion<double>& reduced_;
  const MotionStep& step_;
  const MotionWriter& nodes_;
  const SensitivityColumns& columns_;
  const std::vector<double>& q_start_;
  bool acts_at_rest_;
  double fastest_ = 0.0;
};

}  // namespace poise
