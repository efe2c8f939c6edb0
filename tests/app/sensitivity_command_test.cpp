// `poise sensitivity` through the command line.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::app_tests::sensitivity_command_test {
namespace {

using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string complaint(const std::vector<std::string>& further) {
  std::vector<std::string> words = {"sensitivity", dataset("toggle_clamp")};
  words.insert(words.end(), further.begin(), further.end());
  const ProgramRun outcome = run_poise(words);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  return outcome.err;
}

TEST(SensitivityCommand, SaysInOneLineWhatItCannotRead) {
  EXPECT_TRUE(contains(complaint({}), "--of is required"));
  EXPECT_TRUE(contains(complaint({"--of", "force.ruber"}), "did you mean \"force.rubber\""));
  EXPECT_TRUE(contains(complaint({"--of", "reaction.B.z"}), "expected size, x, y, moment or axial"));
  EXPECT_TRUE(contains(complaint({"--of", "reaction.B.moment"}), "a pin transmits no moment"));
  EXPECT_TRUE(contains(complaint({"--of", "angle.ground"}), "the ground does not turn"));
  EXPECT_TRUE(contains(complaint({"--of", "load_at_fold.Q"}), "--of load_at_fold.Q: expected the name of a load"));
  EXPECT_TRUE(contains(complaint({"--of", "travel.x"}), "a slide or a pin in a slot; there is none here"));
  EXPECT_TRUE(contains(complaint({"--of", "travel.A"}), "expected a slide or pin in a slot, A is a pin"));
  EXPECT_TRUE(contains(complaint({"--of", "handle,"}), "\"handle,\": expected a name before and after each comma"));
  EXPECT_TRUE(contains(complaint({"--of", "bogus"}), "bogus: expected the name of a quantity; did you mean "));
  EXPECT_TRUE(contains(complaint({"--of", "handle", "--top", "-1"}), "--top"));
}

// A rubber tip of 400 N/mm that is 1 mm longer presses 400 N more: arm and handle stand against the stop.
TEST(SensitivityCommand, RanksNumbersInTheUnitsOfTheScene) {
  const ProgramRun run = run_poise({"sensitivity", dataset("toggle_clamp"), "--of", "force.rubber,load_at_fold.P"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "1 mm of spring.rubber.free_length moves force.rubber by -400 N")) << run.out;
  EXPECT_TRUE(contains(run.out, "no derivative by load.P: it is the load itself")) << run.out;
}

// A torque of zero matters as much as one of 5 N m on the same arm.
TEST(SensitivityCommand, RanksNumbersThatAreZeroByTheLargestOfTheirKind) {
  const TempFolder folder;
  const std::string scene = folder.write("scene.toml", R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
mass = 1
center = [1, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[torque]]
name = "u"
on = "arm"
value = 5
[[torque]]
name = "t"
on = "arm"
value = 0
[start]
arm = -1.2
)");
  const std::string file = folder.path("s.json").string();
  const ProgramRun run = run_poise({"sensitivity", scene, "--of", "arm", "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::map<std::string, double> effect;
  const json found = json::parse(contents(file));
  for (const json& number : found["quantities"][0]["numbers"]) {
    if (!number["effect"].is_null()) effect[number["number"]] = number["effect"];
  }
  // cos(arm) = 1/2 with sin(arm) < 0, so that 10 sin(arm) d arm + d torque = 0.
  EXPECT_NEAR(effect.at("load.u"), 5e-3 / (10 * std::sqrt(0.75)), 1e-12);
  EXPECT_NEAR(effect.at("load.t"), effect.at("load.u"), 1e-15);
}

TEST(SensitivityCommand, WritesEveryDerivativeAsData) {
  const TempFolder folder;
  const std::string file = folder.path("s.json").string();
  const ProgramRun run =
      run_poise({"sensitivity", dataset("toggle_clamp"), "--of", "handle", "--top", "1", "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json r = json::parse(contents(file));
  ASSERT_EQ(r["quantities"].size(), 1U);
  const json& of = r["quantities"][0];
  EXPECT_NEAR(of["value"].get<double>(), 93.60883, 1e-5);
  EXPECT_EQ(of["unit"], "deg");
  EXPECT_GT(of["numbers"].size(), 30U);
  double last = 1e300;
  for (const json& number : of["numbers"]) {
    const double effect = std::abs(number["effect"].get<double>());
    EXPECT_LE(effect, last * (1 + 1e-8));
    last = effect;
  }
}

// Without springs and load the apex rests anywhere.
TEST(SensitivityCommand, PrintsNoNumberWithoutARegularEquilibrium) {
  const ProgramRun run = run_poise({"sensitivity", dataset("von_mises_toggle"), "--of", "guide", "--set", "load.P=0",
                                    "--set", "spring.left.stiffness=0", "--set", "spring.right.stiffness=0"});
  EXPECT_NE(run.exit_code, 0) << run.out;
  EXPECT_FALSE(contains(run.out, " moves ")) << run.out;
}

// A block that hangs on a spring. The stop is open, so nothing moves its force; the torque has no part in the
// equilibrium, so no value of it is a fold. Both are said, and what can be had is printed.
TEST(SensitivityCommand, ShowsWhatNoNumberMovesAndWhatHasNoFold) {
  const TempFolder folder;
  const std::string scene = folder.write("rail.toml", R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0], S = [0, 1] }
[body.b]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "r"
points = ["ground.O", "b.C"]
axis = [0, 1]
[[spring]]
name = "k"
slide = "r"
stiffness = 100
free_length = 0
[[torque]]
name = "M"
on = "b"
value = 0
[[stop]]
name = "low"
slide = "r"
min = -0.25
[start]
r = -0.1
)");
  const ProgramRun run = run_poise({"sensitivity", scene, "--of", "r,stop.low,load_at_fold.M"});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_TRUE(contains(run.out, "stop.low = 0 N")) << run.out;
  EXPECT_TRUE(contains(run.out, "numbers without effect")) << run.out;
  EXPECT_TRUE(contains(run.out, "of spring.k.stiffness moves travel.r by")) << run.out;
  EXPECT_TRUE(contains(run.out + run.err, "No derivative of fold.load.M")) << run.out << run.err;
}

}  // namespace
}  // namespace poise::app_tests::sensitivity_command_test
