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
///   F(x) - held f + J^T y = 0,   c(x) = 0 for the rows that hold,
///
/// at the point where a run is, linearized there. It is what the parts of the method (loop closing, stationary search,
/// descent, load stepping) hand to one another; each leaves `now` where it arrived. f is the artificial load of load
/// stepping, and held the share of it that still acts. Buffers are sized once.
class NewtonSystem {
 public:
  /// Both must outlive this; the result is filled as the run goes on.
  NewtonSystem(const Problem& problem, const NewtonOptions& options, NewtonResult& result);

  const Problem& problem;
  const NewtonOptions& options;
  NewtonResult& result;
  const bool bounded;  ///< there are inequalities
  const bool dense;    ///< null space, else sparse factors
  std::unique_ptr<Kkt> kkt;
  ActiveSet active;
  std::minstd_rand random;  ///< the same for every run, so that runs repeat

  std::vector<double> start;      ///< x that the run was given
  Evaluation *now, *trial;        ///< where the run is, and where it may go
  std::vector<double> y;          ///< multipliers at now
  std::span<const double> gap;    ///< of find_gap(): c of the rows that hold at now, 0 of others
  std::vector<double> residual;   ///< of linearize(): F - held f + J^T y
  std::vector<double> step;       ///< of solve_for_step()
  std::vector<double> y_next;     ///< of solve_for_multipliers(): those at the end of the step
  std::vector<double> trial_gap;  ///< at trial
  double gap_norm = 0.0;          ///< of linearize(): |gap|
  double force_norm = 0.0;        ///< of linearize(): |residual|
  std::vector<double> load;       ///< f
  double held = 0.0;

  int variables() const { return static_cast<int>(now->x.size()); }
  int rows() const { return static_cast<int>(y.size()); }
  bool seeks_minimum() const { return options.goal == Goal::minimum && problem.has_objective(); }
  bool interrupted() const { return options.interrupt != nullptr && options.interrupt->load(); }

  /// Puts `now` at x, with the rows that x touches and nothing known of multipliers.
  void begin_at(std::span<const double> x);
  void evaluate(Evaluation& at);
  /// f - held load^T x at an evaluated point.
  double objective(Evaluation& at) const;
  /// trial = now + alpha step.
  void try_step(double alpha);

  /// Good until now moves.
  void find_gap();
  /// How much of a step whose largest entry is `length` may be taken at once. Without a division where all of it may,
  /// which small problems would wait for.
  double bounded_part(double length) const {
    const bool whole = length <= options.longest_step || !options.safeguards.line_search;
    return whole ? 1.0 : options.longest_step / length;
  }
  /// The next linearize() takes least-squares multipliers instead of those that go with the last ones.
  void forget_multipliers() { multipliers_for_ = -1; }
  /// J, y, gap and residual at now. False where J cannot be used as it is, which leaves the other two undefined.
  bool linearize();
  /// Takes the tangent at now and factors it.
  Kkt::Factors factor_tangent();
  /// Of the diagonal of K.
  double largest_curvature() const { return largest(std::span(tangent_).first(now->x.size())); }
  /// step by the factors at hand.
  void solve_for_step();
  /// y_next of that step.
  void solve_for_multipliers();
  /// y += alpha (y_next - y).
  void carry_multipliers(double alpha);

  /// Residuals are nothing but rounding, after linearize().
  bool at_rest() const;
  /// Inequalities that `now` violates join; true where any did.
  bool activate_violated() { return bounded && active.activate_violated(*now, violated_beyond); }
  /// Lets go of the inequality that pulls hardest by more than `least` and what rounding makes of multipliers.
  ActiveSet::Pulling release_pulling(std::span<const double> multipliers, double least);

  /// Notes how a stage of the run ended.
  void note(Outcome outcome);
  /// A stage ended in a way after which another may do better.
  bool gave_up() const {
    return result.outcome == Outcome::stalled || result.outcome == Outcome::singular ||
           result.outcome == Outcome::iteration_limit;
  }

  /// How a run ends whose steps or residuals met their tolerances; takes the last step where asked to.
  Outcome arrive(bool with_last_step);

 private:
  static constexpr double violated_beyond = 1e-14;

  Evaluation points_[2];
  std::vector<double> tangent_, gap_;
  int multipliers_for_ = -1;  // ActiveSet::changes() for which y was found
};

}  // namespace poise::solvers
