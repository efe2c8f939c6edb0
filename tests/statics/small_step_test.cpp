// Steps between two models that are proved: what happens on the way must not be stepped over.
#include "statics/tracking/private/small_step.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/read_scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/varied_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::small_step_test {
namespace {

/// A step between two values of a number, from the stable equilibrium of the first.
struct Step {
  Step(const Scene& scene, const std::string& name, double from, double to)
      : Step(VariedScene(scene, name, from, to)) {}
  explicit Step(VariedScene along) : varied(std::move(along)) {
    begin = varied.model_at(varied.from());
    end = varied.model_at(varied.to());
    const Equilibrium at = solve(*begin);
    EXPECT_TRUE(at.found()) << at.why;
    found = followed_in_one_step(*begin, at.x, at.certificate.active_stops, *end);
  }

  VariedScene varied;
  std::unique_ptr<StaticModel> begin, end;
  std::optional<std::vector<double>> found;
};

// An arm of two links, 1 m and 0.5 m, whose end is held at (x, y).
Scene held_arm(double x, double y) {
  const double reach = std::hypot(x, y);
  const double elbow = std::acos((1.0 + reach * reach - 0.25) / (2.0 * reach));  // at the root of the longer link
  const double first = std::atan2(y, x) + elbow;
  const double second = std::atan2(y - std::sin(first), x - std::cos(first));
  const auto text = [](double value) { return fmt::format("{:.17g}", value); };
  return parse_scene(R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.first]
points = { O = [0, 0], A = [1, 0] }
mass = 1
center = [0.5, 0]
[body.second]
points = { A = [0, 0], end = [0.5, 0] }
[[pin]]
name = "O"
points = ["ground.O", "first.O"]
[[pin]]
name = "A"
points = ["first.A", "second.A"]
[[stop]]
name = "x"
x = "second.end"
min = )" + text(x) +
                         "\nmax = " + text(x) + "\n[[stop]]\nname = \"y\"\ny = \"second.end\"\nmin = " + text(y) +
                         "\nmax = " + text(y) + "\n[start]\nfirst = " + text(first) + "\nsecond = " + text(second),
                     "held arm");
}

VariedScene moved_across(double height, double from, double to) {
  Scene there = held_arm(from, height);
  there.stops[0].min = there.stops[0].max = to;
  return {held_arm(from, height), there};
}

// A rod of 1 m, upright on a torsion spring, pushed by a load at its tip against a stop at 0.1 rad.
Scene rod_against_a_stop() {
  return parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], tip = [0, 1] }
[[pin]]
name = "O"
points = ["ground.O", "rod.O"]
[[torsion_spring]]
name = "spring"
bodies = ["ground", "rod"]
stiffness = 5
[[stop]]
name = "left"
bodies = ["ground", "rod"]
max = 0.1
[[force]]
name = "P"
at = "rod.tip"
vector = [-0.4, 0]
)",
                     "rod against a stop");
}

// A block of no weight between a spring that acts both ways and one in tension only, pulled by P.
Scene block_on_two_springs() {
  return parse_scene(R"(
[ground]
points = { O = [0, 0], L = [-1, 0] }
[body.block]
points = { C = [0, 0] }
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[spring]]
name = "both"
points = ["ground.L", "block.C"]
stiffness = 100
free_length = 1
[[spring]]
name = "rope"
points = ["ground.L", "block.C"]
stiffness = 300
free_length = 1.01
acts = "tension"
[[force]]
name = "P"
at = "block.C"
vector = [0.5, 0]
)",
                     "block on two springs");
}

TEST(SmallStep, ComesToTheEquilibriumOfTheOtherModel) {
  const Scene toggle = read_scene(test::dataset("von_mises_toggle.toml"));
  const Step step(toggle, "load.P", 30.0, 31.0);
  ASSERT_TRUE(step.found);
  SolveOptions options;
  options.seek = Seek::any;
  const Equilibrium there = solve(*step.end, *step.found, options);
  ASSERT_TRUE(there.found());
  EXPECT_LT(std::abs(there.x[0] - (*step.found)[0]), 1e-11);
}

// The fold is at 42.914325731224687 N; beyond it the apex snaps through, and Newton's method finds what is there.
TEST(SmallStep, DoesNotStepOverAFold) {
  const Scene toggle = read_scene(test::dataset("von_mises_toggle.toml"));
  EXPECT_FALSE(Step(toggle, "load.P", 42.9, 42.92).found);
  EXPECT_FALSE(Step(toggle, "load.P", 42.914, 42.91433).found);
  EXPECT_TRUE(Step(toggle, "load.P", 42.914, 42.91401).found);
}

// The end cannot come nearer to O than 0.5 m. On the line y = 0.499 it is too near between two places that are not:
// there the arm may be bent either way, and Newton's method comes to one of them.
TEST(SmallStep, DoesNotStepAcrossASingularPose) {
  for (const double height : {0.49, 0.495, 0.499, 0.4999}) {
    const double side = std::sqrt(0.2501 - height * height) + 1e-3;
    EXPECT_FALSE(Step(moved_across(height, -side, side)).found) << height;
  }
  EXPECT_TRUE(Step(moved_across(0.6, -0.01, 0.01)).found);
}

// 5 N m / rad and P at 1 m: the stop comes on at 0.1 rad, P = 0.5 / cos 0.1 = 0.50250418 N.
TEST(SmallStep, DoesNotStepOverAStop) {
  EXPECT_TRUE(Step(rod_against_a_stop(), "load.P", 0.4, 0.45).found);
  EXPECT_FALSE(Step(rod_against_a_stop(), "load.P", 0.4, 0.51).found);
  EXPECT_TRUE(Step(rod_against_a_stop(), "load.P", 0.51, 0.6).found);
  EXPECT_FALSE(Step(rod_against_a_stop(), "load.P", 0.51, 0.5).found);
}

// Both curvatures of the energy are positive, so that nothing happens where the rope comes tight, at 1 N.
TEST(SmallStep, GoesOnWhereARopeComesTight) {
  const Step step(block_on_two_springs(), "load.P", 0.5, 2.0);
  ASSERT_TRUE(step.found);
  EXPECT_NEAR((*step.found)[0] * step.end->scales().length, 0.01 + 1.0 / 400.0, 1e-12);
}

}  // namespace
}  // namespace poise::small_step_test
