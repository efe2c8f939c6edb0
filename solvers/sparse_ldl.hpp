#pragma once

#include <vector>

namespace poise::solvers {

/// Factors L D L^T of a sparse symmetric matrix, D diagonal, whose pattern is analysed once (SuiteSparse AMD and LDL).
/// There is no pivoting: the matrix should be definite, quasi-definite, or not far from it. Only analyse() allocates.
class SparseLdl {
 public:
  /// Orders a matrix of that size, given by its entries (row[e], column[e]), each pair once or more often, in either
  /// triangle. On return row[e] is the place of entry e in values(), the same for duplicate entries; `column` is
  /// consumed.
  void analyse(int size, std::vector<int>& row, std::vector<int>& column);

  /// To be filled before factor(); duplicate entries are summed.
  std::vector<double>& values() { return value_; }

  /// False if a pivot is zero or not finite.
  bool factor();
  /// Number of negative pivots of the last factors, equal to the number of negative eigenvalues (Sylvester).
  int negative() const { return negative_; }
  /// Ratio of their largest to their smallest pivot, in amount; 1 if there is none.
  double spread() const { return spread_; }

  /// Overwrites x, the right-hand side, with the solution.
  void solve(std::vector<double>& x);

 private:
  void order(const std::vector<int>& first, std::vector<int>& index);
  std::vector<int> permute(const std::vector<int>& first, const std::vector<int>& index);
  void find_fill();

  int size_ = 0;
  int negative_ = 0;
  double spread_ = 1.0;
  std::vector<int> order_, first_, index_;  // upper triangle, permuted, by columns
  std::vector<int> l_first_, parent_, l_count_, l_index_, stack_, flag_;
  std::vector<double> value_, l_value_, d_, work_;
};

}  // namespace poise::solvers
