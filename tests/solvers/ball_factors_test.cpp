// Factors of sets of matrices: solutions against 50 digits, signs against eigenvalues, and nothing said of singular
// ones.

#include "solvers/ball_factors.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "solvers/linear_algebra.hpp"
#include "tests/solvers/exact_balls.hpp"
#include "tests/support/seed.hpp"

namespace poise::solvers::ball_factors_test {
namespace {

using Matrix50 = DenseMatrix<Real50>;
using Vector50 = DenseVector<Real50>;
using Entries = std::vector<BallFactors::Entry>;

// Numbers of few bits, so that sums and products of some of them are exact in double.
struct Random {
  double operator()() { return whole(engine) / 16.0; }
  Eigen::MatrixXd matrix(int rows, int columns) {
    Eigen::MatrixXd out(rows, columns);
    for (double& value : out.reshaped()) value = (*this)();
    return out;
  }
  Eigen::MatrixXd symmetric(int size) {
    const Eigen::MatrixXd half = matrix(size, size);
    return half + half.transpose();
  }

  std::mt19937 engine{static_cast<unsigned>(test::seed(5))};
  std::uniform_int_distribution<int> whole{-64, 64};
};

// Of a symmetric matrix the lower triangle or the upper one, some entries in two parts.
Entries entries_of(const Eigen::MatrixXd& a, bool symmetric) {
  Entries out;
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < (symmetric ? i + 1 : a.cols()); ++j) {
      if (a(i, j) == 0.0) continue;
      const double part = (i + j) % 3 == 0 ? 0.25 : a(i, j);
      const bool turned = symmetric && (i * j) % 2 == 0;
      out.push_back({turned ? j : i, turned ? i : j, Ball(part)});
      if (part != a(i, j)) out.push_back({i, j, Ball(a(i, j) - part)});
    }
  }
  return out;
}

int negative_eigenvalues(const Eigen::MatrixXd& a) {
  const Eigen::VectorXd values = symmetric_eigenvalues<double>(a);
  return static_cast<int>((values.array() < 0.0).count());
}

double determinant(const Eigen::MatrixXd& a) { return FullyPivotedLu(a).determinant(); }

void expect_solves(const BallFactors& factors, const Eigen::MatrixXd& a, Random& random) {
  const Eigen::VectorXd right = random.matrix(static_cast<int>(a.rows()), 1);
  std::vector<Ball> x(right.data(), right.data() + right.size());
  factors.solve(x);
  const Vector50 exact = minimum_norm_solution<Real50>(a.cast<Real50>(), right.cast<Real50>());
  for (Eigen::Index i = 0; i < exact.size(); ++i) {
    EXPECT_TRUE(encloses(x[static_cast<std::size_t>(i)], exact[i])) << i;
    EXPECT_LE(x[static_cast<std::size_t>(i)].radius(), 1e-18 * (1 + std::abs(static_cast<double>(exact[i]))));
  }
}

TEST(BallFactors, OfSymmetricMatricesHaveTheirInertiaAndSolveThem) {
  Random random;
  for (int size = 1; size <= 12; ++size) {
    for (int k = 0; k < 10; ++k) {
      const Eigen::MatrixXd a = random.symmetric(size);
      if (std::abs(determinant(a)) < 1e-3) continue;
      const BallFactors factors(size, true, entries_of(a, true));
      ASSERT_TRUE(factors.regular());
      EXPECT_EQ(factors.negative(), negative_eigenvalues(a));
      EXPECT_EQ(factors.determinant_sign(), determinant(a) > 0 ? 1 : -1);
      expect_solves(factors, a, random);
    }
  }
}

// [H J^T; J 0] with H + J^T J positive definite: as many negative eigenvalues as J has rows. Nothing is on the diagonal
// of the lower block, and H may be zero as well.
TEST(BallFactors, OfBorderedMatricesTakePivotsOfTwoRows) {
  Random random;
  for (const auto& [n, m] : {std::pair{1, 1}, {3, 3}, {5, 2}, {8, 8}, {9, 4}}) {
    for (const bool curved : {true, false}) {
      if (!curved && n != m) continue;
      for (int k = 0; k < 5; ++k) {
        Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n + m, n + m);
        if (curved) a.topLeftCorner(n, n).diagonal().setConstant(2.0);
        a.bottomLeftCorner(m, n) = random.matrix(m, n);
        a.topRightCorner(n, m) = a.bottomLeftCorner(m, n).transpose();
        if (std::abs(determinant(a)) < 1e-3) continue;
        const BallFactors factors(n + m, true, entries_of(a, true));
        ASSERT_TRUE(factors.regular());
        EXPECT_EQ(factors.negative(), m);
        EXPECT_EQ(factors.determinant_sign(), determinant(a) > 0 ? 1 : -1);
        expect_solves(factors, a, random);
      }
    }
  }
}

TEST(BallFactors, OfUnsymmetricMatricesSolveThem) {
  Random random;
  for (int size = 1; size <= 12; ++size) {
    for (int k = 0; k < 10; ++k) {
      Eigen::MatrixXd a = random.matrix(size, size);
      if (k % 2 == 0) a.diagonal().setZero();
      if (std::abs(determinant(a)) < 1e-3) continue;
      const BallFactors factors(size, false, entries_of(a, false));
      if (k % 2 != 0) {
        ASSERT_TRUE(factors.regular());
      }
      if (!factors.regular()) continue;  // pivots are taken from the diagonal only
      EXPECT_EQ(factors.determinant_sign(), determinant(a) > 0 ? 1 : -1);
      expect_solves(factors, a, random);
    }
  }
}

TEST(BallFactors, OfSingularMatricesAreNotRegular) {
  Random random;
  for (int size = 1; size <= 10; ++size) {
    for (int k = 0; k < 10; ++k) {
      const Eigen::MatrixXd thin = random.matrix(size, size - 1);
      const Eigen::MatrixXd other = random.matrix(size - 1, size);
      const Eigen::MatrixXd symmetric = thin * thin.transpose();
      EXPECT_FALSE(BallFactors(size, true, entries_of(symmetric, true)).regular());
      EXPECT_FALSE(BallFactors(size, false, entries_of(thin * other, false)).regular());
    }
  }
  EXPECT_FALSE(BallFactors(2, true, {{0, 0, Ball(1)}}).regular()) << "an empty row";
}

TEST(BallFactors, OfASetThatContainsASingularMatrixAreNotRegular) {
  Random random;
  for (int size = 1; size <= 10; ++size) {
    for (int k = 0; k < 10; ++k) {
      const Eigen::MatrixXd thin = random.matrix(size, size - 1);
      Entries entries = entries_of(thin * thin.transpose(), true);
      for (int i = 0; i < size; ++i) entries.push_back({i, i, Ball(1e-3).widened(1e-3)});
      EXPECT_FALSE(BallFactors(size, true, entries).regular());
    }
  }
}

TEST(BallFactors, OfASetEncloseTheSolutionsOfItsMembers) {
  Random random;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr double width = 1e-6;
  for (const bool symmetric : {true, false}) {
    for (int size = 1; size <= 8; ++size) {
      Eigen::MatrixXd a = symmetric ? random.symmetric(size) : random.matrix(size, size);
      a.diagonal().array() += 16.0;
      Entries entries;
      for (BallFactors::Entry& e : entries = entries_of(a, symmetric)) e.value = e.value.widened(width);
      const BallFactors factors(size, symmetric, entries);
      ASSERT_TRUE(factors.regular());
      const Eigen::VectorXd right = random.matrix(size, 1);
      std::vector<Ball> x(right.data(), right.data() + right.size());
      factors.solve(x);
      for (int draw = 0; draw < 10; ++draw) {
        Matrix50 member = a.cast<Real50>();
        for (int i = 0; i < size; ++i) {
          for (int j = 0; j < size; ++j) {
            if (a(i, j) == 0.0) continue;
            if (symmetric && j > i) continue;
            member(i, j) += width * uniform(random.engine);
            if (symmetric) member(j, i) = member(i, j);
          }
        }
        const Vector50 exact = minimum_norm_solution<Real50>(member, right.cast<Real50>());
        for (int i = 0; i < size; ++i) EXPECT_TRUE(encloses(x[i], exact[i]));
      }
    }
  }
}

// Tridiagonal, 2 - s on the diagonal and -1 beside it: eigenvalues 2 - s - 2 cos(k pi / (n + 1)).
TEST(BallFactors, OfAThousandSparseRows) {
  constexpr int size = 1000;
  for (const double shift : {0.0, 0.5, 2.0, 3.7, 5.0}) {
    int negative = 0;
    for (int k = 1; k <= size; ++k) negative += 2 - shift - 2 * std::cos(k * M_PI / (size + 1)) < 0.0 ? 1 : 0;
    for (const bool symmetric : {true, false}) {
      Entries entries;
      for (int i = 0; i < size; ++i) {
        entries.push_back({i, i, Ball(2 - shift)});
        if (i + 1 == size) continue;
        entries.push_back({i, i + 1, Ball(-1)});
        if (!symmetric) entries.push_back({i + 1, i, Ball(-1)});
      }
      const BallFactors factors(size, symmetric, entries);
      ASSERT_TRUE(factors.regular()) << shift;
      if (symmetric) {
        EXPECT_EQ(factors.negative(), negative);
      }
      EXPECT_EQ(factors.determinant_sign(), negative % 2 == 0 ? 1 : -1);
      // x_i = (i mod 7) - 3 from the right sides that it needs.
      const auto known = [](int i) { return i < 0 || i >= size ? 0 : i % 7 - 3; };
      std::vector<Ball> x;
      for (int i = 0; i < size; ++i) {
        x.push_back(Ball(2 - shift) * Ball(known(i)) - Ball(known(i - 1)) - Ball(known(i + 1)));
      }
      factors.solve(x);
      double widest = 0.0;
      for (int i = 0; i < size; ++i) {
        EXPECT_TRUE(x[i].contains(Ball(known(i)))) << i;
        widest = std::max(widest, x[i].radius());
      }
      EXPECT_LT(widest, 1e-20);
    }
  }
}

}  // namespace
}  // namespace poise::solvers::ball_factors_test
