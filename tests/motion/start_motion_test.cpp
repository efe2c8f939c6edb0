#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/simulate.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/vector_mechanics.hpp"

namespace poise::start_motion_test {
namespace {

std::string complaint(const MotionModel& model, const test::Release& release) {
  try {
    test::released(model, release);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

double value(const MotionModel& model, const std::vector<double>& values, const std::string& name) {
  return values[static_cast<std::size_t>(test::coordinate_of(model, name))];
}

void expect_closed(const MotionModel& model, const std::vector<double>& q) {
  const auto poses = model.poses(model.from_si(q));
  for (std::size_t j = 0; j < model.scene().joints.size(); ++j) {
    const int travel = model.layout().travel[j];
    const double along = travel < 0 ? 0.0 : q[static_cast<std::size_t>(travel)];
    EXPECT_LT(norm(test::gap(model.scene(), static_cast<int>(j), along, poses)), 1e-14);
  }
}

/// A crank-rocker, shortest link 0.3 m: s + l = 1.3 m < 1.5 m of the other two, so that the crank turns round.
Scene crank_rocker(double rocker, double start) {
  return parse_scene(fmt::format(R"(
[ground]
points = {{ O = [0, 0], C = [1, 0] }}
[body.crank]
points = {{ O = [0, 0], A = [0.3, 0] }}
[body.coupler]
points = {{ A = [0, 0], B = [0.9, 0] }}
[body.rocker]
points = {{ C = [0, 0], B = [{}, 0] }}
mass = 1
[body.arm]
points = {{ B = [0, 0] }}
mass = 0.5
center = [0.2, 0]
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.A", "coupler.A"]
[[pin]]
points = ["coupler.B", "rocker.B"]
[[pin]]
points = ["ground.C", "rocker.C"]
[[pin]]
points = ["coupler.B", "arm.B"]
[[drive]]
bodies = ["ground", "crank"]
start = {}
[start]
crank = 0.3
coupler = 0.5
rocker = 1.8
arm = -1.5
)",
                                 rocker, start),
                     "crank_rocker");
}

TEST(StartMotion, BringsAnyCoordinateToItsPlaceAndRate) {
  const MotionModel model(test::four_bar_with_everything());
  // The rocker is no independent coordinate; 2.3 rad is half a radian from the assembled start.
  const MotionState start = test::released(model, {{{"rocker", 2.3}}, {{"coupler", -0.7}}});
  expect_closed(model, start.q);
  EXPECT_NEAR(value(model, start.q, "rocker"), 2.3, 1e-13);
  EXPECT_NEAR(value(model, start.v, "coupler"), -0.7, 1e-13);
}

// An encoder counts turns: 40 of them are 2513 steps of Newton's method.
TEST(StartMotion, TurnsABodyManyTimes) {
  const MotionModel model(crank_rocker(0.6, 0.3));
  const double turns = 40 * 2 * M_PI;
  const MotionState start = test::released(model, {{{"arm", turns}}});
  EXPECT_NEAR(value(model, start.q, "arm"), turns, 1e-12);
  expect_closed(model, start.q);
}

TEST(StartMotion, LeavesOtherFreedomsAlone) {
  const MotionModel model(test::quick_return());
  const MotionState plain = test::released(model, {});
  const MotionState start = test::released(model, {{{"rail", 0.31}}, {{"rail", 0.2}}});
  expect_closed(model, start.q);
  EXPECT_NEAR(value(model, start.q, "rail"), 0.31, 1e-14);
  EXPECT_NEAR(value(model, start.q, "crank"), value(model, plain.q, "crank"), 1e-14);
  EXPECT_NEAR(value(model, start.v, "rail"), 0.2, 1e-14);
  EXPECT_NEAR(value(model, start.v, "crank"), 0.0, 1e-14);
  for (double v : plain.v) EXPECT_EQ(v, 0.0);
}

TEST(StartMotion, GivesDrivesTheirStartAndRate) {
  const MotionModel model(test::driven_five_bar());
  const MotionState start = test::released(model, {});
  expect_closed(model, start.q);
  // rate + amplitude 2 pi frequency cos(phase)
  EXPECT_NEAR(value(model, start.v, "crank"), 2 + 0.3 * 2 * M_PI * 0.8 * std::cos(0.4), 1e-13);
  EXPECT_NEAR(value(model, start.v, "track"), 0.08 * 2 * M_PI * 0.7, 1e-13);
  Scene scene = test::driven_five_bar();
  scene.drives[0].start = 0.65;
  const MotionModel moved(scene);
  EXPECT_NEAR(value(moved, test::released(moved, {}).q, "crank"), 0.65, 1e-14);
}

// The rocker of a crank-rocker stays on one side of the line from C to A: the sign of (A - C) x (B - C) names its
// branch.
TEST(StartMotion, DrivesFarAndStaysInTheBranchOfAssembly) {
  for (const double turn : {-7.5, -3.0, 1.2, 4.5, 6.0, 19.0}) {
    const MotionModel model(crank_rocker(0.6, turn));
    const MotionState start = test::released(model, {});
    expect_closed(model, start.q);
    const double crank = value(model, start.q, "crank"), rocker = value(model, start.q, "rocker");
    EXPECT_NEAR(crank, turn, 1e-13);
    EXPECT_NEAR(value(model, start.q, "arm"), -1.5, 1e-13) << "free, and left alone";
    const double ax = 0.3 * std::cos(crank) - 1, ay = 0.3 * std::sin(crank);
    EXPECT_LT(ax * std::sin(rocker) - ay * std::cos(rocker), 0.0) << turn;
    EXPECT_GT(std::sin(rocker), 0.0) << turn;
  }
  // 0.9 + 0.35 < 1 + 0.3: the crank cannot pass pi - 0.25 or so, where coupler and rocker are in line.
  const MotionModel stuck(crank_rocker(0.35, 4.5));
  EXPECT_NE(complaint(stuck, {}).find("cannot reach the start values of its drives"), std::string::npos);
}

TEST(StartMotion, RefusesWhatTheMechanismCannotHave) {
  const MotionModel four_bar(test::four_bar_with_everything());
  // The rocker of this crank-rocker swings between 1.41 and 2.36 rad only.
  EXPECT_NE(complaint(four_bar, {{{"rocker", 3.5}}, {}})
                .find("expected places of rocker that the mechanism can have at once"),
            std::string::npos)
      << complaint(four_bar, {{{"rocker", 3.5}}, {}});
  EXPECT_NE(complaint(four_bar, {{{"crank", 1.2}, {"rocker", 1.5}}, {}}).find("places of crank, rocker"),
            std::string::npos);
  EXPECT_NE(complaint(four_bar, {{}, {{"crank", 1.0}, {"rocker", 1.0}}})
                .find("expected rates of crank, rocker that the mechanism can have at once"),
            std::string::npos);
  const MotionModel driven(test::driven_five_bar());
  EXPECT_NE(complaint(driven, {{}, {{"crank", 0.0}}}).find("rates of crank"), std::string::npos);
}

TEST(StartMotion, RefusesToReleaseWhatDrivesCarry) {
  const MotionModel wheel(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0] }
inertia = 3
[[pin]]
points = ["ground.O", "wheel.O"]
[[drive]]
bodies = ["ground", "wheel"]
start = 0.2
rate = 0.5
)",
                                      "wheel"));
  for (const test::Release& release : {test::Release{{{"wheel", 0.3}}, {}}, test::Release{{}, {{"wheel", 0.6}}}}) {
    EXPECT_NE(complaint(wheel, release)
                  .find("no degree of freedom is left to release; leave out the release of wheel, or a drive"),
              std::string::npos)
        << complaint(wheel, release);
  }
  EXPECT_EQ(complaint(wheel, {{{"wheel", 0.2}}, {{"wheel", 0.5}}}), "no complaint");
}

TEST(StartMotion, RefusesDrivesThatCannotBegin) {
  Scene scene = test::driven_five_bar();
  scene.drives[1].start = 9.0;
  const MotionModel model(scene);
  EXPECT_NE(complaint(model, {}).find("drives"), std::string::npos) << complaint(model, {});
}

}  // namespace
}  // namespace poise::start_motion_test
