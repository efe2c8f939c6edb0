#include "solvers/loop_closing.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr int chord_steps = 20;                        // of one pull_back()
constexpr int sparse_starts = 3;                       // displaced ones, if a problem is too large for dense factors
constexpr double least_reach = 0.1, more_reach = 3.0;  // distance of displaced starts: of the first, and its growth

}  // namespace

LoopClosing::LoopClosing(NewtonSystem& system)
    : at_(system),
      starts_(system.dense ? system.options.closing_starts : std::min(sparse_starts, system.options.closing_starts)) {}

bool LoopClosing::run() {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double least = std::numeric_limits<double>::infinity();
  for (int attempt = 0;; ++attempt) {
    // At first stops that were reached stay active, so that a start just beyond one ends on it; if too many active
    // stops leave no solution, they only count while violated.
    const double left = close(attempt == 0 ? Stops::stay : Stops::while_violated);
    if (left <= at_.options.active_set.touching) return true;
    if (left < least) {
      least = left;
      best_ = at_.now->x;
    }
    if (attempt == starts_ || at_.interrupted()) break;
    const double reach = least_reach + more_reach * attempt / starts_;
    at_.now->x = at_.start;
    for (double& x : at_.now->x) x += reach * uniform(at_.random);
    at_.evaluate(*at_.now);
  }
  at_.now->x = best_;
  at_.evaluate(*at_.now);
  return false;
}

double LoopClosing::close(Stops stops) {
  double left = 0.0;
  for (int k = 0; k < at_.options.iterations; ++k) {
    if (stops == Stops::while_violated) at_.active.release_inequalities();
    at_.activate_violated();
    at_.find_gap();
    left = largest(at_.gap);
    if (!(left > at_.options.rounding) || at_.interrupted()) break;
    if (!at_.kkt->set_jacobian(*at_.now, at_.active.flags())) break;
    at_.kkt->factor_identity();
    at_.kkt->solve({}, at_.gap, at_.step);
    ++at_.result.iterations;
    if (!shorten(stops)) break;
  }
  if (stops == Stops::while_violated) at_.active.activate_touched(*at_.now);
  return left;
}

bool LoopClosing::shorten(Stops stops) {
  const double before = dot(at_.gap, at_.gap);
  double alpha = std::min(1.0, at_.options.longest_step / largest(at_.step));
  for (int h = 0; h < at_.options.halvings; ++h, alpha *= 0.5) {
    at_.try_step(alpha);
    if (stops == Stops::stay) {
      at_.active.gaps(*at_.trial, at_.trial_gap);
    } else {
      for (int r = 0; r < at_.rows(); ++r) at_.trial_gap[r] = violation(at_.problem, *at_.trial, r);
    }
    if (!(dot(at_.trial_gap, at_.trial_gap) <= (1.0 - at_.options.armijo * alpha) * before)) continue;
    std::swap(at_.now, at_.trial);
    return true;
  }
  return false;
}

bool LoopClosing::pull_back(double tolerance) {
  at_.active.gaps(*at_.trial, at_.trial_gap);
  double left = largest(at_.trial_gap);
  for (int k = 0; k < chord_steps && left > tolerance; ++k) {
    at_.kkt->restore(at_.trial_gap, at_.residual);
    if (!(largest(at_.residual) <= at_.options.longest_step)) return false;
    for (int i = 0; i < at_.variables(); ++i) at_.trial->x[i] += at_.residual[i];
    at_.evaluate(*at_.trial);
    at_.active.gaps(*at_.trial, at_.trial_gap);
    const double now_left = largest(at_.trial_gap);
    if (!(now_left < 0.7 * left)) return false;
    left = now_left;
  }
  return left <= tolerance;
}

}  // namespace poise::solvers
