#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "design/goals/design_numbers.hpp"
#include "design/goals/goal_problem.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "statics/quantities/numbered_equations.hpp"

namespace poise {

/// Values of quantities at the positions of a sweep, SI, and their derivatives by the parts of the variables.
struct SweepValues {
  Eigen::MatrixXd value;            ///< positions x quantities; not a number where one is undefined
  std::vector<Eigen::MatrixXd> by;  ///< of each position: quantities x variables
};

/// What evaluations have cost.
struct EvaluationCounts {
  long evaluations = 0;  ///< of all positions of a sweep
  long followed = 0;     ///< of these: from the positions of the one before, by Newton's method
  long paths = 0;        ///< by following the path anew
};

/// The positions of a sweep as numbers change. Bodies are cut free (NumberedEquations): with z the places of the bodies
/// and all efforts, R(z, p) = 0. Once a path has been followed, positions of the next choice of numbers are found from
/// the last ones by Newton's method, with the same stops acting; where that fails, or stops come on or off, the path is
/// followed anew. Derivatives are those of the implicit function theorem,
///
///   dQ/du = Q_p p_u + Q_z z_u,   R_z z_u = -R_p p_u.
///
/// Refers to the problem.
class SweepPositions {
 public:
  SweepPositions(const GoalProblem& problem, int sweep, std::vector<SoughtQuantity> of);

  const std::vector<double>& at() const { return at_; }
  /// False where not all positions are reached; `why` then says so in one sentence.
  bool evaluate(const DesignPoint& point, bool with_derivatives, SweepValues& out, std::string& why);
  /// Forgets the positions, so that the next evaluation follows the path anew.
  void forget() { spots_.clear(); }
  /// After a failure: the stop that a position would overrun, where the drive alone decides the pose, so that no other
  /// numbers but those of the stop's bodies and limits matter; -1 of other failures.
  int blocking_stop() const { return blocking_; }
  const EvaluationCounts& counts() const { return counts_; }
  void set_interrupt(const std::atomic<bool>* interrupt) { interrupt_ = interrupt; }

 private:
  struct Spot {
    NumberedEquations equations;
    std::vector<double> z;
    Eigen::MatrixXd z_by;  // by the parts, at the last evaluation with derivatives; else empty
  };
  bool is_at_rest() const { return sweep_->along.empty(); }
  VariedScene varied_in(Scene scene) const;
  bool follow_path(const DesignPoint& point, std::string& why);
  std::string where_it_ends(const Path& found, std::size_t missing) const;
  bool follow_rest(const DesignPoint& point, std::string& why);
  void place(const StaticModel& model, const std::vector<double>& x, std::vector<int> active,
             const std::vector<double>& p);
  std::vector<double> numbers_at(const DesignPoint& point, double at) const;
  DesignNumbers::Slopes slopes_at(const DesignPoint& point, double at, const std::vector<double>& p) const;
  bool improve(Spot& spot, const std::vector<double>& p) const;
  /// The stop that comes on or off there; -1 where none does.
  int changed_stop(const Spot& spot, const std::vector<double>& p) const;
  bool is_determined(const Spot& spot) const;
  /// A stop on the driven measure itself, which the drive holds already.
  bool is_on_drive(int stop) const;
  bool find_positions(const DesignPoint& point, const std::vector<std::vector<double>>& numbers, bool anew,
                      std::string& why);
  void derive(Spot& spot, const std::vector<double>& p, const DesignNumbers::Slopes& slopes) const;
  void read(const Spot& spot, const std::vector<double>& p, const DesignNumbers::Slopes& slopes, bool with_derivatives,
            std::size_t k, SweepValues& out) const;

  const GoalProblem* problem_;
  const Sweep* sweep_;
  std::vector<SoughtQuantity> of_;
  std::vector<double> at_;
  std::optional<VariedScene> varied_;  // of the scene as given
  Scales scales_{};
  std::optional<DesignNumbers> numbers_;
  std::vector<int> loads_;  // places in p of all loads, where a factor of them varies
  std::vector<Spot> spots_;
  Eigen::VectorXd last_parts_;
  std::vector<int> last_rows_;
  int blocking_ = -1;
  EvaluationCounts counts_;
  const std::atomic<bool>* interrupt_ = nullptr;
};

}  // namespace poise
