#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "solvers/ball.hpp"

namespace poise::solvers {

/// Proof, by elimination in ball arithmetic, that every matrix of a set is regular, with the signs of its eigenvalues
/// or of its determinant; and enclosures of the solutions of its linear systems.
///
/// The set is given by one ball per entry of a sparse matrix. It is factored as P A P^T = L D U with pivots of one row,
/// or of two where a diagonal entry is too small, in an order of little fill (minimum degree). If no pivot's ball
/// contains zero every matrix of the set has such factors and so is regular. A symmetric one has as many negative
/// eigenvalues as its D (Sylvester's law).
class BallFactors {
 public:
  struct Entry {
    int row, column;
    Ball value;
  };

  /// A of `size` rows from its entries, which are summed where there are several for one place. `symmetric`: of two
  /// entries (i, j) and (j, i) one is given; the set contains all matrices with entries of both in that ball.
  BallFactors(int size, bool symmetric, const std::vector<Entry>& entries);

  /// False if some pivot may be zero, or where the WorkLimit is exceeded: nothing is proved then.
  bool regular() const { return regular_; }
  /// Number of negative eigenvalues of every symmetric matrix of the set; of a set that is given as symmetric.
  int negative() const { return negative_; }
  /// Sign of the determinant of every matrix of the set, 1 or -1.
  int determinant_sign() const { return sign_; }

  /// Overwrites b with an enclosure of all A^-1 b.
  void solve(std::vector<Ball>& b) const;

 private:
  struct Place {  // off the diagonal, row > column
    int row, column;
    Ball below, above;  // A(row, column), A(column, row); above only if not symmetric
  };
  struct Pair {
    Ball of[2];
  };
  struct Multiplier {
    int row;
    Pair left, right;  // of L's row, and of U's column; right only if not symmetric
  };
  struct Pivot {
    int rows[2];
    int count;
    Ball inverse[2][2];
    std::vector<Multiplier> others;
  };

  int find(int i, int j) const;
  Place& place(int i, int j);
  void add(const Entry& entry);
  const Ball& at(int i, int j) const;
  /// The rows, other than `except`, that are left and share an entry with row k.
  std::vector<int> neighbours(int k, int except);
  bool is_large_enough(int k, const std::vector<int>& around) const;
  int best_partner(int k, const std::vector<int>& around);
  bool eliminate(int k);
  bool eliminate_with(int k, int partner, const std::vector<int>& around);
  void update(const Pivot& pivot);
  bool eliminate_all();

  int size_;
  bool symmetric_;
  bool regular_ = false;
  int negative_ = 0;
  int sign_ = 1;
  std::vector<Ball> diagonal_;
  std::vector<Place> places_;
  std::vector<int> table_;  // of small matrices: place by row and column, or -1
  std::unordered_map<std::uint64_t, int> known_;
  std::vector<std::vector<int>> around_;  // per row: rows with which it shares an entry
  std::vector<char> left_;
  std::vector<Pivot> pivots_;
  Ball zero_;
};

}  // namespace poise::solvers
