#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/support/parallel_links.hpp"

namespace poise::app_tests::modes_and_forces_test {
namespace {

using nlohmann::json;

// A motor turns a bar of 2 kg and 1.2 m about its end, in degrees and millimetres.
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
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  return json::parse(contents(file));
}

TEST(ModesCommand, ShowsFrequencyAndDampingOfTheLift) {
  const ProgramRun run = run_poise({"modes", dataset("lift")});
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
  EXPECT_NEAR(r["coordinates"][0]["value"], -90.0, 1e-9);
  ASSERT_EQ(r["modes"].size(), 1U);
  const json& mode = r["modes"][0];
  const double omega = std::sqrt(9.81 * 0.6 * 2 / 0.96);
  EXPECT_EQ(mode["kind"], "oscillates");
  EXPECT_NEAR(mode["frequency"], omega / (2 * M_PI), 1e-12);
  EXPECT_NEAR(mode["roots"]["im"][0], omega, 1e-12);
  EXPECT_NEAR(mode["shape"]["re"][0], 1 / std::sqrt(0.96), 1e-12);
}

constexpr const char* shaky_experiment = R"(
scene = "shaky.toml"
[[sensor]]
name = "angle"
angle = "l1"
noise = 1e-4
[[unknown]]
path = "body.bed.mass"
name = "m"
[[run]]
name = "first"
duration = 1
rate = 100
seed = 1
)";

TEST(ShakyMechanism, IsNamedByEveryCommandThatMeetsIt) {
  const TempFolder folder;
  const std::string scene = folder.write("shaky.toml", test::three_links(0.1));
  const std::string experiment = folder.write("experiment.toml", shaky_experiment);
  const std::string words =
      "joints repeat each other in this position and not beside it: 1 degree of freedom of infinitesimal motion, none "
      "of finite motion (to second order they would open along every motion)";
  struct Case {
    std::string command, file;
    int exit_code;
  };
  for (const Case& one : {Case{"check", scene, 0}, Case{"solve", scene, 0}, Case{"compare", scene, 0},
                          Case{"equilibria", scene, 0}, Case{"modes", scene, 1}, Case{"identify", experiment, 1}}) {
    const ProgramRun run = run_poise({one.command, one.file});
    EXPECT_EQ(run.exit_code, one.exit_code) << one.command << run.out << run.err;
    EXPECT_NE(run.out.find(words), std::string::npos) << one.command << run.out;
    const json r = json_of(folder, {one.command, one.file}, one.exit_code);
    if (one.command == "check") {
      EXPECT_EQ(r["finite_degrees_of_freedom"], 0);
      EXPECT_EQ(r["finite_known_by"], "curvature");
      continue;
    }
    const json& mobility = one.command == "identify"     ? r["mobility"][0]
                           : one.command == "compare"    ? r["methods"][1]["mobility"]
                           : one.command == "equilibria" ? r["equilibria"][0]["mobility"]
                                                         : r["mobility"];
    EXPECT_EQ(mobility["degrees_of_freedom"], 1) << one.command;
    EXPECT_EQ(mobility["finite_degrees_of_freedom"], 0) << one.command;
    EXPECT_EQ(mobility["known_by"], "curvature") << one.command;
  }
}

// With links of one length it is a parallelogram with a third crank, whose closures repeat each other everywhere.
TEST(ShakyMechanism, IsNoParallelogram) {
  const TempFolder folder;
  const std::string scene = folder.write("parallelogram.toml", test::three_links(0));
  for (const std::string command : {"solve", "modes"}) {
    const ProgramRun run = run_poise({command, scene});
    EXPECT_EQ(run.exit_code, 0) << command << run.out << run.err;
    EXPECT_EQ(run.out.find("infinitesimal"), std::string::npos) << command << run.out;
    const json r = json_of(folder, {command, scene}, 0);
    EXPECT_EQ(r["mobility"]["finite_degrees_of_freedom"], 1) << command;
    EXPECT_EQ(r["mobility"]["known_by"], "closing beside") << command;
  }
}

// An eccentric of 10 mm lifts its follower: N = m w^2 e cos + k e (1 - cos) + F0 + m g.
std::string eccentric(const std::string& guided) {
  return R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.cam]
points = { O = [0, 0] }
inertia = 0.01
[body.follower]
points = { T = [0, 0] }
mass = 0.5
[[pin]]
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.O", "follower.T"]
axis = [0, 1]
[[cam]]
name = "lobe"
bodies = ["ground", "cam"]
follower = { slide = "guide" }
base = 0.05
lift = 0.02
guided = )" +
         guided + R"(
law = [{ to = 3.14159265358979312, lift = 1, law = "harmonic" },
       { to = 6.28318530717958623, lift = 0, law = "harmonic" }]
[[spring]]
slide = "guide"
stiffness = 800
free_length = 0.025
[start]
cam = 0
guide = 0.05
)";
}

TEST(ForcesCommand, SaysWhereACamWouldHaveToPull) {
  const TempFolder folder;
  const std::string scene = folder.write("eccentric.toml", eccentric("false"));
  const std::vector<std::string> at_rate{"forces", scene, "--drive", "cam=0..6.2831853", "--rate", "100"};
  const ProgramRun run = run_poise(at_rate);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("cam \"lobe\" would have to pull, with 9.095 N at cam = 3.141592"), std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("lifts off at 2.47"), std::string::npos) << run.out;
  const json r = json_of(folder, at_rate, 1);
  const double off = std::acos(-(8 + 20 + 0.5 * 9.81) / (50.0 - 8));
  ASSERT_EQ(r["contacts"].size(), 1U);
  const json& contact = r["contacts"][0];
  EXPECT_EQ(contact["name"], "lobe");
  EXPECT_EQ(contact["pulls"], true);
  EXPECT_NEAR(contact["least_force"], 16 + 20 + 0.5 * 9.81 - 50, 1e-9);
  EXPECT_NEAR(contact["changes"][0]["at"], off, 1e-12);
  EXPECT_EQ(contact["changes"][0]["what"], "lifts off");
  EXPECT_EQ(contact["changes"][1]["what"], "presses again");
  EXPECT_EQ(run_poise({"forces", scene, "--drive", "cam=0..6.2831853", "--rate", "80"}).exit_code, 0);
}

TEST(ForcesCommand, SaysWhereAGuidedCamChangesSides) {
  const TempFolder folder;
  const json r = json_of(
      folder,
      {"forces", folder.write("eccentric.toml", eccentric("true")), "--drive", "cam=0..6.2831853", "--rate", "100"}, 0);
  EXPECT_EQ(r["contacts"][0]["pulls"], false);
  ASSERT_EQ(r["contacts"][0]["changes"].size(), 2U);
  EXPECT_EQ(r["contacts"][0]["changes"][0]["what"], "changes side");
}

TEST(ForcesCommand, FindsTheSpeedOfLiftOff) {
  const TempFolder folder;
  const std::string scene = folder.write("eccentric.toml", eccentric("false"));
  const json r =
      json_of(folder, {"forces", scene, "--drive", "cam=0..6.2831853", "--steps", "20", "--lift-off", "lobe"}, 0);
  EXPECT_NEAR(r["lift_off"][0]["rate"], 90.4488805901, 1e-9);
  EXPECT_NEAR(r["lift_off"][0]["at"], M_PI, 1e-7);
  const ProgramRun wrong = run_poise({"forces", scene, "--drive", "cam=0..6", "--lift-off", "lobes"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("did you mean \"lobe\"?"), std::string::npos) << wrong.err;
  EXPECT_EQ(run_poise({"forces", scene, "--lift-off", "lobe"}).exit_code, 2);
}

TEST(ModesCommand, ReportsWhetherItIsStable) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor);
  EXPECT_NE(run_poise({"modes", scene, "--seek", "stable"})
                .out.find("It oscillates about this equilibrium: stable, 1 mode.\n"),
            std::string::npos);
  const ProgramRun upright = run_poise({"modes", scene, "--set", "start.bar=90"});
  EXPECT_NE(upright.out.find("Unstable equilibrium: 1 mode diverges.\n"), std::string::npos) << upright.out;
}

TEST(ModesCommand, ReportsWhyModesAreUnknown) {
  const ProgramRun run = run_poise({"modes", dataset("thesis_chain")});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("no body that can move has inertia"), std::string::npos) << run.out;
}

TEST(ForcesCommand, ReportsWhatHoldsAPose) {
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

// In its dead centre the press takes the torque of its pins alone, datasets/friction/crank_press.toml.
TEST(ForcesCommand, FrictionOfAPressAndItsEfficiency) {
  const TempFolder folder;
  const json r = json_of(
      folder, {"forces", dataset("friction/crank_press"), "--drive", "crank=0..90", "--rate", "60", "--steps", "3"}, 0);
  const json& forces = r["forces"];
  EXPECT_NEAR(forces["effort.crank"][0], 5274.027561, 1e-5);
  EXPECT_NEAR(forces["effort_without_friction.crank"][0], 0.0, 1e-9);
  EXPECT_EQ(r["friction"][0]["at_rest"][0], "guide");
  EXPECT_EQ(r["friction"][1]["at_rest"].size(), 0U);
  EXPECT_TRUE(forces["efficiency"][0].is_null());
  EXPECT_LT(r["power_error"].get<double>(), 1e-9);
  for (std::size_t k = 1; k < 4; ++k) {
    const double rate = M_PI / 3, power = forces["power.crank"][k];
    double lost = 0.0;
    for (const char* const joint : {"O", "B", "C", "guide"})
      lost += forces["lost." + std::string(joint)][k].get<double>();
    EXPECT_NEAR(power, forces["effort_without_friction.crank"][k].get<double>() * rate + lost, 1e-9 * power);
    EXPECT_NEAR(forces["efficiency"][k], (power - lost) / power, 1e-12);
  }
}

TEST(ForcesCommand, ShowsPowerOnlyWhereSomethingMoves) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor);
  for (const char* drive : {"bar", "bar=0..90"}) {
    const ProgramRun still = run_poise({"forces", scene, "--drive", drive});
    EXPECT_EQ(still.out.find("power"), std::string::npos) << still.out;
  }
  const ProgramRun moving = run_poise({"forces", scene, "--drive", "bar=0..90", "--rate", "90"});
  EXPECT_NE(moving.out.find("power (N mm/s)"), std::string::npos) << moving.out;
}

// A bar on a shaft needs the torque m g d cos(angle): its integral swings by 2 m g d, d = 0.5 m.
TEST(ForcesCommand, SizesAFlywheel) {
  const TempFolder folder;
  const std::string scene = folder.write("bar.toml", R"(gravity = [0, -10]
[units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.bar]
points = { O = [0, 0] }
mass = 3
center = [0.5, 0]
inertia = 1
[[pin]]
points = ["ground.O", "bar.O"]
)");
  const std::string file = folder.path("a.json").string();
  const ProgramRun run =
      run_poise({"forces", scene, "--drive", "bar=0..360", "--rate", "90", "--flywheel", "0.1", "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const json found = json::parse(contents(file))["fluctuation"];
  EXPECT_NEAR(found["mean_torque"].get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(found["greatest_torque"].get<double>(), 15.0, 1e-12);
  EXPECT_NEAR(found["least_torque_at"].get<double>(), 180.0, 1e-6);
  EXPECT_NEAR(found["energy_swing"].get<double>(), 30.0, 1e-8);
  EXPECT_NEAR(found["slowest_at"].get<double>(), 90.0, 1e-4) << "above";
  EXPECT_NEAR(found["flywheel"].get<double>(), 30.0 / (0.1 * M_PI * M_PI / 4), 1e-7);
  EXPECT_NE(run.out.find("holds (largest - least speed) / mean at 0.1"), std::string::npos) << run.out;
  for (const auto& [words, says] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--drive", "bar=0..360", "--flywheel", "0.1"}, "--flywheel: its size depends on the speed"},
           {{"--drive", "bar=0..90", "--rate", "90", "--flywheel", "0.1"}, "expected a range of whole turns"},
           {{"--drive", "bar=0..360", "--rate", "90", "--flywheel", "2"}, "--flywheel: expected a coefficient"}}) {
    std::vector<std::string> all = {"forces", scene};
    all.insert(all.end(), words.begin(), words.end());
    const ProgramRun refused = run_poise(all);
    EXPECT_EQ(refused.exit_code, 2) << refused.out;
    EXPECT_NE(refused.err.find(says), std::string::npos) << refused.err;
  }
}

TEST(ForcesCommand, DrawsTheMechanismInASinglePose) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor), svg = folder.path("f.svg");
  const ProgramRun run =
      run_poise({"forces", scene, "--drive", "bar", "--svg", svg}, {"PATH=" + folder.path("").string()});
  ASSERT_EQ(run.exit_code, 0) << "no gnuplot is needed: " << run.err;
  const std::string text = contents(svg);
  EXPECT_EQ(objection_to_xml(text), "");
  EXPECT_NE(text.find("Every body is in balance."), std::string::npos);
  EXPECT_NE(text.find("bar = 10195 N mm"), std::string::npos) << "the torque of the drive";
}

// Driven at its block, with a torque of 2000 N mm on its crank: crank 100 mm, rod 300 mm.
constexpr const char* slider_crank = R"(
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], B = [100, 0] }
[body.rod]
points = { B = [0, 0], C = [300, 0] }
[body.block]
points = { C = [0, 0] }
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.B", "rod.B"]
[[pin]]
points = ["rod.C", "block.C"]
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[torque]]
name = "M"
on = "crank"
value = 2000
[start]
crank = 60
rail = 340
)";

TEST(ForcesCommand, ReportsWhereTheDeadPointIs) {
  const TempFolder folder;
  const std::string scene = folder.write("crank.toml", slider_crank);
  const std::string words = "Dead point: at rail = 400 mm no finite force of the drive holds the load.\n";
  for (const char* drive : {"rail=350..450", "rail=400"}) {
    const ProgramRun run = run_poise({"forces", scene, "--drive", drive, "--quiet"});
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_TRUE(run.out.ends_with(words)) << drive << run.out;
  }
  const ProgramRun passed = run_poise({"forces", scene, "--drive", "rail=350..450", "--quiet"});
  EXPECT_EQ(passed.out.find("Driven in part only: the mechanism cannot be driven beyond rail = 400 mm: dead centre "),
            0U)
      << passed.out;
  const json r = json_of(folder, {"forces", scene, "--drive", "rail=350..150"}, 1);
  ASSERT_EQ(r["dead_points"].size(), 1U);
  EXPECT_NEAR(r["dead_points"][0]["rail"], 200.0, 1e-9);
  EXPECT_TRUE(json_of(folder, {"forces", scene, "--drive", "crank=0..360"}, 0)["dead_points"].empty());
}

TEST(ForcesCommand, SpinningBarPullsAtItsPin) {
  const TempFolder folder;
  const json r = json_of(
      folder, {"forces", folder.write("motor.toml", motor), "--drive", "bar=0..360", "--steps", "4", "--rate", "540"},
      0);
  EXPECT_EQ(r["along"], "bar");
  ASSERT_EQ(r["forces"]["bar"].size(), 5U);
  EXPECT_NEAR(r["forces"]["bar"][3], 270.0, 1e-12);
  const double pull = 2 * 0.6 * std::pow(3 * M_PI, 2);
  EXPECT_NEAR(r["forces"]["reaction.O.x"][0], -pull, 1e-9);
  EXPECT_NEAR(r["forces"]["reaction.O.y"][1], 2 * 9.81 - pull, 1e-9);
  EXPECT_NEAR(r["forces"]["effort.bar"][2], -2 * 9.81 * 600, 1e-8);
  EXPECT_NEAR(r["forces"]["power.bar"][2], -2 * 9.81 * 600 * 3 * M_PI, 1e-6);
}

// The motion that poise motion writes needs no drive, whether its rates are read or not.
TEST(ForcesCommand, BalancesARecordedMotion) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor);
  const std::string record = folder.path("motion.csv").string();
  const ProgramRun moved =
      run_poise({"motion", scene, "--duration", "1", "--rate", "500", "--from", "start", "--csv", record});
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  const json r = json_of(folder, {"forces", scene, "--motion", record}, 0);
  EXPECT_EQ(r["balanced"], true);
  ASSERT_EQ(r["forces"]["time"].size(), 501U);
  EXPECT_NEAR(r["forces"]["reaction.O.x"][0], 0.75 * 2 * 9.81 * std::cos(M_PI / 6) * 0.5, 1e-6)
      << "let go level with 30 deg it starts with 3/4 g cos 30 across";
}

// Stops limit its bar to -45 .. 60 deg.
std::string motor_with_stop(const char* more = "") {
  std::string text = motor;
  text += R"(
[[stop]]
name = "floor"
bodies = ["ground", "bar"]
min = -45
max = 60
)";
  return text += more;
}

TEST(ForcesCommand, EndsTheRangeAtAStopAndReportsIt) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor_with_stop());
  const std::string csv = folder.path("f.csv"), svg = folder.path("f.svg");
  const json r =
      json_of(folder, {"forces", scene, "--drive", "bar=0..-90", "--steps", "9", "--csv", csv, "--svg", svg}, 0);
  EXPECT_EQ(r["complete"], false);
  EXPECT_EQ(r["balanced"], true);
  EXPECT_EQ(r["stop"], json({{"name", "floor"}, {"limit", "min"}, {"value", -45.0}}));
  EXPECT_EQ(r["idle_stops"], json({"floor"}));
  EXPECT_TRUE(r["undetermined"].empty());
  ASSERT_EQ(r["forces"]["bar"].size(), 6U) << "0, -10 .. -40 and the stop itself";
  EXPECT_NEAR(r["forces"]["bar"][5], -45.0, 1e-12);
  EXPECT_NEAR(r["forces"]["effort.bar"][5], 2 * 9.81 * 600 * std::cos(M_PI / 4), 1e-8);
  EXPECT_EQ(r["forces"]["stop.floor"][5], 0.0);
  const std::string table = contents(csv);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 7);
  EXPECT_EQ(objection_to_xml(contents(svg)), "");
  EXPECT_NE(contents(svg).find("up to the stop"), std::string::npos);
  const ProgramRun run = run_poise({"forces", scene, "--drive", "bar=0..-90"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.out.find("ends early: the stop \"floor\" is reached at bar = -45 deg (its min, -45 deg)"),
            std::string::npos)
      << run.out;
}

TEST(ForcesCommand, RejectsASinglePoseBeyondAStop) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor_with_stop());
  const ProgramRun put = run_poise({"forces", scene, "--drive", "bar=-60"});
  EXPECT_EQ(put.exit_code, 2);
  EXPECT_NE(put.err.find("the stop \"floor\" is reached at bar = -45 deg"), std::string::npos) << put.err;
  const std::string driven = folder.write("driven.toml", motor_with_stop(R"(
[[drive]]
name = "servo"
bodies = ["ground", "bar"]
start = 75
)"));
  const ProgramRun stands = run_poise({"forces", driven});
  EXPECT_EQ(stands.exit_code, 2);
  EXPECT_NE(stands.err.find("beyond the stop \"floor\" by 15 deg"), std::string::npos) << stands.err;
  const ProgramRun at_it = run_poise({"forces", scene, "--drive", "bar", "--set", "start.bar=60"});
  EXPECT_EQ(at_it.exit_code, 0);
  EXPECT_NE(at_it.out.find("\"floor\" is in contact without force"), std::string::npos) << at_it.out;
}

// The record is of the machine without its stop.
TEST(ForcesCommand, MarksThePosesOfARecordThatAreBeyondAStop) {
  const TempFolder folder;
  const std::string scene = folder.write("motor.toml", motor_with_stop());
  const std::string record = folder.path("motion.csv").string();
  const ProgramRun moved = run_poise({"motion", folder.write("free.toml", motor), "--duration", "1", "--rate", "100",
                                      "--from", "start", "--csv", record});
  ASSERT_EQ(moved.exit_code, 0) << moved.err;
  const json r = json_of(folder, {"forces", scene, "--motion", record, "--drive", "bar"}, 0);
  const json& overrun = r["forces"]["overrun.floor"];
  ASSERT_EQ(overrun.size(), 101U);
  EXPECT_EQ(overrun[0], 0.0);
  const double most = *std::max_element(overrun.begin(), overrun.end());
  EXPECT_GT(most, 90.0);
  const ProgramRun said = run_poise({"forces", scene, "--motion", record, "--drive", "bar"});
  EXPECT_NE(said.out.find("Stop \"floor\" is passed in "), std::string::npos) << said.out;
}

// The lift's shut cylinder is a spring, which the drive stretches unless it is left out.
TEST(ForcesCommand, WarnsWhereTheDriveWorksAgainstASpring) {
  const TempFolder folder;
  const std::string lift = dataset("lift");
  const json against = json_of(folder, {"forces", lift, "--drive", "stroke=0.5..0.79"}, 0);
  EXPECT_EQ(against["parallel"], json({{{"element", "spring.oil"}, {"drive", "stroke"}}}));
  const ProgramRun said = run_poise({"forces", lift, "--drive", "stroke=0.5..0.79"});
  EXPECT_NE(said.out.find("spring.oil acts in parallel with the drive \"stroke\""), std::string::npos) << said.out;
  EXPECT_NE(said.out.find("--set \"spring.oil.stiffness=0\" leaves it out"), std::string::npos) << said.out;
  const json still =
      json_of(folder, {"forces", lift, "--drive", "stroke=0.5..0.79", "--set", "spring.oil.stiffness=0"}, 0);
  EXPECT_TRUE(still["parallel"].empty()) << "nothing flows while it stands still";
  const json moving = json_of(
      folder, {"forces", lift, "--drive", "stroke=0.5..0.79", "--rate", "0.1", "--set", "spring.oil.stiffness=0"}, 0);
  EXPECT_EQ(moving["parallel"], json({{{"element", "damper.oil film"}, {"drive", "stroke"}}}));
  for (const json& force : moving["forces"]["effort.stroke"]) {
    EXPECT_GT(force, 14500.0);
    EXPECT_LT(force, 15000.0);
  }
}

TEST(ForcesCommand, CsvHoldsEveryPose) {
  const TempFolder folder;
  const std::string file = folder.path("f.csv").string();
  const ProgramRun run = run_poise({"forces", dataset("four_bar_gravity"), "--drive", "crank=0..6", "--csv", file});
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
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    return run.err;
  };
  EXPECT_NE(complaint({"--drive", "crnk"}).find("did you mean \"crank\"?"), std::string::npos);
  EXPECT_NE(complaint({"--rate", "3"}).find("--rate: nothing is driven"), std::string::npos);
  EXPECT_NE(complaint({"--drive", "crank=0..x"}).find("is no range of numbers"), std::string::npos);
  EXPECT_EQ(complaint({"--motion", "nowhere.csv"}),
            "nowhere.csv: cannot be read: No such file or directory; check the path\n");
  EXPECT_NE(complaint({"--drive", "crank=0..1", "--motion", "a.csv"}).find("--motion:"), std::string::npos);
}

}  // namespace
}  // namespace poise::app_tests::modes_and_forces_test
