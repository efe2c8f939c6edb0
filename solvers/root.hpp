#pragma once

// Roots of functions of one variable. Each method keeps a bracket, two places between which the function changes its
// sign, so that it finds a root between them.

#include <cmath>
#include <optional>

namespace poise::solvers {

/// Two places between which something changes. `from` may be the larger one.
struct Bracket {
  double from = 0.0, to = 0.0;

  double width() const { return std::abs(to - from); }
};

/// Halves a bracket until `is_narrow(bracket)`, or no number lies between its ends. `is_before(place)` says whether a
/// place is still as `from` is; where it returns an empty std::optional the search ends. It may move the place that it
/// is given, within the bracket.
template <class IsBefore, class IsNarrow>
void bisect(Bracket& bracket, IsBefore is_before, IsNarrow is_narrow) {
  while (!is_narrow(bracket)) {
    double middle = 0.5 * (bracket.from + bracket.to);
    if (middle == bracket.from || middle == bracket.to) return;
    const std::optional<bool> before = is_before(middle);
    if (!before) return;
    (*before ? bracket.from : bracket.to) = middle;
  }
}

/// Halves a bracket down to rounding.
template <class IsBefore>
void bisect(Bracket& bracket, IsBefore is_before) {
  bisect(bracket, is_before, [](const Bracket&) { return false; });
}

/// Halves a bracket `most` times, or down to rounding.
template <class IsBefore>
void bisect_at_most(int most, Bracket& bracket, IsBefore is_before) {
  bisect(bracket, is_before, [&](const Bracket&) { return most-- == 0; });
}

/// Finds the root of f between from < to, of the values `at_from` and `at_to` of opposite signs there: secant steps
/// kept within the bracket, where an end that stays counts half (Illinois; M. Dowell, P. Jarratt, 1971). `f` returns a
/// std::optional, empty where it has no value: then there is no root. Ends where the bracket is narrower than `width`;
/// places and values are of the size 1, so that 1e-16 is nothing.
template <class F>
std::optional<double> root_by_secants(F f, Bracket bracket, double at_from, double at_to, double width) {
  constexpr int most_steps = 80;
  constexpr double nothing = 1e-16;
  auto& [from, to] = bracket;
  double s = from;
  int stayed = 0;  // 1: the end at `to` stayed in the last step, -1: that at `from`
  for (int k = 0; k < most_steps; ++k) {
    s = (from * at_to - to * at_from) / (at_to - at_from);
    if (!(s > from && s < to)) s = 0.5 * (from + to);
    const std::optional<double> value = f(s);
    if (!value) return std::nullopt;
    if (to - from < width || s == from || s == to || std::abs(*value) < nothing) break;
    if ((*value > 0.0) == (at_from > 0.0)) {
      if (s - from < nothing) break;
      from = s;
      at_from = *value;
      if (stayed == 1) at_to *= 0.5;
      stayed = 1;
    } else {
      if (to - s < nothing) break;
      to = s;
      at_to = *value;
      if (stayed == -1) at_from *= 0.5;
      stayed = -1;
    }
  }
  return s;
}

/// A function at a place.
struct ValueAndSlope {
  double value = 0.0, slope = 0.0;
};

/// Limits at which root_by_newton() ends.
struct NewtonLimits {
  double step = 1e-15;  ///< that is shorter
  double width = 0.0;   ///< of a bracket that is narrower
  int steps = 50;       ///< at most
};

/// Finds the root of f between from < to: Newton's steps from `start`, halves of the bracket where they leave it.
/// `falls`: f is positive at `from` and negative at `to`; else the other way round. `f` returns a
/// std::optional<ValueAndSlope>, empty where it has none: then there is no root.
template <class F>
std::optional<double> root_by_newton(F f, Bracket bracket, double start, bool falls, NewtonLimits limits = {}) {
  auto& [from, to] = bracket;
  double s = start;
  for (int k = 0; k < limits.steps; ++k) {
    const std::optional<ValueAndSlope> at = f(s);
    if (!at) return std::nullopt;
    ((at->value > 0.0) == falls ? from : to) = s;
    double next = s - at->value / at->slope;
    if (!(next > from && next < to)) next = 0.5 * (from + to);
    if (at->value == 0.0 || std::abs(next - s) < limits.step || to - from < limits.width) break;
    s = next;
  }
  return s;
}

}  // namespace poise::solvers
