#pragma once

#include <array>

#include <Eigen/Core>

#include "solvers/curve.hpp"

namespace poise::solvers {

/// Stationary points of two parameters p and q, as curves of each while the other is held. All have the same x, active
/// rows and y; a curve holds until the next call.
class CurveFamily {
 public:
  virtual ~CurveFamily() = default;
  virtual Curve& first_varies(double q) = 0;
  virtual Curve& second_varies(double p) = 0;
};

/// A point z = (x, y, p, q) of a curve of folds.
struct FoldPlace {
  Eigen::VectorXd z;
  /// dz/ds by arclength of (x, p, q):  |x'|^2 + p'^2 + q'^2 = 1.
  Eigen::VectorXd tangent;
  /// R_u v = 0 and w^T R_u = 0, u = (x, y), each of length 1 in x and of the same sense all along a curve.
  Eigen::VectorXd v, w;
  /// w^T (R_uu v v). Two stationary points meet at a fold where it is not zero, three at a cusp where it changes sign.
  double coefficient = 0.0;
};

/// The curve of folds of stationary points R(x, y, p, q) = 0, where R_u is singular, as the minimally augmented system
///
///   R(z) = 0,   g(z) = 0   with   [R_u  b; c^T  0] (v; g) = (0; 1),   [R_u  b; c^T  0]^T (w; g) = (0; 1),
///   dg/dz = -w^T R_uz v
///
/// with exact second derivatives (W. Govaerts, "Numerical methods for bifurcations of dynamical equilibria", SIAM 2000,
/// chapters 3 and 4). It is regular also at cusps and where p or q turn. b and c are the x of w and v of a point near
/// by. Dense.
class FoldSystem {
 public:
  /// `family` must outlive this.
  explicit FoldSystem(CurveFamily& family);

  int unknowns() const { return size_ + 2; }
  int variables() const { return n_; }

  /// Product of (x, p, q) parts.
  double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  double norm(const Eigen::VectorXd& a) const;

  struct Begin {
    bool converged = false;
    /// w^T R_p and w^T R_q vanish at a distance of at most 2e-5 along v, as by imperfections of rounding: neither p nor
    /// q disturbs a crossing of curves there, and the equations lose rank.
    bool undisturbed = false;
    double distance = 0.0;  ///< gone
  };
  /// Newton's method from place.z, near a fold, in the plane normal to the curve; sets all of `place`.
  Begin begin(FoldPlace& place);

  struct Correction {
    bool converged = false;
    double first = 0.0;  ///< norm of the first step
  };
  /// Newton's method from place.z in the plane normal to `row`, bordered by v and w of `near`; sets all of `place`, in
  /// the sense of `near`.
  Correction correct(FoldPlace& place, const Eigen::VectorXd& row, const FoldPlace& near);

  /// Derivatives of p and of q by errors of R (w^T R_u v = 0 the last of them) at a place where the curve's p and q do
  /// not move, a cusp: errors e move p by -first^T e.
  struct Sensitivity {
    Eigen::VectorXd first, second;
  };
  Sensitivity sensitivity(const FoldPlace& cusp);

  /// Largest entry of R(z).
  double residual(const Eigen::VectorXd& z);

  /// Negative eigenvalues of the second derivative on the null space of the active rows, but for the one that is zero
  /// at a fold; -1 where they are not real. `symmetric`: R_u is.
  int other_negative_directions(const Eigen::VectorXd& z, bool symmetric);

  /// (x, y, p) and (x, y, q) of z.
  Eigen::VectorXd first_part(const Eigen::VectorXd& z) const;
  Eigen::VectorXd second_part(const Eigen::VectorXd& z) const;

 private:
  void evaluate(const Eigen::VectorXd& z);
  void border_by(const Eigen::VectorXd& v, const Eigen::VectorXd& w);
  bool bordered(const Eigen::VectorXd& z, const Eigen::VectorXd& row);

  CurveFamily& family_;
  int n_, size_;
  // At the place last evaluated.
  Eigen::VectorXd r_, by_q_, v_, w_, b_, c_;
  Eigen::MatrixXd a_;       // R_u, R_p
  Eigen::MatrixXd along_;   // R_uu v, R_up v, R_uq v
  Eigen::MatrixXd newton_;  // with dg/dz and the row
  double g_ = 0.0;
};

}  // namespace poise::solvers
