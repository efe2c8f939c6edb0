// Springs whose force is a curve: the curve itself, its work, and its derivatives by the points.

#include "model/laws/curve_spring.hpp"

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "model/laws/laws.hpp"
#include "solvers/ball.hpp"
#include "solvers/real50.hpp"
#include "tests/support/seed.hpp"

namespace poise::curve_spring_test {
namespace {

using solvers::Ball;
using Real = Real50;

// Uneven pieces that rise, fall, stay level and rise again.
ForceCurve wavy() { return {{-1.0, 0.5, 1.0, 2.5, 3.0, 5.0, 5.25}, {-2.0, 1.0, 4.0, 3.0, 3.0, 3.5, 9.0}}; }

double relative(const Real& found, const Real& expected) {
  return std::abs(static_cast<double>(found - expected)) / (1 + std::abs(static_cast<double>(expected)));
}

TEST(ForceCurve, PassesThroughItsPointsAndIsTheLineThroughTwo) {
  const ForceCurve curve = wavy();
  for (std::size_t k = 0; k < curve.points(); ++k) {
    EXPECT_DOUBLE_EQ(curve.force(curve.x()[k]).first, curve.forces()[k]);
  }
  const ForceCurve line({1.0, 3.0}, {4.0, 10.0});
  for (const double x : {-5.0, 1.0, 1.75, 3.0, 8.0}) {
    EXPECT_DOUBLE_EQ(line.force(x).first, 3 * x + 1);
    EXPECT_DOUBLE_EQ(line.force(x).second, 3.0);
    EXPECT_DOUBLE_EQ(line.work(x), 1.5 * (x * x - 1) + (x - 1));
  }
}

// By hand: secants 2, 1, 3, widths 1, 1, 2. Slopes inside: a = 1/2 gives 1 / (1/4 + 1/2) = 4/3; a = 5/9 gives
// 1 / (5/9 + 4/27) = 27/19; at the ends (6 - 4/3)/2 = 7/3 and (9 - 27/19)/2 = 72/19.
TEST(ForceCurve, HasTheSlopesOfItsDocumentation) {
  const ForceCurve curve({0.0, 1.0, 2.0, 4.0}, {0.0, 2.0, 3.0, 9.0});
  EXPECT_NEAR(curve.force(-7.0).second, 7.0 / 3, 1e-15);
  EXPECT_NEAR(curve.force(1.0).second, 4.0 / 3, 1e-15);
  EXPECT_NEAR(curve.force(2.0).second, 27.0 / 19, 1e-15);
  EXPECT_NEAR(curve.force(11.0).second, 72.0 / 19, 1e-14);
  EXPECT_NEAR(curve.force(11.0).first, 9.0 + 7 * 72.0 / 19, 1e-13);
}

TEST(ForceCurve, IsMonotoneWhereItsPointsAre) {
  std::mt19937_64 random(test::seed(5));
  std::uniform_real_distribution<double> width(0.01, 2.0);
  for (int k = 0; k < 300; ++k) {
    std::vector<double> x{0.0}, force{0.0};
    for (int i = 0; i < 6; ++i) {
      x.push_back(x.back() + width(random));
      force.push_back(force.back() + (random() % 4 == 0 ? 0.0 : std::pow(width(random), 4)));
    }
    const ForceCurve curve(x, force);
    for (double at = -1.0; at < x.back() + 1; at += 0.01) ASSERT_GE(curve.force(at).second, -1e-12);
  }
}

TEST(ForceCurve, IsContinuousWithItsSlopeAndAtTheEndsWithItsCurvature) {
  const ForceCurve curve = wavy();
  const Real h("1e-20");
  for (const double x : curve.x()) {
    const auto below = curve.force(Real(x - h)), above = curve.force(Real(x + h));
    EXPECT_LT(relative(above.first, below.first), 1e-17) << x;
    EXPECT_LT(relative(above.second, below.second), 1e-15) << x;
  }
  for (const double x : {curve.x().front(), curve.x().back()}) {
    const Real small("1e-12");
    const Real bend = (curve.force(Real(x + small)).second - curve.force(Real(x - small)).second) / (2 * small);
    EXPECT_LT(abs(bend), 1e-9) << x;
  }
}

// Points that lie much closer at one end, and numbers beside them.
TEST(ForceCurve, FindsThePieceAmongUnevenPoints) {
  std::vector<double> x, force;
  for (int k = 0; k < 40; ++k) {
    x.push_back(std::pow(1.4, k) - 3.0);
    force.push_back(std::sin(k));
  }
  const ForceCurve curve(x, force);
  for (std::size_t k = 0; k < x.size(); ++k) {
    for (const double at : {x[k], std::nextafter(x[k], -1e9), std::nextafter(x[k], 1e9), x[k] + 0.2}) {
      EXPECT_LT(relative(Real(curve.force(at).first), curve.force(Real(at)).first), 1e-9) << at;
    }
  }
  EXPECT_TRUE(std::isnan(curve.force(std::nan("")).first));
}

TEST(ForceCurve, DoubleAgreesWithFiftyDigits) {
  const ForceCurve curve = wavy();
  for (double x = -3.0; x < 8.0; x += 0.0625) {
    EXPECT_LT(relative(Real(curve.force(x).first), curve.force(Real(x)).first), 1e-14) << x;
    EXPECT_LT(relative(Real(curve.force(x).second), curve.force(Real(x)).second), 1e-13) << x;
    EXPECT_LT(relative(Real(curve.work(x)), curve.work(Real(x))), 1e-14) << x;
  }
}

// The integral of each piece of third degree, by Simpson's rule, which is exact for them.
TEST(ForceCurve, WorkIsTheIntegralOfTheForce) {
  const ForceCurve curve = wavy();
  Real sum = 0;
  for (std::size_t k = 1; k < curve.points(); ++k) {
    const Real a = curve.x()[k - 1], b = curve.x()[k];
    const Real middle = (a + b) / 2;
    sum += (b - a) / 6 * (curve.force(a).first + 4 * curve.force(middle).first + curve.force(b).first);
    EXPECT_LT(relative(curve.work(b), sum), 1e-40);
  }
}

TEST(ForceCurve, KnowsItsDerivativesByThePoints) {
  const ForceCurve curve({-1.0, 0.5, 1.0, 2.5, 3.0, 5.0, 5.25}, {-2.0, 1.0, 4.0, 3.0, 3.25, 3.5, 9.0});
  const double step = 0x1p-26;
  for (std::size_t point = 0; point < curve.points(); ++point) {
    EXPECT_TRUE(curve.has_derivatives_by(point));
    const ForceCurve more = curve.with_force(point, curve.forces()[point] + step);
    const ForceCurve less = curve.with_force(point, curve.forces()[point] - step);
    for (const double x : {-2.0, -0.25, 0.625, 1.5, 2.75, 3.5, 5.125, 7.0}) {
      const Real at = x;
      EXPECT_LT(relative(curve.force_by(point, at), (more.force(at).first - less.force(at).first) / (2 * step)), 1e-13);
      EXPECT_NEAR(curve.force_by(point, x), static_cast<double>(curve.force_by(point, at)), 1e-13);
    }
  }
}

TEST(ForceCurve, HasNoDerivativesBesideALevelPiece) {
  const ForceCurve curve = wavy();
  for (std::size_t point = 0; point < curve.points(); ++point) {
    EXPECT_EQ(curve.has_derivatives_by(point), point != 3 && point != 4) << point;
  }
}

TEST(CurveSpring, ScalesAndShiftsItsCurve) {
  CurveSpring spring({0.0, 1.0, 2.0, 4.0}, {0.0, 2.0, 3.0, 9.0}, true);
  spring.scale = 2.0;
  spring.shift = 10.0;
  const ForceCurve& curve = spring.curve();
  EXPECT_EQ(spring.at_rest(11.5).value, 2 * curve.force(1.5).first);
  EXPECT_EQ(spring.at_rest(11.5).by_measure, 2 * curve.force(1.5).second);
  EXPECT_EQ(spring.energy(11.5), 2 * curve.work(1.5));
  CurveSpring rescaled = spring;
  rescaled.rescale(4.0, 0.5);
  rescaled.shift *= 4.0;
  EXPECT_EQ(rescaled.at_rest(46.0).value, 0.5 * spring.at_rest(11.5).value) << "powers of two are exact";
  EXPECT_EQ(rescaled.energy(46.0), 2.0 * spring.energy(11.5));
}

TEST(CurveSpring, HasANumberForEachPoint) {
  Law law = CurveSpring({0.0, 1.0, 2.0}, {0.0, 2.0, 3.0}, true);
  ASSERT_EQ(numbers_of(law).size(), 5U);
  EXPECT_EQ(numbers_of(law)[4].key, "force.3");
  EXPECT_EQ(numbers_of(law)[4].angle_key, "torque.3");
  const Law before = law;
  auto& spring = std::get<CurveSpring>(law);
  numbers_of(law)[4].set(&spring, 7.0);
  EXPECT_EQ(spring.curve().forces()[2], 7.0);
  EXPECT_EQ(std::get<CurveSpring>(before).curve().forces()[2], 3.0) << "copies keep theirs";
  EXPECT_EQ(numbers_of(Law(CurveSpring({0.0, 1.0, 2.0}, {0.0, 2.0, 3.0}, false))).size(), 2U);
}

// A ball across a point holds the forces of both pieces, and slopes and work too.
TEST(CurveSpring, EnclosesTheForcesOfABall) {
  CurveSpring spring({-1.0, 0.5, 1.0, 2.5, 3.0, 5.0, 5.25}, {-2.0, 1.0, 4.0, 3.0, 3.0, 3.5, 9.0}, true);
  spring.scale = 1.5;
  std::mt19937_64 random(test::seed(11));
  std::uniform_real_distribution<double> place(-2.0, 7.0), share(-1.0, 1.0);
  for (int k = 0; k < 500; ++k) {
    const double middle = k % 3 == 0 ? spring.curve().x()[static_cast<std::size_t>(k) % 7] : place(random);
    const double radius = std::pow(10.0, -6 + 5 * std::abs(share(random)));
    const Ball g = Ball(middle).widened(radius);
    const Ball inside(middle + 0.999 * share(random) * radius);
    EXPECT_TRUE(spring.at_rest(g).value.contains(spring.at_rest(inside).value)) << middle << " +- " << radius;
    EXPECT_TRUE(spring.at_rest(g).by_measure.contains(spring.at_rest(inside).by_measure)) << middle;
    EXPECT_TRUE(spring.energy(g).contains(spring.energy(inside))) << middle;
    // As narrow as the ball, also where secants differ in sign.
    EXPECT_LT(spring.at_rest(g).value.radius(), 1e3 * radius);
  }
}

}  // namespace
}  // namespace poise::curve_spring_test
