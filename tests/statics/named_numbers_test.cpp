// Scenes whose numbers are expressions: derivatives, tolerances, paths and changes by named numbers, against closed
// forms.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "statics/model/static_model.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "statics/paths/varied_pair.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "statics/sensitivity/tolerance.hpp"
#include "statics/tracking/tracked_equilibrium.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::statics_named_numbers_test {
namespace {

using test::message_of;

constexpr double degree = std::numbers::pi / 180.0;

Scene arm() { return read_scene(test::dataset("balanced_arm.toml")); }

const Sensitivity& by(const QuantitySensitivity& of, const std::string& number) {
  const auto found = std::find_if(of.by.begin(), of.by.end(), [&](const Sensitivity& s) { return s.number == number; });
  if (found == of.by.end()) throw std::runtime_error("no derivative by " + number);
  return *found;
}

QuantitySensitivity sensitivity(const Scene& scene, const std::string& name) {
  const StaticModel model(scene);
  const Sensitivities found = sensitivities(model, {find_quantity(scene, name)});
  EXPECT_EQ(found.why, "");
  return found.of.at(0);
}

// A block on a rail at the angle a, on a spring along it, pulled by a force at the angle c and pressed against by a
// sum:
//   k s = F cos(c - a) - m g sin(a),   the rail presses  m g cos(a) - F sin(c - a).
const std::string rail = R"-(
gravity = [0, "-g"]
[numbers]
g = 10
a = 0.4
c = 0.9
F = 7
k = 40
m = 1.5
half = "m/2"
[ground]
points = { O = [0, 0] }
[body.block]
points = { P = [0, 0] }
mass = "2*half"
[[slide]]
name = "rail"
points = ["ground.O", "block.P"]
axis = ["3*cos(a)", "3*sin(a)"]
[[spring]]
name = "coil"
slide = "rail"
stiffness = "k"
free_length = 0
[[force]]
name = "P"
at = "block.P"
vector = ["F*cos(c)", "F*sin(c)"]
)-";

double travel(double g, double a, double c, double F, double k, double m) {
  return (F * std::cos(c - a) - m * g * std::sin(a)) / k;
}

TEST(NamedNumbersInStatics, MoveTheBalancedArmAsItsClosedForm) {
  const QuantitySensitivity angle = sensitivity(arm(), "angle.arm");
  EXPECT_NEAR(angle.value, 45 * degree, 1e-13);
  // tan(a) = (share - 1) / (2 pull) = 1
  EXPECT_NEAR(by(angle, "numbers.share").derivative, 1.25, 1e-12);
  EXPECT_NEAR(by(angle, "numbers.pull").derivative, -2.5, 1e-12);
  EXPECT_NEAR(by(angle, "numbers.lean").derivative, 0.5 * degree, 1e-13);
  for (const char* none : {"numbers.L", "numbers.m", "numbers.g"}) {
    EXPECT_NEAR(by(angle, none).derivative, 0.0, 1e-13) << none;
  }
  // Of what follows, as if it alone changed.
  EXPECT_GT(std::abs(by(angle, "point.arm.B.x").derivative), 1.0);
  for (const Sensitivity& one : angle.by) EXPECT_NE(one.number, "numbers.h") << "it is but a step";
}

// Axes and directions of forces have no number of their own.
TEST(NamedNumbersInStatics, MoveAxesAndDirections) {
  const Scene scene = parse_scene(rail, "rail.toml");
  const double g = 10, a = 0.4, c = 0.9, F = 7, k = 40, m = 1.5;
  const QuantitySensitivity s = sensitivity(scene, "travel.rail");
  EXPECT_NEAR(s.value, travel(g, a, c, F, k, m), 1e-13);
  EXPECT_NEAR(by(s, "numbers.a").derivative, (F * std::sin(c - a) - m * g * std::cos(a)) / k, 1e-12);
  EXPECT_NEAR(by(s, "numbers.c").derivative, -F * std::sin(c - a) / k, 1e-12);
  EXPECT_NEAR(by(s, "numbers.F").derivative, std::cos(c - a) / k, 1e-12);
  EXPECT_NEAR(by(s, "numbers.k").derivative, -s.value / k, 1e-12);
  EXPECT_NEAR(by(s, "numbers.m").derivative, -g * std::sin(a) / k, 1e-12);
  EXPECT_NEAR(by(s, "numbers.g").derivative, -m * std::sin(a) / k, 1e-12);
  const QuantitySensitivity press = sensitivity(scene, "reaction.rail");
  EXPECT_NEAR(press.value, m * g * std::cos(a) - F * std::sin(c - a), 1e-12);
  EXPECT_NEAR(by(press, "numbers.a").derivative, -m * g * std::sin(a) + F * std::cos(c - a), 1e-11);
}

// A load and its function of time, at one time: k s = F c cos(b) + V c sin(b), c = F/2 sin(w t + F).
TEST(NamedNumbersInStatics, MoveLoadsThroughFunctionsOfTime) {
  std::string text = rail;
  text += "time = { sine = { amplitude = \"F/2\", frequency = 0.3, phase = \"F\" } }\n";
  const double t = 0.35, F = 7, c = 0.9, a = 0.4, k = 40, m = 1.5, g = 10;
  const Scene scene = at_time(parse_scene(text, "rail.toml"), t);
  const double turn = 2 * std::numbers::pi * 0.3 * t + F, factor = F / 2 * std::sin(turn);
  const double factor_by = std::sin(turn) / 2 + F / 2 * std::cos(turn);
  const QuantitySensitivity s = sensitivity(scene, "travel.rail");
  EXPECT_NEAR(s.value, travel(g, a, c, F * factor, k, m), 1e-13);
  EXPECT_NEAR(by(s, "numbers.F").derivative, std::cos(c - a) * (factor + F * factor_by) / k, 1e-12);
  EXPECT_NEAR(by(s, "numbers.c").derivative, -F * factor * std::sin(c - a) / k, 1e-12);
  // Along a path and by a change.
  const VariedScene varied(scene, "numbers.F", 7, 7.5);
  PathOptions options;
  options.certify = false;
  const Path found = path(varied, options);
  ASSERT_FALSE(found.branches.empty());
  for (const PathPoint& point : found.branches[0].points) {
    const double f = point.parameter, now = f / 2 * std::sin(turn - F + f);
    const double s_there = travel(g, a, c, f * now, k, m);
    EXPECT_NEAR(varied.model_at(f)->poses(point.x)[1].origin.x, s_there * std::cos(a), 1e-10) << f;
  }
  // The direction of a load that is a number by itself follows its function alone.
  text.replace(text.find("vector = [\"F*cos(c)\", \"F*sin(c)\"]"), 33, "vector = [3, 0]");
  const QuantitySensitivity fixed = sensitivity(at_time(parse_scene(text, "rail.toml"), t), "travel.rail");
  EXPECT_NEAR(by(fixed, "numbers.F").derivative, 3 * factor_by * std::cos(a) / k, 1e-12);
}

// A spring k on (k / 40) s is one of stiffness k (k / 40)^2.
TEST(NamedNumbersInStatics, MoveFactorsOfSums) {
  std::string text = rail;
  text.replace(text.find("slide = \"rail\"\nstiff"), 14, "sum = [{ factor = \"k/40\", slide = \"rail\" }]");
  const double g = 10, a = 0.4, c = 0.9, F = 7, k = 40, m = 1.5;
  const Scene scene = parse_scene(text, "s.toml");
  const QuantitySensitivity s = sensitivity(scene, "travel.rail");
  EXPECT_NEAR(s.value, travel(g, a, c, F, k, m), 1e-13);
  EXPECT_NEAR(by(s, "numbers.k").derivative, -3 * s.value / k, 1e-12);
  const VariedScene varied(scene, "numbers.k", 40, 60);
  PathOptions options;
  options.certify = false;
  const Path found = path(varied, options);
  ASSERT_FALSE(found.branches.empty());
  for (const PathPoint& point : found.branches[0].points) {
    const double now = point.parameter, expected = travel(g, a, c, F, now * (now / 40) * (now / 40), m);
    EXPECT_NEAR(varied.model_at(now)->poses(point.x)[1].origin.x, expected * std::cos(a), 1e-10) << now;
  }
}

TEST(NamedNumbersInStatics, SayWhereThereIsNoDerivative) {
  std::string text = rail;
  text.replace(text.find("\"2*half\""), 8, "\"max(m, 1.5)\"");
  EXPECT_EQ(by(sensitivity(parse_scene(text, "s.toml"), "travel.rail"), "numbers.m").why,
            "body.block.mass = \"max(m, 1.5)\" has no derivative by it");
}

std::string strip(const std::string& s, const std::string& area, const std::string& modulus) {
  return R"(
    [numbers]
    s = )" +
         s + R"(
    [ground]
    points = { A = [0, 0] }
    [body.strip]
    points = { A = [0, 0], B = [1, 0] }
    [body.strip.section]
    area = )" +
         area + R"(
    second_moment = 1
    modulus = )" +
         modulus + R"(
    height = 1
    flexible = true
    elements = 2
    [[weld]]
    points = ["ground.A", "strip.A"]
    [[force]]
    name = "P"
    at = "strip.B"
    vector = [0, -1]
  )";
}

// All springs of a flexible link follow: derivatives, paths and changes.
TEST(NamedNumbersInStatics, ReachSectionsOfFlexibleLinks) {
  const auto scene = [](const std::string& s) { return parse_scene(strip(s, "1", "\"s/2\""), "strip.toml"); };
  const std::string tip = scene("4").bodies.back().name;
  const QuantitySensitivity bend = sensitivity(scene("4"), "angle." + tip);
  // Without weight the shape depends on P / (E I) alone.
  EXPECT_LT(by(bend, "load.P").derivative, -0.1);
  EXPECT_NEAR(4 * by(bend, "numbers.s").derivative, -by(bend, "load.P").derivative, 1e-12);
  const VariedScene varied(scene("4"), "numbers.s", 4, 8);
  PathOptions options;
  options.certify = false;
  const Path found = path(varied, options);
  ASSERT_FALSE(found.branches.empty());
  const PathPoint& last = found.branches[0].points.back();
  EXPECT_EQ(last.parameter, 8);
  const StaticModel there(scene("8"));
  const Equilibrium rest = solve(there);
  ASSERT_TRUE(rest.found()) << rest.why;
  EXPECT_NEAR(varied.model_at(8)->poses(last.x).back().angle, there.poses(rest.x).back().angle, 1e-10);
  EXPECT_LT(there.poses(rest.x).back().angle, -0.05);

  const Scene stressed = parse_scene(strip("4", "\"s\"", "2"), "strip.toml");
  for (const Sensitivity& one : sensitivity(stressed, "angle." + tip).by) EXPECT_NE(one.number, "numbers.s");
}

TEST(NamedNumbersInStatics, VaryAlongPaths) {
  const VariedScene varied(arm(), "numbers.share", 1.2, 1.8);
  PathOptions options;
  options.certify = false;
  const Path found = path(varied, options);
  ASSERT_FALSE(found.branches.empty());
  for (const PathPoint& point : found.branches[0].points) {
    const double share = point.parameter;
    EXPECT_NEAR(varied.model_at(share)->poses(point.x)[1].angle, std::atan((share - 1) / 0.4), 1e-10);
  }
  EXPECT_EQ(found.branches[0].points.back().parameter, 1.8);
  EXPECT_EQ(message_of([] { VariedScene(arm(), "spring.balance.stiffness", 1, 2); }),
            "spring.balance.stiffness: expected a number of its own, found the expression "
            "\"share*weight*(L/2)/(b*h)\"; change numbers.L, numbers.share, numbers.h, numbers.b, numbers.weight");
  EXPECT_EQ(
      message_of([] { VariedScene(arm(), "numbers.L", -100, 100); }),
      "numbers.L: spring \"balance\".stiffness = \"share*weight*(L/2)/(b*h)\": expected a finite number >= 0, found "
      "-1.3733999999999997");
  EXPECT_NE(message_of([] {
              VariedPair(arm(), {"loads", 0.5, 1}, {"numbers.pull", 0.1, 0.3});
            }).find("loads"),
            std::string::npos);
}

TEST(NamedNumbersInStatics, HaveTolerances) {
  const StaticModel model(arm());
  const std::string file = "[tolerances]\n\"numbers.share\" = 0.02\n\"numbers.L\" = 5\n";
  const std::vector<Tolerance> tolerances = parse_tolerances(file, "t.toml", model.scene());
  ASSERT_EQ(tolerances.size(), 2U);
  ToleranceOptions options;
  options.samples = 4000;
  options.jobs = 1;
  const ToleranceStudy study = tolerance_study(model, tolerances, {find_quantity(model.scene(), "angle.arm")}, options);
  ASSERT_EQ(study.why, "");
  const ToleranceBand& band = study.of[0];
  ASSERT_EQ(band.why, "");
  EXPECT_NEAR(band.sigma, 1.25 * 0.02 / std::sqrt(3.0), 1e-12);
  EXPECT_EQ(study.continued, options.samples);
  EXPECT_EQ(study.disagreed, 0U);
  // Every sample is the closed form, whatever the length.
  EXPECT_NEAR(band.all.least, std::atan(0.38 / 0.4), 1e-4);
  EXPECT_NEAR(band.all.most, std::atan(0.42 / 0.4), 1e-4);
  EXPECT_NEAR(*band.at_most, std::atan(0.42 / 0.4), 1e-11);
  // d2a/dshare2 = -2 tan / (1 + tan^2)^2 / (2 pull)^2
  EXPECT_NEAR(band.shift, 0.5 * (-0.5 / 0.16) * 0.02 * 0.02 / 3.0, 1e-8);
  EXPECT_EQ(
      message_of([&] { parse_tolerances("[tolerances]\n\"numbers.L\" = 500\n", "t.toml", model.scene()); }),
      "t.toml:2: tolerances: numbers.L: spring \"balance\".stiffness = \"share*weight*(L/2)/(b*h)\": expected a finite "
      "number >= 0, found -1.3733999999999997");
}

TEST(NamedNumbersInStatics, AreFollowedWhileTheyChange) {
  TrackedEquilibrium tracked(arm());
  for (const double share : {1.5, 1.9, 1.3}) {
    Scene wanted = tracked.scene();
    set_value(wanted, "numbers.share", share);
    set_value(wanted, "numbers.lean", 10 * (share - 1));
    const Transition transition = tracked.change(wanted);
    EXPECT_EQ(transition.kind, Transition::Kind::followed);
    // K cos(a) = sin(a - lean), K = (share - 1) / (2 pull)
    const double lean = 10 * (share - 1) * degree, K = (share - 1) / 0.4;
    EXPECT_NEAR(tracked.poses()[1].angle, std::atan2(K + std::sin(lean), std::cos(lean)), 1e-9) << share;
  }
}

}  // namespace
}  // namespace poise::statics_named_numbers_test
