// Scenes with controllers: `poise modes` and `poise motion`, and the commands that refuse them.

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::control_command_test {
namespace {

using nlohmann::json;

/// An arm of 0.1 kg m^2 with a spring of 10 N m/rad and a torque of 1 N m on a DC motor.
const char* const motor_on_a_spring = R"([ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
inertia = 0.1
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 10
[[motor]]
bodies = ["ground", "arm"]
stall_torque = 5
no_load_rate = 20
[[torque]]
name = "T"
on = "arm"
value = 1
)";

// 0.1 a + 0.25 w + 10 phi = 5 + T: at rest at 0.6 rad, damping ratio 0.25/(2 sqrt(0.1 10)), 1/(0.25 w) at resonance.
TEST(ControlCommand, AMotorThatIsHeldDamps) {
  const TempFolder folder;
  folder.write("motor.toml", motor_on_a_spring);
  const std::string scene = folder.path("motor.toml").string();
  const json modes = run_json(folder, {"modes", scene}, 0);
  EXPECT_NEAR(modes["poles"]["re"][0], -1.25, 1e-9);
  EXPECT_NEAR(modes["poles"]["im"][0], std::sqrt(100 - 1.25 * 1.25), 1e-9);
  EXPECT_NEAR(modes["coordinates"][0]["value"], 0.6, 1e-9);
  const json response = run_json(folder,
                                 {"response", scene, "--excite", "load.T", "--of", "angle.arm", "--from",
                                  "1.5915494309189535", "--to", "2", "--steps", "2"},
                                 0);
  EXPECT_NEAR(response["response"]["amplitude"][0], 0.4, 1e-9) << response.dump();
  // A machine that its motor turns has no equilibrium but that of statics.
  const ProgramRun runs = run_poise({"modes", dataset("machines/motor_slider_crank")});
  EXPECT_TRUE(has(runs.out, "Motors are left out: with them no equilibrium is known")) << runs.out;
}

// A step of the reference throws the effort onto its limit: the standard error of the time of the step by differences
// of whole motions, made apart.
TEST(ControlCommand, AStepOntoALimitIsIdentified) {
  const TempFolder folder;
  folder.write("scene.toml", R"([ground]
points = { O = [0, 0] }
[body.m]
points = { P = [0, 0] }
mass = 2
[[slide]]
name = "ax"
points = ["ground.O", "m.P"]
axis = [1, 0]
[[controller]]
name = "c"
slide = "ax"
proportional = 20
derivative = 8
reference = 1
max = 4
time = { reference = { step = { at = 0.5, from = 0, to = 1 } } }
[start]
ax = 0.05
)");
  folder.write("experiment.toml", R"(scene = "scene.toml"
[[sensor]]
name = "x"
travel = "ax"
noise = 1e-3
[[unknown]]
path = "controller.c.time.reference.at"
name = "p"
[[run]]
start_known = true
duration = 2
rate = 20
)");
  const json found = run_json(folder, {"identifiability", folder.path("experiment.toml").string()}, 0);
  EXPECT_NEAR(found["predicted"][0]["standard_error"].get<double>(), 0.00022629, 3e-7) << found["predicted"].dump();
}

// ../shared/benchmarks.md 4.1 and 4.2.
TEST(ControlCommand, ModesSaysThePolesAndTheMatrices) {
  const TempFolder folder;
  const json pid = run_json(folder, {"modes", dataset("machines/upright_pendulum_pid")}, 0);
  EXPECT_EQ(pid["stability"], "stable");
  EXPECT_NEAR(pid["poles"]["re"][0], -3.0, 1e-9);
  EXPECT_NEAR(pid["poles"]["im"][1], 3.0, 1e-9);
  EXPECT_EQ(pid["closed_loop"]["states"], json({"pendulum", "d(pendulum)/dt", "pid integral"}));
  const ProgramRun unstable =
      run_poise({"modes", dataset("machines/upright_pendulum_pid"), "--set", "controller.pid.integral=140"});
  EXPECT_EQ(unstable.exit_code, 0);
  EXPECT_TRUE(has(unstable.out, "The closed loop is unstable")) << unstable.out;

  const std::string csv = folder.path("loop.csv").string();
  const json cart = run_json(folder, {"modes", dataset("machines/cart_pole"), "--csv", csv}, 0);
  const json& loop = cart["closed_loop"];
  EXPECT_EQ(cart["open_loop"]["A"].size(), 4U);
  EXPECT_NEAR(cart["open_loop"]["A"][1][0], 31.1818182, 1e-7);
  EXPECT_NEAR(cart["open_loop"]["B"][3][0], 1.81818182, 1e-8);
  // [A B; C D] in the file.
  std::istringstream rows(contents(csv));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row, "pole,d(pole)/dt,rail,d(rail)/dt,place.reference,pole.reference");
  std::vector<std::vector<double>> block;
  while (std::getline(rows, row)) {
    std::istringstream cells(row);
    std::vector<double>& line = block.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) line.push_back(std::stod(cell));
  }
  ASSERT_EQ(block.size(), 8U);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      EXPECT_EQ(block[i][j], loop["A"][i][j].get<double>());
      EXPECT_EQ(block[4 + i][j], loop["C"][i][j].get<double>());
    }
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_EQ(block[i][4 + j], loop["B"][i][j].get<double>());
      EXPECT_EQ(block[4 + i][4 + j], loop["D"][i][j].get<double>());
    }
  }
}

TEST(ControlCommand, MotionActsByControllers) {
  const TempFolder folder;
  const json moved = run_json(folder,
                              {"motion", dataset("machines/upright_pendulum_pid"), "--release", "pendulum=0.2",
                               "--duration", "5", "--show", "force.pid"},
                              0);
  EXPECT_EQ(moved["degrees_of_freedom"], 1);
  EXPECT_LT(moved["energy_error"].get<double>(), 1e-9);
  // At the start the force with which it resists is kp times the angle.
  EXPECT_NEAR(moved["quantities"][0]["values"][0].get<double>(), 17.155 * 0.2, 1e-9);
  const ProgramRun away = run_poise({"motion", dataset("machines/upright_pendulum_pid"), "--release", "pendulum=0.1",
                                     "--set", "controller.pid.derivative=-30", "--duration", "100"});
  EXPECT_EQ(away.exit_code, 1);
  EXPECT_TRUE(has(away.out, "its controllers let it run away")) << away.out;
}

TEST(ControlCommand, WhatDoesNotKnowControllersRefusesThemByName) {
  const std::string scene = dataset("machines/upright_pendulum_pid");
  const auto refuses = [&](const std::vector<std::string>& arguments) {
    const ProgramRun run = run_poise(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments[0] << run.out;
    EXPECT_TRUE(has(run.err, "controller \"pid\"")) << arguments[0] << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  };
  const TempFolder folder;
  const std::string pushed =
      folder.write("pushed.toml", contents(scene) + "[[torque]]\nname = \"P\"\non = \"pendulum\"\nvalue = 1\n");
  refuses({"response", pushed, "--excite", "load.P", "--of", "angle.pendulum", "--amplitude", "1"});
  refuses({"equations", scene});
  refuses({"running", scene, "--turning", "pendulum"});
  refuses({"kinematics", scene, "--drive", "pendulum=0..90"});
  refuses({"forces", scene, "--drive", "pendulum=0..90"});
  EXPECT_EQ(run_poise({"response", pushed, "--excite", "load.P", "--of", "angle.pendulum"}).exit_code, 0);
  // Statics says what it leaves out.
  const ProgramRun rest = run_poise({"check", scene});
  EXPECT_TRUE(has(rest.out, "controllers are off in statics")) << rest.out;
}

}  // namespace
}  // namespace poise::app_tests::control_command_test
