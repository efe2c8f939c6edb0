// Gas struts: the force and the work of a stroke in closed form, near the isothermal case too, and beyond the stroke.

#include "model/laws/gas_strut.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include "solvers/ball.hpp"
#include "solvers/real50.hpp"

namespace poise::gas_strut_test {
namespace {

using solvers::Ball;

// 500 N with the rod out at 0.5 m, 700 N with it in by 0.2 m.
GasStrut strut(double exponent) { return {500.0, 0.5, 0.2, 1.4, exponent}; }

// As variables.
template <class T>
std::array<ceres::Jet<T, 5>, 5> numbers_of_strut(const GasStrut& of) {
  const std::array values{of.preload, of.length, of.stroke, of.ratio, of.exponent};
  std::array<ceres::Jet<T, 5>, 5> out;
  for (int k = 0; k < 5; ++k) out[static_cast<std::size_t>(k)] = {T(values[static_cast<std::size_t>(k)]), k};
  return out;
}

TEST(GasStrut, PushesAsItsDataSheetSays) {
  for (const double n : {0.9, 1.0, 1.2, 1.4}) {
    EXPECT_NEAR(strut(n).at_rest(0.5).value, -500.0, 1e-11) << n;
    EXPECT_NEAR(strut(n).at_rest(0.3).value, -700.0, 1e-10) << n;
  }
}

// p V^n = constant with the gas volume V0 = A s / b:  F (V0 / (V0 - A u))^n.
TEST(GasStrut, IsAPolytropicGas) {
  for (const double n : {1.0, 1.2, 1.4}) {
    const double b = 1 - std::pow(1.4, -1 / n);
    for (const double u : {0.03, 0.1, 0.17}) {
      const double volume = 0.2 / b;
      EXPECT_NEAR(strut(n).at_rest(0.5 - u).value, -500 * std::pow(volume / (volume - u), n), 1e-10);
    }
  }
}

// Isothermal: F s/b ln(1/(1 - b)) with b = 1 - 1/1.4, hence F s 3.5 ln 1.4; polytropic F s/b ((1-b)^(1-n) - 1)/(n - 1).
TEST(GasStrut, TakesTheWorkOfAStroke) {
  EXPECT_NEAR(strut(1.0).energy(0.3) - strut(1.0).energy(0.5), 500 * 0.2 * 3.5 * std::log(1.4), 1e-11);
  const double n = 1.3, b = 1 - std::pow(1.4, -1 / n);
  EXPECT_NEAR(strut(n).energy(0.3), 500 * 0.2 / b * (std::pow(1 - b, 1 - n) - 1) / (n - 1), 1e-10);
}

// Near n = 1 the quotient above is rounding; the energy and its derivatives are not.
TEST(GasStrut, IsAccurateNearTheIsothermalCase) {
  for (const double n : {1.0, 1.0 + 1e-14, 1.0 + 1e-9, 1.0 - 1e-6, 1.001, 3.0}) {
    for (const double g : {0.31, 0.4, 0.499}) {
      const GasStrut of = strut(n);
      const Real50 exact = of.energy(Real50(g));
      EXPECT_NEAR(of.energy(g), static_cast<double>(exact), 1e-14 * 100) << n << " at " << g;
      const ceres::Jet<double, 5> dual = of.with(numbers_of_strut<double>(of).data()).energy(ceres::Jet<double, 5>(g));
      const ceres::Jet<Real50, 5> known =
          of.with(numbers_of_strut<Real50>(of).data()).energy(ceres::Jet<Real50, 5>(Real50(g)));
      for (int k = 0; k < 5; ++k) {
        const auto by = static_cast<double>(known.v[k]);
        EXPECT_NEAR(dual.v[k], by, 1e-12 * (1 + std::abs(by))) << n << " at " << g << " by " << k;
      }
    }
  }
}

TEST(GasStrut, HasTheForceThatItsEnergyFallsBy) {
  const Real50 h("1e-15");
  for (const double n : {1.0, 1.25}) {
    for (const double length : {0.25, 0.35, 0.45, 0.55}) {  // behind, in and before the stroke
      const Real50 g = length;
      const GasStrut of = strut(n);
      const Real50 slope = (of.energy(Real50(g + h)) - of.energy(Real50(g - h))) / (2 * h);
      EXPECT_LT(static_cast<double>(abs(slope - of.at_rest(g).value)), 1e-10) << n << " at " << length;
    }
  }
}

TEST(GasStrut, GoesOnAlongItsTangentsBeyondTheStroke) {
  const GasStrut of = strut(1.2);
  for (const double end : {0.3, 0.5}) {
    const double outward = end == 0.3 ? -1.0 : 1.0;
    const double beside = 0.01;
    const LawForce<double> at = of.at_rest(end + outward * 1e-9), far = of.at_rest(end + outward * beside);
    EXPECT_NEAR(far.value, at.value + outward * (beside - 1e-9) * at.by_measure, 1e-9);
    EXPECT_DOUBLE_EQ(far.by_measure, at.by_measure);
    EXPECT_NEAR(at.by_measure, of.at_rest(end - outward * 1e-9).by_measure, 1e-4);
  }
}

TEST(GasStrut, EnclosesTheForcesOfABall) {
  const GasStrut of = strut(1.2);
  for (const double middle : {0.28, 0.3, 0.35, 0.4, 0.5, 0.52}) {
    for (const double radius : {1e-9, 1e-4, 1e-2}) {
      for (const double share : {-0.99, -0.3, 0.0, 0.6, 0.99}) {
        const Ball g = Ball(middle).widened(radius);
        const Ball inside(middle + share * radius);
        EXPECT_TRUE(of.at_rest(g).value.contains(of.at_rest(inside).value)) << middle << " +- " << radius;
        EXPECT_TRUE(of.at_rest(g).by_measure.contains(of.at_rest(inside).by_measure)) << middle << " +- " << radius;
        EXPECT_TRUE(of.energy(g).contains(Ball(of.energy(middle + share * radius)))) << middle << " +- " << radius;
      }
    }
  }
}

}  // namespace
}  // namespace poise::gas_strut_test
