// Four-bars through poses as a whole, and the reader of their design files.
#include "design/synthesis/guidance.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "design/synthesis/read_synthesis.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/message_of.hpp"

namespace poise::guidance_test {
namespace {

/// The positions of a coupler, its frame turned against it, at rising angles of the input.
std::vector<BodyPosition> passed(const FourBar& linkage, double start, double step, int number) {
  constexpr double frame = 0.7;
  std::vector<BodyPosition> out;
  for (int k = 0; k < number; ++k) {
    const auto pose = pose_of(linkage, start + k * step, 1);
    if (!pose) return {};
    out.push_back({pose->point, pose->coupler_angle + frame});
  }
  return out;
}

TEST(Guidance, ForgottenFourBarsAreFoundAndPass) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> place(-2, 2), length(0.6, 3), angle(-3, 3);
  int tasks = 0;
  for (int task = 0; tasks < 200 && task < 2000; ++task) {
    const FourBar linkage{
        {place(random), place(random)}, {place(random), place(random)}, length(random), length(random), length(random),
        {place(random), place(random)}};
    const double start = angle(random);
    PoseTask asked;
    asked.positions = passed(linkage, start, 0.3, 5);
    bool closes = !asked.positions.empty();
    for (int k = 0; k <= 1000; ++k) closes = closes && pose_of(linkage, start + 1.2 * k / 1000, 1).has_value();
    if (!closes) continue;
    ++tasks;
    const Guidance found = guide(asked);
    ASSERT_TRUE(found.five.complete) << task;
    const auto same = std::find_if(found.four_bars.begin(), found.four_bars.end(), [&](const GuidingFourBar& f) {
      const bool as_it_was = norm(f.linkage.a - linkage.a) + norm(f.linkage.b - linkage.b) < 1e-5;
      const bool turned_round = norm(f.linkage.a - linkage.b) + norm(f.linkage.b - linkage.a) < 1e-5;
      return as_it_was || turned_round;
    });
    ASSERT_NE(same, found.four_bars.end()) << task;
    EXPECT_NEAR(same->linkage.coupler, linkage.coupler, 1e-5) << task;
    EXPECT_EQ(same->passage.defect, Defect::none) << task;
    EXPECT_GE(found.best, 0);
    EXPECT_LT(norm(same->linkage.point - linkage.point), same->linkage.a == linkage.a ? 1e-5 : INFINITY);
  }
  EXPECT_EQ(tasks, 200);
}

TEST(Guidance, BestOfACurveKeepsWhatWasAskedFor) {
  const FourBar linkage{{0, 0}, {2, 0}, 0.7, 1.8, 1.5, {0.9, 0.8}};
  PoseTask task;
  task.positions = passed(linkage, 0.4, 0.5, 4);
  task.wishes.kind = GrashofKind::crank_rocker;
  task.wishes.within = Rectangle{{-0.5, -0.5}, {2.5, 0.5}};
  const Guidance found = guide(task);
  ASSERT_TRUE(found.curve.complete);
  ASSERT_EQ(found.best, 0);
  const GuidingFourBar& best = found.four_bars.front();
  EXPECT_EQ(best.kind, GrashofKind::crank_rocker);
  EXPECT_TRUE(task.wishes.within->contains(best.linkage.a));
  EXPECT_TRUE(task.wishes.within->contains(best.linkage.b));
  for (std::size_t k = 0; k < task.positions.size(); ++k) {
    const auto pose = pose_of(best.linkage, best.positions[k].angle, best.positions[k].closure);
    ASSERT_TRUE(pose);
    EXPECT_LT(norm(pose->point - task.positions[k].at), 1e-12);
  }
  // The linkage that was forgotten is among those that were asked for by their pivots.
  task.near = {{0.01, 0.02}, {2.01, -0.01}};
  const Guidance chosen = guide(task);
  ASSERT_EQ(chosen.four_bars.size(), 1u);
  EXPECT_LT(norm(chosen.links[0].fixed - linkage.a), 0.03);
  EXPECT_LT(norm(chosen.links[1].fixed - linkage.b), 0.03);
}

TEST(Guidance, WrongFilesAreRefusedInOneLine) {
  const app_tests::TempFolder folder;
  const auto message = [&](const std::string& lines) {
    const std::string file = folder.write("wrong_design.toml", "[synthesis]\n" + lines);
    return test::message_of([&] { read_synthesis(file); });
  };
  const auto expect = [&](const std::string& lines, const std::string& part) {
    const std::string found = message(lines);
    EXPECT_NE(found.find(part), std::string::npos) << found;
    EXPECT_NE(found.find("wrong_design.toml:"), std::string::npos) << found;
  };
  const std::string three = "kind = \"poses\"\nposes = [[0,0,0],[1,0,20],[2,1,50]]\n";
  const std::string function = "kind = \"function\"\nfunction = \"x^2\"\nrange = [1, 2]\n";
  expect("kind = \"pose\"\n", "did you mean \"poses\"?");
  expect("kind = \"poses\"\nposes = [[0,0,0],[1,0,20]]\n", "expected 3, 4 or 5 poses [X, Y, ANGLE], found 2");
  expect("kind = \"poses\"\nposes = [[0,0,0],[1,0],[2,1,50]]\n", "expected three finite numbers [X, Y, ANGLE]");
  expect("kind = \"poses\"\nposes = [[0,0,0],[1,0,20],[0,0,360]]\n", "found the same as pose 1");
  expect("kind = \"poses\"\nposes = [[0,0,5],[1,0,5],[2,1,5]]\n", "expected poses that turn");
  expect(three, "two points in pins and pivots together, found 0");
  expect(three + "pins = [[0,0],[1,1]]\nnear = [[0,0],[1,1]]\n", "expected it with 4 poses only, found 3");
  expect(three + "pins = [[0,0],[1,1]]\nwithin = [1,0,0,1]\n", "expected a rectangle");
  expect(three + "pins = [[0,0],[1,1]]\ngrashof = \"crank\"\n", "crank-rocker");
  expect(function + "input_turn = 0\noutput_turn = 60\n", "expected a turn of at most 360 degrees other than 0");
  expect(function + "input_turn = 90\noutput_turn = 60\nat = [1, 1.5, 2]\n", "expected 5, for neither");
  expect(function + "input_turn = 90\noutput_turn = 60\nat = [1, 1.2, 1.5, 1.8, 3]\n", "expected places in the range");
  expect("kind = \"function\"\nfunction = \"y^2\"\nrange = [1, 2]\n", "synthesis.function");
  expect("kind = \"function\"\npairs = [[0,0],[1,2],[3,4]]\ninput_start = 3\n", "expected 4, for one of");
  expect("kind = \"function\"\npairs = [[0,0],[1,2],[1,4]]\ninput_start = 3\noutput_start = 1\n",
         "numbers 2 and 3 the same");
}

}  // namespace
}  // namespace poise::guidance_test
