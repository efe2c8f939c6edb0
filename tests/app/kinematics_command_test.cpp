// `poise kinematics` and `poise design` through the command line.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::kinematics_command_test {
namespace {

using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(KinematicsCommand, WritesTheSameNumbersEverywhere) {
  const TempFolder folder;
  const std::string table = folder.path("k.csv"), result = folder.path("k.json"), chart = folder.path("k.svg");
  const ProgramRun outcome = run_poise({"kinematics", dataset("six_bar"), "--drive", "crank=-100..-20", "--steps", "8",
                                        "--rate", "10", "--csv", table, "--json", result, "--svg", chart});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "Driven through the whole range."));
  const json answer = json::parse(contents(result));
  const json& samples = answer["samples"];
  ASSERT_EQ(samples["crank"].size(), 9u);
  EXPECT_EQ(answer["units"]["angle"], "deg");
  EXPECT_NEAR(samples["drive.crank"][4].get<double>(), -60.0, 1e-12);
  EXPECT_NEAR(samples["crank.rate"][4].get<double>(), 10.0, 1e-12);
  // The crank's end runs on a circle of 2 in at 10 deg/s.
  const double w = 10 * std::numbers::pi / 180;
  EXPECT_NEAR(samples["crank.A.x"][4].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(samples["crank.A.x.rate"][4].get<double>(), 2 * w * std::sin(std::numbers::pi / 3), 1e-12);
  EXPECT_NEAR(samples["crank.A.x.acceleration"][4].get<double>(), -w * w, 1e-12);
  const std::string lines = contents(table);
  EXPECT_TRUE(lines.starts_with("drive.crank,crank,crank.rate,crank.acceleration,coupler"));
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 10);
  const std::string header = lines.substr(0, lines.find('\n'));
  EXPECT_EQ(static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1, samples.size());
  EXPECT_EQ(objection_to_xml(contents(chart)), "");
}

TEST(KinematicsCommand, ShowsAScreenAndMoreOnDemand) {
  const std::vector<std::string> words = {"kinematics", dataset("lift"), "--drive", "obd=0.3..0.6"};
  const auto shown = [&](const std::vector<std::string>& further) {
    std::vector<std::string> all = words;
    all.insert(all.end(), further.begin(), further.end());
    const ProgramRun outcome = run_poise(all);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  const std::string plain = shown({});
  EXPECT_LT(std::count(plain.begin(), plain.end(), '\n'), 52);
  EXPECT_TRUE(contains(plain, "1 degree of freedom, driven by obd"));
  EXPECT_TRUE(contains(plain, "Positions\n"));
  EXPECT_FALSE(contains(plain, "Velocities"));
  const std::string all = shown({"--all"});
  EXPECT_TRUE(contains(all, "Accelerations\n")) << all;
  EXPECT_TRUE(contains(all, "platform, payload")) << "welded bodies share a column";
  const std::string point = shown({"--point", "platform.P"});
  EXPECT_TRUE(contains(point, "Point platform.P")) << point;
  EXPECT_TRUE(contains(point, "vy (m/s)")) << point;
  EXPECT_FALSE(contains(point, "Positions"));
}

TEST(KinematicsCommand, DrawsTheMechanismAndThePathOfAPoint) {
  const TempFolder folder;
  const std::string picture = folder.path("k.svg");
  const ProgramRun outcome = run_poise(
      {"kinematics", dataset("six_bar"), "--drive", "crank=-100..-20", "--point", "coupler.B", "--svg", picture});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string text = contents(picture);
  EXPECT_EQ(objection_to_xml(text), "");
  for (const char* part : {"coupler.B", "end of the range", "middle of the range", "Path of coupler.B", "Its speed"}) {
    EXPECT_TRUE(contains(text, part)) << part;
  }
}

TEST(KinematicsCommand, NamesTheDeadCentreAndExitsOne) {
  const ProgramRun outcome = run_poise({"kinematics", dataset("thesis_four_bar"), "--drive", "link4=0..360"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.out, "cannot be driven beyond link4 = 102.79")) << outcome.out;
  EXPECT_TRUE(contains(outcome.out, "link6 and link7 are in line")) << outcome.out;
}

// At the dead centre of its shock a rear suspension moves as a whole, but only rocker and shock are in line.
TEST(KinematicsCommand, CallsOnlyThoseInLineThatAre) {
  const TempFolder folder;
  const std::string scene = folder.write("suspension.toml", R"(
[units]
length = "mm"
[ground]
points = { A = [0, 0], R = [-20, 300], T = [150, 330] }
[body.chainstay]
points = { A = [0, 0], B = [-420, 30] }
[body.seatstay]
points = { B = [0, 0], C = [300, 330] }
[body.rocker]
points = { R = [0, 0], C = [-80, 0], S = [60, 20] }
[body.tube]
points = { S = [0, 0] }
[body.shaft]
points = { T = [0, 0] }
[[pin]]
name = "A"
points = ["ground.A", "chainstay.A"]
[[pin]]
name = "B"
points = ["chainstay.B", "seatstay.B"]
[[pin]]
name = "C"
points = ["seatstay.C", "rocker.C"]
[[pin]]
name = "R"
points = ["ground.R", "rocker.R"]
[[pin]]
name = "S"
points = ["rocker.S", "tube.S"]
[[pin]]
name = "T"
points = ["ground.T", "shaft.T"]
[[slide]]
name = "shock"
points = ["tube.S", "shaft.T"]
axis = [1, 0]
[start]
tube = 0.1
shock = 110
)");
  const ProgramRun outcome = run_poise({"kinematics", scene, "--drive", "shock=160..60"});
  EXPECT_EQ(outcome.exit_code, 1);
  // |T - R| - |S - R| of the points.
  EXPECT_NE(outcome.out.find("cannot be driven beyond shock = 109.3812"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("dead centre of the loop closed by \"shock\": rocker and tube are in line"),
            std::string::npos)
      << outcome.out;
}

TEST(KinematicsCommand, EndsAtAStopAndReportsIt) {
  const TempFolder folder;
  const std::string result = folder.path("k.json");
  const ProgramRun outcome =
      run_poise({"kinematics", dataset("car_hood"), "--drive", "hood=0.8..1.3", "--json", result});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(contains(outcome.out, "Driven up to a stop: the stop \"reach\" is reached at hood = 0.9669"))
      << outcome.out;
  const json answer = json::parse(contents(result));
  EXPECT_FALSE(answer["complete"].get<bool>());
  EXPECT_EQ(answer["stop"], json({{"name", "reach"}, {"limit", "max"}, {"value", 0.44}}));
  const double x = answer["samples"]["hood.H.x"].back(), y = answer["samples"]["hood.H.y"].back();
  EXPECT_NEAR(std::hypot(x - 0.27, y + 0.08), 0.44, 1e-14);
  const ProgramRun beyond = run_poise({"kinematics", dataset("car_hood"), "--drive", "hood=1.3"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_TRUE(contains(beyond.err, "the stop \"reach\" is reached at hood = ")) << beyond.err;
}

TEST(KinematicsCommand, NamesWhatItCannotRead) {
  const auto complaint = [](const std::string& drive) {
    const ProgramRun outcome = run_poise({"kinematics", dataset("six_bar"), "--drive", drive});
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.err;
  };
  EXPECT_TRUE(contains(complaint("cranc=0..1"), "did you mean \"crank\"?"));
  EXPECT_TRUE(contains(complaint("crank=0..x"), "is no range of numbers"));
  EXPECT_TRUE(contains(complaint("crank"), "there is no \"=\""));
  const ProgramRun chain = run_poise({"kinematics", dataset("thesis_chain"), "--drive", "link2=0..1"});
  EXPECT_EQ(chain.exit_code, 2);
  EXPECT_TRUE(contains(chain.err, "drive 1 more, of link1, link3, link4")) << chain.err;
}

TEST(DesignCommand, WritesASceneThatMovesAsReported) {
  const TempFolder folder;
  const std::string found = folder.path("found.toml"), result = folder.path("d.json");
  const ProgramRun outcome =
      run_poise({"design", dataset("lift_design"), "--seed", "16", "--scene", found, "--json", result});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "confirmed by the general kinematics"));
  const json answer = json::parse(contents(result));
  EXPECT_TRUE(answer["met"].get<bool>());
  const std::string range = "obd=" + answer["drive"]["from"].dump() + ".." + answer["drive"]["to"].dump();
  const std::string swept = folder.path("k.json");
  const ProgramRun moved = run_poise({"kinematics", found, "--drive", range, "--json", swept});
  ASSERT_EQ(moved.exit_code, 0) << moved.out << moved.err;
  double low = 1e300, high = -1e300;
  const json motion = json::parse(contents(swept));
  for (const double y : motion["samples"]["platform.Q.y"]) {
    low = std::min(low, y);
    high = std::max(high, y);
  }
  EXPECT_NEAR(high - low, 1.5, 1e-6);
}

TEST(DesignCommand, SceneMustBeAFileOfItsOwn) {
  const TempFolder folder;
  const std::string same = folder.path("same").string();
  for (const char* option : {"--json", "--markdown"}) {
    const ProgramRun outcome = run_poise({"design", dataset("lift_design"), "--scene", same, option, same});
    EXPECT_EQ(outcome.exit_code, 2) << option;
    EXPECT_TRUE(contains(outcome.err, "--scene: ")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "expected another file")) << outcome.err;
  }
  for (const char* read : {"lift_design", "lift"}) {
    const ProgramRun outcome = run_poise({"design", dataset("lift_design"), "--scene", dataset(read)});
    EXPECT_EQ(outcome.exit_code, 2) << read;
    EXPECT_TRUE(contains(outcome.err, "expected another file")) << outcome.err;
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(DesignCommand, ExitsOneWhereItFindsNothing) {
  const ProgramRun outcome = run_poise({"design", dataset("lift_design"), "--starts", "1"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.out, "No dimensions meet all goals yet")) << outcome.out;
}

}  // namespace
}  // namespace poise::app_tests::kinematics_command_test
