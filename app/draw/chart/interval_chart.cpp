#include "app/draw/chart/interval_chart.hpp"

#include <cmath>
#include <cstddef>

#include <fmt/format.h>

namespace poise::app {

std::vector<Curve> interval_curves(const std::vector<Interval>& intervals) {
  std::vector<Curve> out;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const Interval& one = intervals[i];
    if (!std::isfinite(one.low) || !std::isfinite(one.value) || !std::isfinite(one.high)) continue;
    const auto at = static_cast<double>(i + 1);
    out.push_back({.name = fmt::format("{}  {}", i + 1, one.name),
                   .x = {at, at, at},
                   .y = {one.low, one.value, one.high},
                   .style = Curve::Style::marked,
                   .colour = static_cast<int>(i)});
  }
  return out;
}

}  // namespace poise::app
