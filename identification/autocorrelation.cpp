#include "identification/autocorrelation.hpp"

#include <algorithm>
#include <limits>

namespace poise {
namespace {

constexpr double neighbours = 1.5;  // spacing over the median spacing

}  // namespace

Autocorrelation autocorrelation(const std::vector<double>& time, const std::vector<double>& residual) {
  Autocorrelation out;
  const std::size_t n = residual.size();
  out.value = std::numeric_limits<double>::quiet_NaN();
  if (n < 2) return out;
  std::vector<double> spacing;
  for (std::size_t i = 1; i < n; ++i) spacing.push_back(time[i] - time[i - 1]);
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  const double widest = neighbours * *middle;
  double square = residual[0] * residual[0];
  double lagged = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    square += residual[i] * residual[i];
    if (time[i] - time[i - 1] > widest) continue;
    lagged += residual[i] * residual[i - 1];
    ++out.pairs;
  }
  if (out.pairs == 0) return out;
  out.value = square > 0 ? lagged / square * static_cast<double>(n - 1) / out.pairs : 0.0;
  return out;
}

}  // namespace poise
