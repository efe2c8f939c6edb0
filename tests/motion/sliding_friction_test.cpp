#include "motion/sliding_friction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/forces_along.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/friction/held.hpp"
#include "tests/support/seed.hpp"

namespace poise::sliding_friction_test {
namespace {

using State = SlidingFriction::State;

/// The forces of a scene driven at this place and rate by its first drive.
Forces driven(const std::string& text, const std::string& drive, double at, double rate) {
  Scene scene = parse_scene(text, "test");
  scene.drives = {find_drive(scene, drive)};
  const MotionModel model(std::move(scene));
  SweepOptions options;
  options.rate = rate;
  const ForcesAlong found = forces_over(model, {{drive, at, at}}, options, true);
  EXPECT_EQ(found.poses.size(), 1U) << found.why;
  return found.poses.at(0);
}

void expect_balance(const Forces& forces) {
  EXPECT_LT(forces.power.error, 1e-9);
  EXPECT_LT(forces.work_error, 1e-9);
  EXPECT_TRUE(forces.balanced);
  for (const SlidingJoint& one : forces.friction.joints) {
    EXPECT_NEAR(std::abs(one.effort), one.bound, 1e-9 * std::max(1.0, one.bound));
    EXPECT_GE(one.lost(), 0.0);
  }
}

// A nut with a weight W on a thread of lead angle l, unrolled, pushed along the circumference by a collar on a level
// guide: the drive raises W at the efficiency tan l / tan(l + phi).
std::string screw(double lead, double mu, double weight) {
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0] }}
[body.collar]
points = {{ A = [0, 0] }}
[body.nut]
points = {{ A = [0, 0] }}
[[slide]]
name = "push"
points = ["ground.O", "collar.A"]
axis = [1, 0]
[[pin_in_slot]]
name = "groove"
points = ["collar.A", "nut.A"]
axis = [0, 1]
[[slide]]
name = "thread"
points = ["ground.O", "nut.A"]
axis = [{:.17g}, {:.17g}]
friction = {{ coefficient = {:.17g} }}
[[force]]
name = "W"
at = "nut.A"
vector = [0, {:.17g}]
)",
                     std::cos(lead), std::sin(lead), mu, -weight);
}

TEST(SlidingFriction, ScrewRaisesAndLowersAsInShigley) {
  for (const double lead : {0.05, 0.2, 0.6}) {
    for (const double mu : {0.05, 0.12, 0.3}) {
      const double phi = std::atan(mu), weight = 5000.0;
      const Forces up = driven(screw(lead, mu, weight), "push", 0.0, 0.01);
      ASSERT_EQ(up.friction.state, State::solved);
      expect_balance(up);
      EXPECT_NEAR(up.drives[0].value, weight * std::tan(lead + phi), 1e-9 * weight);
      EXPECT_NEAR(up.friction.efforts_without[0], weight * std::tan(lead), 1e-9 * weight);
      ASSERT_TRUE(up.friction.efficiency());
      EXPECT_NEAR(*up.friction.efficiency(), std::tan(lead) / std::tan(lead + phi), 1e-11);
      EXPECT_FALSE(up.friction.efficiency_back());

      const Forces down = driven(screw(lead, mu, weight), "push", 0.0, -0.01);
      expect_balance(down);
      EXPECT_NEAR(down.drives[0].value, weight * std::tan(lead - phi), 1e-9 * weight);
      EXPECT_FALSE(down.friction.efficiency());
      ASSERT_TRUE(down.friction.efficiency_back());
      EXPECT_NEAR(*down.friction.efficiency_back(), std::max(0.0, std::tan(lead - phi) / std::tan(lead)), 1e-11);
    }
  }
}

// With l + phi beyond a right angle no push raises the nut; just below it a great one does.
TEST(SlidingFriction, ScrewThatLocksForwards) {
  const double lead = 1.2, edge = std::tan(std::numbers::pi / 2 - lead);
  const Forces locked = driven(screw(lead, edge * (1 + 1e-6), 100.0), "push", 0.0, 0.01);
  EXPECT_TRUE(locked.friction.has_no_forces());
  EXPECT_EQ(locked.friction.state, State::locked);
  const Forces moves = driven(screw(lead, edge * (1 - 1e-6), 100.0), "push", 0.0, 0.01);
  ASSERT_EQ(moves.friction.state, State::solved);
  EXPECT_NEAR(moves.drives[0].value / (100.0 * std::tan(lead + std::atan(edge * (1 - 1e-6)))), 1.0, 1e-6);
}

// A crank of mass 0 on a pin of friction circle c with a load P at its arm a: the torque T of the drive is P a + c P,
// because the pin carries P. With a torque as well as a force on it the pin carries no more.
TEST(SlidingFriction, FrictionCircleOfACrank) {
  const std::string text = R"(
[ground]
points = { O = [0, 0] }
[body.crank]
points = { A = [0, 0], B = [0.3, 0] }
[[pin]]
name = "O"
points = ["ground.O", "crank.A"]
friction = { radius = 0.02, coefficient = 0.25, torque = 0.7 }
[[force]]
name = "P"
at = "crank.B"
vector = [0, -40]
)";
  const double circle = 0.02 * 0.25 / std::sqrt(1 + 0.25 * 0.25);
  for (const double angle : {0.0, 0.5, 2.0}) {
    for (const double rate : {1e-3, -1e-3}) {
      const Forces found = driven(text, "crank", angle, rate);
      ASSERT_EQ(found.friction.state, State::solved);
      expect_balance(found);
      const double ideal = 40 * 0.3 * std::cos(angle), friction = circle * 40 + 0.7;
      EXPECT_NEAR(found.drives[0].value, ideal + (rate > 0 ? friction : -friction), 1e-11);
      EXPECT_NEAR(found.friction.lost(), friction * std::abs(rate), 1e-14);
    }
  }
}

// A drawer of length L pulled by P at the height e over its axis, pushed back by S on it: contact at both ends, the
// couple P e.
std::string drawer(double offset, double mu, double length) {
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0] }}
[body.handle]
points = {{ A = [0, 0] }}
[body.drawer]
points = {{ A = [0, 0], H = [0, {0:.17g}] }}
[[slide]]
name = "guides"
points = ["ground.O", "drawer.A"]
axis = [1, 0]
friction = {{ coefficient = {1:.17g}, length = {2:.17g} }}
[[slide]]
name = "pull"
points = ["ground.O", "handle.A"]
axis = [1, 0]
[[pin_in_slot]]
name = "grip"
points = ["handle.A", "drawer.H"]
axis = [0, 1]
[[force]]
name = "S"
at = "drawer.A"
vector = [-10, 0]
)",
                     offset, mu, length);
}

TEST(SlidingFriction, DrawerPulledBesideItsAxis) {
  // P = S + mu 2 P e / L.
  const Forces found = driven(drawer(0.1, 0.3, 0.4), "pull", 0.0, 1e-3);
  ASSERT_EQ(found.friction.state, State::solved);
  expect_balance(found);
  EXPECT_NEAR(found.drives[0].value, 10.0 / (1 - 2 * 0.3 * 0.1 / 0.4), 1e-10);
  EXPECT_EQ(found.friction.joints.size(), 1U);
  // It sticks where 2 mu e / L reaches 1: friction grows as fast as the pull.
  EXPECT_EQ(driven(drawer(0.1, 2.0 * (1 + 1e-6), 0.4), "pull", 0.0, 1e-3).friction.state, State::locked);
  EXPECT_EQ(driven(drawer(0.1, 2.0 * (1 - 1e-6), 0.4), "pull", 0.0, 1e-3).friction.state, State::solved);
}

// Beyond that edge a nut that is pulled up may bear on either flank of the thread: no effort is claimed.
TEST(SlidingFriction, SeveralSolutionsAreNone) {
  const double lead = 1.2, edge = std::tan(std::numbers::pi / 2 - lead);
  const Forces found = driven(screw(lead, 1.5 * edge, -100.0), "push", 0.0, 0.01);
  EXPECT_EQ(found.friction.state, State::several);
  EXPECT_FALSE(found.friction.efficiency());
  EXPECT_EQ(driven(screw(lead, 0.9 * edge, -100.0), "push", 0.0, 0.01).friction.state, State::solved);
}

// Two guides side by side share a load that statics does not divide.
TEST(SlidingFriction, BoundsOfIndeterminateForcesAreNotKnown) {
  std::string text = drawer(0.1, 0.3, 0.4);
  text.replace(text.find("[[force]]"), 0, R"([[slide]]
name = "second"
points = ["ground.Q", "drawer.H"]
axis = [1, 0]
)");
  text.replace(text.find("O = [0, 0]"), 10, "O = [0, 0], Q = [0, 0.1]");
  const Forces found = driven(text, "pull", 0.0, 1e-3);
  EXPECT_EQ(found.friction.state, State::undetermined);
  EXPECT_EQ(found.friction.because_of, 0);
}

TEST(SlidingFriction, StandingStillIsLeftOut) {
  Scene scene = parse_scene(drawer(0.1, 0.3, 0.4), "test");
  scene.drives = {find_drive(scene, "pull")};
  const ForcesAlong found = forces_in_place(MotionModel(scene));
  EXPECT_EQ(found.poses[0].friction.state, State::still);
  EXPECT_NEAR(found.poses[0].drives[0].value, 10.0, 1e-12);
}

// A slider-crank with friction in everything, its block loaded by P and its crank by M.
std::string slider_crank(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const double crank = 0.1, rod = 0.2 + 0.3 * u(random), theta = 0.4 + 1.6 * u(random);
  const double x = crank * std::cos(theta) + std::sqrt(rod * rod - std::pow(crank * std::sin(theta), 2));
  const double Py = 20 * (u(random) - 0.5), Px = 40 * (u(random) - 0.5), coefficient = 0.3 * u(random);
  const double B = 0.008 * u(random), dry = 0.1 * u(random), O = 0.01 * u(random);
  return fmt::format(R"(
[units]
angle = "deg"
[ground]
points = {{ O = [0, 0] }}
[body.crank]
points = {{ a = [0, 0], b = [{0}, 0] }}
[body.rod]
points = {{ a = [0, 0], b = [{1:.17g}, 0] }}
[body.block]
points = {{ a = [0, 0] }}
[[pin]]
name = "O"
points = ["ground.O", "crank.a"]
friction = {{ radius = {5:.17g}, coefficient = 0.3, torque = {6:.17g} }}
[[pin]]
name = "B"
points = ["crank.b", "rod.a"]
friction = {{ radius = {7:.17g}, coefficient = 0.2 }}
[[pin]]
name = "C"
points = ["rod.b", "block.a"]
friction = {{ radius = {5:.17g}, coefficient = 0.2 }}
[[slide]]
name = "rail"
points = ["ground.O", "block.a"]
axis = [1, 0]
friction = {{ coefficient = {8:.17g}, length = 0.08, force = {6:.17g} }}
[[force]]
name = "P"
at = "block.a"
vector = [{9:.17g}, {10:.17g}]
[[torque]]
name = "M"
on = "crank"
value = 0
[start]
crank = {2:.17g}
rod = {3:.17g}
rail = {4:.17g}
)",
                     crank, rod, theta * 180 / std::numbers::pi,
                     -std::asin(crank / rod * std::sin(theta)) * 180 / std::numbers::pi, x, O, dry, B, coefficient, Px,
                     Py);
}

// At rates toward zero the effort that drives it in a direction is that end of the range that friction holds, if all
// joints slip there in that direction. It may lie inside: where less friction in one joint lets others hold more, the
// greatest load that is held has not all of friction acting, and the mechanism that moves has.
TEST(SlidingFriction, TheEdgeOfSlippingOfRandomSliderCranks) {
  std::mt19937_64 random(test::seed(7));
  int equal = 0, all = 0;
  for (int k = 0; k < 12; ++k) {
    const std::string text = slider_crank(random);
    const StaticModel model(parse_scene(text, "test"));
    const std::vector<double> x = assemble(model);
    const HeldRange range = held_range(model, x, "load.M");
    ASSERT_TRUE(range.any) << k << range.why;
    const double theta = value_of(model.scene(), Measure::angle_between(0, 1), model.poses(x));
    for (const double rate : {1e-7, -1e-7}) {
      const Forces found = driven(text, "crank", theta, rate);
      ASSERT_EQ(found.friction.state, State::solved) << k;
      expect_balance(found);
      ASSERT_EQ(found.friction.joints.size(), 4U);
      const double torque = found.drives[0].value, most = 1e-8 * std::max(1.0, std::abs(torque));
      EXPECT_LE(torque, range.upper.value + most) << k;
      EXPECT_GE(torque, range.lower.value - most) << k;
      const HeldEnd& end = rate > 0 ? range.upper : range.lower;
      const bool slips_alike =
          end.slips.size() == 4U && std::all_of(end.slips.begin(), end.slips.end(), [&](Slip slip) {
            return slip.increases == (found.friction.joints[slip.of].rate > 0);
          });
      ++all;
      if (!slips_alike) continue;
      ++equal;
      EXPECT_NEAR(torque, end.value, most) << k;
    }
  }
  EXPECT_GE(equal, all - 4);
}

}  // namespace
}  // namespace poise::sliding_friction_test
