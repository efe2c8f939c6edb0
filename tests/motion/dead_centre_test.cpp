// Where drives meet dead centres, and where motions pass singular positions, against closed forms.

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "motion/simulate.hpp"
#include "tests/support/motions.hpp"

namespace poise::dead_centre_test {
namespace {

constexpr double pi = std::numbers::pi;

/// A crank of 0.1 m and a rod of 0.3 m that move a block; the crank begins at 1 rad.
std::string slider_crank(const std::string& more) {
  return R"(
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [0.1, 0] }
mass = 2
inertia = 0.05
[body.rod]
points = { A = [0, 0], B = [0.3, 0] }
mass = 1
center = [0.15, 0]
inertia = 0.01
[body.block]
points = { B = [0, 0] }
mass = 0.5
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "rod.A"]
[[pin]]
name = "B"
points = ["rod.B", "block.B"]
[[slide]]
name = "ram"
points = ["ground.O", "block.B"]
axis = [1, 0]
[start]
crank = 1
rod = -0.284
ram = 0.342
)" + more;
}

Motion moved_for(const MotionModel& model, const test::Release& release, double duration, double accuracy = 1e-10) {
  MotionOptions options;
  options.duration = duration;
  options.accuracy = accuracy;
  return simulate(model, test::released(model, release), options);
}

// The block that is drawn at 0.05 m/s meets the stretched position, 0.4 m.
TEST(DeadCentre, ASliderCrankThatIsDrivenAtTheSliderStopsThere) {
  const std::string drive = "[[drive]]\nname = \"winch\"\nslide = \"ram\"\nrate = 0.05\n";
  const MotionModel model(parse_scene(slider_crank(drive), "a.toml"));
  const Motion motion = moved_for(model, {}, 5.0);
  EXPECT_EQ(motion.status, MotionStatus::stuck);
  ASSERT_TRUE(motion.dead_centre) << motion.why;
  const double start = motion.trajectory.q[static_cast<std::size_t>(test::coordinate_of(model, "ram"))];
  EXPECT_NEAR(motion.dead_centre->time, (0.4 - start) / 0.05, 1e-8);
  EXPECT_LE(motion.trajectory.t.back(), motion.dead_centre->time);
  EXPECT_EQ(motion.dead_centre->text, "dead centre of the loop closed by \"B\": crank and rod are in line");
  EXPECT_EQ(motion.dead_centre->position, "crank = 0 rad, rod = 0 rad, ram = 0.4 m");
  EXPECT_NE(motion.why.find("it meets a dead centre of the loop closed by \"B\""), std::string::npos) << motion.why;
}

// A drive of the place of the block, which is no coordinate, says the same; it slows down by 0.01 m/s^2.
TEST(DeadCentre, AMeasureThatIsDrivenMeetsItToo) {
  const std::string drive = "[[drive]]\nname = \"winch\"\nx = \"block.B\"\nrate = 0.05\nacceleration = -0.01\n";
  const MotionModel model(parse_scene(slider_crank(drive), "a.toml"));
  const Motion motion = moved_for(model, {}, 5.0);
  ASSERT_TRUE(motion.dead_centre) << motion.why;
  const double start = motion.trajectory.q[static_cast<std::size_t>(test::coordinate_of(model, "ram"))];
  EXPECT_NEAR(motion.dead_centre->time, 5 - std::sqrt(25 - 200 * (0.4 - start)), 1e-8);
  EXPECT_NE(motion.dead_centre->text.find("\"winch\""), std::string::npos) << motion.dead_centre->text;
  EXPECT_NE(motion.dead_centre->position.find("ram = 0.4 m"), std::string::npos) << motion.dead_centre->position;
}

// The end of a crank that turns evenly has the place 0.1 cos(2 pi t + 0.4): so driven, it reaches the dead centres with
// finite rates, and goes on through them.
TEST(DeadCentre, APlaceThatIsDrivenAsATurningCrankMovesItTakesTheCrankThrough) {
  const std::string drive =
      "[[drive]]\nname = \"yoke\"\nx = \"crank.A\"\ntime = { sine = { amplitude = 0.1, frequency = 1, phase = 1.9708 } "
      "}\n";
  const MotionModel model(parse_scene(slider_crank(drive), "a.toml"));
  const Motion motion = moved_for(model, {}, 1.75);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const auto crank = static_cast<std::size_t>(test::coordinate_of(model, "crank"));
  const double start = motion.trajectory.q[crank];
  EXPECT_NEAR(start, 1.9708 - pi / 2, 1e-9);
  EXPECT_NEAR(test::q_at(motion, motion.trajectory.nodes() - 1)[crank], start + 2 * pi * 1.75, 1e-6);
  const std::vector<SingularPlace> places = singular_places(model, motion, 6);
  ASSERT_EQ(places.size(), 3U);
  EXPECT_NEAR(places[0].time, (pi - start) / (2 * pi), 1e-6);
  EXPECT_NE(places[0].branch.find("crank at 6.28319 rad/s"), std::string::npos) << places[0].branch;
  EXPECT_LT(motion.energy_error, 1e-6);
}

// The crank is a flywheel that nothing drives: it passes both dead centres of the block.
TEST(DeadCentre, ACrankIsCarriedThroughByItsInertia) {
  const MotionModel model(parse_scene(slider_crank(""), "a.toml"));
  const Motion motion = moved_for(model, {{}, {{"crank", 8.0}}}, 2.0);
  ASSERT_TRUE(motion.completed()) << motion.why;
  EXPECT_FALSE(motion.dead_centre);
  const auto crank = static_cast<std::size_t>(test::coordinate_of(model, "crank"));
  EXPECT_GT(test::q_at(motion, motion.trajectory.nodes() - 1)[crank], 1.0 + 4 * pi) << "it turned more than twice";
  EXPECT_LT(motion.energy_error, 1e-8);
}

/// A four-bar of which the crank, 0.1 m, turns wholly; coupler 0.35 m, rocker 0.25 m, ground 0.3 m.
constexpr const char* four_bar = R"(
[ground]
points = { O = [0, 0], C = [0.3, 0] }
[body.crank]
points = { O = [0, 0], A = [0.1, 0] }
mass = 1
inertia = 0.02
[body.coupler]
points = { A = [0, 0], B = [0.35, 0] }
mass = 1
inertia = 0.02
[body.rocker]
points = { C = [0, 0], B = [0.25, 0] }
mass = 1
inertia = 0.02
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "coupler.A"]
[[pin]]
name = "B"
points = ["coupler.B", "rocker.B"]
[[pin]]
name = "C"
points = ["ground.C", "rocker.C"]
[start]
crank = 1.2
coupler = 0.4
rocker = 1.2
)";

// The rocker can swing as far as crank and coupler reach: 0.45 m from O to B.
TEST(DeadCentre, AFourBarThatIsDrivenAtItsRockerStopsWhereCrankAndCouplerAreInLine) {
  const MotionModel model(parse_scene(
      std::string(four_bar) + "[[drive]]\nname = \"swing\"\nbodies = [\"ground\", \"rocker\"]\nrate = -0.5\n",
      "a.toml"));
  const Motion motion = moved_for(model, {}, 5.0);
  EXPECT_EQ(motion.status, MotionStatus::stuck);
  ASSERT_TRUE(motion.dead_centre) << motion.why;
  EXPECT_NE(motion.dead_centre->text.find("crank and coupler are in line"), std::string::npos)
      << motion.dead_centre->text;
  const auto rocker = static_cast<std::size_t>(test::coordinate_of(model, "rocker"));
  const double start = motion.trajectory.q[rocker];
  // Cosine rule: 0.45^2 = 0.3^2 + 0.25^2 + 2 0.3 0.25 cos(rocker).
  const double reached = std::acos((0.45 * 0.45 - 0.09 - 0.0625) / (2 * 0.3 * 0.25));
  EXPECT_NEAR(motion.dead_centre->time, (start - reached) / 0.5, 1e-8);
}

// A parallelogram passes the position in which all its links are in line, and keeps its cranks parallel.
TEST(DeadCentre, AParallelogramGoesOnOnItsBranch) {
  const MotionModel model(parse_scene(R"(
[units]
angle = "deg"
[ground]
points = { O = [0, 0], C = [0.4, 0] }
[body.crank]
points = { O = [0, 0], A = [0.2, 0] }
mass = 1
inertia = 0.02
[body.coupler]
points = { A = [0, 0], B = [0.4, 0] }
mass = 1
[body.rocker]
points = { C = [0, 0], B = [0.2, 0] }
mass = 1
inertia = 0.02
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "coupler.A"]
[[pin]]
name = "C"
points = ["ground.C", "rocker.C"]
[[pin]]
name = "B"
points = ["coupler.B", "rocker.B"]
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
rate = 90
[start]
crank = 40
coupler = 0
rocker = 40
)",
                                      "a.toml"));
  const Motion motion = moved_for(model, {}, 3.0);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const std::vector<SingularPlace> places = singular_places(model, motion, 4);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_NEAR(places.front().time, 140.0 / 90, 1e-6);
  EXPECT_NE(places.front().text.find("are in line"), std::string::npos) << places.front().text;
  EXPECT_NE(places.front().branch.find("rocker at 90 deg/s"), std::string::npos) << places.front().branch;
  const auto rocker = static_cast<std::size_t>(test::coordinate_of(model, "rocker"));
  EXPECT_NEAR(test::q_at(motion, motion.trajectory.nodes() - 1)[rocker], 310 * pi / 180, 1e-8);
}

// 1592 turns of a driven four-bar: joints stay closed to less than the error that is printed, however long it runs.
TEST(DeadCentre, GapsDoNotGrowInTenThousandSeconds) {
  const MotionModel model(parse_scene(
      std::string(four_bar) + "[[drive]]\nname = \"motor\"\nbodies = [\"ground\", \"crank\"]\nrate = 1\n", "a.toml"));
  constexpr double coarse = 1e-4;
  const Motion motion = moved_for(model, {}, 1e4, coarse);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const double error = difference(motion, moved_for(model, {}, 1e4, coarse / 10));
  EXPECT_LT(motion.gap, std::max(error, 1e-13)) << motion.gap_of;
  EXPECT_LT(motion.gap, 1e-12) << "of the mechanism's size, or rad";
  const auto crank = static_cast<std::size_t>(test::coordinate_of(model, "crank"));
  const std::vector<double> first = test::q_at(motion, 0), last = test::q_at(motion, motion.trajectory.nodes() - 1);
  EXPECT_NEAR(last[crank] - first[crank], 1e4, 1e-8);
}

// Without drive or loads the crank turns on freely by its inertia.
TEST(DeadCentre, NorDoThoseOfAFreeMotion) {
  const MotionModel model(parse_scene(four_bar, "a.toml"));
  constexpr double coarse = 1e-4;
  const test::Release release{{}, {{"crank", 1.0}}};
  const Motion motion = moved_for(model, release, 1e4, coarse);
  ASSERT_TRUE(motion.completed()) << motion.why;
  EXPECT_LT(motion.gap, 1e-12) << motion.gap_of;
}

}  // namespace
}  // namespace poise::dead_centre_test
