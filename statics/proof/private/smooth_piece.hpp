#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "statics/model/curvature.hpp"
#include "statics/proof/balance_system.hpp"
#include "statics/proof/stability.hpp"

namespace poise {

/// What is proved for one set of active stops and one state of each one-way spring.
struct Finding {
  enum class Kind { none, regular, neutral, degenerate };
  Kind kind = Kind::none;
  BalanceSystem::Solution solution;
  KeptEquations kept;
  int unstable = 0;  ///< directions; with follower loads 1 if the reduced stiffness has a negative determinant
  int freedoms = 0;
  std::vector<int> neutral;  ///< fixed coordinates
  int redundant = 0;         ///< rows left out that repeat others
  bool singular = false;     ///< the rows lose rank
  /// Of kind none: a lower bound of the largest joint force with which bodies can balance near the singular
  /// configuration, in the mechanism's unit of force.
  double least_joint_force = 0.0;
  Stability degenerate = Stability::unknown;
  double spread = 0.0;    ///< by which the solution may be farther away than its enclosure
  std::string why;        ///< nothing is proved, or the kind is degenerate
  bool excluded = false;  ///< proved that there is no equilibrium near
};

/// In double, at a solution: the tangents Z of the kept rows, and the Hessian of the Lagrangian on them.
struct TangentSpace {
  TangentSpace(const Mechanism<double>& mechanism, const Finding& finding);

  std::vector<double> x;
  DensePoint<double> point;
  Eigen::MatrixXd basis;  ///< orthonormal columns
  Eigen::MatrixXd hessian;
};

std::vector<Ball> midpoints(const std::vector<Ball>& balls);
std::vector<double> middles(const std::vector<Ball>& balls);
/// A with  J_r = A J  for a row J_r that is a combination of those of J.
Eigen::VectorXd shares_in(const Eigen::MatrixXd& jacobian, const Eigen::RowVectorXd& row);

/// A mechanism in which every one-way spring either acts, both ways, or does not, and the proofs about its equilibria
/// near a point for given active stops.
class SmoothPiece {
 public:
  using Solution = BalanceSystem::Solution;

  static constexpr double first_reach = 1e-10;  ///< of the box in which an equilibrium is proved to be the only one
  static constexpr double last_reach = 0x1p-50;
  static constexpr long usual_bits = 128;
  static constexpr long many_bits = 320;
  static constexpr double nearly_dependent = 1e-9;  ///< pivots of rows that may repeat others
  static constexpr int dense_limit = 400;  ///< coordinates up to which ranks and spectra are computed in double

  /// Near x, for answers up to `farthest` from it (rad or mechanism sizes). `uncertain`: some numbers of the mechanism
  /// are balls. `balls` must live longer.
  SmoothPiece(const BallMechanism& balls, const std::vector<double>& x, double farthest, bool uncertain = false)
      : balls_(balls), x_(x), start_(x.begin(), x.end()), farthest_(farthest), uncertain_(uncertain) {}

  /// In double, with the laws of the present state of the one-way springs.
  const Mechanism<double>& m() const { return balls_.plain; }
  const BallMechanism& balls() const { return balls_; }
  const std::vector<double>& x() const { return x_; }
  bool is_uncertain() const { return uncertain_; }

  /// All closures, without stops.
  KeptEquations closures() const;

  /// The equilibrium near x: with rows left out that repeat others to within some accuracy of x; with all of them if
  /// the others do not imply them.
  Finding examine(const KeptEquations& kept) const;
  int unstable_directions(const Solution& solution) const;

  Solution solve(const KeptEquations& kept, const std::vector<Ball>& from, double reach) const {
    return solve(kept, from, reach, farthest_);
  }
  /// In smaller and smaller boxes, and to more and more digits.
  Solution solve_closely(const KeptEquations& kept, const std::vector<Ball>& from) const;

  /// Indices into kept.rows of closures that are nearly combinations of other closures, and of stops that nothing moves
  /// that the closures and other stops leave free. Each row counts over the size of the numbers of its loop.
  std::vector<int> dependent_rows(const KeptEquations& kept, double tolerance) const;
  /// Coordinates that may be chosen freely while the kept rows determine the others: fixed ones first.
  std::vector<int> free_coordinates(const KeptEquations& kept) const;
  /// Where closures repeat others to rounding only: for each closure that takes part the greatest gap that is left, in
  /// the mechanism's unit of length, or its growth with the motion; 0 for others. Empty where there are none.
  std::vector<double> open_loops() const;

 private:
  Solution solve(const KeptEquations& kept, const std::vector<Ball>& from, double reach, double farthest,
                 bool rounding = false) const;
  Finding examine_independent(const KeptEquations& kept) const;
  KeptEquations without_stops(const KeptEquations& kept) const;
  // Whether rows that were left out hold to within the rounding of the scene's numbers.
  struct Repeated {
    bool to_rounding = false;
    std::vector<double> gaps;  // of the dropped rows of closures that hold to rounding only, 0 of others
    std::vector<int> loops;    // closures of which some hold to rounding only, and those that they depend on
  };
  Repeated repeated(const KeptEquations& kept, const std::vector<Ball>& at, const KeptEquations& all) const;
  Repeated repeated_everywhere(const Repeated& here, const KeptEquations& kept, const Solution& at,
                               const KeptEquations& all) const;
  // Takes what is found after each step, and the way there.
  using TakeRepeated = std::function<void(const Repeated&, double)>;
  bool repeated_along(const KeptEquations& with_fixed, const Solution& at, const KeptEquations& all,
                      const TakeRepeated& take) const;
  int loop_of(int row) const;
  double least_joint_force(const KeptEquations& kept) const;
  bool examine_singular(Finding& finding, const KeptEquations& all, const std::vector<int>& dropped) const;
  void examine_flat(Finding& finding, const KeptEquations& kept) const;
  bool is_neutral(const KeptEquations& with_fixed, const Eigen::MatrixXd& directions, const Solution& at) const;
  void bracket(Finding& finding, const KeptEquations& kept, int coordinate, bool rounding) const;

  const BallMechanism& balls_;
  std::vector<double> x_;
  std::vector<Ball> start_;
  double farthest_;
  bool uncertain_;
};

}  // namespace poise
