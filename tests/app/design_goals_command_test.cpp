// `poise design` of files with goals, through the command line.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/run_poise.hpp"

namespace poise::app_tests::design_goals_command_test {
namespace {

using nlohmann::json;

/// The wall bed of datasets/wall_bed.toml by its closed form, with the stiffness and the free length of its spring.
struct Bed {
  double stiffness = 0.0, free_length = 0.0;

  /// The spring's ends, from the pivot: one fixed, the other turned with the bed.
  static constexpr double fixed_x = 0.30, fixed_y = -0.32, x = -0.16, y = -0.05;
  static constexpr double mass = 38, gravity = 9.81, center_x = 0.95, center_y = 0.02;

  double tension(double angle) const { return stiffness * (length(angle) - free_length); }
  static double length(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return std::hypot(c * x - s * y - fixed_x, s * x + c * y - fixed_y);
  }
  /// Half of the torque that holds the bed.
  double force(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    const double dx = -s * x - c * y, dy = c * x - s * y;
    const double by_angle = -(fixed_x * dx + fixed_y * dy) / length(angle);
    return (mass * gravity * (c * center_x - s * center_y) + tension(angle) * by_angle) / 2;
  }
};

Bed found_bed(const json& answer) {
  return {answer["numbers"]["spring.balance.stiffness"]["value"],
          answer["numbers"]["spring.balance.free_length"]["value"]};
}

/// A design of the bed's spring with these goals.
std::string bed_design(const std::string& goals) {
  return "scene = \"" + dataset("wall_bed") +
         "\"\n[variables]\n\"spring.balance.stiffness\" = [5000, 30000]\n"
         "\"spring.balance.free_length\" = [0.2, 0.4]\n" +
         goals;
}

constexpr double degree = std::numbers::pi / 180;

TEST(DesignForGoals, NumbersMeetTheClosedForm) {
  const TempFolder folder;
  const std::string scene = folder.path("found.toml").string(), file = folder.path("o.json").string();
  const ProgramRun run = run_poise({"design", dataset("wall_bed_design"), "--scene", scene, "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const json answer = json::parse(contents(file)), goal = answer["goals"][0];
  EXPECT_EQ(answer["proved"], answer["points"]);
  const Bed bed = found_bed(answer);
  double least = 1e300, most = -1e300;
  for (int k = 0; k <= 9000; ++k) {
    const double force = bed.force(k * 0.01 * degree);
    least = std::min(least, force);
    most = std::max(most, force);
  }
  EXPECT_LE(most, 25);
  EXPECT_GE(least, -25);
  EXPECT_NEAR(goal["most"].get<double>(), most, 1e-5);
  EXPECT_NEAR(goal["least"].get<double>(), least, 1e-5);
  EXPECT_NEAR(goal["margin"].get<double>(), std::min(25 - most, 25 + least), 1e-5);
  EXPECT_NEAR(goal["before_most"].get<double>(), (Bed{9000, 0.28}.force(0)), 1e-5);
  // The scene written is the one that was found, with all else as it was.
  const ProgramRun solved = run_poise({"path", scene, "--vary", "angle.bed=0..90", "--at", "30", "--json", file});
  ASSERT_EQ(solved.exit_code, 0) << solved.out << solved.err;
  EXPECT_NEAR(json::parse(contents(file))["at"][0]["equilibria"][0]["effort"].get<double>(), 2 * bed.force(30 * degree),
              1e-6);
}

TEST(DesignForGoals, NamesTheGoalsThatConflict) {
  const TempFolder folder;
  const std::string file = folder.path("o.json").string();
  const std::string at = "[[goal]]\nof = \"force.drive / 2\"\nalong = \"angle.bed\"\nat = ";
  const std::string design = folder.write(
      "design.toml",
      bed_design("[[goal]]\nof = \"force.drive / 2\"\nalong = \"angle.bed\"\nover = [0, 90]\nleast = -25\nmost = 25\n" +
                 at + "0\nleast = 15\n" + at + "45\nmost = -10\n" + at + "90\nmost = -5\n"));
  const ProgramRun run = run_poise({"design", design, "--starts", "20", "--json", file});
  EXPECT_EQ(run.exit_code, 1) << run.err;
  const json answer = json::parse(contents(file));
  EXPECT_EQ(answer["status"], "not met");
  ASSERT_EQ(answer["conflict"].size(), 3u);
  for (const int k : {0, 1, 2, 3}) EXPECT_EQ(answer["goals"][k]["conflicts"], k < 3) << k;
  EXPECT_NE(run.out.find("that no numbers meet the goals is not proved"), std::string::npos) << run.out;
  // The closed form says that no stiffness and free length within their ranges keep these three.
  for (double stiffness = 5000; stiffness <= 30000; stiffness += 25) {
    for (double free_length = 0.2; free_length <= 0.4; free_length += 2.5e-4) {
      const Bed bed{stiffness, free_length};
      const bool keeps = bed.force(0) >= 15 && bed.force(45 * degree) <= -10 && bed.force(60 * degree) >= -25 &&
                         bed.force(75 * degree) >= -25 && bed.force(90 * degree) >= -25;
      ASSERT_FALSE(keeps) << stiffness << ' ' << free_length;
    }
  }
}

TEST(DesignForGoals, TradesOneAimForTheOther) {
  const TempFolder folder;
  const std::string file = folder.path("o.json").string();
  const std::string design = folder.write(
      "design.toml",
      bed_design("[[goal]]\nof = \"force.drive / 2\"\nalong = \"angle.bed\"\nover = [0, 90]\naim = \"flat\"\n"
                 "[[goal]]\nof = \"force.balance\"\nalong = \"angle.bed\"\nat = 0\naim = \"least\"\n"));
  const ProgramRun run = run_poise({"design", design, "--trade-off", "5", "--json", file});
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const json points = json::parse(contents(file))["trade_off"];
  ASSERT_EQ(points.size(), 5u);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Bed bed{points[k]["numbers"][0], points[k]["numbers"][1]};
    double least = 1e300, most = -1e300;
    for (int i = 0; i <= 900; ++i) {
      least = std::min(least, bed.force(i * 0.1 * degree));
      most = std::max(most, bed.force(i * 0.1 * degree));
    }
    // The aims are those of the positions of the search, between which extremes are a little larger.
    const double first = points[k]["first"];
    EXPECT_LE(first, most - least + 1e-5) << k;
    EXPECT_GE(first, 0.97 * (most - least)) << k;
    EXPECT_NEAR(points[k]["second"].get<double>(), bed.tension(0), 1e-5) << k;
    if (k == 0) continue;
    EXPECT_GT(points[k]["first"], points[k - 1]["first"]) << k;
    EXPECT_LT(points[k]["second"], points[k - 1]["second"]) << k;
  }
}

}  // namespace
}  // namespace poise::app_tests::design_goals_command_test
