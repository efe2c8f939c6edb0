// Scenes with blades on the command line: what is said of them, and which commands refuse them.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::blades_command_test {
namespace {

using nlohmann::json;

// The position that solve finds is the one without the force of the blade.
TEST(BladesCommand, SayThatPositionsComeInSets) {
  const ProgramRun run = run_poise({"solve", dataset("machines/castor")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out,
                  "Blade \"wheel\" can take a force across its edge at rest too, so that positions in balance "
                  "come in sets: this is the one without that force"))
      << run.out;
  EXPECT_TRUE(has(run.out, "blade \"wheel\": it keeps no position from being reached")) << run.out;
  const TempFolder folder;
  const json r = run_json(folder, {"check", dataset("machines/castor")}, 0);
  EXPECT_EQ(r["blades"][0]["at"], "castor.W");
  EXPECT_EQ(r["blades"][0]["on"], "ground");
}

TEST(BladesCommand, ShowTheirForces) {
  const TempFolder folder;
  // The sleigh begins with w = 2 and v = 0.5: its edge takes m (v w + a w'), w' = -m a v w/I.
  const double first = 1.0 * (0.5 * 2 - 0.3 * 0.3 * 0.5 * 2 / 0.19);
  const std::vector<std::string> move = {"motion",         dataset("machines/chaplygin_sleigh"),
                                         "--from",         "start",
                                         "--duration",     "0.5",
                                         "--release-rate", "sleigh.x=0.5",
                                         "--release-rate", "sleigh=2"};
  std::vector<std::string> show = move;
  show.insert(show.end(), {"--show", "force.edge", "--rate", "100"});
  const json shown = run_json(folder, show, 0);
  const json r = run_json(folder, move, 0);
  EXPECT_TRUE(r["confirmed"]);
  EXPECT_EQ(r["blades"][0]["name"], "edge");
  EXPECT_NEAR(r["energies"]["start"]["kinetic"].get<double>(), r["energies"]["end"]["kinetic"].get<double>(), 1e-12);
  EXPECT_GE(std::abs(r["blades"][0]["largest"].get<double>()), first - 1e-9);
  std::vector<std::string> forces = move;
  forces.insert(forces.end(), {"--forces", "--rate", "20"});
  const ProgramRun all = run_poise(forces);
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_TRUE(has(all.out, "edge")) << all.out;
}

TEST(BladesCommand, AreRefusedByNameWhereTheyAreNotTreated) {
  const std::string scene = dataset("machines/castor");
  const std::vector<std::vector<std::string>> commands = {{"equilibria", scene},
                                                          {"equations", scene},
                                                          {"path", scene, "--vary", "spring.side.stiffness=10..20"},
                                                          {"kinematics", scene, "--drive", "tow=0..1"},
                                                          {"sensitivity", scene, "--of", "x.castor.W"}};
  for (const std::vector<std::string>& command : commands) {
    const ProgramRun run = run_poise(command);
    EXPECT_EQ(run.exit_code, 2) << command[0] << run.out;
    EXPECT_TRUE(has(run.err, "blade \"wheel\": ")) << command[0] << ": " << run.err;
    EXPECT_TRUE(has(run.err, "do not treat blades")) << command[0] << ": " << run.err;
  }
}

TEST(BladesCommand, ModesSayThatTheEquilibriumIsOneOfASet) {
  const TempFolder folder;
  const std::string scene = dataset("machines/sled_across_slope");
  const json r = run_json(folder, {"modes", scene}, 0);
  EXPECT_EQ(r["blades"][0]["name"], "runner");
  EXPECT_NEAR(r["blades"][0]["force"].get<double>(), -8.0, 1e-12);
  EXPECT_EQ(r["poles"]["re"].size(), 5U);
  EXPECT_EQ(r["closed_loop"]["A"].size(), 5U);
  EXPECT_EQ(r["stability"], "stable");
  const ProgramRun sleigh = run_poise({"modes", dataset("machines/chaplygin_sleigh")});
  EXPECT_EQ(sleigh.exit_code, 0) << sleigh.err;
  EXPECT_TRUE(has(sleigh.out,
                  "The equilibrium neither decays nor grows: some pole beside those of its blades has no "
                  "real part."))
      << sleigh.out;
  EXPECT_TRUE(has(sleigh.out, "the blade holds other positions beside this one, too: a pole is 0")) << sleigh.out;
  const ProgramRun sought = run_poise({"modes", scene, "--seek", "any"});
  EXPECT_EQ(sought.exit_code, 2);
  EXPECT_TRUE(has(sought.err, "--seek: with a [[controller]] or a [[blade]]")) << sought.err;
}

}  // namespace
}  // namespace poise::app_tests::blades_command_test
