#include "benchmarks/timing.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

namespace poise::benchmarks {

double seconds_of(const std::function<void()>& work, int times) {
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < times; ++k) work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / times;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string in_units(double seconds) {
  if (seconds < 1e-5) return fmt::format("{:.3g} us", 1e6 * seconds);
  if (seconds < 1e-3) return fmt::format("{:.1f} us", 1e6 * seconds);
  return fmt::format("{:.2f} ms", 1e3 * seconds);
}

}  // namespace poise::benchmarks
