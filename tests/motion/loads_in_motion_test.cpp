// Internal loads of links in motion, against closed forms and against the masses that they stand for.

#include "motion/loads_in_motion.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "tests/support/motions.hpp"

namespace poise::loads_in_motion_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double m = 3.0, l = 2.0, g = 9.81;

/// A bar on a pin at ground.A, which is not the world's origin; its mass and inertia, and what else there is.
std::string bar(double inertia, const std::string& more, const std::string& gravity = "[0, 0]") {
  return fmt::format(R"(
gravity = {}
[ground]
points = {{ A = [5, -3], B = [9, -3] }}
[body.bar]
points = {{ A = [0, 0], M = [{}, 0], B = [{}, 0] }}
mass = {}
center = [{}, 0]
inertia = {:.17g}
[body.bar.section]
area = 3e-3
second_moment = 8e-6
modulus = 2.1e11
height = 0.2
line = ["A", "B"]
[[pin]]
name = "A"
points = ["ground.A", "bar.A"]
{}
)",
                     gravity, l / 2, l, m, l / 2, inertia, more);
}

const std::string motor = "[[drive]]\nbodies = [\"ground\", \"bar\"]\nname = \"motor\"\n";

LoadsInMotion loads_of(const std::string& text, double time) {
  const MotionModel model(parse_scene(text, "bar.toml"));
  return loads_in_motion(model, start_motion(model, {}), time, {});
}

LinkState state(const LinkLoads& link, double s) {
  const LinkPiece* piece = &link.pieces.front();
  for (const LinkPiece& one : link.pieces) {
    if (one.from <= s) piece = &one;
  }
  return link.at(*piece, s);
}

// N(x) = m w^2 (l^2 - x^2)/(2 l), nothing else.
TEST(LoadsInMotion, BarThatTurnsAboutItsEnd) {
  const double w = 40.0;
  for (const double time : {0.0, 0.37}) {
    const LoadsInMotion found = loads_of(bar(m * l * l / 12, motor + "start = 0.3\nrate = 40\n"), time);
    ASSERT_EQ(found.why, "");
    const LinkLoads& link = found.links.at(0);
    ASSERT_EQ(link.why, "");
    EXPECT_LT(link.imbalance, 1e-12);
    EXPECT_DOUBLE_EQ(link.spread, m);
    for (const double x : {0.0, 0.3, 1.1, 1.7, 2.0}) {
      EXPECT_NEAR(state(link, x).normal, m * w * w * (l * l - x * x) / (2 * l), 1e-9) << x;
      EXPECT_NEAR(state(link, x).shear, 0, 1e-9);
      EXPECT_NEAR(state(link, x).moment, 0, 1e-9);
    }
    EXPECT_NEAR(link.normal.value, m * w * w * l / 2, 1e-9);
    EXPECT_EQ(link.normal.s, 0.0);
    EXPECT_NEAR(link.tension.value, m * w * w * l / 2 / 3e-3, 1e-6);
  }
}

// A bar that falls about its end, at the angle a: M = m g cos(a) x (l - x)^2 / (4 l^2), by size largest at l/3.
TEST(LoadsInMotion, FallingChimneyBreaksAtAThird) {
  for (const double time : {0.0, 0.2, 0.5}) {
    const LoadsInMotion found = loads_of(bar(m * l * l / 12, "[start]\nbar = 1.2\n", fmt::format("[0, {}]", -g)), time);
    ASSERT_EQ(found.why, "");
    const LinkLoads& link = found.links.at(0);
    ASSERT_EQ(link.why, "");
    EXPECT_LT(link.imbalance, 1e-11);
    const BodyMotion& motion = found.forces.motions.at(1);
    const double cosine = std::cos(motion.pose.angle), sine = std::sin(motion.pose.angle), w = motion.rate;
    for (const double x : {0.1, 0.5, 1.0, 1.5, 1.9}) {
      const double far = l - x;
      EXPECT_NEAR(std::abs(state(link, x).moment), m * g * std::abs(cosine) * x * far * far / (4 * l * l), 1e-9);
      // What is beyond x: its weight along the line and its inertia.
      const double normal = m * far / l * (w * w * (l + x) / 2 - g * sine);
      EXPECT_NEAR(state(link, x).normal, normal, 1e-8) << x;
    }
    EXPECT_NEAR(std::abs(link.moment.value), m * g * l * std::abs(cosine) / 27, 1e-9);
    EXPECT_NEAR(link.moment.s, l / 3, 1e-9);
  }
}

// At rest, held by a drive without rate: what statics has, of the weight along the line.
TEST(LoadsInMotion, AtRestAreThoseOfStatics) {
  const std::string weight = fmt::format("[0, {}]", -g);
  const LoadsInMotion moving = loads_of(bar(m * l * l / 12, motor + "start = 0.4\n", weight), 0.3);
  const StaticModel model(parse_scene(
      bar(m * l * l / 12,
          "[[torsion_spring]]\nbodies = [\"ground\", \"bar\"]\nstiffness = 1e9\nfree_angle = 0.4\n[start]\nbar = 0.4\n",
          weight),
      "bar.toml"));
  const Equilibrium equilibrium = solve_or_hold(model);
  ASSERT_TRUE(equilibrium.found());
  const LinkLoads still = link_loads(model.scene(), model.poses(equilibrium.x), equilibrium.check).at(0);
  ASSERT_EQ(still.why, "");
  ASSERT_EQ(moving.links.at(0).why, "");
  for (const double x : {0.0, 0.4, 1.3, 1.9}) {
    EXPECT_NEAR(state(moving.links[0], x).normal, state(still, x).normal, 1e-5);
    EXPECT_NEAR(state(moving.links[0], x).shear, state(still, x).shear, 1e-5);
    EXPECT_NEAR(state(moving.links[0], x).moment, state(still, x).moment, 1e-5);
  }
}

// All mass at the middle: N = m w^2 l/2 as far as there, none beyond; half of the inertia: half of the mass along the
// line; more inertia than a bar has: all along the line, and a couple in the middle.
TEST(LoadsInMotion, MassIsSpreadAsFarAsTheMomentOfInertiaAllows) {
  const double w = 10.0, alpha = 7.0;
  const std::string turns = motor + "start = 0.3\nrate = 10\nacceleration = 7\n";
  const double uniform = m * l * l / 12;
  for (const double share : {0.0, 0.5, 1.0, 1.6}) {
    const LoadsInMotion found = loads_of(bar(share * uniform, turns), 0.0);
    const LinkLoads& link = found.links.at(0);
    ASSERT_EQ(link.why, "") << share;
    EXPECT_LT(link.imbalance, 1e-12) << share;
    const double spread = std::min(1.0, share) * m, lumped = m - spread;
    EXPECT_NEAR(link.spread, spread, 1e-12);
    for (const double x : {0.2, 0.9, 1.1, 1.8}) {
      const double point = x < l / 2 ? lumped : 0.0;
      EXPECT_NEAR(state(link, x).normal, spread * w * w * (l * l - x * x) / (2 * l) + point * w * w * l / 2, 1e-9);
      // Beyond x the part carries - dm alpha y to the side; M about x, stretched on the right of the line if positive.
      const double bar_moment = spread / l * alpha * (l * l * l / 3 - x * l * l / 2 + x * x * x / 6);
      const double extra = x < l / 2 ? std::max(0.0, share - 1) * uniform * alpha : 0.0;
      EXPECT_NEAR(state(link, x).moment, -(bar_moment + point * alpha * l / 2 * (l / 2 - x) + extra), 1e-9)
          << share << " " << x;
    }
  }
}

// A bent link of two arms: the line's own radius of gyration, and both ends closed.
TEST(LoadsInMotion, CornersAndForcesOfTimeBalance) {
  const MotionModel model(parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { A = [0.4, 0.2], B = [1.6, 0.1] }
[body.crank]
points = { A = [0, 0], P = [0.3, 0] }
mass = 1
center = [0.1, 0.02]
inertia = 0.02
[body.crank.section]
area = 3e-3
second_moment = 8e-6
modulus = 2.1e11
height = 0.2
[body.coupler]
points = { P = [0, 0], C = [0.6, 0.5], Q = [1.1, 0] }
mass = 4
center = [0.5707, 0.25]
inertia = 0.5
[body.coupler.section]
area = 3e-3
second_moment = 8e-6
modulus = 2.1e11
height = 0.2
line = ["P", "C", "Q"]
[body.rocker]
points = { B = [0, 0], Q = [0.9, 0] }
mass = 2
center = [0.45, 0]
inertia = 0.135
[body.rocker.section]
area = 3e-3
second_moment = 8e-6
modulus = 2.1e11
height = 0.2
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.P", "coupler.P"]
[[pin]]
points = ["coupler.Q", "rocker.Q"]
[[pin]]
points = ["ground.B", "rocker.B"]
[[drive]]
bodies = ["ground", "crank"]
rate = 9
[[force]]
at = "coupler.C"
vector = [30, -40]
time = { sine = { amplitude = 2, frequency = 3 } }
[[damper]]
points = ["ground.B", "coupler.C"]
coefficient = 20
[start]
crank = 1
coupler = 0.3
rocker = 1.4
)",
                                      "four_bar.toml"));
  int whole = 0;
  for (int k = 0; k <= 20; ++k) {
    const LoadsInMotion found = loads_in_motion(model, start_motion(model, {}), 0.04 * k, {});
    ASSERT_EQ(found.why, "");
    ASSERT_TRUE(found.forces.balanced);
    for (const LinkLoads& link : found.links) {
      ASSERT_EQ(link.why, "") << link.name << " " << k;
      EXPECT_LT(link.imbalance, 1e-9) << link.name << " " << k;
      ++whole;
    }
  }
  EXPECT_EQ(whole, 63);
}

}  // namespace
}  // namespace poise::loads_in_motion_test
