#pragma once

#include <vector>

#include "solvers/ball.hpp"
#include "solvers/ball_factors.hpp"

namespace poise::solvers {

/// A set of matrices A = A_c + D, |D| <= R entry by entry, given by one ball per entry, with a proof that all of them
/// are regular:
///
///   A_c is factored in ball arithmetic (BallFactors), and  kappa >= |A_c^-1 D|  is bounded for all D of the set. With
///   kappa < 1 every A = A_c (I + A_c^-1 D) is regular, the signs of eigenvalues and determinant are those of A_c, and
///   A^-1 b = x + e,  x = A_c^-1 b,  |e| <= kappa / (1 - kappa) |x|.
///
/// Up to `dense_limit` rows kappa is in the maximum norm, from an approximate inverse C in double:
/// |A_c^-1 D| <= | |C| R | / (1 - |I - C A_c|), all rounding bounded (S. M. Rump, "Verification methods", Acta Numerica
/// 2010). Beyond, in the Euclidean norm, kappa = |R| / s: s is a proved lower bound of the singular values of A_c, for
/// if A_c - s I and A_c + s I have equally many negative eigenvalues none lies between -s and s. (If A_c is not
/// symmetric, of [0 A_c^T; A_c 0] in its place.)
class RegularSet {
 public:
  using Entry = BallFactors::Entry;

  /// As BallFactors.
  RegularSet(int size, bool symmetric, const std::vector<Entry>& entries);

  /// All matrices of the set are proved regular.
  bool regular() const { return center_.regular() && kappa_ < 1.0; }
  const BallFactors& center() const { return center_; }
  /// Number of negative eigenvalues of every symmetric matrix of the set, and the sign of every determinant.
  int negative() const { return center_.negative(); }
  int determinant_sign() const { return center_.determinant_sign(); }

  /// Enclosures of A^-1 b for all A of the set and all b of the balls. Needs regular().
  std::vector<Ball> solve(std::vector<Ball> b) const;
  /// A_c^-1 b.
  std::vector<Ball> solve_center(std::vector<Ball> b) const;

  static constexpr int dense_limit = 60;

 private:
  static std::vector<Entry> centers(const std::vector<Entry>& entries);
  void add_effect(const std::vector<double>& radius, std::vector<Ball>& x) const;
  void bound_by_inverse(const std::vector<Entry>& entries);
  void bound_by_shifts(const std::vector<Entry>& entries);
  double least_singular_value(const std::vector<Entry>& entries) const;

  int size_;
  bool symmetric_;
  BallFactors center_;
  double kappa_;
  // Of the maximum norm: its weights, |C| by columns, and the bound of |I - C A_c|.
  std::vector<double> weight_, inverse_;
  double of_center_ = 0.0;
  double least_ = 0.0;  // of the Euclidean norm: s
};

}  // namespace poise::solvers
