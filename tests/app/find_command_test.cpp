// `poise find`: the jobs of docs/find.md against closed forms and references.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::find_command_test {
namespace {

using nlohmann::json;
constexpr double degree = std::numbers::pi / 180;

json found_by(std::vector<std::string> words, int code = 0) {
  const TempFolder folder;
  const std::string file = folder.path("find.json").string();
  words.insert(words.begin(), "find");
  words.insert(words.end(), {"--json", file});
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, code) << run.out << run.err;
  return json::parse(contents(file));
}

/// A root of f between a and b, halved to rounding.
double root(const std::function<double(double)>& f, double a, double b) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (a + b);
    ((f(middle) > 0) == (f(a) > 0) ? a : b) = middle;
  }
  return a;
}

TEST(FindCommand, TheClampPressesWithTheForceThatIsWanted) {
  const json found =
      found_by({dataset("toggle_clamp"), "--vary", "spring.rubber.stiffness=200..800", "--for", "force.rubber = -700"});
  ASSERT_EQ(found["values"].size(), 1u);
  const json& one = found["values"][0];
  EXPECT_EQ(one["proved"], true);
  EXPECT_EQ(one["stability"], "stable");
  EXPECT_LT(one["radii"][0].get<double>(), 1e-10);
  // `poise solve` with that stiffness says the same.
  const TempFolder folder;
  const std::string file = folder.path("solve.json").string();
  char number[64];
  std::snprintf(number, sizeof number, "spring.rubber.stiffness=%.17g", one["numbers"][0].get<double>());
  EXPECT_EQ(run_poise({"solve", dataset("toggle_clamp"), "--set", number, "--show", "force.rubber", "--json", file})
                .exit_code,
            0);
  EXPECT_NEAR(json::parse(contents(file))["quantities"][0]["value"].get<double>(), -700.0, 1e-8);
}

// datasets/gas_lid.toml: the unstable equilibrium at 0.9226133824194724518 rad, computed with 50 digits.
TEST(FindCommand, ALidOpensByItselfFromAnAngleOn) {
  const json found = found_by({dataset("gas_lid"), "--vary", "angle.lid=20..80", "--for", "push.lid.nose.y = 0"});
  ASSERT_EQ(found["values"].size(), 1u);
  EXPECT_NEAR(found["values"][0]["numbers"][0].get<double>(), 0.9226133824194724518 / degree, 1e-11);
}

// The same from the force that drives it.
TEST(FindCommand, NothingDrivesALidAtItsEquilibrium) {
  const json found = found_by({dataset("gas_lid"), "--vary", "angle.lid=40..80", "--for", "force.lid = 0"});
  ASSERT_EQ(found["values"].size(), 1u);
  EXPECT_EQ(found["values"][0]["proved"], true);
  EXPECT_NEAR(found["values"][0]["numbers"][0].get<double>(), 0.9226133824194724518 / degree, 1e-11);
}

// Law of cosines, datasets/bike_suspension.toml.
TEST(FindCommand, TheTravelAtWhichASuspensionHasALeverage) {
  const double f = std::hypot(130, 120), s = std::hypot(60, 140), wheel = 440;
  // Angle at the pivot between frame's end and tab with the arm level.
  const double level = std::atan2(140, -60) - std::atan2(120, 130);
  const auto length = [&](double b) { return std::sqrt(f * f + s * s - 2 * f * s * std::cos(b)); };
  const auto leverage = [&](double b) {
    const double arm = b - level;  // its angle
    return -wheel * std::cos(arm) / (f * s * std::sin(b) / length(b));
  };
  const json found = found_by(
      {dataset("bike_suspension"), "--vary", "angle.arm=10..-20", "--for", "d(y.arm.axle)/d(length.shock) = -3.4"});
  const double b = root([&](double at) { return leverage(at) + 3.4; }, level + 10 * degree, level - 20 * degree);
  ASSERT_EQ(found["values"].size(), 1u) << found;
  EXPECT_EQ(found["values"][0]["proved"], true);
  EXPECT_NEAR(found["values"][0]["numbers"][0].get<double>(), (b - level) / degree, 1e-10);
}

// mu (sin a + mu cos a) = (1 + mu^2) (d / l) cos a, datasets/friction/leaning_ladder.toml.
TEST(FindCommand, TheLeastFrictionThatHoldsALadder) {
  const double a = 65 * degree, d = (12 * 9.81 * 2 + 784.8 * 3) / (12 * 9.81 + 784.8), l = 4;
  const double least = root(
      [&](double mu) { return mu * (std::sin(a) + mu * std::cos(a)) - (1 + mu * mu) * d / l * std::cos(a); }, 0, 1);
  const TempFolder folder;
  const std::string file = folder.path("hold.json").string();
  const ProgramRun run =
      run_poise({"hold", dataset("friction/leaning_ladder"), "--vary", "numbers.mu", "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const json range = json::parse(contents(file))["range"];
  EXPECT_NEAR(range["lower"]["value"].get<double>(), least, 1e-11);
  EXPECT_EQ(range["lower"]["proved"], true);
  EXPECT_EQ(range["upper"]["without_end"], true);
}

/// The quantities of these names at the values asked for, one row for each value.
std::vector<std::vector<double>> shown_on_path(std::vector<std::string> words, const std::vector<std::string>& names) {
  const TempFolder folder;
  const std::string file = folder.path("path.json").string();
  words.insert(words.begin(), "path");
  words.insert(words.end(), {"--json", file, "--show"});
  words.push_back(names[0] + "," + names[1]);
  const ProgramRun run = run_poise(words);
  EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
  std::vector<std::vector<double>> out;
  for (const json& at : json::parse(contents(file))["at"]) {
    std::vector<double>& row = out.emplace_back();
    for (const std::string& name : names) row.push_back(at["equilibria"][0]["measures"][name].get<double>());
  }
  return out;
}

// Links of equal length at the angle a from the ram's axis: the transmission angle is 90 deg - a, and
// dx/dy = -1 / (2 tan a) of the knee sideways by the ram.
TEST(CurvesOverTravel, KneePressHasTheTransmissionAngleOfItsLinks) {
  const auto rows = shown_on_path({dataset("knee_press"), "--vary", "angle.upper=70..5", "--at", "60,30,10"},
                                  {"transmission.lower.wrist", "d(x.upper.N)/d(travel.gib)"});
  const std::vector<double> angles{60, 30, 10};
  ASSERT_EQ(rows.size(), angles.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_NEAR(rows[k][0], 90 - angles[k], 1e-9);
    EXPECT_NEAR(std::abs(rows[k][1]), 1 / (2 * std::tan(angles[k] * degree)), 1e-11);
  }
}

// Law of cosines, datasets/bike_suspension.toml; the spring of 90 N/mm carries the wheel.
TEST(CurvesOverTravel, SuspensionHasTheLeverageOfTheLawOfCosines) {
  const auto rows =
      shown_on_path({dataset("bike_suspension"), "--vary", "length.shock=200..145", "--at", "200,170,145"},
                    {"d(y.arm.axle)/d(length.shock)", "push.arm.axle.y"});
  const double f = std::hypot(130, 120), s = std::hypot(60, 140);
  const double level = std::atan2(140, -60) - std::atan2(120, 130);
  const std::vector<double> lengths{200, 170, 145};
  ASSERT_EQ(rows.size(), lengths.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double b = std::acos((f * f + s * s - lengths[k] * lengths[k]) / (2 * f * s));
    const double leverage = -440 * std::cos(b - level) / (f * s * std::sin(b) / lengths[k]);
    EXPECT_NEAR(rows[k][0], leverage, 1e-10 * std::abs(leverage));
    // 90 N/mm times the compression, over the leverage, is what wheel and hand hold together.
    EXPECT_NEAR(rows[k][1], 90 * (200 - lengths[k]) / -leverage - 700, 1e-8);
  }
}

TEST(FindCommand, SaysWhatItCannotRead) {
  const auto refused = [](std::vector<std::string> words, const std::string& expected) {
    words.insert(words.begin(), {"find", dataset("toggle_clamp")});
    const ProgramRun run = run_poise(words);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find(expected), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  };
  refused({"--vary", "load.P=0..5", "--for", "force.rubber"}, "--for: expected \"QUANTITY = VALUE\"");
  refused({"--vary", "load.P=0..5", "--for", "force.rubbr = 3"}, "rubber");
  refused({"--vary", "load.Q=0..5", "--for", "force.rubber = 3"}, "--vary load.Q");
  refused({"--vary", "load.P=0..5"}, "--for");
  refused({"--vary", "load.P=0..5", "--vary", "gravity.y=-9..-10", "--for", "energy = 1"}, "as many --for as --vary");
  refused({"--vary", "load.P=0..5", "--for", "max(force.rubber) = 3"}, "belongs to a path");
  refused({"--vary", "angle.handle=90..95", "--for", "fold.load.P = 3"}, "fold");
}

TEST(FindCommand, AnswersWithTheNearestWhereThereIsNone) {
  const ProgramRun run =
      run_poise({"find", dataset("toggle_clamp"), "--vary", "load.P=0..30", "--for", "force.rubber = 700"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.out.find("the nearest is force.rubber = -"), std::string::npos) << run.out;
}

}  // namespace
}  // namespace poise::app_tests::find_command_test
