// Sparse least squares against dense decompositions, with rows of very different length and some columns that are full.

#include "statics/bodies/sparse_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "solvers/linear_algebra.hpp"
#include "tests/support/seed.hpp"

namespace poise::sparse_least_squares_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class Draw {
 public:
  double number() { return uniform_(random_); }
  VectorXd vector(Eigen::Index size) {
    return VectorXd::NullaryExpr(size, [this] { return number(); });
  }

  // Three entries a row; the first `full` columns without a gap.
  MatrixXd matrix(Eigen::Index rows, Eigen::Index columns, Eigen::Index full) {
    std::uniform_int_distribution<Eigen::Index> any(0, columns - 1);
    MatrixXd out = MatrixXd::Zero(rows, columns);
    for (Eigen::Index r = 0; r < rows; ++r) {
      for (int k = 0; k < 3; ++k) out(r, any(random_)) = number();
      out(r, r % columns) = 2.0 + number();
    }
    for (Eigen::Index c = 0; c < full; ++c) out.col(c) += vector(rows);
    return out;
  }

 private:
  std::mt19937 random_{static_cast<unsigned>(test::seed(3))};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

SparseLeastSquares sparse(const MatrixXd& a) { return SparseLeastSquares(a.sparseView()); }

MatrixXd even(MatrixXd a) {
  for (Eigen::Index r = 0; r < a.rows(); ++r) a.row(r).normalize();
  return a;
}

// Columns of 40 entries are long, of 16 not.
TEST(SparseLeastSquares, AgreesWithDenseDecompositions) {
  Draw draw;
  for (const Eigen::Index columns : {8, 20}) {
    for (const Eigen::Index full : {0, 3}) {
      SCOPED_TRACE(testing::Message() << columns << ", " << full);
      const MatrixXd a = draw.matrix(2 * columns, columns, full);
      const VectorXd b = draw.vector(a.rows());
      VectorXd scaled = b;
      for (Eigen::Index r = 0; r < a.rows(); ++r) scaled[r] /= a.row(r).norm();
      const VectorXd expected = solvers::minimum_norm_solution<double>(even(a), scaled);
      SparseLeastSquares factored = sparse(a);
      EXPECT_LT((factored.solve(b) - expected).cwiseAbs().maxCoeff(), 1e-4);
      EXPECT_LT((factored.solve(a * expected) - expected).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_EQ(factored.null_space().dimension, 0);
      EXPECT_EQ(factored.left_null_space().dimension, columns);
    }
  }
}

// Moments of short bodies in a long mechanism: what can be balanced is balanced whatever its unit.
TEST(SparseLeastSquares, MeetsWhatCanBeMetInEveryUnit) {
  Draw draw;
  MatrixXd a = draw.matrix(60, 30, 0);
  const VectorXd x = draw.vector(a.cols());
  for (Eigen::Index r = 0; r < a.rows(); r += 3) a.row(r) *= 1e-7;
  EXPECT_LT((sparse(a).solve(a * x) - x).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(SparseLeastSquares, FindsWhatIsUndetermined) {
  Draw draw;
  for (const Eigen::Index full : {0, 2}) {
    MatrixXd a = draw.matrix(80, 40, full);
    a.col(7) = 0.5 * a.col(3) + a.col(11);
    a.col(20) = -a.col(21);
    SparseLeastSquares factored = sparse(a);
    const TouchedNullSpace null = factored.null_space();
    EXPECT_EQ(null.dimension, 2);
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
      const bool expected = i == 3 || i == 7 || i == 11 || i == 20 || i == 21;
      EXPECT_EQ(null.touches[static_cast<std::size_t>(i)], expected) << i;
    }
    // Least norm, and still so after the null space was counted.
    const VectorXd b = a * draw.vector(a.cols());
    const VectorXd expected = solvers::minimum_norm_solution(a, b);
    EXPECT_LT((factored.solve(b) - expected).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(SparseLeastSquares, FindsRowsThatRepeatOthers) {
  Draw draw;
  for (const Eigen::Index full : {0, 2}) {
    MatrixXd a = draw.matrix(40, 80, full);
    a.row(7) = 1e5 * a.row(3) + a.row(11);
    a.row(20) = -1e-6 * a.row(21);
    const TouchedNullSpace null = sparse(a).left_null_space();
    EXPECT_EQ(null.dimension, 2);
    for (Eigen::Index i : {3, 7, 20, 21}) EXPECT_TRUE(null.touches[static_cast<std::size_t>(i)]) << i;
    EXPECT_EQ(std::count(null.touches.begin(), null.touches.end(), true), 5);
  }
}

}  // namespace
}  // namespace poise::sparse_least_squares_test
