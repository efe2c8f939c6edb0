#pragma once

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// A value of a measure g of x at which something happens, as a function of g that vanishes there.
///
/// A distance that passes near zero turns round within a part of the way as short as it is itself; half its square is
/// smooth along the motion however near it passes. So of a distance the function is that of its square, scaled to the
/// slope of g at the threshold.
struct Threshold {
  double at = 0.0;
  bool of_distance = false;  ///< then at > 0

  double past(double g) const { return of_distance ? (g - at) * (g + at) / (2 * at) : g - at; }
  double slope(double g) const { return of_distance ? g / at : 1.0; }
};

/// A limit of an inequality: sign * threshold.past(g) >= 0.
struct Limit {
  int inequality;
  double sign;
  Threshold threshold;
};

/// A Problem with a heavily damped motion: x(t) with
///
///   D(x) x' + F(x) + J^T y = 0,   c(x) = 0,   lower <= g(x) <= upper,
///
/// where y presses at an inequality only while x is at its bound. F may have kinks where a measure passes a switch.
class DampedProblem : public Problem {
 public:
  /// Whether an inequality limits a distance.
  virtual bool limits_distance(int inequality) const = 0;
  /// Where F has kinks; F itself is continuous there.
  virtual const std::vector<Threshold>& switches() const = 0;
  /// The measures of the switches at an evaluated point.
  virtual void switch_measures(Evaluation& at, std::span<double> values) const = 0;
  /// out = the gradient of one of them.
  virtual void switch_gradient(Evaluation& at, int which, std::span<double> out) const = 0;
  /// values = D by the entries of tangent_pattern(), symmetric and positive definite on the null space of J.
  virtual void resistance(Evaluation& at, std::span<double> values) const = 0;

  /// All finite limits, but for the lower ones of distances that no distance reaches.
  std::vector<Limit> limits() const {
    std::vector<Limit> out;
    for (int k = 0; k < inequalities(); ++k) {
      const bool is_distance = limits_distance(k);
      const double low = lower()[k], high = upper()[k];
      if (std::isfinite(low) && !(is_distance && low <= 0.0)) out.push_back({k, 1.0, {low, is_distance}});
      if (std::isfinite(high)) out.push_back({k, -1.0, {high, is_distance && high > 0.0}});
    }
    return out;
  }
};

/// How a damped motion ended.
enum class Arrival {
  rest,         ///< at an equilibrium from which small displacements do not grow, or at stops that hold it
  unstable,     ///< at an equilibrium that is not stable: the start is one, or lies on a watershed
  runs_away,    ///< it moved farther than DampedOptions::run_away
  singular,     ///< J loses rank on the way, where the motion may continue in several ways
  step_limit,   ///< DampedOptions::steps used up: it circulates, or creeps
  interrupted,  ///< DampedOptions::interrupt was set
};

struct DampedOptions {
  double tolerance = 1e-4;     ///< of the error of one step, rad or mechanism sizes; one freedom needs none
  double longest_step = 0.25;  ///< rad or mechanism sizes
  double run_away = 100.0;     ///< max |x - start|, rad or mechanism sizes
  int steps = 4000;
  double touching = 1e-9;  ///< distance from a bound within which a point counts as at the bound
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(std::span<const double> x)> passed{};  ///< called at the end of every step
};

struct DampedResult {
  Arrival arrival = Arrival::step_limit;
  std::vector<double> x;
  std::vector<char> active;  ///< rows of J: equalities, and inequalities that hold x
  /// The motion passed a place where rounding decides how it goes on.
  bool rounding_decides = false;
  /// Several freedoms: how far from the way of the motion there may be another that ends elsewhere, and how far the one
  /// computed may be from the exact one, both where their distances have grown most; rad or mechanism sizes.
  double margin = std::numeric_limits<double>::infinity();
  double error = 0.0;
  int steps = 0;
  int evaluations = 0;
};

}  // namespace poise::solvers
