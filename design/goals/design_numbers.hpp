#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "design/goals/goal_problem.hpp"
#include "model/number_list.hpp"
#include "model/scales.hpp"

namespace poise {

/// A choice of numbers: each variable as the part of its range, 0 to 1, and a row of each catalogue.
struct DesignPoint {
  Eigen::VectorXd parts;
  std::vector<int> rows;
};

/// Values of all numbers that are chosen or follow from such, SI: variables, ties, numbers of catalogues.
struct ChosenValue {
  const ParameterRow* row = nullptr;
  double value = 0.0;
};
std::vector<ChosenValue> chosen_values(const GoalProblem& problem, const DesignPoint& point);

/// Derivatives of the tied number of that index by the parts of the variables that it follows from, SI: variable and
/// derivative. What has no derivative is left out.
std::vector<std::pair<int, double>> slopes_of_tie(const GoalProblem& problem, const DesignPoint& point,
                                                  std::size_t tie);

/// The scene with these. Throws InputError where numbers contradict each other.
Scene scene_at(const GoalProblem& problem, const DesignPoint& point);

/// The scene's own numbers, moved into their ranges; of each catalogue the row that is nearest.
DesignPoint own_point(const GoalProblem& problem);

/// How the numbers p of a NumberList follow from a choice.
class DesignNumbers {
 public:
  /// `scene` is that of the problem, or has a stop more, which holds what is driven.
  DesignNumbers(const GoalProblem& problem, const Scene& scene, const Scales& scales);

  const std::shared_ptr<const NumberList>& list() const { return list_; }
  /// p with what is chosen, before dependent numbers have followed it: NumberList::follow() once.
  std::vector<double> at(const DesignPoint& point) const;
  /// dp / d(part) of each variable: places in p and derivatives, where p is at() and has followed.
  using Slopes = std::vector<std::vector<std::pair<int, double>>>;
  Slopes slopes(const DesignPoint& point, const std::vector<double>& p) const;

 private:
  const GoalProblem* problem_;
  Scales scales_;
  std::shared_ptr<const NumberList> list_;
  std::vector<int> rows_;  // in p, of chosen_values()
};

}  // namespace poise
