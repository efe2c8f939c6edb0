// `poise design` of four-bars through poses and of functions through the command line.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::synthesis_command_test {
namespace {

using app_tests::contents;
using app_tests::dataset;
using app_tests::ProgramRun;
using app_tests::run_poise;
using app_tests::TempFolder;
using Json = nlohmann::json;

TEST(SynthesisCommand, WrittenSceneGoesFromTheFirstPoseToTheLast) {
  const TempFolder folder;
  const std::string scene = folder.path("found.toml").string(), result = folder.path("result.json").string();
  const ProgramRun found = run_poise({"design", dataset("five_poses_design"), "--scene", scene, "--json", result});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const Json data = Json::parse(contents(result));
  EXPECT_TRUE(data.at("complete"));
  EXPECT_TRUE(data.at("confirmed"));
  EXPECT_EQ(data.at("links").size(), 4u);
  EXPECT_EQ(data.at("four_bars").size(), 6u);
  const Json& best = data.at("four_bars").at(data.at("best").get<std::size_t>() - 1);
  const std::string drive = fmt::format("input={}..{}", best.at("from").get<double>(), best.at("to").get<double>());
  const std::string motion = folder.path("motion.json").string();
  const ProgramRun driven = run_poise(
      {"kinematics", scene, "--drive", drive, "--steps", "1", "--show", "x.coupler.P,y.coupler.P", "--json", motion});
  ASSERT_EQ(driven.exit_code, 0) << driven.err;
  // The last pose of the file is (180, -340) at -60 degrees; the first one is the origin at 0.
  const Json moved = Json::parse(contents(motion));
  const auto at = [&](const std::string& name, std::size_t sample) {
    return moved.at("samples").at(name).at(sample).get<double>();
  };
  EXPECT_NEAR(at("x.coupler.P", 0), 0.0, 1e-9);
  EXPECT_NEAR(at("y.coupler.P", 0), 0.0, 1e-9);
  EXPECT_NEAR(at("x.coupler.P", 1), 180.0, 1e-7);
  EXPECT_NEAR(at("y.coupler.P", 1), -340.0, 1e-7);
  EXPECT_NEAR(std::remainder(at("coupler", 1) - at("coupler", 0) + 60.0, 360.0), 0.0, 1e-9);
}

TEST(SynthesisCommand, WithoutAFourBarThatPassesTheCodeIsOne) {
  const TempFolder folder;
  const std::string design = folder.write("known_design.toml", R"([synthesis]
kind = "poses"
poses = [[0, 0, 0], [2.8, -1, -85], [2.5, -0.9, 45], [0, 1.4, 80], [3.6, 0.9, -55]]
)");
  const std::string scene = folder.path("none.toml").string();
  const ProgramRun found = run_poise({"design", design, "--scene", scene, "--quiet"});
  EXPECT_EQ(found.exit_code, 1);
  EXPECT_EQ(found.out,
            "4 links and 6 four-bars through the five poses, all that there are: proved. None passes them in order "
            "without a defect.\n");
  EXPECT_TRUE(folder.names() == std::vector<std::string>{"known_design.toml"});
}

TEST(SynthesisCommand, WrongFilesAreRefused) {
  const TempFolder folder;
  const std::string design = folder.write("wrong_design.toml", "[synthesis]\nkind = \"poses\"\nposes = [[0, 0, 0]]\n");
  const ProgramRun refused = run_poise({"design", design});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("wrong_design.toml:3: synthesis.poses: expected 3, 4 or 5 poses"), std::string::npos)
      << refused.err;
}

}  // namespace
}  // namespace poise::synthesis_command_test
