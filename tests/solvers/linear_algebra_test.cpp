// Closed forms and the defining properties of what is computed, in double and in 50 digits.

#include "solvers/linear_algebra.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/linear_algebra_50.hpp"

namespace poise::solvers::linear_algebra_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

template <class T>
struct LinearAlgebra : testing::Test {
  using Matrix = DenseMatrix<T>;
  using Vector = DenseVector<T>;

  // What rounding may leave of zero.
  static T rounding() { return 1e4 * Eigen::NumTraits<T>::epsilon(); }

  static Matrix random_matrix(Index rows, Index columns, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    return Matrix::NullaryExpr(rows, columns, [&] { return T(uniform(random)); });
  }

  // A product of random factors: of the rank given, but for rounding in T.
  static Matrix of_rank(Index rank, Index rows, Index columns, unsigned seed) {
    return random_matrix(rows, rank, seed) * random_matrix(rank, columns, seed + 1);
  }

  static Matrix hilbert(Index n) {
    return Matrix::NullaryExpr(n, n, [](Index i, Index j) { return T(1) / T(i + j + 1); });
  }

  static T largest(const Matrix& a) { return a.size() > 0 ? T(a.cwiseAbs().maxCoeff()) : T(0); }
};

using Scalars = testing::Types<double, Real50>;
TYPED_TEST_SUITE(LinearAlgebra, Scalars);

TYPED_TEST(LinearAlgebra, RankOfProductsIsTheirInnerSize) {
  using Fixture = LinearAlgebra<TypeParam>;
  for (const Index inner : {1, 2, 5}) {
    EXPECT_EQ(rank(Fixture::of_rank(inner, 7, 5, 1), known_to::rounding), inner);
    EXPECT_EQ(rank(Fixture::of_rank(inner, 5, 9, 3), known_to::rounding), inner);
  }
  EXPECT_EQ(rank(typename Fixture::Matrix(Fixture::Matrix::Zero(3, 4)), known_to::rounding), 0);
  EXPECT_EQ(rank(typename Fixture::Matrix(0, 4), known_to::rounding), 0);
  EXPECT_EQ(rank(typename Fixture::Matrix(4, 0), known_to::rounding), 0);
}

// Pivots count that are more than the tolerance of the largest one, and eps min(m, n) where the tolerance is less.
TYPED_TEST(LinearAlgebra, RankFollowsItsPolicy) {
  using Fixture = LinearAlgebra<TypeParam>;
  typename Fixture::Matrix a = Fixture::Matrix::Zero(4, 4);
  const TypeParam eps = Eigen::NumTraits<TypeParam>::epsilon();
  a.diagonal() << TypeParam(2), TypeParam(2.1e-4), TypeParam(1.9e-7), 7 * eps;
  EXPECT_EQ(rank(a, known_to::singular_point), 2);
  EXPECT_EQ(rank(a, known_to::path), 2);
  EXPECT_EQ(rank(a, 0.9e-7), 3);
  EXPECT_EQ(rank(a, known_to::rounding), 3);
  a(3, 3) = 9 * eps;
  EXPECT_EQ(rank(a, known_to::rounding), 4);
}

// The Hilbert matrix of order 20 has a smallest singular value of about 1e-28 of its largest.
TEST(LinearAlgebra50, FindsRanksThatDoubleDoesNot) {
  EXPECT_EQ(rank(LinearAlgebra<Real50>::hilbert(20), known_to::rounding), 20);
  EXPECT_LT(rank(LinearAlgebra<Real50>::hilbert(20), known_to::half_of_50_digits), 20);
  EXPECT_LT(rank(LinearAlgebra<double>::hilbert(20), known_to::rounding), 15);
}

TYPED_TEST(LinearAlgebra, PivotsComeLargestFirst) {
  using Fixture = LinearAlgebra<TypeParam>;
  typename Fixture::Matrix a = Fixture::random_matrix(5, 3, 11);
  a.col(1) *= TypeParam(100);
  a.col(2) = 2 * a.col(0) - a.col(1);
  a.col(0) *= TypeParam(1e-3);  // what is left of it beside column 1 is the smallest
  const PivotOrder order = pivot_order(a, known_to::solution);
  EXPECT_EQ(order.rank, 2);
  ASSERT_EQ(order.columns.size(), 3U);
  EXPECT_EQ(order.columns[2], 0);
  EXPECT_EQ(pivot_order(typename Fixture::Matrix(0, 2), known_to::rounding).columns, (std::vector<int>{0, 1}));
}

TYPED_TEST(LinearAlgebra, NullSpaceIsOrthonormalAndWhole) {
  using Fixture = LinearAlgebra<TypeParam>;
  for (const Index inner : {0, 1, 3}) {
    const typename Fixture::Matrix a = Fixture::of_rank(inner, 4, 6, 21);
    for (const typename Fixture::Matrix& z :
         {null_space(a, known_to::solution), LeastSquares<TypeParam>(a).null_space()}) {
      ASSERT_EQ(z.cols(), 6 - inner);
      EXPECT_LT(Fixture::largest(z.transpose() * z - Fixture::Matrix::Identity(z.cols(), z.cols())),
                Fixture::rounding());
      EXPECT_LT(Fixture::largest(a * z), Fixture::rounding());
    }
  }
  EXPECT_EQ(null_space(typename Fixture::Matrix(0, 3), known_to::solution), (Fixture::Matrix::Identity(3, 3)));
  EXPECT_EQ(null_space(typename Fixture::Matrix(Fixture::random_matrix(5, 3, 5)), known_to::solution).cols(), 0);
}

// Of all x with  A^T (A x - b) = 0  the one without a part in the null space of A.
TYPED_TEST(LinearAlgebra, LeastSquaresSolutionIsTheShortest) {
  using Fixture = LinearAlgebra<TypeParam>;
  for (const auto& [rows, columns, inner] :
       std::vector<std::array<Index, 3>>{{6, 4, 4}, {4, 6, 4}, {5, 5, 5}, {6, 5, 2}}) {
    const typename Fixture::Matrix a = Fixture::of_rank(inner, rows, columns, 31);
    const typename Fixture::Vector b = Fixture::random_matrix(rows, 1, 33);
    const LeastSquares<TypeParam> factors(a);
    EXPECT_EQ(factors.rank(), inner);
    const typename Fixture::Vector x = factors.solve(b);
    EXPECT_LT(Fixture::largest(a.transpose() * (a * x - b)), Fixture::rounding());
    EXPECT_LT(Fixture::largest(null_space(a, known_to::solution).transpose() * x), Fixture::rounding());
    EXPECT_EQ(minimum_norm_solution(a, b), x);
  }
}

// Where nothing is unknown, b is missed whole.
TYPED_TEST(LinearAlgebra, LeastSquaresWithoutUnknowns) {
  using Fixture = LinearAlgebra<TypeParam>;
  const LeastSquares<TypeParam> factors(typename Fixture::Matrix(2, 0));
  EXPECT_EQ(factors.rank(), 0);
  EXPECT_EQ(factors.solve(Fixture::Vector::Ones(2)).size(), 0);
  EXPECT_EQ(factors.null_space().size(), 0);
}

// One equation in two unknowns: 3 x + 4 y = 10 is met next to the origin by (6, 8) / 5.
TYPED_TEST(LinearAlgebra, MinimumNormOfALine) {
  using Fixture = LinearAlgebra<TypeParam>;
  typename Fixture::Matrix a(1, 2);
  a << TypeParam(3), TypeParam(4);
  const typename Fixture::Vector x =
      minimum_norm_solution(a, typename Fixture::Vector(Fixture::Vector::Constant(1, 10)));
  EXPECT_LT(abs(x[0] - TypeParam(6) / 5), Fixture::rounding());
  EXPECT_LT(abs(x[1] - TypeParam(8) / 5), Fixture::rounding());
}

// Rows that contradict each other by less than the tolerance count once: the pivot they leave is not divided by.
TYPED_TEST(LinearAlgebra, ToleranceKeepsNearlyRepeatedRowsFromBlowingUp) {
  using Fixture = LinearAlgebra<TypeParam>;
  typename Fixture::Matrix a(2, 2);
  a << 1, 0, 1, TypeParam(1e-12);
  typename Fixture::Vector b(2);
  b << 1, 2;
  EXPECT_LT(Fixture::largest(minimum_norm_solution(a, b, known_to::solution)), TypeParam(2));
  EXPECT_GT(Fixture::largest(minimum_norm_solution(a, b)), TypeParam(0.9e12));
}

// Second differences with fixed ends: 2 - 2 cos(k pi / (n + 1)).
TYPED_TEST(LinearAlgebra, EigenvaluesOfAString) {
  using Fixture = LinearAlgebra<TypeParam>;
  using std::acos;
  using std::cos;
  constexpr Index n = 9;
  typename Fixture::Matrix a = Fixture::Matrix::Zero(n, n);
  a.diagonal().setConstant(TypeParam(2));
  a.diagonal(-1).setConstant(TypeParam(-1));
  const typename Fixture::Vector values = symmetric_eigenvalues(a);
  ASSERT_EQ(values.size(), n);
  const TypeParam pi = acos(TypeParam(-1));
  for (Index k = 1; k <= n; ++k) {
    EXPECT_LT(abs(values[k - 1] - (2 - 2 * cos(k * pi / (n + 1)))), Fixture::rounding()) << k;
  }
}

using Doubles = LinearAlgebra<double>;

TEST(LinearAlgebraInDouble, SymmetricEigenvectorsDiagonalise) {
  const MatrixXd any = Doubles::random_matrix(6, 6, 41);
  const MatrixXd a = any + any.transpose();
  const SymmetricEigen eigen = symmetric_eigen(a.triangularView<Eigen::Lower>());
  EXPECT_LT((a * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(), 1e-13);
  EXPECT_LT((eigen.vectors.transpose() * eigen.vectors - MatrixXd::Identity(6, 6)).norm(), 1e-13);
  EXPECT_TRUE(std::is_sorted(eigen.values.begin(), eigen.values.end()));
  EXPECT_LT((eigen.values - symmetric_eigenvalues(a)).norm(), 1e-13);
}

// A turn by 1 rad has exp(+-i), a companion matrix the roots of its polynomial (x - 1)(x - 2)(x + 3).
TEST(LinearAlgebraInDouble, EigenvaluesOfATurnAndOfACompanionMatrix) {
  MatrixXd turn(2, 2);
  turn << std::cos(1.0), -std::sin(1.0), std::sin(1.0), std::cos(1.0);
  const Eigenpairs both = eigenpairs(turn);
  EXPECT_NEAR(std::abs(both.values[0].imag()), std::sin(1.0), 1e-15);
  EXPECT_NEAR(both.values[0].real(), std::cos(1.0), 1e-15);
  EXPECT_EQ(both.values[1], std::conj(both.values[0]));

  MatrixXd companion(3, 3);
  companion << 0, 7, -6, 1, 0, 0, 0, 1, 0;
  const Eigenpairs roots = eigenpairs(companion);
  std::vector<double> values;
  for (Index k = 0; k < 3; ++k) {
    EXPECT_LT((companion * roots.vectors.col(k) - roots.values[k] * roots.vectors.col(k)).norm(), 1e-13);
    values.push_back(roots.values[k].real());
  }
  std::sort(values.begin(), values.end());
  EXPECT_NEAR(values[0], -3, 1e-13);
  EXPECT_NEAR(values[1], 1, 1e-13);
  EXPECT_NEAR(values[2], 2, 1e-13);
}

TEST(LinearAlgebraInDouble, SingularValuesRebuildTheMatrix) {
  for (const auto& [rows, columns] : {std::pair{5, 3}, std::pair{3, 5}, std::pair{20, 18}}) {
    const MatrixXd a = Doubles::random_matrix(rows, columns, 51);
    const SingularValues svd = singular_value_decomposition(a);
    const Index count = std::min(rows, columns);
    ASSERT_EQ(svd.values.size(), count);
    ASSERT_EQ(svd.right.cols(), columns);
    EXPECT_LT((svd.left * svd.values.asDiagonal() * svd.right.leftCols(count).transpose() - a).norm(), 1e-13);
    EXPECT_LT((svd.right.transpose() * svd.right - MatrixXd::Identity(columns, columns)).norm(), 1e-13);
    EXPECT_LT((singular_values(a) - svd.values).norm(), 1e-13);
    EXPECT_EQ(svd.rank(1e-10), count);
  }
  MatrixXd graded = MatrixXd::Zero(3, 3);
  graded.diagonal() << 1, 1e-4, 1e-9;
  EXPECT_EQ(singular_value_decomposition(graded).rank(1e-5), 2);
  EXPECT_EQ(singular_value_decomposition(graded).rank(1e-4), 2);
  EXPECT_EQ(singular_value_decomposition(MatrixXd::Zero(3, 2)).rank(1e-5), 0);
}

TEST(LinearAlgebraInDouble, TriangularFactorHasTheSameNormalMatrix) {
  const MatrixXd a = Doubles::random_matrix(12, 4, 61);
  MatrixXd work = a;
  const MatrixXd r = triangular_factor(work);
  ASSERT_EQ(r.rows(), 4);
  ASSERT_EQ(r.cols(), 4);
  EXPECT_TRUE(r.isUpperTriangular(0.0));
  EXPECT_LT((r.transpose() * r - a.transpose() * a).norm(), 1e-13);
}

TEST(LinearAlgebraInDouble, ColumnSharesMakeTheOtherColumns) {
  const MatrixXd a = Doubles::of_rank(3, 8, 5, 71);
  const auto [columns, share] = column_shares(a, 3);
  ASSERT_EQ(columns.size(), 5U);
  ASSERT_EQ(share.rows(), 3);
  ASSERT_EQ(share.cols(), 2);
  for (Index k = 0; k < share.cols(); ++k) {
    VectorXd sum = VectorXd::Zero(8);
    for (Index i = 0; i < 3; ++i) sum += share(i, k) * a.col(columns[static_cast<std::size_t>(i)]);
    EXPECT_LT((sum - a.col(columns[static_cast<std::size_t>(3 + k)])).norm(), 1e-13);
  }
}

TEST(LinearAlgebraInDouble, FullyPivotedLu) {
  MatrixXd a(3, 3);
  a << 0, 2, 1, 4, 0, 0, 0, 0, -3;
  const FullyPivotedLu lu(a);
  EXPECT_DOUBLE_EQ(lu.determinant(), 24);
  EXPECT_EQ(lu.determinant_sign(), 1);
  EXPECT_EQ(FullyPivotedLu(MatrixXd(a.row(1).replicate(3, 1))).determinant_sign(), 0);
  // Where the determinant underflows.
  MatrixXd tiny = 1e-200 * a;
  tiny.row(0).swap(tiny.row(1));
  EXPECT_EQ(FullyPivotedLu(tiny).determinant(), 0.0);
  EXPECT_EQ(FullyPivotedLu(tiny).determinant_sign(), -1);
  EXPECT_DOUBLE_EQ(lu.largest_pivot(), 4);
  EXPECT_GT(lu.reciprocal_condition(), 0.1);
  const VectorXd b = VectorXd::LinSpaced(3, 1, 3);
  EXPECT_LT((a * lu.solve(b) - b).norm(), 1e-14);
  EXPECT_LT((a * lu.solve(a) - a).norm(), 1e-14);
  // Of [1 1; 1 1] x = (2, 2) some solution, whatever is divided by nothing.
  const VectorXd x = FullyPivotedLu(MatrixXd::Ones(2, 2)).solve(VectorXd(VectorXd::Constant(2, 2.0)));
  EXPECT_NEAR(x.sum(), 2.0, 1e-15);
  EXPECT_LT(FullyPivotedLu(MatrixXd::Ones(2, 2)).reciprocal_condition(), 1e-15);
}

Eigen::SparseMatrix<Real50> sparse(const DenseMatrix<Real50>& dense) {
  Eigen::SparseMatrix<Real50> out(dense.rows(), dense.cols());
  for (Index c = 0; c < dense.cols(); ++c) {
    for (Index r = 0; r < dense.rows(); ++r) {
      if (dense(r, c) != 0) out.insert(r, c) = dense(r, c);
    }
  }
  return out;
}

TEST(LinearAlgebra50, SolvesSparseSystems) {
  using Fifty = LinearAlgebra<Real50>;
  const DenseMatrix<Real50> any = Fifty::random_matrix(7, 7, 81);
  const DenseMatrix<Real50> even = any + any.transpose();
  const DenseVector<Real50> b = Fifty::random_matrix(7, 1, 82);
  for (const bool symmetric : {false, true}) {
    const DenseMatrix<Real50>& a = symmetric ? even : any;
    const auto x = solve(sparse(a), b, symmetric);
    ASSERT_TRUE(x);
    EXPECT_LT(Fifty::largest(a * *x - b), Fifty::rounding());
  }
  // LDL^T without pivoting meets a zero pivot at once, LU does not.
  DenseMatrix<Real50> swap = DenseMatrix<Real50>::Zero(2, 2);
  swap(0, 1) = swap(1, 0) = 2;
  const auto x = solve(sparse(swap), b.head(2), true);
  ASSERT_TRUE(x);
  EXPECT_EQ((*x)[0], b[1] / 2);
  EXPECT_EQ((*x)[1], b[0] / 2);
}

TEST(LinearAlgebra50, SaysThatASparseSystemIsSingular) {
  const DenseMatrix<Real50> ones = DenseMatrix<Real50>::Ones(3, 3);
  for (const bool symmetric : {false, true}) {
    EXPECT_FALSE(solve(sparse(ones), DenseVector<Real50>::Constant(3, 1), symmetric));
  }
}

}  // namespace
}  // namespace poise::solvers::linear_algebra_test
