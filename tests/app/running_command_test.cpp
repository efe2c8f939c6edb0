// `poise running`: machines with motors.

#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::running_command_test {
namespace {

using nlohmann::json;

// The slider crank of ../shared/benchmarks.md 4.3: with K = 0.2 N m/A a current of M/K.
TEST(RunningCommand, SaysHowAMachineRuns) {
  const TempFolder folder;
  const std::string csv = folder.path("turn.csv").string();
  const json r = run_json(folder, {"running", dataset("machines/motor_slider_crank"), "--csv", csv}, 0);
  EXPECT_TRUE(r["found"]);
  EXPECT_TRUE(r["stable"]);
  EXPECT_NEAR(r["period"], 0.12290078165, 5e-11);
  EXPECT_NEAR(r["mean_speed"].get<double>(), 2 * M_PI / 0.12290078165, 1e-8);
  EXPECT_NEAR(r["slowest"], 41.9999515, 2e-7);
  EXPECT_NEAR(r["fastest"], 63.9869923, 2e-7);
  const json& motor = r["motors"][0];
  EXPECT_EQ(motor["unit"], "N mm");
  EXPECT_NEAR(motor["mean"].get<double>() / 200, 9.1834604, 1e-6);
  EXPECT_NEAR(motor["greatest"].get<double>() / 200, 10.4000065, 1e-6);
  // What the motor gives the damper takes: 30 N s/m times the square of the slider's speed, over the turn.
  std::istringstream rows(contents(csv));
  std::string row;
  std::getline(rows, row);
  EXPECT_EQ(row.substr(0, 16), "time,angle,speed");
  int count = 0;
  double taken = 0.0;
  while (std::getline(rows, row)) {
    const double angle = std::stod(row.substr(row.find(',') + 1));
    const double speed = std::stod(row.substr(row.find(',', row.find(',') + 1) + 1));
    const double s = std::sin(angle), c = std::cos(angle), root = std::sqrt(0.2 * 0.2 - 0.05 * 0.05 * s * s);
    const double slider = speed * (-0.05 * s - 0.05 * 0.05 * s * c / root);
    if (count++ > 0) taken += 30 * slider * slider / 360;
  }
  EXPECT_EQ(count, 361);
  EXPECT_NEAR(motor["power"].get<double>(), taken, 1e-6 * taken);
  for (const json& joint : r["joint_forces"]) EXPECT_GT(joint["greatest"].get<double>(), joint["mean"].get<double>());
}

TEST(RunningCommand, SaysWhatIsMissing) {
  const TempFolder folder;
  folder.write("wheel.toml", wheel);
  const std::string file = folder.path("wheel.toml").string();
  const ProgramRun none = run_poise({"running", file});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_TRUE(has(none.err, "expected a [[motor]] that turns a body; add one, or name a body with --turning BODY"))
      << none.err;
  const ProgramRun named = run_poise({"running", file, "--turning", "whel"});
  EXPECT_EQ(named.exit_code, 2);
  EXPECT_TRUE(has(named.err, "wheel")) << named.err;
  // Without a motor the wheel comes to rest.
  const ProgramRun stands = run_poise({"running", file, "--turning", "wheel"});
  EXPECT_EQ(stands.exit_code, 1) << stands.out;
  EXPECT_TRUE(has(stands.out, "No steady running found: it makes no whole turn")) << stands.out;
  const std::string motor = std::string(wheel) + "[[motor]]\nbodies = [\"ground\", \"wheel\"]\n";
  EXPECT_TRUE(has(run_poise({"running", folder.write("a.toml", motor + "stall_torque = 1\n")}).err,
                  "expected the key no_load_rate"));
  EXPECT_TRUE(has(run_poise({"running", folder.write("b.toml", motor + "stall_torque = -1\nno_load_rate = 3\n")}).err,
                  "stall_torque: expected a finite number >= 0, found -1"));
  EXPECT_TRUE(
      has(run_poise({"running", folder.write("c.toml", motor + "stall_torque = 1\nno_load_rate = 3\n"), "--turns", "0"})
              .err,
          "--turns"));
}

}  // namespace
}  // namespace poise::app_tests::running_command_test
