#include "identification/experiment/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace poise {
namespace {

/// The readings with first <= time < end, which then count from `zero`; with as many more as `beside` on both sides.
Series cut(const Series& series, double zero, double end, std::ptrdiff_t beside) {
  const auto& time = series.time;
  const auto from = std::lower_bound(time.begin(), time.end(), zero);
  const auto to = std::lower_bound(from, time.end(), end);
  const auto first = std::max(from - time.begin() - beside, std::ptrdiff_t{0});
  const auto last = std::min(to - time.begin() + beside, std::ssize(time));
  Series out{{time.begin() + first, time.begin() + last}, {series.value.begin() + first, series.value.begin() + last}};
  for (double& t : out.time) t -= zero;
  return out;
}

}  // namespace

std::vector<Piece> pieces_of(Piece whole, double length, double end) {
  constexpr std::ptrdiff_t beside = 16;
  // None is shorter than from one reading to the next.
  const auto most = static_cast<double>(std::max<std::size_t>(whole.record.count(), 1));
  const int count = static_cast<int>(std::clamp(std::round(end / length), 1.0, most));
  if (count == 1) return {std::move(whole)};
  std::vector<double> edges;
  for (int k = 0; k <= count; ++k) {
    double edge = k < count ? INFINITY : std::nextafter(end, INFINITY);
    for (const Series& series : whole.record.sensors) {
      const auto next = std::lower_bound(series.time.begin(), series.time.end(), k * end / count * (1 - 1e-12));
      if (k < count && next != series.time.end()) edge = std::min(edge, *next);
    }
    if (edges.empty() || edge > edges.back()) edges.push_back(edge);
  }
  std::vector<Piece> out;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    Piece& piece = out.emplace_back();
    piece.zero = edges[k];
    for (const Series& series : whole.record.sensors)
      piece.record.sensors.push_back(cut(series, edges[k], edges[k + 1], 0));
    for (const Series& series : whole.inputs) piece.inputs.push_back(cut(series, edges[k], edges[k + 1], beside));
  }
  return out;
}

}  // namespace poise
