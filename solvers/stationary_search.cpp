#include "solvers/stationary_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double gap_left_by_trials = 1e-13;  // gaps that trials may leave where constraints are redundant

}  // namespace

StationarySearch::StationarySearch(NewtonSystem& system, LoopClosing& closing)
    : at_(system), closing_(closing), filter_(system.options.filter), y_before_(system.y.size()) {}

NewtonEnd StationarySearch::run() {
  at_.forget_multipliers();
  if (!begin_anew()) return NewtonEnd::stalled;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < at_.options.stationary_steps; ++k) {
    if (at_.interrupted()) return NewtonEnd::interrupted;
    const bool neutral = at_.factor_tangent() == Kkt::Factors::singular;
    at_.solve_for_step();
    ++at_.result.iterations;
    const double length = largest(at_.step);
    // Near a fold rounding changes the step by far more than the tolerance: residuals that are rounding only then end
    // the run once steps no longer decrease; so they do if a neutral direction leaves the step undetermined.
    const bool no_shorter = neutral || (length <= at_.options.next_to_fold && length > 0.25 * last);
    last = length;
    if (length <= at_.options.step_tolerance || (no_shorter && at_.balanced())) {
      at_.solve_for_multipliers();
      const ActiveSet::Release release = at_.release_wrong_sign(at_.y_next, 0.0);
      if (release == ActiveSet::Release::cycling) return NewtonEnd::stalled;
      if (release == ActiveSet::Release::none) return at_.arrive(length <= at_.options.step_tolerance);
      if (!begin_anew()) return NewtonEnd::stalled;
      continue;
    }
    if (!std::isfinite(length)) return NewtonEnd::stalled;
    if (!shorten(at_.bounded_part(length))) {
      return at_.balanced() ? at_.arrive(false) : NewtonEnd::stalled;
    }
    if (at_.activate_violated() && !begin_anew()) return NewtonEnd::stalled;
  }
  return NewtonEnd::iteration_limit;
}

// The active set has changed: remembered points no longer compare.
bool StationarySearch::begin_anew() {
  filter_.clear();
  return at_.linearize();
}

// Halves the step until the filter accepts it; leaves `now` there, linearized. Redundancy of constraints can be
// recognized only where they hold: with redundant ones every trial is first projected back onto them.
bool StationarySearch::shorten(double alpha) {
  filter_.remember(at_.gap_norm, at_.force_norm);
  const bool redundant = at_.kkt->redundant();
  const bool carries_multipliers = !at_.kkt->determines_multipliers();
  if (carries_multipliers) {
    at_.solve_for_multipliers();
    y_before_ = at_.y;
  }
  for (int h = 0; h < at_.options.stationary_halvings; ++h, alpha *= 0.5) {
    at_.try_step(alpha);
    if (redundant && !closing_.pull_back(gap_left_by_trials)) continue;
    std::swap(at_.now, at_.trial);
    if (carries_multipliers) at_.carry_multipliers(alpha);
    const bool linearized = at_.linearize();
    if (linearized && (filter_.takes(at_.gap_norm, at_.force_norm) || !at_.options.safeguards.line_search)) return true;
    std::swap(at_.now, at_.trial);
    if (carries_multipliers) at_.y = y_before_;
  }
  at_.linearize();
  return false;
}

}  // namespace poise::solvers
