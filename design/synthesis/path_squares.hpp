#pragma once

#include <atomic>
#include <span>
#include <vector>

namespace poise {

/// Sums of squares of many points that share unknowns x, each with one unknown t of its own at most:
///
///   S(x, t) = sum over points |r(x, t_i)|^2 + |e(x)|^2.
class PointSquares {
 public:
  virtual ~PointSquares() = default;
  virtual int shared() const = 0;         ///< the number of unknowns x
  virtual int points() const = 0;         ///< the number of points
  virtual int rows() const = 0;           ///< residuals of each point
  virtual int more_rows() const = 0;      ///< the number of residuals e
  virtual bool own(int point) const = 0;  ///< t of the point is an unknown, not a given number

  /// Residuals of a point and their derivatives, by x row by row; false where they are not defined.
  virtual bool evaluate(int point, std::span<const double> x, double t, std::span<double> residuals,
                        std::span<double> by_shared, std::span<double> by_own) const = 0;
  /// The same of the residuals e.
  virtual bool evaluate_more(std::span<const double> x, std::span<double> residuals,
                             std::span<double> by_shared) const = 0;
};

struct SquaresOptions {
  int iterations = 200;
  double enough = 0.0;     ///< ends where S is not larger
  double hopeless = -1.0;  ///< ends where S falls slowly and is still larger than this; < 0: never
  const std::atomic<bool>* interrupt = nullptr;
};

struct SquaresResult {
  std::vector<double> x, t;
  double sum = 0.0;        ///< S; infinite where it is not defined at the start
  bool converged = false;  ///< the last steps were below 1e-9 of the unknowns, or S is enough
  int iterations = 0;
};

/// The method of Levenberg and Marquardt with the damping of Nielsen (K. Madsen, H. B. Nielsen, O. Tingleff, "Methods
/// for non-linear least squares problems", 2004, section 3.2). The unknowns of the points are eliminated one by one by
/// Householder reflections, so that a step takes the time of points x shared^2.
SquaresResult least_squares_of_points(const PointSquares& problem, std::vector<double> x, std::vector<double> t,
                                      const SquaresOptions& options = {});

}  // namespace poise
