// `poise path` through the command line.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::path_command_test {
namespace {

using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The one line that is said of bad input.
std::string complaint(const std::vector<std::string>& further) {
  std::vector<std::string> words = {"path", dataset("von_mises_toggle")};
  words.insert(words.end(), further.begin(), further.end());
  const ProgramRun outcome = run_poise(words);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  return outcome.err;
}

TEST(PathCommand, SaysInOneLineWhatItCannotRead) {
  EXPECT_TRUE(contains(complaint({"--vary", "lod.P=0..5"}), "--vary lod.P: ")) << "the name";
  EXPECT_TRUE(contains(complaint({"--vary", "lod.P=0..5"}), "did you mean \"load.P\"?"));
  EXPECT_TRUE(contains(complaint({"--vary", "travel.gide=0..1"}), "did you mean \"guide\"?"));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=2..2"}), "the range 2..2 has no length"));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=0..x"}), "is no range of numbers"));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P"}), "there is no \"=\""));
  EXPECT_TRUE(
      contains(complaint({"--vary", "load.P=0..5", "--at", "1,7"}), "within the range of load.P, 0..5, found 7"));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=0..5", "--at", "1,x"}), "\"x\" is not a number"));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=0..5", "--measure", "guid"}), "did you mean \"travel.guide\""));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=0..5", "--from", "rest"}), "expected settle or equilibrium"));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=0..5", "--follow", "all"}), "expected unstable or jump"));
  EXPECT_TRUE(contains(complaint({}), "--vary is required"));
}

TEST(PathCommand, SaysInOneLineWhatCannotBeSideBySide) {
  const auto with = [](std::vector<std::string> further) {
    further.insert(further.begin(), {"--vary", "load.P=0..5"});
    return complaint(further);
  };
  EXPECT_TRUE(contains(with({"--variant", "soft"}), "--variant soft: expected a label and settings"));
  EXPECT_TRUE(contains(with({"--variant", "soft: "}), "expected a label and settings"));
  EXPECT_TRUE(contains(with({"--variant", "A: load.P"}), "A: --set load.P: "));
  EXPECT_TRUE(contains(with({"--variant", "A: spring.left.stiffness=900", "--variant", "A: load.P=1"}),
                       "expected labels that differ, found \"A\" twice"));
  EXPECT_TRUE(contains(with({"--variant", "A: load.P=1"}), "load.P is what --vary varies"));
  EXPECT_TRUE(contains(with({"--beside", "nowhere.toml"}), "nowhere: nowhere.toml: cannot be read"));
  EXPECT_TRUE(contains(with({"--beside", dataset("toggle_clamp")}), "expected a scene in the units of"));
  EXPECT_TRUE(contains(with({"--beside", dataset("hanging_chain_10")}), "hanging_chain_10: --vary load.P: "));
}

// Two springs k of the length l0 hold the apex of Von Mises' toggle at the height h, 1 from their feet: up it needs
// F = P - 2 k (l0 - l) h / l,  l^2 = 1 + h^2.
TEST(PathCommand, ComparesScenesWithOneAnother) {
  const TempFolder folder;
  const std::string result = folder.path("p.json"), table = folder.path("p.csv"), chart = folder.path("p.svg");
  const ProgramRun outcome =
      run_poise({"path", dataset("von_mises_toggle"), "--vary", "travel.guide=0.4..0.1", "--at", "0.3,0.2", "--variant",
                 "twice: spring.left.stiffness=2000, spring.right.stiffness=2000", "--variant", "unloaded: load.P=0",
                 "--json", result, "--csv", table, "--svg", chart});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  const json answer = json::parse(contents(result));
  ASSERT_EQ(answer["scenes"].size(), 3U);
  const json& effort = answer["quantities"][0];
  EXPECT_EQ(effort["name"], "force");
  ASSERT_EQ(effort["values"].size(), 6U);
  for (const json& one : effort["values"]) {
    const double h = one["parameter"], l = std::hypot(1.0, h), P = 21.45716286561234384347652;
    const double springs = -2000 * (std::sqrt(1.25) - l) * h / l;
    const bool is_first = one["scene"] == "von_mises_toggle", is_twice = one["scene"] == "twice";
    EXPECT_NEAR(one["value"].get<double>(), is_twice ? P + 2 * springs : is_first ? P + springs : springs, 1e-9);
    EXPECT_NEAR(one["difference"].get<double>(), is_twice ? springs : is_first ? 0.0 : -P, 1e-9);
  }
  EXPECT_TRUE(contains(outcome.out, "twice - von_mises_toggle"));
  EXPECT_TRUE(contains(contents(table), "scene,branch,parameter,effort,stability,proof"));
  EXPECT_TRUE(contains(contents(chart), "twice"));
}

TEST(PathCommand, SaysInOneLineWhatACurveOfFoldsNeeds) {
  const std::vector<std::string> two = {"--vary", "load.P=0..1", "--vary", "spring.left.stiffness=1..2"};
  const auto with = [&](const std::vector<std::string>& further) {
    std::vector<std::string> words = two;
    words.insert(words.end(), further.begin(), further.end());
    return complaint(words);
  };
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=0..1", "--curve", "fold"}), "expected --vary twice, found 1"));
  EXPECT_TRUE(contains(with({}), "expected one number, found 2; two with --curve fold"));
  EXPECT_TRUE(contains(with({"--curve", "cusp"}), "expected equilibria or fold"));
  EXPECT_TRUE(contains(with({"--curve", "fold", "--at", "1"}), "--at: not with --curve fold"));
  EXPECT_TRUE(contains(with({"--curve", "fold", "--follow", "jump"}), "--follow: not with --curve fold"));
  EXPECT_TRUE(contains(with({"--curve", "fold", "--search", "3"}), "--search: not with --curve fold"));
  EXPECT_TRUE(contains(complaint({"--vary", "load.P=0..1", "--vary", "load.P=0..2", "--curve", "fold"}),
                       "--vary load.P: named twice"));
}

TEST(PathCommand, WritesTheSameCurveEverywhere) {
  const TempFolder folder;
  const std::string table = folder.path("p.csv"), result = folder.path("p.json"), chart = folder.path("p.svg");
  const ProgramRun outcome = run_poise({"path", dataset("von_mises_toggle"), "--vary", "load.P=-60..60", "--at", "30",
                                        "--csv", table, "--json", result, "--svg", chart});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  const json answer = json::parse(contents(result));
  EXPECT_EQ(answer["status"], "traced");
  EXPECT_EQ(answer["unproved"], 0);
  const std::string lines = contents(table);
  EXPECT_EQ(static_cast<std::size_t>(std::count(lines.begin(), lines.end(), '\n')), answer["points"].size() + 1);
  std::vector<double> folds;
  for (const json& event : answer["events"]) {
    if (event["kind"] == "fold") folds.push_back(event["parameter"]);
  }
  std::sort(folds.rbegin(), folds.rend());
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_NEAR(folds[0], 42.9143257312246876869530451065, 42.9 * 1e-12);
  EXPECT_NEAR(folds[1], -42.9143257312246876869530451065, 42.9 * 1e-12);
  EXPECT_EQ(answer["at"][0]["equilibria"].size(), 3u);
  EXPECT_EQ(answer["parameter"]["unit"], "N");
  EXPECT_EQ(objection_to_xml(contents(chart)), "");
}

/// A force to the right at the end of the last of n links.
std::string load_on_last_link(int n) {
  return "[[force]]\nname = \"P\"\nat = \"link" + std::to_string(n - 1) + ".b\"\nvector = [1, 0]\n";
}

TEST(PathCommand, WithoutAnEquilibriumAtTheStartExitsOne) {
  const TempFolder folder;
  const std::string scene = folder.write("runaway.toml", runaway);
  const ProgramRun outcome = run_poise({"path", scene, "--vary", "load.push=1..2"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "No equilibrium to begin with at load.push = 1")) << outcome.out << outcome.err;
}

TEST(PathCommand, ShowsTheEffortOfADrive) {
  const ProgramRun outcome = run_poise({"path", dataset("toggle_press"), "--vary", "angle.crank=140..150"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "angle.crank (deg)")) << outcome.out;
  EXPECT_TRUE(contains(outcome.out, "torque (kN mm)")) << outcome.out;
}

TEST(PathCommand, LoadsAndUnloadsWithJumps) {
  const ProgramRun outcome =
      run_poise({"path", dataset("von_mises_toggle"), "--vary", "load.P=-60..60", "--follow", "jump"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "load.P from -60 N to 60 N, and back to -60 N: 2 folds and 2 snaps"))
      << outcome.out;
  EXPECT_TRUE(contains(outcome.out, "hysteresis end")) << outcome.out;
}

TEST(PathCommand, InterruptKeepsWhatWasFollowed) {
  const TempFolder folder;
  const std::string scene = folder.write("links.toml", hanging_links(400) + load_on_last_link(400));
  const std::string result = folder.path("p.json").string(), table = folder.path("p.csv").string();
  const int exit_code = interrupt_poise({"path", scene, "--vary", "load.P=0..1000", "--json", result, "--csv", table},
                                        folder.path("out").string(), std::chrono::milliseconds(500));
  EXPECT_EQ(exit_code, 1);
  const json answer = json::parse(contents(result));
  EXPECT_EQ(answer["status"], "interrupted");
  EXPECT_TRUE(contains(contents(folder.path("out")), "Interrupted")) << contents(folder.path("out"));
}

// A balanced arm needs no torque anywhere; what is left is rounding, and no reason for small units.
TEST(PathCommand, ShowsNoRoundingAsATorque) {
  const TempFolder folder;
  const std::string scene = folder.write("arm.toml", R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], S = [0, 0.3] }
[body.arm]
points = { O = [0, 0], A = [0.2, 0] }
mass = 0.7
center = [0.35, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
name = "k"
points = ["ground.S", "arm.A"]
stiffness = 40.0575
free_length = 0
[start]
arm = 0.2
)");
  const ProgramRun outcome = run_poise({"path", scene, "--vary", "angle.arm=0.1..1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("torque (N m)"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("1.0000000             0  stable"), std::string::npos) << outcome.out;
}

}  // namespace
}  // namespace poise::app_tests::path_command_test
