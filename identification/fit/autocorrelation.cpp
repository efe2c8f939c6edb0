#include "identification/fit/autocorrelation.hpp"

#include <algorithm>
#include <limits>

namespace poise {

Autocorrelation autocorrelation(const std::vector<double>& time, const std::vector<double>& residual, std::size_t lag) {
  Autocorrelation out;
  const std::size_t n = residual.size();
  out.value = std::numeric_limits<double>::quiet_NaN();
  if (n < 2 || n <= lag) return out;
  std::vector<double> spacing;
  for (std::size_t i = 1; i < n; ++i) spacing.push_back(time[i] - time[i - 1]);
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  const double widest = (static_cast<double>(lag) + 0.5) * *middle;
  double square = 0.0, lagged = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    square += residual[i] * residual[i];
    if (i < lag || time[i] - time[i - lag] > widest) continue;
    lagged += residual[i] * residual[i - lag];
    ++out.pairs;
  }
  if (out.pairs == 0) return out;
  out.value = square > 0 ? lagged / square * static_cast<double>(n - lag) / out.pairs : 0.0;
  return out;
}

}  // namespace poise
