#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "tests/support/elements.hpp"

namespace poise::set_value_test {
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
    [[damper]]
    name = "oil"
    points = ["ground.O", "rod.1.B"]
    coefficient = 1
    [[torsion_damper]]
    name = "grease"
    bodies = ["ground", "crank"]
    coefficient = 1
    [[friction]]
    name = "dry"
    bodies = ["ground", "crank"]
    torque = 1
    width = 1
    [[drive]]
    name = "motor"
    bodies = ["ground", "crank"]
    [[drive]]
    name = "feed"
    slide = "ground.S-rod.1.B"
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
  EXPECT_DOUBLE_EQ(test::law<LinearSpring>(scene, "spring").stiffness, 2 * pound_force / inch);
  EXPECT_DOUBLE_EQ(test::law<LinearSpring>(scene, "spring").free_length, 3 * inch);
  EXPECT_DOUBLE_EQ(test::law<LinearSpring>(scene, "torsion_spring").stiffness, 4 * pound_force * inch / degree);
  EXPECT_DOUBLE_EQ(test::law<LinearSpring>(scene, "torsion_spring").free_length, -400 * degree);
}

TEST_F(SetValue, SetsDampersAndFriction) {
  set_value(scene, "damper.oil.coefficient", 2);
  set_value(scene, "torsion_damper.grease.coefficient", 3);
  set_value(scene, "friction.dry.torque", 4);
  set_value(scene, "friction.dry.width", 5);
  EXPECT_DOUBLE_EQ(test::law<Damper>(scene, "damper").coefficient, 2 * pound_force / inch);
  EXPECT_DOUBLE_EQ(test::law<Damper>(scene, "torsion_damper").coefficient, 3 * pound_force * inch / degree);
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction").force, 4 * pound_force * inch);
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction").width, 5 * degree);
}

TEST_F(SetValue, SetsDrives) {
  set_value(scene, "drive.motor.start", 10);
  set_value(scene, "drive.motor.rate", -20);
  set_value(scene, "drive.motor.acceleration", 30);
  set_value(scene, "drive.motor.amplitude", 40);
  set_value(scene, "drive.motor.frequency", 0.5);
  set_value(scene, "drive.motor.phase", 60);
  const Drive& motor = scene.drives[0];
  EXPECT_DOUBLE_EQ(motor.start.value(), 10 * degree);
  EXPECT_DOUBLE_EQ(motor.rate, -20 * degree);
  EXPECT_DOUBLE_EQ(motor.acceleration, 30 * degree);
  EXPECT_DOUBLE_EQ(motor.amplitude, 40 * degree);
  EXPECT_EQ(motor.frequency, 0.5);
  EXPECT_DOUBLE_EQ(motor.phase, 60 * degree);
  set_value(scene, "drive.feed.rate", 7);
  set_value(scene, "drive.feed.phase", 8);
  EXPECT_DOUBLE_EQ(scene.drives[1].rate, 7 * inch);
  EXPECT_DOUBLE_EQ(scene.drives[1].phase, 8 * degree);
}

TEST_F(SetValue, SetsPlacesAndGravity) {
  set_value(scene, "body.crank.center.x", 1);
  set_value(scene, "body.crank.center.y", -2);
  set_value(scene, "point.crank.B.x", 3);
  set_value(scene, "point.crank.B.y", -4);
  set_value(scene, "point.ground.S.y", 5);
  set_value(scene, "point.rod.1.B.x", 6);
  set_value(scene, "gravity.x", 7);
  set_value(scene, "gravity.y", -386.09);
  EXPECT_EQ(scene.bodies[1].center, (Vec2{1 * inch, -2 * inch}));
  EXPECT_EQ(scene.local({1, 1}), (Vec2{3 * inch, -4 * inch}));
  EXPECT_EQ(scene.local({0, 1}), (Vec2{1 * inch, 5 * inch}));
  EXPECT_EQ(scene.local({2, 0}), (Vec2{6 * inch, 0}));
  EXPECT_EQ(scene.gravity, (Vec2{7 * inch, -386.09 * inch}));
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
  const std::string expected = ": expected the path of a number of the scene; ";
  const auto expect_suggested = [&](const std::string& path, const std::string& nearest) {
    EXPECT_EQ(message(path, 1), path + expected + "did you mean \"" + nearest + "\"?");
  };
  expect_suggested("load.Q", "load.P");
  expect_suggested("body.crank.mas", "body.crank.mass");
  expect_suggested("body.crank", "body.crank.mass");
  expect_suggested("body.crankxmass", "body.crank.mass");
  expect_suggested("spring.sprong 1.stiffness", "spring.spring 1.stiffness");
  expect_suggested("damper.oil.coeficient", "damper.oil.coefficient");
  expect_suggested("friction.dry.with", "friction.dry.width");
  expect_suggested("drive.moter.rate", "drive.motor.rate");
  expect_suggested("gravity", "gravity.x");
  expect_suggested("gravity..x", "gravity.x");
  expect_suggested("body.crank.center", "body.crank.center.x");
  expect_suggested("point.crank.C.x", "point.crank.O.x");
  expect_suggested("point.crank.B.z", "point.crank.B.x");
  expect_suggested("start.ground", "start.ground.S-rod.1.B");
}

TEST_F(SetValue, ListsPathsWhereNoneIsNear) {
  const auto expect_listed = [&](const std::string& path, const std::string& first) {
    const std::string text = message(path, 1);
    EXPECT_TRUE(text.starts_with(path + ": expected the path of a number of the scene; known here: " + first)) << text;
    EXPECT_TRUE(text.ends_with(" and 46 more")) << text;
  };
  expect_listed("P", "load.P, load.T, gravity.x, ");
  expect_listed("", "load.P, load.T, gravity.x, ");
  expect_listed("bar.ground.O-crank.O.length", "start.ground.S-rod.1.B, ");
  expect_listed("torsion_damper.oil.coefficient", "torsion_damper.grease.coefficient, damper.oil.coefficient, ");
  expect_listed("body.ground.mass", "body.crank.mass, ");
  expect_listed("start.ground.O-crank.O", "start.ground.S-rod.1.B, ");
}

TEST_F(SetValue, RejectsValuesOutOfRangeAndKeepsTheOld) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message("load.P", -1), "load.P: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("load.T", nan), "load.T: expected a finite number, found nan");
  EXPECT_EQ(message("body.crank.mass", -2), "body.crank.mass: expected a finite number >= 0, found -2");
  EXPECT_EQ(message("bar.tie.length", 0), "bar.tie.length: expected a finite number > 0, found 0");
  EXPECT_EQ(message("stop.reach.min", -1), "stop.reach.min: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("stop.turn.min", 91), "stop.turn.min: expected min <= max; set the other limit first");
  EXPECT_EQ(message("stop.turn.max", -1), "stop.turn.max: expected min <= max; set the other limit first");
  EXPECT_EQ(message("damper.oil.coefficient", -1), "damper.oil.coefficient: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("torsion_damper.grease.coefficient", -1),
            "torsion_damper.grease.coefficient: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("friction.dry.torque", -1), "friction.dry.torque: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("friction.dry.width", -1), "friction.dry.width: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("drive.motor.frequency", -1), "drive.motor.frequency: expected a finite number >= 0, found -1");
  EXPECT_EQ(message("drive.motor.start", nan), "drive.motor.start: expected a finite number, found nan");
  EXPECT_EQ(message("point.crank.B.x", nan), "point.crank.B.x: expected a finite number, found nan");
  EXPECT_DOUBLE_EQ(test::law<DryFriction>(scene, "friction").width, 1 * degree);
  EXPECT_FALSE(scene.drives[0].start.has_value());
  EXPECT_DOUBLE_EQ(norm(scene.forces[0].vector), 5 * pound_force);
  EXPECT_DOUBLE_EQ(scene.joints[2].length, 1 * inch);
  EXPECT_DOUBLE_EQ(scene.stops[0].min, 0.0);
  EXPECT_DOUBLE_EQ(scene.stops[0].max, 90 * degree);
}

TEST_F(SetValue, NeedsADirectionToSetAMagnitude) {
  EXPECT_EQ(message("load.none", 1),
            "load.none: expected a force with a direction, its vector is [0, 0]; give it a direction and a size");
}

/// Every path of the scene, with the SI value of its unit.
std::vector<std::pair<std::string, double>> every_path() {
  const double moment = pound_force * inch;
  std::vector<std::pair<std::string, double>> paths = {
      {"load.P", pound_force},
      {"load.T", moment},
      {"spring.spring 1.stiffness", pound_force / inch},
      {"spring.spring 1.free_length", inch},
      {"torsion_spring.coil.stiffness", moment / degree},
      {"torsion_spring.coil.free_angle", degree},
      {"damper.oil.coefficient", pound_force / inch},
      {"torsion_damper.grease.coefficient", moment / degree},
      {"friction.dry.torque", moment},
      {"friction.dry.width", degree},
      {"bar.tie.length", inch},
      {"stop.turn.min", degree},
      {"stop.turn.max", degree},
      {"stop.reach.min", inch},
      {"stop.reach.max", inch},
      {"stop.travel.min", inch},
      {"stop.travel.max", inch},
      {"start.ground.S-rod.1.B", inch},
      {"gravity.x", inch},
      {"gravity.y", inch},
  };
  for (const std::string point : {"ground.O", "ground.S", "crank.O", "crank.B", "rod.1.B"}) {
    for (const std::string axis : {".x", ".y"}) paths.emplace_back("point." + point + axis, inch);
  }
  for (const std::string body : {"crank", "rod.1"}) {
    paths.emplace_back("body." + body + ".mass", pound);
    paths.emplace_back("body." + body + ".inertia", pound * inch * inch);
    for (const std::string axis : {".x", ".y"}) paths.emplace_back("body." + body + ".center" + axis, inch);
    paths.emplace_back("start." + body, degree);
  }
  for (const auto& [drive, unit] : {std::pair{"motor", degree}, std::pair{"feed", inch}}) {
    const std::string path = "drive." + std::string(drive) + ".";
    for (const char* field : {"start", "rate", "acceleration", "amplitude"}) paths.emplace_back(path + field, unit);
    paths.emplace_back(path + "frequency", 1.0);
    paths.emplace_back(path + "phase", degree);
  }
  return paths;
}

TEST_F(SetValue, IsReadBackAtEveryPath) {
  // Grows along the list, so that no limit of a stop passes the other.
  double value = 0.75;
  for (const auto& [path, unit] : every_path()) {
    value += 0.0625;
    EXPECT_NEAR(value_unit(scene, path), unit, 1e-15 * unit) << path;
    set_value(scene, path, value);
    EXPECT_DOUBLE_EQ(get_value(scene, path), value) << path;
  }
  // None of them shares its place with another.
  value = 0.75;
  for (const auto& [path, unit] : every_path()) {
    value += 0.0625;
    EXPECT_DOUBLE_EQ(get_value(scene, path), value) << path;
  }
}

TEST_F(SetValue, ReadsTheValuesOfTheSceneFile) {
  EXPECT_DOUBLE_EQ(get_value(scene, "load.P"), 5.0);
  EXPECT_EQ(get_value(scene, "load.none"), 0.0);
  EXPECT_DOUBLE_EQ(get_value(scene, "stop.turn.max"), 90.0);
  EXPECT_DOUBLE_EQ(get_value(scene, "friction.dry.width"), 1.0);
  EXPECT_EQ(get_value(scene, "start.crank"), 0.0) << "an absent guess";
  EXPECT_EQ(get_value(scene, "stop.reach.min"), -std::numeric_limits<double>::infinity());
}

TEST_F(SetValue, NamesTheNearestPathToReadToo) {
  const auto expect_message = [](const auto& read, const std::string& message) {
    try {
      read();
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), message);
    }
  };
  const std::string expected = ": expected the path of a number of the scene; did you mean ";
  expect_message([&] { get_value(scene, "load.Q"); }, "load.Q" + expected + "\"load.P\"?");
  expect_message([&] { value_unit(scene, "load.Q"); }, "load.Q" + expected + "\"load.P\"?");
  expect_message([&] { get_value(scene, "drive.motor.start"); },
                 "drive.motor.start: expected a drive with a start, this one starts from the assembled position; "
                 "add the key start");
  EXPECT_NO_THROW(value_unit(scene, "drive.motor.start"));
}

TEST_F(SetValue, RejectsTwoValuesOfTheSameName) {
  scene.elements.push_back(test::element(scene, "spring"));
  EXPECT_EQ(message("spring.spring 1.stiffness", 1),
            "spring.spring 1.stiffness: expected one value, found several; give them different names");
}

}  // namespace
}  // namespace poise::set_value_test
