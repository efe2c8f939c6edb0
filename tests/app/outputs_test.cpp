// Outputs of scenes, and quantities asked for by --show, in all commands that have positions.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::app_tests::outputs_test {
namespace {

using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A lid of 12 kg with its centre 0.4 m and its grip 0.8 m from the hinge, on a torsion spring of 100 N m/rad that is
/// free at 1 rad.
std::string lid(const std::string& outputs) {
  return R"(gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.lid]
points = { O = [0, 0], grip = [0.8, 0] }
mass = 12
center = [0.4, 0]
[[pin]]
name = "hinge"
points = ["ground.O", "lid.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "lid"]
stiffness = 100
free_angle = 1
[start]
lid = 0.6
[outputs]
)" + outputs;
}

constexpr const char* two = "hand = \"push.lid.grip.y * 1.1\"\ntwisted = \"force.coil\"\n";

json data_of(std::vector<std::string> words) {
  const TempFolder folder;
  const std::string file = folder.path("out.json").string();
  words.insert(words.end(), {"--json", file});
  const ProgramRun run = run_poise(words);
  EXPECT_LT(run.exit_code, 2) << run.err;
  EXPECT_GE(run.exit_code, 0) << run.err;
  return json::parse(contents(file));
}

/// 1.1 times the force that holds the lid at an angle against its weight and its spring.
double hand_at(double angle) {
  return 1.1 * (12 * 10 * 0.4 * std::cos(angle) - 100 * (1 - angle)) / (0.8 * std::cos(angle));
}

// The hood turns about where the lines of both links meet.
TEST(Outputs, InstantCentresThatAreShownAreDrawn) {
  const TempFolder folder;
  const std::string file = folder.path("hood.svg").string();
  const ProgramRun run =
      run_poise({"solve", dataset("car_hood"), "--show", "center.hood.ground.x", "--svg", file, "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(contents(file).find("centre hood, ground"), std::string::npos);
}

TEST(Outputs, AreShownByAllCommandsWithPositions) {
  const TempFolder folder;
  const std::string scene = folder.write("lid.toml", lid(two));
  for (const std::string command : {"solve", "equilibria"}) {
    json found = data_of({command, scene});
    const json of = command == "solve" ? found["quantities"] : found["equilibria"][0]["quantities"];
    ASSERT_EQ(of.size(), 2U) << command;
    EXPECT_EQ(of[0]["name"], "hand");
    EXPECT_EQ(of[0]["unit"], "N");
    EXPECT_NEAR(of[0]["value"].get<double>(), 0.0, 1e-9);
    EXPECT_EQ(of[1]["name"], "twisted");
  }
  const json on_path = data_of({"path", scene, "--vary", "angle.lid=0.5..0.9", "--at", "0.7"});
  EXPECT_NEAR(on_path["at"][0]["equilibria"][0]["measures"]["hand"].get<double>(), hand_at(0.7), 1e-9);
  const json swept = data_of({"kinematics", scene, "--drive", "lid=0.5..0.9", "--steps", "2"});
  EXPECT_NEAR(swept["samples"]["hand"][1].get<double>(), hand_at(0.7), 1e-9);
  const json forces = data_of({"forces", scene, "--drive", "lid=0.5..0.9", "--steps", "2"});
  EXPECT_NEAR(forces["forces"]["hand"][1].get<double>(), hand_at(0.7), 1e-9);
  const json pose = data_of({"forces", scene, "--drive", "lid=0.7", "--show", "force.lid"});
  EXPECT_NEAR(pose["quantities"][0]["value"].get<double>(), hand_at(0.7), 1e-9);
  EXPECT_NEAR(pose["quantities"][2]["value"].get<double>(), hand_at(0.7) / 1.1 * 0.8 * std::cos(0.7), 1e-9);
  const json held = data_of({"equilibria", scene, "--drive", "lid=0.7"});
  EXPECT_NEAR(held["equilibria"][0]["quantities"][0]["value"].get<double>(), hand_at(0.7), 1e-9);
}

TEST(Outputs, AreKnownByName) {
  const TempFolder folder;
  const std::string scene = folder.write("lid.toml", lid(two));
  const json sensitive = data_of({"sensitivity", scene, "--of", "twisted"});
  EXPECT_EQ(sensitive["quantities"][0]["name"], "twisted");
  EXPECT_FALSE(sensitive["quantities"][0]["numbers"].empty());
  const json checked = data_of({"check", scene});
  EXPECT_EQ(checked["outputs"][0]["quantity"], "push.lid.grip.y * 1.1");
  EXPECT_EQ(checked["outputs"][1]["unit"], "N m");
  const ProgramRun run = run_poise({"path", scene, "--vary", "angle.lid=0.5..0.9", "--show", "max(hand),work(hand)"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "Over the curve")) << run.out;
  EXPECT_TRUE(contains(run.out, "at angle.lid = 0.9 rad")) << run.out;
}

TEST(Outputs, ThatAreNoQuantityAreRefusedWithFileAndLine) {
  const TempFolder folder;
  const std::string scene = folder.write("lid.toml", lid("hand = \"push.lid.grp.y * 1.1\"\n"));
  for (const std::vector<std::string>& words : {std::vector<std::string>{"check", scene},
                                                {"solve", scene},
                                                {"path", scene, "--vary", "angle.lid=0.5..0.9"},
                                                {"sensitivity", scene, "--of", "energy"}}) {
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_TRUE(contains(run.err, "lid.toml:19: outputs.hand: push.lid.grp.y * 1.1: expected")) << run.err;
    EXPECT_TRUE(contains(run.err, "\"push.lid.grip.y\"")) << run.err;
  }
}

TEST(Show, SaysWhyAQuantityIsUndefined) {
  const TempFolder folder;
  const std::string scene = folder.write("lid.toml", lid("hand = \"push.lid.O.y\"\n"));
  const ProgramRun run = run_poise({"solve", scene, "--show", "d(angle.lid)/d(x.lid.O)"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const json found = data_of({"solve", scene, "--show", "d(angle.lid)/d(x.lid.O),energy"});
  EXPECT_EQ(found["quantities"][0]["why"], "the point does not move along that direction here");
  EXPECT_TRUE(found["quantities"][0]["value"].is_null());
  EXPECT_EQ(found["quantities"][1]["why"], "x.lid.O stands still here");
  EXPECT_TRUE(found["quantities"][2]["why"].is_null());
  EXPECT_TRUE(contains(run.out, "x.lid.O stands still here")) << run.out;
}

TEST(Show, NamesTheThreeNearestQuantities) {
  const TempFolder folder;
  const std::string scene = folder.write("lid.toml", lid(""));
  const ProgramRun run = run_poise({"solve", scene, "--show", "push.lid.grp.y"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_TRUE(contains(run.err, "did you mean \"push.lid.grip.y\", ")) << run.err;
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '"'), 6) << run.err;
  for (const char* over : {"max(energy)", "work(force.coil)"}) {
    const ProgramRun refused = run_poise({"solve", scene, "--show", over});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_TRUE(contains(refused.err, "belongs to a path")) << refused.err;
  }
}

// A mass on a spring oscillates with sqrt(k/I); the stress in a cantilever is that of its root.
TEST(Show, HasModesAndStresses) {
  const TempFolder folder;
  const std::string scene = folder.write("pendulum.toml", R"(
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], T = [2, 0] }
inertia = 3
[body.arm.section]
profile = "rectangle 0.1x0.2"
modulus = 2e11
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "arm"]
stiffness = 12e6
[[force]]
name = "P"
at = "arm.T"
vector = [0, -1000]
follows = "arm"
)");
  const json found = data_of({"solve", scene, "--show", "mode.1.frequency,mode.1.damping,mode.2.frequency"});
  EXPECT_NEAR(found["quantities"][0]["value"].get<double>(), std::sqrt(12e6 / 3) / (2 * M_PI), 1e-6);
  EXPECT_EQ(found["quantities"][0]["unit"], "1/s");
  EXPECT_NEAR(found["quantities"][1]["value"].get<double>(), 0.0, 1e-12);
  EXPECT_EQ(found["quantities"][2]["why"], "the mechanism has 1 mode");
  const json loads = data_of({"loads", scene, "--show", "stress.arm"});
  EXPECT_TRUE(loads["quantities"][0]["value"].is_null() != loads["quantities"][0]["why"].is_null());
}

}  // namespace
}  // namespace poise::app_tests::outputs_test
