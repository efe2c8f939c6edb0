// Designs of datasets/: met, by the search and by a judge that shares nothing with it, and known answers.

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/design/goal_judge.hpp"

namespace poise::app_tests::design_recipes_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// What a design comes to: the result, and the scene that it has written.
struct Designed {
  json result;
  Scene scene;

  double number(const std::string& path) const { return result["numbers"][path]["value"].get<double>(); }
};

Designed designed(const fs::path& file, const std::vector<std::string>& more = {}, int code = 0) {
  const TempFolder folder;
  const std::string out = folder.path("out.json").string(), scene = folder.path("scene.toml").string();
  std::vector<std::string> words{"design", file.string(), "--json", out, "--scene", scene, "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, code) << run.out << run.err;
  return {json::parse(contents(out)), read_scene(scene)};
}

class Recipe : public ::testing::TestWithParam<const char*> {};

TEST_P(Recipe, IsMet) {
  const std::string file = dataset(std::string(GetParam()) + "_design");
  const Designed found = designed(file);
  EXPECT_EQ(found.result["met"], true);
  EXPECT_EQ(found.result["points"], found.result["proved"]);
  EXPECT_EQ(test::missed_goals(file, found.scene), "");
}

// The scenes as they are do not meet them, so that the judge can tell.
TEST_P(Recipe, IsNotMetByTheSceneAsItIs) {
  const std::string file = dataset(std::string(GetParam()) + "_design");
  std::string scene = GetParam();
  if (scene.ends_with("_robust")) scene.resize(scene.size() - std::string("_robust").size());
  EXPECT_NE(test::missed_goals(file, read_scene(dataset(scene))), "");
}

INSTANTIATE_TEST_SUITE_P(Designs, Recipe,
                         ::testing::Values("bike_suspension", "bistable_four_bar", "constant_force", "garage_door",
                                           "knee_press", "over_centre_latch", "tailgate", "torque_profile", "wall_bed",
                                           "wall_bed_robust"),
                         [](const auto& one) { return std::string(one.param); });

// datasets/bistable_four_bar.toml: both stiffnesses follow from the poses and the barrier.
TEST(DesignAnswers, SpringsOfTheBistableFourBar) {
  const Designed found = designed(dataset("bistable_four_bar_design"));
  const double kc = 2.68358256373652, ratio = 0.0870966388841565;
  EXPECT_NEAR(found.number("torsion_spring.C.stiffness"), kc, 1e-8 * kc);
  EXPECT_NEAR(found.number("torsion_spring.D.stiffness"), kc * ratio, 1e-8 * kc * ratio);
}

/// The ratio of the largest to the least force of a constant-force mechanism of links of 200 mm in all,
///   F = k A / (r2 (sin A + cos A tan B)),   r2 sin A = r3 sin B,  x = r2 cos A + r3 cos B.
double force_ratio(double r2, double from, double to) {
  const double r3 = 200.0 - r2;
  double least = HUGE_VAL, most = 0.0;
  constexpr int steps = 4000;
  for (int k = 0; k <= steps; ++k) {
    const double x = from + (to - from) * k / steps;
    const double a = std::acos((x * x + r2 * r2 - r3 * r3) / (2.0 * x * r2));
    const double b = std::asin(r2 * std::sin(a) / r3);
    const double force = a / (std::sin(a) + std::cos(a) * std::tan(b));
    least = std::min(least, force);
    most = std::max(most, force);
  }
  return most / least;
}

/// The length r2 of the least ratio, which falls before it and rises after it.
double best_length(double from, double to) {
  double low = 90.0, high = 130.0;
  for (int k = 0; k < 60; ++k) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    const bool is_low = force_ratio(a, from, to) < force_ratio(b, from, to);
    (is_low ? high : low) = is_low ? b : a;
  }
  return low;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

// The benchmark goes from the straight mechanism on, the goals from 199.7 mm: R = 0.827075 and Xi = 1.00306181 there.
TEST(DesignAnswers, TheFlattestConstantForce) {
  const Designed found = designed(dataset("constant_force_design"));
  const double r2 = found.number("point.crank.B.x"), best = best_length(199.7, 168.0);
  EXPECT_LE(force_ratio(r2, 199.7, 168.0), 1.00306181 + 1e-5);
  EXPECT_LE(force_ratio(r2, 199.7, 168.0), force_ratio(best, 199.7, 168.0) + 1e-6);
  EXPECT_NEAR(r2, best, 0.005);
  EXPECT_NEAR(200.0 / r2 - 1.0, 0.827075, 5e-4);
  EXPECT_NEAR(found.number("point.rod.C.x"), 200.0 - r2, 1e-10);
}

// Pushed in by up to 40 % of its length: R = 0.884879 and Xi = 1.02449977.
TEST(DesignAnswers, TheFlattestConstantForceOverALongerRange) {
  const TempFolder folder;
  fs::copy_file(dataset("constant_force"), folder.path("constant_force.toml"));
  std::string text = contents(dataset("constant_force_design"));
  for (int k = 0; k < 3; ++k) text = replaced(text, "[199.7, 168]", "[199.7, 120]");
  text = replaced(text, "most = 1.0035", "most = 1.03");
  const std::string file = folder.write("design.toml", text);
  const Designed found = designed(file);
  const double r2 = found.number("point.crank.B.x"), best = best_length(199.7, 120.0);
  EXPECT_LE(force_ratio(r2, 199.7, 120.0), 1.02449977 + 1e-5);
  EXPECT_LE(force_ratio(r2, 199.7, 120.0), force_ratio(best, 199.7, 120.0) + 1e-5);
  EXPECT_NEAR(200.0 / r2 - 1.0, 0.884879, 5e-4);
  EXPECT_EQ(test::missed_goals(file, found.scene), "");
}

}  // namespace
}  // namespace poise::app_tests::design_recipes_test
