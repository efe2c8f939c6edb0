// Quantities by their names, with values and derivatives.

#include "statics/quantities/quantity.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::statics_quantity_test {
namespace {

using test::dataset;

std::string refusal(const Scene& scene, const std::string& name) {
  try {
    find_quantity(scene, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A lever about O of 0.3 m, with its tip at B; a torsion spring and a drive hold it at 30 degrees.
Scene lever() {
  return parse_scene(R"(
title = "lever"
source = "ours"
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], B = [0.3, 0] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "lever"]
stiffness = 2.0
free_angle = 0.0
[start]
lever = 0.5
)",
                     "lever.toml");
}

TEST(Quantities, HaveTheNamesOfTheGrammar) {
  for (const std::string& name : test::scene_names()) {
    const Scene scene = read_scene(dataset(name));
    if (scene.bodies.size() > 40) continue;
    for (const std::string& one : quantity_names(scene)) EXPECT_EQ(find_quantity(scene, one).name, one) << name;
  }
}

TEST(Quantities, AreReadUnderTheirOldNames) {
  const Scene clamp = read_scene(dataset("toggle_clamp.toml"));
  EXPECT_EQ(find_quantity(clamp, "handle").name, "angle.handle");
  EXPECT_EQ(find_quantity(clamp, "arm.T.x").name, "x.arm.T");
  EXPECT_EQ(find_quantity(clamp, "load_at_fold.P").name, "fold.load.P");
  EXPECT_EQ(find_quantity(clamp, "rubber").name, "length.rubber");
  EXPECT_EQ(find_quantity(clamp, "spring.rubber").name, "length.rubber");
}

TEST(Quantities, AreMadeOfOthers) {
  const Scene clamp = read_scene(dataset("toggle_clamp.toml"));
  EXPECT_EQ(find_quantity(clamp, "(force.rubber+reaction.B)*1.5").name, "(force.rubber + reaction.B) * 1.5");
  EXPECT_EQ(find_quantity(clamp, "-energy / (2)").name, "-1 * energy / 2");
  EXPECT_EQ(find_quantity(clamp, "x.arm.T - (x.arm.T - y.arm.T)").name, "x.arm.T - (x.arm.T - y.arm.T)");
  EXPECT_EQ(find_quantity(clamp, "d(y.arm.T)/d(angle.handle)").dimension,
            dimension::length * dimension::angle.power(-1));
  EXPECT_EQ(find_quantity(clamp, "force.rubber / force.rubber").dimension, dimension::none);
}

TEST(Quantities, WithoutANameAreRefusedInOneLine) {
  const Scene clamp = read_scene(dataset("toggle_clamp.toml"));
  EXPECT_NE(refusal(clamp, "force.rubbr").find("did you mean \"rubber\"?"), std::string::npos);
  EXPECT_NE(refusal(clamp, "reaction.B.moment").find("a pin transmits no moment"), std::string::npos);
  EXPECT_NE(refusal(clamp, "travel.B").find("B is a pin"), std::string::npos);
  EXPECT_NE(refusal(clamp, "angle.ground").find("the ground does not turn"), std::string::npos);
  EXPECT_NE(refusal(clamp, "along.arm.T.east").find("a point and an angle, BODY.POINT.DEGREES"), std::string::npos);
  EXPECT_NE(refusal(clamp, "angle.arm.hndle"), "");
  EXPECT_NE(refusal(clamp, "angle.arm.arm"), "");
  EXPECT_NE(refusal(clamp, "force.rubber + energy").find("one unit on both sides of +"), std::string::npos);
  EXPECT_NE(refusal(clamp, "d(force.rubber)/d(angle.handle)").find("expected angles"), std::string::npos);
  EXPECT_NE(refusal(clamp, "(force.rubber").find("closing parenthesis"), std::string::npos);
  EXPECT_NE(refusal(clamp, "force.rubber 2").find("expected + - * /"), std::string::npos);
  for (const char* empty : {"", " ", "+", "force.rubber *", "d()/d()", "d(angle.handle)", "1e999", "nan"}) {
    EXPECT_NE(refusal(clamp, empty), "") << empty;
  }
}

// The force at the tip that holds the lever against its spring, k angle = -P L for one across the lever, and the motion
// of its tip.
TEST(Quantities, OfALeverAreItsLaws) {
  const VariedScene varied(lever(), "angle.lever", 0.1, 0.6);
  PathPoint point;
  point.parameter = 0.4;
  const auto model = varied.model_at(point.parameter);
  point.x = model->from_si({0.4});
  PathReader reader(varied);
  const auto value = [&](const std::string& name) { return reader.value(find_quantity(varied.scene(), name), point); };
  const double L = 0.3, k = 2.0, angle = 0.4, s = std::sin(angle), c = std::cos(angle);
  EXPECT_NEAR(value("angle.lever"), angle, 1e-12);
  EXPECT_NEAR(value("angle.ground.lever"), -angle, 1e-12);
  EXPECT_NEAR(value("along.lever.B.30"), L * std::cos(angle - M_PI / 6), 1e-12);
  EXPECT_NEAR(value("along.lever.B.-90 + y.lever.B"), 0.0, 1e-15);
  EXPECT_NEAR(value("d(along.lever.B.90)/d(angle.lever.ground)"), L * c, 1e-12);
  EXPECT_NEAR(value("push.lever.B.y"), k * angle / (L * c), 1e-12);
  EXPECT_NEAR(value("push.lever.B.x"), -k * angle / (L * s), 1e-12);
  EXPECT_NEAR(value("push.lever.B.120"), k * angle / (L * std::cos(angle + M_PI / 2 - 2 * M_PI / 3)), 1e-11);
  EXPECT_NEAR(value("push.lever.B.y * 1.1 - push.lever.B.y"), 0.1 * k * angle / (L * c), 1e-12);
  EXPECT_NEAR(value("d(y.lever.B)/d(x.lever.B)"), -c / s, 1e-12);
  EXPECT_NEAR(value("d(y.lever.B)/d(angle.lever)"), L * c, 1e-12);
  EXPECT_NEAR(value("force.coil"), k * angle, 1e-12);
  EXPECT_NEAR(value("energy"), k * angle * angle / 2, 1e-12);
  EXPECT_TRUE(std::isnan(value("d(angle.lever)/d(x.lever.O)")));
  EXPECT_TRUE(std::isnan(value("energy / (angle.lever - angle.lever)")));
}

// Leverage against differences of positions along the path, on mechanisms of one freedom.
TEST(Quantities, RatiosAreSlopesOfPaths) {
  const VariedScene varied(read_scene(dataset("toggle_press.toml")), "angle.crank", 120, 140);
  PathOptions options;
  options.at = {2.2, 2.2 + 1e-4, 2.2 - 1e-4};
  const Path found = path(varied, options);
  PathReader reader(varied);
  const SoughtQuantity crank = find_quantity(varied.scene(), "angle.crank"),
                       ram = find_quantity(varied.scene(), "travel.gib"),
                       ratio = find_quantity(varied.scene(), "d(travel.gib)/d(angle.crank)");
  std::vector<const PathPoint*> at;
  for (const std::vector<PathPoint>& wanted : found.wanted) {
    ASSERT_EQ(wanted.size(), 1U);
    at.push_back(&wanted.front());
  }
  const double slope = (reader.value(ram, *at[1]) - reader.value(ram, *at[2])) /
                       (reader.value(crank, *at[1]) - reader.value(crank, *at[2]));
  EXPECT_NEAR(reader.value(ratio, *at[0]), slope, 1e-7 * std::abs(slope));
  // Virtual work: the effort on the crank times the ratio of both speeds is the force at the ram.
  const SoughtQuantity push = find_quantity(varied.scene(), "push.ram.R.y");
  const double rate = reader.value(find_quantity(varied.scene(), "d(y.ram.R)/d(angle.crank)"), *at[0]);
  EXPECT_NEAR(reader.value(push, *at[0]) * rate, at[0]->effort, 1e-9 * std::abs(at[0]->effort));
}

}  // namespace
}  // namespace poise::statics_quantity_test
