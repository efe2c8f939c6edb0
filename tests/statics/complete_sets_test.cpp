// Sets of equilibria that are hard to prove complete, against closed forms: springs without length, stiff springs,
// folds, and three freedoms with springs.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "statics/all_equilibria/all_equilibria.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::complete_sets_test {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

EquilibriumSet set_of(const std::string& text) {
  return all_equilibria(StaticModel(parse_scene(text, "scene.toml")), {.starts = 50, .settling = false});
}

/// Where the first body is, m.
Vec2 place(const std::string& text, const Equilibrium& equilibrium) {
  return StaticModel(parse_scene(text, "scene.toml")).poses(equilibrium.x)[1].origin;
}

// --- springs without length ----------------------------------------------------------------------------------------

/// Two springs of k = 10 N/m and 1.2 m from (-1, 0) and (1, 0) to a point P, which F pulls.
std::string truss(double fx, double fy) {
  return fmt::format(R"(
[ground]
points = {{ A = [-1, 0], B = [1, 0] }}
[body.P]
points = {{ P = [0, 0] }}
[[force]]
at = "P.P"
vector = [{}, {}]
[[spring]]
name = "a"
points = ["ground.A", "P.P"]
stiffness = 10
free_length = 1.2
[[spring]]
name = "b"
points = ["ground.B", "P.P"]
stiffness = 10
free_length = 1.2
)",
                     fx, fy);
}

// At a pin one spring has no length, and would have to push with what the other one, 2 m long, and the load leave: at
// least 8 - 3 N, at most 8 + 3, and it pushes with 12.
TEST(CompleteSets, ATrussWhoseApexMeetsAPin) {
  for (const Vec2 load : {Vec2{0, -1}, Vec2{0.7, -2}, Vec2{-2, 1.5}, Vec2{0.3, 0.1}}) {
    const std::string text = truss(load.x, load.y);
    const EquilibriumSet set = set_of(text);
    EXPECT_EQ(set.claim, Claim::complete) << set.statement;
    EXPECT_TRUE(contains(set.statement,
                         "where spring \"a\" has no length its force has no direction, and that is no "
                         "equilibrium"))
        << set.statement;
    EXPECT_TRUE(contains(set.statement, "where spring \"b\" has no length")) << set.statement;
    // Index: the field points inwards far away, and each pin is a peak, of index 1.
    int sum = 2;
    for (const Equilibrium& e : set.equilibria) {
      const Vec2 q = place(text, e);
      Vec2 force = load;
      for (const double pin : {-1.0, 1.0}) {
        const Vec2 d{q.x - pin, q.y};
        force = force - 10 * (norm(d) - 1.2) / norm(d) * d;
      }
      EXPECT_LT(norm(force), 1e-11);
      sum += e.certificate.unstable_directions % 2 == 0 ? 1 : -1;
    }
    EXPECT_EQ(sum, 1) << set.statement;
  }
}

// A crank of 1 m on a spring of k = 100 N/m and 0.4 m from its tip to A, 1 m from its pin. Where they meet, and `miss`
// m beside, the energy has a peak; elsewhere  V' = m g/2 cos t + k (l - L) dl/dt,  l^2 = 1 + a^2 - 2 a cos(t).
TEST(CompleteSets, ACrankThatPassesTheOtherEndOfItsSpring) {
  for (const double miss : {0.0, 1e-15, 1e-12, 1e-3, -1e-3}) {
    for (const double weight : {0.0, 9.81, -30.0}) {
      SCOPED_TRACE(fmt::format("{} {}", miss, weight));
      const double a = 1.0 + miss;
      const EquilibriumSet set = set_of(fmt::format(R"(
gravity = [0, {}]
[ground]
points = {{ O = [0, 0], A = [{}, 0] }}
[body.crank]
points = {{ O = [0, 0], B = [1, 0] }}
mass = 1
center = [0.5, 0]
[[pin]]
points = ["ground.O", "crank.O"]
[[spring]]
name = "s"
points = ["ground.A", "crank.B"]
stiffness = 100
free_length = 0.4
[start]
crank = 1
)",
                                                    -weight, a));
      EXPECT_EQ(set.claim, Claim::complete) << set.statement;
      const bool passes = std::abs(miss) < 1e-9;
      EXPECT_EQ(contains(set.statement, "where spring \"s\" has no length the energy has a peak"), passes)
          << set.statement;
      const auto slope = [&](double t) {
        const double length = std::sqrt(1.0 + a * a - 2.0 * a * std::cos(t));
        return 0.5 * weight * std::cos(t) + 100.0 * (length - 0.4) * a * std::sin(t) / length;
      };
      std::size_t expected = 0;
      constexpr int steps = 100'000;
      for (int i = 0; i < steps; ++i) {
        const double from = -M_PI + 2.0 * M_PI * (i + 0.3) / steps;
        const double to = from + 2.0 * M_PI / steps;
        if (passes && from < 0 && to > 0) continue;
        if (slope(from) * slope(to) < 0) ++expected;
      }
      EXPECT_EQ(set.equilibria.size(), expected) << set.statement;
    }
  }
}

// A crank of a four-bar whose end passes one of a spring, in both assembly modes.
TEST(CompleteSets, ALoopThatPassesTheOtherEndOfASpring) {
  const EquilibriumSet set = set_of(R"(
gravity = [0, -9.81]
[ground]
points = { A = [0, 0], D = [2, 0], S = [0.8, 0.6] }
[body.crank]
points = { A = [0, 0], B = [1, 0] }
mass = 1
center = [0.5, 0]
[body.coupler]
points = { B = [0, 0], C = [2, 0] }
mass = 2
center = [1, 0]
[body.rocker]
points = { D = [0, 0], C = [1.5, 0] }
mass = 1
center = [0.7, 0]
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "coupler.B"]
[[pin]]
points = ["coupler.C", "rocker.C"]
[[pin]]
points = ["ground.D", "rocker.D"]
[[spring]]
name = "s"
points = ["ground.S", "crank.B"]
stiffness = 100
free_length = 0.5
[start]
crank = 1
coupler = 0.3
rocker = 1.5
)");
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_EQ(set.equilibria.size(), 6U) << set.statement;
  EXPECT_TRUE(contains(set.statement, "where spring \"s\" has no length the energy has a peak")) << set.statement;
}

// The spring, which pushes with 5 N where the block is at its other end, holds no load above that.
TEST(CompleteSets, ABlockThatIsPushedThroughTheEndOfItsSpring) {
  for (const double force : {1.0, 4.9, 5.1}) {
    SCOPED_TRACE(force);
    const EquilibriumSet set = set_of(fmt::format(R"(
[ground]
points = {{ O = [0, 0], A = [0.3, 0.4] }}
[body.block]
points = {{ P = [0, 0] }}
[[slide]]
name = "x"
points = ["ground.O", "block.P"]
axis = [0.6, 0.8]
[[force]]
at = "block.P"
vector = [{}, {}]
[[spring]]
name = "s"
points = ["ground.A", "block.P"]
stiffness = 10
free_length = 0.5
)",
                                                  0.6 * force, 0.8 * force));
    EXPECT_EQ(set.claim, Claim::complete) << set.statement;
    EXPECT_EQ(set.equilibria.size(), force < 5.0 ? 2U : 1U) << set.statement;
    EXPECT_EQ(contains(set.statement, "has no length the energy has a peak"), force < 5.0) << set.statement;
  }
}

// The springs of the truss would hold any force up to 12 N at a pin if they pulled.
TEST(CompleteSets, AnElementThatPullsItsPointsTogetherIsNamed) {
  const EquilibriumSet set = set_of(R"(
[ground]
points = { A = [0, 0] }
[body.P]
points = { P = [0, 0] }
[[force]]
at = "P.P"
vector = [0, -1]
[[constant_force]]
name = "band"
points = ["ground.A", "P.P"]
force = 5
[[spring]]
name = "soft"
points = ["ground.A", "P.P"]
stiffness = 1
free_length = 0
)");
  EXPECT_TRUE(set.equilibria.empty());
  ASSERT_EQ(set.undecided.size(), 1U) << set.statement;
  EXPECT_TRUE(contains(set.undecided[0].why, "constant force \"band\" may have no length in it"))
      << set.undecided[0].why;
}

// --- stiff springs -------------------------------------------------------------------------------------------------

// A weight w on a spring k: at L + w/k below its end, stable, and L - w/k above.
TEST(CompleteSets, AWeightOnAStiffSpringThatTurnsFreely) {
  for (const double k : {1e2, 1e4, 1e6, 1e8, 1e10}) {
    SCOPED_TRACE(k);
    const std::string text = fmt::format(R"(
gravity = [0, -10]
[ground]
points = {{ A = [0, 0] }}
[body.P]
points = {{ P = [0, 0] }}
mass = 0.1
[[spring]]
name = "k"
points = ["ground.A", "P.P"]
stiffness = {}
free_length = 0.7
)",
                                         k);
    const EquilibriumSet set = set_of(text);
    EXPECT_EQ(set.claim, Claim::complete) << set.statement;
    ASSERT_EQ(set.equilibria.size(), 2U) << set.statement;
    for (std::size_t e = 0; e < 2; ++e) {
      const Vec2 q = place(text, set.equilibria[e]);
      const double side = e == 0 ? -1.0 : 1.0;
      EXPECT_NEAR(q.x, 0.0, 1e-12);
      EXPECT_NEAR(q.y, side * 0.7 - 1.0 / k, 1e-12);
      EXPECT_EQ(set.equilibria[e].certificate.unstable_directions, static_cast<int>(e));
    }
  }
}

// --- folds ---------------------------------------------------------------------------------------------------------

// The toggle of the data sets next to its limit load, of which only the first 16 digits are in a double.
TEST(CompleteSets, FoldsThatAreNear) {
  constexpr double limit = 42.9143257312246876869530451065;
  for (const double below : {1e-3, 1e-6, 1e-8, 1e-10, 1e-12, -1e-12, -1e-9, -1e-6}) {
    SCOPED_TRACE(below);
    Scene scene = read_scene(test::dataset("von_mises_toggle.toml"));
    scene.forces[0].vector.y = -limit * (1.0 - below);
    const EquilibriumSet set = all_equilibria(StaticModel(scene), {.starts = 50, .settling = false});
    EXPECT_EQ(set.claim, Claim::complete) << set.statement;
    ASSERT_EQ(set.equilibria.size(), below > 0 ? 3U : 1U) << set.statement;
    if (below < 0) continue;
    // V = 1000 (r - L)^2 + P h: at the fold V''' = 6000 L h / r^5 (b^2 = 1), and the heights are h -+ sqrt(2 dP /
    // V''').
    constexpr double height = 0.277880091075164758518;
    const double r = std::hypot(1.0, height);
    const double third = 2000 * 3 * 1.118033988749894848 * height / std::pow(r, 5);
    const double apart = 2 * std::sqrt(2 * limit * below / third);
    std::vector<double> heights;
    for (const Equilibrium& e : set.equilibria) heights.push_back(e.x[0] * StaticModel(scene).scales().length);
    std::sort(heights.begin(), heights.end());
    EXPECT_NEAR(heights[2] - heights[1], apart, 0.02 * apart);
  }
}

// --- three freedoms ------------------------------------------------------------------------------------------------

// Three links and springs to the ground, which can all be without length.
TEST(CompleteSets, ThreeLinksOnTwoSprings) {
  const std::string text = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], A = [1.1, 0.6], B = [-0.7, 0.9] }
[body.l0]
points = { a = [0, 0], b = [0.8, 0] }
mass = 1
center = [0.4, 0]
[body.l1]
points = { a = [0, 0], b = [0.6, 0] }
mass = 1.5
center = [0.3, 0]
[body.l2]
points = { a = [0, 0], b = [0.7, 0] }
mass = 0.8
center = [0.35, 0]
[[pin]]
points = ["ground.O", "l0.a"]
[[pin]]
points = ["l0.b", "l1.a"]
[[pin]]
points = ["l1.b", "l2.a"]
[[spring]]
name = "A"
points = ["ground.A", "l2.b"]
stiffness = 40
free_length = 0.5
[[spring]]
name = "B"
points = ["ground.B", "l1.b"]
stiffness = 25
free_length = 0.4
)";
  const EquilibriumSet set = set_of(text);
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_LT(set.boxes, 100'000);
  for (const Equilibrium& e : set.equilibria) EXPECT_EQ(e.certificate.outcome, Outcome::proved);
}

// --- loops ---------------------------------------------------------------------------------------------------------

// The work is about 30 000 boxes.
TEST(CompleteSets, TheLiftTakesLittleWork) {
  const Scene lift = read_scene(test::dataset("lift.toml"));
  const EquilibriumSet set = all_equilibria(StaticModel(lift), {.work = 2.5e6, .settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  EXPECT_EQ(set.equilibria.size(), 64U) << set.statement;
}

// A scissor lift of three stages whose base runs between two stops. At the angle t of its arms, their length 1 m, the
// base is at x = cos t, and the stages go up or down by sin t each: the first up, and the others as they are folded.
// With the weights of 50 N for each arm and 1000 N on the platform
//   V = G sin t + k/2 (cos t - L)^2,
// and the platform points either way.
TEST(CompleteSets, AScissorLiftOfThreeStages) {
  Scene scene = read_scene(test::dataset("scissor_lift.toml"));
  constexpr double k = 60000.0;
  constexpr double free_length = 0.7723295178919067307583705;
  constexpr double limits[] = {0.1, 0.98};
  Stop& rail = scene.stops.emplace_back();
  rail.name = "rail";
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (scene.joints[j].name == "base") rail.on = Measure::travel_of(static_cast<int>(j));
  }
  rail.min = limits[0];
  rail.max = limits[1];
  const EquilibriumSet set = all_equilibria(StaticModel(scene), {.work = 3e6, .settling = false});
  EXPECT_EQ(set.claim, Claim::complete) << set.statement;
  std::vector<double> expected;
  for (const double second : {1.0, -1.0}) {
    for (const double third : {1.0, -1.0}) {
      const double stages = 0.5 + (1.0 + 0.5 * second) + (1.0 + second + 0.5 * third);
      const double load = 100.0 * stages + 1000.0 * (1.0 + second + third);
      const auto slope = [&](double t) { return load * std::cos(t) - k * (std::cos(t) - free_length) * std::sin(t); };
      for (const double side : {1.0, -1.0}) {
        constexpr int steps = 10'000;
        const double first = std::acos(limits[1]);
        const double step = (std::acos(limits[0]) - first) / steps;
        for (int i = 0; i < steps; ++i) {
          double below = side * (first + i * step);
          double above = side * (first + (i + 1) * step);
          if (slope(below) * slope(above) > 0) continue;
          for (int halving = 0; halving < 60; ++halving) {
            const double middle = 0.5 * (below + above);
            (slope(below) * slope(middle) > 0 ? below : above) = middle;
          }
          expected.insert(expected.end(), 2, below);
        }
        for (const double limit : limits) {
          const double t = side * std::acos(limit);
          const double by_travel = -slope(t) / std::sin(t);
          if (limit == limits[0] ? by_travel > 0 : by_travel < 0) expected.insert(expected.end(), 2, t);
        }
      }
    }
  }
  std::vector<double> found;
  for (const Equilibrium& e : set.equilibria) {
    EXPECT_EQ(e.certificate.outcome, Outcome::proved);
    found.push_back(std::remainder(e.x[0], 2 * M_PI));
  }
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), expected.size()) << set.statement;
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-9);
}

}  // namespace
}  // namespace poise::complete_sets_test
