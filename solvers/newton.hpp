#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solvers/active_set.hpp"
#include "solvers/filter.hpp"
#include "solvers/problem.hpp"

namespace poise::solvers {

/// What a Newton run looks for.
enum class Goal {
  stationary,  ///< any point with F + J^T y = 0 near the start
  minimum      ///< a local minimum of the objective on the constraints
};

/// How a run ended.
enum class NewtonEnd {
  not_solved,       ///< nothing has been tried
  converged,        ///< the last step met its tolerance, or the residuals are rounding only
  not_closed,       ///< no point with c(x) = 0 was found from the start
  stalled,          ///< no step makes further progress
  singular,         ///< it approached a pose where J loses rank and no finite multipliers balance F
  unbounded,        ///< the objective decreases without bound, or x diverges
  iteration_limit,  ///< NewtonOptions::iterations used up
  interrupted       ///< NewtonOptions::interrupt was set
};

/// The end in words, for messages.
std::string describe(NewtonEnd end);

/// Globalization of Newton's method. Each safeguard can be switched off to measure its effect; docs/method.md describes
/// them.
struct Safeguards {
  bool inertia_correction =
      true;                    ///< minimum: the tangent is shifted until it is positive definite on the null space of J
  bool line_search = true;     ///< steps are bounded, and halved by the filter or the decrease of the Lagrangian
  bool rank_revealing = true;  ///< dependent rows of J are left out, multipliers have minimum norm
  bool restarts = true;        ///< after a failed run or a singular pose, from displaced starts, near ones first
  bool load_stepping = true;   ///< when all else fails: an artificial load that balances the start is reduced in steps
};

struct NewtonOptions {
  Goal goal = Goal::stationary;
  Safeguards safeguards{};
  const std::atomic<bool>* interrupt = nullptr;

  // Convergence.
  double step_tolerance =
      1e-9;  ///< converged when max |d| is below it; d is then still applied, so the error is about |d|^2
  double rounding = 2e-15;  ///< or when max |c| and max |F + J^T y| / (1 + max |F|) are below it
  double next_to_fold =
      1e-5;  ///< and max |d|, no longer decreasing, below this: near a fold, rounding errors of steps are so large
  /// max |y| / (1 + max |F|) beyond which J may have lost rank: the run has then converged only if gaps of one rounding
  /// unit change y by less than settled_multipliers max |y|.
  double heavy_multipliers = 1e3;
  double settled_multipliers = 0.3;
  double run_away = 100.0;  ///< max |x - start|, rad or mechanism sizes, that counts as unbounded

  // Steps.
  double longest_step = 0.5;        ///< bound on max |d|, rad or mechanism sizes
  int iterations = 500;             ///< of descent, and of loop closing from one start
  int stationary_steps = 80;        ///< of the stationary search, after which descent is tried
  int stationary_halvings = 12;     ///< of one of its steps
  int halvings = 30;                ///< of one step of descent or of loop closing
  double armijo = 1e-4;             ///< share of the decrease predicted by the slope that a step must achieve
  double closure_tolerance = 1e-8;  ///< steps of descent start from points with max |c| below it
  FilterOptions filter{};           ///< of the stationary search
  ActiveSetOptions active_set{};    ///< max |c| below its `touching` also counts as closed

  // Other starts. Large problems get few or none, because displaced starts are rarely better there.
  int closing_starts = 30;      ///< displaced ones for loop closing; 3 at most with sparse factors
  int perturbations = 20;       ///< of descent, away from poses where J loses rank
  int perturbation_tries = 30;  ///< for each of them
  int restarts = 30;            ///< of a run that failed
  int restarts_up_to = 300;     ///< variables; no restarts beyond

  // Load stepping.
  double first_release = 0.25;  ///< first reduction, as a share of the artificial load
  double least_release = 1e-3;  ///< smallest reduction; the run fails below it

  /// The dense null space costs about n^2 (n - equalities) a step, sparse LDL^T about n: dense is used if n is at most
  /// dense_limit and n (n - equalities) at most dense_work, and always if there is no objective.
  int dense_limit = 48;
  int dense_work = 50;
};

struct NewtonResult {
  NewtonEnd end = NewtonEnd::not_solved;
  std::vector<double> x;
  std::vector<double> multipliers;  ///< one per constraint row, zero for rows not active
  std::vector<char> active;         ///< active rows: equalities, and inequalities held at their bound
  int iterations = 0;               ///< Newton steps, loop closing included
  int evaluations = 0;
  /// max |c|, active bounds included, at the last point evaluated; a final step within the tolerance is not evaluated
  /// again.
  double constraint_error = 0.0;
  bool descended = false;     ///< Goal::stationary fell back on descending the objective
  bool restarted = false;     ///< converged from a start displaced at random
  bool load_stepped = false;  ///< converged by load stepping
  bool met_singular = false;  ///< some stage ended as NewtonEnd::singular, even if a later one did not
};

/// Newton's method for a Problem, globalized so that it converges from distant starts.
///
/// stationary: the step of the full system {c = 0, F + J^T y = 0}, shortened until a filter accepts it: compared with
///   every point left behind, |c| or |F + J^T y| must be smaller. If that stalls it starts again from closed loops, and
///   if that stalls too and there is an objective, it descends as below.
/// minimum: loops are closed first (damped minimum-norm steps); then each step keeps them closed. The tangent is
///   shifted until it is positive definite on the null space of J, the step is halved until the Lagrangian decreases
///   (Armijo), and at a saddle or maximum it follows a direction of negative curvature. The Lagrangian decreases with
///   every step, so the run ends at a minimum, diverges, or is stopped by a limit.
/// Inequalities are handled by an active set: a step ends at the first bound it reaches; an inequality whose multiplier
///   has the wrong sign is released.
/// restarts: after a failed run or a singular configuration, from the start displaced at random by growing distances
///   and closed.
/// load stepping: if all this fails, an artificial load F + J^T y makes the closed start an equilibrium and is reduced
///   to zero in steps, each solved from the last.
///
/// Iterations allocate nothing: all buffers are sized in the constructor. Only restarts and load stepping allocate
/// further points, when they are first needed.
class Newton {
 public:
  /// `problem` must outlive this.
  explicit Newton(const Problem& problem, const NewtonOptions& options = {});
  ~Newton();
  Newton(const Newton&) = delete;
  Newton& operator=(const Newton&) = delete;

  /// Runs from x (problem.variables() values). The result stays valid until the next call.
  const NewtonResult& solve(std::span<const double> x);
  /// Only closes the constraints from x by shortest steps; NewtonEnd::converged or not_closed.
  const NewtonResult& close(std::span<const double> x);

 private:
  class Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace poise::solvers
