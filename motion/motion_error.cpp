#include "motion/motion_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
  // A mechanism at rest exchanges no energy, and rounding of its potential is no error.
  const double potential = std::abs(motion.potential.front());
  const bool at_rest = exchanged < 1e-8 * potential && worst < 1e3 * std::numeric_limits<double>::epsilon() * potential;
  return exchanged > 0 && !at_rest ? worst / exchanged : 0.0;
}

double difference(const Motion& a, const Motion& b, double of_most) {
  const Trajectory& fine = b.trajectory;
  const Trajectory& coarse = a.trajectory;
  const std::size_t n = static_cast<std::size_t>(fine.coordinates);
  if (fine.nodes() < 2 || coarse.nodes() < 2) return 0.0;
  std::vector<int> all(n);
  std::vector<double> reach(n, 0.0), apart(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) all[i] = static_cast<int>(i);
  TrajectoryReader reader(coarse, all), between(fine, all);
  for (std::size_t node = 0; node < fine.nodes() && fine.t[node] <= coarse.t.back(); ++node) {
    // Nodes of both are near each other, where the reading of neither errs.
    const double last = node > 0 ? fine.t[node - 1] : fine.t[node];
    for (const double part : {0.25, 0.5, 0.75}) {
      const double within = last + part * (fine.t[node] - last);
      if (!(within > last)) continue;
      reader.at(within);
      between.at(within);
      for (std::size_t i = 0; i < n; ++i) apart[i] = std::max(apart[i], std::abs(between.q(i) - reader.q(i)));
    }
    reader.at(fine.t[node]);
    for (std::size_t i = 0; i < n; ++i) {
      reach[i] = std::max(reach[i], std::abs(fine.q[node * n + i] - fine.q[i]));
      apart[i] = std::max(apart[i], std::abs(fine.q[node * n + i] - reader.q(i)));
    }
  }
  const auto is_state = [&](std::size_t i) {
    return std::find(b.states.begin(), b.states.end(), static_cast<int>(i)) != b.states.end();
  };
  double far = 0.0;
  for (std::size_t i = 0; i < n; ++i) far = is_state(i) ? far : std::max(far, reach[i]);
  double worst = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double size = is_state(i) ? reach[i] : std::max(reach[i], of_most * far);
    if (size > 0) worst = std::max(worst, apart[i] / size);
  }
  return worst;
}

}  // namespace poise
