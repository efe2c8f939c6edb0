#include "solvers/descent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double loose_gap = 0.05;       // gap over step length above which loops are closed before descending
constexpr double closed_within = 1e-13;  // to which they are
constexpr double near_rest = 1e-3;       // steps below which the sign of a multiplier is reliable
constexpr int inverse_iterations = 4;
constexpr int neighbours = 8;  // variables, at most, that are perturbed together without the others

}  // namespace

Descent::Descent(NewtonSystem& system, LoopClosing& closing) : at_(system), closing_(closing) {}

NewtonEnd Descent::run() {
  shift_ = 0.0;
  if (!closing_.run()) return at_.interrupted() ? NewtonEnd::interrupted : NewtonEnd::not_closed;
  NewtonEnd end = descend();
  const int most = at_.options.safeguards.restarts ? at_.options.perturbations : 0;
  for (int k = 0; k < most && (end == NewtonEnd::stalled || end == NewtonEnd::singular) && perturb(); ++k) {
    at_.result.met_singular = at_.result.met_singular || end == NewtonEnd::singular;
    end = descend();
  }
  return end;
}

NewtonEnd Descent::run_from_closed() {
  shift_ = 0.0;
  return descend();
}

NewtonEnd Descent::descend() {
  const NewtonOptions& options = at_.options;
  at_.forget_multipliers();
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < options.iterations; ++k) {
    if (at_.interrupted()) return NewtonEnd::interrupted;
    if (!at_.linearize()) return NewtonEnd::stalled;
    const Kkt::Factors factors = at_.factor_tangent();
    ++at_.result.iterations;
    if (factors == Kkt::Factors::singular && at_.balanced()) {
      const ActiveSet::Release release = at_.release_wrong_sign(at_.y, 0.0);
      if (release == ActiveSet::Release::released) continue;
      return release == ActiveSet::Release::none ? at_.arrive(false) : NewtonEnd::stalled;
    }
    const bool positive_definite = factors == Kkt::Factors::positive;
    const bool corrects = options.safeguards.inertia_correction;
    if (!positive_definite && corrects) shift_until_positive_definite();
    at_.solve_for_step();
    at_.solve_for_multipliers();
    const double length = largest(at_.step);
    if (!std::isfinite(length)) return NewtonEnd::stalled;
    const double gap = largest(at_.gap);
    if (gap > 1e-10 && gap > loose_gap * length) {
      // A step that mostly closes loops is no measure of descent: close them first.
      at_.trial->x = at_.now->x;
      at_.trial->constraint = at_.now->constraint;
      if (closing_.pull_back(closed_within))
        std::swap(at_.now, at_.trial);
      else if (closing_.close() > options.active_set.touching)
        return NewtonEnd::stalled;
      continue;
    }
    const ActiveSet::Release release =
        at_.release_wrong_sign(at_.y_next, length <= near_rest ? 0.0 : 10.0 * largest(at_.residual));
    if (release == ActiveSet::Release::released) continue;
    if (release == ActiveSet::Release::cycling && length <= near_rest) return NewtonEnd::stalled;
    const bool rounded = at_.balanced() && length <= options.next_to_fold && length > 0.25 * last;
    last = length;
    if (positive_definite && (length <= options.step_tolerance || rounded)) return at_.arrive(true);
    const bool at_saddle = !positive_definite && corrects && length < 0.01;
    if (at_saddle && leave_saddle()) continue;
    if (!step(at_.bounded_part(length))) {
      return positive_definite && at_.balanced() ? at_.arrive(false) : NewtonEnd::stalled;
    }
    if (!std::isfinite(largest(at_.now->x))) return NewtonEnd::stalled;
    if (ran_away()) return NewtonEnd::unbounded;
  }
  return NewtonEnd::iteration_limit;
}

bool Descent::ran_away() const {
  for (int i = 0; i < at_.variables(); ++i) {
    if (std::abs(at_.now->x[i] - at_.start[i]) > at_.options.run_away) return true;
  }
  return false;
}

// Takes the smallest shift tried that does.
void Descent::shift_until_positive_definite() {
  const double scale = at_.largest_curvature();
  double shift = std::max({shift_ / 16.0, 1e-8 * scale, 1e-12});
  while (at_.kkt->factor_shifted(shift) != Kkt::Factors::positive && shift < 1e12 * (1.0 + scale)) shift *= 4.0;
  shift_ = shift;
}

// Inverse iteration with the barely positive definite factors turns any vector towards the most negative curvature.
bool Descent::leave_saddle() {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  direction_.resize(at_.variables());
  for (double& d : direction_) d = uniform(at_.random);
  for (int k = 0; k < inverse_iterations; ++k) {
    at_.kkt->solve(direction_, {}, at_.step);
    const double length = largest(at_.step);
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    for (int i = 0; i < at_.variables(); ++i) direction_[i] = at_.step[i] / length;
  }
  const double sign = dot(at_.now->gradient, direction_) > 0 ? -1.0 : 1.0;
  for (const double s : {sign, -sign}) {
    for (int i = 0; i < at_.variables(); ++i) at_.step[i] = s * direction_[i];
    at_.y_next = at_.y;
    if (step(0.2)) return true;
  }
  return false;
}

// Halves the step until the Lagrangian decreases at the trial point, projected back onto the constraints. A step that
// reaches the bound of an inequality ends there, and the inequality becomes active.
bool Descent::step(double alpha) {
  const bool line_search = at_.options.safeguards.line_search;
  at_.kkt->unbalanced(at_.now->gradient, at_.y_next, at_.residual);
  const double slope = std::min(0.0, dot(at_.residual, at_.step));
  const double objective = at_.objective(*at_.now);
  const double before = objective + dot(at_.gap, at_.y_next);
  const double noise = 1e-14 * (1.0 + std::abs(objective)) + dot(at_.gap, at_.gap);
  const double longest = largest(at_.step);
  for (int h = 0; h < at_.options.halvings; ++h) {
    at_.try_step(alpha);
    const double reach = alpha * longest;
    if (closing_.pull_back(std::clamp(reach * reach, 1e-13, at_.options.closure_tolerance))) {
      const ActiveSet::Crossing met = at_.active.first_crossing(*at_.now, *at_.trial);
      if (met.fraction < 1.0) {
        alpha *= met.fraction;
        if (alpha * longest > 1e-15) continue;
      }
      const double after = at_.objective(*at_.trial) + dot(at_.trial_gap, at_.y_next);
      const bool fell = after <= before + at_.options.armijo * alpha * slope + noise;
      if (fell || (alpha == 1.0 && -slope < noise) || !line_search) {
        if (met.row >= 0)
          at_.active.activate(met.row, met.upper);
        else
          at_.carry_multipliers(alpha);
        std::swap(at_.now, at_.trial);
        return true;
      }
    }
    alpha *= 0.5;
  }
  return false;
}

// At a bifurcation of motion J loses rank, and steps along its null space need not lead to feasible points. From there
// random displacements, closed again by minimum-norm steps, are tried until one has less energy: alternately of all
// variables and of a few neighbours, which moves one loop out of its singular configuration and leaves the others
// unchanged.
bool Descent::perturb() {
  const double before = at_.objective(*at_.now);
  perturbed_ = at_.now->x;
  const int n = at_.variables();
  const int tries = at_.options.perturbation_tries;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int k = 0; k < tries && !at_.interrupted(); ++k) {
    const bool all = k % 2 == 0;
    const double reach = all ? std::pow(10.0, -3.0 + 2.5 * k / tries) : M_PI * k / tries;
    const int width = all ? n : 1 + static_cast<int>(at_.random() % neighbours);
    const int first = all ? 0 : static_cast<int>(at_.random() % n);
    at_.now->x = perturbed_;
    for (int i = first; i < std::min(n, first + width); ++i) at_.now->x[i] += reach * uniform(at_.random);
    at_.evaluate(*at_.now);
    const bool closed = closing_.close() <= at_.options.active_set.touching;
    if (closed && at_.objective(*at_.now) < before - 1e-13 * (1.0 + std::abs(before))) return true;
  }
  at_.now->x = perturbed_;
  at_.evaluate(*at_.now);
  return false;
}

}  // namespace poise::solvers
