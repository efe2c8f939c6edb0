// Mechanisms that are balanced in every position, and those that nearly are, against closed forms.

#include "statics/neutral_motions.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "statics/all_equilibria.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::neutral_motions_test {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// An arm of 0.7 kg, its centre c = 0.35 m out, whose end 0.2 m out a spring of free length zero ties to a point h =
/// 0.3 m above its pivot: V = (m g c - k a h) sin t, which vanishes at 40.0575 N/m, in decimals and not in doubles.
std::string arm(const std::string& stiffness, const std::string& further = {}) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0.1, 0.2], S = [0.1, 0.5] }}
[body.arm]
points = {{ O = [0, 0], A = [0.2, 0] }}
mass = 0.7
center = [0.35, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
name = "k"
points = ["ground.S", "arm.A"]
stiffness = {}
free_length = 0
{}
[start]
arm = 1
)",
                     stiffness, further);
}

EquilibriumSet set_of(const std::string& text) {
  return all_equilibria(StaticModel(parse_scene(text, "arm.toml")), {.settling = true});
}

TEST(NeutralMotions, AnArmWhoseNumbersCancelIsBalancedInEveryPosition) {
  const EquilibriumSet set = set_of(arm("40.0575"));
  EXPECT_EQ(set.claim, Claim::complete);
  EXPECT_EQ(set.statement, "balanced in every position with the numbers as they are written, complete, proved");
  EXPECT_TRUE(set.undecided.empty());
  ASSERT_EQ(set.equilibria.size(), 1U);
  EXPECT_EQ(set.equilibria[0].certificate.outcome, Outcome::neutral);
  ASSERT_EQ(set.balanced.size(), 1U);
  EXPECT_TRUE(set.balanced[0].exact);
  EXPECT_EQ(set.balanced[0].coordinates, std::vector<std::string>{"arm"});
  EXPECT_EQ(set.settles_into, 0);
}

TEST(NeutralMotions, UnitsDoNotMatter) {
  const EquilibriumSet set = set_of(R"(
gravity = [0, -9810]
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [100, 200], S = [100, 500] }
[body.arm]
points = { O = [0, 0], A = [200, 0] }
mass = 0.7
center = [350, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
name = "k"
points = ["ground.S", "arm.A"]
stiffness = 0.0400575
free_length = 0
[start]
arm = 60
)");
  EXPECT_EQ(set.statement, "balanced in every position with the numbers as they are written, complete, proved");
}

// The next double after 40.0575 differs from it by 7.1e-15 N/m, so that the torque is 4.3e-16 N m sin t.
TEST(NeutralMotions, OneUnitInTheLastPlaceIsBalancedToRounding) {
  const double stiffness = std::nextafter(40.0575, 41.0);
  const EquilibriumSet set = set_of(arm(fmt::format("{:.17g}", stiffness)));
  EXPECT_EQ(set.claim, Claim::complete);
  EXPECT_TRUE(contains(set.statement, "balanced in every position to rounding: torque at most ")) << set.statement;
  EXPECT_TRUE(contains(set.statement, " J in every position, complete, proved") ||
              contains(set.statement, " N m in every position, complete, proved"))
      << set.statement;
  ASSERT_EQ(set.balanced.size(), 1U);
  EXPECT_FALSE(set.balanced[0].exact);
  EXPECT_GE(set.balanced[0].effort, (stiffness - 40.0575) * 0.06 * 0.99);
  EXPECT_LE(set.balanced[0].effort, 1e-14);
}

TEST(NeutralMotions, ExpressionsAreBalancedToRounding) {
  const EquilibriumSet set = set_of(arm("\"0.7 * 9.81 * 0.35 / (0.2 * 0.3)\""));
  EXPECT_EQ(set.claim, Claim::complete);
  EXPECT_TRUE(contains(set.statement, "balanced in every position to rounding: torque at most ")) << set.statement;
}

TEST(NeutralMotions, ABlockOnALevelSlideRestsAnywhere) {
  const EquilibriumSet set = set_of(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.block]
points = { P = [0, 0] }
mass = 3.3
[[slide]]
name = "rail"
points = ["ground.O", "block.P"]
axis = [1, 0]
)");
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_TRUE(contains(set.statement, "balanced in every position with the numbers as they are written"))
      << set.statement;
}

TEST(NeutralMotions, AnImbalanceIsDecidedHoweverSmall) {
  for (const double part : {1e-6, -1e-6, 1e-9, -1e-9, 1e-12, -1e-12, 1e-14, -1e-14}) {
    SCOPED_TRACE(part);
    const EquilibriumSet set = set_of(arm(fmt::format("{:.17g}", 40.0575 * (1.0 + part))));
    EXPECT_EQ(set.claim, Claim::complete) << set.statement;
    EXPECT_TRUE(set.balanced.empty());
    EXPECT_LT(set.boxes, 200);
    ASSERT_EQ(set.equilibria.size(), 2U) << set.statement;
    for (const Equilibrium& e : set.equilibria) {
      EXPECT_EQ(e.certificate.outcome, Outcome::proved);
      EXPECT_NEAR(std::abs(std::remainder(e.x[0], 2 * M_PI)), M_PI / 2, 1e-9);
      // The spring is too strong, or the weight.
      const bool is_up = std::sin(e.x[0]) > 0.0;
      EXPECT_EQ(e.certificate.stability, is_up == (part > 0.0) ? Stability::stable : Stability::unstable);
    }
  }
}

TEST(NeutralMotions, StopsOnABalancedArmDoNotUnbalanceIt) {
  const EquilibriumSet set = set_of(arm("40.0575", R"(
[[stop]]
name = "range"
bodies = ["ground", "arm"]
min = -1
max = 1.5
)"));
  EXPECT_EQ(set.statement, "balanced in every position with the numbers as they are written, complete, proved");
}

TEST(NeutralMotions, ATorqueUnbalancesIt) {
  const EquilibriumSet set = set_of(arm("40.0575", "[[torque]]\non = \"arm\"\nvalue = 1e-9\n"));
  EXPECT_TRUE(set.balanced.empty());
  EXPECT_TRUE(set.equilibria.empty());
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
}

// A pendulum beside the arm: it hangs or stands, whatever the arm does.
TEST(NeutralMotions, WhatElseMovesHasItsOwnEquilibria) {
  const EquilibriumSet set = set_of(arm("40.0575", R"(
[body.bob]
points = { O = [0, 0] }
mass = 1
center = [1, 0]
[[pin]]
points = ["ground.S", "bob.O"]
)"));
  EXPECT_EQ(set.statement,
            "2 equilibria, balanced in every position of arm with the numbers as they are written, complete, proved");
  ASSERT_EQ(set.equilibria.size(), 2U);
  for (const Equilibrium& e : set.equilibria) EXPECT_EQ(e.certificate.outcome, Outcome::neutral);
  EXPECT_EQ(set.equilibria[0].certificate.unstable_directions, 0);
  EXPECT_EQ(set.equilibria[1].certificate.unstable_directions, 1);
  EXPECT_EQ(set.settles_into, 0);
}

// A wheel on its centre carries a massless crank that a spring ties to the wheel's rim: together they turn freely, and
// the crank rests towards the rim's point or away from it.
TEST(NeutralMotions, FramesThatSpringsTieTogetherTurnTogether) {
  const EquilibriumSet set = set_of(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0], P = [0.1, 0], rim = [0.3, 0] }
mass = 2
[body.crank]
points = { P = [0, 0], end = [0.05, 0] }
[[pin]]
points = ["ground.O", "wheel.O"]
[[pin]]
points = ["wheel.P", "crank.P"]
[[spring]]
name = "k"
points = ["wheel.rim", "crank.end"]
stiffness = 10
free_length = 0
[start]
wheel = 0.4
crank = 1
)");
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  ASSERT_EQ(set.equilibria.size(), 2U) << set.statement;
  ASSERT_EQ(set.balanced.size(), 1U);
  EXPECT_TRUE(set.balanced[0].exact);
  EXPECT_EQ(set.balanced[0].coordinates.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<double>& x = set.equilibria[k].x;
    EXPECT_NEAR(std::cos(x[1] - x[0]), k == 0 ? 1.0 : -1.0, 1e-12);
  }
}

TEST(NeutralMotions, TheBalancedArmOfTheDatasets) {
  const StaticModel model(read_scene(test::dataset("hard/balanced_arm.toml")));
  const NeutralMotions found = neutral_motions(model, model.start());
  ASSERT_EQ(found.motions.size(), 1U);
  EXPECT_TRUE(found.motions[0].exact);
  EXPECT_EQ(found.motions[0].effort, 0.0);
}

TEST(NeutralMotions, AreNoneWhereALoopOrASpringHolds) {
  for (const char* scene : {"four_bar_gravity.toml", "hard/balanced_lamp.toml", "zeeman.toml", "von_mises_toggle.toml",
                            "hard/zero_spring_arm.toml", "inverted_pendulum_torsion.toml"}) {
    SCOPED_TRACE(scene);
    const StaticModel model(read_scene(test::dataset(scene)));
    EXPECT_FALSE(neutral_motions(model, model.start()).any());
  }
}

}  // namespace
}  // namespace poise::neutral_motions_test
