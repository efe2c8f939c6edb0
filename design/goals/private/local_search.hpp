#pragma once

#include <atomic>
#include <limits>
#include <vector>

#include "design/goals/goal_evaluation.hpp"
#include "solvers/nonlinear_program.hpp"

namespace poise {

inline constexpr double not_limited = std::numeric_limits<double>::infinity();

/// Where a local search has ended.
struct LocalEnd {
  DesignPoint point;
  bool has_values = false;      ///< the goals could be evaluated
  bool keeps = false;           ///< all limits
  bool misses_length = false;   ///< a length is outside of the row's
  double missed = not_limited;  ///< sum of the squares of what limits miss
  double aim = 0.0;             ///< weighted sum of the aims
  std::vector<double> aims{};
  int index = 0;

  /// Keeps limits that the other does not, or has a better aim by more than a part `by` of it, or misses less.
  bool is_better_than(const LocalEnd& other, double by) const;
};

struct LocalSearchOptions {
  solvers::ProgramMethod method = solvers::ProgramMethod::slsqp;
  const std::atomic<bool>* interrupt = nullptr;
  std::vector<double> levels{};  ///< of each aim a limit; none where empty
  bool with_aims = true;
};

/// From a choice of numbers: first limits, then aims. Rows of catalogues stay.
LocalEnd local_search(const GoalProblem& problem, GoalEvaluation& evaluation, DesignPoint from,
                      const LocalSearchOptions& options);

/// The goals at a choice of numbers, without a search.
LocalEnd values_at(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& point);

/// A limit, or an end of a variable's range, that holds the aims back.
struct HeldBack {
  int goal = -1, variable = -1;
  bool is_upper = false;
  double gain = 0.0;
};
/// At the best choice, the strongest first.
std::vector<HeldBack> holding_back(const GoalProblem& problem, GoalEvaluation& evaluation, const DesignPoint& point);

}  // namespace poise
