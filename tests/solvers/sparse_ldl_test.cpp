// Sparse symmetric factors against dense linear algebra.

#include "solvers/sparse_ldl.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::solvers::sparse_ldl_test {
namespace {

// Entries as a caller gives them: in either triangle, some in several parts.
struct Entries {
  std::vector<int> row, column;
  std::vector<double> value;

  void add(int i, int j, double v) {
    row.push_back(i);
    column.push_back(j);
    value.push_back(v);
  }
  Eigen::MatrixXd dense(int size) const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(size, size);
    for (std::size_t e = 0; e < row.size(); ++e) {
      out(row[e], column[e]) += value[e];
      if (row[e] != column[e]) out(column[e], row[e]) += value[e];
    }
    return out;
  }
};

// Diagonally dominant, with `negative` negative diagonal entries and so as many negative eigenvalues.
Entries random_matrix(int size, int negative, std::mt19937& random) {
  std::uniform_int_distribution<int> any(0, size - 1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Entries out;
  for (int k = 0; k < 3 * size; ++k) {
    const int i = any(random), j = any(random);
    if (i != j) out.add(i, j, uniform(random));
  }
  for (int i = 0; i < size; ++i) {
    const double half = (i < negative ? -1.0 : 1.0) * 2.0 * size;
    out.add(i, i, half);
    out.add(i, i, half);
  }
  return out;
}

void fill(SparseLdl& factors, const std::vector<int>& target, const std::vector<double>& value) {
  std::fill(factors.values().begin(), factors.values().end(), 0.0);
  for (std::size_t e = 0; e < target.size(); ++e) factors.values()[target[e]] += value[e];
}

TEST(SparseLdl, SolvesAndCountsLikeDenseFactors) {
  std::mt19937 random(static_cast<unsigned>(test::seed(7)));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const int size : {1, 2, 7, 40}) {
    for (const int negative : {0, size / 2, size}) {
      SCOPED_TRACE(testing::Message() << size << ", " << negative);
      Entries entries = random_matrix(size, negative, random);
      const Eigen::MatrixXd dense = entries.dense(size);
      SparseLdl factors;
      factors.analyse(size, entries.row, entries.column);
      for (const double by : {1.0, -0.5}) {  // the same pattern serves other values
        std::vector<double> value = entries.value;
        for (double& v : value) v *= by;
        fill(factors, entries.row, value);
        ASSERT_TRUE(factors.factor());
        EXPECT_EQ(factors.negative(), by > 0 ? negative : size - negative);
        std::vector<double> x(size);
        for (double& v : x) v = uniform(random);
        const Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(x.data(), size);
        factors.solve(x);
        const Eigen::VectorXd left = by * dense * Eigen::Map<Eigen::VectorXd>(x.data(), size) - right;
        EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-14);
      }
    }
  }
}

TEST(SparseLdl, EntriesOfOnePlaceShareIt) {
  std::vector<int> row = {0, 1, 1, 0, 2, 2}, column = {1, 0, 1, 0, 2, 2};
  SparseLdl factors;
  factors.analyse(3, row, column);
  EXPECT_EQ(row[0], row[1]);
  EXPECT_EQ(row[4], row[5]);
  EXPECT_EQ(factors.values().size(), 4u);
}

TEST(SparseLdl, ReportsAPivotThatVanishesOrOverflows) {
  std::vector<int> row = {0, 1, 1}, column = {0, 0, 1};
  SparseLdl factors;
  factors.analyse(2, row, column);
  fill(factors, row, {1.0, 1.0, 1.0});
  EXPECT_FALSE(factors.factor());
  fill(factors, row, {1e-300, 1e300, 1e-300});
  EXPECT_FALSE(factors.factor());
  fill(factors, row, {1.0, 1.0, 3.0});
  EXPECT_TRUE(factors.factor());
  EXPECT_EQ(factors.spread(), 2.0);  // 3 - 1 / 1, over 1
}

}  // namespace
}  // namespace poise::solvers::sparse_ldl_test
