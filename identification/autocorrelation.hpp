#pragma once

#include <vector>

namespace poise {

/// The correlation of neighbouring residuals e_i of one sensor in one run,
///   (mean over the pairs of e_i e_(i+1)) / (sum of e_i^2 / (n - 1)).
/// The pairs are neighbours at most 1.5 times the median spacing apart: others have missing readings between them.
struct Autocorrelation {
  double value = 0.0;  ///< 0 where all residuals are 0; NaN without pairs
  int pairs = 0;
};

/// `time` ascends, s; one per residual.
Autocorrelation autocorrelation(const std::vector<double>& time, const std::vector<double>& residual);

}  // namespace poise
