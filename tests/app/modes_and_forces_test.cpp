#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests {
namespace {

using nlohmann::json;

// A motor swings a bar of 2 kg and 1.2 m about its end, in degrees and millimetres.
constexpr const char* motor = R"(
title = "Motor"
gravity = [0, -9810]
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.bar]
points = { O = [0, 0], E = [1200, 0] }
mass = 2
center = [600, 0]
inertia = 240000
[[pin]]
name = "O"
points = ["ground.O", "bar.O"]
[start]
bar = 30
)";

json json_of(const TempFolder& folder, std::vector<std::string> words, int exit_code) {
  const std::string file = folder.path("result.json").string();
  words.insert(words.end(), {"--json", file});
  const Outcome run = run_poise(words);
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  return json::parse(contents(file));
}

TEST(ModesCommand, TellsFrequencyAndDampingOfTheLift) {
  const Outcome run = run_poise({"modes", dataset("lift")});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.out.find("2.703665518"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("0.0169807"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("obd +1.00"), std::string::npos) << run.out;
}

TEST(ModesCommand, JsonHoldsRootsAndShape) {
  const TempFolder folder;
  const json r = json_of(folder, {"modes", folder.write("motor.toml", motor), "--seek", "stable"}, 0);
  EXPECT_EQ(r["status"], "confirmed");
  EXPECT_EQ(r["stability"], "stable");
  EXPECT_NEAR(r["coordinates"][0]["rest"], -90.0, 1e-9);
  ASSERT_EQ(r["modes"].size(), 1U);
  const json& mode = r["modes"][0];
  const double omega = std::sqrt(9.81 * 0.6 * 2 / 0.96);
  EXPECT_EQ(mode["kind"], "swings");
  EXPECT_NEAR(mode["frequency"], omega / (2 * M_PI), 1e-12);
  EXPECT_NEAR(mode["roots"][0][1], omega, 1e-12);
  EXPECT_NEAR(mode["shape"][0][0], 1 / std::sqrt(0.96), 1e-12);
}

TEST(ModesCommand, SaysWhyItKnowsNone) {
  const Outcome run = run_poise({"modes", dataset("thesis_chain")});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("nothing that can move has inertia"), std::string::npos) << run.out;
}

TEST(ForcesCommand, SaysWhatHoldsAPose) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor);
  const json alone = json_of(folder, {"forces", scene}, 1);
  EXPECT_EQ(alone["balanced"], false);
  const json held = json_of(folder, {"forces", scene, "--drive", "bar"}, 0);
  EXPECT_EQ(held["balanced"], true);
  const double moment = 2 * 9.81 * 600 * std::cos(M_PI / 6);  // N mm
  EXPECT_NEAR(held["forces"]["effort.bar"][0], moment, 1e-9);
  EXPECT_NEAR(held["forces"]["reaction.O.y"][0], 2 * 9.81, 1e-12);
  const json elsewhere = json_of(folder, {"forces", scene, "--drive", "bar=-60"}, 0);
  EXPECT_NEAR(elsewhere["forces"]["effort.bar"][0], 2 * 9.81 * 600 * 0.5, 1e-9);
}

TEST(ForcesCommand, SpinningBarPullsAtItsPin) {
  const TempFolder folder;
  const json r = json_of(
      folder, {"forces", folder.write("motor.toml", motor), "--drive", "bar=0..360", "--steps", "4", "--rate", "540"},
      0);
  ASSERT_EQ(r["at"].size(), 5U);
  EXPECT_NEAR(r["at"][3], 270.0, 1e-12);
  const double pull = 2 * 0.6 * std::pow(3 * M_PI, 2);
  EXPECT_NEAR(r["forces"]["reaction.O.x"][0], -pull, 1e-9);
  EXPECT_NEAR(r["forces"]["reaction.O.y"][1], 2 * 9.81 - pull, 1e-9);
  EXPECT_NEAR(r["forces"]["effort.bar"][2], -2 * 9.81 * 600, 1e-8);
  EXPECT_NEAR(r["forces"]["power.bar"][2], -2 * 9.81 * 600 * 3 * M_PI, 1e-6);
}

// The motion that poise motion writes needs no drive, whether its rates are read or not.
TEST(ForcesCommand, BalancesARecordedSwing) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor);
  const std::string record = folder.path("swing.csv").string();
  const Outcome moved =
      run_poise({"motion", scene, "--duration", "1", "--rate", "500", "--from", "start", "--csv", record});
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  const json r = json_of(folder, {"forces", scene, "--motion", record}, 0);
  EXPECT_EQ(r["balanced"], true);
  ASSERT_EQ(r["at"].size(), 501U);
  EXPECT_NEAR(r["forces"]["reaction.O.x"][0], 0.75 * 2 * 9.81 * std::cos(M_PI / 6) * 0.5, 1e-6)
      << "let go level with 30 deg it starts with 3/4 g cos 30 across";
}

TEST(ForcesCommand, CsvHoldsEveryPose) {
  const TempFolder folder;
  const std::string file = folder.path("f.csv").string();
  const Outcome run = run_poise({"forces", dataset("four_bar_gravity"), "--drive", "crank=0..6", "--csv", file});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::istringstream lines(contents(file));
  std::string header, line;
  std::getline(lines, header);
  EXPECT_TRUE(header.starts_with("crank,effort.crank,power.crank,reaction.A.x,reaction.A.y,")) << header;
  int rows = 0;
  while (std::getline(lines, line)) ++rows;
  EXPECT_EQ(rows, 73);
}

TEST(ForcesCommand, NamesWhatIsWrong) {
  const std::string scene = dataset("four_bar_gravity");
  const auto complaint = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"forces", scene});
    const Outcome run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    return run.err;
  };
  EXPECT_NE(complaint({"--drive", "crnk"}).find("did you mean \"crank\"?"), std::string::npos);
  EXPECT_NE(complaint({"--rate", "3"}).find("--rate: nothing is driven"), std::string::npos);
  EXPECT_NE(complaint({"--drive", "crank=0..x"}).find("is no range of numbers"), std::string::npos);
  EXPECT_NE(complaint({"--motion", "nowhere.csv"}).find("--motion: cannot read \"nowhere.csv\""), std::string::npos);
  EXPECT_NE(complaint({"--drive", "crank=0..1", "--motion", "a.csv"}).find("--motion:"), std::string::npos);
}

}  // namespace
}  // namespace poise::app_tests
