// Mechanisms that are balanced in every position, and those that nearly are, against closed forms.

#include "statics/all_equilibria/private/neutral_motions.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "solvers/random_stream.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"

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
  for (const char* scene : {"four_bar_gravity.toml", "zeeman.toml", "von_mises_toggle.toml",
                            "hard/zero_spring_arm.toml", "inverted_pendulum_torsion.toml"}) {
    SCOPED_TRACE(scene);
    const StaticModel model(read_scene(test::dataset(scene)));
    EXPECT_FALSE(neutral_motions(model, model.start()).any());
  }
}

// --- loops --------------------------------------------------------------------------------------------------------

// A lamp whose lower arm turns with a stay, so that the link between the arms keeps its angle; springs of free length
// zero from 0.1 m above each pivot: k h d = g (m c + what follows L).
std::string lamp(const std::string& lower = "588.6", const std::string& upper = "245.25", double stay = 0.4) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0], H = [0, 0.1] }}
[body.lower]
points = {{ O = [0, 0], D = [0.2, 0], E = [0.4, 0] }}
mass = 2
center = [0.2, 0]
[body.stay]
points = {{ U = [0, 0], R = [{:.17g}, 0] }}
[body.link]
points = {{ E = [0, 0], R = [0, 0.1], H = [0, 0.1] }}
[body.upper]
points = {{ E = [0, 0], D = [0.15, 0], T = [0.3, 0] }}
mass = 1.5
center = [0.15, 0]
[[pin]]
points = ["ground.O", "lower.O"]
[[pin]]
points = ["ground.H", "stay.U"]
[[pin]]
points = ["lower.E", "link.E"]
[[pin]]
points = ["stay.R", "link.R"]
[[pin]]
points = ["link.E", "upper.E"]
[[force]]
name = "payload"
at = "upper.T"
vector = [0, -4.905]
[[spring]]
name = "s1"
points = ["ground.H", "lower.D"]
stiffness = {}
free_length = 0
[[spring]]
name = "s2"
points = ["link.H", "upper.D"]
stiffness = {}
free_length = 0
[start]
lower = "30*pi/180"
stay = "30*pi/180"
upper = "-20*pi/180"
)",
                     stay, lower, upper);
}

NeutralMotions motions_of(const std::string& text) {
  const StaticModel model(parse_scene(text, "lamp.toml"));
  return neutral_motions(model, assemble(model));
}

// With the parallelogram folded over and the link upside down, sin(lower) = 0.1 / 0.4, the upper arm is in line with
// what pulls at it.
TEST(NeutralMotions, ALampOnAParallelogramIsBalancedInEveryPositionOfItsBranch) {
  const EquilibriumSet set = set_of(lamp());
  EXPECT_EQ(set.statement,
            "balanced in every position of lower with stay, upper while link keeps its angle with the numbers as they "
            "are written; 4 equilibria on other branches of its loops, complete, proved; change points of the balanced "
            "branch are left out");
  EXPECT_EQ(set.claim, Claim::complete);
  EXPECT_TRUE(set.undecided.empty());
  EXPECT_EQ(set.settles_into, 2);
  ASSERT_EQ(set.balanced.size(), 2U);
  EXPECT_TRUE(set.balanced[0].exact);
  EXPECT_EQ(set.balanced[0].coordinates, (std::vector<std::string>{"lower", "stay"}));
  EXPECT_EQ(set.balanced[0].keeping, std::vector<std::string>{"link"});
  EXPECT_EQ(set.balanced[0].gap, 0.0);
  ASSERT_EQ(set.equilibria.size(), 5U);
  for (const std::size_t k : {0U, 1U, 3U, 4U}) {
    const std::vector<double>& x = set.equilibria[k].x;
    EXPECT_NEAR(std::sin(x[0]), 0.25, 1e-12);
    EXPECT_NEAR(std::sin(x[1]), -0.25, 1e-12);
    EXPECT_NEAR(std::cos(x[2]), -1.0, 1e-12);
    EXPECT_NEAR(std::sin(x[3]), k < 2 ? -1.0 : 1.0, 1e-12);
  }
}

TEST(NeutralMotions, SolveStaysWhereALampIsBalanced) {
  const StaticModel model(parse_scene(lamp(), "lamp.toml"));
  for (const Seek seek : {Seek::settle, Seek::any, Seek::stable}) {
    SolveOptions options;
    options.seek = seek;
    const Equilibrium found = solve(model, options);
    EXPECT_EQ(found.certificate.outcome, Outcome::neutral);
    const std::vector<double> start = {M_PI / 6, M_PI / 6, 0.0, -M_PI / 9};
    for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(found.x[i], start[i], 1e-14);
  }
}

TEST(NeutralMotions, ALampNearlyBalancedIsNotCalledSo) {
  for (const double part : {1e-6, 1e-9, -1e-9, 1e-12, 1e-14}) {
    SCOPED_TRACE(part);
    EXPECT_FALSE(motions_of(lamp(fmt::format("{:.17g}", 588.6 * (1 + part)))).branch);
    // The lower arm alone remains balanced.
    for (const auto& motion : motions_of(lamp("588.6", fmt::format("{:.17g}", 245.25 * (1 + part)))).motions) {
      EXPECT_EQ(motion.coordinates, (std::vector<int>{0, 1}));
    }
    EXPECT_FALSE(motions_of(lamp("588.6", "245.25", 0.4 * (1 + part))).branch);
  }
  const StaticModel model(parse_scene(lamp("588.6000005886"), "lamp.toml"));
  const EquilibriumSet set = all_equilibria(model, {.work = 1e4, .starts = 0, .settling = false});
  EXPECT_NE(set.claim, Claim::complete);
  EXPECT_FALSE(contains(set.statement, "balanced")) << set.statement;
  for (const EquilibriumSet::Balanced& one : set.balanced) EXPECT_EQ(one.coordinates[0], "upper");
}

// Where lower is upright the loop has a change point, near which rounding of its numbers moves it much. Its torque
// (k' - k) h d cos(lower) is not zero beside it.
TEST(NeutralMotions, ALampNearlyBalancedIsInNoEquilibriumBesideItsChangePoint) {
  const StaticModel model(parse_scene(lamp("588.6000005886"), "lamp.toml"));
  for (const double upright : {M_PI / 2, -M_PI / 2}) {
    for (const double aside : {1e-4, 3e-4, 1e-3, 1.15518e-3, 1.274e-3, 3e-3, 0.01, 0.1}) {
      for (const double lower : {upright - aside, upright + aside}) {
        const Certificate c = certify(model, {lower, lower, 0.0, 0.277877049});
        EXPECT_TRUE(c.outcome == Outcome::no_equilibrium || c.outcome == Outcome::not_proved)
            << lower << ": " << c.statement;
      }
    }
  }
}

// A stiffness one unit in the last place off leaves (k' - k) h d of torque.
TEST(NeutralMotions, ALampIsBalancedToRoundingWithinItsBound) {
  const double stiffness = std::nextafter(588.6, 600.0);
  const EquilibriumSet set = set_of(lamp(fmt::format("{:.17g}", stiffness)));
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_TRUE(contains(set.statement, "while link keeps its angle to rounding: torque at most ")) << set.statement;
  ASSERT_EQ(set.balanced.size(), 2U);
  EXPECT_FALSE(set.balanced[0].exact);
  EXPECT_GE(set.balanced[0].effort, (stiffness - 588.6) * 0.02 * 0.99);
  EXPECT_LE(set.balanced[0].effort, 1e-12);
  EXPECT_TRUE(set.balanced[1].exact);
  const EquilibriumSet thirds = set_of(lamp("\"981 * 0.6\"", "\"981 * 0.25\""));
  EXPECT_EQ(thirds.claim, Claim::complete) << thirds.statement;
  EXPECT_TRUE(contains(thirds.statement, "loops open by at most ")) << thirds.statement;
  ASSERT_EQ(thirds.equilibria.size(), 5U);
  EXPECT_GT(thirds.balanced[0].gap, 0.0);
  EXPECT_LT(thirds.balanced[0].gap, 1e-13);
}

// A table on a crank with a counterweight, whose pins are b apart. Folded over, its far pin is the one of the branch
// mirrored in the line from the ground's far pin to the crank's end; equilibria are where the height of all weights,
// sampled all round, has its extremes.
TEST(NeutralMotions, ACounterweightedParallelogramHasItsOtherBranchBeside) {
  const std::string text = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], U = [0.3, 0] }
[body.crank]
points = { O = [0, 0], B = [0.5, 0] }
mass = 4.2
center = [-0.25, 0]
[body.rocker]
points = { U = [0, 0], C = [0.5, 0] }
[body.table]
points = { B = [0, 0], C = [0.3, 0] }
mass = 2.1
center = [0.15, 0.05]
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["ground.U", "rocker.U"]
[[pin]]
points = ["crank.B", "table.B"]
[[pin]]
points = ["rocker.C", "table.C"]
[start]
crank = 1
rocker = 1
)";
  const EquilibriumSet set = set_of(text);
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_TRUE(contains(set.statement, "balanced in every position of crank with rocker while table keeps its angle"))
      << set.statement;
  const auto energy = [](double crank) {
    const Planar<double> end = 0.5 * unit(crank);
    const Planar<double> line = end - Planar<double>{0.3, 0.0};
    const Planar<double> along = {line.x / norm(line), line.y / norm(line)};
    const Planar<double> table = along * along * conj(Planar<double>{1.0, 0.0});
    const Planar<double> center = table * Planar<double>{0.15, 0.05};
    return 9.81 * (4.2 * (-0.5) * end.y + 2.1 * (end.y + center.y));
  };
  constexpr int samples = 20000;
  const auto at = [&](int k) { return 2 * M_PI * (k + 0.3) / samples; };
  std::vector<double> extremes;
  for (int k = 0; k < samples; ++k) {
    if ((energy(at(k)) - energy(at(k - 1))) * (energy(at(k + 1)) - energy(at(k))) < 0.0) extremes.push_back(at(k));
  }
  ASSERT_EQ(set.equilibria.size(), extremes.size() + 1);
  for (const double crank : extremes) {
    EXPECT_TRUE(std::any_of(set.equilibria.begin(), set.equilibria.end(), [&](const Equilibrium& e) {
      return std::abs(std::remainder(e.x[0] - crank, 2 * M_PI)) < 4 * M_PI / samples && e.x[0] != 1.0;
    })) << crank;
  }
}

// One to three arms on parallelograms, whose decimals balance: k h d = g (m c + M L), M all that follows.
struct RandomLamp {
  std::string text;
  std::size_t arms = 0;

  RandomLamp(solvers::RandomStream& random, double part) {
    const auto below = [&](int n) { return std::min(n - 1, static_cast<int>(random.uniform(0.0, n))); };
    arms = static_cast<std::size_t>(1 + below(3));
    std::vector<long long> mass, center, length;
    for (std::size_t k = 0; k < arms; ++k) {
      mass.push_back(100 + below(3000));
      length.push_back(100 + below(400));
      center.push_back(below(static_cast<int>(length.back())));
    }
    const long long payload = 50 + below(2000);
    const auto off = static_cast<std::size_t>(below(static_cast<int>(arms)));
    std::string bodies, pins, springs, starts;
    text =
        "gravity = [0, -9.81]\n[ground]\npoints = { E = [0, 0], R = [0.03, 0.08], A = [0, 0.1], B = [0, 0.2], C = [0, "
        "0.5] }\n";
    for (std::size_t k = 0; k < arms; ++k) {
      const std::string before = k == 0 ? "ground" : fmt::format("link{}", k - 1);
      const int h[] = {10, 5, 2};  // 1 / m
      const int i = below(3);
      const int j = below(3);
      long long after = payload;
      for (std::size_t l = k + 1; l < arms; ++l) after += mass[l];
      // In units of 1e-8 N/m.
      const long long stiffness = 981 * (mass[k] * center[k] + after * length[k]) * h[i] * h[j];
      std::string written = fmt::format("{}.{:08d}", stiffness / 100000000, stiffness % 100000000);
      if (k == off && part != 0.0) written = fmt::format("{:.17g}", 1e-8 * static_cast<double>(stiffness) * (1 + part));
      bodies += fmt::format(
          "[body.arm{0}]\npoints = {{ O = [0, 0], E = [{1}e-3, 0], D = [{2}, 0] }}\nmass = {3}e-3\ncenter = [{4}e-3, "
          "0]\n"
          "[body.stay{0}]\npoints = {{ O = [0, 0], R = [{1}e-3, 0] }}\n"
          "[body.link{0}]\npoints = {{ E = [0, 0], R = [0.03, 0.08], A = [0, 0.1], B = [0, 0.2], C = [0, 0.5] }}\n",
          k, length[k],
          h[j] == 10  ? "0.1"
          : h[j] == 5 ? "0.2"
                      : "0.5",
          mass[k], center[k]);
      pins += fmt::format(
          "[[pin]]\npoints = [\"{0}.E\", \"arm{1}.O\"]\n[[pin]]\npoints = [\"{0}.R\", \"stay{1}.O\"]\n"
          "[[pin]]\npoints = [\"arm{1}.E\", \"link{1}.E\"]\n[[pin]]\npoints = [\"stay{1}.R\", \"link{1}.R\"]\n",
          before, k);
      springs += fmt::format(
          "[[spring]]\nname = \"s{}\"\npoints = [\"{}.{}\", \"arm{}.D\"]\nstiffness = {}\nfree_length = 0\n", k, before,
          h[i] == 10  ? "A"
          : h[i] == 5 ? "B"
                      : "C",
          k, written);
      const double angle = random.uniform(-1.0, 1.0);
      starts += fmt::format("arm{0} = {1:.6f}\nstay{0} = {1:.6f}\n", k, angle);
    }
    text += bodies + pins + springs +
            fmt::format("[[force]]\nname = \"payload\"\nat = \"link{}.E\"\nvector = [0, -{}.{:05d}]\n", arms - 1,
                        981 * payload / 100000, 981 * payload % 100000) +
            "[start]\n" + starts;
  }
};

// Weight and spring cancel in the one coordinate that both turn, and leave no force there whose size tells what is
// rounding.
TEST(NeutralMotions, ALampWhoseForcesCancelInOneCoordinateStaysWhereItIs) {
  const StaticModel model(parse_scene(R"(gravity = [0, -9.81]
[ground]
points = { E = [0, 0], R = [0.03, 0.08], A = [0, 0.1], B = [0, 0.2], C = [0, 0.5] }
[body.arm0]
points = { O = [0, 0], E = [153e-3, 0], D = [0.5, 0] }
mass = 3052e-3
center = [102e-3, 0]
[body.stay0]
points = { O = [0, 0], R = [153e-3, 0] }
[body.link0]
points = { E = [0, 0], R = [0.03, 0.08], A = [0, 0.1], B = [0, 0.2], C = [0, 0.5] }
[[pin]]
points = ["ground.E", "arm0.O"]
[[pin]]
points = ["ground.R", "stay0.O"]
[[pin]]
points = ["arm0.E", "link0.E"]
[[pin]]
points = ["stay0.R", "link0.R"]
[[spring]]
name = "s0"
points = ["ground.C", "arm0.D"]
stiffness = 17.64893556
free_length = 0
[[force]]
name = "payload"
at = "link0.E"
vector = [0, -8.87805]
[start]
arm0 = 0.100768
stay0 = 0.100768
)",
                                      "lamp.toml"));
  const std::vector<double> start = assemble(model);
  const Equilibrium rests = solve(model, SolveOptions{});
  EXPECT_EQ(rests.certificate.outcome, Outcome::neutral) << rests.why;
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(rests.x[i], start[i], 1e-12);
}

TEST(NeutralMotions, RandomLampsAreBalancedWhereTheirDecimalsCancelAndNowhereElse) {
  for (int k = 0; k < test::cases(60, 2000); ++k) {
    SCOPED_TRACE(k);
    solvers::RandomStream random(test::seed(3711), 0, static_cast<std::uint64_t>(k));
    solvers::RandomStream again = random;
    const RandomLamp lamp(random, 0.0);
    const NeutralMotions found = motions_of(lamp.text);
    ASSERT_TRUE(found.branch) << lamp.text;
    EXPECT_EQ(found.branch->gap, 0.0);
    ASSERT_EQ(found.motions.size(), lamp.arms) << lamp.text;
    for (const NeutralMotions::Motion& motion : found.motions) {
      EXPECT_TRUE(motion.exact) << lamp.text;
      EXPECT_EQ(motion.coordinates.size(), 2U);
    }
    const RandomLamp off(again, k % 2 == 0 ? 1e-9 : -1e-9);
    EXPECT_FALSE(motions_of(off.text).branch) << off.text;
    if (k % 8 != 0) continue;
    const StaticModel model(parse_scene(lamp.text, "lamp.toml"));
    const std::vector<double> start = assemble(model);
    const Equilibrium rests = solve(model, SolveOptions{});
    EXPECT_EQ(rests.certificate.outcome, Outcome::neutral) << lamp.text;
    for (std::size_t i = 0; i < start.size(); ++i) EXPECT_NEAR(rests.x[i], start[i], 1e-12);
    if (lamp.arms > 1) continue;
    const EquilibriumSet set = set_of(lamp.text);
    // Nothing turns the link: the other branch is neutral too, and boxes of it stay undecided.
    EXPECT_NE(set.claim, Claim::sampled) << set.statement << lamp.text;
    EXPECT_TRUE(contains(set.statement, "balanced in every position of arm0 with stay0 while link0 keeps its angle"));
  }
}

// Stops, and a pendulum beside it, which has its own equilibria.
TEST(NeutralMotions, WhatMovesBesideAParallelogramHasItsOwnEquilibria) {
  const EquilibriumSet set = set_of(lamp() + R"(
[body.bob]
points = { O = [0, 0] }
mass = 1
center = [1, 0]
[[pin]]
points = ["ground.O", "bob.O"]
)");
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_TRUE(contains(set.statement,
                       "2 equilibria, balanced in every position of lower with stay, upper while link "
                       "keeps its angle with the numbers as they are written; 8 equilibria on other"))
      << set.statement;
}

}  // namespace
}  // namespace poise::neutral_motions_test
