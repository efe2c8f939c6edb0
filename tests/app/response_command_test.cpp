#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::response_command_test {
namespace {

using nlohmann::json;

// A table of 2 kg on a spring of 50 N/mm, in millimetres and degrees.
constexpr const char* shaken_table = R"(
title = "Table"
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.table]
points = { P = [0, 0] }
mass = 2
[[slide]]
name = "guide"
points = ["ground.O", "table.P"]
axis = [0, 1]
[[spring]]
name = "mount"
slide = "guide"
stiffness = 50
free_length = 0
[[damper]]
name = "film"
slide = "guide"
coefficient = 0.02
[[force]]
name = "P"
at = "table.P"
vector = [0, 3]
)";

std::vector<std::string> respond(const std::string& scene, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"response", scene, "--excite", "load.P", "--of", "y.table.P"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool says(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(ResponseCommand, SaysTheLargestResponseInTheUnitsOfTheScene) {
  const TempFolder folder;
  const std::string scene = folder.write("table.toml", shaken_table), file = folder.path("o.json").string();
  const ProgramRun run =
      run_poise(respond(scene, {"--json", file, "--csv", folder.path("o.csv").string(), "--from", "1", "--to", "100"}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  // k = 50 000 N/m, c = 20 N s/m: z = c / (2 sqrt(k m)).
  const double w = std::sqrt(25000.0), z = 20 / (2 * std::sqrt(1e5));
  EXPECT_TRUE(says(run.out, "Largest response of y.table.P: ")) << run.out;
  EXPECT_TRUE(says(run.out, "per N of load.P, at ")) << run.out;
  const json r = json::parse(contents(file));
  EXPECT_EQ(r["unit"], "mm/N");
  EXPECT_NEAR(r["static"], 0.02, 1e-12);
  ASSERT_EQ(r["resonances"].size(), 1U);
  const json& peak = r["resonances"][0];
  EXPECT_EQ(peak["kind"], "peak");
  EXPECT_EQ(peak["mode"], 1);
  EXPECT_NEAR(peak["frequency"], w * std::sqrt(1 - 2 * z * z) / (2 * M_PI), 1e-8);
  EXPECT_NEAR(peak["amplitude"], 0.02 / (2 * z * std::sqrt(1 - z * z)), 1e-10);
  EXPECT_EQ(r["response"]["frequency"].size(), 201U);
  EXPECT_EQ(r["response"]["frequency"][0], 1.0);
  EXPECT_TRUE(says(contents(folder.path("o.csv")), "frequency,amplitude,phase"));
  EXPECT_NEAR(r["quantity"]["value"], 0.06, 1e-10);
}

TEST(ResponseCommand, SaysWhereItIsUnbounded) {
  const TempFolder folder;
  const std::string file = folder.path("o.json").string();
  const ProgramRun run =
      run_poise({"response", dataset("forced_machine"), "--excite", "load.F", "--of", "y.machine.C", "--json", file});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(says(run.out, "is unbounded at 5.032921 Hz (mode 1, undamped)")) << run.out;
  EXPECT_TRUE(says(run.out, "sine of load \"F\" over time: it has its value at t = 0")) << run.out;
  const json r = json::parse(contents(file));
  EXPECT_TRUE(r["resonances"][0]["amplitude"].is_null());
  for (const json& amplitude : r["response"]["amplitude"]) {
    EXPECT_TRUE(amplitude.is_null() || amplitude.get<double>() < 1.0);
  }
}

TEST(ResponseCommand, SaysWhereASpringThatHardensJumps) {
  const TempFolder folder;
  const std::string file = folder.path("o.json").string();
  const ProgramRun run = run_poise({"response", dataset("duffing"), "--excite", "load.F", "--of", "x.mass.C",
                                    "--amplitude", "0.2", "--from", "0.05", "--to", "0.4", "--json", file});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(says(run.out, "sweeping up it jumps down at 0.2232263 Hz, from 3.62603 m")) << run.out;
  EXPECT_TRUE(says(run.out, "sweeping down it jumps up at 0.1791572 Hz, from 1.11364 m")) << run.out;
  const json r = json::parse(contents(file));
  EXPECT_TRUE(r["periodic"]["whole"]);
  EXPECT_EQ(r["periodic"]["branches"].size(), 1U);
  EXPECT_EQ(r["periodic"]["events"].size(), 3U);
  EXPECT_LT(r["periodic"]["error"], 1e-10);
}

TEST(ResponseCommand, NamesWhatHolds) {
  const TempFolder folder;
  const std::string stopped =
      std::string(shaken_table) + "[[stop]]\nname = \"pad\"\nslide = \"guide\"\nmin = -1\nmax = 0\n";
  const ProgramRun run = run_poise(respond(folder.write("stopped.toml", stopped)));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(says(run.out, "held by its stops")) << run.out;
  const std::string rubbing =
      std::string(shaken_table) + "[[friction]]\nname = \"rail\"\nslide = \"guide\"\nforce = 1\nwidth = 0\n";
  const std::string scene = folder.write("rubbing.toml", rubbing);
  EXPECT_TRUE(says(run_poise(respond(scene)).out, "friction \"rail\": dry friction")) << scene;
  const ProgramRun refused = run_poise(respond(scene, {"--amplitude", "1"}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(says(refused.err, "friction \"rail\" sticks; periodic motions are not followed with it; expected"))
      << refused.err;
}

TEST(ResponseCommand, SaysThatAnUnstableEquilibriumHasNone) {
  const TempFolder folder;
  std::string pushed = shaken_table;
  pushed.replace(pushed.find("stiffness = 50"), 14, "stiffness = -50");
  const ProgramRun run = run_poise(respond(folder.write("pushed.toml", pushed), {"--seek", "any"}));
  EXPECT_NE(run.exit_code, 0) << run.out;
}

TEST(ResponseCommand, RefusesWhatItCannotAnswer) {
  const TempFolder folder;
  const std::string scene = folder.write("table.toml", shaken_table);
  struct Case {
    std::vector<std::string> words;
    std::string message;
  };
  for (const Case& one :
       {Case{respond(scene, {"--from", "3", "--to", "2"}), "--to: expected more than 3 Hz"},
        Case{respond(scene, {"--from", "-1"}), "--from: expected a frequency > 0"},
        Case{respond(scene, {"--at", "3"}), "--at: it asks for all periodic motions"},
        Case{respond(scene, {"--amplitude", "1", "--at", "1e6"}), "--at: expected frequencies from"},
        Case{respond(scene, {"--steps", "1"}), "--steps"},
        Case{respond(scene, {"--amplitude", "-1"}), "--amplitude: expected a number > 0"},
        Case{{"response", scene, "--excite", "load.Q", "--of", "y.table.P"}, "--excite"},
        Case{{"response", scene, "--excite", "body.table.mass", "--of", "y.table.P"},
             "nothing swings with it; expected"},
        Case{{"response", scene, "--excite", "load.P", "--of", "energy"}, "--of energy: its response is not known"},
        Case{{"response", scene, "--excite", "load.P", "--of", "y.table.P,x.table.P"},
             "--of: expected one quantity"}}) {
    const ProgramRun run = run_poise(one.words);
    EXPECT_EQ(run.exit_code, 2) << one.message << run.out;
    EXPECT_TRUE(says(run.err, one.message)) << run.err;
  }
}

}  // namespace
}  // namespace poise::app_tests::response_command_test
