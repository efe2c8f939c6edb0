#pragma once

#include <memory>
#include <random>
#include <span>
#include <vector>

#include "solvers/active_set.hpp"
#include "solvers/kkt.hpp"
#include "solvers/newton.hpp"
#include "solvers/problem.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {

/// The conditions that Newton's method solves,
///
///   F(x) - share f + J^T y = 0,   c(x) = 0 for the active rows,
///
/// linearized at the current point of a run. The parts of the method (loop closing, stationary search, descent, load
/// stepping) share it; each leaves `now` at the point it reached. f is the artificial load of load stepping, and share
/// the part of it that still acts. Buffers are sized once.
class NewtonSystem {
 public:
  /// Both must outlive this; the result is filled during the run.
  NewtonSystem(const Problem& problem, const NewtonOptions& options, NewtonResult& result);

  const Problem& problem;
  const NewtonOptions& options;
  NewtonResult& result;
  const bool bounded;  ///< there are inequalities
  const bool dense;    ///< dense null space, otherwise sparse factors
  std::unique_ptr<Kkt> kkt;
  ActiveSet active;
  std::minstd_rand random;  ///< the same seed for every run, so that runs are reproducible

  std::vector<double> start;      ///< the start of the run
  Evaluation *now, *trial;        ///< the current point and a trial point
  std::vector<double> y;          ///< multipliers at now
  std::span<const double> gap;    ///< of find_gap(): c of the active rows at now, 0 of others
  std::vector<double> residual;   ///< of linearize(): F - share f + J^T y
  std::vector<double> step;       ///< of solve_for_step()
  std::vector<double> y_next;     ///< of solve_for_multipliers(): at the end of the step
  std::vector<double> trial_gap;  ///< at trial
  double gap_norm = 0.0;          ///< of linearize(): |gap|
  double force_norm = 0.0;        ///< of linearize(): |residual|
  std::vector<double> load;       ///< f
  double share = 0.0;             ///< of the load that still acts

  int variables() const { return static_cast<int>(now->x.size()); }
  int rows() const { return static_cast<int>(y.size()); }
  bool seeks_minimum() const { return options.goal == Goal::minimum && problem.has_objective(); }
  bool interrupted() const { return options.interrupt != nullptr && options.interrupt->load(); }

  /// Sets `now` to x, activates the inequalities at a bound there and discards the multipliers.
  void begin_at(std::span<const double> x);
  void evaluate(Evaluation& at);
  /// f - share load^T x at an evaluated point.
  double objective(Evaluation& at) const;
  /// trial = now + alpha step.
  void try_step(double alpha);

  /// Sets `gap`, valid until `now` changes.
  void find_gap();
  /// The share of a step whose largest entry is `length` that the bound on steps allows. Avoids a division, costly in
  /// small problems, where the full step is allowed.
  double bounded_part(double length) const {
    const bool whole = length <= options.longest_step || !options.safeguards.line_search;
    return whole ? 1.0 : options.longest_step / length;
  }
  /// The next linearize() computes least-squares multipliers instead of continuing from the last ones.
  void forget_multipliers() { multipliers_for_ = -1; }
  /// Sets J, y, gap and residual at now. False if J cannot be used, which leaves y and residual undefined.
  bool linearize();
  /// Evaluates the tangent at now and factors it.
  Kkt::Factors factor_tangent();
  /// Largest entry of the diagonal of K, in amount.
  double largest_curvature() const { return largest(std::span(tangent_).first(now->x.size())); }
  /// Sets `step` by the current factors.
  void solve_for_step();
  /// Sets `y_next` for that step.
  void solve_for_multipliers();
  /// y += alpha (y_next - y).
  void carry_multipliers(double alpha);

  /// Whether the residuals are rounding only, after linearize().
  bool balanced() const;
  /// Activates the inequalities that `now` violates; true if there are any.
  bool activate_violated() { return bounded && active.activate_violated(*now, violated_beyond); }
  /// Releases the inequality whose multiplier has the wrong sign by most, if by more than `least` and the rounding
  /// error of multipliers.
  ActiveSet::Release release_wrong_sign(std::span<const double> multipliers, double least);

  /// Records how a stage of the run ended.
  void note(NewtonEnd end);
  /// A stage failed in a way after which another may succeed.
  bool gave_up() const {
    return result.end == NewtonEnd::stalled || result.end == NewtonEnd::singular ||
           result.end == NewtonEnd::iteration_limit;
  }

  /// The end of a run whose steps or residuals met their tolerances; applies the last step if asked to.
  NewtonEnd arrive(bool with_last_step);

 private:
  static constexpr double violated_beyond = 1e-14;

  Evaluation points_[2];
  std::vector<double> tangent_, gap_;
  int multipliers_for_ = -1;  // ActiveSet::changes() for which y was found
};

}  // namespace poise::solvers
