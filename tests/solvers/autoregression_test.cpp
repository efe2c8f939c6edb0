// Autoregressive models of correlated series, and what their correlation does to sums.

#include "solvers/autoregression.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace poise::solvers::autoregression_test {
namespace {

std::vector<double> simulate(const std::vector<double>& phi, std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(count + 5000, 0.0);
  for (std::size_t t = 0; t < x.size(); ++t) {
    x[t] = normal(random);
    for (std::size_t j = 0; j < phi.size() && j < t; ++j) x[t] += phi[j] * x[t - 1 - j];
  }
  return {x.begin() + 5000, x.end()};
}

TEST(Autoregression, WhiteSeriesIsCalledWhite) {
  int white = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const std::vector<std::vector<double>> pieces = {simulate({}, 1000, 2 * seed), simulate({}, 500, 2 * seed + 1)};
    white += fit_autoregression(pieces, 20).is_white() ? 1 : 0;
  }
  EXPECT_GE(white, 190);
  EXPECT_EQ(Autoregression{}.spread(), 1.0);
  const std::vector<std::vector<double>> zero = {std::vector<double>(100, 0.0)};
  EXPECT_TRUE(fit_autoregression(zero, 20).is_white());
}

// Neighbours of 16 white values less their mean and trend are correlated by -1/8: of that alone half of all sets of ten
// such series would be called correlated.
TEST(Autoregression, WhiteSeriesOfWhichAFitTookMuchIsCalledWhite) {
  constexpr int count = 16;
  Eigen::MatrixXd basis(count, 2);
  for (int t = 0; t < count; ++t) basis.row(t) << 1.0, t - 0.5 * (count - 1);
  basis.colwise().normalize();
  const std::vector<TakenColumns> taken(10, {lag_products(basis, 20), Eigen::Vector2d::Ones()});
  int white = 0, alone = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::vector<std::vector<double>> pieces;
    for (unsigned r = 0; r < 10; ++r) {
      std::vector<double> x = simulate({}, count, 10 * seed + r);
      Eigen::Map<Eigen::VectorXd> values(x.data(), count);
      values -= basis * (basis.transpose() * values).eval();
      pieces.push_back(std::move(x));
    }
    white += fit_autoregression(pieces, 20, taken).is_white() ? 1 : 0;
    alone += fit_autoregression(pieces, 20).is_white() ? 1 : 0;
  }
  EXPECT_GE(white, 180);
  EXPECT_LE(alone, 150);
}

// What columns with their products add is what they would add as pieces of their own, of any length; the criterion
// differs only by the number of values.
TEST(Autoregression, ColumnsCountAsPiecesByTheirProducts) {
  for (const std::size_t length : {std::size_t{3}, std::size_t{6}, std::size_t{9}, std::size_t{60}}) {
    const std::vector<double> phi{1.6, -0.8};
    std::vector<std::vector<double>> pieces = {simulate(phi, 400, 1), simulate(phi, 300, 2)};
    const std::vector<std::vector<double>> columns = {simulate({0.9}, length, 3), simulate({-0.5}, length, 4)};
    Eigen::MatrixXd b(length, 2);
    for (int i = 0; i < 2; ++i) b.col(i) = Eigen::Map<const Eigen::VectorXd>(columns[i].data(), b.rows());
    const std::vector<TakenColumns> taken = {{lag_products(b, 8), Eigen::Vector2d(400.0, 900.0)}};
    const Autoregression by_products = fit_autoregression(pieces, 8, taken);
    for (std::size_t i = 0; i < 2; ++i) {
      pieces.push_back(columns[i]);
      for (double& value : pieces.back()) value *= i == 0 ? 20.0 : 30.0;
    }
    const Autoregression by_pieces = fit_autoregression(pieces, 8);
    ASSERT_EQ(by_products.coefficient.size(), by_pieces.coefficient.size()) << length;
    EXPECT_NEAR(by_products.innovation, by_pieces.innovation, 1e-11) << length;
    for (std::size_t j = 0; j < by_pieces.coefficient.size(); ++j) {
      EXPECT_NEAR(by_products.coefficient[j], by_pieces.coefficient[j], 1e-11) << length;
    }
  }
}

TEST(Autoregression, FindsItsCoefficients) {
  for (const std::vector<double>& phi :
       {std::vector<double>{0.9}, std::vector<double>{-0.5}, std::vector<double>{1.6, -0.8}}) {
    const std::vector<std::vector<double>> pieces = {simulate(phi, 20000, 7), simulate(phi, 20000, 8)};
    const Autoregression found = fit_autoregression(pieces, 12);
    ASSERT_GE(found.coefficient.size(), phi.size());
    for (std::size_t j = 0; j < phi.size(); ++j) EXPECT_NEAR(found.coefficient[j], phi[j], 0.03);
  }
}

// First order: r(k) = phi^|k|, sum of r^2 = (1 + phi^2) / (1 - phi^2).
TEST(Autoregression, FirstOrderInClosedForm) {
  const double phi = 0.9;
  const Autoregression first{{phi}, 1 - phi * phi};
  EXPECT_NEAR(first.spread(), (1 + phi * phi) / (1 - phi * phi), 1e-6);
  Eigen::MatrixXd a(60, 2);
  for (int t = 0; t < 60; ++t) a.row(t) << std::sin(0.3 * t), 1.0 + 0.1 * t;
  Eigen::MatrixXd r(60, 60);
  for (int s = 0; s < 60; ++s) {
    for (int t = 0; t < 60; ++t) r(s, t) = std::pow(phi, std::abs(s - t));
  }
  const Eigen::MatrixXd expected = a.transpose() * r * a;
  EXPECT_LT((first.weighted_square(a) - expected).norm(), 1e-12 * expected.norm());
  EXPECT_LT((Autoregression{}.weighted_square(a) - a.transpose() * a).norm(), 1e-12 * expected.norm());
}

// Second order, against the autocorrelation by the Yule-Walker recursion.
TEST(Autoregression, SecondOrderOscillation) {
  const double p1 = 1.6, p2 = -0.8;
  std::vector<double> r = {1.0, p1 / (1 - p2)};
  for (int k = 2; k < 400; ++k) r.push_back(p1 * r[k - 1] + p2 * r[k - 2]);
  const Autoregression second{{p1, p2}, 1 - p1 * r[1] - p2 * r[2]};
  double squares = 1.0;
  for (int k = 1; k < 400; ++k) squares += 2 * r[k] * r[k];
  EXPECT_NEAR(second.spread(), squares, 1e-6 * squares);
  for (const int rows : {1, 2, 3, 200, 400}) {
    Eigen::MatrixXd a(rows, 1);
    for (int t = 0; t < rows; ++t) a(t, 0) = std::cos(0.4 * t);
    double expected = 0.0;
    for (int s = 0; s < rows; ++s) {
      for (int t = 0; t < rows; ++t) expected += a(s, 0) * r[std::abs(s - t)] * a(t, 0);
    }
    EXPECT_NEAR(second.weighted_square(a)(0, 0), expected, 1e-12 * expected) << rows;
  }
}

}  // namespace
}  // namespace poise::solvers::autoregression_test
