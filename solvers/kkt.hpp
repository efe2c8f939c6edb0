#pragma once

#include <memory>
#include <span>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// The linear algebra of a Newton step on  F(x) + J^T y = 0,  c(x) = 0:
///
///   [ K + shift I   J^T ] [ d ]     [ F ]
///   [ J              0  ] [ y ] = - [ c ]
///
/// with J the active rows of the constraint Jacobian. Two implementations: null space (dense, rank-revealing, K
/// symmetric or not) and sparse LDL^T (K symmetric). Buffers are sized once; no call allocates.
class Kkt {
 public:
  virtual ~Kkt() = default;

  /// Sets the Jacobian values of an evaluated point and the active rows (one flag per constraint row). False if they
  /// cannot be used: rows assumed to be independent are not.
  virtual bool set_jacobian(const Evaluation& at, const std::vector<char>& active) = 0;

  /// True when active rows are dependent at the point of the Jacobian, so that some were left out.
  virtual bool redundant() const = 0;

  /// Whether multipliers() determines them accurately from a point alone; otherwise those of the last step are better.
  virtual bool determines_multipliers() const = 0;
  /// y, zero for inactive rows, with least |F + J^T y|, or if determines_multipliers() with F + J^T y = 0 in as many
  /// entries as J has independent rows. May overwrite the factors.
  virtual void multipliers(std::span<const double> field, std::span<double> y) = 0;
  /// multipliers(), and the residual F + J^T y with them.
  virtual void balance(std::span<const double> field, std::span<double> y, std::span<double> residual) = 0;
  /// out = F + J^T y, y zero for inactive rows.
  virtual void unbalanced(std::span<const double> field, std::span<const double> y, std::span<double> out) const = 0;

  enum class Factors { positive, indefinite, singular };
  /// Takes the values of K and factors the system; returns whether K is positive definite on the null space of J. For
  /// an unsymmetric K only `singular` or not is meaningful.
  virtual Factors factor_tangent(std::span<const double> values) = 0;
  /// The same for K = identity: solve() then gives the minimum-norm d with J d = -c.
  virtual Factors factor_identity() = 0;
  /// The same for K + shift I with the last K, shift > 0.
  virtual Factors factor_shifted(double shift) = 0;

  /// d from the current factors; an empty field or c counts as zero.
  virtual void solve(std::span<const double> field, std::span<const double> c, std::span<double> d) = 0;
  /// y of the last solve(), with the same field. With the residual F + J^T y0 for the field it is the correction of y0:
  /// preferable, because the error of an inexact solution then vanishes with the correction.
  virtual void solved_multipliers(std::span<const double> field, std::span<double> y) = 0;
  /// Some d with J d = -c from the current factors: brings a point back to the constraints.
  virtual void restore(std::span<const double> c, std::span<double> d) = 0;
};

/// Null space by coordinate partitioning; see null_space.cpp. Unless `rank_revealing`, every row is assumed to be
/// independent.
std::unique_ptr<Kkt> make_null_space(const Problem& problem, bool rank_revealing = true);

/// Sparse LDL^T analysed once; see sparse_kkt.cpp. The problem must have an objective (symmetric tangent).
std::unique_ptr<Kkt> make_sparse_kkt(const Problem& problem);

/// Inertia of the tangent on the null space of the active rows, by the signs of sparse LDL^T pivots (Sylvester).
struct Inertia {
  bool known = false;  ///< false if the factorization broke down
  int negative = 0;
};

/// At x, with least-squares multipliers, `active` one flag per constraint row.
Inertia inertia_at(const Problem& problem, const std::vector<double>& x, const std::vector<char>& active);

}  // namespace poise::solvers
