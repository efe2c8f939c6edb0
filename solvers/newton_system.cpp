#include "solvers/newton_system.hpp"

#include <algorithm>
#include <cmath>

namespace poise::solvers {
namespace {

constexpr double rounded_pull = 1e-13;  // relative to the field: rounding error of a multiplier that is zero
constexpr double rounded_gap = 2e-16;

bool small_enough(const Problem& problem, const NewtonOptions& options) {
  const int n = problem.variables();
  return n <= options.dense_limit && n * (n - problem.equalities()) <= options.dense_work;
}

}  // namespace

NewtonSystem::NewtonSystem(const Problem& given_problem, const NewtonOptions& given_options, NewtonResult& given_result)
    : problem(given_problem),
      options(given_options),
      result(given_result),
      bounded(problem.inequalities() > 0),
      dense(!problem.has_objective() || small_enough(problem, options)),
      kkt(dense ? make_null_space(problem, options.safeguards.rank_revealing) : make_sparse_kkt(problem)),
      active(problem, {}, options.active_set),
      now(&points_[0]),
      trial(&points_[1]),
      points_{problem.make_evaluation(), problem.make_evaluation()},
      tangent_(problem.tangent_pattern().size()) {
  for (auto* v : {&start, &residual, &step}) v->resize(problem.variables());
  for (auto* v : {&y, &y_next, &trial_gap}) v->resize(problem.constraints());
  if (bounded) gap_.resize(problem.constraints());
}

void NewtonSystem::begin_at(std::span<const double> x) {
  std::copy(x.begin(), x.end(), now->x.begin());
  if (bounded) active.reset();
  std::fill(y.begin(), y.end(), 0.0);
  forget_multipliers();
  evaluate(*now);
  if (bounded) active.activate_touched(*now);
}

void NewtonSystem::evaluate(Evaluation& at) {
  problem.evaluate(at);
  ++result.evaluations;
  if (share == 0.0) return;
  for (int i = 0; i < variables(); ++i) at.gradient[i] -= share * load[i];
}

double NewtonSystem::objective(Evaluation& at) const {
  const double f = problem.objective(at);
  return share == 0.0 ? f : f - share * dot(load, at.x);
}

void NewtonSystem::try_step(double alpha) {
  for (int i = 0; i < variables(); ++i) trial->x[i] = now->x[i] + alpha * step[i];
  evaluate(*trial);
}

void NewtonSystem::find_gap() {
  gap = now->constraint;
  if (!bounded) return;
  active.gaps(*now, gap_);
  gap = gap_;
}

bool NewtonSystem::linearize() {
  find_gap();
  if (!kkt->set_jacobian(*now, active.flags())) return false;
  if (kkt->determines_multipliers() || multipliers_for_ != active.changes())
    kkt->balance(now->gradient, y, residual);
  else
    kkt->unbalanced(now->gradient, y, residual);
  multipliers_for_ = active.changes();
  gap_norm = std::sqrt(dot(gap, gap));
  force_norm = std::sqrt(dot(residual, residual));
  return true;
}

Kkt::Factors NewtonSystem::factor_tangent() {
  problem.tangent(*now, y, tangent_);
  return kkt->factor_tangent(tangent_);
}

void NewtonSystem::solve_for_step() { kkt->solve(residual, gap, step); }

void NewtonSystem::solve_for_multipliers() {
  kkt->solved_multipliers(residual, y_next);
  for (int r = 0; r < rows(); ++r) y_next[r] += y[r];
}

void NewtonSystem::carry_multipliers(double alpha) {
  for (int r = 0; r < rows(); ++r) y[r] += alpha * (y_next[r] - y[r]);
}

bool NewtonSystem::balanced() const {
  return largest(gap) <= options.rounding && largest(residual) <= options.rounding * (1.0 + largest(now->gradient));
}

ActiveSet::Release NewtonSystem::release_wrong_sign(std::span<const double> multipliers, double least) {
  if (!bounded) return ActiveSet::Release::none;
  const double noise = rounded_pull * (1.0 + largest(now->gradient));
  const ActiveSet::Release release = active.release_wrong_sign(multipliers, std::max(least, noise));
  if (release == ActiveSet::Release::released) active.clear_inactive(y);
  return release;
}

void NewtonSystem::note(NewtonEnd end) {
  result.end = end;
  result.met_singular = result.met_singular || end == NewtonEnd::singular;
}

// Where J loses rank no finite multipliers balance F. Close to such a pose rounded closures can make them appear to:
// they are large there and change strongly with the rounding of the closures.
NewtonEnd NewtonSystem::arrive(bool with_last_step) {
  if (with_last_step) {
    for (int i = 0; i < variables(); ++i) now->x[i] += step[i];
    carry_multipliers(1.0);
  }
  const double most = largest(y);
  if (!(most > options.heavy_multipliers * (1.0 + largest(now->gradient)))) return NewtonEnd::converged;
  if (with_last_step) evaluate(*now);
  if (!kkt->set_jacobian(*now, active.flags())) return NewtonEnd::singular;
  factor_tangent();
  for (int r = 0; r < rows(); ++r) trial_gap[r] = active.holds(r) ? (r % 2 == 0 ? rounded_gap : -rounded_gap) : 0.0;
  kkt->solve({}, trial_gap, step);
  kkt->solved_multipliers({}, y_next);
  return largest(y_next) <= options.settled_multipliers * most ? NewtonEnd::converged : NewtonEnd::singular;
}

}  // namespace poise::solvers
