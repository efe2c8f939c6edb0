#pragma once

#include <vector>

#include <Eigen/Core>

#include "statics/all_equilibria/private/merged_mechanism.hpp"

namespace poise {

/// Newton's operator in interval arithmetic for equilibria in a box X of scaled coordinates:
///
///   f(x, y) = (F(x) + J(x)^T y, c(x) - b) = 0     of n coordinates x and the multipliers y of m rows c with values b,
///   f(x)    = c(x) - b = 0                        where there are as many rows as coordinates.
///
/// For two solutions, or one and the middle z_0 = (x_0, y_0),  f(z) - f(z_0) = A (z - z_0)  with rows of
/// A = [H(X, y_0) J(X)^T; J(X) 0], since y enters linearly. With C >= |I - R A| and a weighted norm |C|_w < 1, every
/// solution with x in X has |z - z_0| <= u for u = |R f| + C u; and if u is within X there is one, and no other.
///
/// Needs solvers::RoundingUp. Nothing is kept between boxes but memory.
class NewtonOperator {
 public:
  /// The first `m` of `rows` are the equations, with the values `bounds`; `equation` has their places in `rows` by
  /// constraint row, -1 of others. All arguments must outlive this; rows may change their order between boxes.
  NewtonOperator(const Mechanism<double>& plain, MergedMechanism& mechanism, const std::vector<int>& rows,
                 const std::vector<double>& bounds, const std::vector<int>& equation, int m);

  /// Whether the rows alone determine x, so that there are no multipliers.
  bool is_square() const { return is_square_; }

  /// Begins with a box, with z_0 refined from its middle `x` and multipliers `y` while it stays near, and with the
  /// inverse R of its matrix. False if that is singular.
  bool begin(const std::vector<Interval>& box, const std::vector<double>& x, const std::vector<double>& y);
  /// Bounds by u the distance from z_0 of all solutions within reach of it. False if the operator is no contraction
  /// there, so that nothing is known.
  bool apply();
  /// Looks for a solution further away, where apply() found none to exist: what rounding leaves open may reach further
  /// than a box that was narrowed as far as that.
  void reach_further();

  /// Whether there is a solution, and no other within reach.
  bool exists() const { return exists_; }
  const std::vector<double>& x() const { return x_; }  ///< of z_0
  /// Where coordinate i, or multiplier k, of all solutions within reach is.
  Interval coordinate(int i) const { return Interval(x_[i]) + Interval(-u_[i], u_[i]); }
  Interval multiplier(int k) const { return Interval(y_[k]) + Interval(-u_[n_ + k], u_[n_ + k]); }

 private:
  void refine(const std::vector<Interval>& box);
  void linearize();
  void evaluate_middle();
  void enclose_matrix();
  void precondition();
  bool bound_by_weights();
  void shrink();
  void contract(const std::vector<double>& v, bool with_step, std::vector<double>& out) const;
  // The equation that an entry of the Jacobian is in, or -1.
  int equation_of(std::size_t jacobian_entry) const {
    const int k = equation_[plain_.jacobian_row()[jacobian_entry]];
    return k < m_ ? k : -1;
  }
  Interval& entry(int i, int j) { return a_[static_cast<std::size_t>(i) * size_ + j]; }

  const Mechanism<double>& plain_;
  MergedMechanism& mechanism_;
  const std::vector<int>& rows_;
  const std::vector<double>& bounds_;
  const std::vector<int>& equation_;
  int n_, m_;
  bool is_square_;
  int size_, first_;  // equations, and the first of them that is a row

  std::vector<double> x_, y_;  // z_0
  bool is_near_ = false;       // it stayed near the middle when it was refined
  Eigen::MatrixXd inverse_;    // R
  std::vector<Interval> f_;    // f(z_0)
  std::vector<double> reach_;  // half widths of X around x_0
  std::vector<double> u_;
  bool exists_ = false;

  // Workspace: at z_0 in double.
  std::vector<double> x_start_, y_start_;
  std::vector<Planar<double>> plain_pose_;
  std::vector<double> plain_jacobian_, plain_tangent_, plain_constraint_, plain_multipliers_;
  Eigen::VectorXd residual_;
  Eigen::MatrixXd matrix_;
  // In intervals.
  std::vector<Interval> around_;
  std::vector<Planar<Interval>> pose_;
  std::vector<Interval> jacobian_, constraint_, tangent_, multipliers_;
  std::vector<Interval> a_, row_;
  std::vector<double> contraction_;  // C
  std::vector<double> first_step_;   // |R f|
  std::vector<double> weight_, next_;
};

}  // namespace poise
