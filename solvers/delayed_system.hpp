#pragma once

#include <complex>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace poise::solvers {

/// The linear system
///   x' = A x + B d,   d_i(t) = u_i(t - T_i),   u = C x + D d
/// with n states x, k delayed signals d and their delays T_i > 0, s. Its poles s are the roots of
///   det M(s),   M(s) = [s I - A, -B; -E C, I - E D],   E = diag(exp(-s T_i)).
/// There are infinitely many, of which finitely many are right of any vertical line where D is nilpotent: where no
/// delayed signals follow each other in a circle (J. K. Hale, S. M. Verduyn Lunel, Introduction to functional
/// differential equations, 1993, chapters 1 and 9).
struct DelayedSystem {
  Eigen::MatrixXd a, b, c, d;
  Eigen::VectorXd delays;
};

/// x and its derivative by s, where the system is pushed,
///   x' = A x + B d + b exp(s t),   u = C x + D d + e exp(s t),
/// and answers by  x exp(s t):  x = [I 0] M(s)^-1 [b; E e].
struct ForcedAnswer {
  Eigen::VectorXcd x, by_s;
};
ForcedAnswer forced_answer(const DelayedSystem& system, const std::complex<double>& s, const Eigen::VectorXd& b,
                           const Eigen::VectorXd& e);

/// All poles right of a vertical line.
struct RightmostPoles {
  std::vector<std::complex<double>> poles;  ///< 1/s, the largest real parts first, of a pair the positive imaginary one
  double right_of = 0.0;                    ///< the line, 1/s
};

/// At least `least` poles of a system whose D is nilpotent. First approximations are the eigenvalues of the system with
/// the signals on their way as polynomials through Chebyshev points (D. Breda, S. Maset, R. Vermiglio, Pseudospectral
/// differencing methods for characteristic roots of delay differential equations, SIAM J. Sci. Comput. 27, 2005);
/// Newton's method for det M(s) makes each exact to rounding. That none is missing is counted: the argument of det M(s)
/// along a path around all that can be right of the line turns once for each. None where the counts still differ with
/// the most points.
std::optional<RightmostPoles> rightmost_poles(const DelayedSystem& system, int least);

}  // namespace poise::solvers
