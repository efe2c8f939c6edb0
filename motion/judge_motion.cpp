#include "motion/judge_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace poise {

double energy_error(const Motion& motion) {
  if (motion.kinetic.empty()) return 0.0;
  double exchanged = 0.0;
  double worst = 0.0;
  const double total = motion.kinetic.front() + motion.potential.front();
  for (std::size_t i = 0; i < motion.kinetic.size(); ++i) {
    exchanged = std::max({exchanged, motion.kinetic[i], std::abs(motion.potential[i] - motion.potential.front()),
                          std::abs(motion.work[i])});
    worst = std::max(worst, std::abs(motion.kinetic[i] + motion.potential[i] - motion.work[i] - total));
  }
  return exchanged > 0 ? worst / exchanged : 0.0;
}

namespace {

using Four = std::array<double, 4>;

// Larger of the two second divided differences of y over x, by size.
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

double difference(const Motion& a, const Motion& b) {
  const Trajectory& fine = b.trajectory;
  const Trajectory& coarse = a.trajectory;
  const std::size_t n = static_cast<std::size_t>(fine.coordinates);
  if (fine.nodes() < 2 || coarse.nodes() < 2) return 0.0;
  std::vector<int> all(n);
  std::vector<double> reach(n, 0.0), apart(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) all[i] = static_cast<int>(i);
  TrajectoryReader reader(coarse, all);
  for (std::size_t node = 0; node < fine.nodes() && fine.t[node] <= coarse.t.back(); ++node) {
    reader.at(fine.t[node]);
    for (std::size_t i = 0; i < n; ++i) {
      reach[i] = std::max(reach[i], std::abs(fine.q[node * n + i] - fine.q[i]));
      apart[i] = std::max(apart[i], std::abs(fine.q[node * n + i] - reader.q(i)));
    }
  }
  const double far = n > 0 ? *std::max_element(reach.begin(), reach.end()) : 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (far > 0) worst = std::max(worst, apart[i] / std::max(reach[i], 1e-3 * far));
  }
  return worst;
}

}  // namespace poise
