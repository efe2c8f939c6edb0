#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "design/goals/goal_problem.hpp"
#include "statics/paths/path.hpp"
#include "statics/proof/certificate.hpp"

namespace poise {

/// What one goal comes to, SI.
struct CheckedGoal {
  bool met = false;  ///< of an aim: it has a value
  std::string why;   ///< one sentence, where it is not met for another reason than a limit
  bool has_value = false;
  double least = 0.0, most = 0.0;        ///< of the quantity, of a curve of the distance from it
  double least_at = 0.0, most_at = 0.0;  ///< values of what is varied
  std::vector<double> extremes{};        ///< of an expression of extremes: where these are attained
  double margin = 0.0;                   ///< to the nearest limit, negative where it is missed
  double worst_at = 0.0;                 ///< where that margin is
};

/// How a design was looked at: by what `poise path` and `poise solve` do.
struct GoalCheck {
  bool met = false;
  std::vector<CheckedGoal> goals;
  int points = 0, proved = 0;        ///< equilibria that were looked at, and those that are proved
  std::vector<std::string> notes{};  ///< sentences of the paths that a reader should not miss
  std::string why;                   ///< a length or a path that is missed, in one sentence
};

/// Checks the goals in a scene by following each sweep as `poise path` does, with certificates at all of its points;
/// extremes over ranges are located between the points. Shares nothing with the search but the goals.
GoalCheck check_goals(const GoalProblem& problem, const Scene& scene, const std::vector<int>& rows,
                      const std::atomic<bool>* interrupt = nullptr);

/// What a quantity does along its sweep, for charts: values of what is varied and of the quantity, SI.
struct GoalCourse {
  std::vector<double> at, value;
};
GoalCourse course_of(const GoalProblem& problem, const DesignGoal& goal, const Scene& scene);

}  // namespace poise
