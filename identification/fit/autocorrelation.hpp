#pragma once

#include <cstddef>
#include <vector>

namespace poise {

/// The correlation of residuals e_i of one sensor in one run at a lag of k readings, 1 for neighbours,
///   (mean over the pairs of e_i e_(i+k)) / (sum of e_i^2 / (n - k)).
/// The pairs are at most k + 0.5 times the median spacing apart: others have missing readings between them.
struct Autocorrelation {
  double value = 0.0;  ///< 0 where all residuals are 0; NaN without pairs
  int pairs = 0;
};

/// `time` ascends, s; one per residual.
Autocorrelation autocorrelation(const std::vector<double>& time, const std::vector<double>& residual,
                                std::size_t lag = 1);

}  // namespace poise
