// Proofs that all matrices of a set are regular: members' solutions and signs, and sets with a singular member.

#include "solvers/regular_set.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "solvers/linear_algebra.hpp"
#include "tests/solvers/exact_balls.hpp"
#include "tests/support/seed.hpp"

namespace poise::solvers::regular_set_test {
namespace {

using Entries = std::vector<RegularSet::Entry>;
using Matrix50 = DenseMatrix<Real50>;
using Vector50 = DenseVector<Real50>;

struct Random {
  double operator()() { return uniform(engine); }
  Eigen::MatrixXd matrix(int rows, int columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return (*this)(); });
  }

  std::mt19937 engine{static_cast<unsigned>(test::seed(9))};
  std::uniform_real_distribution<double> uniform{-1.0, 1.0};
};

Entries entries_of(const Eigen::MatrixXd& center, const Eigen::MatrixXd& radius, bool symmetric) {
  Entries out;
  for (int i = 0; i < center.rows(); ++i) {
    for (int j = 0; j < (symmetric ? i + 1 : center.cols()); ++j) {
      if (center(i, j) != 0.0 || radius(i, j) != 0.0) out.push_back({i, j, Ball(center(i, j)).widened(radius(i, j))});
    }
  }
  return out;
}

class Sets : public testing::TestWithParam<bool> {
 protected:
  bool symmetric() const { return GetParam(); }
  Eigen::MatrixXd center(int size, Random& random) const {
    const Eigen::MatrixXd a = random.matrix(size, size);
    return symmetric() ? Eigen::MatrixXd(a + a.transpose()) : a;
  }
};

// Members need not be symmetric: (i, j) and (j, i) are drawn apart.
TEST_P(Sets, EncloseTheSolutionsOfTheirMembers) {
  Random random;
  int proved = 0;
  for (const int size : {1, 2, 5, 12, 40}) {
    for (const double width : {0.0, 1e-12, 1e-6, 1e-3}) {
      const Eigen::MatrixXd a = center(size, random);
      const Eigen::MatrixXd radius = Eigen::MatrixXd::Constant(size, size, width);
      const RegularSet set(size, symmetric(), entries_of(a, radius, symmetric()));
      if (!set.regular()) continue;
      ++proved;
      const Eigen::VectorXd right = random.matrix(size, 1);
      std::vector<Ball> b;
      for (const double value : right) b.push_back(Ball(value).widened(width));
      const std::vector<Ball> x = set.solve(b);
      for (int draw = 0; draw < 3; ++draw) {
        Matrix50 member = a.cast<Real50>();
        Vector50 side = right.cast<Real50>();
        // At corners of the set.
        for (Real50& value : member.reshaped()) value += random() > 0 ? Real50(width) : Real50(-width);
        for (Real50& value : side) value += random() > 0 ? Real50(width) : Real50(-width);
        const Vector50 exact = minimum_norm_solution<Real50>(member, side);
        for (int i = 0; i < size; ++i) EXPECT_TRUE(encloses(x[i], exact[i])) << size << ", " << width;
        const Eigen::MatrixXd rounded = member.cast<double>();
        EXPECT_EQ(set.determinant_sign(), FullyPivotedLu(rounded).determinant() > 0 ? 1 : -1);
        if (symmetric()) {
          const Eigen::MatrixXd even = (rounded + rounded.transpose()) / 2;
          const Eigen::VectorXd values = symmetric_eigenvalues<double>(even);
          EXPECT_EQ(set.negative(), (values.array() < 0.0).count());
        }
      }
    }
  }
  EXPECT_GE(proved, 14) << "it must not refuse what is far from singular";
}

TEST_P(Sets, WithASingularMemberAreNotRegular) {
  Random random;
  for (const int size : {1, 2, 7, 30, 70}) {
    for (const double width : {1e-14, 1e-9, 1e-3}) {
      const Eigen::MatrixXd thin = random.matrix(size, size - 1);
      const Eigen::MatrixXd singular = symmetric() ? Eigen::MatrixXd(thin * thin.transpose())
                                                   : Eigen::MatrixXd(thin * random.matrix(size - 1, size));
      // The singular matrix, but for rounding of its product in double, is on the set's edge.
      const Eigen::MatrixXd away = width * center(size, random);
      const Eigen::MatrixXd radius = away.cwiseAbs().array() + 1e-13 * size;
      EXPECT_FALSE(RegularSet(size, symmetric(), entries_of(singular + away, radius, symmetric())).regular())
          << size << ", " << width;
    }
  }
}

// Rows and columns scaled from 1e-8 to 1e8 do not matter: the bound is weighted.
TEST_P(Sets, OfBadlyScaledMatricesAreProved) {
  Random random;
  for (const int size : {2, 6, 20}) {
    Eigen::MatrixXd a = center(size, random);
    a.diagonal().array() += 2.0 * size;
    for (int i = 0; i < size; ++i) {
      const double scale = std::exp2(52.0 * i / size - 26.0);
      a.row(i) *= scale;
      a.col(i) *= scale;
    }
    const Eigen::MatrixXd radius = 1e-12 * a.cwiseAbs();
    EXPECT_TRUE(RegularSet(size, symmetric(), entries_of(a, radius, symmetric())).regular()) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Sets, testing::Bool(),
                         [](const auto& symmetric) { return symmetric.param ? "Symmetric" : "Unsymmetric"; });

Entries tridiagonal(int size, double diagonal, double width, bool symmetric) {
  Entries out;
  for (int i = 0; i < size; ++i) {
    out.push_back({i, i, Ball(diagonal).widened(width)});
    if (i + 1 == size) continue;
    out.push_back({i, i + 1, Ball(-1).widened(width)});
    if (!symmetric) out.push_back({i + 1, i, Ball(-1).widened(width)});
  }
  return out;
}

// 3 on the diagonal and -1 beside it: singular values from 1 to 5, so sets of less width than 1/3 are regular, and
// those of more than 1/3, which contain 3 - w - 2 (1 + w) = 0 on a long chain, are not.
TEST(RegularSet, OfAThousandSparseRows) {
  constexpr int size = 1000;
  for (const bool symmetric : {true, false}) {
    const RegularSet narrow(size, symmetric, tridiagonal(size, 3.0, 1e-6, symmetric));
    ASSERT_TRUE(narrow.regular());
    EXPECT_EQ(narrow.determinant_sign(), 1);
    if (symmetric) {
      EXPECT_EQ(narrow.negative(), 0);
      EXPECT_EQ(RegularSet(size, true, tridiagonal(size, -3.0, 1e-6, true)).negative(), size);
    }
    EXPECT_FALSE(RegularSet(size, symmetric, tridiagonal(size, 3.0, 0.34, symmetric)).regular());
    // Solutions of the two members at its ends, whose inverses have only positive entries: 1 for the right sides of 1.
    std::vector<Ball> b;
    for (int i = 0; i < size; ++i) b.emplace_back(i == 0 || i + 1 == size ? 2 : 1);
    const std::vector<Ball> x = narrow.solve(b);
    for (const Ball& v : x) EXPECT_TRUE(v.contains(Ball(1)));
    EXPECT_LT(x[size / 2].radius(), 1e-3);
  }
}

TEST(RegularSet, OfNumbersThatAreNotFiniteIsNotRegular) {
  for (const int size : {2, 100}) {
    Entries entries = tridiagonal(size, 3.0, 0.0, true);
    entries.front().value = Ball(1) / Ball(0);
    EXPECT_FALSE(RegularSet(size, true, entries).regular());
  }
}

}  // namespace
}  // namespace poise::solvers::regular_set_test
