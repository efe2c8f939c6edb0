#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <numeric>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "app/draw/chart/gnuplot.hpp"
#include "identification/experiment/record.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/scenes.hpp"

namespace poise::app_tests::motion_command_test {
namespace {

using nlohmann::json;

/// A block of 2 kg on a rail in millimetres, with a spring of 0.2 N/mm and a damper of 0.004 N s/mm, in equilibrium
/// at 100 mm: w0 = 10 /s, decay 1 /s.
constexpr const char* oscillator = R"(title = "Oscillator"
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[spring]]
name = "S"
points = ["ground.O", "block.C"]
stiffness = 0.2
free_length = 100
[[damper]]
name = "D"
points = ["ground.O", "block.C"]
coefficient = 0.004
[start]
rail = 95
)";

/// A flywheel of 3 kg m2 without any load.
constexpr const char* flywheel = R"([units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0] }
mass = 1
inertia = 3
[[pin]]
points = ["ground.O", "wheel.O"]
)";

constexpr const char* motor = R"(
[[drive]]
name = "motor"
bodies = ["ground", "wheel"]
start = 10
rate = 20
acceleration = 60
)";

std::vector<std::string> words(const std::string& scene, const std::vector<std::string>& further) {
  std::vector<std::string> all = {"motion", scene};
  all.insert(all.end(), further.begin(), further.end());
  return all;
}

TEST(MotionCommand, DampedOscillatorFollowsItsClosedForm) {
  const TempFolder folder;
  const std::string csv = folder.path("a.csv").string();
  const ProgramRun run = run_poise(words(folder.write("a.toml", oscillator),
                                         {"--duration", "2", "--rate", "500", "--release", "rail=7", "--csv", csv}));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const CsvTable table = read_csv(
      csv, {"time", "rail", "rail.rate", "energy.kinetic", "block.C.x", "block.C.y", "rail.acceleration",
            "block.C.x.rate", "block.C.x.acceleration", "block.center.x.acceleration", "block.C.y.acceleration"});
  ASSERT_EQ(table.values[0].size(), 1001U);
  const double decay = 1.0;
  const double w = std::sqrt(100.0 - decay * decay);
  for (std::size_t i = 0; i < table.values[0].size(); ++i) {
    const double t = table.values[0][i];
    EXPECT_DOUBLE_EQ(t, static_cast<double>(i) / 500);
    const double displacement = 7 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    const double rate = -7 * std::exp(-decay * t) * (w + decay * decay / w) * std::sin(w * t);
    ASSERT_NEAR(table.values[1][i], 100 + displacement, 1e-8) << "mm, from equilibrium at 100 mm";
    ASSERT_NEAR(table.values[2][i], rate, 1e-7) << "mm/s";
    ASSERT_NEAR(table.values[3][i], 0.5 * 2 * rate * rate * 1e-6 * 1e3, 1e-9) << "N mm";
    ASSERT_NEAR(table.values[4][i], table.values[1][i], 1e-12) << "the point is where the rail takes it, in mm";
    ASSERT_EQ(table.values[5][i], 0.0);
    const double acceleration = -w * w * displacement - 2 * decay * rate - decay * decay * displacement;
    ASSERT_NEAR(table.values[6][i], acceleration, 1e-6) << "mm/s^2: of x'' + 2 x' + 100 x = 0";
    ASSERT_EQ(table.values[7][i], table.values[2][i]);
    ASSERT_EQ(table.values[8][i], table.values[6][i]);
    ASSERT_EQ(table.values[9][i], table.values[6][i]) << "the centre of mass is at C";
    ASSERT_EQ(table.values[10][i], 0.0);
  }
  EXPECT_NE(run.out.find("equilibrium (stable), rail displaced by 7 mm and released"), std::string::npos) << run.out;
}

// With x from the equilibrium the spring pulls with 0.2 N/mm x and the damper with 0.004 N s/mm x'.
TEST(MotionCommand, ShowsWhatIsAskedForAlone) {
  const TempFolder folder;
  const std::string csv = folder.path("a.csv").string(), file = folder.path("a.json").string();
  const std::vector<std::string> names = {"travel.rail", "d(travel.rail)/dt", "force.S", "force.D", "reaction.rail.y"};
  std::string show = "max(force.S)";
  for (const std::string& name : names) show += "," + name;
  const ProgramRun run =
      run_poise(words(folder.write("a.toml", oscillator), {"--duration", "2", "--rate", "500", "--release", "rail=7",
                                                           "--csv", csv, "--json", file, "--show", show}));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ(contents(csv).substr(0, contents(csv).find('\n')),
            "time,travel.rail,d(travel.rail)/dt,force.S,force.D,reaction.rail.y");
  const CsvTable table = read_csv(csv, {"time", names[0], names[1], names[2], names[3], names[4]});
  ASSERT_EQ(table.values[0].size(), 1001U);
  const double decay = 1.0, w = std::sqrt(100.0 - decay * decay);
  for (std::size_t i = 0; i < table.values[0].size(); ++i) {
    const double t = table.values[0][i];
    const double x = 7 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    const double rate = -7 * std::exp(-decay * t) * (w + decay * decay / w) * std::sin(w * t);
    ASSERT_NEAR(table.values[1][i], 100 + x, 1e-8);
    ASSERT_NEAR(table.values[2][i], rate, 1e-7);
    ASSERT_NEAR(table.values[3][i], 0.2 * x, 1e-8);
    ASSERT_NEAR(table.values[4][i], 0.004 * rate, 1e-8);
    ASSERT_NEAR(table.values[5][i], 0.0, 1e-12) << "there is no gravity";
  }
  const json found = json::parse(contents(file));
  ASSERT_EQ(found["quantities"].size(), 6U);
  EXPECT_EQ(found["quantities"][0]["name"], "max(force.S)");
  EXPECT_NEAR(found["quantities"][0]["value"].get<double>(), 1.4, 1e-9) << "at the start";
  // It first turns round after half a period, pi / w.
  const json& travel = found["quantities"][1];
  EXPECT_EQ(travel["unit"], "mm");
  EXPECT_NEAR(travel["least_at"].get<double>(), M_PI / w, 1e-4) << "between the samples";
  EXPECT_NEAR(travel["least"].get<double>(), 100 - 7 * std::exp(-decay * M_PI / w), 1e-8);
  EXPECT_EQ(travel["values"].size(), 1001U);
  EXPECT_EQ(run.out.find("Slides"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("Quantities over time"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("max(force.S)"), std::string::npos) << run.out;
}

// Beside everything else, also in the record.
TEST(MotionCommand, ShowsTheOutputsOfItsScene) {
  const TempFolder folder;
  const std::string csv = folder.path("a.csv").string();
  const std::string scene =
      folder.write("a.toml", std::string(oscillator) + "[outputs]\npull = \"2 * force.S\"\npeak = \"max(pull)\"\n" +
                                 "speed = \"d(travel.rail)/dt\"\npushed = \"push.block.C.x\"\n");
  const ProgramRun run = run_poise(words(scene, {"--duration", "1", "--release", "rail=7", "--csv", csv}));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const CsvTable table = read_csv(csv, {"rail", "rail.rate", "pull", "speed"});
  for (std::size_t i = 0; i < table.values[0].size(); ++i) {
    ASSERT_NEAR(table.values[2][i], 0.4 * (table.values[0][i] - 100), 1e-8);
    ASSERT_NEAR(table.values[3][i], table.values[1][i], 1e-9);
  }
  EXPECT_NE(run.out.find("Slides"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("peak"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("pushed: a push takes the place of the drive"), std::string::npos) << run.out;
  // At rest the rate is undefined, and nothing else.
  const ProgramRun still = run_poise({"solve", scene});
  EXPECT_EQ(still.exit_code, 0) << still.out << still.err;
}

// Two drives of one arm that part: what is left of the motion is not confirmed, and says so wherever it is read.
TEST(MotionCommand, MarksEachRowOfARecordThatIsNotConfirmed) {
  const TempFolder folder;
  const std::string csv = folder.path("a.csv").string();
  const std::string drive = "[[drive]]\nbodies = [\"ground\", \"arm\"]\nrate = 1\n";
  const std::string scene =
      "[ground]\npoints = { O = [0, 0] }\n[body.arm]\npoints = { O = [0, 0] }\ninertia = 1\n"
      "[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n" +
      drive;
  const auto lines = [&](const std::string& text) {
    const ProgramRun run = run_poise(words(folder.write("a.toml", text), {"--duration", "1", "--csv", csv}));
    std::vector<std::string> out{std::to_string(run.exit_code)};
    std::istringstream in(contents(csv));
    for (std::string line; std::getline(in, line);) out.push_back(line);
    return out;
  };
  const std::vector<std::string> whole = lines(scene), torn = lines(scene + drive + "acceleration = 0.5\n");
  EXPECT_EQ(whole[0], "0");
  EXPECT_EQ(whole[1].find("confirmed"), std::string::npos);
  EXPECT_EQ(torn[0], "1");
  EXPECT_EQ(torn[1].rfind("time,confirmed,", 0), 0U) << torn[1];
  for (std::size_t i = 2; i < torn.size(); ++i) EXPECT_NE(torn[i].find(",no,"), std::string::npos) << torn[i];
}

TEST(MotionCommand, ReportsThatItIsAlreadyAtEquilibrium) {
  const TempFolder folder;
  const ProgramRun run = run_poise(words(folder.write("a.toml", oscillator), {"--duration", "0.1"}));
  EXPECT_NE(run.out.find("already at equilibrium, use --release to displace it"), std::string::npos) << run.out;
}

// Shaken from its equilibrium: beats, whose largest places follow the closed form of the scene.
TEST(MotionCommand, LoadsOfTimeShakeAMachine) {
  const TempFolder folder;
  const std::string csv = folder.path("record.csv").string();
  const ProgramRun outcome = run_poise({"motion", dataset("forced_machine"), "--duration", "4", "--csv", csv});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  EXPECT_EQ(outcome.out.find("already at equilibrium"), std::string::npos);
  const CsvTable record = read_csv(csv, {"time", "guide"});
  const double w = std::sqrt(1000.0), W = 2 * M_PI * 4.8, r = W / w;
  ASSERT_EQ(record.line.size(), 4001U);
  for (std::size_t i = 0; i < record.line.size(); ++i) {
    const double t = record.column("time")[i];
    const double exact = -0.00981 + 32.0 / 20000 / (1 - r * r) * (std::sin(W * t) - r * std::sin(w * t));
    EXPECT_NEAR(record.column("guide")[i], exact, 1e-9) << t;
  }
}

TEST(MotionCommand, StaticsHasTheLoadsOfOneTime) {
  const ProgramRun later = run_poise({"solve", dataset("forced_machine"), "--time", "0.0520833333333333"});
  EXPECT_EQ(later.exit_code, 0) << later.err;
  EXPECT_NE(later.out.find("F: a sine, at t = 0.0520833333333333 s 1 times what the scene gives"), std::string::npos)
      << later.out;
  EXPECT_NE(later.out.find("-0.00821"), std::string::npos) << later.out;
  const ProgramRun none = run_poise({"solve", dataset("zeeman"), "--time", "1"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("--time: no load or spring of the scene follows a function of time"), std::string::npos)
      << none.err;
}

TEST(MotionCommand, StartsWhereAssembledOnRequest) {
  const TempFolder folder;
  const std::string file = folder.path("a.json").string();
  const ProgramRun run =
      run_poise(words(folder.write("a.toml", oscillator), {"--duration", "0.1", "--from", "start", "--json", file}));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NEAR(json::parse(contents(file))["slides"]["rail"]["start"], 95.0, 1e-10);
}

TEST(MotionCommand, FlywheelKeepsItsRate) {
  const TempFolder folder;
  const std::string file = folder.path("a.json").string();
  const ProgramRun run = run_poise(
      words(folder.write("a.toml", flywheel), {"--duration", "3", "--release-rate", "wheel=30", "--json", file}));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const json r = json::parse(contents(file));
  EXPECT_NEAR(r["angles"]["wheel"]["end"], 90.0, 1e-9) << "degrees";
  EXPECT_NEAR(r["angles"]["wheel"]["rate_end"], 30.0, 1e-9);
  EXPECT_NEAR(r["energies"]["end"]["kinetic"], 0.5 * 3 * std::pow(M_PI / 6, 2), 1e-12);
  EXPECT_EQ(r["confirmed"], true);
  EXPECT_LT(r["error"], 1e-10);
}

TEST(MotionCommand, DriveDoesTheWorkThatTheWheelGains) {
  const TempFolder folder;
  const std::string file = folder.path("a.json").string();
  const std::string scene = folder.write("a.toml", std::string(flywheel) + motor);
  const ProgramRun run = run_poise(words(scene, {"--duration", "2", "--json", file}));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const json r = json::parse(contents(file));
  EXPECT_EQ(r["degrees_of_freedom"], 0);
  EXPECT_NEAR(r["angles"]["wheel"]["start"], 10.0, 1e-10);
  EXPECT_NEAR(r["angles"]["wheel"]["end"], 10 + 40 + 120, 1e-9);
  const double degree = M_PI / 180;
  EXPECT_NEAR(r["drives"][0]["largest"], 3 * 60 * degree, 1e-9) << "inertia times acceleration";
  EXPECT_NEAR(r["energies"]["end"]["work"], 0.5 * 3 * (140.0 * 140 - 20 * 20) * degree * degree, 1e-9);
}

// A motor speeds 3 kg m2 up by 60 deg/s^2 from 20 deg/s: torque, power and work are known at every instant.
TEST(MotionCommand, ForcesAtEveryInstant) {
  const TempFolder folder;
  const std::string file = folder.path("a.json").string(), csv = folder.path("a.csv").string();
  const std::string scene = folder.write("a.toml", std::string(flywheel) + motor);
  const ProgramRun run =
      run_poise(words(scene, {"--duration", "2", "--rate", "10", "--forces", "--json", file, "--csv", csv}));
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const double degree = M_PI / 180, torque = 3 * 60 * degree;
  const CsvTable table = read_csv(csv, {"time", "effort.motor", "power.motor", "work.motor", "inertia.wheel.moment",
                                        "wheel.acceleration", "imbalance"});
  ASSERT_EQ(table.values[0].size(), 21U);
  for (std::size_t i = 0; i < table.values[0].size(); ++i) {
    const double t = table.values[0][i];
    EXPECT_NEAR(table.values[1][i], torque, 1e-9);
    EXPECT_NEAR(table.values[2][i], torque * (20 + 60 * t) * degree, 1e-9);
    EXPECT_NEAR(table.values[3][i], torque * (20 * t + 30 * t * t) * degree, 1e-9);
    EXPECT_NEAR(table.values[4][i], -torque, 1e-9);
    EXPECT_NEAR(table.values[5][i], 60, 1e-9) << "deg/s^2";
  }
  const json r = json::parse(contents(file));
  EXPECT_TRUE(r["forces"]["balanced"]);
  EXPECT_NEAR(r["forces"]["drives"][0]["work"], torque * 160 * degree, 1e-9);
  EXPECT_NEAR(r["forces"]["drives"][0]["power_at"], 2.0, 1e-12);
  EXPECT_EQ(r["samples"]["work.motor"].size(), 21U);
  EXPECT_TRUE(r["forces"]["motors"].is_null());
}

TEST(MotionCommand, MotorsThatCannotMakeAMotionEndWithExitOne) {
  const TempFolder folder;
  const std::string robot = dataset("three_motor_robot"), file = folder.path("a.json").string();
  const ProgramRun all = run_poise(
      words(robot, {"--duration", "0.5", "--rate", "50", "--motors", "shoulder,elbow,wrist", "--json", file}));
  ASSERT_EQ(all.exit_code, 0) << all.out << all.err;
  json found = json::parse(contents(file))["forces"]["motors"];
  EXPECT_TRUE(found["made"]);
  EXPECT_EQ(found["freedoms"], 3);
  EXPECT_LT(found["followed"], 1e-8);
  const ProgramRun few =
      run_poise(words(robot, {"--duration", "0.5", "--rate", "50", "--motors", "shoulder,elbow", "--json", file}));
  EXPECT_EQ(few.exit_code, 1);
  EXPECT_NE(few.out.find("shoulder and elbow cannot make this motion: at t = "), std::string::npos) << few.out;
  EXPECT_NE(few.out.find("Generalized forces that stay unbalanced"), std::string::npos) << few.out;
  found = json::parse(contents(file))["forces"]["motors"];
  EXPECT_FALSE(found["made"]);
  EXPECT_EQ(found["unbalanced"].size(), 3U);
}

TEST(MotionCommand, ADriveThatMeetsADeadCentreNamesIt) {
  const TempFolder folder;
  const std::string text = R"([ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [0.1, 0] }
mass = 2
inertia = 0.05
[body.rod]
points = { A = [0, 0], B = [0.3, 0] }
[body.block]
points = { B = [0, 0] }
mass = 0.5
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "rod.A"]
[[pin]]
name = "B"
points = ["rod.B", "block.B"]
[[slide]]
name = "ram"
points = ["ground.O", "block.B"]
axis = [1, 0]
[[drive]]
name = "winch"
slide = "ram"
start = 0.35
rate = 0.05
[start]
crank = 0.9
rod = -0.26
ram = 0.35
)";
  const std::string file = folder.path("a.json").string();
  const ProgramRun run = run_poise(words(folder.write("a.toml", text), {"--duration", "5", "--json", file}));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("it meets a dead centre of the loop closed by"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("crank and rod are in line"), std::string::npos) << run.out;
  const json place = json::parse(contents(file))["dead_centre"];
  EXPECT_NEAR(place["time"], 1.0, 1e-8) << "from 0.35 m to 0.4 m";
  EXPECT_EQ(place["position"], "crank = 0 rad, rod = 0 rad, ram = 0.4 m");
}

TEST(MotionCommand, NoiseHasTheSizeAskedForAndFollowsTheSeed) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", oscillator);
  const auto record = [&](const std::string& name, const std::vector<std::string>& further) {
    std::vector<std::string> all = words(scene, {"--duration", "4", "--release", "rail=7", "--csv", folder.path(name)});
    all.insert(all.end(), further.begin(), further.end());
    EXPECT_EQ(run_poise(all).exit_code, 0);
    return contents(folder.path(name));
  };
  const std::string exact = record("exact.csv", {});
  const std::string noisy = record("noisy.csv", {"--noise", "0.03", "--seed", "5"});
  EXPECT_EQ(record("again.csv", {"--noise", "0.03", "--seed", "5"}), noisy);
  EXPECT_NE(record("other.csv", {"--noise", "0.03", "--seed", "6"}), noisy);
  const CsvTable a = read_csv(folder.path("exact.csv"), {"rail", "rail.rate"});
  const CsvTable b = read_csv(folder.path("noisy.csv"), {"rail", "rail.rate"});
  double sum = 0.0;
  double squares = 0.0;
  const auto n = static_cast<double>(a.values[0].size());
  for (std::size_t i = 0; i < a.values[0].size(); ++i) {
    const double e = b.values[0][i] - a.values[0][i];
    sum += e;
    squares += e * e;
    EXPECT_EQ(b.values[1][i], a.values[1][i]) << "rates are not measured";
  }
  EXPECT_NEAR(std::sqrt(squares / n), 0.03, 4 * 0.03 / std::sqrt(2 * n)) << "mm";
  EXPECT_NEAR(sum / n, 0.0, 4 * 0.03 / std::sqrt(n));
}

TEST(MotionCommand, ReportsWhatItCannotMove) {
  const TempFolder folder;
  const std::string massless = folder.write("a.toml", std::string(workshop_pendulum));
  const ProgramRun run = run_poise(words(massless, {"--duration", "1", "--release", "a<b=5"}));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("no inertia"), std::string::npos) << run.out;
  const ProgramRun nowhere = run_poise(words(folder.write("b.toml", runaway), {"--duration", "1"}));
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_NE(nowhere.out.find("No equilibrium found to start from: "), std::string::npos) << nowhere.out;
}

TEST(MotionCommand, NothingIsReleasedThatADriveCarries) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", std::string(flywheel) + motor);
  for (const char* option : {"--release", "--release-rate"}) {
    const ProgramRun run = run_poise(words(scene, {"--duration", "2", option, "wheel=1"}));
    EXPECT_EQ(run.exit_code, 2) << option;
    EXPECT_NE(run.err.find("no degree of freedom is left to release"), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

TEST(MotionCommand, BadWordsAreNamed) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", oscillator);
  const std::string csv = folder.path("a.csv").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{}, "--duration"},
      {{"--duration", "0"}, "--duration: expected seconds > 0"},
      {{"--duration", "nan"}, "--duration: expected seconds > 0"},
      {{"--duration", "1", "--rate", "-5"}, "--rate: expected samples"},
      {{"--duration", "1e6", "--rate", "1e6"}, "--rate: "},
      {{"--duration", "1", "--accuracy", "0"}, "--accuracy: expected"},
      {{"--duration", "1", "--noise", "0.1"}, "--noise: there is no record"},
      {{"--duration", "1", "--noise", "-1", "--csv", csv}, "--noise: expected"},
      {{"--duration", "1", "--from", "equilibrum"}, "did you mean \"equilibrium\"?"},
      {{"--duration", "1", "--release", "rial=1"}, "did you mean \"rail\"?"},
      {{"--duration", "1", "--release", "rail"}, "there is no \"=\""},
      {{"--duration", "1", "--release-rate", "rail=fast"}, "is not a number"},
      {{"--duration", "1", "--release", "rail=inf"}, "expected a finite number"},
      {{"--duration", "1", "--show", "force.SS"}, "--show force.SS: "},
      {{"--duration", "1", "--show", "push.block.C.x"}, "--show push.block.C.x: a push takes the place of the drive"},
      {{"--duration", "1", "--show", "mode.1.frequency"}, "belongs to an equilibrium, not to a motion"},
      {{"--duration", "1", "--show", "d(travel.rail)/d"}, "--show d(travel.rail)/d: "},
      {{"--duration", "1", "--show", "travel.rail", "--noise", "0.1", "--csv", csv}, "expected no --show with it"},
      {{"--duration", "1", "--show", "travel.rail", "--forces"}, "--show: with --forces all forces"},
      {{"--duration", "1", "--motors", "rail"}, "--motors: the scene prescribes no motion"},
      {{"--duration", "1000", "--rate", "10000", "--forces"}, "forces; expected 4e+06 at most"},
      {{"--duration", "1", "--csv", scene}, "is the scene too"},
      {{"--duration", "1", "--csv", csv, "--json", csv}, "--csv"}};
  const std::vector<std::string> before = folder.names();
  for (const auto& [further, says] : cases) {
    const ProgramRun run = run_poise(words(scene, further));
    EXPECT_EQ(run.exit_code, 2) << says;
    EXPECT_EQ(run.out, "") << says;
    EXPECT_NE(run.err.find(says), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
  EXPECT_EQ(folder.names(), before);
}

TEST(MotionCommand, DrawsWhatMoves) {
  if (!app::has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const TempFolder folder;
  const std::string svg = folder.path("a.svg").string();
  ASSERT_EQ(run_poise(words(dataset("lift"), {"--duration", "1", "--release", "obd=0.005", "--svg", svg})).exit_code,
            0);
  const std::string text = contents(svg);
  EXPECT_EQ(objection_to_xml(text), "");
  EXPECT_LT(text.size(), 300000U);
  for (const char* part : {"Lifting linkage", "from where they start", "angle (rad)", "travel (m)", "energy (J)", "obd",
                           "stroke", "cylinder, rod", "kinetic", "time (s)", "at the end", "Simulated 1 s"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
}

TEST(MotionCommand, MissingGnuplotIsFoundBeforeAnyWork) {
  const TempFolder folder;
  const ProgramRun run = run_poise(words(folder.path("no_such_scene.toml"), {"--duration", "1", "--svg", "a.svg"}),
                                   {"PATH=" + folder.path("").string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("gnuplot was not found"), std::string::npos) << run.err;
}

TEST(MotionCommand, InterruptKeepsWhatWasReached) {
  const TempFolder folder;
  const std::string scene = folder.write("a.toml", std::string(oscillator));
  const std::string csv = folder.path("a.csv").string();
  const pid_t child = ::fork();
  if (child == 0) {
    const int out = ::open(folder.path("out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(out, STDOUT_FILENO);
    ::execl(POISE_EXECUTABLE, POISE_EXECUTABLE, "motion", scene.c_str(), "--duration", "100000", "--rate", "10",
            "--release", "rail=7", "--set", "damper.D.coefficient=0", "--csv", csv.c_str(), nullptr);
    ::_exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const std::string out = contents(folder.path("out"));
  EXPECT_NE(out.find("of 100000 s only: interrupted"), std::string::npos) << out;
  const CsvTable table = read_csv(csv, {"time", "rail"});
  ASSERT_GT(table.values[0].size(), 10U);
  EXPECT_LT(table.values[0].back(), 99999.0);
  EXPECT_NEAR(table.values[1][5], 100 + 7 * std::cos(10 * table.values[0][5]), 1e-8);
}

// A rod of 1 kg whose centre is 0.2 m from a pin that was written twice, a rounding of its place apart.
TEST(MotionCommand, APinWrittenTwiceMovesAsOne) {
  const TempFolder folder;
  const std::string scene = dataset("hard/middle_pin_twice"), file = folder.path("found.json").string();
  const ProgramRun moved = run_poise({"motion", scene, "--release", "rod=1", "--duration", "1"});
  EXPECT_EQ(moved.exit_code, 0) << moved.err;
  EXPECT_NE(moved.out.find("1 degree of freedom, of 1"), std::string::npos) << moved.out;
  EXPECT_EQ(run_poise({"kinematics", scene, "--drive", "rod=0..1"}).exit_code, 0);
  const ProgramRun held = run_poise({"path", scene, "--vary", "angle.rod=1..2", "--json", file});
  EXPECT_EQ(held.exit_code, 0) << held.out;
  const json points = json::parse(contents(file))["points"];
  EXPECT_GT(points.size(), 2U);
  for (const json& point : points) {
    EXPECT_NEAR(point["effort"], 10 * 0.2 * std::cos(point["parameter"].get<double>()), 1e-12);
    EXPECT_EQ(point["proof"], "proved");
  }
}

}  // namespace
}  // namespace poise::app_tests::motion_command_test
