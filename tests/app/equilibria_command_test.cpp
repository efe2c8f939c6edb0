// `poise equilibria` through the command line.

#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::app_tests::equilibria_command_test {
namespace {

using nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The one line that is said of bad input.
std::string complaint(const std::string& scene, const std::vector<std::string>& further) {
  std::vector<std::string> words = {"equilibria", dataset(scene)};
  words.insert(words.end(), further.begin(), further.end());
  const ProgramRun outcome = run_poise(words);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  return outcome.err;
}

std::set<std::string> keys_of(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.insert(key);
  return keys;
}

TEST(EquilibriaCommand, SaysInOneLineWhatItCannotRead) {
  EXPECT_TRUE(contains(complaint("zeeman", {"--starts", "-1"}), "--starts"));
  EXPECT_TRUE(contains(complaint("zeeman", {"--seconds", "-1"}), "--seconds: expected a time in s, 0 or more"));
  EXPECT_TRUE(contains(complaint("zeeman", {"--jobs", "x"}), "--jobs"));
  EXPECT_TRUE(contains(complaint("four_bar_gravity", {"--drive", "crnk=1"}), "did you mean \"crank\"?"));
  EXPECT_TRUE(contains(complaint("four_bar_gravity", {"--drive", "crank=0..1"}), "expected one place"));
  EXPECT_TRUE(contains(complaint("four_bar_gravity", {"--drive", "crank="}), "expected NAME=VALUE"));
  EXPECT_TRUE(contains(complaint("four_bar_gravity", {"--drive", "crank=1", "--drive", "crank"}), "found twice"));
  EXPECT_TRUE(contains(complaint("four_bar_gravity", {"--assemblies"}), "1 degree of freedom is left"));
}

TEST(EquilibriaCommand, WritesTheSameSetEverywhere) {
  const TempFolder folder;
  const std::string table = folder.path("e.csv"), result = folder.path("e.json"), picture = folder.path("e.svg");
  const ProgramRun outcome = run_poise({"equilibria", dataset("von_mises_toggle"), "--seconds", "0", "--csv", table,
                                        "--json", result, "--svg", picture});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  const json answer = json::parse(contents(result));
  EXPECT_EQ(answer["claim"], "sampled");
  EXPECT_TRUE(contains(answer["statement"], "3 equilibria found from 1000 starts, not proved to be all"));
  EXPECT_EQ(answer["settles_into"], 1);
  ASSERT_EQ(answer["equilibria"].size(), 3U);
  const double heights[] = {-0.548097444662501969, 0.436788903652506563, 0.0949167614870496588};
  for (int k = 0; k < 3; ++k) {
    const json& one = answer["equilibria"][k];
    EXPECT_EQ(one["index"], k);
    EXPECT_EQ(one["status"], "confirmed");
    EXPECT_NEAR(one["slides"]["guide"].get<double>(), heights[k], 1e-12);
    EXPECT_EQ(one["stability"], k < 2 ? "stable" : "unstable");
  }
  ASSERT_EQ(answer["barriers"].size(), 2U);
  const auto energy = [&](int k) { return answer["equilibria"][k]["energy"].get<double>(); };
  for (const json& barrier : answer["barriers"]) {
    EXPECT_NEAR(barrier["energy"].get<double>(), energy(barrier["over"]) - energy(barrier["from"]), 1e-9);
  }
  const std::string lines = contents(table);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 4);
  EXPECT_EQ(lines.substr(0, lines.find('\n')),
            "index,energy,stability,unstable_directions,guide,settles_here,change_point");
  const std::string svg = contents(picture);
  EXPECT_EQ(objection_to_xml(svg), "");
  for (const char* id : {"multiple1", "multiple2", "multiple3"}) EXPECT_TRUE(contains(svg, id)) << id;
  EXPECT_FALSE(contains(svg, "multiple4"));
  EXPECT_TRUE(contains(svg, "2: stable, 10.091 J; solve")) << svg.substr(0, 2000);
  EXPECT_TRUE(contains(outcome.out, "solve settles here"));
}

TEST(EquilibriaCommand, GivesOfEachWhatSolveGives) {
  const TempFolder folder;
  const std::string all = folder.path("all.json"), one = folder.path("one.json");
  run_poise({"equilibria", folder.write("p.toml", pendulum), "--seconds", "0", "--json", all});
  run_poise({"solve", folder.path("p.toml"), "--json", one});
  const json set = json::parse(contents(all)), solved = json::parse(contents(one));
  ASSERT_EQ(set["equilibria"].size(), 2U);
  std::set<std::string> expected = keys_of(solved);
  for (const char* key : {"poise", "verdict", "warnings", "scene", "units", "left_out", "held_loads"}) {
    expected.erase(key);
  }
  expected.insert("index");
  EXPECT_EQ(keys_of(set["equilibria"][0]), expected);
  const json& settled = set["equilibria"][set["settles_into"].get<int>()];
  EXPECT_EQ(settled["angles"], solved["angles"]);
  EXPECT_EQ(settled["energy"], solved["energy"]);
  EXPECT_EQ(settled["reactions"], solved["reactions"]);
}

TEST(EquilibriaCommand, EndsWithOneWhereNothingIsProved) {
  const TempFolder folder;
  const std::string scene = folder.write("p.toml", pendulum);
  // Found as asked for; and none found.
  EXPECT_EQ(run_poise({"equilibria", scene, "--seconds", "0"}).exit_code, 0);
  std::string motor = pendulum;
  motor.insert(motor.find("[start]"), "[[torque]]\nname = \"motor\"\non = \"rod\"\nvalue = 100\n");
  const ProgramRun none = run_poise({"equilibria", folder.write("motor.toml", motor), "--seconds", "0"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_TRUE(contains(none.out, "0 equilibria found")) << none.out << none.err;
  EXPECT_TRUE(contains(none.out, "From the start it settles in none of these")) << none.out;
}

TEST(EquilibriaCommand, HoldsDrivesForAssemblies) {
  const TempFolder folder;
  const std::string result = folder.path("a.json");
  const ProgramRun outcome = run_poise({"equilibria", dataset("four_bar_gravity"), "--assemblies", "--drive", "crank=1",
                                        "--seconds", "0", "--json", result});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(contents(result));
  EXPECT_TRUE(answer["assemblies"]);
  ASSERT_EQ(answer["equilibria"].size(), 2U);
  for (const json& one : answer["equilibria"]) EXPECT_NEAR(one["angles"]["crank"].get<double>(), 1.0, 1e-15);
  EXPECT_TRUE(contains(outcome.out, "the start closes this way")) << outcome.out;
  // Where it stands, and by the scene's own drives.
  EXPECT_EQ(run_poise({"equilibria", dataset("four_bar_gravity"), "--assemblies", "--drive", "crank", "--seconds", "0"})
                .exit_code,
            0);
  std::string driven = contents(dataset("four_bar_gravity"));
  driven.insert(driven.find("[start]"), "[[drive]]\nname = \"motor\"\nbodies = [\"ground\", \"crank\"]\nstart = 1\n");
  const ProgramRun own =
      run_poise({"equilibria", folder.write("driven.toml", driven), "--assemblies", "--seconds", "0"});
  EXPECT_EQ(own.exit_code, 0) << own.err;
  EXPECT_TRUE(contains(own.out, "2 assemblies found")) << own.out;
}

TEST(EquilibriaCommand, ShowsProgressOnATerminalOnly) {
  const ProgramRun quiet = run_poise({"equilibria", dataset("zeeman"), "--seconds", "0", "--starts", "200", "--quiet"});
  EXPECT_EQ(quiet.err, "");
  EXPECT_EQ(std::count(quiet.out.begin(), quiet.out.end(), '\n'), 1) << quiet.out;
}

}  // namespace
}  // namespace poise::app_tests::equilibria_command_test
