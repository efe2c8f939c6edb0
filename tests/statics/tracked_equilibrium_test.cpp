#include "statics/tracking/tracked_equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "statics/model/singular_configuration.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/hanging_chain.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::tracked_equilibrium_test {
namespace {

using Kind = Transition::Kind;

// A rod of 1 m on a pin, with its mass at the end and a force there.
Scene pendulum() {
  return parse_scene(R"(
gravity = [0, -10]
[units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], tip = [1, 0] }
mass = 1
center = [1, 0]
[[pin]]
name = "O"
points = ["ground.O", "rod.O"]
[[force]]
name = "pull"
at = "rod.tip"
vector = [0, 0]
[start]
rod = -90
)",
                     "pendulum");
}

// A lever of 2 m against a torsion spring of 3 N m / rad, free at angle zero.
Scene lever() {
  return parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], tip = [2, 0] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[torsion_spring]]
name = "spring"
bodies = ["ground", "lever"]
stiffness = 3
[[stop]]
name = "end"
bodies = ["ground", "lever"]
max = 1.2
)",
                     "lever");
}

// Two arms of 1 m, a mass of 2 kg in the middle of the first and of 1 kg at the end of the second.
Scene two_arms() {
  return parse_scene(R"(
gravity = [0, -10]
[units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.first]
points = { O = [0, 0], A = [1, 0] }
mass = 2
center = [0.5, 0]
[body.second]
points = { A = [0, 0], tip = [1, 0] }
mass = 1
center = [1, 0]
[[pin]]
name = "O"
points = ["ground.O", "first.O"]
[[pin]]
name = "A"
points = ["first.A", "second.A"]
[start]
first = -90
second = -90
)",
                     "two arms");
}

Scene slider_crank() {
  return parse_scene(R"(
[units]
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [1, 0] }
[body.rod]
points = { A = [0, 0], C = [2, 0] }
[body.block]
points = { C = [0, 0] }
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "rod.A"]
[[pin]]
name = "C"
points = ["rod.C", "block.C"]
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[torsion_spring]]
name = "holder"
bodies = ["ground", "crank"]
stiffness = 1
free_angle = 40
[start]
crank = 40
rod = -20
rail = 2.6
)",
                     "slider crank");
}

// Twenty links of 0.1 m between points 1.6 m apart.
Scene chain() { return parse_scene(test::hanging_chain(20), "chain"); }

Vec2 place_of(const TrackedEquilibrium& live, PointRef point) {
  return live.poses()[static_cast<std::size_t>(point.body)].world(live.scene().local(point));
}

double apart(const BodyPoses& a, const BodyPoses& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    out = std::max({out, std::abs(a[i].angle - b[i].angle), norm(a[i].origin - b[i].origin)});
  }
  return out;
}

TEST(TrackedEquilibrium, FollowsAPendulumWithItsLoad) {
  TrackedEquilibrium live(pendulum());
  for (int k = 1; k <= 20; ++k) {
    Scene wanted = live.scene();
    wanted.forces[0].vector = {1.5 * k, 0.5 * k};
    const Transition way = live.change(wanted);
    EXPECT_EQ(way.kind, Kind::followed);
    ASSERT_TRUE(live.equilibrium().found());
    EXPECT_NEAR(live.poses()[1].angle, std::atan2(0.5 * k - 10.0, 1.5 * k), 1e-12);
  }
}

TEST(TrackedEquilibrium, FollowsSeveralNumbersTogether) {
  TrackedEquilibrium live(pendulum());
  Scene wanted = live.scene();
  wanted.forces[0].vector = {30.0, 0.0};
  wanted.bodies[1].mass = 4.0;
  wanted.gravity = {0.0, -5.0};
  EXPECT_EQ(live.change(wanted).kind, Kind::followed);
  EXPECT_NEAR(live.poses()[1].angle, std::atan2(-20.0, 30.0), 1e-12);
  EXPECT_EQ(live.change(wanted).kind, Kind::none);
}

// A block on a spring of 100 N/m, and on a rope of 300 N/m that is tight from 0.01 m on.
TEST(TrackedEquilibrium, TellsThatARopeComesTight) {
  TrackedEquilibrium live(parse_scene(R"(
[ground]
points = { O = [0, 0], L = [-1, 0] }
[body.block]
points = { C = [0, 0] }
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[spring]]
name = "spring"
points = ["ground.L", "block.C"]
stiffness = 100
free_length = 1
[[spring]]
name = "rope"
points = ["ground.L", "block.C"]
stiffness = 300
free_length = 1.01
acts = "tension"
[[force]]
name = "P"
at = "block.C"
vector = [0.5, 0]
)",
                                      "block"));
  Scene wanted = live.scene();
  wanted.forces[0].vector = {2.0, 0.0};
  const Transition way = live.change(wanted);
  EXPECT_EQ(way.kind, Kind::followed);
  EXPECT_EQ(way.passed, std::vector<std::string>{"\"rope\" acts"});
  EXPECT_NEAR(live.poses()[1].origin.x, 0.01 + 1.0 / 400.0, 1e-12);
}

// Two stops 0.2 m apart, and nothing else on a rail: where the load turns it moves to the other one.
TEST(TrackedEquilibrium, MovesAtOnceWhereNothingHoldsIt) {
  TrackedEquilibrium live(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[stop]]
name = "ends"
slide = "rail"
min = -0.1
max = 0.1
[[force]]
name = "P"
at = "block.C"
vector = [1, 0]
)",
                                      "block"));
  ASSERT_NEAR(live.poses()[1].origin.x, 0.1, 1e-12);
  Scene wanted = live.scene();
  wanted.forces[0].vector = {-1.0, 0.0};
  const Transition way = live.change(wanted);
  EXPECT_TRUE(way.kind == Kind::snapped || way.kind == Kind::settled) << to_string(way.kind);
  ASSERT_FALSE(way.courses.empty());
  EXPECT_NEAR(way.courses.front().poses.front()[1].origin.x, 0.1, 1e-6);
  EXPECT_NEAR(live.poses()[1].origin.x, -0.1, 1e-12);
}

TEST(TrackedEquilibrium, SnapsAtTheFoldToWhereThePathLands) {
  const Scene toggle = read_scene(test::dataset("von_mises_toggle.toml"));
  TrackedEquilibrium live(toggle);
  Scene wanted = live.scene();
  wanted.forces[0].vector = {0.0, -42.9};  // the fold is at 42.914325731224687
  EXPECT_EQ(live.change(wanted).kind, Kind::followed);
  EXPECT_GT(live.poses()[1].origin.y, 0.277880091075164758518);
  wanted.forces[0].vector = {0.0, -43.0};
  const Transition way = live.change(wanted);
  EXPECT_EQ(way.kind, Kind::snapped);
  ASSERT_EQ(way.courses.size(), 1u);
  EXPECT_EQ(way.why, "it snaps at load.P = 42.9143 N, where the stable equilibrium ends");
  EXPECT_NEAR(way.courses[0].poses.front()[1].origin.y, 0.277880091075164758518, 1e-4);

  PathOptions options{.follow = PathOptions::Follow::load};
  const VariedScene varied(toggle, "load.P", 21.0, 43.0);
  const Path found = path(varied, options);
  const PathPoint& last = found.branches.back().points.back();
  EXPECT_LT(apart(live.poses(), varied.model_at(varied.to())->poses(last.x)), 1e-9);
  EXPECT_LT(live.poses()[1].origin.y, -0.5);
}

// A knee on a rail is dragged as far as it goes, where its end can hardly move, and comes back.
TEST(TrackedEquilibrium, ComesBackFromWhereAPointCannotMove) {
  TrackedEquilibrium live(parse_scene(R"(
[units]
angle = "deg"
[ground]
points = { A = [0, 0], D = [2, 0] }
[body.left]
points = { A = [0, 0], B = [1, 0] }
[body.right]
points = { B = [0, 0], D = [1.5, 0] }
[body.block]
points = { D = [0, 0] }
[[pin]]
name = "A"
points = ["ground.A", "left.A"]
[[pin]]
name = "B"
points = ["left.B", "right.B"]
[[pin]]
name = "D"
points = ["right.D", "block.D"]
[[slide]]
name = "rail"
points = ["ground.A", "block.D"]
axis = [1, 0]
[[torsion_spring]]
name = "spring"
bodies = ["ground", "left"]
stiffness = 1
free_angle = 50
[start]
left = 50
right = -30
rail = 2
)",
                                      "knee"));
  const PointRef end{3, 0};
  live.drag(end, {3.0, 0.0});
  const double stretched = place_of(live, end).x;
  EXPECT_GT(stretched, 2.49);
  for (const double x : {3.0, 2.7, 2.4, 2.2}) live.drag(end, {x, 0.0});
  EXPECT_NEAR(place_of(live, end).x, 2.2, 1e-9);
  EXPECT_TRUE(live.equilibrium().found());
}

TEST(TrackedEquilibrium, TheHandFeelsTheSpringOfALever) {
  TrackedEquilibrium live(lever());
  const PointRef tip{1, 1};
  for (int k = 1; k <= 10; ++k) {
    const double angle = 0.1 * k;
    EXPECT_EQ(live.drag(tip, 2.0 * unit(angle)).kind, Kind::followed);
    ASSERT_TRUE(live.equilibrium().found());
    EXPECT_NEAR(live.poses()[1].angle, angle, 1e-9);
    EXPECT_NEAR(cross(2.0 * unit(angle), live.force_of_hand()), 3.0 * live.poses()[1].angle, 1e-9);
  }
  EXPECT_EQ(live.release().kind, Kind::settled);
  EXPECT_NEAR(live.poses()[1].angle, 0.0, 1e-12);
  EXPECT_EQ(live.release().kind, Kind::none);
}

TEST(TrackedEquilibrium, TheHandCarriesWhatTwoArmsDoNot) {
  TrackedEquilibrium live(two_arms());
  const PointRef tip{2, 1};
  for (const Vec2 target : {Vec2{0.3, -1.7}, Vec2{0.9, -1.2}, Vec2{1.1, 0.4}}) {
    EXPECT_EQ(live.drag(tip, target).kind, Kind::followed);
    ASSERT_TRUE(live.equilibrium().found());
    EXPECT_LT(norm(place_of(live, tip) - target), 1e-9);
    const Vec2 a = unit(live.poses()[1].angle), b = unit(live.poses()[2].angle);
    const double along_second = 0.5 * a.x * 20.0 / cross(a, b);
    const Vec2 force = Vec2{0.0, 10.0} + along_second * b;
    EXPECT_LT(norm(live.force_of_hand() - force), 1e-8);
  }
}

TEST(TrackedEquilibrium, AStopHoldsTheHandUp) {
  TrackedEquilibrium live(lever());
  const Transition way = live.drag({1, 1}, 2.0 * unit(1.8));
  EXPECT_EQ(way.kind, Kind::blocked);
  EXPECT_NE(way.why.find("\"end\""), std::string::npos) << way.why;
  EXPECT_NEAR(live.poses()[1].angle, 1.2, 2e-7);
  EXPECT_TRUE(live.equilibrium().found());
}

TEST(TrackedEquilibrium, APointStaysAtTheEndOfItsWay) {
  TrackedEquilibrium live(slider_crank());
  const Transition way = live.drag({3, 0}, {5.0, 0.0});
  EXPECT_TRUE(way.kind == Kind::blocked || way.kind == Kind::followed);
  EXPECT_NEAR(place_of(live, {3, 0}).x, 3.0, 1e-5);
  EXPECT_GT(live.poses()[1].angle, 0.0);
  EXPECT_TRUE(live.equilibrium().found());
}

// Eight links of 0.1 m lead to the point: it comes next to the circle of 0.8 m that these can reach, in the direction
// of the hand, though no drag tries more steps than it may.
TEST(TrackedEquilibrium, AChainIsPulledBeyondItsReachInDragsOfBoundedWork) {
  constexpr DragLimits limits{.proved_steps = 16, .near_enough = 5e-4};
  const PointRef point{8, 1};
  const auto pulled = [&](int& drags) {
    TrackedEquilibrium live(chain());
    for (drags = 0; drags < 60;) {
      const Transition way = live.drag(point, 2.0 * unit(-0.5), limits);
      ++drags;
      EXPECT_LE(way.proved_steps, limits.proved_steps + 2);
      EXPECT_TRUE(live.equilibrium().found()) << live.equilibrium().why;
      EXPECT_LT(norm(place_of(live, point)), 0.8);
      if (!way.unfinished) break;
      EXPECT_EQ(way.kind, Kind::followed) << drags;
    }
    return live;
  };
  int drags = 0, again = 0;
  const TrackedEquilibrium live = pulled(drags);
  EXPECT_GT(drags, 1);
  EXPECT_LT(drags, 60);
  EXPECT_LT(norm(place_of(live, point) - 0.8 * unit(-0.5)), 0.01);
  const TrackedEquilibrium twin = pulled(again);
  EXPECT_EQ(drags, again);
  EXPECT_EQ(apart(live.poses(), twin.poses()), 0.0);
}

// Where a place can be reached limits change nothing in the end.
TEST(TrackedEquilibrium, DragsOfBoundedWorkComeToWhereOneWithoutLimitsDoes) {
  const PointRef point{8, 1};
  TrackedEquilibrium live(chain()), free(chain());
  const Vec2 place{0.5, -0.2};
  ASSERT_EQ(free.drag(point, place).kind, Kind::followed);
  bool is_there = false;
  for (int drags = 0; drags < 60 && !is_there; ++drags)
    is_there = !live.drag(point, place, {.proved_steps = 3, .near_enough = 5e-4}).unfinished;
  EXPECT_TRUE(is_there);
  EXPECT_LT(norm(place_of(live, point) - place), 1e-9);
  EXPECT_LT(apart(live.poses(), free.poses()), 1e-6);
}

// A parallelogram that hangs straight: a point can be held in one direction there, and in two a little beside it.
TEST(TrackedEquilibrium, TheHandIsHeldInTheDirectionsThatItsStopsHave) {
  const Scene scene = read_scene(test::dataset("three_motor_robot.toml"));
  const PointRef point{3, 0};
  ASSERT_EQ(scene.name_of(point), "rod.L");
  for (int k = 0; k < 12; ++k) {
    TrackedEquilibrium live(scene);
    live.drag(point, place_of(live, point) + 0.1 * unit(k * M_PI / 6), {.settling_steps = 0, .near_enough = 1e-4});
    ASSERT_TRUE(live.equilibrium().found()) << k;
    EXPECT_EQ(live.scene_with_hand().stops.size(), scene.stops.size() + live.hand_stops()) << k;
    // Nothing else holds the point: what the hand exerts balances the bodies.
    TrackedEquilibrium again(started_at(live.scene_with_hand(), live.poses()));
    EXPECT_LT(apart(again.poses(), live.poses()), 1e-6) << k;
  }
}

TEST(TrackedEquilibrium, AnArmThatIsDraggedBeyondItsReachKeepsItsBend) {
  TrackedEquilibrium live(two_arms());
  const PointRef tip{2, 1};
  live.drag(tip, {1.0, -1.0});
  const double bend = std::remainder(live.poses()[2].angle - live.poses()[1].angle, 2 * M_PI);
  live.drag(tip, {4.0, -4.0});
  EXPECT_NEAR(norm(place_of(live, tip)), 2.0, 1e-4);
  EXPECT_TRUE(live.equilibrium().found());
  live.drag(tip, {1.0, -1.0});
  EXPECT_NEAR(std::remainder(live.poses()[2].angle - live.poses()[1].angle, 2 * M_PI), bend, 1e-6);
}

TEST(TrackedEquilibrium, LoopsThatCannotBeClosedChangeNothing) {
  TrackedEquilibrium live(read_scene(test::dataset("thesis_four_bar.toml")));
  const BodyPoses before = live.poses();
  Scene wanted = live.scene();
  NamedPoint& point = wanted.bodies[2].points.back();
  const Vec2 at = point.at;
  point.at = 30.0 * at;
  EXPECT_THROW(live.change(wanted), InputError);
  EXPECT_EQ(apart(before, live.poses()), 0.0);
  EXPECT_EQ(live.scene().bodies[2].points.back().at, at);
  EXPECT_TRUE(live.equilibrium().found());
}

// The clamp's frame is lowered until the link is at its limit against the handle and the arm at its limit on the
// ground: with y of pin A as the unknown, the distance of pins C and B is that of a triangle of given sides and angle
// there.
TEST(TrackedEquilibrium, TellsWhichStopsJamAndAtWhichValue) {
  TrackedEquilibrium clamp(read_scene(test::dataset("toggle_clamp.toml")));
  const double at_limit = 6.0 * M_PI / 180.0, lowest = -5.0 * M_PI / 180.0;
  const double far = std::sqrt(24.0 * 24.0 + 36.0 * 36.0 + 2.0 * 24.0 * 36.0 * std::cos(at_limit));
  const double arm_x = -36.0 * std::cos(lowest) - 4.0 * std::sin(lowest);
  const double arm_y = -36.0 * std::sin(lowest) + 4.0 * std::cos(lowest);
  const double jams = 4.0 + std::sqrt(far * far - (arm_x + 36.0) * (arm_x + 36.0)) - arm_y;
  Scene wanted = clamp.scene();
  wanted.bodies[0].points[0].at.y = 0.056;
  try {
    clamp.change(wanted);
    FAIL() << "nothing jams";
  } catch (const InputError& error) {
    const std::string why = error.what();
    EXPECT_NE(why.find("stop \"over_centre\" and stop \"open\""), std::string::npos) << why;
    const std::size_t number = why.find("point.ground.A.y = ");
    ASSERT_NE(number, std::string::npos) << why;
    EXPECT_NEAR(std::stod(why.substr(number + 19)), jams, 2e-4) << why;
  }
}

TEST(TrackedEquilibrium, WithoutItsSpringALeverFalls) {
  Scene scene = pendulum();
  test::add_torsion_spring(scene, 0, 1, 1000.0);
  TrackedEquilibrium live(scene);
  EXPECT_NEAR(live.poses()[1].angle, -0.01, 1e-5);
  Scene without = live.scene();
  without.elements.clear();
  const Transition way = live.change(without);
  EXPECT_EQ(way.kind, Kind::settled);
  ASSERT_EQ(way.courses.size(), 1u);
  for (std::size_t k = 1; k < way.courses[0].poses.size(); ++k) {
    EXPECT_LT(apart(way.courses[0].poses[k - 1], way.courses[0].poses[k]), 0.15);
  }
  EXPECT_NEAR(live.poses()[1].angle, -0.5 * M_PI, 1e-12);
}

TEST(TrackedEquilibrium, WhatIsReleasedSettlesAsTheSceneDoes) {
  for (const char* name : {"toggle_clamp.toml", "hanging_chain_10.toml", "six_bar.toml"}) {
    TrackedEquilibrium live(read_scene(test::dataset(name)));
    const PointRef point{2, 0};
    live.drag(point, place_of(live, point) + 0.05 * live.model().scales().length * Vec2{0.6, 0.8});
    const Scene held_up = live.scene();
    live.release();
    const StaticModel model(held_up);
    const Equilibrium settled = solve(model);
    ASSERT_TRUE(settled.found()) << name;
    EXPECT_LT(apart(live.poses(), model.poses(settled.x)), 1e-9) << name;
  }
}

TEST(TrackedEquilibrium, ScenesOfOneStructureVaryTogether) {
  const Scene from = lever();
  Scene to = from;
  set_value(to, "torsion_spring.spring.stiffness", 5.0);
  set_value(to, "stop.end.max", 2.2);
  const VariedScene varied(from, to);
  const Scene middle = varied.scene_at(0.5);
  EXPECT_EQ(get_value(middle, "torsion_spring.spring.stiffness"), 4.0);
  EXPECT_DOUBLE_EQ(get_value(middle, "stop.end.max"), 1.7);
  EXPECT_EQ(get_value(varied.scene_at(1.0), "stop.end.max"), 2.2);

  EXPECT_THROW(VariedScene(from, from), InputError);
  Scene other = from;
  other.elements.clear();
  EXPECT_THROW(VariedScene(from, other), InputError);
  Scene limited = from;
  limited.stops[0].min = -1.0;
  EXPECT_THROW(VariedScene(from, limited), InputError);
}

// A plate that a weld holds has no coordinate left; whether its pin closes is seen from where it is.
TEST(TrackedEquilibrium, LoopsWithoutCoordinatesAreClosedOrNot) {
  const auto closed_with_hole_at = [](const std::string& x) {
    const Scene scene =
        parse_scene("[ground]\npoints = { A = [0, 0], B = [1, 0] }\n[body.plate]\npoints = { a = [0, 0], b = [" + x +
                        ", 0] }\n[[weld]]\nname = \"W\"\npoints = [\"ground.A\", \"plate.a\"]\n[[pin]]\nname = "
                        "\"P\"\npoints = [\"ground.B\", \"plate.b\"]\n",
                    "plate.toml");
    EXPECT_FALSE(find_singular_configuration(StaticModel(scene), {}));
    return closed_near(scene, BodyPoses(2)).has_value();
  };
  EXPECT_TRUE(closed_with_hole_at("1"));
  EXPECT_FALSE(closed_with_hole_at("1.1"));
}

}  // namespace
}  // namespace poise::tracked_equilibrium_test
