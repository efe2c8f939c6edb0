#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "model/scene.hpp"

namespace poise {
namespace {

constexpr double inch = 0.0254;
constexpr double pound_force = 4.4482216152605;
constexpr double pound = 0.45359237;
constexpr double degree = 3.14159265358979323846 / 180.0;

class SetValue : public testing::Test {
 protected:
  Scene scene = parse_scene(R"(
    [units]
    length = "in"
    force = "lbf"
    mass = "lb"
    angle = "deg"
    [ground]
    points = { O = [0, 0], S = [1, 0] }
    [body.crank]
    points = { O = [0, 0], B = [1, 0] }
    [body."rod.1"]
    points = { B = [0, 0] }
    [[pin]]
    points = ["ground.O", "crank.O"]
    [[slide]]
    points = ["ground.S", "rod.1.B"]
    axis = [1, 0]
    [[bar]]
    name = "tie"
    points = ["crank.B", "rod.1.B"]
    length = 1
    [[spring]]
    points = ["ground.O", "rod.1.B"]
    stiffness = 1
    free_length = 1
    [[torsion_spring]]
    name = "coil"
    bodies = ["ground", "crank"]
    stiffness = 1
    [[force]]
    name = "P"
    at = "crank.B"
    vector = [3, -4]
    [[force]]
    name = "none"
    at = "crank.B"
    vector = [0, 0]
    [[torque]]
    name = "T"
    on = "crank"
    value = 1
    [[stop]]
    name = "turn"
    bodies = ["ground", "crank"]
    min = 0
    max = 90
    [[stop]]
    name = "reach"
    points = ["ground.O", "rod.1.B"]
    max = 5
    [[stop]]
    name = "travel"
    slide = "ground.S-rod.1.B"
    min = 0)",
                            "s.toml");

  std::string message(std::string_view path, double value) {
    try {
      set_value(scene, path, value);
      return "no error";
    } catch (const InputError& error) {
      return error.what();
    }
  }
};

TEST_F(SetValue, ScalesForcesAlongTheirDirection) {
  set_value(scene, "load.P", 10);
  EXPECT_DOUBLE_EQ(scene.forces[0].vector.x, 6 * pound_force);
  EXPECT_DOUBLE_EQ(scene.forces[0].vector.y, -8 * pound_force);
  set_value(scene, "load.P", 0);
  EXPECT_EQ(norm(scene.forces[0].vector), 0.0);
}

TEST_F(SetValue, SetsTorques) {
  set_value(scene, "load.T", -3);
  EXPECT_DOUBLE_EQ(scene.torques[0].value, -3 * pound_force * inch);
}

TEST_F(SetValue, SetsBodies) {
  set_value(scene, "body.rod.1.mass", 2);
  set_value(scene, "body.crank.inertia", 3);
  EXPECT_DOUBLE_EQ(scene.bodies[2].mass, 2 * pound);
  EXPECT_DOUBLE_EQ(scene.bodies[1].inertia, 3 * pound * inch * inch);
  EXPECT_EQ(scene.bodies[1].mass, 0.0);
}

TEST_F(SetValue, SetsSprings) {
  set_value(scene, "spring.spring 1.stiffness", 2);
  set_value(scene, "spring.spring 1.free_length", 3);
  set_value(scene, "torsion_spring.coil.stiffness", 4);
  set_value(scene, "torsion_spring.coil.free_angle", -400);
  EXPECT_DOUBLE_EQ(scene.springs[0].stiffness, 2 * pound_force / inch);
  EXPECT_DOUBLE_EQ(scene.springs[0].free_length, 3 * inch);
  EXPECT_DOUBLE_EQ(scene.torsion_springs[0].stiffness, 4 * pound_force * inch / degree);
  EXPECT_DOUBLE_EQ(scene.torsion_springs[0].free_angle, -400 * degree);
}

TEST_F(SetValue, SetsBars) {
  set_value(scene, "bar.tie.length", 7);
  EXPECT_DOUBLE_EQ(scene.joints[2].length, 7 * inch);
}

TEST_F(SetValue, SetsStops) {
  set_value(scene, "stop.turn.min", -30);
  set_value(scene, "stop.turn.max", 60);
  set_value(scene, "stop.reach.min", 1);
  set_value(scene, "stop.travel.max", 2);
  EXPECT_DOUBLE_EQ(scene.stops[0].min, -30 * degree);
  EXPECT_DOUBLE_EQ(scene.stops[0].max, 60 * degree);
  EXPECT_DOUBLE_EQ(scene.stops[1].min, 1 * inch);
  EXPECT_DOUBLE_EQ(scene.stops[2].max, 2 * inch);
}

TEST_F(SetValue, SetsStarts) {
  set_value(scene, "start.crank", 45);
  set_value(scene, "start.ground.S-rod.1.B", -2);
  EXPECT_DOUBLE_EQ(scene.start.angle[1].value(), 45 * degree);
  EXPECT_DOUBLE_EQ(scene.start.travel[1].value(), -2 * inch);
  EXPECT_FALSE(scene.start.angle[2].has_value());
}

TEST_F(SetValue, NamesTheNearestPath) {
  const std::string expected = ": expected the path of a number of the scene; did you mean ";
  EXPECT_EQ(message("load.Q", 1), "load.Q" + expected + "\"load.P\"?");
  EXPECT_EQ(message("P", 1), "P" + expected + "\"load.P\"?");
  EXPECT_EQ(message("", 1), expected + "\"load.P\"?");
  EXPECT_EQ(message("body.crank.mas", 1), "body.crank.mas" + expected + "\"body.crank.mass\"?");
  EXPECT_EQ(message("body.crank", 1), "body.crank" + expected + "\"body.crank.mass\"?");
  EXPECT_EQ(message("body.crankxmass", 1), "body.crankxmass" + expected + "\"body.crank.mass\"?");
  EXPECT_EQ(message("spring.sprong 1.stiffness", 1),
            "spring.sprong 1.stiffness" + expected + "\"spring.spring 1.stiffness\"?");
  EXPECT_EQ(message("bar.ground.O-crank.O.length", 1),
            "bar.ground.O-crank.O.length" + expected + "\"start.ground.S-rod.1.B\"?");
  EXPECT_EQ(message("start.ground", 1), "start.ground" + expected + "\"start.crank\"?");
  EXPECT_EQ(message("start.ground.O-crank.O", 1), "start.ground.O-crank.O" + expected + "\"start.ground.S-rod.1.B\"?");
}

TEST_F(SetValue, RefusesValuesOutOfRangeAndKeepsTheOld) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message("load.P", -1), "load.P: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("load.T", nan), "load.T: expected a finite number, found nan");
  EXPECT_EQ(message("body.crank.mass", -2), "body.crank.mass: expected a finite number >= 0, found -2");
  EXPECT_EQ(message("bar.tie.length", 0), "bar.tie.length: expected a finite number > 0, found 0");
  EXPECT_EQ(message("stop.reach.min", -1), "stop.reach.min: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("stop.turn.min", 91), "stop.turn.min: expected min <= max; set the other limit first");
  EXPECT_EQ(message("stop.turn.max", -1), "stop.turn.max: expected min <= max; set the other limit first");
  EXPECT_DOUBLE_EQ(norm(scene.forces[0].vector), 5 * pound_force);
  EXPECT_DOUBLE_EQ(scene.joints[2].length, 1 * inch);
  EXPECT_DOUBLE_EQ(scene.stops[0].min, 0.0);
  EXPECT_DOUBLE_EQ(scene.stops[0].max, 90 * degree);
}

TEST_F(SetValue, NeedsADirectionToSetAMagnitude) {
  EXPECT_EQ(message("load.none", 1),
            "load.none: expected a force with a direction, its vector is [0, 0]; give another vector");
}

TEST_F(SetValue, RefusesTwoValuesOfTheSameName) {
  scene.springs.push_back(scene.springs[0]);
  EXPECT_EQ(message("spring.spring 1.stiffness", 1),
            "spring.spring 1.stiffness: expected one value, found several; give them different names");
}

}  // namespace
}  // namespace poise
