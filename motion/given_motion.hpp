#pragma once

#include <vector>

#include "motion/motion_model.hpp"

namespace poise {

/// A coordinate that was sampled; SI, one entry per time.
struct SampledCoordinate {
  int coordinate = 0;  ///< of the model's layout, < kept
  std::vector<double> value;
  std::vector<double> rate;  ///< empty if only values were sampled
};

/// The motion of all coordinates at sampled times; scaled, n values per time.
struct GivenMotion {
  std::vector<std::vector<double>> x, v, a;
  double closing = 0.0;  ///< largest change of a sampled coordinate that closed the loops, rad or mechanism sizes
};

/// Completes a sampled motion. Rates not sampled and accelerations are those of the polynomial through the neighbouring
/// samples (values of seven, or values and rates of five); coordinates not sampled follow from the loops,
///   c(x) = 0,   J v = 0,   J a = -(J v)' v,
/// and a remaining gap is closed by the least change of all of them. `time` ascends, two at least. Throws InputError if
/// the samples do not determine a coordinate, or if loops cannot be closed, or only by changing a sample by more than
/// 0.1 rad (mechanism sizes).
GivenMotion complete_motion(const MotionModel& model, const std::vector<double>& time,
                            const std::vector<SampledCoordinate>& samples);

}  // namespace poise
