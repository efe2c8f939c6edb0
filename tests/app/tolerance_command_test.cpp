// `poise tolerance` through the command line.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::tolerance_command_test {
namespace {

using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::vector<std::string> clamp = {
    "tolerance", dataset("toggle_clamp"), "--tolerances", dataset("toggle_clamp_tolerances"), "--of", "force.rubber"};

ProgramRun with(const std::vector<std::string>& further) {
  std::vector<std::string> words = clamp;
  words.insert(words.end(), further.begin(), further.end());
  return run_poise(words);
}

std::string complaint(const ProgramRun& outcome) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  return outcome.err;
}

TEST(ToleranceCommand, SaysInOneLineWhatItCannotRead) {
  const TempFolder folder;
  EXPECT_TRUE(contains(complaint(run_poise({"tolerance", dataset("toggle_clamp"), "--of", "handle"})),
                       "--tolerances is required"));
  EXPECT_TRUE(contains(complaint(with({"--samples", "-1"})), "--samples"));
  EXPECT_TRUE(contains(complaint(with({"--jobs", "-1"})), "--jobs"));
  EXPECT_TRUE(contains(complaint(run_poise({"tolerance", dataset("toggle_clamp"), "--of", "handle", "--tolerances",
                                            folder.path("none.toml").string()})),
                       "cannot be read"));
  const std::string file = folder.write("t.toml", "[tolerances]\n\"pont.*\" = 0.1\n");
  EXPECT_TRUE(
      contains(complaint(run_poise({"tolerance", dataset("toggle_clamp"), "--of", "handle", "--tolerances", file})),
               "t.toml:2: tolerances.pont.*: expected the path of a number"))
      << "the place";
}

TEST(ToleranceCommand, ShowsThatTheClampSnapsOpen) {
  const ProgramRun run = with({"--samples", "2000"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, "lose it and settle elsewhere")) << run.out;
  EXPECT_TRUE(contains(run.out, "force.rubber is not linear over these tolerances")) << run.out;
  EXPECT_TRUE(contains(run.out, "point.ground.A.y")) << run.out;
}

// Torques that cancel but for a millionth, each to 5 %: no sample has an equilibrium.
TEST(ToleranceCommand, FailsWhereTheEquilibriumContinuesToNoSample) {
  const TempFolder folder;
  const std::string file = folder.write("t.toml", "[tolerances]\n\"load.T1\" = { percent = 5 }\n");
  const ProgramRun run = run_poise(
      {"tolerance", dataset("hard/cancelling_couple"), "--tolerances", file, "--of", "arm", "--samples", "20"});
  EXPECT_EQ(run.exit_code, 1) << run.out;
  EXPECT_TRUE(contains(run.out, "continues to 0 %")) << run.out;
}

// One sample tells nothing of how far others are from it.
TEST(ToleranceCommand, OneSampleHasNoDeviation) {
  const TempFolder folder;
  const std::string file = folder.path("t.json").string();
  const ProgramRun run = with({"--samples", "1", "--json", file});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(contains(run.out, ", 1 sample: ")) << run.out;
  const json r = json::parse(contents(file));
  EXPECT_TRUE(r["quantities"][0]["continued"]["sigma"].is_null());
  EXPECT_TRUE(r["quantities"][0]["continued"]["mean"].is_number());
}

TEST(ToleranceCommand, WritesTheSameDataForAnyNumberOfThreads) {
  const TempFolder folder;
  std::vector<std::string> texts;
  for (const char* jobs : {"1", "2"}) {
    const std::string file = folder.path(std::string("t") + jobs + ".json").string();
    EXPECT_EQ(with({"--samples", "2000", "--jobs", jobs, "--json", file}).exit_code, 0);
    texts.push_back(contents(file));
  }
  EXPECT_EQ(texts[0], texts[1]);
  const json r = json::parse(texts[0]);
  EXPECT_EQ(r["samples"], 2000);
  EXPECT_EQ(r["continued"].get<int>() + r["snapped"].get<int>(), 2000);
  const json& of = r["quantities"][0];
  EXPECT_NEAR(of["nominal"].get<double>(), -724.53765593, 1e-6);
  EXPECT_EQ(of["linear"], false);
  int drawn = 0;
  for (const json& bin : of["histogram"]) drawn += bin.get<int>();
  EXPECT_EQ(drawn, 2000);
}

}  // namespace
}  // namespace poise::app_tests::tolerance_command_test
