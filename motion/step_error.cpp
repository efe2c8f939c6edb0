#include "motion/step_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace poise {
namespace {

using stepping::eps;

/// Errors of sensitivities that count may be larger than those of the state, by this factor.
constexpr double larger_for_sensitivities = 1e4;

}  // namespace

double StepError::of_state(double t, double h, double accuracy) const {
  const double of_motion = reduced_.freedoms() == 0 ? of_work(t, h, accuracy) : of_coordinates(h, accuracy);
  return std::max(of_motion, of_sensitivities(accuracy));
}

// All is driven. Work alone is integrated, of whose error the method's estimate knows nothing where it depends on time
// only; the energies at both ends do.
double StepError::of_work(double t, double h, double accuracy) const {
  const double energy = reduced_.kinetic_energy() + reduced_.potential_energy();
  const double unbalanced = std::abs(energy - nodes_.energy() - (step_.y_new[0] - step_.y[0]));
  // Rounding is that of energies, of places to which loops and drives are closed, and of the times at which power is
  // taken.
  const double rounding = 100 * eps * (std::abs(energy) + std::abs(nodes_.energy())) +
                          10 * eps * reduced_.work_of_gaps() +
                          4 * eps * (t + h) * (std::abs(step_.dydt[0]) + std::abs(step_.dydt_new[0]));
  return std::max(0.0, unbalanced - rounding) /
         (1000 * accuracy * std::max(nodes_.exchanged(), std::abs(step_.y_new[0])) + stepping::tiny);
}

double StepError::of_coordinates(double h, double accuracy) const {
  const int f = reduced_.freedoms();
  double far = 0.0;
  double fast = 0.0;
  for (int k = 0; k < f; ++k) {
    if (reduced_.is_state(reduced_.independent()[static_cast<std::size_t>(k)])) continue;
    far = std::max(far, reach_of(k, h));
    fast = std::max(fast, speed_of(k, h));
  }
  const double singular = uncertain_acceleration();
  double worst = 0.0;
  for (int k = 0; k < f; ++k) {
    // Where forces balance, accelerations are about the rounding of a coordinate times stiffness over inertia.
    const double place = std::abs(step_.y[static_cast<std::size_t>(k)]);
    const double balanced = eps * fastest_ * fastest_ * (1 + place);
    const double uncertain = h * (singular + balanced);
    const double z = accuracy * std::max(reach_of(k, h), 1e-3 * far) + h * uncertain;
    const double w = accuracy * std::max(speed_of(k, h), 1e-3 * fast) + uncertain;
    const double e_z = std::abs(step_.error[static_cast<std::size_t>(k)]);
    const double e_w = std::abs(step_.error[static_cast<std::size_t>(f + k)]);
    const double rounding = eps * place / 100;
    worst = std::max({worst, e_z / (z + rounding + stepping::tiny), e_w / (w + stepping::tiny)});
  }
  return worst;
}

double StepError::of_sensitivities(double accuracy) const {
  const int f = reduced_.freedoms();
  double worst = 0.0;
  for (const int column : columns_.that_switch()) {
    double largest = 0.0;
    double error = 0.0;
    for (int k = f; k < 2 * f; ++k) {
      const std::size_t at = step_.sensitivity(k, column);
      const double turns = fastest_ * std::abs(step_.y[step_.sensitivity(k - f, column)]);
      largest = std::max({largest, turns, std::abs(step_.y[at]), std::abs(step_.y_new[at])});
      error = std::max(error, std::abs(step_.error[at]));
    }
    worst = std::max(worst, error / (larger_for_sensitivities * accuracy * largest + stepping::tiny));
  }
  return worst;
}

double StepError::of_reading(double t, double h) const {
  if (h < step_.length / 20) return 0.0;
  const std::size_t n = q_start_.size();
  const std::size_t known = std::min<std::size_t>(3, nodes_.nodes() - nodes_.smooth_from());
  const std::size_t first = nodes_.nodes() - known;
  double far = 0.0, far_before = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (reduced_.is_state(static_cast<int>(i))) continue;
    far_before = std::max(far_before, nodes_.reach(i));
    far = std::max({far, nodes_.reach(i), std::abs(reduced_.q()[i] - q_start_[i])});
  }
  // What rests and is then moved by forces that begin at zero, smoothly, is as the fourth power of time or more: over
  // the first step all of it is more than a polynomial knows.
  const double least = far_before > 0.0 ? 0.0 : eps;
  // Rounding of the nodes, and of the loops that give the dependent coordinates.
  const double pivot = std::min(nodes_.pivots().back(), reduced_.pivot());
  const double loops = reduced_.rank() > 0 ? 2e3 * eps / (pivot + eps) + h * h * uncertain_acceleration() : 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    std::array<NodeValues, 4> nodes;
    for (std::size_t k = 0; k < known; ++k) nodes[k] = nodes_.at(first + k, i);
    nodes[known] = {t + h, reduced_.q()[i], reduced_.v()[i], reduced_.a()[i]};
    const double reach = std::max({nodes_.reach(i), std::abs(nodes[known].q - q_start_[i]), 1e-3 * far});
    const double rounding = 1e4 * eps * std::abs(nodes[known].q) + loops + least;
    const double error = reading_error({nodes.data(), known + 1}, t + h / 2);
    worst = std::max(worst, (error - rounding) / (reach + stepping::tiny));
  }
  return worst;
}

// Accelerations are uncertain by rounding eps of the loops' closure, by eps rate^2 / pivot^3.
double StepError::uncertain_acceleration() const {
  if (reduced_.rank() == 0) return 0.0;
  double fastest = 0.0;
  for (std::size_t i = 0; i < q_start_.size(); ++i) fastest = std::max(fastest, std::abs(reduced_.v()[i]));
  const double pivot = std::min(nodes_.pivots().back(), reduced_.pivot());
  return eps * fastest * fastest / (pivot * pivot * pivot + eps);
}

double StepError::reach_of(int k, double h) const {
  const double w = std::abs(step_.y[static_cast<std::size_t>(reduced_.freedoms() + k)]);
  const double alpha = acceleration_of(k);
  return std::max(nodes_.reach(static_cast<std::size_t>(reduced_.independent()[k])), h * (w + h * alpha / 2));
}

double StepError::speed_of(int k, double h) const {
  const double w = std::abs(step_.y[static_cast<std::size_t>(reduced_.freedoms() + k)]);
  return std::max(nodes_.speed(static_cast<std::size_t>(reduced_.independent()[k])), w + h * acceleration_of(k));
}

// It is that of the start of the step; where something may begin to act also that of its end.
double StepError::acceleration_of(int k) const {
  const auto i = static_cast<std::size_t>(reduced_.freedoms() + k);
  const double at_start = std::abs(step_.dydt[i]);
  return acts_at_rest_ ? std::max(at_start, std::abs(step_.dydt_new[i])) : at_start;
}

}  // namespace poise
