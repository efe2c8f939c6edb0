// `poise design` of files with a table [balance]: what it writes, and what it refuses.

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::balance_command_test {
namespace {

using nlohmann::json;

TEST(BalanceCommand, TheLampThatItWritesRestsEverywhere) {
  const TempFolder folder;
  const std::string scene = folder.path("lamp.toml").string(), file = folder.path("lamp.json").string();
  const ProgramRun run = run_poise({"design", dataset("desk_lamp_design"), "--scene", scene, "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json found = json::parse(contents(file));
  EXPECT_NEAR(found["found"]["spring.lower.stiffness"]["value"].get<double>(), 588.6, 1e-10);
  EXPECT_NEAR(found["found"]["spring.upper.stiffness"]["value"].get<double>(), 245.25, 1e-10);
  EXPECT_LT(found["check"]["residual"].get<double>(), 1e-12);
  EXPECT_LT(found["check"]["imbalance"].get<double>(), 1e-12 * found["check"]["weight"].get<double>());
  EXPECT_NE(contents(scene).find("# parallel to the lower arm"), std::string::npos);
  for (const char* const start : {"0.3", "-1", "2"}) {
    const ProgramRun solved = run_poise({"solve", scene, "--set", std::string("start.lower=") + start, "--set",
                                         std::string("start.stay=") + start, "--json", file, "--quiet"});
    EXPECT_EQ(solved.exit_code, 0) << solved.out << solved.err;
    EXPECT_NE(solved.out.find("neutral"), std::string::npos) << solved.out;
  }
}

TEST(BalanceCommand, CounterweightsThatItWritesNeedNoMore) {
  const TempFolder folder;
  const std::string scene = folder.path("four_bar_gravity.toml").string(), file = folder.path("bar.json").string();
  ASSERT_EQ(run_poise({"design", dataset("four_bar_shaking_design"), "--scene", scene}).exit_code, 0);
  const std::string again = folder.write("again.toml", contents(dataset("four_bar_shaking_design")));
  ASSERT_EQ(run_poise({"design", again, "--json", file}).exit_code, 0);
  const json found = json::parse(contents(file));
  EXPECT_LT(found["shaking"]["before"]["force"].get<double>(), 1e-9);
  for (const json& weight : found["counterweights"]) EXPECT_LT(weight["mass"].get<double>(), 1e-12);
}

TEST(BalanceCommand, RefusesInOneLine) {
  const TempFolder folder;
  const auto refusal_of = [&](const std::string& table) {
    const std::string file =
        folder.write("design.toml", "scene = \"" + dataset("desk_lamp") + "\"\n[balance]\n" + table);
    const ProgramRun run = run_poise({"design", file});
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_EQ(run.out, "");
    return run.err.substr(run.err.find("design.toml"));
  };
  EXPECT_EQ(
      refusal_of("of = \"weights\"\nsprings = { \"spring.lowr.stiffness\" = [0, 1] }\n"),
      "design.toml:4: balance.springs.spring.lowr.stiffness: spring.lowr.stiffness: expected the path of a number of "
      "the scene; did you mean \"spring.lower.stiffness\"?\n");
  EXPECT_EQ(refusal_of("of = \"weights\"\nsprings = { \"spring.lower.stiffness\" = [1, 0] }\n"),
            "design.toml:4: balance.springs.spring.lower.stiffness: expected [LEAST, GREATEST]; swap them\n");
  EXPECT_EQ(
      refusal_of("of = \"shaking\"\ncounterweights = { head = { radius = 1 } }\n"),
      "design.toml:2: balance.counterweights.head: expected a body with a pin to the ground, about which the radius "
      "is; give {mass = M}\n");
}

}  // namespace
}  // namespace poise::app_tests::balance_command_test
