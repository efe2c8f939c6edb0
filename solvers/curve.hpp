#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "solvers/parametric_problem.hpp"

namespace poise::solvers {

/// A constraint row that holds as an equation: an equality, or an inequality at one of its bounds.
struct ActiveRow {
  int row = 0;
  bool upper = false;
};

/// A point z = (x, y, p) of a curve, with its derivative by arclength s in (x, p):  |x'|^2 + p'^2 = 1.
struct CurvePoint {
  Eigen::VectorXd z, tangent;
  /// Sign of the determinant of the equations bordered by the tangent: it changes at simple branch points only.
  int orientation = 0;
  /// Second derivative of z by arclength, to some 7 digits, for prediction and interpolation.
  Eigen::VectorXd bend;
};

/// The curve of stationary points for given active rows,
///
///   R(z) = ( F(x, p) + J(x, p)^T y,  c_r(x, p) - b_r(p) ) = 0,   z = (x, y, p), y one for each active row,
///
/// n + m equations in N = n + m + 1 unknowns. Every linear system is the Jacobian of R bordered by one row, which is
/// regular at folds too. Dense up to `dense_limit` unknowns, beyond by sparse LU of SuiteSparse's kind (Eigen) with a
/// border of one entry (W. C. Rheinboldt, "Numerical analysis of continuation methods for nonlinear structural
/// problems", Computers & Structures 13, 1981).
class Curve {
 public:
  static constexpr int dense_limit = 50;      ///< unknowns up to which the equations are factored as dense
  static constexpr int spectrum_limit = 400;  ///< unknowns up to which null spaces are computed
  // Of steps of Newton's method, also on curves of folds.
  static constexpr double small_step = 3e-9;     ///< after which the error is about its square
  static constexpr double rounding_step = 1e-7;  ///< steps that no longer decrease but are below it are rounding errors
  static constexpr double farthest = 1.0;        ///< of one step

  /// `problem` must outlive this. The rows should be independent.
  Curve(ParametricProblem& problem, std::vector<ActiveRow> active);
  ~Curve();
  Curve(const Curve&) = delete;
  Curve& operator=(const Curve&) = delete;

  int unknowns() const { return size_; }
  int variables() const { return n_; }
  bool symmetric() const { return problem_.symmetric(); }
  const std::vector<ActiveRow>& active() const { return active_; }

  /// Product of (x, p) parts; y does not count.
  double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  double norm(const Eigen::VectorXd& a) const;

  struct Correction {
    bool converged = false;
    double first = 0.0;  ///< norm of the first step
    int steps = 0;
  };
  /// Newton's method on R(z) = 0 in the plane through z normal to `row`. A last step of at most `small_step` counts as
  /// converged: the error is then about its square.
  Correction correct(Eigen::VectorXd& z, const Eigen::VectorXd& row);
  /// The same on the sphere of that radius round `centre`, from a point on it.
  Correction correct_on_sphere(Eigen::VectorXd& z, const Eigen::VectorXd& centre, double radius);

  /// Newton's method with the parameter held, kept away from solutions that are known: each step is divided by
  /// 1 - step . grad log M,  M(x) = product of (1 / |x - x_k|^2 + 1)  (deflation: P. E. Farrell, A. Birkisson, S. W.
  /// Funke, "Deflation techniques for finding distinct solutions of nonlinear partial differential equations", 2015).
  /// False if it does not converge in `steps`.
  bool deflate(Eigen::VectorXd& z, const std::vector<Eigen::VectorXd>& known, int steps);

  /// Sets tangent and orientation of a point that correct() has just found, by its last factors; the tangent's product
  /// with `like`, the row it was corrected with, is positive. False if the equations are singular there.
  bool differentiate(CurvePoint& point, const Eigen::VectorXd& like);
  /// Sets both by factors at the point itself.
  bool differentiate_at(CurvePoint& point, const Eigen::VectorXd& like);

  /// Sets CurvePoint::bend by differences of R along the tangent, with the factors of differentiate().
  void estimate_bend(CurvePoint& point);
  /// Second derivative of z by arclength at a point with its tangent; exact third derivatives of energy and
  /// constraints.
  Eigen::VectorXd bend(const CurvePoint& point);

  /// Negative eigenvalues of K on the null space of the active rows, real ones of an unsymmetric K; -1 if unknown.
  int negative_directions(const Eigen::VectorXd& z);

  /// Values of the constraint rows at z less their lower and upper bounds, and the derivatives along the tangent.
  struct Room {
    double value, lower, upper;  ///< the row's, and its distances from the bounds, positive within them
    double rate, lower_rate, upper_rate;
  };
  /// Of the inequalities, in their order.
  void rooms(const CurvePoint& point, std::vector<Room>& out);

  /// Whether the equations, or a bound, change with the parameter at z, in the first derivative.
  bool depends_on_parameter(const Eigen::VectorXd& z);
  /// The largest of the equalities that are not among the active rows, at z.
  double largest_left_out(const Eigen::VectorXd& z);

  /// w with  w^T (dR/dz; row) = (0, .., 0, 1): where a point is determined by R(z) = 0 and a condition of gradient
  /// `row`, errors (e, f) of both move its parameter by -w^T (e, f). At a fold `row` is the tangent, without its y.
  Eigen::VectorXd parameter_sensitivity(const Eigen::VectorXd& z, const Eigen::VectorXd& row);
  /// Gradient by z of an inequality's value less its lower or upper bound.
  Eigen::VectorXd gap_gradient(const Eigen::VectorXd& z, int inequality, bool upper);
  /// z' = (x, y, p) for (x, p) parts alone.
  Eigen::VectorXd without_multipliers(Eigen::VectorXd z) const;

  /// Basis of the null space of dR/dz at z, orthonormal columns, by singular values below `tolerance` times the
  /// largest; at least `least` columns. With `along` also those below it times the rate of dR/dz along this direction:
  /// where several curves cross, all singular values may vanish. Dense.
  Eigen::MatrixXd null_vectors(const Eigen::VectorXd& z, double tolerance, int least,
                               const Eigen::VectorXd* along = nullptr);

  /// Moves z to the branch point near it, where dR/dz loses rank by one, by Newton's method on
  ///   R(z) + b psi = 0,   g_1(z) = g_2(z) = 0,
  /// g the vector that is zero exactly where rank is lost (W. Govaerts, "Numerical methods for bifurcations of
  /// dynamical equilibria", 2000, chapter 4). Returns the norm of the last step, infinity if it diverges. Dense.
  double find_branch_point(Eigen::VectorXd& z);

  /// R(z) and dR/dz, whose last row is zero. Dense.
  void equations(const Eigen::VectorXd& z, Eigen::VectorXd& residual, Eigen::MatrixXd& matrix);
  /// Derivative of dR/dz along u at z, exact: d/de dR/dz(z + e u). Dense.
  Eigen::MatrixXd second(const Eigen::VectorXd& z, const Eigen::VectorXd& u);

  int evaluations() const { return evaluations_; }

 private:
  struct Factors;
  void evaluate(const Eigen::VectorXd& z, bool with_tangent);
  void residual(const Eigen::VectorXd& z);
  // dR/dz, the last row left out.
  void fill(Eigen::MatrixXd& matrix) const;
  template <class Put>
  void entries(Put put) const;
  bool factor(const Eigen::VectorXd& row);
  int sign() const;
  void solve(Eigen::VectorXd& b);
  Correction iterate(Eigen::VectorXd& z, const Eigen::VectorXd* row, const Eigen::VectorXd* centre, double radius);

  ParametricProblem& problem_;
  std::vector<ActiveRow> active_;
  std::vector<int> place_;  // per constraint row: its index among the active ones, or -1
  int n_, m_, size_;
  bool dense_;
  int evaluations_ = 0;
  std::vector<double> values_, by_p_, tangent_, y_;
  Eigen::VectorXd residual_, step_, right_, row_;
  std::unique_ptr<Factors> factors_;
};

}  // namespace poise::solvers
