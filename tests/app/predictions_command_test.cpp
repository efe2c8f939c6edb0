// `--with FIT.json`: results with intervals from a fit, through the command line.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"
#include "tests/support/toggle_rig.hpp"

namespace poise::app_tests::predictions_command_test {
namespace {

using nlohmann::json;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The rig in a folder, with a fit of it.
class FittedRig : public testing::Test {
 protected:
  /// `further`: tables behind the experiment.
  std::string fit(const std::string& further = "") {
    const std::string file = folder_.write("experiment.toml", test::rig_experiment(1, further));
    const ProgramRun run = run_poise({"identify", file, "--json", path("fit.json")});
    EXPECT_LE(run.exit_code, 1) << run.err;
    return path("fit.json");
  }
  std::string path(const std::string& name) const { return folder_.path(name).string(); }
  json result(std::vector<std::string> words, int exit_code) {
    words.insert(words.end(), {"--json", path("out.json")});
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
    text_ = run.out + run.err;
    return json::parse(contents(folder_.path("out.json")));
  }
  std::string complaint(const std::vector<std::string>& words) {
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    return run.err;
  }

  TempFolder folder_;
  std::string scene_ = folder_.write("rig.toml", test::rig_scene());
  std::string text_;
};

const json& named(const json& result, const std::string& name) {
  for (const json& one : result.at("predictions").at("results")) {
    if (one.at("name") == name) return one;
  }
  static const json none = json::object();
  ADD_FAILURE() << "no " << name;
  return none;
}

TEST_F(FittedRig, SnapsWhereItsFitSays) {
  const json path = result({"path", scene_, "--vary", "load.P=0..40", "--with", fit()}, 0);
  const json& fold = named(path, "load.P at fold 1");
  EXPECT_LT(fold["low"].get<double>(), test::rig_snap_load());
  EXPECT_GT(fold["high"].get<double>(), test::rig_snap_load());
  double sum = 0.0;
  for (const json& share : fold["shares"]) sum += share["share"].get<double>();
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_TRUE(has(text_, "at load.P = ")) << text_;
  EXPECT_TRUE(has(text_, "(95 %), ")) << text_;
  // Its name gives the same load, from the equilibrium under the scene's own load.
  const json band =
      result({"tolerance", scene_, "--with", this->path("fit.json"), "--of", "fold.load.P", "--samples", "0"}, 0);
  EXPECT_NEAR(band["quantities"][0]["sigma"].get<double>(), fold["standard_error"].get<double>(),
              1e-6 * fold["standard_error"].get<double>());
}

TEST_F(FittedRig, GivesEveryResultOfAnEquilibriumAnInterval) {
  const json solved = result({"solve", scene_, "--with", fit(), "--show", "x.block.C"}, 0);
  for (const std::string name : {"x.block.C", "angle.left", "travel.rail", "force.rubber", "reaction.O"}) {
    const json& one = named(solved, name);
    EXPECT_LT(one["low"].get<double>(), one["value"].get<double>()) << name;
    EXPECT_GT(one["high"].get<double>(), one["value"].get<double>()) << name;
  }
  const json all =
      result({"equilibria", scene_, "--with", path("fit.json"), "--show", "angle.left", "--starts", "50"}, 0);
  EXPECT_GT(all["predictions"]["results"].size(), 1u);
}

// Samples of the fit's numbers agree with its first and second order; with tolerances beside them the variances add up.
TEST_F(FittedRig, CountsBesideTolerances) {
  const std::string tolerances = folder_.write("t.toml", "[tolerances]\n\"point.left.knee.x\" = 1e-4\n");
  const auto band = [&](std::vector<std::string> further, const std::string& samples) {
    std::vector<std::string> words = {"tolerance", scene_, "--of", "angle.left", "--samples", samples};
    words.insert(words.end(), further.begin(), further.end());
    return result(words, 0)["quantities"][0];
  };
  const json fitted = band({"--with", fit()}, "20000");
  EXPECT_NEAR(fitted["continued"]["sigma"].get<double>(), fitted["sigma"].get<double>(),
              0.03 * fitted["sigma"].get<double>());
  const json made = band({"--tolerances", tolerances}, "0");
  // The estimates are not quite the numbers of the scene, at which the tolerances alone were taken.
  const json both = band({"--with", path("fit.json"), "--tolerances", tolerances}, "0");
  EXPECT_NEAR(both["sigma"].get<double>(), std::hypot(fitted["sigma"].get<double>(), made["sigma"].get<double>()),
              3e-3 * both["sigma"].get<double>());
  const std::string twice = folder_.write("twice.toml", "[tolerances]\n\"spring.*\" = 1e-4\n");
  EXPECT_TRUE(
      has(complaint({"tolerance", scene_, "--of", "angle.left", "--with", path("fit.json"), "--tolerances", twice}),
          "has both a tolerance and an estimate"));
}

// With the mass unknown too the swings tell only k / m and c / m: the angle of equilibrium, which k moves alone, is not
// determined; what no unknown moves is.
TEST_F(FittedRig, SaysWhatTheFitDoesNotDetermine) {
  const std::string mass =
      "[[unknown]]\npath = \"body.block.mass\"\nname = \"m\"\nstart = 3.5\nmin = 0.1\n"
      "[[unknown]]\npath = \"load.P\"\nname = \"P\"\nstart = 7\nmin = 0.1\n";
  const json solved = result({"solve", scene_, "--with", fit(mass), "--show", "reaction.O"}, 1);
  EXPECT_FALSE(named(solved, "reaction.O")["not_determined"].is_null()) << "a common factor of all forces moves it";
  EXPECT_TRUE(named(solved, "angle.left")["not_determined"].is_null()) << "it does not move the angle";
  const auto direction = named(solved, "reaction.O")["not_determined"].get<std::string>();
  EXPECT_TRUE(has(text_, "reaction.O is not determined by this fit: " + direction.substr(0, 6))) << text_;
  EXPECT_TRUE(named(solved, "reaction.O")["low"].is_null());
}

// A clock whose rate is known to 1 % moves what follows from swings alone, and no angle at rest; it is no number of the
// scene.
TEST_F(FittedRig, CarriesAnUncertainClock) {
  const json solved = result(
      {"solve", scene_, "--with", fit("[[known]]\npath = \"clock\"\ndeviation = 0.01\n"), "--show", "angle.left"}, 0);
  EXPECT_FALSE(named(solved, "angle.left")["low"].is_null());
}

// As the scene stands a drive of the rail holds  E = k (l0 - l) - P/(2 tan a), and friction F of it the loads
// P = 2 tan a (k (l0 - l) -+ F): so are their errors, by the covariance of k and l0.
TEST_F(FittedRig, CarriesErrorsIntoForcesAndHeldRanges) {
  const std::string found = fit();
  constexpr double a = 0.19, P = 8.0, F = 2.0;
  // The scene as it is assembled at this angle, exactly.
  std::string text = test::rig_scene();
  text.replace(text.find("rail = 0.589"), 12, fmt::format("rail = {:.17g}", 0.6 * std::cos(a)));
  const std::string placed = folder_.write("placed.toml", text);
  const json fitted = json::parse(contents(folder_.path("fit.json"))), &v = fitted["covariance"];
  const json forces = result({"forces", placed, "--drive", "rail", "--with", found}, 0);
  const json& effort = named(forces, "effort of rail");
  double k = 0.0, l0 = 0.0;
  for (const json& one : fitted["fitted_numbers"]["numbers"]) {
    if (one["path"] == "spring.rubber.stiffness") k = one["value"];
    if (one["path"] == "spring.rubber.free_length") l0 = one["value"];
  }
  const double short_by = l0 - (1 - 0.6 * std::cos(a));
  const double deviation =
      std::sqrt(short_by * short_by * v["k"]["k"].get<double>() + k * k * v["l0"]["l0"].get<double>() +
                2 * short_by * k * v["k"]["l0"].get<double>());
  EXPECT_NEAR(effort["value"].get<double>(), k * short_by - P / (2 * std::tan(a)), 1e-6 * k * l0);
  EXPECT_NEAR(effort["standard_error"].get<double>(), deviation, 1e-3 * deviation);

  const std::string rubbing = folder_.write(
      "rubbing.toml", text + fmt::format("[[friction]]\nname = \"rail\"\nslide = \"rail\"\nforce = {}\n", F));
  const json held = result({"hold", rubbing, "--vary", "load.P", "--with", found}, 0);
  for (const auto& [name, sign] : {std::pair("least held load.P", -1.0), std::pair("greatest held load.P", 1.0)}) {
    const json& end = named(held, name);
    EXPECT_NEAR(end["value"].get<double>(), 2 * std::tan(a) * (k * short_by + sign * F), 1e-6 * k * l0) << name;
    EXPECT_NEAR(end["standard_error"].get<double>(), 2 * std::tan(a) * deviation, 1e-3 * deviation) << name;
  }
  EXPECT_TRUE(has(complaint({"hold", rubbing, "--with", found}), "expected --vary NUMBER too"));
}

TEST_F(FittedRig, SaysInOneLineWhatItCannotTake) {
  const std::string found = fit();
  EXPECT_TRUE(has(complaint({"solve", scene_, "--with", found, "--set", "spring.rubber.stiffness=9000"}),
                  "--set spring.rubber.stiffness=9000: --with "));
  EXPECT_TRUE(
      has(complaint({"solve", dataset("von_mises_toggle"), "--with", found}), "has no number for its estimate"));
  EXPECT_TRUE(has(complaint({"solve", scene_, "--with", scene_}), "expected the result of poise identify"));
  EXPECT_TRUE(has(complaint({"path", scene_, "--vary", "load.P=0..40", "--with", found, "--variant", "a: load.P=3"}),
                  "--with: not with --beside and --variant"));
  EXPECT_TRUE(has(complaint({"solve", scene_, "--with", found, "--json", found}), "--json"));
}

// The runs that make the snap load sharp, whose standard error is the one that a fit of them reaches.
TEST_F(FittedRig, PlansRunsForThePrediction) {
  const std::string limits =
      "[plan]\nruns = 2\ncandidates = 12\n[[plan.vary]]\nwhat = \"release.left\"\nmin = 0.17\nmax = 0.23\n";
  const std::string file = folder_.write("plan.toml", test::rig_experiment(1, limits));
  const json plan = result({"plan", file, "--for", "fold.load.P"}, 0);
  EXPECT_EQ(plan["criterion"], "C");
  EXPECT_NEAR(plan["for_value"].get<double>(), test::rig_snap_load(), 1e-6);
  const json other = result({"plan", file}, 0);
  const double sharp = plan["steps"][1]["prediction"];
  EXPECT_LT(sharp, plan["steps"][0]["prediction"].get<double>());
  EXPECT_TRUE(other["steps"][1]["prediction"].is_null());
  EXPECT_TRUE(has(complaint({"plan", file, "--in", scene_}), "--in: expected --for beside it"));
}

}  // namespace
}  // namespace poise::app_tests::predictions_command_test
