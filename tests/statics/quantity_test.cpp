// Quantities by their names, with values and derivatives.

#include "statics/quantities/quantity.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "motion/driven_quantities.hpp"
#include "motion/forces_along.hpp"
#include "solvers/real50.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/paths/over_path.hpp"
#include "statics/paths/path_measures.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/quantities_at.hpp"
#include "statics/quantities/quantity_value.hpp"
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
  EXPECT_NE(refusal(clamp, "force.rubbr").find("did you mean \"force.rubber\""), std::string::npos);
  EXPECT_NE(refusal(clamp, "reaction.B.moment").find("a pin transmits no moment"), std::string::npos);
  EXPECT_NE(refusal(clamp, "travel.B").find("B is a pin"), std::string::npos);
  EXPECT_NE(refusal(clamp, "angle.ground").find("the ground does not turn"), std::string::npos);
  EXPECT_NE(refusal(clamp, "along.arm.T.east").find("a point and an angle, BODY.POINT.DEGREES"), std::string::npos);
  EXPECT_NE(refusal(clamp, "angle.arm.hndle"), "");
  EXPECT_NE(refusal(clamp, "angle.arm.arm"), "");
  EXPECT_NE(refusal(clamp, "force.rubber + energy").find("one unit on both sides of +"), std::string::npos);
  EXPECT_NE(refusal(clamp, "d(reaction.B)/d(angle.handle)").find("expected angles"), std::string::npos);
  EXPECT_NE(refusal(clamp, "(force.rubber").find("closing parenthesis"), std::string::npos);
  EXPECT_NE(refusal(clamp, "force.rubber 2").find("expected + - * /"), std::string::npos);
  EXPECT_NE(refusal(clamp, std::string(100, '(') + "energy").find("inside each other"), std::string::npos);
  EXPECT_NE(refusal(clamp, std::string(3000, 'a')).find("at most 2000 characters"), std::string::npos);
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
  EXPECT_NEAR(value("d(energy)/d(angle.lever)"), k * angle, 1e-12);
  EXPECT_NEAR(value("d(force.coil)/d(y.lever.B)"), k / (L * c), 1e-12);
  EXPECT_NEAR(value("d(3*x.lever.B*x.lever.B - y.lever.B*y.lever.B)/d(2*angle.lever)"), -4 * L * L * c * s, 1e-12);
  EXPECT_NEAR(value("d(x.lever.B / y.lever.B)/d(angle.lever)"), -1 / (s * s), 1e-11);
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

/// The quantities so called where a driven measure stands at a value, SI.
std::vector<double> driven_values(const VariedScene& varied, double at, const std::vector<std::string>& names) {
  PathOptions options;
  options.at = {at};
  options.certify = false;
  const Path found = path(varied, options);
  EXPECT_EQ(found.wanted.size(), 1U);
  EXPECT_EQ(found.wanted.at(0).size(), 1U) << found.why;
  PathReader reader(varied);
  const Scene named = named_scene(varied);
  std::vector<double> out;
  for (const std::string& name : names) {
    out.push_back(reader.value(find_quantity(named, name), found.wanted.at(0).at(0)));
  }
  return out;
}

// Crank r = 0.1 m about O, coupler l = 0.3 m, slider on the x axis, with weights and a force against the slider.
Scene slider_crank() {
  return parse_scene(R"(
title = "slider-crank"
source = "ours"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], B = [0.1, 0] }
mass = 2
center = [0.04, 0.01]
[body.rod]
points = { B = [0, 0], C = [0.3, 0] }
mass = 3
center = [0.15, 0]
[body.piston]
points = { C = [0, 0] }
mass = 1
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "B"
points = ["crank.B", "rod.B"]
[[pin]]
name = "C"
points = ["rod.C", "piston.C"]
[[slide]]
name = "bore"
points = ["ground.O", "piston.C"]
axis = [1, 0]
[[force]]
name = "gas"
at = "piston.C"
vector = [-500, 0]
[start]
crank = 0.7
rod = -0.2
)",
                     "slider_crank.toml");
}

// sin(rod) = -r sin(crank) / l; the transmission angle is that between the rod and the normal of the bore, 90 degrees
// less the rod's. The instant centre of the rod relative to the ground is on the line of the crank, above the piston.
TEST(Quantities, OfASliderCrankAreItsClosedForms) {
  const VariedScene varied(slider_crank(), "angle.crank", 0.7, 1.4);
  const double crank = 1.0, r = 0.1, l = 0.3;
  const double tilt = std::asin(r * std::sin(crank) / l), x = r * std::cos(crank) + l * std::cos(tilt);
  const double leverage = -r * std::sin(crank) - r * std::cos(crank) * std::tan(tilt);
  const std::vector<double> at = driven_values(
      varied, crank,
      {"transmission.rod.C", "center.rod.ground.x", "center.rod.ground.y", "center.piston.crank.x",
       "center.piston.crank.y", "center.crank.rod.x", "d(travel.bore)/d(angle.crank)", "force.crank", "force.drive",
       "shaking.x", "shaking.y", "shaking.size", "shaking.moment", "center.piston.ground.x"});
  EXPECT_NEAR(at[0], M_PI / 2 - tilt, 1e-12);
  EXPECT_NEAR(at[1], x, 1e-12);
  EXPECT_NEAR(at[2], x * std::tan(crank), 1e-12);
  // Kennedy: on the normal of the bore through O, and on the line of the rod.
  EXPECT_NEAR(at[3], 0.0, 1e-12);
  EXPECT_NEAR(at[4], x * std::tan(tilt), 1e-12);
  EXPECT_NEAR(at[5], r * std::cos(crank), 1e-12);
  EXPECT_NEAR(at[6], leverage, 1e-12);
  // The drive does the work of weights and gas: torque + power of the loads = 0 in the motion.
  const double g = 9.81, F = 500;
  const double by_crank = -2 * g * (0.04 * std::cos(crank) - 0.01 * std::sin(crank));
  const double rate_of_rod = -r * std::cos(crank) / (l * std::cos(tilt));
  const double by_rod = -3 * g * (r * std::cos(crank) + 0.15 * std::cos(tilt) * rate_of_rod);
  const double torque = -(by_crank + by_rod - F * leverage);
  EXPECT_NEAR(at[7], torque, 1e-9);
  EXPECT_EQ(at[8], at[7]);
  // At rest the ground gets what acts on the bodies.
  EXPECT_NEAR(at[9], -F, 1e-9);
  EXPECT_NEAR(at[10], -6 * g, 1e-9);
  EXPECT_NEAR(at[11], std::hypot(F, 6 * g), 1e-9);
  const double x_crank = 0.04 * std::cos(crank) - 0.01 * std::sin(crank);
  const double moment = -g * (2 * x_crank + 3 * (r * std::cos(crank) + 0.15 * std::cos(tilt)) + x);
  EXPECT_NEAR(at[12], moment, 1e-9);
  EXPECT_TRUE(std::isnan(at[13]));  // it slides
}

// The instant centre of the coupler of a four-bar is where the lines of crank and rocker cross, its transmission angle
// that between coupler and rocker.
TEST(Quantities, OfAFourBarAreThoseOfItsLines) {
  const Scene scene = read_scene(dataset("four_bar_gravity.toml"));
  const VariedScene varied(scene, "angle.crank", -1.4, -0.8);
  const std::vector<double> at = driven_values(varied, -1.0,
                                               {"center.coupler.ground.x", "center.coupler.ground.y", "x.crank.B",
                                                "y.crank.B", "x.rocker.C", "y.rocker.C", "transmission.coupler.C"});
  const Vec2 center{at[0], at[1]}, B{at[2], at[3]}, C{at[4], at[5]}, D{4, 1};
  EXPECT_NEAR(cross(center, B), 0.0, 1e-11 * norm(center));
  EXPECT_NEAR(cross(center - D, C - D), 0.0, 1e-11 * norm(center));
  EXPECT_NEAR(std::sin(at[6]), std::abs(cross(C - B, C - D)) / (norm(C - B) * norm(C - D)), 1e-12);
}

std::string with_outputs(const std::string& outputs) {
  return R"([ground]
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
[start]
lever = 0.5
[outputs]
)" + outputs;
}

TEST(Outputs, AreQuantitiesOfTheScene) {
  const Scene scene = parse_scene(with_outputs("hand = \"push.lever.B.y * 1.1\"\nboth = \"hand + push.lever.B.x / 2\"\n"
                                               "arm = \"0.5 * length.coil\"\n"),
                                  "lever.toml");
  const std::vector<SoughtQuantity> outputs = outputs_of(scene);
  ASSERT_EQ(outputs.size(), 3U);
  EXPECT_EQ(outputs[0].name, "hand");
  EXPECT_EQ(outputs[0].dimension, dimension::force);
  EXPECT_EQ(find_quantity(scene, "(hand)*2").name, "hand * 2");
  const VariedScene varied(scene, "angle.lever", 0.1, 0.6);
  const std::vector<double> at = driven_values(varied, 0.4, {"hand", "arm", "push.lever.B.y"});
  EXPECT_NEAR(at[0], 1.1 * at[2], 1e-14);
  EXPECT_NEAR(at[1], 0.2, 1e-14);
}

TEST(Outputs, ThatAreNoneAreRefusedWithTheirLine) {
  const auto why = [](const std::string& outputs) {
    try {
      outputs_of(parse_scene(with_outputs(outputs), "lever.toml"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(why("hand = \"push.lever.C.y\"\n").find("lever.toml:15: outputs.hand: push.lever.C.y: expected "), 0U)
      << why("hand = \"push.lever.C.y\"\n");
  EXPECT_NE(why("energy = \"force.coil\"\n").find("15: outputs.energy: expected a name that is not a quantity yet"),
            std::string::npos);
  EXPECT_NE(why("lever = \"force.coil\"\n").find("is angle.lever"), std::string::npos);
  EXPECT_NE(why("a = \"b\"\nb = \"energy\"\n").find("15: outputs.a: b: expected the name of a quantity"),
            std::string::npos);
  EXPECT_NE(why("two.words = \"energy\"\n").find("outputs"), std::string::npos);
  EXPECT_NE(why("\"a-b\" = \"energy\"\n").find("expected a name of letters"), std::string::npos);
  EXPECT_NE(why("a = 3\n").find("expected a string"), std::string::npos) << why("a = 3\n");
}

/// What a quantity is over the path on which a driven measure changes.
OverPathValue over(const VariedScene& varied, const std::string& name) {
  PathOptions options;
  options.certify = false;
  const Path found = path(varied, options);
  EXPECT_EQ(found.branches.size(), 1U);
  return over_path(varied, found.branches.at(0), find_quantity(named_scene(varied), name));
}

// The slider-crank through a whole turn: the slider from l - r to l + r, twice each in two turns; the rod tilts most
// where the crank is across the bore. Work of the drive is what weights and gas take up, nothing in a whole turn.
TEST(Quantities, OverAPathOfASliderCrank) {
  const double r = 0.1, l = 0.3, turn = 2 * M_PI;
  const VariedScene varied(slider_crank(), "angle.crank", 0.7, 0.7 + turn);
  const OverPathValue most = over(varied, "max(travel.bore)");
  EXPECT_NEAR(most.value, l + r, 1e-9 * l);
  ASSERT_EQ(most.at.size(), 1U);
  EXPECT_NEAR(most.at[0], turn, 1e-5);
  EXPECT_NEAR(over(varied, "min(travel.bore)").value, l - r, 1e-9 * l);
  EXPECT_NEAR(over(varied, "span(travel.bore)").value, 2 * r, 1e-9 * l);
  const OverPathValue tilt = over(varied, "min(transmission.rod.C)");
  EXPECT_NEAR(tilt.value, M_PI / 2 - std::asin(r / l), 1e-9);
  EXPECT_EQ(tilt.at.size(), 2U);  // up and down
  EXPECT_TRUE(tilt.is_attained_twice);
  EXPECT_NEAR(over(varied, "work(force.crank)").value, 0.0, 1e-7);
  // The mean of r cos a + sqrt(l^2 - r^2 sin^2 a) over a turn is a complete elliptic integral.
  EXPECT_NEAR(over(varied, "mean(travel.bore)").value, 2 / M_PI * l * std::comp_ellint_2(r / l), 1e-9 * l);
  EXPECT_NE(over(varied, "max(d(angle.crank)/d(travel.bore))").why, "");
}

// A block on a spring of 1 N/mm under a load P: a buffer of 10 N/mm acts from 20 mm on, a stop holds at 30 mm, reached
// at 20 N and 130 N. The mean travel over 0 to 200 N is (200 + 2750 + 2100) / 200 mm, that of the buffer's pull
// (0 + 100 x 110 / 2 + 100 x 70) / 200 N, whether the events are points of the branch or lie between.
TEST(Quantities, MeansOverAPathCountItsKinks) {
  const Scene scene = parse_scene(R"(
title = "kinks"
source = "ours"
units = { length = "mm", angle = "deg" }
[ground]
points = { O = [0, 0] }
[body.b]
points = { C = [0, 0] }
[[slide]]
name = "s"
points = ["ground.O", "b.C"]
axis = [1, 0]
[[spring]]
name = "soft"
slide = "s"
stiffness = 1
free_length = 0
[[spring]]
name = "buffer"
slide = "s"
stiffness = 10
free_length = 20
acts = "tension"
[[stop]]
name = "end"
slide = "s"
max = 30
[[force]]
name = "P"
at = "b.C"
direction = [1, 0]
size = 0
[start]
s = 0
)",
                                  "kinks.toml");
  const VariedScene varied(scene, "load.P", 0.0, 200.0);
  EXPECT_NEAR(over(varied, "mean(travel.s)").value, 0.02525, 1e-9 * 0.03);
  EXPECT_NEAR(over(varied, "mean(force.buffer)").value, 62.5, 1e-9 * 100);
  EXPECT_NEAR(over(varied, "mean(stop.end)").value, 12.25, 1e-9 * 70);
  const VariedScene part(scene, "load.P", 20.0, 130.0);
  EXPECT_NEAR(over(part, "mean(travel.s)").value, 0.025, 1e-9 * 0.03);
}

// Over a part of the turn: the drive's work is that against gas and weights, of which the push at the piston has the
// same.
TEST(Quantities, WorkAlongAPathIsThatOfTheLoads) {
  const VariedScene varied(slider_crank(), "angle.crank", 0.7, 1.4);
  const auto energy = [](double crank) {
    const double r = 0.1, l = 0.3, g = 9.81, tilt = std::asin(r * std::sin(crank) / l);
    const double x = r * std::cos(crank) + l * std::cos(tilt);
    const double y_crank = 0.04 * std::sin(crank) + 0.01 * std::cos(crank);
    return 500 * x + g * (2 * y_crank + 3 * (r * std::sin(crank) - 0.15 * std::sin(tilt)));
  };
  const double work = energy(1.4) - energy(0.7);
  EXPECT_NEAR(over(varied, "work(force.crank)").value, work, 1e-8);
  EXPECT_NEAR(over(varied, "work(push.piston.C.x)").value, work, 1e-8);
  EXPECT_NEAR(over(varied, "work(2 * push.piston.C.x) / 2").value, work, 1e-8);
}

TEST(Quantities, OverAPathAreNotMixedWithThoseOfAPosition) {
  const Scene clamp = read_scene(dataset("toggle_clamp.toml"));
  EXPECT_NE(refusal(clamp, "max(energy) - energy").find("not both in one expression"), std::string::npos);
  EXPECT_NE(refusal(clamp, "max(min(energy))").find("expected a quantity of a position"), std::string::npos);
  EXPECT_NE(refusal(clamp, "work(energy)").find("expected the force of a push"), std::string::npos);
  EXPECT_EQ(find_quantity(clamp, "max(energy)-min( energy )").name, "max(energy) - min(energy)");
}

// Kinematics and inverse dynamics say the same of a position as the path does; inertia comes to what is at rest.
TEST(Quantities, OfDrivenPositionsAgreeWithPaths) {
  Scene scene = slider_crank();
  const std::vector<std::string> names{"force.crank", "push.piston.C.x", "shaking.moment", "reaction.B",
                                       "d(travel.bore)/d(angle.crank)"};
  const VariedScene varied(scene, "angle.crank", 0.7, 1.4);
  const std::vector<double> on_path = driven_values(varied, 1.0, names);
  scene.drives = {find_drive(scene, "crank")};
  std::vector<SoughtQuantity> of;
  for (const std::string& name : names) of.push_back(find_quantity(scene, name));
  const std::vector<DriveRange> ranges{{"crank", 1.0, 1.0}};
  const KinematicsResult found = sweep(scene, ranges);
  ASSERT_EQ(found.samples.size(), 1U);
  const std::vector<QuantityValue> driven = driven_quantities(scene, scene.drives, found.samples[0].bodies, of);
  const MotionModel model(scene);
  const ForcesAlong still = forces_over(model, ranges, {}, false);
  const std::vector<QuantityValue> by_forces = driven_quantities(model.scene(), still.poses.at(0), of);
  for (std::size_t q = 0; q < names.size(); ++q) {
    EXPECT_NEAR(driven[q].value, on_path[q], 1e-9 * std::max(1.0, std::abs(on_path[q]))) << names[q];
    EXPECT_NEAR(by_forces[q].value, on_path[q], 1e-9 * std::max(1.0, std::abs(on_path[q]))) << names[q];
  }
  // In motion the drive's effort and the forces of joints are those of inverse dynamics.
  const ForcesAlong moving = forces_over(model, {{"crank", 1.0, 1.2}}, {.steps = 2, .rate = 30.0}, true);
  for (const Forces& pose : moving.poses) {
    const std::vector<QuantityValue> at = driven_quantities(model.scene(), pose, of);
    EXPECT_NEAR(at[0].value, pose.drives.at(0).value, 1e-9 * std::abs(at[0].value));
    EXPECT_NEAR(at[1].value * at[4].value, at[0].value, 1e-9 * std::abs(at[0].value));
    EXPECT_NEAR(at[3].value, norm(pose.reactions.at(1).force), 1e-9 * at[3].value);
    double moment = 0.0;
    for (const SourcedForce& one : forces_on_bodies(model.scene(), pose)) {
      if (one.on.body == 0) moment += cross(one.on.at, one.on.force) + one.on.moment;
    }
    EXPECT_NEAR(at[2].value, moment, 1e-9 * std::abs(moment));
  }
}

/// f'(0) from f at -2h, -h, h, 2h.
Real50 central(const std::array<Real50, 4>& f, double h) {
  return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * Real50(h));
}

/// Compares the derivatives of all quantities of a driven position, by all places, efforts and numbers, with
/// differences in 50 digits. Returns how many.
int expect_differences(const VariedScene& varied, double at) {
  PathOptions options;
  options.at = {at};
  options.certify = false;
  const Path found = path(varied, options);
  EXPECT_EQ(found.wanted.at(0).size(), 1U) << found.why;
  const std::unique_ptr<StaticModel> model = varied.model_at(at);
  std::vector<int> active = found.wanted.at(0).at(0).active_stops;
  active.push_back(static_cast<int>(model->scene().stops.size()) - 1);
  const LinearResponse response = response_at(*model, found.wanted.at(0).at(0).x, active, 1e-10);
  const NumberedEquations& equations = response.equations();
  const int driven = static_cast<int>(active.size()) - 1;
  std::vector<SoughtQuantity> of;
  std::vector<QuantityGradient> gradients;
  for (SoughtQuantity& one : all_quantities(named_scene(varied))) {
    QuantityGradient gradient = gradient_of(one, equations, equations.numbers(), response.z(), driven);
    // An angle of 0 or 90 degrees is the least or largest: it turns back there.
    const double from_middle = std::abs(gradient.value - M_PI / 4);
    const bool turns = one.kind == SoughtQuantity::Kind::transmission && from_middle > M_PI / 4 - 1e-6;
    if (!gradient.why.empty() || turns) continue;
    of.push_back(std::move(one));
    gradients.push_back(std::move(gradient));
  }
  int compared = 0;
  const std::size_t unknowns = response.z().size();
  for (std::size_t k = 0; k < unknowns + equations.numbers().size(); ++k) {
    const double value = k < unknowns ? response.z()[k] : equations.numbers()[k - unknowns];
    if (!std::isfinite(value)) continue;
    const double h = std::ldexp(1.0, -28) * std::max(1.0, std::abs(value));
    std::vector<std::array<Real50, 4>> values(of.size());
    for (const auto& [slot, steps] : {std::pair(0, -2), std::pair(1, -1), std::pair(2, 1), std::pair(3, 2)}) {
      std::vector<Real50> z(response.z().begin(), response.z().end());
      std::vector<Real50> numbers(equations.numbers().begin(), equations.numbers().end());
      Real50& changed = k < unknowns ? z[k] : numbers[k - unknowns];
      changed += steps * Real50(h);
      QuantityPlace<Real50> place(equations, numbers.data(), z.data(), driven);
      for (std::size_t q = 0; q < of.size(); ++q) values[q][static_cast<std::size_t>(slot)] = place.value(of[q]);
    }
    for (std::size_t q = 0; q < of.size(); ++q) {
      const QuantityGradient& one = gradients[q];
      const double difference = static_cast<double>(central(values[q], h));
      const double largest = std::max(one.by_unknowns.cwiseAbs().maxCoeff(), one.by_numbers.cwiseAbs().maxCoeff());
      const double derivative = k < unknowns ? one.by_unknowns[static_cast<Eigen::Index>(k)]
                                             : one.by_numbers[static_cast<Eigen::Index>(k - unknowns)];
      EXPECT_NEAR(derivative, difference, 1e-10 * std::max({1.0, largest, std::abs(one.value)}))
          << of[q].name << " by " << k;
      ++compared;
    }
  }
  return compared;
}

// Drives, pushes that hold something, and the derivatives by each coordinate alone.
TEST(Quantities, OfDrivenPositionsHaveExactDerivatives) {
  EXPECT_GT(expect_differences(VariedScene(slider_crank(), "angle.crank", 0.7, 1.4), 1.0), 1000);
  const Scene four_bar = read_scene(dataset("four_bar_gravity.toml"));
  EXPECT_GT(expect_differences(VariedScene(four_bar, "angle.crank", -1.4, -0.8), -1.0), 1000);
}

// Of a linear spring, the stiffness; of a drive that nothing drives, and of a push in several motions, no number.
TEST(Quantities, OfElementsAndDrives) {
  const StaticModel model(lever());
  const Equilibrium found = solve(model);
  ASSERT_TRUE(found.found());
  const auto values = [&](const std::string& name) {
    return quantities_at(model, found.x, {}, {find_quantity(model.scene(), name)}).front();
  };
  EXPECT_NEAR(values("rate.coil"), 2.0, 1e-13);
  Scene driven = lever();
  Drive drive;
  drive.name = "lever";
  drive.on = Measure::angle_between(0, 1);
  driven.drives.push_back(drive);
  EXPECT_TRUE(std::isnan(quantities_at(model, found.x, {}, {find_quantity(driven, "force.lever")}).front()));
  EXPECT_EQ(find_quantity(driven, "force.drive").name, "force.lever");
}

}  // namespace
}  // namespace poise::statics_quantity_test
