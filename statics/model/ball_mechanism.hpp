#pragma once

#include <vector>

#include "model/mechanism_impl.hpp"
#include "statics/bodies/ball_scalar.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// A scene compiled in ball arithmetic: once with its doubles as exact numbers, and once with each as all the numbers
/// that round to it; and in double.
struct BallMechanism {
  explicit BallMechanism(const StaticModel& model) : BallMechanism(model, model.layout()) {}
  /// With a layout that was loosened.
  BallMechanism(const StaticModel& model, const Layout& layout);

  Mechanism<Ball> exact;
  Mechanism<Ball> rounded;
  Mechanism<double> plain;
  std::vector<double> row_rounding;  ///< of all constraint rows (statics/model/private/closure_rounding.hpp)

  const Mechanism<Ball>& of(bool rounding) const { return rounding ? rounded : exact; }
};

}  // namespace poise
