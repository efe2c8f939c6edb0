// The conditions of Karush, Kuhn and Tucker:  x >= 0,  A^T (b - A x) <= 0,  zero where x is positive.

#include "solvers/nonnegative_least_squares.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "solvers/linear_algebra.hpp"
#include "tests/support/seed.hpp"

namespace poise::solvers::nonnegative_least_squares_test {
namespace {

struct Random {
  Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(engine); });
  }

  std::mt19937 engine{static_cast<unsigned>(test::seed(3))};
  std::uniform_real_distribution<double> uniform{-1.0, 1.0};
};

void expect_optimal(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = nonnegative_least_squares(a, b);
  ASSERT_EQ(x.size(), a.cols());
  const Eigen::VectorXd gain = a.transpose() * (b - a * x);
  const double scale = 1 + a.cwiseAbs().sum() * b.cwiseAbs().sum();
  std::vector<Eigen::Index> positive;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    EXPECT_GE(x[j], 0.0);
    EXPECT_LE(gain[j], 1e-12 * scale);
    if (x[j] > 0.0) {
      EXPECT_GE(gain[j], -1e-12 * scale);
      positive.push_back(j);
    }
  }
  if (positive.empty()) return;
  Eigen::MatrixXd columns(a.rows(), static_cast<Eigen::Index>(positive.size()));
  for (std::size_t k = 0; k < positive.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = a.col(positive[k]);
  EXPECT_EQ(rank<double>(columns, known_to::solution), columns.cols()) << "positive columns are independent";
}

TEST(NonnegativeLeastSquares, IsOptimalOnRandomData) {
  Random random;
  for (const Eigen::Index rows : {1, 2, 5, 20}) {
    for (const Eigen::Index columns : {1, 2, 4, 8, 30}) {
      for (int k = 0; k < 20; ++k) {
        const Eigen::MatrixXd b = random.matrix(rows, 1);
        expect_optimal(random.matrix(rows, columns), b);
      }
    }
  }
}

// The moments of stops: columns repeated, opposite to one another, and zero.
TEST(NonnegativeLeastSquares, IsOptimalWhereColumnsDepend) {
  Random random;
  for (const Eigen::Index rows : {1, 2, 3, 6}) {
    for (int k = 0; k < 40; ++k) {
      const Eigen::MatrixXd some = random.matrix(rows, 3);
      Eigen::MatrixXd a(rows, 10);
      a << some, -some, some, Eigen::MatrixXd::Zero(rows, 1);
      expect_optimal(a, random.matrix(rows, 1));
      expect_optimal(a, some * random.matrix(3, 1).cwiseAbs());
    }
  }
}

TEST(NonnegativeLeastSquares, FindsTheForcesThatBalance) {
  Random random;
  for (int k = 0; k < 50; ++k) {
    const Eigen::MatrixXd a = random.matrix(6, 4);
    const Eigen::VectorXd known = random.matrix(4, 1).cwiseAbs();
    EXPECT_LE((nonnegative_least_squares(a, a * known) - known).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(NonnegativeLeastSquares, IsZeroWhereAllWouldHaveToPull) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_EQ(nonnegative_least_squares(a, Eigen::Vector3d(-1, -2, 0)), Eigen::VectorXd(Eigen::Vector3d::Zero()));
  EXPECT_EQ(nonnegative_least_squares(a, Eigen::Vector3d(-1, 2, 0)), Eigen::VectorXd(Eigen::Vector3d(0, 2, 0)));
}

TEST(NonnegativeLeastSquares, OfNothingIsNothing) {
  EXPECT_EQ(nonnegative_least_squares(Eigen::MatrixXd(3, 0), Eigen::Vector3d(1, 2, 3)).size(), 0);
  EXPECT_EQ(nonnegative_least_squares(Eigen::MatrixXd(0, 2), Eigen::VectorXd(0)),
            Eigen::VectorXd(Eigen::Vector2d::Zero()));
}

// With E x = e the gradient of |C x + c|^2 / 2 is E^T l + m, where m >= 0 is zero wherever x is not.
TEST(ZerosOfLeastNorm, RandomSetsAreOptimal) {
  Random random;
  int zeros = 0;
  for (int k = 0; k < test::cases(300, 3000); ++k) {
    const Eigen::Index n = 2 + k % 7, rows = 1 + k % std::min<Eigen::Index>(3, n - 1);
    const Eigen::MatrixXd e = random.matrix(rows, n), c_matrix = random.matrix(n + 2, n);
    const Eigen::VectorXd c = 3 * random.matrix(n + 2, 1);
    const Eigen::VectorXd some = random.matrix(n, 1).cwiseMax(0.0);
    if (some.isZero()) continue;
    const std::vector<bool> zero = zeros_of_least_norm(e, some, c_matrix, c);
    // The least of those with these zeros: [C^T C  E^T; E 0], with x_j = 0 in place of some rows.
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + rows, n + rows);
    system.topLeftCorner(n, n) = c_matrix.transpose() * c_matrix;
    system.topRightCorner(n, rows) = -e.transpose();
    system.bottomLeftCorner(rows, n) = e;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + rows);
    right.head(n) = -c_matrix.transpose() * c;
    right.tail(rows) = e * some;
    const Eigen::MatrixXd stationary = system.topRows(n);
    const Eigen::VectorXd of = right.head(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      if (!zero[static_cast<std::size_t>(j)]) continue;
      ++zeros;
      system.row(j).setZero();
      system(j, j) = 1.0;
      right[j] = 0.0;
    }
    const Eigen::VectorXd found = minimum_norm_solution<double>(system, right);
    EXPECT_LE((e * (found.head(n) - some)).norm(), 1e-9) << k;
    const Eigen::VectorXd m = stationary * found - of;
    for (Eigen::Index j = 0; j < n; ++j) {
      EXPECT_GE(found[j], -1e-9) << k;
      EXPECT_GE(m[j], -1e-8) << k;
      EXPECT_TRUE(zero[static_cast<std::size_t>(j)] || m[j] <= 1e-8) << k;
    }
  }
  EXPECT_GT(zeros, 300);
}

}  // namespace
}  // namespace poise::solvers::nonnegative_least_squares_test
