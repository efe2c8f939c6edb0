#include "motion/singular_passage.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/runge_kutta.hpp"

namespace poise {
namespace {

using Four = std::array<double, 4>;

// Larger in size of the two second divided differences of y over x.
double bend(const Four& x, const Four& y) {
  const auto slope = [&](std::size_t k) { return (y[k + 1] - y[k]) / (x[k + 1] - x[k]); };
  return std::max(std::abs(slope(1) - slope(0)) / (x[2] - x[0]), std::abs(slope(2) - slope(1)) / (x[3] - x[1]));
}

// The cubic x(y) at y = 0.
double place_of_zero(const Four& x, const Four& y) {
  double place = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    double weight = 1.0;
    for (std::size_t j = 0; j < 4; ++j) {
      if (j != k) weight *= y[j] / (y[j] - y[k]);
    }
    place += weight * (x[k] - x[0]);
  }
  return x[0] + place;
}

}  // namespace

std::vector<double> zero_crossings(const std::vector<double>& t, const std::vector<double>& size) {
  std::vector<double> found;
  std::size_t last = 0;
  double last_bend = 0.0;
  for (std::size_t i = 2; i + 1 < size.size(); ++i) {
    const Four time{t[i - 2], t[i - 1], t[i], t[i + 1]};
    const Four value{size[i - 2], size[i - 1], size[i], size[i + 1]};
    if (!(value[0] > value[1] && value[2] < value[3])) continue;
    const Four passing{value[0], value[1], -value[2], -value[3]};
    const double left = bend(time, passing);
    if (!(left < 0.5 * bend(time, value))) continue;
    const bool again = last > 0 && last == i - 1;
    if (again && left >= last_bend) continue;
    if (again) found.pop_back();
    found.push_back(place_of_zero(time, passing));
    last = i;
    last_bend = left;
  }
  return found;
}

double steered_step(const std::vector<double>& t, const std::vector<double>& pivot, double h) {
  const std::size_t last = pivot.size() - 1;
  if (last < 2 || !(pivot[last] < pivot[last - 1] && pivot[last] < 0.5)) return h;
  // The inverse function t(pivot) as a parabola, at zero.
  const double p0 = pivot[last], p1 = pivot[last - 1], p2 = pivot[last - 2];
  const double slope = (t[last] - t[last - 1]) / (p1 - p0);
  double ahead = p0 * slope;
  if (p2 > p1) {
    const double bend = ((t[last - 1] - t[last - 2]) / (p2 - p1) - slope) / (p2 - p0);
    const double better = ahead - bend * p0 * p1;
    if (better > 0.5 * ahead && better < 2 * ahead) ahead = better;
  }
  if (ahead > 1.25 * h || ahead < 0.06 * h) return h;
  for (const double place : solvers::RungeKutta78::gaps) {
    if (ahead <= 1.05 * h * place) return ahead / place;
  }
  return ahead / 1.25;
}

}  // namespace poise
