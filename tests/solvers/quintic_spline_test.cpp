#include "solvers/quintic_spline.hpp"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::solvers::quintic_spline_test {
namespace {

using Numbers = std::vector<double>;

double at(const QuinticSpline& spline, double t, int derivative) {
  std::size_t i = 0;
  while (i + 1 < spline.pieces.size() && spline.breaks[i + 1] <= t) ++i;
  double sum = 0.0;
  for (int k = 5; k >= derivative; --k) {
    double factor = 1.0;
    for (int d = 0; d < derivative; ++d) factor *= k - d;
    sum = sum * (t - spline.breaks[i]) + factor * spline.pieces[i][static_cast<std::size_t>(k)];
  }
  return sum;
}

double sine(double t, int derivative) {
  constexpr double w = 7.0;
  return 0.3 * std::pow(w, derivative) * std::sin(w * t + derivative * std::acos(0.0));
}

/// Times about `step` apart, by up to 40 % more or less.
Numbers uneven(std::size_t count, double step) {
  Numbers t;
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<double>(i);
    t.push_back(2.0 + step * (k + 0.2 * std::sin(2.4 * k)));
  }
  return t;
}

TEST(InterpolatingSpline, IsAnyPolynomialOfDegreeFive) {
  const auto polynomial = [](double t) { return 1 + t * (2 + t * (-3 + t * (1 + t * (0.5 - 0.2 * t)))); };
  for (const std::size_t count : {6U, 7U, 30U}) {
    const Numbers t = uneven(count, 0.1);
    Numbers y;
    for (const double x : t) y.push_back(polynomial(x));
    const QuinticSpline spline = interpolating_spline(t, y);
    ASSERT_EQ(spline.pieces.size(), count - 5);
    for (double x = t.front(); x <= t.back(); x += 0.01) EXPECT_NEAR(at(spline, x, 0), polynomial(x), 1e-9);
  }
}

TEST(InterpolatingSpline, HasFourContinuousDerivatives) {
  const Numbers t = uneven(60, 0.02);
  Numbers y;
  for (const double x : t) y.push_back(sine(x, 0));
  const QuinticSpline spline = interpolating_spline(t, y);
  for (std::size_t i = 0; i < t.size(); ++i) EXPECT_NEAR(at(spline, t[i], 0), y[i], 1e-14);
  for (std::size_t i = 1; i < spline.pieces.size(); ++i) {
    const double h = spline.breaks[i] - spline.breaks[i - 1];
    double scale = 1.0;
    for (int d = 0; d <= 4; ++d) {
      double before = 0.0;
      for (int k = 5; k >= d; --k) {
        double factor = 1.0;
        for (int j = 0; j < d; ++j) factor *= k - j;
        before = before * h + factor * spline.pieces[i - 1][static_cast<std::size_t>(k)];
      }
      EXPECT_NEAR(before, at(spline, spline.breaks[i], d), 1e-12 * scale) << i << ", derivative " << d;
      scale /= h;
    }
  }
}

// The error of the second derivative falls with the fourth power of the spacing.
TEST(InterpolatingSpline, ConvergesWithItsOrder) {
  Numbers errors;
  for (const std::size_t count : {40U, 80U, 160U}) {
    const Numbers t = uneven(count, 4.0 / static_cast<double>(count));
    Numbers y;
    for (const double x : t) y.push_back(sine(x, 0));
    const QuinticSpline spline = interpolating_spline(t, y);
    double worst = 0.0;
    for (double x = t[8]; x < t[count - 9]; x += 1e-3) worst = std::max(worst, std::abs(at(spline, x, 2) - sine(x, 2)));
    errors.push_back(worst);
  }
  EXPECT_GT(errors[0] / errors[1], 10.0);
  EXPECT_GT(errors[1] / errors[2], 10.0);
}

TEST(SmoothingSpline, LeavesNoiseAndFollowsTheMotion) {
  std::mt19937_64 random(test::seed(1));
  std::normal_distribution<double> normal;
  constexpr double noise = 1e-3;
  const Numbers t = uneven(4000, 1e-3);
  Numbers y;
  for (const double x : t) y.push_back(sine(x, 0) + noise * normal(random));
  const std::optional<QuinticSpline> spline = smoothing_spline(t, y, noise);
  ASSERT_TRUE(spline);
  EXPECT_LT(spline->pieces.size(), 30U);
  double errors[3] = {};
  int count = 0;
  for (double x = t[100]; x < t[3900]; x += 1e-3, ++count) {
    for (int d = 0; d < 3; ++d) errors[d] += std::pow(at(*spline, x, d) - sine(x, d), 2);
  }
  EXPECT_LT(std::sqrt(errors[0] / count), 0.2 * noise);
  EXPECT_LT(std::sqrt(errors[1] / count), 0.01) << "of 2.1 / s";
  EXPECT_LT(std::sqrt(errors[2] / count), 0.3) << "of 14.7 / s^2";
  for (int d = 0; d < 3; ++d) {
    RecordProperty("rms_error_of_derivative_" + std::to_string(d), std::to_string(std::sqrt(errors[d] / count)));
  }
}

TEST(SmoothingSpline, NeedsReadingsAsGoodAsTheirNoise) {
  std::mt19937_64 random(test::seed(1));
  std::normal_distribution<double> normal;
  const Numbers t = uneven(500, 1e-2);
  Numbers y;
  for (const double x : t) y.push_back(sine(x, 0) + 1e-3 * normal(random));
  EXPECT_FALSE(smoothing_spline(t, y, 1e-4));
  const Numbers few(t.begin(), t.begin() + 6);
  EXPECT_FALSE(smoothing_spline(few, Numbers(6, 2.0), 1e-3)) << "six coefficients of six points leave no residual";
}

}  // namespace
}  // namespace poise::solvers::quintic_spline_test
