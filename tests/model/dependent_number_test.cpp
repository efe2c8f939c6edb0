// Scenes whose numbers are expressions: reading, setting, scaling, writing back.
#include "model/dependent_number.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene.hpp"
#include "model/scene_builder.hpp"
#include "tests/support/message_of.hpp"

namespace poise::dependent_number_test {
namespace {

using test::message_of;

/// An expression at every kind of key.
const std::string everywhere = R"-(gravity = [0, "-10*r"]

[units]
length = "mm"
angle = "deg"

[numbers]
double = "2*r" # before r
r = 3
turn = "atan(1)*180/pi"

[ground]
points = { O = [0, "r"], S = ["-r", 0] }

[body.arm]
points = { O = ["r", "double"], B = ["r^2", 1] }
mass = "r/10"
center = ["r/2", "r/4"]
inertia = "r^3"

[body.ram]
points = { S = [0, 0] }

[[pin]]
points = ["ground.O", "arm.O"]

[[slide]]
name = "guide"
points = ["ground.S", "ram.S"]
axis = ["cos(r)", "sin(r)"]
angle = "turn"

[[bar]]
name = "tie"
points = ["arm.B", "ram.S"]
length = "hypot(r, 4)"

[[spring]]
name = "k"
sum = [{ factor = "r", slide = "guide" }, { factor = 2, x = "arm.B" }]
stiffness = "5*r"
free_length = "double - r"

[[drive]]
name = "motor"
bodies = ["ground", "arm"]
start = "r"
rate = "10*r"
acceleration = "r/2"
amplitude = "r/3"
frequency = "r/6"
phase = "turn"

[[force]]
name = "P"
at = "arm.B"
vector = ["r", "4*r/3"]

[[torque]]
name = "T"
on = "arm"
value = "7*r"

[[stop]]
name = "end"
slide = "guide"
min = "r"
max = "r + 1"

[start]
arm = "20*r"
guide = "r"
position = { ram = ["r", "2*r"] }
)-";

constexpr double degree = std::numbers::pi / 180.0;

/// What `everywhere` says, SI.
void expect_everything(const Scene& s, double r) {
  EXPECT_DOUBLE_EQ(s.gravity.y, -10 * r * 1e-3);
  EXPECT_EQ(get_value(s, "numbers.double"), 2 * r);
  EXPECT_DOUBLE_EQ(s.bodies[0].points[0].at.y, r * 1e-3);
  EXPECT_DOUBLE_EQ(s.bodies[0].points[1].at.x, -r * 1e-3);
  const Body& arm = s.bodies[1];
  EXPECT_DOUBLE_EQ(arm.points[0].at.y, 2 * r * 1e-3);
  EXPECT_DOUBLE_EQ(arm.points[1].at.x, r * r * 1e-3);
  EXPECT_EQ(arm.points[1].at.y, 1e-3);
  EXPECT_DOUBLE_EQ(arm.mass, r / 10);
  EXPECT_DOUBLE_EQ(arm.center.x, r / 2 * 1e-3);
  EXPECT_DOUBLE_EQ(arm.center.y, r / 4 * 1e-3);
  EXPECT_DOUBLE_EQ(arm.inertia, r * r * r * 1e-6);
  const Joint& guide = s.joints[1];
  EXPECT_DOUBLE_EQ(guide.axis.x, std::cos(r));
  EXPECT_DOUBLE_EQ(guide.axis.y, std::sin(r));
  EXPECT_DOUBLE_EQ(guide.angle, 45 * degree);
  EXPECT_DOUBLE_EQ(s.joints[2].length, std::hypot(r, 4) * 1e-3);
  const Element& k = s.elements[0];
  EXPECT_EQ(k.on.terms[0].factor, r);
  EXPECT_EQ(k.on.terms[1].factor, 2.0);
  EXPECT_DOUBLE_EQ(std::get<LinearSpring>(k.law).stiffness, 5 * r * 1e3);
  EXPECT_DOUBLE_EQ(std::get<LinearSpring>(k.law).free_length, r * 1e-3);
  const Drive& motor = s.drives[0];
  EXPECT_DOUBLE_EQ(*motor.start, r * degree);
  EXPECT_DOUBLE_EQ(motor.rate, 10 * r * degree);
  EXPECT_DOUBLE_EQ(motor.acceleration, r / 2 * degree);
  EXPECT_DOUBLE_EQ(motor.amplitude, r / 3 * degree);
  EXPECT_DOUBLE_EQ(motor.frequency, r / 6);
  EXPECT_DOUBLE_EQ(motor.phase, 45 * degree);
  EXPECT_DOUBLE_EQ(s.forces[0].vector.x, r);
  EXPECT_DOUBLE_EQ(s.forces[0].vector.y, 4 * r / 3);
  EXPECT_DOUBLE_EQ(s.torques[0].value, 7 * r * 1e-3);
  EXPECT_DOUBLE_EQ(s.stops[0].min, r * 1e-3);
  EXPECT_DOUBLE_EQ(s.stops[0].max, (r + 1) * 1e-3);
  EXPECT_DOUBLE_EQ(*s.start.angle[1], 20 * r * degree);
  EXPECT_DOUBLE_EQ(*s.start.travel[1], r * 1e-3);
  EXPECT_DOUBLE_EQ(s.start.position[2]->x, r * 1e-3);
  EXPECT_DOUBLE_EQ(s.start.position[2]->y, 2 * r * 1e-3);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string message_of(const std::string& text) {
  return message_of([&] { parse_scene(text, "s.toml"); });
}

TEST(NamedNumbers, StandWhereverANumberDoes) { expect_everything(parse_scene(everywhere, "s.toml"), 3.0); }

// Also limits of a stop that pass each other on the way.
TEST(NamedNumbers, TakeAllThatFollowsWithThem) {
  Scene scene = parse_scene(everywhere, "s.toml");
  for (const double r : {7.0, 0.5, 3.0}) {
    set_value(scene, "numbers.r", r);
    expect_everything(scene, r);
    expect_everything(parse_scene(replaced(everywhere, "r = 3", "r = " + std::to_string(r)), "s.toml"), r);
  }
}

TEST(NamedNumbers, CannotBeSetByWhatFollowsFromThem) {
  Scene scene = parse_scene(everywhere, "s.toml");
  EXPECT_EQ(message_of([&] { set_value(scene, "spring.k.stiffness", 1); }),
            "spring.k.stiffness: expected a number of its own, found the expression \"5*r\"; change numbers.r");
  EXPECT_EQ(message_of([&] { set_value(scene, "numbers.double", 1); }),
            "numbers.double: expected a number of its own, found the expression \"2*r\"; change numbers.r");
  EXPECT_EQ(message_of([&] { set_value(scene, "load.P", 1); }),
            "load.P: expected a number of its own, found the expression \"r\"; change numbers.r");
  EXPECT_EQ(
      message_of([&] { set_value(scene, "numbers.turn", 1); }),
      "numbers.turn: expected a number of its own, found the expression \"atan(1)*180/pi\"; write it as a number in "
      "the scene");
  EXPECT_EQ(message_of([&] { set_value(scene, "numbers.R", 1); }),
            "numbers.R: expected the path of a number of the scene; did you mean \"numbers.r\"?");
  set_value(scene, "point.arm.B.y", 5);  // a component beside one that follows
  EXPECT_DOUBLE_EQ(scene.bodies[1].points[1].at.y, 5e-3);
  set_value(scene, "point.arm.B.y", 1);
  expect_everything(scene, 3.0);
}

TEST(NamedNumbers, ChangeAllOrNothing) {
  Scene scene = parse_scene(everywhere, "s.toml");
  EXPECT_EQ(message_of([&] { set_value(scene, "numbers.r", -1); }),
            "numbers.r: body.arm.mass = \"r/10\": expected a finite number >= 0, found -0.1");
  EXPECT_EQ(message_of([&] { set_value(scene, "numbers.r", INFINITY); }),
            "numbers.r: expected a finite number, found inf");
  expect_everything(scene, 3.0);
  Scene stop = parse_scene(replaced(everywhere, "\"r + 1\"", "5"), "s.toml");
  EXPECT_EQ(message_of([&] { set_value(stop, "numbers.r", 6); }), "numbers.r: stop \"end\".min: expected min <= max");
  Scene axis = parse_scene(replaced(everywhere, "\"cos(r)\", \"sin(r)\"", "\"r - 1\", 0"), "s.toml");
  EXPECT_EQ(message_of([&] { set_value(axis, "numbers.r", 1); }),
            "numbers.r: slide \"guide\".axis: expected a direction, found [0, 0]");
}

TEST(NamedNumbers, AreNotScaledAndStayRightInAScaledScene) {
  const Scene scene = parse_scene(everywhere, "s.toml");
  const Scales scales{0.25, 8.0};
  Scene small = scaled(scene, scales);
  EXPECT_EQ(get_value(small, "numbers.r"), 3.0);
  Scene set = scene;
  set_value(set, "numbers.r", 5);
  set = scaled(set, scales);
  set_value_at(small, parameter(small, "numbers.r").place, 5);
  const std::vector<ParameterRow> rows = parameter_table(small);
  for (const ParameterRow& row : rows)
    EXPECT_EQ(value_at(small, row.place), value_at(set, row.place)) << row.path.text();
  EXPECT_EQ(small.forces[0].vector, set.forces[0].vector);
  EXPECT_EQ(small.joints[1].axis, set.joints[1].axis);
  scale(small, {scales.per_length(), scales.per_force()});
  expect_everything(small, 5.0);
}

// Of each number that follows, against differences.
TEST(NamedNumbers, HaveDerivativesAlongAllExpressions) {
  const Scene scene = parse_scene(everywhere, "s.toml");
  const int r = parameter(scene, "numbers.r").place.item;
  const std::vector<double> exact = dependents_by(scene, r, named_values(scene));
  std::vector<double> low = named_values(scene), high = low;
  const double h = 1e-5;
  low[static_cast<std::size_t>(r)] -= h;
  high[static_cast<std::size_t>(r)] += h;
  const std::vector<double> a = dependent_values(scene, low, true), b = dependent_values(scene, high, true);
  ASSERT_EQ(exact.size(), 34U);
  for (std::size_t k = 0; k < exact.size(); ++k) {
    EXPECT_NEAR(exact[k], (b[k] - a[k]) / (2 * h), 1e-8 * (1e-3 + std::abs(exact[k]))) << (*scene.dependents)[k].item;
  }
}

TEST(NamedNumbers, SayWhatIsWrong) {
  const auto with = [](const std::string& from, const std::string& to) {
    return message_of(replaced(everywhere, from, to));
  };
  EXPECT_EQ(
      with("\"r/10\"", "\"rr/10\""),
      "s.toml:17: body.arm.mass: expected a name of [numbers], pi or a function, found \"rr\" in \"rr/10\"; known "
      "here: r, pi, turn, sqrt, exp, log, sin, cos, tan, abs, min, max and 6 more");
  EXPECT_EQ(with("\"r/10\"", "\"r/\""),
            "s.toml:17: body.arm.mass: expected a number, a name or \"(\", found its end at character 3 of \"r/\"");
  EXPECT_EQ(with("\"r/10\"", "\"-r\""),
            "s.toml:17: body.arm.mass: expected a finite number >= 0, found -3 from \"-r\"");
  EXPECT_EQ(with("\"r/10\"", "\"1/0\""),
            "s.toml:17: body.arm.mass: expected a finite number >= 0, found inf from \"1/0\"");
  EXPECT_EQ(
      with("r = 3", "r = \"double\""),
      "s.toml:9: numbers.r: expected numbers that do not follow from themselves, found double -> r -> double; give "
      "one of them as a number");
  EXPECT_EQ(
      with("r = 3", "r = \"r+1\""),
      "s.toml:9: numbers.r: expected numbers that do not follow from themselves, found r -> r; give one of them as "
      "a number");
  EXPECT_EQ(with("r = 3", "r = \"log(0)\""),
            "s.toml:9: numbers.r: expected a finite number, found -inf from \"log(0)\"");
  EXPECT_EQ(
      with("r = 3", "r = 3\n\"a b\" = 1"),
      "s.toml:10: numbers.a b: expected a name of letters, digits and underscores that does not begin with a digit "
      "and is neither pi nor a function");
  std::string many;
  for (int k = 0; k < 1000; ++k) many += "\nn" + std::to_string(k) + " = 1";
  EXPECT_EQ(with("r = 3", "r = 3" + many),
            "s.toml:7: numbers: expected at most 1000 numbers, found 1003; write those that nothing shares where they "
            "stand");
  EXPECT_EQ(with("r = 3", "r = [3]"), "s.toml:9: numbers.r: expected a number, found a list");
}

TEST(NamedNumbers, NeedNoTableForConstants) {
  const Scene scene = parse_scene("[body.arm]\nmass = \"2*pi\"\n", "s.toml");
  EXPECT_DOUBLE_EQ(scene.bodies[1].mass, 2 * std::numbers::pi);
  EXPECT_EQ(scene.dependents->size(), 1U);
}

TEST(NamedNumbers, AreWrittenBackWhereTheyAre) {
  Scene scene = parse_scene(everywhere, "s.toml");
  EXPECT_EQ(rewritten_scene(everywhere, "s.toml", scene), everywhere);
  set_value(scene, "numbers.r", 4.5);
  EXPECT_EQ(rewritten_scene(everywhere, "s.toml", scene), replaced(everywhere, "r = 3", "r = 4.5"));
  // A value that its expression does not have is not put in its place.
  set_value_at(scene, parameter(scene, "body.arm.mass").place, 2.0);
  EXPECT_EQ(message_of([&] { rewritten_scene(everywhere, "s.toml", scene); }),
            "s.toml: body.arm.mass: expected the value of its expression \"r/10\", found 2.0; write it as a number");
}

TEST(NamedNumbers, AreBuiltInCode) {
  SceneBuilder builder("arm", {.length = "mm"});
  builder.number("r", 3)
      .number("k", "2*r")
      .body("arm", {.points = {{"O", {0, 0}}}})
      .ground_point("O", {0, 0})
      .pin("ground.O", "arm.O")
      .element("torsion_spring", "coil", measures::angle("ground", "arm"), {{"stiffness", "k/2"}});
  Scene scene = builder.build();
  set_value(scene, "numbers.r", 7);
  EXPECT_EQ(get_value(scene, "torsion_spring.coil.stiffness"), 7.0);
  EXPECT_EQ(message_of([&] { builder.number("r", 4); }), "arm: numbers.r: expected a name of its own; \"r\" is taken");
}

// The stop of a gas strut and the parts of a flexible link have no tables of their own.
TEST(NamedNumbers, StandBesideStrutsAndFlexibleLinks) {
  Scene scene = parse_scene(R"(
    [numbers]
    s = 0.2
    [ground]
    points = { O = [0, 0], H = [0, 0.5] }
    [body.lid]
    points = { O = [0, 0], E = [0.5, 0] }
    [body.lid.section]
    area = 1e-4
    second_moment = 1e-9
    modulus = "1e12*s"
    height = 0.01
    flexible = true
    elements = 2
    [[pin]]
    points = ["ground.O", "lid.O"]
    [[spring]]
    name = "strut"
    points = ["ground.H", "lid.E"]
    gas = { preload = 300, length = 0.9, stroke = "2*s", ratio = 1.3 }
    [[stop]]
    bodies = ["ground", "lid"]
    max = "5*s"
  )",
                            "s.toml");
  const auto stiffness = [&] {
    const int spring = scene.flexible_links.at(0).springs.at(0);
    return std::get<LinearSpring>(scene.elements[static_cast<std::size_t>(spring)].law).stiffness;
  };
  const double before = stiffness();
  set_value_at(scene, parameter(scene, "numbers.s").place, 0.3);
  EXPECT_DOUBLE_EQ(stiffness(), 1.5 * before);
  EXPECT_EQ(get_value(scene, "spring.strut.gas.stroke"), 0.6);
  EXPECT_EQ(get_value(scene, "stop.stop 1.max"), 1.5);
  EXPECT_DOUBLE_EQ(scene.stops.back().min, 0.3);
}

}  // namespace
}  // namespace poise::dependent_number_test
