#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "model/planar.hpp"
#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::app_tests::design_path_command_test {
namespace {

using nlohmann::json;

constexpr double degree = M_PI / 180;

Vec2 place(const json& pair) { return {pair[0].get<double>(), pair[1].get<double>()}; }

/// The coupler point of a four-bar by its printed numbers: where circles about the crank's pin and the other pivot
/// meet.
Vec2 coupler_point(const json& linkage, double angle, int side) {
  const Vec2 a = place(linkage["input_pivot"]), b = place(linkage["output_pivot"]), p = place(linkage["point"]);
  const double crank = linkage["input"], coupler = linkage["coupler"], output = linkage["output"];
  const double px = a.x + crank * std::cos(angle), py = a.y + crank * std::sin(angle);
  const double dx = b.x - px, dy = b.y - py, d = std::hypot(dx, dy);
  const double along = (coupler * coupler - output * output + d * d) / (2 * d);
  const double across = side * std::sqrt(coupler * coupler - along * along);
  const double cx = (along * dx - across * dy) / (d * coupler), cy = (along * dy + across * dx) / (d * coupler);
  return {px + cx * p.x - cy * p.y, py + cy * p.x + cx * p.y};
}

TEST(DesignPathCommand, PrintedLinkagesPassTheNinePoints) {
  const TempFolder folder;
  const std::string file = folder.path("found.json").string(), scene = folder.path("found.toml").string();
  const ProgramRun run =
      run_poise({"design", dataset("nine_points_design"), "--json", file, "--scene", scene, "--starts", "150"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_NE(run.out.find("others are not excluded"), std::string::npos) << run.out;
  const json found = json::parse(contents(file));
  const std::vector<Vec2> points = {
      {1.1900588956, 2.4807129039},  {1.7721646341, 3.3852863112},  {1.3239148854, 3.7397521919},
      {0.4318848866, 3.5020242869},  {-0.3559237840, 2.7801638947}, {-0.8008957172, 1.9117488343},
      {-0.8537072763, 1.1988099283}, {-0.5094184768, 0.9012896304}, {0.1747125412, 1.3381291732}};
  EXPECT_TRUE(found["met"].get<bool>());
  ASSERT_EQ(found["linkages"].size(), found["through_all"].get<std::size_t>());
  for (const json& linkage : found["linkages"]) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double angle = linkage["input_angles"][i].get<double>() * degree;
      EXPECT_LT(norm(coupler_point(linkage, angle, linkage["closures"][i].get<int>()) - points[i]), 1e-8);
    }
  }
  // The cognates draw the same curve: each point is near one of theirs.
  for (const json& cognate : found["linkages"][0]["cognates"]) {
    for (const Vec2& p : points) {
      double nearest = 1e300;
      for (int k = 0; k < 20'000; ++k) {
        for (const int side : {1, -1}) {
          const double d = norm(coupler_point(cognate, 2 * M_PI * k / 20'000, side) - p);
          if (d < nearest) nearest = d;
        }
      }
      EXPECT_LT(nearest, 0.02);
    }
  }
  // The scene is the first of them, at the first point.
  EXPECT_TRUE(found["linkages"][0]["defect"].is_null());
  const Scene written = read_scene(scene);
  EXPECT_EQ(written.bodies.size(), 4U);
  const ProgramRun driven = run_poise({"kinematics", scene, "--drive", "input=0..360"});
  EXPECT_EQ(driven.exit_code, 0) << driven.out << driven.err;
  EXPECT_NE(driven.out.find("Driven through the whole range."), std::string::npos) << driven.out;
}

TEST(DesignPathCommand, ExitCodes) {
  const TempFolder folder;
  const std::string points = "[synthesis]\nkind = \"path\"\npoints = [[0,0],[1,1],[2,0],[3,1],[4,0]]\n";
  const auto run = [&](const std::string& text) {
    return run_poise({"design", folder.write("points.toml", points + text), "--starts", "20"});
  };
  // Five points with pivots of three places: least squares, which a limit of the error may refuse.
  const std::string timed = "crank_step = 20\npivots = [[0,-3],[4,-3]]\n";
  EXPECT_EQ(run(timed).exit_code, 0);
  const ProgramRun near = run(timed + "within_error = 1e-6\n");
  EXPECT_EQ(near.exit_code, 1);
  EXPECT_NE(near.out.find("better ones are not excluded"), std::string::npos) << near.out;
  EXPECT_EQ(run("within = [100, 100, 101, 101]\nlongest = 2\n").exit_code, 1);
  const ProgramRun wrong = run("longest = 0\n");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_EQ(std::count(wrong.err.begin(), wrong.err.end(), '\n'), 1) << wrong.err;
}

}  // namespace
}  // namespace poise::app_tests::design_path_command_test
