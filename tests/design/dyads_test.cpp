#include "design/synthesis/dyads.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace poise::dyads_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

std::vector<BodyPosition> positions(const std::vector<std::array<double, 3>>& rows) {
  std::vector<BodyPosition> out;
  for (const auto& [x, y, angle] : rows) out.push_back({{x, y}, angle * degree});
  return out;
}

struct KnownDyad {
  Vec2 fixed, moving;
  double length;
};

void expect_dyads(const FiveDyads& found, std::vector<KnownDyad> known) {
  ASSERT_TRUE(found.complete);
  ASSERT_EQ(found.dyads.size(), known.size());
  EXPECT_EQ(found.complex, 4 - static_cast<int>(known.size()));
  std::sort(known.begin(), known.end(), [](auto& a, auto& b) { return a.fixed.x < b.fixed.x; });
  for (std::size_t k = 0; k < known.size(); ++k) {
    EXPECT_NEAR(norm(found.dyads[k].fixed - known[k].fixed), 0.0, 2e-8);
    EXPECT_NEAR(norm(found.dyads[k].moving - known[k].moving), 0.0, 2e-8);
    EXPECT_NEAR(found.dyads[k].length, known[k].length, 2e-8);
    EXPECT_TRUE(found.dyads[k].proved);
    EXPECT_LT(found.dyads[k].radius, 1e-20);
  }
}

TEST(Dyads, KnownTasksHaveFourTwoAndNone) {
  const auto four = positions({{0, 0, 0}, {2.8, -1, -85}, {2.5, -0.9, 45}, {0, 1.4, 80}, {3.6, 0.9, -55}});
  expect_dyads(dyads_through(four), {{{-0.56137574, 0.89166075}, {-7.46184148, 1.26986925}, 6.91082261},
                                     {{1.70621019, 0.44833482}, {0.06994478, -0.22516501}, 1.76945374},
                                     {{1.29400440, 1.37410918}, {-1.15997522, 0.83442719}, 2.51262266},
                                     {{1.54304877, -2.30039901}, {-0.93002978, -2.70950025}, 2.50668732}});
  for (const GuidingDyad& dyad : dyads_through(four).dyads) EXPECT_LT(misfit_of(dyad, four), 2e-14);
  expect_dyads(
      dyads_through(positions({{0, 0, 0}, {1.7, 0.9, -45}, {-1.1, 2.2, 45}, {-1.9, -1.4, -10}, {0.3, 3.4, 5}})),
      {{{-3.84307896, 0.03338578}, {-1.42322685, -1.99672431}, 3.15864389},
       {{-0.08853233, 0.13143842}, {4.21111850, -2.34410293}, 4.96138108}});
  expect_dyads(
      dyads_through(positions({{0, 0, 0}, {2.9, -1.5, -60}, {-0.6, -0.9, 55}, {3.3, 1.5, -85}, {-1.5, 0, -10}})), {});
}

using Complex = std::complex<double>;
using Unknowns = Eigen::Vector4cd;  // u, w

/// Newton's method on the differences of squared lengths from a complex start; empty where it does not converge.
std::vector<Complex> newton(const std::vector<BodyPosition>& five, Unknowns x) {
  Eigen::Matrix4cd slopes;
  Unknowns values;
  for (int step = 0; step < 100; ++step) {
    std::array<std::array<Complex, 2>, 5> arm;
    for (std::size_t i = 0; i < 5; ++i) {
      const double c = std::cos(five[i].angle), s = std::sin(five[i].angle);
      arm[i] = {five[i].at.x + c * x[2] - s * x[3] - x[0], five[i].at.y + s * x[2] + c * x[3] - x[1]};
    }
    const auto slope = [&](std::size_t i) {
      const double c = std::cos(five[i].angle), s = std::sin(five[i].angle);
      return Unknowns(-2.0 * arm[i][0], -2.0 * arm[i][1], 2.0 * (c * arm[i][0] + s * arm[i][1]),
                      2.0 * (c * arm[i][1] - s * arm[i][0]));
    };
    for (std::size_t i = 1; i < 5; ++i) {
      values[static_cast<int>(i) - 1] =
          arm[i][0] * arm[i][0] + arm[i][1] * arm[i][1] - arm[0][0] * arm[0][0] - arm[0][1] * arm[0][1];
      slopes.row(static_cast<int>(i) - 1) = (slope(i) - slope(0)).transpose();
    }
    const Unknowns change = slopes.partialPivLu().solve(values);
    x -= change;
    if (!std::isfinite(x.norm()) || x.norm() > 1e8) return {};
    if (change.norm() < 1e-10 * (1 + x.norm())) return {x[0], x[1], x[2], x[3]};
  }
  return {};
}

/// All solutions by Newton's method from random complex starts, until four are found.
std::vector<std::vector<Complex>> by_newton(const std::vector<BodyPosition>& five, std::mt19937& random) {
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::vector<Complex>> out;
  for (int start = 0; start < 20000 && out.size() < 4; ++start) {
    Unknowns x;
    const double spread = 3 * std::exp(2.5 * normal(random));  // some pivots are far away
    for (int k = 0; k < 4; ++k) x[k] = {spread * normal(random), spread * normal(random)};
    const auto found = newton(five, x);
    if (found.empty()) continue;
    const bool known = std::any_of(out.begin(), out.end(), [&](const auto& other) {
      double difference = 0.0, size = 1.0;
      for (std::size_t k = 0; k < 4; ++k) {
        difference += std::abs(other[k] - found[k]);
        size += std::abs(found[k]);
      }
      return difference < 1e-6 * size;
    });
    if (!known) out.push_back(found);
  }
  return out;
}

TEST(Dyads, RandomTasksHaveAsManyAsNewtonsMethodFinds) {
  std::mt19937 random(20260101);
  std::uniform_real_distribution<double> place(-2, 2), turn(-90, 90);
  std::array<int, 5> tasks_with{};
  for (int task = 0; task < 300; ++task) {
    std::vector<std::array<double, 3>> rows;
    for (int k = 0; k < 5; ++k) rows.push_back({place(random), place(random), turn(random)});
    const auto five = positions(rows);
    const FiveDyads found = dyads_through(five);
    ASSERT_TRUE(found.complete) << task;
    const auto all = by_newton(five, random);
    ASSERT_EQ(all.size(), 4u) << task;
    std::size_t real = 0;
    for (const auto& x : all) {
      double imaginary = 0.0, size = 1.0;
      for (const Complex& one : x) {
        imaginary += std::abs(one.imag());
        size += std::abs(one);
      }
      if (imaginary > 1e-9 * size) continue;
      ++real;
      const double distance = std::transform_reduce(
          found.dyads.begin(), found.dyads.end(), INFINITY, [](double a, double b) { return std::min(a, b); },
          [&](const GuidingDyad& d) {
            return norm(d.fixed - Vec2{x[0].real(), x[1].real()}) + norm(d.moving - Vec2{x[2].real(), x[3].real()});
          });
      EXPECT_LT(distance, 1e-7 * size) << task;
    }
    EXPECT_EQ(found.dyads.size(), real) << task;
    ++tasks_with[found.dyads.size()];
  }
  EXPECT_EQ(tasks_with[1] + tasks_with[3], 0);
  EXPECT_GT(tasks_with[0], 10);
  EXPECT_GT(tasks_with[2], 10);
  EXPECT_GT(tasks_with[4], 10);
}

TEST(Dyads, ForgottenLinksAreFound) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-3, 3), turn(-1, 1);
  for (int task = 0; task < 200; ++task) {
    // A link alone: the turn of the body and of the link are free.
    const Vec2 fixed{place(random), place(random)}, moving{place(random), place(random)};
    const double length = 1.5 + 0.4 * place(random);
    std::vector<BodyPosition> five;
    for (int k = 0; k < 5; ++k) {
      const double angle = 1.5 * turn(random);
      five.push_back({fixed + length * unit(2 * turn(random)) - unit(angle) * moving, angle});
    }
    const FiveDyads found = dyads_through(five);
    ASSERT_TRUE(found.complete) << task;
    EXPECT_GE(found.dyads.size(), 2u);
    double least = INFINITY;
    for (const GuidingDyad& d : found.dyads) least = std::min(least, norm(d.fixed - fixed) + norm(d.moving - moving));
    EXPECT_LT(least, 1e-8) << task;
  }
}

TEST(Dyads, PlantedSlidesAreFound) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-3, 3), turn(-1, 1);
  for (int task = 0; task < 40; ++task) {
    const bool on_ground = task % 2 == 0;
    const Vec2 point{place(random), place(random)}, other{place(random), place(random)}, axis = unit(place(random));
    std::vector<BodyPosition> five;
    for (int k = 0; k < 5; ++k) {
      const double angle = turn(random), travel = place(random);
      // The point `other` of the body on a line through `point` of the world, or a line of the body through `other`
      // over that point.
      const Vec2 at =
          on_ground ? point + travel * axis - unit(angle) * other : point - unit(angle) * (other + travel * axis);
      five.push_back({at, angle});
    }
    const FiveDyads found = dyads_through(five);
    ASSERT_TRUE(found.complete) << task;
    const auto slide = std::find_if(found.dyads.begin(), found.dyads.end(),
                                    [](const GuidingDyad& d) { return d.kind != GuidingDyad::Kind::link; });
    ASSERT_NE(slide, found.dyads.end()) << task;
    EXPECT_EQ(slide->kind, on_ground ? GuidingDyad::Kind::slide_on_ground : GuidingDyad::Kind::slide_on_body);
    EXPECT_NEAR(cross(slide->axis, axis), 0.0, 1e-9);
    EXPECT_NEAR(norm(on_ground ? slide->moving - other : slide->fixed - point), 0.0, 1e-8);
    EXPECT_LT(misfit_of(*slide, five), 1e-10);
    EXPECT_FALSE(slide->proved);
  }
}

TEST(Dyads, DoubleSolutionsAreFoundOnceAndNotCalledProved) {
  // Two pairs of poses are turned alike, and a slide is a double solution.
  const auto five = positions({{-1, -2, 105}, {-2, -3, 105}, {-1, -2, 135}, {-1, -3, 15}, {-2, -2, 15}});
  const FiveDyads found = dyads_through(five);
  EXPECT_FALSE(found.complete);
  EXPECT_EQ(found.dyads.size(), 3u);
  for (const GuidingDyad& dyad : found.dyads) {
    EXPECT_LT(misfit_of(dyad, five), 1e-9);
    EXPECT_FALSE(dyad.proved);
  }
}

TEST(Dyads, DependentConditionsAreSaid) {
  // A body that only turns about a point has infinitely many links to that point.
  std::vector<BodyPosition> five;
  for (int k = 0; k < 5; ++k) five.push_back({{1, 2}, 0.3 * k});
  EXPECT_TRUE(dyads_through(five).dependent);
  // So has one that is shifted only.
  five = positions({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 3, 0}, {4, 2, 0}});
  EXPECT_TRUE(dyads_through(five).dependent);
}

}  // namespace
}  // namespace poise::dyads_test
