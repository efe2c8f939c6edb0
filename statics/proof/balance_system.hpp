#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "solvers/regular_set.hpp"
#include "statics/model/ball_mechanism.hpp"

namespace poise {

/// Which of the equations of equilibrium are kept: constraint rows with the values they must have (zero, or the bound
/// of an active stop), and coordinates that are fixed where they are, so that their equation of balance is left out.
struct KeptEquations {
  std::vector<int> rows;
  std::vector<char> at_upper;  ///< per row: of a stop, its upper bound
  std::vector<int> fixed;
};

/// The equations of equilibrium for given active rows, as a square system in z = (x, y),
///
///   F_i(x) + sum_r y_r d c_r / d x_i = 0   for every coordinate that is not fixed
///   c_r(x) - b_r = 0                       for every kept row
///
/// with proofs about its solutions in ball arithmetic.
class BalanceSystem {
 public:
  /// `rounding`: for all scenes whose numbers round to those of the scene.
  BalanceSystem(const BallMechanism& mechanism, KeptEquations kept, bool rounding = false);

  struct Solution {
    /// Exactly one solution has its coordinates in `box`, and it is in q, y. Every matrix of first derivatives in the
    /// box is regular.
    bool proved = false;
    std::vector<Ball> q;     ///< all coordinates, fixed ones exact
    std::vector<Ball> y;     ///< per kept row
    std::vector<Ball> box;   ///< coordinates within `reach` of the point that q was refined to
    int unstable = 0;        ///< negative eigenvalues of the reduced Hessian; only without follower loads
    int stiffness_sign = 1;  ///< of the determinant of the reduced stiffness
    std::shared_ptr<const solvers::RegularSet> matrix;
  };

  /// Refines x, y by Newton's method and proves, with balls of `reach` times max(1, |x|) around it. Not proved if the
  /// matrix is not proved regular there, or if the iteration leads farther than `farthest` from x.
  Solution prove(const std::vector<Ball>& x, const std::vector<Ball>& y, double reach, double farthest) const;

  /// Where the fixed coordinates lie `change` (of all coordinates, 0 of others) from a place where the kept rows hold:
  /// the place where they hold that is joined with `at` by a curve of such places on which their derivatives by the
  /// other coordinates are regular. At each fixed value between, exactly one lies within half of the way there from the
  /// straight line, by the interval Newton operator on boxes around all of that line. None where that is not proved, or
  /// if the kept rows are not as many as the coordinates that are not fixed.
  std::optional<std::vector<Ball>> follow(const std::vector<Ball>& at, const std::vector<double>& change) const;

  /// Per fixed coordinate the rates of all coordinates with which the kept rows hold while it moves at a rate of 1 and
  /// the other fixed ones rest. None where the kept rows are not proved to determine the others.
  std::optional<std::vector<std::vector<Ball>>> motions(const std::vector<Ball>& x) const;
  /// Multipliers of the kept rows of least |F + J^T y|, not enclosed; none if the rows are dependent.
  std::optional<std::vector<Ball>> multipliers(const std::vector<Ball>& x) const;
  /// Left sides of all equations at enclosures of x and y.
  std::vector<Ball> residual(const std::vector<Ball>& x, const std::vector<Ball>& y) const;
  /// left^T M right, M the matrix of their derivatives by z.
  Ball product(const std::vector<Ball>& x, const std::vector<Ball>& y, const std::vector<Ball>& left,
               const std::vector<Ball>& right) const;
  /// F_i + (J^T y)_i of all coordinates: zero but for fixed ones.
  std::vector<Ball> forces(const std::vector<Ball>& x, const std::vector<Ball>& y) const;
  /// J u of the kept rows.
  std::vector<Ball> rates(const std::vector<Ball>& x, const std::vector<Ball>& u) const;
  /// Rate of the measure of a force element.
  Ball measure_rate(int element, const std::vector<Ball>& x, const std::vector<Ball>& u) const;
  /// All constraint rows at an enclosure of x.
  std::vector<Ball> constraints(const std::vector<Ball>& x) const;
  /// Measures of the force elements.
  std::vector<Ball> measures(const std::vector<Ball>& x) const;

  int unknowns() const { return free_ + static_cast<int>(kept_.rows.size()); }

 private:
  struct Point {
    std::vector<Planar<Ball>> pose;
    std::vector<Ball> jacobian;
  };
  Point place(const std::vector<Ball>& x) const;
  std::vector<solvers::RegularSet::Entry> entries(const std::vector<Ball>& x, const std::vector<Ball>& y) const;
  // Gives [0 J^T; J 0] of the kept rows and of the coordinates that are not fixed.
  std::vector<solvers::RegularSet::Entry> derivatives(const std::vector<Ball>& x) const;
  std::vector<Ball> left_of_rows(const std::vector<Ball>& x) const;

  const Mechanism<Ball>& mechanism_;
  KeptEquations kept_;
  bool rounding_;
  int free_ = 0;
  std::vector<int> unknown_;   // per coordinate: its unknown, or -1 if it is fixed
  std::vector<int> equation_;  // per constraint row: its equation, or -1
};

}  // namespace poise
