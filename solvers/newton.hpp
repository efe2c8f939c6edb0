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
enum class Outcome {
  not_solved,       ///< nothing has been tried
  converged,        ///< the last step, or what rounding leaves of residuals, met the tolerances
  not_closed,       ///< no point with c(x) = 0 was found from the start
  stalled,          ///< no step led any further
  singular,         ///< it closed in on a pose where J loses rank and only infinite multipliers would balance F
  unbounded,        ///< the objective falls without end, or x runs away
  iteration_limit,  ///< NewtonOptions::iterations used up
  interrupted       ///< NewtonOptions::interrupt was set
};

/// One sentence for a person.
std::string describe(Outcome outcome);

/// What keeps Newton's method from failing where it is left to itself. Each can be switched off to show its worth;
/// docs/method.md says what each does.
struct Safeguards {
  bool inertia_correction = true;  ///< minimum: the tangent is shifted until it is positive on the null space of J
  bool line_search = true;         ///< steps are bounded and halved on the filter or the Lagrangian's fall
  bool rank_revealing = true;      ///< dependent rows of J are left out, multipliers are of minimum norm
  bool restarts = true;            ///< from singular poses, and where a run gives up, others begin close by, then far
  bool load_stepping = true;       ///< where all else stalls: released step by step from a load that holds the start
};

struct NewtonOptions {
  Goal goal = Goal::stationary;
  Safeguards safeguards{};
  const std::atomic<bool>* interrupt = nullptr;

  // When a run has arrived.
  double step_tolerance = 1e-9;  ///< converged when max |d| is below it; d is then still applied, leaving |d|^2
  double rounding = 2e-15;       ///< or when max |c| and max |F + J^T y| / (1 + max |F|) are below it
  double next_to_fold = 1e-5;    ///< and max |d|, which no longer shrinks: next to a fold rounding moves steps so far
  /// max |y| / (1 + max |F|) beyond which J may have lost rank: the run has then converged only where gaps of one
  /// rounding change y by less than settled_multipliers max |y|.
  double heavy_multipliers = 1e3;
  double settled_multipliers = 0.3;
  double run_away = 100.0;  ///< max |x - start|, rad or mechanism sizes, that counts as unbounded

  // Steps.
  double longest_step = 0.5;        ///< bound on max |d|, rad or mechanism sizes
  int iterations = 500;             ///< of descent, and of closing from one start
  int stationary_steps = 80;        ///< of the stationary search, before descent is tried instead
  int stationary_halvings = 12;     ///< of one of its steps
  int halvings = 30;                ///< of one step of descent or of closing
  double armijo = 1e-4;             ///< share of the fall predicted by the slope that these must achieve
  double closure_tolerance = 1e-8;  ///< steps of descent start from points with max |c| below it
  FilterOptions filter{};           ///< of the stationary search
  ActiveSetOptions active_set{};    ///< max |c| below its `touching` counts as closed, too

  // Other starts. Those of large problems are as bad as any: they get few or none.
  int closing_starts = 30;      ///< displaced ones for closing loops; 3 at most where factors are sparse
  int perturbations = 20;       ///< of descent, away from poses where J loses rank
  int perturbation_tries = 30;  ///< for each of them
  int restarts = 30;            ///< of a run that gave up
  int restarts_up_to = 300;     ///< variables; beyond there are none

  // Load stepping.
  double first_release = 0.25;  ///< share of the holding load that is let go at once
  double least_release = 1e-3;  ///< below it the run gives up

  /// The dense null space costs about n^2 (n - equalities) a step, sparse LDL^T about n: dense is used where n is at
  /// most dense_limit and n (n - equalities) at most dense_work, and always where there is no objective.
  int dense_limit = 48;
  int dense_work = 50;
};

struct NewtonResult {
  Outcome outcome = Outcome::not_solved;
  std::vector<double> x;
  std::vector<double> multipliers;  ///< one per constraint row, zero for rows not active
  std::vector<char> active;         ///< rows that hold: equalities, and inequalities at their bound
  int iterations = 0;               ///< Newton steps, closing of loops included
  int evaluations = 0;
  /// max |c|, active bounds included, at the last point evaluated: a step within the tolerance is taken from there
  /// without another look.
  double constraint_error = 0.0;
  bool descended = false;     ///< Goal::stationary fell back on descending the objective
  bool restarted = false;     ///< it took a start displaced at random
  bool load_stepped = false;  ///< it took load stepping to get there
  bool met_singular = false;  ///< some stage ended as Outcome::singular, even if a later one went on
};

/// Newton's method for a Problem, made to arrive from anywhere.
///
/// stationary: the step of the full system {c = 0, F + J^T y = 0}, shortened until a filter takes it: against every
/// point
///   left behind, |c| or |F + J^T y| must be smaller. Where that stalls it starts again from closed loops, and where
///   that stalls too and there is an objective, it descends as below.
/// minimum: loops are closed first (shortest damped steps); then each step keeps them closed. The tangent is shifted
///   until it is positive definite on the null space of J, the step is halved until the Lagrangian falls (Armijo), and
///   at a saddle or maximum it follows a direction of negative curvature. The Lagrangian falls from step to step, so
///   the run can only end in a minimum, run away, or be cut off.
/// Inequalities are held by an active set: a step ends where it meets one; one whose multiplier pulls is released.
/// restarts: a run that gives up or ends in a singular configuration begins again from the start displaced at random
///   and closed, ever farther.
/// load stepping: where all this stalls, the closed start is held in balance by the artificial load F + J^T y that it
///   lacks, and that load is let go by steps, each solved from the last.
///
/// Iterations allocate nothing: all that they use is sized in the constructor. Only other starts and load stepping keep
/// points of their own, from when they are first needed.
class Newton {
 public:
  /// `problem` must outlive this.
  explicit Newton(const Problem& problem, const NewtonOptions& options = {});
  ~Newton();
  Newton(const Newton&) = delete;
  Newton& operator=(const Newton&) = delete;

  /// Runs from x (problem.variables() values). The result stays valid until the next call.
  const NewtonResult& solve(std::span<const double> x);
  /// Only closes the constraints from x by shortest steps; Outcome::converged or not_closed.
  const NewtonResult& close(std::span<const double> x);

 private:
  class Method;
  std::unique_ptr<Method> method_;
};

}  // namespace poise::solvers
