// `poise identify` through its command line.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/draw/chart/gnuplot.hpp"
#include "identification/experiment/record.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::identify_command_test {
namespace {

using nlohmann::json;

std::filesystem::path measured_pendulum() {
  return std::filesystem::path(POISE_SOURCE_DIR) / ".." / "shared" / "data" / "multi_arm_pendulum" / "double.csv";
}

// First the verdict, then the estimates, residuals and at last the numerics; --quiet is the verdict alone.
TEST(IdentifyCommand, PutsTheEstimatesBeforeTheNumerics) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  const ProgramRun run = run_poise({"identify", file, "--verbose"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::size_t at = 0;
  for (const char* part : {"Converged: residuals agree with the stated noise.\n", "\nEstimates\n", "standard error",
                           "error / sigma", "\nResiduals\n", ", expected ", "\nNumerics\n",
                           "1 simulated run; 1200 "
                           "readings of 1 sensor; 2 parameters, 2 nuisances (start of each run)",
                           "Levenberg-Marquardt"}) {
    at = run.out.find(part, at);
    ASSERT_NE(at, std::string::npos) << part << "\n" << run.out;
  }
  EXPECT_EQ(run_poise({"identify", file, "--quiet"}).out, "Converged: residuals agree with the stated noise.\n");
}

// A pendulum with viscous damping alone, guessed ten times too small, and friction whose estimate is near or at its
// bound 0: the damping is determined to some ten per cent of itself all the same.
TEST(IdentifyCommand, FindsTheDampingBesideFrictionThatIsZero) {
  const TempFolder folder;
  const auto scene = [](const char* inertia, const char* damping) {
    return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.arm]
points = {{ O = [0, 0] }}
mass = 1
center = [0.3, 0]
inertia = {}
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
[[torsion_damper]]
name = "grease"
bodies = ["ground", "arm"]
coefficient = {}
[[friction]]
name = "bearing"
bodies = ["ground", "arm"]
torque = 0
width = 0.05
[start]
arm = -1.2
)",
                       inertia, damping);
  };
  const std::string truth = folder.write("truth.toml", scene("0.02", "0.01"));
  folder.write("guess.toml", scene("0.03", "0.001"));
  const std::string experiment = folder.write("experiment.toml", R"(
scene = "guess.toml"
[[sensor]]
name = "arm"
angle = "arm"
noise = 6e-4
[[unknown]]
path = "body.arm.inertia"
[[unknown]]
path = "torsion_damper.grease.coefficient"
[[unknown]]
path = "friction.bearing.torque"
[[run]]
data = "record.csv"
)");
  int at_bound = 0;
  for (const char* seed : {"1", "3", "5", "6"}) {
    ASSERT_EQ(run_poise({"motion", truth, "--release", "arm=-0.6", "--duration", "4", "--rate", "50", "--noise", "6e-4",
                         "--seed", seed, "--csv", folder.path("record.csv").string()})
                  .exit_code,
              0);
    const json r = run_json(folder, {"identify", experiment}, 0);
    const json& damping = r["estimates"][1];
    EXPECT_TRUE(damping["withheld"].is_null()) << seed << ": " << damping;
    const double error = damping["standard_error"].is_number() ? damping["standard_error"].get<double>() : NAN;
    EXPECT_LT(error, 0.0015) << seed;
    EXPECT_NEAR(damping["value"].get<double>(), 0.01, 4 * error) << seed;
    EXPECT_LE(damping["low"].get<double>(), 0.01) << seed;
    EXPECT_GE(damping["high"].get<double>(), 0.01) << seed;
    at_bound += r["estimates"][2]["at_bound"].get<bool>() ? 1 : 0;
  }
  EXPECT_GE(at_bound, 1);
}

// The wheel swings against a bar: its parameters are found across the impacts as they are without them.
TEST(IdentifyCommand, FitsAcrossImpacts) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  folder.write("wheel.toml", std::string(wheel) +
                                 "[[stop]]\nname = \"bar\"\nbodies = [\"ground\", \"wheel\"]\nmin = -10\n"
                                 "restitution = 0.7\n");
  const json r = run_json(folder, {"identify", file}, 0);
  EXPECT_EQ(r["verdict"], "Converged: residuals agree with the stated noise.");
  for (const json& estimate : r["estimates"]) {
    const double error = estimate["value"].get<double>() - estimate["truth"].get<double>();
    EXPECT_LT(std::abs(error), 4 * estimate["standard_error"].get<double>()) << estimate;
  }
}

// Where the bar is and what it gives back are unknown as well.
TEST(IdentifyCommand, FindsWhereAStopIsAndWhatItGivesBack) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) +
                                                  "[[unknown]]\npath = \"stop.bar.min\"\nstart = -9.5\n"
                                                  "[[unknown]]\npath = \"stop.bar.restitution\"\nstart = 0.6\n" +
                                                  one_run);
  const auto with_bar_at = [&](const char* limit) {
    folder.write("wheel.toml", std::string(wheel) +
                                   "[[stop]]\nname = \"bar\"\nbodies = [\"ground\", \"wheel\"]\nmin = " + limit +
                                   "\nrestitution = 0.7\n");
  };
  with_bar_at("-10");
  const json r = run_json(folder, {"identify", file}, 0);
  EXPECT_EQ(r["verdict"], "Converged: residuals agree with the stated noise.");
  ASSERT_EQ(r["estimates"].size(), 4U);
  for (const json& estimate : r["estimates"]) {
    ASSERT_TRUE(estimate["withheld"].is_null()) << estimate;
    const double error = estimate["value"].get<double>() - estimate["truth"].get<double>();
    EXPECT_LT(std::abs(error), 4 * estimate["standard_error"].get<double>()) << estimate;
  }
  EXPECT_LT(r["estimates"][3]["standard_error"].get<double>(), 0.01);
}

// Without forces masses act in impacts alone: one cart hits another, whose mass follows from their rates before and
// after; what a stop gives back that nothing reaches does not.
TEST(IdentifyCommand, FindsTheMassThatImpactsAloneTell) {
  const TempFolder folder;
  folder.write("carts.toml", R"(
[ground]
points = { O = [0, 0] }
[body.a]
points = { C = [0, 0] }
mass = 1
[body.b]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "A"
points = ["ground.O", "a.C"]
axis = [1, 0]
[[slide]]
name = "B"
points = ["ground.O", "b.C"]
axis = [1, 0]
[[stop]]
name = "buffer"
points = ["a.C", "b.C"]
min = 0.1
restitution = 0.5
[[stop]]
name = "far"
slide = "B"
max = 9
restitution = 0.5
[start]
A = 0
B = 0.5
)");
  const std::string file = folder.write("experiment.toml", R"(
scene = "carts.toml"
[[sensor]]
name = "A"
travel = "A"
noise = 1e-4
[[sensor]]
name = "B"
travel = "B"
noise = 1e-4
[[unknown]]
path = "body.b.mass"
start = 1.5
[[unknown]]
path = "stop.buffer.restitution"
start = 0.4
[[unknown]]
path = "stop.far.restitution"
start = 0.4
[[run]]
release = { A = 0, B = 0.5 }
release_rate = { A = 1 }
duration = 1
rate = 100
seed = 2
)");
  const json r = run_json(folder, {"identify", file}, 0);
  for (int i = 0; i < 2; ++i) {
    const json& estimate = r["estimates"][i];
    ASSERT_TRUE(estimate["withheld"].is_null()) << estimate;
    const double error = estimate["value"].get<double>() - estimate["truth"].get<double>();
    EXPECT_LT(std::abs(error), 4 * estimate["standard_error"].get<double>()) << estimate;
  }
  EXPECT_EQ(r["estimates"][2]["withheld"], "not identifiable from these data");
}

TEST(IdentifyCommand, FindsTheLift) {
  const TempFolder folder;
  const json r = run_json(folder, {"identify", dataset("lift_experiment")}, 0);
  EXPECT_EQ(r["status"], "converged");
  EXPECT_NEAR(r["residual_over_noise"], 1.0, 4 * r["residual_over_noise_sigma"].get<double>());
  EXPECT_EQ(r["verdict"], "Converged: residuals agree with the stated noise.");
  EXPECT_TRUE(r["warnings"].empty()) << r["warnings"];
  EXPECT_EQ(r["standard_errors"], "white");
  // Cramer-Rao bounds of the standard errors that lift/README.md states, per cent.
  const std::vector<std::pair<std::string, double>> bounds = {{"mP", 0.037}, {"J_O", 1.20}, {"k", 0.014}, {"c", 0.154}};
  ASSERT_EQ(r["estimates"].size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const json& e = r["estimates"][i];
    EXPECT_EQ(e["name"], bounds[i].first);
    const double truth = e["truth"];
    const double standard_error = e["standard_error"];
    EXPECT_NEAR(100 * standard_error / truth, bounds[i].second, 0.03 * bounds[i].second);
    EXPECT_NEAR(e["value"].get<double>(), truth, 4 * standard_error);
    EXPECT_TRUE(e["withheld"].is_null());
  }
  EXPECT_EQ(r["estimates"][0]["unit"], "kg");
  EXPECT_EQ(r["estimates"][1]["unit"], "kg m²");
  for (const json& run : r["residuals"]) EXPECT_EQ(run["white"], true) << run;
  EXPECT_NEAR(r["rms"][0], 1e-4, 2e-6);
  EXPECT_TRUE(r["rms_from_first_readings"].is_null());
  EXPECT_NEAR(r["identifiability"]["correlation"]["mP"]["J_O"], -0.8, 0.02);
}

TEST(IdentifyCommand, WithholdsAScaleThatIsNotIdentifiable) {
  const TempFolder folder;
  const std::string file = folder.path("a.json").string();
  const ProgramRun run = run_poise({"identify", dataset("lift_experiment_empty"), "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_TRUE(has(run.out, "overall scale")) << run.out;
  EXPECT_TRUE(has(run.out, "known payload")) << run.out;
  EXPECT_TRUE(has(run.out, "Withheld: 4 of 4")) << run.out;
  const std::string text = contents(file);
  const json r = json::parse(text);
  for (const json& e : r["estimates"]) {
    for (const char* key : {"value", "standard_error", "truth"}) EXPECT_TRUE(e[key].is_null()) << e;
    EXPECT_EQ(e["withheld"], "not identifiable from these data") << e;
  }
  EXPECT_TRUE(r["identifiability"]["not_identifiable"][0]["scale"].get<bool>());
  // No line of the table has a digit; the row of the first is "mP  withheld  kg ...".
  const std::size_t table = run.out.find("\nEstimates\n");
  const std::size_t end = run.out.find("\n\n", table);
  ASSERT_NE(table, std::string::npos);
  const std::string rows = run.out.substr(table, end - table);
  EXPECT_EQ(std::count_if(rows.begin(), rows.end(), [](char c) { return c >= '0' && c <= '9'; }), 0) << rows;
  // The masses as the scene has them appear nowhere.
  for (const char* number : {"64.68", "3.3757", "2000000", "2e6", "4000"}) {
    EXPECT_FALSE(has(run.out, number)) << number;
    EXPECT_FALSE(has(text, number)) << number;
  }
}

TEST(IdentifyCommand, ShowsTheUnitsOfTheScene) {
  const TempFolder folder;
  const json r = run_json(folder, {"identify", experiment(folder, std::string(wheel_unknowns) + one_run)}, 0);
  const json& k = r["estimates"][0];
  EXPECT_EQ(k["unit"], "N m/deg");
  EXPECT_EQ(r["estimates"][1]["unit"], "N m s/deg");
  EXPECT_NEAR(k["value"].get<double>(), 48 * M_PI / 180, 4 * k["standard_error"].get<double>());
  EXPECT_NEAR(r["sensors"][0]["noise"], 0.02, 1e-15);
  EXPECT_NEAR(r["rms"][0], 0.02, 4 * 0.02 / std::sqrt(2 * 1200.0)) << "degrees";
  const json& found = r["residuals"][0]["nuisances"];
  EXPECT_NEAR(found["start wheel"], 20.0, 0.02) << "degrees";
  EXPECT_NEAR(found["start rate wheel"], 0.0, 0.1) << "degrees per second";
}

TEST(IdentifyCommand, WritesResidualsThatAddUp) {
  const TempFolder folder;
  const std::string csv = folder.path("a.csv").string();
  ASSERT_EQ(run_poise({"identify", experiment(folder, std::string(wheel_unknowns) + one_run), "--csv", csv}).exit_code,
            0);
  const CsvTable table = read_csv(csv, {"time", "turn", "turn.prediction", "turn.residual"}, {"run"});
  ASSERT_EQ(table.values[0].size(), 1200U);
  EXPECT_EQ(table.words[0].value[7], "only");
  const double decay = 0.6 / (2 * 3);
  const double w = std::sqrt(16 - decay * decay);
  for (std::size_t i = 0; i < 1200; ++i) {
    const double t = table.values[0][i];
    EXPECT_NEAR(table.values[1][i] - table.values[2][i], table.values[3][i], 1e-12);
    const double truth = 20 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
    ASSERT_NEAR(table.values[2][i], truth, 0.02) << "the prediction is closer than the noise";
  }
}

TEST(IdentifyCommand, ReadsBackWhatMotionWrote) {
  const TempFolder folder;
  const std::string csv = folder.path("wheel.csv").string();
  const std::string file = experiment(folder, std::string(wheel_unknowns) + "[[run]]\ndata = \"wheel.csv\"\n");
  const ProgramRun moved = run_poise({"motion", folder.path("wheel.toml").string(), "--duration", "6", "--rate", "200",
                                      "--from", "start", "--release", "wheel=20", "--noise", "0.02", "--csv", csv});
  ASSERT_EQ(moved.exit_code, 0) << moved.out << moved.err;
  const std::string text = contents(csv);
  folder.write("wheel.csv", "time,turn" + text.substr(text.find(",wheel") + 6));
  const json r = run_json(folder, {"identify", file}, 0);
  EXPECT_EQ(r["experiment"]["simulated"], false);
  const json& k = r["estimates"][0];
  EXPECT_TRUE(k["truth"].is_null()) << "of a measured run it is not known";
  EXPECT_NEAR(k["value"].get<double>(), 48 * M_PI / 180, 4 * k["standard_error"].get<double>());
  ASSERT_EQ(r["rms_from_first_readings"].size(), 1U);
  EXPECT_GT(r["rms_from_first_readings"][0], r["rms"][0]) << "the fitted start is the better one";
  EXPECT_LT(r["rms_from_first_readings"][0], 5.0) << "degrees";
}

// Gravity, a length, inertia and damping from starts a fifth to a third off: with the third seed the starts lead to a
// minimum that is in phase with the records, with residuals of 9.4 times the noise.
TEST(IdentifyCommand, TriesOtherStartsBeforeItCallsAMisfit) {
  const TempFolder folder;
  const std::string scene = folder.write("scene.toml", R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], hook = [0.25, 0] }
mass = 0.5
center = [0.12, 0]
inertia = 0.003
[body.weight]
points = { hook = [0, 0] }
mass = 0.2
[[pin]]
points = ["ground.O", "lever.O"]
[[pin]]
points = ["lever.hook", "weight.hook"]
[[torsion_damper]]
name = "g"
bodies = ["ground", "lever"]
coefficient = 0.002
[start]
lever = -1.2
)");
  const std::string file = folder.write("experiment.toml", R"(scene = "scene.toml"
[[sensor]]
name = "a"
angle = "lever"
column = "lever"
noise = 0.002
[[unknown]]
path = "gravity.y"
[[unknown]]
path = "point.lever.hook.x"
[[unknown]]
path = "body.lever.inertia"
[[unknown]]
path = "torsion_damper.g.coefficient"
[[run]]
set = { "body.weight.mass" = 0 }
data = "empty.csv"
[[run]]
set = { "body.weight.mass" = 0.2 }
data = "loaded.csv"
)");
  for (const int seed : {1, 2, 3}) {
    const auto record = [&](const std::string& name, const std::string& mass, const std::string& release, int noise) {
      run_poise({"motion",     scene,
                 "--set",      "point.lever.hook.x=0.31",
                 "--set",      "body.lever.inertia=0.004",
                 "--set",      "torsion_damper.g.coefficient=0.003",
                 "--set",      "body.weight.mass=" + mass,
                 "--release",  "lever=" + release,
                 "--duration", "5",
                 "--rate",     "60",
                 "--noise",    "0.002",
                 "--seed",     std::to_string(noise),
                 "--csv",      folder.path(name).string()});
    };
    record("empty.csv", "0", "0.667", seed);
    record("loaded.csv", "0.2", "-0.527", 100 + seed);
    const json r = run_json(folder, {"identify", file}, 0);
    EXPECT_EQ(r["status"], "converged") << seed;
    const json& hook = r["estimates"][1];
    EXPECT_NEAR(hook["value"], 0.31, 4 * hook["standard_error"].get<double>()) << seed;
  }
}

TEST(IdentifyCommand, NamesTheFilesOfExperimentsFittedTogether) {
  const TempFolder folder;
  experiment(folder, std::string(wheel_unknowns) + one_run);
  folder.write("other.toml", std::string(wheel_unknowns) + one_run);
  const json r = run_json(
      folder, {"identify", folder.write("joint.toml", "experiments = [\"experiment.toml\", \"other.toml\"]\n")}, 0);
  EXPECT_EQ(r["experiment"]["scene"], "");
  ASSERT_EQ(r["experiment"]["parts"].size(), 2U);
  EXPECT_EQ(r["experiment"]["parts"][0]["file"], folder.path("experiment.toml").string());
  EXPECT_EQ(r["experiment"]["parts"][1]["file"], folder.path("other.toml").string());
  EXPECT_EQ(r["experiment"]["parts"][1]["scene"], folder.path("wheel.toml").string());
  EXPECT_EQ(run_json(folder, {"identify", folder.path("other.toml").string()}, 0)["experiment"]["parts"].size(), 0U);
}

// Of a measured run the number in the scene is no truth: 0 there does not make the estimate one of zero.
TEST(IdentifyCommand, GivesPerCentsOfEstimatesWhereTheSceneHasZero) {
  const TempFolder folder;
  const std::string undamped = std::string(wheel).replace(std::string(wheel).find("0.01047"), 20, "0");
  const std::string file =
      experiment(folder, std::string(wheel_unknowns) + "start = 0.01\n[[run]]\ndata = \"wheel.csv\"\n");
  const ProgramRun moved =
      run_poise({"motion", folder.path("wheel.toml").string(), "--duration", "6", "--rate", "200", "--from", "start",
                 "--release", "wheel=20", "--noise", "0.02", "--csv", folder.path("wheel.csv").string()});
  ASSERT_EQ(moved.exit_code, 0) << moved.out << moved.err;
  const std::string text = contents(folder.path("wheel.csv"));
  folder.write("wheel.csv", "time,turn" + text.substr(text.find(",wheel") + 6));
  folder.write("wheel.toml", undamped);
  const ProgramRun run = run_poise({"identify", file});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::istringstream lines(run.out);
  std::string line;
  while (std::getline(lines, line) && !line.starts_with("  c ")) continue;
  std::istringstream words(line);
  std::string name;
  double estimate = 0, error = 0, per_cent = 0;
  words >> name >> estimate >> error >> per_cent;
  EXPECT_NEAR(estimate, 0.6 * M_PI / 180, 4 * error) << line;
  EXPECT_NEAR(per_cent, 100 * error / estimate, 0.1 * per_cent) << line;
}

TEST(IdentifyCommand, WarnsOfAnIncompleteModel) {
  const TempFolder folder;
  const std::string csv = folder.path("wheel.csv").string();
  const std::string file = experiment(folder, std::string(wheel_unknowns) + "[[run]]\ndata = \"wheel.csv\"\n");
  std::string data = "time,turn\n";
  for (int i = 0; i < 600; ++i) {
    const double t = 0.01 * i;
    data += std::to_string(t) + "," + std::to_string(20 * std::cos(4 * t) + 3 * std::sin(7 * t)) + "\n";
  }
  folder.write("wheel.csv", data);
  const ProgramRun run = run_poise({"identify", file});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run_poise({"identify", file, "--accept-misfit"}).exit_code, 0);
  EXPECT_TRUE(has(run.out, "Gross misfit: residuals of turn are")) << run.out;
  EXPECT_TRUE(has(run.out, "times the stated noise; none of the usual causes explains it")) << run.out;
  EXPECT_TRUE(has(run.out, "not white")) << run.out;
  EXPECT_TRUE(has(run.out, "Standard errors by what is taken for independent")) << run.out;
  EXPECT_TRUE(has(run.out, "one run shows no more: add runs")) << run.out;
}

TEST(IdentifyCommand, DrawsReadingsResidualsAndSensitivities) {
  if (!app::has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const TempFolder folder;
  const std::string svg = folder.path("a.svg").string();
  ASSERT_EQ(run_poise({"identify", experiment(folder, std::string(wheel_unknowns) + one_run), "--svg", svg}).exit_code,
            0);
  const std::string text = contents(svg);
  EXPECT_EQ(objection_to_xml(text), "");
  for (const char* part :
       {"fitted", "reading (deg)", "2 sigma of the noise", "relative sensitivities", "up to", "time (s)"}) {
    EXPECT_TRUE(has(text, part)) << part;
  }
}

// Of many sensors and parameters it draws some, and names the others.
TEST(IdentifyCommand, DrawsSomeOfManySensorsAndNamesTheOthers) {
  if (!app::has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const TempFolder folder;
  const std::string svg = folder.path("a.svg").string();
  std::string text = wheel_unknowns;
  for (int i = 2; i <= 8; ++i) {
    text += "[[sensor]]\nname = \"copy " + std::to_string(i) + "\"\nangle = \"wheel\"\nnoise = 0.02\n" +
            (i % 2 == 0 ? "rate = true\n" : "");
  }
  const ProgramRun run = run_poise({"identify", experiment(folder, text + one_run), "--svg", svg});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "picture: 6 of 8 sensors, those with the largest residuals over their noise; not drawn: "))
      << run.out;
  const std::string picture = contents(svg);
  EXPECT_EQ(objection_to_xml(picture), "");
  EXPECT_TRUE(has(picture, "2 more not drawn, see the report"));
  // The panels' titles; the figure's title, which holds all of them, comes first.
  std::size_t drawn = 0;
  for (std::size_t at = picture.find("</title>");
       (at = picture.find(": relative sensitivities", at)) != std::string::npos; ++at)
    ++drawn;
  EXPECT_EQ(drawn, 6U);
}

TEST(IdentifyCommand, FitsTheMeasuredDoublePendulum) {
  if (!std::filesystem::exists(measured_pendulum())) GTEST_SKIP() << "no measured data at " << measured_pendulum();
  const TempFolder folder;
  const json r =
      run_json(folder, {"identify", dataset("double_pendulum_experiment"), "--data", measured_pendulum().string()}, 0);
  EXPECT_EQ(r["runs"], 26);
  const auto all = [](const json& rms) {
    return std::hypot(rms[0].get<double>(), rms[1].get<double>()) / std::sqrt(2.0);
  };
  EXPECT_LT(all(r["rms"]), 0.0036) << "rad";
  EXPECT_GT(all(r["rms_from_first_readings"]), all(r["rms"]));
  EXPECT_LT(all(r["rms_from_first_readings"]), 0.02);
}

TEST(IdentifyCommand, InterruptIsReportedAndExitsOne) {
  const TempFolder folder;
  std::string text = std::string(wheel_unknowns) + one_run;
  text.replace(text.find("rate = 200"), 10, "rate = 500000");
  const std::string out = folder.path("out").string();
  EXPECT_EQ(
      interrupt_poise({"identify", experiment(folder, text), "--start", "given"}, out, std::chrono::milliseconds(500)),
      1);
  EXPECT_TRUE(has(contents(out), "No fit: interrupted")) << contents(out);
}

// Interrupted within a fit, it shows the best values reached with their residuals, and writes its files.
TEST(IdentifyCommand, InterruptShowsTheValuesReached) {
  const TempFolder folder;
  std::string text = std::string(wheel_unknowns) + one_run;
  text.replace(text.find("duration = 6"), 12, "duration = 400");
  text.replace(text.find("rate = 200"), 10, "rate = 2000");
  const std::string file = experiment(folder, text), out = folder.path("out").string();
  const std::string svg = app::has_gnuplot() ? folder.path("a.svg").string() : "";
  std::vector<std::string> words = {"identify", file,
                                    "--start",  "given",
                                    "--json",   folder.path("a.json").string(),
                                    "--csv",    folder.path("a.csv").string()};
  if (!svg.empty()) words.insert(words.end(), {"--svg", svg});
  // Later on a slow machine, until a step was made.
  json r;
  for (int wait = 250; wait < 60'000 && (r.is_null() || r["residuals"].empty()); wait *= 2) {
    EXPECT_EQ(interrupt_poise(words, out, std::chrono::milliseconds(wait)), 1);
    r = json::parse(contents(folder.path("a.json").string()));
    EXPECT_EQ(r["status"], "interrupted");
  }
  EXPECT_TRUE(has(contents(out), "No fit: interrupted; the values reached so far are shown")) << contents(out);
  EXPECT_TRUE(has(contents(out), "Values reached, no estimates")) << contents(out);
  ASSERT_EQ(r["estimates"].size(), 2U);
  for (const json& e : r["estimates"]) {
    EXPECT_TRUE(e["value"].is_number()) << e;
    EXPECT_TRUE(e["standard_error"].is_null()) << "of a minimum, which this is not: " << e;
    EXPECT_TRUE(e["low"].is_null()) << e;
  }
  EXPECT_FALSE(has(contents(out), "95 % interval")) << contents(out);
  EXPECT_FALSE(has(contents(out), "error / sigma")) << contents(out);
  ASSERT_EQ(r["residuals"].size(), 1U);
  EXPECT_TRUE(r["residuals"][0]["rms"][0].is_number());
  EXPECT_EQ(read_csv(folder.path("a.csv").string(), {"time", "turn.residual"}).values[0].size(), 800'000U);
  if (!svg.empty()) {
    EXPECT_TRUE(has(contents(svg), "2 sigma of the noise"));
  }
}

// From the result of a fit that was interrupted another one goes on; a validation takes it with a warning.
TEST(IdentifyCommand, GoesOnFromWhatAFitHadReached) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  json part = run_json(folder, {"identify", file}, 0);
  const json whole = part;
  part["status"] = "interrupted";
  part["reached"]["k"] = 1.001 * part["reached"]["k"].get<double>();
  const std::string reached = folder.write("part.json", part.dump());
  const json rest = run_json(folder, {"identify", file, "--continue", reached}, 0);
  for (std::size_t i = 0; i < 2; ++i) {
    const double error = whole["estimates"][i]["standard_error"];
    EXPECT_NEAR(rest["estimates"][i]["value"].get<double>(), whole["estimates"][i]["value"].get<double>(),
                0.01 * error);
  }
  EXPECT_EQ(rest["start"], "from what an earlier fit had reached");
  const json validation = run_json(folder, {"validate", file, "--with", reached}, 0);
  EXPECT_EQ(validation["unfinished"], true);
  EXPECT_TRUE(
      has(run_poise({"validate", file, "--with", reached}).out, "was interrupted: its values are no estimates"));
  part["reached"].erase("c");
  const ProgramRun run = run_poise({"identify", file, "--continue", folder.write("other.json", part.dump())});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has(run.err, "found no \"c\"; give the result of a fit of this experiment")) << run.err;
}

TEST(IdentifyCommand, SaysThatAQuickFitWasNotExamined) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  const json quick = run_json(folder, {"identify", file, "--quick"}, 0);
  EXPECT_EQ(quick["unexamined"].size(), 3U);
  EXPECT_EQ(quick["check_evaluations"], 0);
  EXPECT_TRUE(has(run_poise({"identify", file, "--quick"}).out,
                  "Not all examined, to save time: the cost away from the minimum, other minima, fits without a run."));
  EXPECT_TRUE(run_json(folder, {"identify", file}, 0)["unexamined"].empty());
  EXPECT_EQ(run_poise({"identify", file, "--quick", "--thorough"}).exit_code, 2);
}

}  // namespace
}  // namespace poise::app_tests::identify_command_test
