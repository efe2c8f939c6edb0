#include "app/draw/chart/thinned.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace poise::app {
namespace {

/// The extreme points of the run [first, last), sorted, each once.
void add_extremes(const std::vector<double>& x, const std::vector<double>& y, std::size_t first, std::size_t last,
                  std::vector<std::size_t>& kept) {
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::array<std::size_t, 4> extremes{none, none, none, none};
  std::size_t gap = none;
  for (std::size_t i = first; i < last; ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) {
      gap = i;
      continue;
    }
    if (extremes[0] == none) extremes.fill(i);
    if (x[i] < x[extremes[0]]) extremes[0] = i;
    if (x[i] > x[extremes[1]]) extremes[1] = i;
    if (y[i] < y[extremes[2]]) extremes[2] = i;
    if (y[i] > y[extremes[3]]) extremes[3] = i;
  }
  std::vector<std::size_t> run;
  if (extremes[0] != none) run.assign(extremes.begin(), extremes.end());
  if (gap != none) run.push_back(gap);
  std::sort(run.begin(), run.end());
  run.erase(std::unique(run.begin(), run.end()), run.end());
  kept.insert(kept.end(), run.begin(), run.end());
}

}  // namespace

std::vector<std::size_t> thinned(const std::vector<double>& x, const std::vector<double>& y, std::size_t most) {
  const std::size_t n = x.size();
  if (n <= most) return every_kth(n, most);
  std::vector<std::size_t> kept;
  const std::size_t runs = most / 4;
  for (std::size_t run = 0; run < runs; ++run) add_extremes(x, y, run * n / runs, (run + 1) * n / runs, kept);
  return kept;
}

std::vector<std::size_t> every_kth(std::size_t n, std::size_t most) {
  const std::size_t step = std::max<std::size_t>(1, (n + most - 1) / most);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < n; i += step) kept.push_back(i);
  return kept;
}

}  // namespace poise::app
