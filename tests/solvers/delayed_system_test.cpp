// Poles of x' = a x + b x(t - T) are  s = a + W_k(b T exp(-a T))/T  with the branches W_k of Lambert's function
// (R. M. Corless and others, On the Lambert W function, Adv. Comput. Math. 5, 1996).

#include "solvers/delayed_system.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::delayed_system_test {
namespace {

using Complex = std::complex<double>;
using solvers::DelayedSystem;
using solvers::RightmostPoles;

/// W_k(z) by Halley's method; none where it does not converge to that branch.
Complex lambert(int k, const Complex& z) {
  const Complex turn(0.0, 2 * M_PI * k);
  Complex w = std::log(z) + turn;
  if (k != 0 || std::abs(z) > 3.0) w -= std::log(w);
  if (k == 0 && std::abs(z) <= 3.0) w = z / (1.0 + z);
  for (int step = 0; step < 100; ++step) {
    const Complex e = std::exp(w), f = w * e - z;
    w -= f / (e * (w + 1.0) - (w + 2.0) * f / (2.0 * w + 2.0));
  }
  return w;
}

DelayedSystem scalar(double a, double b, double delay) {
  DelayedSystem out;
  out.a = Eigen::MatrixXd::Constant(1, 1, a);
  out.b = Eigen::MatrixXd::Constant(1, 1, b);
  out.c = Eigen::MatrixXd::Constant(1, 1, 1.0);
  out.d = Eigen::MatrixXd::Zero(1, 1);
  out.delays = Eigen::VectorXd::Constant(1, delay);
  return out;
}

double distance(const Complex& s, const std::vector<Complex>& all) {
  double out = 1e300;
  for (const Complex& one : all) out = std::min(out, std::abs(one - s));
  return out;
}

TEST(DelayedSystem, PolesOfFirstOrderAreBranchesOfLambert) {
  std::mt19937_64 random(test::seed(11));
  const auto between = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  int compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double a = between(-4.0, 3.0), delay = std::pow(10.0, between(-2.0, 0.5));
    const double b = std::copysign(std::pow(10.0, between(-1.0, 1.0)), between(-1.0, 1.0));
    const auto found = solvers::rightmost_poles(scalar(a, b, delay), 5);
    ASSERT_TRUE(found) << a << " " << b << " " << delay;
    for (const Complex& s : found->poles) {
      EXPECT_LT(std::abs(s - a - b * std::exp(-s * delay)), 1e-11 * (1 + std::abs(s) + std::abs(b)))
          << a << " " << b << " " << delay;
    }
    for (int k = -12; k <= 12; ++k) {
      const Complex s = a + lambert(k, b * delay * std::exp(-a * delay)) / delay;
      if (std::abs(s - a - b * std::exp(-s * delay)) > 1e-9 * (1 + std::abs(s))) continue;
      if (s.real() < found->right_of) continue;
      ++compared;
      EXPECT_LT(distance(s, found->poles), 1e-7 * (1 + std::abs(s))) << a << " " << b << " " << delay << ": " << s;
    }
  }
  EXPECT_GT(compared, 250);
}

// Two blocks that follow each other late, u1 = c1 x + d u2(t - T2): all poles are roots of the determinant written out,
// and as many as Newton's method finds from a grid.
TEST(DelayedSystem, PolesOfRandomChainsAreAllRootsOfTheirDeterminant) {
  std::mt19937_64 random(test::seed(12));
  const auto between = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
  for (int trial = 0; trial < 12; ++trial) {
    DelayedSystem system;
    system.a = Eigen::MatrixXd::NullaryExpr(2, 2, [&] { return between(-3.0, 3.0); });
    system.b = Eigen::MatrixXd::NullaryExpr(2, 2, [&] { return between(-2.0, 2.0); });
    system.c = Eigen::MatrixXd::NullaryExpr(2, 2, [&] { return between(-2.0, 2.0); });
    system.d = Eigen::MatrixXd::Zero(2, 2);
    system.d(0, 1) = between(-2.0, 2.0);
    system.delays = Eigen::Vector2d(between(0.1, 1.0), between(0.1, 1.0));
    const auto found = solvers::rightmost_poles(system, 6);
    ASSERT_TRUE(found) << trial;
    // u2 = c2 x,  u1 = c1 x + d e2 c2 x:  s - A - b1 e1 (c1 + d e2 c2) - b2 e2 c2.
    const auto determinant = [&](const Complex& s) {
      const Complex e1 = std::exp(-s * system.delays[0]), e2 = std::exp(-s * system.delays[1]);
      const Eigen::MatrixXcd c = system.c.cast<Complex>(), b = system.b.cast<Complex>();
      const Eigen::Matrix2cd m = s * Eigen::Matrix2cd::Identity() - system.a.cast<Complex>() -
                                 e1 * b.col(0) * (c.row(0) + system.d(0, 1) * e2 * c.row(1)) - e2 * b.col(1) * c.row(1);
      return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
    };
    for (const Complex& s : found->poles) EXPECT_LT(std::abs(determinant(s)), 1e-9 * (1 + std::norm(s)));
    int seen = 0;
    for (int i = 0; i < 24; ++i) {
      for (int j = 0; j < 60; ++j) {
        Complex s(found->right_of + 0.5 * i, 0.5 * j), before = s + Complex(1e-3, 1e-3);
        for (int step = 0; step < 60 && std::abs(s - before) > 1e-14 * (1 + std::abs(s)); ++step) {
          const Complex f = determinant(s), next = s - f * (s - before) / (f - determinant(before));
          before = s;
          s = next;
        }
        if (!(std::abs(determinant(s)) < 1e-10 * (1 + std::norm(s))) || s.real() < found->right_of + 1e-7) continue;
        ++seen;
        EXPECT_LT(distance(s, found->poles), 1e-6 * (1 + std::abs(s))) << trial << ": " << s;
      }
    }
    EXPECT_GT(seen, 50);
  }
}

}  // namespace
}  // namespace poise::delayed_system_test
