#include "solvers/optimality.hpp"

#include <algorithm>

#include "solvers/residuals.hpp"

namespace poise::solvers {
namespace {

constexpr double least_pull = 1e-9;  // below it the sign of a multiplier is rounding

}  // namespace

Optimality optimality_at(const Problem& problem, const Evaluation& at, const std::vector<int>& kept, double near) {
  HeldRows held(problem, kept);
  held.hold_violated(at, -near);
  Optimality out;
  do {
    out.multipliers = least_squares_multipliers(problem, at, held.rows());
  } while (held.release_pulling(out.multipliers, least_pull) == HeldRows::Pulling::released);
  out.error = std::max(held.largest_gap(at), force_error(problem, at, out.multipliers));
  return out;
}

}  // namespace poise::solvers
