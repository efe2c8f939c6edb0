// `poise identify`, `identifiability` and `montecarlo` as a person runs them.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "app/plot/gnuplot.hpp"
#include "identification/record.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app_tests {
namespace {

using nlohmann::json;

/// A wheel of 3 kg m2 on a torsion spring of 48 N m/rad with a damper of 0.6 N m s/rad, in degrees: w0 = 4 rad/s.
constexpr const char* wheel = R"([units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0] }
mass = 1
inertia = 3
[[pin]]
points = ["ground.O", "wheel.O"]
[[torsion_spring]]
name = "S"
bodies = ["ground", "wheel"]
stiffness = 0.8377580409572781
[[torsion_damper]]
name = "D"
bodies = ["ground", "wheel"]
coefficient = 0.010471975511965976
)";

constexpr const char* swing = R"(title = "Wheel"
scene = "wheel.toml"
[[sensor]]
name = "turn"
angle = "wheel"
noise = 0.02
[[unknown]]
path = "torsion_spring.S.stiffness"
name = "k"
start = 0.6
[[unknown]]
path = "torsion_damper.D.coefficient"
name = "c"
)";

constexpr const char* one_run = R"([[run]]
name = "only"
release = { wheel = 20 }
duration = 6
rate = 200
seed = 3
)";

constexpr const char* inertia_too = R"([[unknown]]
path = "body.wheel.inertia"
name = "J"
)";

std::string experiment(const TempFolder& folder, const std::string& text) {
  folder.write("wheel.toml", wheel);
  return folder.write("experiment.toml", text);
}

json run_json(const TempFolder& folder, std::vector<std::string> words, int exit_code) {
  const std::string file = folder.path("result.json").string();
  words.insert(words.end(), {"--json", file});
  const Outcome run = run_poise(words);
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  return json::parse(contents(file));
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Starts poise, lets it work for a while, interrupts it and returns its exit code.
int interrupt_poise(const std::vector<std::string>& arguments, const std::string& out,
                    std::chrono::milliseconds after) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::vector<std::string> words = {POISE_EXECUTABLE};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    ::execv(POISE_EXECUTABLE, argv.data());
    ::_exit(127);
  }
  std::this_thread::sleep_for(after);
  ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::filesystem::path measured_pendulum() {
  return std::filesystem::path(POISE_SOURCE_DIR) / ".." / "shared" / "data" / "multi_arm_pendulum" / "double.csv";
}

TEST(IdentifyCommand, FindsTheLift) {
  const TempFolder folder;
  const json r = run_json(folder, {"identify", dataset("lift_experiment")}, 0);
  EXPECT_EQ(r["status"], "converged");
  EXPECT_NEAR(r["misfit"], 1.0, 4 * r["misfit_deviation"].get<double>());
  // Cramer-Rao standard deviations that lift/README.md states, per cent.
  const std::vector<std::pair<std::string, double>> bounds = {{"mP", 0.037}, {"J_O", 1.20}, {"k", 0.014}, {"c", 0.154}};
  ASSERT_EQ(r["estimates"].size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const json& e = r["estimates"][i];
    EXPECT_EQ(e["name"], bounds[i].first);
    const double truth = e["truth"];
    const double deviation = e["deviation"];
    EXPECT_NEAR(100 * deviation / truth, bounds[i].second, 0.03 * bounds[i].second);
    EXPECT_NEAR(e["value"].get<double>(), truth, 4 * deviation);
    EXPECT_TRUE(e["withheld"].is_null());
  }
  EXPECT_EQ(r["estimates"][0]["unit"], "kg");
  EXPECT_EQ(r["estimates"][1]["unit"], "kg m²");
  for (const json& run : r["residuals"]) EXPECT_EQ(run["white"], true) << run;
  EXPECT_NEAR(r["rms"][0], 1e-4, 2e-6);
  EXPECT_TRUE(r["rms_from_first_readings"].is_null());
  EXPECT_NEAR(r["identifiability"]["correlation"][0][1], -0.8, 0.02);
}

TEST(IdentifyCommand, WithholdsTheScaleThatNoPayloadTells) {
  const TempFolder folder;
  const std::string file = folder.path("a.json").string();
  const Outcome run = run_poise({"identify", dataset("lift_experiment_empty"), "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_TRUE(has(run.out, "overall scale")) << run.out;
  EXPECT_TRUE(has(run.out, "known payload")) << run.out;
  EXPECT_TRUE(has(run.out, "Withheld: 4 of 4")) << run.out;
  const std::string text = contents(file);
  const json r = json::parse(text);
  for (const json& e : r["estimates"]) {
    for (const char* key : {"value", "deviation", "truth"}) EXPECT_TRUE(e[key].is_null()) << e;
    EXPECT_TRUE(e["withheld"].is_string()) << e;
  }
  EXPECT_TRUE(r["identifiability"]["untold"][0]["scale"].get<bool>());
  // No line of the table has a digit; the row of the first is "mP  withheld  kg ...".
  const std::size_t table = run.out.find("\nEstimates\n");
  const std::size_t end = run.out.find("\n\n", table);
  ASSERT_NE(table, std::string::npos);
  const std::string rows = run.out.substr(table, end - table);
  EXPECT_EQ(std::count_if(rows.begin(), rows.end(), [](char c) { return c >= '0' && c <= '9'; }), 0) << rows;
  // The masses as the scene has them are told nowhere.
  for (const char* number : {"64.68", "3.3757", "2000000", "2e6", "4000"}) {
    EXPECT_FALSE(has(run.out, number)) << number;
    EXPECT_FALSE(has(text, number)) << number;
  }
}

TEST(IdentifyCommand, ShowsTheUnitsOfTheScene) {
  const TempFolder folder;
  const json r = run_json(folder, {"identify", experiment(folder, std::string(swing) + one_run)}, 0);
  const json& k = r["estimates"][0];
  EXPECT_EQ(k["unit"], "N m/deg");
  EXPECT_EQ(r["estimates"][1]["unit"], "N m s/deg");
  EXPECT_NEAR(k["value"].get<double>(), 48 * M_PI / 180, 4 * k["deviation"].get<double>());
  EXPECT_NEAR(r["sensors"][0]["noise"], 0.02, 1e-15);
  EXPECT_NEAR(r["rms"][0], 0.02, 4 * 0.02 / std::sqrt(2 * 1200.0)) << "degrees";
  const json& found = r["residuals"][0]["nuisances"];
  EXPECT_NEAR(found["start wheel"], 20.0, 0.02) << "degrees";
  EXPECT_NEAR(found["start rate wheel"], 0.0, 0.1) << "degrees per second";
}

TEST(IdentifyCommand, WritesResidualsThatAddUp) {
  const TempFolder folder;
  const std::string csv = folder.path("a.csv").string();
  ASSERT_EQ(run_poise({"identify", experiment(folder, std::string(swing) + one_run), "--csv", csv}).exit_code, 0);
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
  const std::string csv = folder.path("swing.csv").string();
  const std::string file = experiment(folder, std::string(swing) + "[[run]]\ndata = \"swing.csv\"\n");
  const Outcome moved = run_poise({"motion", folder.path("wheel.toml").string(), "--duration", "6", "--rate", "200",
                                   "--from", "start", "--release", "wheel=20", "--noise", "0.02", "--csv", csv});
  ASSERT_EQ(moved.exit_code, 0) << moved.out << moved.err;
  const std::string text = contents(csv);
  folder.write("swing.csv", "time,turn" + text.substr(text.find(",wheel") + 6));
  const json r = run_json(folder, {"identify", file}, 0);
  EXPECT_EQ(r["experiment"]["simulated"], false);
  const json& k = r["estimates"][0];
  EXPECT_TRUE(k["truth"].is_null()) << "nobody knows it";
  EXPECT_NEAR(k["value"].get<double>(), 48 * M_PI / 180, 4 * k["deviation"].get<double>());
  ASSERT_EQ(r["rms_from_first_readings"].size(), 1U);
  EXPECT_GT(r["rms_from_first_readings"][0], r["rms"][0]) << "the fitted start is the better one";
  EXPECT_LT(r["rms_from_first_readings"][0], 5.0) << "degrees";
}

TEST(IdentifyCommand, WarnsOfWhatTheModelMisses) {
  const TempFolder folder;
  const std::string csv = folder.path("swing.csv").string();
  const std::string file = experiment(folder, std::string(swing) + "[[run]]\ndata = \"swing.csv\"\n");
  std::string data = "time,turn\n";
  for (int i = 0; i < 600; ++i) {
    const double t = 0.01 * i;
    data += std::to_string(t) + "," + std::to_string(20 * std::cos(4 * t) + 3 * std::sin(7 * t)) + "\n";
  }
  folder.write("swing.csv", data);
  const Outcome run = run_poise({"identify", file});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_TRUE(has(run.out, "Converged, but take care")) << run.out;
  EXPECT_TRUE(has(run.out, "not white")) << run.out;
  EXPECT_TRUE(has(run.out, "deviations are larger than shown")) << run.out;
}

TEST(IdentifyCommand, DrawsReadingsResidualsAndSensitivities) {
  if (!app::has_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  const TempFolder folder;
  const std::string svg = folder.path("a.svg").string();
  ASSERT_EQ(run_poise({"identify", experiment(folder, std::string(swing) + one_run), "--svg", svg}).exit_code, 0);
  const std::string text = contents(svg);
  EXPECT_EQ(objection_to_xml(text), "");
  for (const char* part :
       {"fitted", "reading (deg)", "2 deviations of the noise", "what the parameters do", "up to", "time (s)"}) {
    EXPECT_TRUE(has(text, part)) << part;
  }
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

TEST(IdentifyCommand, InterruptTellsSoAndExitsOne) {
  const TempFolder folder;
  std::string text = std::string(swing) + one_run;
  text.replace(text.find("rate = 200"), 10, "rate = 500000");
  const std::string out = folder.path("out").string();
  EXPECT_EQ(
      interrupt_poise({"identify", experiment(folder, text), "--start", "given"}, out, std::chrono::milliseconds(500)),
      1);
  EXPECT_TRUE(has(contents(out), "No fit: interrupted")) << contents(out);
}

TEST(IdentifiabilityCommand, PredictsTheLiftBeforeAnyData) {
  const TempFolder folder;
  const json r = run_json(folder, {"identifiability", dataset("lift_experiment")}, 0);
  EXPECT_EQ(r["identifiability"]["rank"], 4);
  EXPECT_EQ(r["nuisances"], 18);
  EXPECT_EQ(r["readings"], 12000);
  EXPECT_NEAR(r["predicted"][0]["value"], 64.6824, 1e-4);
  EXPECT_NEAR(100 * r["predicted"][0]["deviation"].get<double>() / 64.6824, 0.037, 0.0006) << "per cent";
  EXPECT_EQ(r["base_parameters"]["rank"], 23);
  EXPECT_EQ(r["base_parameters"]["parameters"], 36);
}

TEST(IdentifiabilityCommand, NamesTheScaleAndTheRemedy) {
  const Outcome run = run_poise({"identifiability", dataset("lift_experiment_empty"), "--base"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "4 of 4 parameters cannot be told")) << run.out;
  EXPECT_TRUE(has(run.out, "overall scale")) << run.out;
  EXPECT_TRUE(has(run.out, "remedy: add a run with a known payload")) << run.out;
  EXPECT_TRUE(has(run.out, "cylinder.J + 1 rod.J")) << run.out;
}

TEST(IdentifiabilityCommand, NamesAnExactNullDirection) {
  // Inertia, stiffness and damping of a free wheel: only their ratios matter.
  const TempFolder folder;
  const json r =
      run_json(folder, {"identifiability", experiment(folder, std::string(swing) + inertia_too + one_run)}, 0);
  EXPECT_EQ(r["identifiability"]["rank"], 2);
  ASSERT_EQ(r["identifiability"]["untold"].size(), 1U);
  const json& direction = r["identifiability"]["untold"][0];
  EXPECT_EQ(direction["exact"], true);
  for (const char* name : {"k", "c", "J"}) EXPECT_NEAR(direction["part"][name], 1.0, 1e-6) << "all by the same part";
  for (const json& p : r["predicted"]) EXPECT_TRUE(p["deviation"].is_null()) << p;
}

TEST(MonteCarloCommand, ReachesTheBoundOfAWheel) {
  const TempFolder folder;
  const json r = run_json(
      folder, {"montecarlo", experiment(folder, std::string(swing) + one_run), "--trials", "60", "--jobs", "2"}, 0);
  EXPECT_EQ(r["trials"], 60);
  EXPECT_EQ(r["converged"], 60);
  EXPECT_EQ(r["arrived"], 60);
  for (const json& e : r["estimates"]) {
    EXPECT_NEAR(e["rmse_over_bound"], 1.0, 4 / std::sqrt(2 * 60.0)) << e;
    EXPECT_NEAR(e["coverage"], 0.95, 4 * e["coverage_deviation"].get<double>()) << e;
  }
}

TEST(MonteCarloCommand, FollowsItsSeed) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(swing) + one_run);
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
  const int code = interrupt_poise({"montecarlo", experiment(folder, std::string(swing) + one_run), "--trials",
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
  const std::string good = experiment(folder, std::string(swing) + one_run);
  const std::string scene = folder.path("wheel.toml").string();
  const std::string nothing =
      folder.write("nothing.toml", std::string(swing).substr(0, std::string(swing).find("[[unknown]]")) + one_run);
  std::string lost_text = std::string(swing) + one_run;
  lost_text.replace(lost_text.find("S.stiffness"), 11, "S.stifness");
  const std::string lost = folder.write("lost.toml", lost_text);
  const std::string measured = folder.write("measured.toml", std::string(swing) + "[[run]]\ndata = \"d.csv\"\n");
  folder.write("d.csv", "time,turn\n0,1\n0.1,2\n0.2,3\n0.3,2\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"identify"}, "EXPERIMENT is required"},
      {{"identify", good, "b.toml"}, "expected one experiment"},
      {{"identify", folder.path("none.toml").string()}, "none.toml"},
      {{"identify", scene}, "wheel.toml:5: body: expected one of the keys"},
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
      {{"montecarlo", good, "--off", "1"}, "--off: expected"},
      {{"montecarlo", good, "--jobs", "-1"}, "--jobs: expected"}};
  const std::vector<std::string> before = folder.names();
  for (const auto& [words, says] : cases) {
    const Outcome run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << says;
    EXPECT_EQ(run.out, "") << says;
    EXPECT_TRUE(has(run.err, says)) << says << "\n" << run.err;
    EXPECT_EQ(lines(run.err), 1U) << run.err;
  }
  EXPECT_EQ(folder.names(), before);
}

}  // namespace
}  // namespace poise::app_tests
