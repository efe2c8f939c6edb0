#include "identification/identifiability/null_space.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace poise::null_space_test {
namespace {

Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index columns, double size, unsigned seed) {
  std::srand(seed);
  return size * Eigen::MatrixXd::Random(rows, columns);
}

// Columns a, b, a - 3 b, c, zero: the third is a combination, the fourth stands alone.
Eigen::MatrixXd dependent() {
  Eigen::MatrixXd a = noise(40, 5, 1.0, 1);
  a.col(2) = a.col(0) - 3 * a.col(1);
  a.col(4).setZero();
  return a;
}

TEST(NullSpace, OfAMatrixKnownToRounding) {
  const Eigen::MatrixXd a = dependent();
  const Eigen::MatrixXd once = a + noise(40, 5, 1e-15, 2);
  const NullSpace found = null_space(once, a + noise(40, 5, 1e-15, 3), {});
  ASSERT_EQ(found.dimension(), 2);
  EXPECT_EQ(found.unclear, 0);
  EXPECT_GT(found.gap, 1e10);
  EXPECT_LT((a * found.basis).cwiseAbs().maxCoeff(), 1e-13);
  for (const Eigen::Index i : {0, 1, 2, 4}) EXPECT_TRUE(found.touches(i)) << i;
  EXPECT_FALSE(found.touches(3));
}

// Small parts are parts: units and sizes of the numbers do not matter.
TEST(NullSpace, FindsPartsOfAnySize) {
  const Eigen::VectorXd size = (Eigen::VectorXd(5) << 1e6, 1e-9, 1.0, 1e4, 1e-3).finished();
  const Eigen::MatrixXd a = dependent() * size.asDiagonal();
  const Eigen::MatrixXd unit = size.asDiagonal();
  const NullSpace found = null_space(a + noise(40, 5, 1e-15, 2) * unit, a + noise(40, 5, 1e-15, 3) * unit, {});
  ASSERT_EQ(found.dimension(), 2);
  for (const Eigen::Index i : {0, 1, 2, 4}) EXPECT_TRUE(found.touches(i)) << i;
  EXPECT_FALSE(found.touches(3));
}

TEST(NullSpace, NoneOfAMatrixOfFullRank) {
  const Eigen::MatrixXd a = noise(40, 5, 1.0, 1);
  const NullSpace found = null_space(a, a + noise(40, 5, 1e-12, 3), {});
  EXPECT_EQ(found.dimension(), 0);
  EXPECT_FALSE(found.touches(0));
}

// What is known already is not found again.
TEST(NullSpace, BeyondWhatIsKnown) {
  const Eigen::MatrixXd a = dependent();
  NullSpace known;
  known.basis = (Eigen::MatrixXd(5, 1) << 1, -3, -1, 0, 0).finished();
  known.error = Eigen::VectorXd::Zero(5);
  const NullSpace found = null_space(a, a + noise(40, 5, 1e-15, 3), known);
  ASSERT_EQ(found.dimension(), 1);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_FALSE(found.touches(i)) << i;
  EXPECT_TRUE(found.touches(4));
}

// Singular values 1, 0.03, 0.001, ... down to the errors: nothing shows which of them are zero.
TEST(NullSpace, SaysThatItIsUnclearWithoutAGap) {
  Eigen::MatrixXd a = noise(40, 12, 1.0, 1);
  for (Eigen::Index i = 1; i < 12; ++i) a.col(i) = a.col(i - 1) + std::pow(0.03, static_cast<double>(i)) * a.col(i);
  const NullSpace found = null_space(a + noise(40, 12, 1e-13, 2), a + noise(40, 12, 1e-13, 3), {});
  EXPECT_GT(found.dimension(), 0);
  EXPECT_GT(found.unclear, 0);
}

// Two columns differ by 1e-12 of their length, and are known to 1e-17; another one is known to 1e-10 only.
TEST(NullSpace, JudgesADirectionByItsOwnError) {
  Eigen::MatrixXd a = noise(40, 3, 1.0, 1);
  a.col(1).setZero();
  a(0, 1) = 1.0;
  a.col(2) = a.col(1);
  a(1, 2) = 1e-12;
  Eigen::MatrixXd again = a;
  again.col(0) += noise(40, 1, 1e-10, 2);
  EXPECT_GT(null_space(a, again, {}).dimension(), 0);  // near the rounding of the decomposition
  a(1, 2) = 1e-10;
  again.rightCols(2) = a.rightCols(2);
  EXPECT_EQ(null_space(a, again, {}).dimension(), 0);
}

// The part of a number in a null direction that is known to 1e-5 only may be as large.
TEST(NullSpace, APartThatIsNotResolvedCounts) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(40, 3);
  a.col(0) = noise(40, 1, 1.0, 1);
  a.col(1) = noise(40, 1, 1.0, 2);
  a.col(2) = a.col(0) + 1e-5 * a.col(1);
  const NullSpace found = null_space(a, a + noise(40, 3, 1e-6, 3), {});
  ASSERT_EQ(found.dimension(), 1);
  EXPECT_TRUE(found.touches(1));
}

TEST(NullSpace, ComplementIsOrthonormal) {
  const Eigen::MatrixXd basis = noise(6, 2, 1e5, 5);
  const Eigen::MatrixXd rest = complement(basis);
  ASSERT_EQ(rest.cols(), 4);
  EXPECT_LT((rest.transpose() * rest - Eigen::MatrixXd::Identity(4, 4)).norm(), 1e-14);
  EXPECT_LT((basis.transpose() * rest).norm(), 1e-8);
}

}  // namespace
}  // namespace poise::null_space_test
