// `poise identifiability` and `poise montecarlo` through the command line; bad input of all that read experiments.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::identifiability_commands_test {
namespace {

using nlohmann::json;

constexpr const char* inertia_too = R"([[unknown]]
path = "body.wheel.inertia"
name = "J"
)";

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(IdentifiabilityCommand, PredictsTheLiftBeforeAnyData) {
  const TempFolder folder;
  const json r = run_json(folder, {"identifiability", dataset("lift_experiment")}, 0);
  EXPECT_EQ(r["identifiability"]["rank"], 4);
  EXPECT_EQ(r["nuisances"], 18);
  EXPECT_EQ(r["readings"], 12000);
  EXPECT_NEAR(r["predicted"][0]["value"], 64.6824, 1e-4);
  EXPECT_NEAR(100 * r["predicted"][0]["standard_error"].get<double>() / 64.6824, 0.037, 0.0006) << "per cent";
  EXPECT_EQ(r["base_parameters"]["rank"], 23);
  EXPECT_EQ(r["base_parameters"]["parameters"], 36);
  EXPECT_EQ(r["verdict"], "All 4 parameters are identifiable from these data.");
  for (const json& p : r["predicted"]) EXPECT_EQ(p["identifiable"], true) << p;
}

TEST(IdentifiabilityCommand, NamesTheScaleAndTheRemedy) {
  const ProgramRun run = run_poise({"identifiability", dataset("lift_experiment_empty"), "--base"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "4 of 4 parameters are not identifiable from these data.")) << run.out;
  EXPECT_TRUE(has(run.out, "overall scale")) << run.out;
  EXPECT_TRUE(has(run.out, "remedy: add a run with a known payload")) << run.out;
  EXPECT_TRUE(has(run.out, "cylinder.J + 1 rod.J")) << run.out;
}

TEST(IdentifiabilityCommand, NamesAnExactNullDirection) {
  // Inertia, stiffness and damping of a free wheel: only their ratios matter.
  const TempFolder folder;
  const json r =
      run_json(folder, {"identifiability", experiment(folder, std::string(wheel_unknowns) + inertia_too + one_run)}, 0);
  EXPECT_EQ(r["identifiability"]["rank"], 2);
  ASSERT_EQ(r["identifiability"]["not_identifiable"].size(), 1U);
  const json& direction = r["identifiability"]["not_identifiable"][0];
  EXPECT_EQ(direction["exact"], true);
  for (const char* name : {"k", "c", "J"}) EXPECT_NEAR(direction["part"][name], 1.0, 1e-6) << "all by the same part";
  for (const json& p : r["predicted"]) {
    EXPECT_TRUE(p["standard_error"].is_null()) << p;
    EXPECT_EQ(p["identifiable"], false) << p;
  }
}

// Mass, centre and inertia of an arm: a direction of them changes no motion, and it curves.
constexpr const char* arm = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
mass = 2
center = [0.3, 0]
inertia = 0.05
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 3
[[torsion_damper]]
name = "D"
bodies = ["ground", "arm"]
coefficient = 0
)";

constexpr const char* arm_experiment = R"(scene = "arm.toml"
[[sensor]]
name = "turn"
angle = "arm"
noise = 1e-3
[[unknown]]
path = "body.arm.mass"
name = "m"
[[unknown]]
path = "body.arm.center.x"
name = "x"
[[unknown]]
path = "body.arm.inertia"
name = "J"
[[unknown]]
path = "torsion_damper.D.coefficient"
name = "c"
min = -1
scale = 1e-4
[[run]]
release = { arm = -0.7 }
duration = 4
rate = 100
seed = 1
)";

TEST(IdentifiabilityCommand, GivesCombinationsInPlaceOfWhatIsWithheld) {
  const TempFolder folder;
  folder.write("arm.toml", arm);
  const std::string file = folder.write("arm_experiment.toml", arm_experiment);
  const json r = run_json(folder, {"identifiability", file}, 0);
  EXPECT_EQ(r["identifiability"]["rank"], 3);
  EXPECT_EQ(r["identifiability"]["structural_nulls"], 1);
  EXPECT_EQ(r["identifiability"]["other_nulls"], 0);
  for (const json& p : r["predicted"]) EXPECT_EQ(p["identifiable"], p["name"] == "c") << p;
  EXPECT_EQ(r["identifiability"]["combinations"].size(), 0U) << "the null of a centre curves";
  std::string known_centre = arm_experiment;
  const std::string centre = "[[unknown]]\npath = \"body.arm.center.x\"\nname = \"x\"\n";
  known_centre.erase(known_centre.find(centre), centre.size());
  folder.write("arm_experiment.toml", known_centre);
  folder.write("arm.toml",
               std::string(arm).replace(std::string(arm).find("gravity = [0, -9.81]"), 20, "gravity = [0, 0]"));
  const json straight = run_json(folder, {"identifiability", file}, 0);
  ASSERT_EQ(straight["identifiability"]["combinations"].size(), 1U);
  const json& c = straight["identifiability"]["combinations"][0];
  EXPECT_EQ(c["coefficient"].size(), 2U) << c;
  EXPECT_EQ(c["coefficient"][c["words"].get<std::string>().substr(0, 1)], 1.0) << c;
  EXPECT_TRUE(c["over"].is_null()) << c;
  EXPECT_GT(c["standard_error"], 0.0);
  const ProgramRun shown = run_poise({"identifiability", file});
  EXPECT_TRUE(has(shown.out, "Combinations that are identifiable")) << shown.out;
  folder.write("arm.toml", arm);
  folder.write("arm_experiment.toml", arm_experiment);
  const ProgramRun run = run_poise({"identifiability", file, "--verbose"});
  EXPECT_TRUE(has(run.out,
                  "3 of 4: 1 direction changes no motion of this mechanism (structural, from its equations "
                  "of motion)"))
      << run.out;
  EXPECT_FALSE(has(run.out, "Combinations")) << run.out;
  EXPECT_TRUE(has(run.out, "change no reading of any motion")) << run.out;
}

// A damping of zero, which its standard error of 0.0005 N m s/rad leaves poorly determined by a scale of 0.0001.
TEST(IdentifyCommand, PrintsANumberThatIsZeroWithItsError) {
  const TempFolder folder;
  folder.write("arm.toml", arm);
  const std::string file = folder.write("arm_experiment.toml", arm_experiment);
  const json r = run_json(folder, {"identify", file}, 0);
  EXPECT_EQ(r["status"], "converged");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(r["estimates"][i]["withheld"], "not identifiable from these data");
  const json& c = r["estimates"][3];
  EXPECT_TRUE(c["withheld"].is_null()) << c;
  EXPECT_EQ(c["poorly_determined"], true) << c;
  EXPECT_LT(std::abs(c["value"].get<double>()), 5 * c["standard_error"].get<double>());
  EXPECT_GT(c["standard_error"], 1e-4 / 3);
  const ProgramRun run = run_poise({"identify", file});
  EXPECT_TRUE(has(run.out, "poorly determined")) << run.out;
  EXPECT_TRUE(has(run.out, "Withheld: 3 of 4 estimates")) << run.out;
  EXPECT_FALSE(has(run.out, "Combinations")) << run.out;
  const json m = run_json(folder, {"montecarlo", file, "--trials", "10"}, 0);
  EXPECT_EQ(m["converged"], 10);
  for (const json& e : m["estimates"]) EXPECT_EQ(e["bound"].is_null(), e["name"] != "c") << e;
}

TEST(MonteCarloCommand, ReachesTheBoundOfAWheel) {
  const TempFolder folder;
  const json r = run_json(
      folder,
      {"montecarlo", experiment(folder, std::string(wheel_unknowns) + one_run), "--trials", "60", "--jobs", "2"}, 0);
  EXPECT_EQ(r["trials"], 60);
  EXPECT_EQ(r["converged"], 60);
  EXPECT_EQ(r["near_truth"], 60);
  for (const json& e : r["estimates"]) {
    EXPECT_NEAR(e["rmse_over_bound"], 1.0, 4 / std::sqrt(2 * 60.0)) << e;
    EXPECT_NEAR(e["coverage"], 0.95, 4 * e["coverage_standard_error"].get<double>()) << e;
  }
}

TEST(MonteCarloCommand, FollowsItsSeed) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  const auto bias = [&](const char* seed, const char* jobs) {
    return run_json(folder, {"montecarlo", file, "--trials", "4", "--seed", seed, "--jobs", jobs},
                    0)["estimates"][0]["bias"]
        .get<double>();
  };
  const double first = bias("1", "1");
  EXPECT_EQ(first, bias("1", "3")) << "threads do not matter";
  EXPECT_NE(first, bias("2", "1"));
}

TEST(MonteCarloCommand, InterruptKeepsTheTrialsThatEnded) {
  const TempFolder folder;
  const std::string out = folder.path("out").string();
  const std::string file = folder.path("a.json").string();
  const int code = interrupt_poise({"montecarlo", experiment(folder, std::string(wheel_unknowns) + one_run), "--trials",
                                    "100000", "--jobs", "2", "--json", file},
                                   out, std::chrono::milliseconds(1500));
  EXPECT_EQ(code, 1);
  EXPECT_TRUE(has(contents(out), "Interrupted after")) << contents(out);
  const json r = json::parse(contents(file));
  EXPECT_EQ(r["interrupted"], true);
  EXPECT_GT(r["trials"], 0);
  EXPECT_LT(r["trials"], 100000);
  EXPECT_EQ(r["converged"], r["trials"]);
}

TEST(ExperimentCommands, BadWordsAreNamed) {
  const TempFolder folder;
  const std::string good = experiment(folder, std::string(wheel_unknowns) + one_run);
  const std::string scene = folder.path("wheel.toml").string();
  const std::string nothing = folder.write(
      "nothing.toml", std::string(wheel_unknowns).substr(0, std::string(wheel_unknowns).find("[[unknown]]")) + one_run);
  std::string lost_text = std::string(wheel_unknowns) + one_run;
  lost_text.replace(lost_text.find("S.stiffness"), 11, "S.stifness");
  const std::string lost = folder.write("lost.toml", lost_text);
  const std::string measured =
      folder.write("measured.toml", std::string(wheel_unknowns) + "[[run]]\ndata = \"d.csv\"\n");
  folder.write("d.csv", "time,turn\n0,1\n0.1,2\n0.2,3\n0.3,2\n");
  const std::string of_lift = "scene = \"" + dataset("lift") +
                              "\"\n[[sensor]]\nname = \"angle\"\nangle = \"obd\"\nnoise = 1e-4\n[[unknown]]\n"
                              "path = \"spring.oil.stiffness\"\n[[run]]\nname = \"low\"\nduration = 1\nrate = 100\n"
                              "seed = 1\nlabels = {}\n\n";
  const std::string impossible = folder.write("impossible.toml", of_lift + "release = { obd = 5 }\n");
  const std::string no_rest =
      folder.write("no_rest.toml", of_lift + "rest = { angle = \"obd\", at = 5, by = \"spring.oil.free_length\" }\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"identify"}, "EXPERIMENT is required"},
      {{"identifiability", good, "b.toml"}, "expected one experiment"},
      {{"identify", good, "b.toml"}, "b.toml: cannot be read"},
      {{"identify", good, good}, "expected different experiments to compare, found this one twice"},
      {{"identify", folder.path("none.toml").string()}, "none.toml"},
      {{"identify", scene}, "wheel.toml:5: body: expected an experiment, found a scene; give a file that names it"},
      {{"solve", good}, "experiment.toml:2: scene: expected a scene, found a file that names one: an experiment"},
      {{"identify", impossible}, "impossible.toml:15: run \"low\".release: " + dataset("lift") + ":"},
      {{"identify", no_rest}, "no_rest.toml:15: rest.at: " + dataset("lift") + ":"},
      {{"identify", lost}, "did you mean"},
      {{"identify", nothing}, "expected at least one [[unknown]]"},
      {{"identifiability", nothing}, "expected at least one [[unknown]]"},
      {{"identify", good, "--start", "gvien"}, "did you mean \"given\"?"},
      {{"identify", good, "--set", "body.wheel.mas=2"}, "did you mean"},
      {{"identify", good, "--json", good}, "is the experiment too"},
      {{"identify", good, "--csv", scene}, "is a file that is read too"},
      {{"identify", measured, "--csv", folder.path("d.csv").string()}, "is a file that is read too"},
      {{"identify", good, "--data", folder.path("d.csv").string()}, "--data"},
      {{"montecarlo", measured}, "expected simulated runs only"},
      {{"montecarlo", good, "--trials", "0"}, "--trials: expected"},
      {{"montecarlo", good, "--trials", "1e9"}, "--trials: expected a number from 1 to 1000000, found 1000000000"},
      {{"montecarlo", good, "--seed", "-1"}, "--seed: expected a whole number from 0 to 18446744073709551615"},
      {{"montecarlo", good, "--start-error", "x"}, "--start-error: expected a number, found \"x\""},
      {{"identify", good, "--data", ""}, "--data: expected a word that is not empty; leave the option out"},
      {{"montecarlo", good, "--start-error", "1"}, "--start-error: expected"},
      {{"montecarlo", good, "--jobs", "-1"}, "--jobs: expected"}};
  const std::vector<std::string> before = folder.names();
  for (const auto& [words, says] : cases) {
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << says;
    EXPECT_EQ(run.out, "") << says;
    EXPECT_TRUE(has(run.err, says)) << says << "\n" << run.err;
    EXPECT_EQ(lines(run.err), 1U) << run.err;
  }
  EXPECT_EQ(folder.names(), before);
}

}  // namespace
}  // namespace poise::app_tests::identifiability_commands_test
