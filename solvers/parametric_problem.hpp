#pragma once

#include <span>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// The conditions of a stationary point as functions of one parameter p:
///
///   F(x, p) + J(x, p)^T y = 0,   c_r(x, p) = 0 or a bound b_r(p),   J = dc/dx.
///
/// Rows 0 .. equalities()-1 of c must be zero, the others lie between bounds. Values come in one vector, so that those
/// of two parameters can be combined:  [F (n), c (rows), J (entries of jacobian_pattern()), lower, upper
/// (inequalities)].
class ParametricProblem {
 public:
  virtual ~ParametricProblem() = default;

  virtual int variables() const = 0;
  virtual int equalities() const = 0;
  virtual int rows() const = 0;
  virtual bool symmetric() const = 0;  ///< F is a gradient
  virtual const Pattern& jacobian_pattern() const = 0;
  /// As Problem::tangent_pattern().
  virtual const Pattern& tangent_pattern() const = 0;

  /// Values at (x, p), and, where `by_p` is not empty, their derivatives by p.
  virtual void evaluate(std::span<const double> x, double p, std::span<double> values, std::span<double> by_p) = 0;
  /// K = dF/dx + sum_r y_r d2 c_r/dx2 at (x, p), one y for each row.
  virtual void tangent(std::span<const double> x, double p, std::span<const double> y, std::span<double> values) = 0;
  /// Derivatives along (u, v, w) of x, y, p: of the values, of their derivatives by p, and of K.
  virtual void change(std::span<const double> x, double p, std::span<const double> y, std::span<const double> u,
                      std::span<const double> v, double w, std::span<double> values, std::span<double> by_p,
                      std::span<double> tangent) = 0;

  int inequalities() const { return rows() - equalities(); }
  // Places in the vector of values.
  int first_row() const { return variables(); }
  int first_entry() const { return first_row() + rows(); }
  int first_lower() const { return first_entry() + jacobian_pattern().size(); }
  int first_upper() const { return first_lower() + inequalities(); }
  int values() const { return first_upper() + inequalities(); }
};

}  // namespace poise::solvers
