#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/friction/held.hpp"

namespace poise::capstan_test {
namespace {

using std::numbers::pi;

/// A weight W and a pull P downwards on the ends of a rope over drums of radius 0.05 in a row, all as high as one
/// another and wrapped from below: half round the first and the last of several by a quarter, round others not at all.
/// `drums`: their centres and pulleys as text.
std::string capstan(const std::string& ground, const std::string& pulleys, double right, double length, double weight,
                    double pull, const std::string& more = {}) {
  return fmt::format(R"(
[ground]
points = {{ A = [-0.05, -1], B = [{0:.17g}, -1], {1} }}
[body.weight]
points = {{ A = [0, 0] }}
[body.hand]
points = {{ B = [0, 0] }}
[[slide]]
name = "left"
points = ["ground.A", "weight.A"]
axis = [0, 1]
[[slide]]
name = "right"
points = ["ground.B", "hand.B"]
axis = [0, 1]
[[rope]]
name = "rope"
over = ["weight.A", {2}, "hand.B"]
length = {3:.17g}
[[force]]
name = "W"
at = "weight.A"
vector = [0, {4:.17g}]
[[force]]
name = "P"
at = "hand.B"
vector = [0, {5:.17g}]
{6}
)",
                     right, ground, pulleys, length, -weight, -pull, more);
}

std::string drum(double mu, double weight, double pull) {
  return capstan(
      "O = [0, 0]",
      fmt::format("{{ pulley = \"ground.O\", radius = 0.05, turn = \"clockwise\", friction = {:.17g} }}", mu), 0.05,
      2 + 0.05 * pi, weight, pull);
}

/// A quarter round the first drum, straight to the second, and a quarter round that.
std::string two_drums(double first, double second, double weight, double pull) {
  const std::string pulley = "{{ pulley = \"ground.{}\", radius = 0.05, turn = \"clockwise\", friction = {:.17g} }}";
  return capstan("O = [0, 0], Q = [0.4, 0]",
                 fmt::format(fmt::runtime(pulley), "O", first) + ", " + fmt::format(fmt::runtime(pulley), "Q", second),
                 0.45, 2 + 0.05 * pi + 0.4, weight, pull);
}

HeldPose held(const std::string& text) {
  const StaticModel model(parse_scene(text, "test"));
  return held_pose(model, assemble(model));
}

HeldRange range(const std::string& text, const std::string& number) {
  const StaticModel model(parse_scene(text, "test"));
  return held_range(model, assemble(model), number);
}

void expect_verdict(const HeldPose& pose, bool is_held, const std::string& what) {
  EXPECT_EQ(pose.verdict, is_held ? Holding::held : Holding::slips) << what << ": " << pose.why;
  EXPECT_TRUE(pose.proved) << what;
}

TEST(Capstan, TwoWeightsOverADrum) {
  for (const double mu : {0.05, 0.3, 1.0}) {
    const double most = std::exp(mu * pi);
    expect_verdict(held(drum(mu, 1.0, most * (1 - 1e-9))), true, "below the greatest ratio");
    const HeldPose slips = held(drum(mu, 1.0, most * (1 + 1e-9)));
    expect_verdict(slips, false, "above it");
    ASSERT_EQ(slips.slips.size(), 1U);
    EXPECT_TRUE(slips.slips[0].increases) << "the hand pulls the rope to its last point";
    expect_verdict(held(drum(mu, most * (1 - 1e-9), 1.0)), true, "the other way");
    expect_verdict(held(drum(mu, most * (1 + 1e-9), 1.0)), false, "the other way");
  }
}

TEST(Capstan, TheLeastFactorMultipliesTheCoefficient) {
  const HeldPose pose = held(drum(0.3, 2.0, 3.0));
  expect_verdict(pose, true, "");
  EXPECT_NEAR(pose.least_factor, std::log(1.5) / (0.3 * pi), 1e-11);
  ASSERT_EQ(pose.efforts.size(), 1U);
  EXPECT_NEAR(pose.efforts[0].effort, -1.0, 1e-9) << "the rim holds the rope back";
  EXPECT_NEAR(pose.efforts[0].bound, 2.0 * std::expm1(0.3 * pi), 1e-9);
}

TEST(Capstan, DrumsInSeries) {
  for (const double first : {0.0, 0.1, 0.4}) {
    const double most = std::exp((first + 0.25) * pi / 2);
    expect_verdict(held(two_drums(first, 0.25, 10.0, 10 * most * (1 - 1e-9))), true, "below");
    expect_verdict(held(two_drums(first, 0.25, 10.0, 10 * most * (1 + 1e-9))), false, "above");
  }
}

TEST(Capstan, RangesOfLoadAndCoefficient) {
  const HeldRange load = range(drum(0.3, 400.0, 300.0), "load.P");
  EXPECT_TRUE(load.contains_now);
  EXPECT_NEAR(load.lower.value, 400 * std::exp(-0.3 * pi), 1e-9);
  EXPECT_NEAR(load.upper.value, 400 * std::exp(0.3 * pi), 1e-8);
  EXPECT_TRUE(load.lower.proved);
  EXPECT_TRUE(load.upper.proved);
  ASSERT_TRUE(load.ideal);
  EXPECT_NEAR(*load.ideal, 400.0, 1e-9);
  EXPECT_NEAR(load.efficiency().value_or(0.0), std::exp(-0.3 * pi), 1e-11);

  const HeldRange coefficient = range(two_drums(0.1, 0.25, 1.0, 1.5), "rope.rope.friction.2");
  EXPECT_NEAR(coefficient.lower.value, std::log(1.5) / (pi / 2) - 0.1, 1e-11);
  EXPECT_TRUE(coefficient.lower.proved);
}

// A pulley that turns on its pin without friction holds nothing, however rough its rim is.
TEST(Capstan, APulleyThatTurnsHoldsNothing) {
  const auto on_wheel = [](double pull, const std::string& pin) {
    return capstan("O = [0, 0]", "{ pulley = \"wheel.O\", radius = 0.05, turn = \"clockwise\", friction = 0.5 }", 0.05,
                   2 + 0.05 * pi, 10.0, pull, R"(
[body.wheel]
points = { O = [0, 0] }
[[pin]]
name = "axle"
points = ["ground.O", "wheel.O"]
)" + pin);
  };
  // In equilibrium to within rounding, or out of it: of what no friction changes nothing is proved here.
  EXPECT_EQ(held(on_wheel(10.0, "")).verdict, Holding::held);
  EXPECT_EQ(held(on_wheel(10.0 * (1 + 1e-6), "")).verdict, Holding::slips) << "the wheel turns";
  // With a torque of 0.05 Nm on its axle it holds a difference of 1 N.
  const std::string torque = "friction = { torque = 0.05 }\n";
  expect_verdict(held(on_wheel(11.0 * (1 - 1e-9), torque)), true, "the axle holds");
  expect_verdict(held(on_wheel(11.0 * (1 + 1e-9), torque)), false, "the axle slips");
}

TEST(Capstan, ASlackRopeHoldsNothing) {
  std::string text = drum(0.3, 10.0, 10.0);
  text.replace(text.find("length = "), 9, "length = 1");  // ten times as long
  EXPECT_EQ(held(text).verdict, Holding::slips);
}

TEST(Capstan, NumbersOfPulleysAndWhereTheyAreRefused) {
  Scene scene = parse_scene(two_drums(0.1, 0.25, 1.0, 1.5), "test");
  EXPECT_EQ(get_value(scene, "rope.rope.friction.1"), 0.1);
  set_value(scene, "rope.rope.friction.2", 0.5);
  EXPECT_EQ(scene.stops[0].on.contacts[2].friction, 0.5);
  EXPECT_THROW(set_value(scene, "rope.rope.friction.3", 0.5), InputError);
  EXPECT_THROW(set_value(scene, "rope.rope.friction.1", -0.5), InputError);
  std::string stretches = drum(0.3, 10.0, 10.0);
  stretches.replace(stretches.find("length = "), 9, "stiffness = 1e4\nfree_length = ");
  EXPECT_THROW(parse_scene(stretches, "test"), InputError);
}

}  // namespace
}  // namespace poise::capstan_test
