// `poise identify --scene` and `poise validate` through the command line.

#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/draw/chart/gnuplot.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::validate_command_test {
namespace {

using nlohmann::json;

std::filesystem::path measured_pendulum() {
  return std::filesystem::path(POISE_SOURCE_DIR) / ".." / "shared" / "data" / "multi_arm_pendulum" / "double.csv";
}

/// Fits and writes NAME.json and NAME.toml; the first as read.
json identify(const TempFolder& folder, const std::string& experiment, const std::string& name,
              const std::vector<std::string>& more = {}) {
  const std::string file = folder.path(name + ".json").string();
  std::vector<std::string> words = {"identify", experiment, "--json",
                                    file,       "--scene",  folder.path(name + ".toml").string()};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  return json::parse(contents(file));
}

/// The scene written has the estimates, and all else as it was, with the changes.
void expect_scene(const TempFolder& folder, const json& fit, const std::string& name,
                  const std::vector<std::pair<std::string, double>>& changes = {}) {
  const Scene back = read_scene(folder.path(name + ".toml"));
  Scene expected = read_scene(fit["experiment"]["scene"].get<std::string>());
  for (const auto& [path, value] : changes) set_value(expected, path, value);
  std::map<std::string, int> values;
  for (const json& e : fit["estimates"]) ++values[e["path"]];
  for (const json& e : fit["estimates"]) {
    if ((!e["withheld"].is_null() && !e["at_bound"]) || values[e["path"]] > 1) continue;
    set_value(expected, e["path"].get<std::string>(), e["scene_value"]);
  }
  for (const ParameterRow& row : parameter_table(expected)) {
    const std::optional<double> wanted = value_at(expected, row.place), found = value_at(back, row.place);
    ASSERT_EQ(wanted.has_value(), found.has_value()) << row.path.text();
    if (!wanted) continue;
    EXPECT_DOUBLE_EQ(*wanted, *found) << row.path.text();
  }
}

TEST(IdentifyCommand, WritesTheSceneOfEveryExperiment) {
  const TempFolder folder;
  const bool measured = std::filesystem::exists(measured_pendulum());
  int experiments = 0;
  for (const auto& file : std::filesystem::directory_iterator(std::filesystem::path(POISE_SOURCE_DIR) / "datasets")) {
    const std::string name = file.path().stem().string();
    if (name.find("experiment") == std::string::npos) continue;
    const bool pendulum = name.starts_with("double");
    if (pendulum && !measured) continue;
    SCOPED_TRACE(name);
    std::vector<std::string> more;
    if (pendulum) more = {"--data", measured_pendulum().string()};
    const json fit = identify(folder, file.path().string(), name, more);
    ++experiments;
    // Without a known payload nothing can be written.
    if (name == "lift_experiment_empty") {
      EXPECT_FALSE(std::filesystem::exists(folder.path(name + ".toml")));
    } else {
      expect_scene(folder, fit, name);
    }
  }
  EXPECT_GE(experiments, 4);
}

TEST(IdentifyCommand, WritesKnownChangesAndSaysWhatItLeaves) {
  const TempFolder folder;
  std::string text = "set = { \"body.wheel.mass\" = 2 }\n" + std::string(wheel_unknowns) + one_run;
  text.insert(text.find("name = \"c\""), "per = \"run\"\n");
  text += "[[run]]\nname = \"other\"\nrelease = { wheel = 20 }\nduration = 6\nrate = 200\nseed = 4\n";
  const json fit = identify(folder, experiment(folder, text), "out", {"--set", "gravity.y=-1"});
  expect_scene(folder, fit, "out", {{"body.wheel.mass", 2.0}, {"gravity.y", -1.0}});
  EXPECT_EQ(fit["experiment"]["changes"][0], "body.wheel.mass=2");
  EXPECT_EQ(fit["estimates"][1]["unknown"], "c");
  const std::string scene = contents(folder.path("out.toml"));
  EXPECT_TRUE(has(scene, "# torsion_damper.D.coefficient keeps its value, since it differs between the runs: c (only)"))
      << scene;
  EXPECT_TRUE(has(scene, "#   torsion_spring.S.stiffness = 0.8")) << scene;
  EXPECT_TRUE(has(scene, "with estimates of poise identify")) << scene;
}

TEST(IdentifyCommand, DoesNotWriteTheSceneOverItself) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  const ProgramRun run = run_poise({"identify", file, "--scene", folder.path("wheel.toml").string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(has(run.err, "--scene")) << run.err;
}

// On its own records the held-out error is that of the fit.
TEST(ValidateCommand, ReproducesTheResidualsOfTheFit) {
  const TempFolder folder;
  const json fit = identify(folder, dataset("lift_experiment_heights"), "fit");
  const json held =
      run_json(folder, {"validate", dataset("lift_experiment_heights"), "--with", folder.path("fit.json").string()}, 0);
  EXPECT_NEAR(held["ratio"], 1.0, 1e-4);
  EXPECT_NEAR(held["ratio_refitted"], 1.0, 1e-4);
  EXPECT_EQ(held["status"], "converged");
  EXPECT_TRUE(has(held["verdict"], "The prediction agrees with the noise, 1")) << held["verdict"];
  EXPECT_NEAR(held["rms"][0].get<double>(), fit["rms"][0].get<double>(), 1e-4 * fit["rms"][0].get<double>());
  for (std::size_t r = 0; r < fit["residuals"].size(); ++r) {
    const json &a = fit["residuals"][r], &b = held["residuals"][r];
    EXPECT_NEAR(a["rms"][0].get<double>(), b["rms"][0].get<double>(), 1e-3 * a["rms"][0].get<double>());
    for (const auto& [name, value] : a["nuisances"].items()) {
      EXPECT_NEAR(b["nuisances"][name].get<double>(), value.get<double>(), 2e-6) << name;
    }
  }
  // Of n readings that determine p parameters their uncertainty explains noise sqrt(p / n).
  const double n = fit["readings"], p = fit["parameters"], noise = 1e-4;
  EXPECT_NEAR(held["held_out"][0]["from_parameters"], noise * std::sqrt(p / n), 0.05 * noise * std::sqrt(p / n));
}

// New records of the same wheel, in other units; its noise is not stated, that of the fit is taken.
TEST(ValidateCommand, PredictsOtherRecords) {
  const TempFolder folder;
  const std::string file = experiment(folder, std::string(wheel_unknowns) + one_run);
  identify(folder, file, "fit");
  const std::string with = folder.path("fit.json").string();
  run_poise({"motion", folder.path("wheel.toml").string(), "--duration", "5", "--from", "start", "--release",
             "wheel=30", "--noise", "0.02", "--csv", folder.path("other.csv").string()});
  const std::string other = folder.write("other.toml", R"(scene = "wheel.toml"
[[sensor]]
name = "turn"
angle = "wheel"
column = "wheel"
[[unknown]]
path = "torsion_spring.S.stiffness"
name = "k"
[[unknown]]
path = "torsion_damper.D.coefficient"
name = "c"
[[run]]
data = "other.csv"
)");
  std::vector<std::string> words = {"validate", other, "--with", with, "--csv", folder.path("out.csv").string()};
  if (app::has_gnuplot()) words.insert(words.end(), {"--svg", folder.path("out.svg").string()});
  const json held = run_json(folder, words, 0);
  EXPECT_NEAR(held["ratio"], 1.0, 0.1);
  EXPECT_EQ(held["status"], "converged");
  EXPECT_NEAR(held["held_out"][0]["noise"], 0.02, 1e-12);
  EXPECT_EQ(contents(folder.path("out.csv")).substr(0, 45), "run,time,turn,turn.prediction,turn.residual\nr");
  const json measured = run_json(folder, {"validate", other, "--with", with, "--starts", "measured"}, 0);
  EXPECT_EQ(measured["starts"], "measured");
  EXPECT_GE(measured["rms"][0], held["rms"][0]);
  EXPECT_EQ(measured["degrees_of_freedom"], measured["readings"]);
  // A spring that is 10 % stiffer than what was fitted.
  std::string stiffer = contents(folder.path("wheel.toml"));
  stiffer.replace(stiffer.find("0.8377"), 6, "0.9215");
  folder.write("stiffer.toml", stiffer);
  run_poise({"motion", folder.path("stiffer.toml").string(), "--duration", "5", "--from", "start", "--release",
             "wheel=30", "--noise", "0.02", "--csv", folder.path("other.csv").string()});
  const json wrong = run_json(folder, {"validate", other, "--with", with}, 0);
  EXPECT_EQ(wrong["status"], "misfit");
  EXPECT_GT(wrong["ratio"], 20.0);
  // With its own stiffness the model explains these records, too.
  EXPECT_NEAR(wrong["held_out"][0]["refitted"], 0.02, 0.002);
  EXPECT_NEAR(wrong["ratio_refitted"].get<double>() * wrong["held_out"][0]["refitted"].get<double>(), wrong["rms"][0],
              1e-9);
  EXPECT_TRUE(has(wrong["verdict"], "The prediction's error is ")) << wrong["verdict"];
}

TEST(ValidateCommand, NamesWhatTheFitLacks) {
  const TempFolder folder;
  const std::string text = std::string(wheel_unknowns) + one_run;
  const std::string file = experiment(folder, text);
  json fit = identify(folder, file, "fit");
  const std::string with = folder.path("fit.json").string();
  const auto expect_error = [&](const std::string& experiment, const std::string& words) {
    const ProgramRun run = run_poise({"validate", experiment, "--with", with});
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_TRUE(has(run.err, words)) << run.err;
  };
  std::string other = text;
  other.replace(other.find("name = \"c\""), 10, "name = \"damping\"");
  expect_error(folder.write("other.toml", other), "unknown \"damping\": expected the name of an estimate in " + with);
  other = text;
  other.replace(other.find("torsion_damper.D.coefficient"), 28, "body.wheel.inertia");
  expect_error(folder.write("other.toml", other),
               "unknown \"c\": expected the path torsion_damper.D.coefficient as in " + with);
  fit["estimates"][0]["withheld"] = "at the bound 0";
  folder.write("fit.json", fit.dump());
  expect_error(file, "unknown \"k\": expected an estimate in " + with + ", it is withheld: at the bound 0");
  fit["status"] = "failed";
  folder.write("fit.json", fit.dump());
  expect_error(file, "that converged, found status \"failed\"");
  folder.write("fit.json", "{}");
  expect_error(file, "expected the result of poise identify with --json FILE, found another text");
  fit["status"] = "converged";
  fit.erase("covariance");
  folder.write("fit.json", fit.dump());
  expect_error(file, "found one that lacks keys");
}

/// Each half of the measured records predicted by the model that is fitted to the other half. The elbow's damper ends
/// at its bound, 0, in most of these fits: no estimate, but the model has it there.
void expect_predicts_halves(const std::string& experiment) {
  if (!std::filesystem::exists(measured_pendulum())) GTEST_SKIP() << "no measured data at " << measured_pendulum();
  const TempFolder folder;
  folder.write("double_pendulum.toml", contents(dataset("double_pendulum")));
  const std::string text = contents(dataset(experiment));
  const std::string data = measured_pendulum().string();
  std::vector<std::string> halves;
  for (const int first : {0, 1}) {
    std::string segments;
    for (int i = first; i < 26; i += 2) segments += (i > 1 ? ", \"" : "\"") + std::to_string(i) + "\"";
    halves.push_back(folder.write("half" + std::to_string(first) + ".toml", text + "segments = [" + segments + "]\n"));
  }
  double own = 0.0, held_out = 0.0;
  for (const std::size_t half : {0U, 1U}) {
    const json fit = identify(folder, halves[half], "fit", {"--data", data});
    const json held =
        run_json(folder, {"validate", halves[1 - half], "--with", folder.path("fit.json").string(), "--data", data}, 0);
    std::cout << experiment << ", half " << half << ": rms fitted " << fit["rms"] << " rad, held out " << held["rms"]
              << ", ratio " << held["ratio"] << ", over a fit to them " << held["ratio_refitted"] << "\n";
    EXPECT_LT(held["ratio_refitted"], 1.05);
    for (const int sensor : {0, 1}) {
      own += std::pow(fit["rms"][sensor].get<double>(), 2);
      held_out += std::pow(held["rms"][sensor].get<double>(), 2);
    }
  }
  const double ratio = std::sqrt(held_out / own);
  std::cout << experiment << ": held-out error over the identification's own, both halves: " << ratio << "\n";
  EXPECT_LT(ratio, 1.05);
}

TEST(ValidateCommand, PredictsTheMeasuredDoublePendulum) { expect_predicts_halves("double_pendulum_experiment"); }

TEST(ValidateCommand, PredictsTheMeasuredDoublePendulumWithDryFriction) {
  expect_predicts_halves("double_pendulum_dry_experiment");
}

}  // namespace
}  // namespace poise::app_tests::validate_command_test
