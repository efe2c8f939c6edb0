// Rigs that controllers move: gains, delays and what is behind a drive that a controller leads are found from motions.

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"

namespace poise::controlled_rigs_test {
namespace {

/// The angle of a body with a noise of 0.1 mrad, after a release of the body "rod", in one run of 3 s.
Experiment rig(const std::string& text, const std::vector<std::string>& unknowns) {
  Experiment e;
  e.scene = parse_scene(text, "rig.toml");
  e.sensors = {test::angle_of(e.scene, "rod", 1e-4)};
  for (const std::string& path : unknowns) e.unknowns.push_back(test::unknown(path));
  poise::Release pull;
  pull.body = e.sensors.front().on.body_b;
  pull.value = 0.3;
  e.runs = {test::simulated(100, 300, {pull})};
  return e;
}

std::string rod(const std::string& tables) {
  return R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.rod]
mass = 1
center = [0, 0.5]
inertia = 0.05
points = { P = [0, 0] }
[[pin]]
points = ["ground.O", "rod.P"]
[start]
rod = 0.3
)" + tables;
}

// A pendulum that is kept upright late: the delay is a number as others.
TEST(ControlledRigs, ADelayIsFound) {
  const Experiment e = rig(rod("[[controller]]\nname = \"hand\"\nbodies = [\"ground\", \"rod\"]\nproportional = 14\n"
                               "derivative = 3\ndelay = 0.04\n"),
                           {"controller.hand.proportional", "controller.hand.derivative", "controller.hand.delay"});
  test::expect_found(e, 0.1);
}

TEST(ControlledRigs, GainsOfSamplesAreFound) {
  const Experiment e = rig(rod("[[controller]]\nname = \"hand\"\nbodies = [\"ground\", \"rod\"]\nproportional = 14\n"
                               "derivative = 3\nintegral = 8\nperiod = 0.02\n"),
                           {"controller.hand.proportional", "controller.hand.derivative", "controller.hand.integral"});
  test::expect_found(e, 0.5);
}

// The trolley of a crane is led by a servo that sees the load, whose length is found from its swing.
TEST(ControlledRigs, WhatHangsFromADriveThatIsLed) {
  const Experiment e = rig(R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.trolley]
points = { c = [0, 0] }
mass = 40
[body.rod]
points = { hook = [0, 0], c = [0, -2] }
mass = 100
inertia = 3
center = [0, -2]
[[slide]]
name = "rail"
points = ["ground.O", "trolley.c"]
axis = [1, 0]
[[pin]]
name = "hook"
points = ["trolley.c", "rod.hook"]
[[torsion_damper]]
name = "bearing"
bodies = ["trolley", "rod"]
coefficient = 20
[[drive]]
name = "motor"
slide = "rail"
[[controller]]
name = "trolley"
sets = "drive.motor.acceleration"
reads = { slide = "rail" }
follows = "swing"
reference = 1
proportional = 2.04
derivative = 2.85
[[controller]]
name = "swing"
reads = { bodies = ["ground", "rod"] }
proportional = -3.98
derivative = -1.12
[start]
rail = 0
rod = 0.3
)",
                           {"body.rod.center.y", "controller.trolley.proportional", "controller.swing.derivative"});
  test::expect_derivatives(e, test::released(FitProblem(e))[0]);
  test::expect_found(e, 1.0);
}

}  // namespace
}  // namespace poise::controlled_rigs_test
