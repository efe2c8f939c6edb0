#include "solvers/optimality.hpp"

#include <algorithm>

#include "solvers/active_set.hpp"
#include "solvers/residuals.hpp"

namespace poise::solvers {
namespace {

constexpr double least_pull = 1e-9;  // below it the sign of a multiplier is decided by rounding

}  // namespace

Optimality optimality_at(const Problem& problem, const Evaluation& at, const std::vector<int>& kept, double near) {
  ActiveSet active(problem, kept);
  active.activate_violated(at, -near);
  Optimality out;
  do {
    out.multipliers = least_squares_multipliers(problem, at, active.rows());
  } while (active.release_wrong_sign(out.multipliers, least_pull) == ActiveSet::Release::released);
  out.error = std::max(active.largest_gap(at), force_error(problem, at, out.multipliers));
  return out;
}

}  // namespace poise::solvers
