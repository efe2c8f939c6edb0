#pragma once

#include <atomic>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "design/goals/design_numbers.hpp"
#include "design/goals/goal_problem.hpp"
#include "design/goals/sweep_positions.hpp"

namespace poise {

/// A value that a goal is about, SI, at a value of what is varied, and its derivatives by the parts of the variables.
struct GoalTerm {
  double at = 0.0, value = 0.0;
  Eigen::RowVectorXd by;
};

/// A condition  c <= 0, or of an equation c = 0,  over the size of what it is about.
struct GoalLimit {
  int goal = -1;  ///< -1: of a length that a catalogue limits
  double at = 0.0, c = 0.0;
  Eigen::RowVectorXd by;
  bool is_equation = false;
  double kept_to = 1e-10;  ///< |c| of an equation that is met
};

/// Terms of an aim, over its size: the aim is the largest of their values as small as possible, of a flat quantity the
/// largest difference.
struct GoalAim {
  int goal = 0;
  std::vector<GoalTerm> terms;  ///< of a curve: distances from it, of either sign
};

/// Goals at a choice of numbers.
struct GoalValues {
  std::vector<GoalLimit> limits;
  std::vector<GoalAim> aims;
  std::vector<std::vector<GoalTerm>> terms;  ///< of each goal, as they are
};

/// Evaluates goals with exact derivatives. Refers to the problem; one for each thread.
class GoalEvaluation {
 public:
  explicit GoalEvaluation(const GoalProblem& problem);

  /// By how much the values of quantities over ranges differ from those over the positions, SI, of each goal: what a
  /// check has found; none by default.
  void correct(std::vector<double> by) { corrections_ = std::move(by); }
  /// Amounts by which limits are tightened, SI, of each goal at each of its terms; none by default.
  using Tightening = std::vector<std::vector<std::pair<double, double>>>;  ///< of each goal: value varied, amount
  void tighten(Tightening by) { tighter_ = std::move(by); }
  void set_interrupt(const std::atomic<bool>* interrupt);
  void forget();

  /// False where positions are not reached, or a quantity is undefined: why() says which, in one sentence.
  bool evaluate(const DesignPoint& point, bool with_derivatives, GoalValues& out);
  const std::string& why() const { return why_; }
  /// After a failure: the force element whose own numbers alone let a stop of it block a sweep; -1 of other failures.
  int blocking_element() const;
  EvaluationCounts counts() const;
  /// What a goal's quantity is measured by, SI.
  double size_of(int goal) const { return sizes_[static_cast<std::size_t>(goal)]; }

 private:
  struct OfGoal {
    std::vector<int> asked;  // indices of the sweep's quantities: the goal's own, or those that extremes are of
  };
  int ask(int sweep, const SoughtQuantity& of);
  void ask_inner(int sweep, const SoughtQuantity& of, OfGoal& out);
  /// The value of a sweep's quantity at its position k.
  GoalTerm term_at(std::size_t sweep, std::size_t k, Eigen::Index asked) const;
  GoalTerm extreme_over(const DesignGoal& goal, SoughtQuantity::Kind kind, int asked) const;
  GoalTerm mean_over(const DesignGoal& goal, int asked) const;
  GoalTerm over_range(const DesignGoal& goal, const SoughtQuantity& of, const std::vector<int>& asked,
                      std::size_t& next) const;
  bool put_terms(std::size_t goal, const DesignPoint& point, bool with_derivatives, GoalValues& out);
  bool put_fold(std::size_t goal, const DesignPoint& point, bool with_derivatives, GoalValues& out);
  double tightened_at(std::size_t goal, double at) const;
  void put_limits(std::size_t goal, const std::vector<GoalTerm>& terms, GoalValues& out) const;
  void put_equilibrium(std::size_t goal, const std::vector<GoalTerm>& terms, GoalValues& out) const;
  void put_lengths(const DesignPoint& point, GoalValues& out) const;

  const GoalProblem* problem_;
  std::vector<std::vector<SoughtQuantity>> asked_;  // of each sweep
  std::vector<OfGoal> goals_;
  std::vector<std::vector<int>> lengths_;  // of each sweep: those of all catalogues
  std::vector<SweepPositions> sweeps_;
  std::vector<SweepValues> values_;
  std::vector<double> sizes_, corrections_;
  Tightening tighter_;
  bool may_contradict_ = false;  // numbers within their ranges may make no scene
  std::string why_;
};

}  // namespace poise
