// Free-body statics: it refutes what is wrong, and its reactions are those of a textbook.

#include "statics/model/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::check_test {
namespace {

using test::coordinates_at;
using test::model_of;
using test::reaction_of;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void expect_vector(Vec2 found, Vec2 expected, double tolerance) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
}

// A box of 1 kg whose ropes go straight down from its lower corners, with what `further` adds to it.
std::string box_above_its_ropes(const std::string& further = "") {
  return R"(
gravity = [0, -10]
[ground]
points = { A = [-1, -2], B = [1, -2] }
[body.box]
points = { P = [-1, -1], Q = [1, -1], O = [0, 0] }
mass = 1
[[rope]]
name = "left"
over = ["ground.A", "box.P"]
length = 1
[[rope]]
name = "right"
over = ["ground.B", "box.Q"]
length = 1
)" + further;
}

TEST(Check, NamesTheRopesThatWouldHaveToPush) {
  const StaticModel model(parse_scene(box_above_its_ropes(), "scene.toml"));
  const Check found = check(model, model.start());
  EXPECT_FALSE(found.is_equilibrium());
  EXPECT_EQ(found.objection, "rope \"left\" and rope \"right\" would have to push");
  EXPECT_EQ(found.pulling, (std::vector<int>{0, 1}));
}

// Of weight and loads, (4, 6) N together, the ropes carry 6 N; the wall cannot hold 4 N.
TEST(Check, NamesTheStopsThatWouldHaveToPull) {
  const StaticModel model(parse_scene(box_above_its_ropes(R"(
[[stop]]
name = "floor"
y = "box.O"
min = 0
[[force]]
name = "lift"
at = "box.O"
vector = [0, 16]
[[stop]]
name = "wall"
x = "box.O"
min = 0
[[force]]
name = "push"
at = "box.O"
vector = [4, 0]
)"),
                                      "scene.toml"));
  const Check found = check(model, model.start());
  EXPECT_FALSE(found.is_equilibrium());
  EXPECT_EQ(found.objection, "stop \"wall\" would have to pull");
  EXPECT_EQ(found.pulling, (std::vector<int>{1}));
}

// --- wrong results ---------------------------------------------------------------------------------------------------

class Refutes : public testing::TestWithParam<const char*> {};

TEST_P(Refutes, EveryCoordinateShiftedByAMillionth) {
  const StaticModel model(read_scene(test::dataset(GetParam())));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  std::set<std::string> joints, bodies;
  for (const Joint& joint : model.scene().joints) joints.insert(joint.name);
  for (const Body& body : model.scene().bodies) bodies.insert(body.name);
  for (std::size_t i = 0; i < found.x.size(); ++i) {
    SCOPED_TRACE(model.layout().coordinates[i].name);
    std::vector<double> x = found.x;
    x[i] += 1e-6;
    const Check check = poise::check(model, x);
    EXPECT_FALSE(check.is_equilibrium());
    EXPECT_EQ(joints.count(check.worst_joint), 1u) << check.worst_joint;
    EXPECT_EQ(bodies.count(check.worst_body), 1u) << check.worst_body;
    if (!check.closed) {
      EXPECT_TRUE(contains(check.objection, "joint \"" + check.worst_joint + "\" is open by")) << check.objection;
      EXPECT_GT(check.closure_error, 1e-9 * model.scales().length);
      EXPECT_LT(check.closure_error, 1e-5 * model.scales().length);
    } else {
      ASSERT_FALSE(check.balanced);
      EXPECT_TRUE(contains(check.objection, "body \"" + check.worst_body + "\" is out of balance by"))
          << check.objection;
      EXPECT_GT(check.imbalance, 1e-9 * check.largest_force);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Refutes,
                         testing::Values("thesis_four_bar.toml", "pendulum_chain.toml", "six_bar.toml",
                                         "vertical_slider_crank.toml", "lift.toml", "toggle_press.toml",
                                         "redundant_parallelogram.toml", "hencky_cantilever.toml"),
                         [](const auto& scene) {
                           const std::string name = scene.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(Check, NamesTheGapingJoint) {
  const StaticModel model(read_scene(test::dataset("thesis_four_bar.toml")));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  // The tree holds A, B and D together whatever x is, so what opens is the joint that closes the loop.
  ASSERT_EQ(model.layout().closures.size(), 1u);
  std::vector<double> x = found.x;
  x[0] += 1e-3;
  const Check check = poise::check(model, x);
  EXPECT_FALSE(check.closed);
  EXPECT_EQ(check.worst_joint, model.layout().closures[0].name);
}

TEST(Check, NamesTheBodyOutOfBalance) {
  // Two separate pendulums: the one that is moved is the one named.
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { L = [0, 0], R = [5, 0] }
    [body.left]
    points = { O = [0, 0] }
    mass = 1
    center = [1, 0]
    [body.right]
    points = { O = [0, 0] }
    mass = 1
    center = [1, 0]
    [[pin]]
    points = ["ground.L", "left.O"]
    [[pin]]
    points = ["ground.R", "right.O"]
  )");
  const double down = -M_PI_2;
  EXPECT_TRUE(check(model, coordinates_at(model, {{"left", down}, {"right", down}})).is_equilibrium());
  const Check moved = check(model, coordinates_at(model, {{"left", down}, {"right", down + 1e-3}}));
  EXPECT_EQ(moved.worst_body, "right");
  EXPECT_TRUE(moved.closed);
  EXPECT_FALSE(moved.balanced);
  // What is left over is the moment of the weight about the pin, over the scale of lengths, or less where the pin's
  // least-squares force shares it.
  EXPECT_GT(moved.imbalance, 0.0);
  EXPECT_LE(moved.imbalance, 10.0 * std::sin(1e-3) / model.scales().length * (1 + 1e-9));
}

// A spring at its free length in numbers that are not exact in binary: all forces are rounding.
TEST(Check, FindsNothingOutOfBalanceWithoutForces) {
  const StaticModel model(parse_scene(R"(
[units]
length = "mm"
[ground]
points = { A = [0, 0], D = [300, 20] }
[body.crank]
points = { A = [0, 0], B = [100.3, 0] }
[body.coupler]
points = { B = [0, 0], C = [251.7, 0] }
[body.rocker]
points = { D = [0, 0], C = [170.1, 0], S = [60, 30] }
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "coupler.B"]
[[pin]]
points = ["coupler.C", "rocker.C"]
[[pin]]
points = ["ground.D", "rocker.D"]
[[spring]]
name = "shock"
points = ["crank.B", "rocker.S"]
stiffness = 80
free_length = 210
[start]
crank = 1
coupler = 0.3
rocker = 1.9
)",
                                      "bike.toml"));
  const Equilibrium found = solve(model, SolveOptions{});
  EXPECT_EQ(found.status, Status::confirmed);
  EXPECT_TRUE(found.check.is_equilibrium()) << found.check.objection;
}

TEST(Check, NamesTheStopThatIsOverrun) {
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0] }
    [body.arm]
    points = { O = [0, 0] }
    mass = 1
    center = [1, 0]
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[stop]]
    name = "high"
    bodies = ["ground", "arm"]
    max = 2
    [[stop]]
    name = "low"
    bodies = ["ground", "arm"]
    min = -1
  )");
  const Check check = poise::check(model, coordinates_at(model, {{"arm", -M_PI_2}}));
  EXPECT_FALSE(check.stops_kept);
  EXPECT_FALSE(check.is_equilibrium());
  EXPECT_EQ(check.worst_stop, "low");
  EXPECT_NEAR(check.stop_violation, M_PI_2 - 1.0, 1e-12);
  EXPECT_TRUE(contains(check.objection, "stop \"low\" is overrun")) << check.objection;
}

TEST(Check, RejectsNan) {
  const StaticModel model(read_scene(test::dataset("thesis_four_bar.toml")));
  const std::vector<double> equilibrium = solve(model, test::by(Method::virtual_work)).x;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    for (std::size_t i = 0; i < equilibrium.size(); ++i) {
      std::vector<double> x = equilibrium;
      x[i] = bad;
      const Check check = poise::check(model, x);
      EXPECT_FALSE(check.is_equilibrium());
      EXPECT_TRUE(contains(check.objection, "not a finite number")) << check.objection;
    }
  }
}

TEST(Check, ObjectsToForcesThatOverflow) {
  // Scale of forces: the sum overflows; the stiffest spring: its force does. Only a scene built in code can do this.
  for (const std::string loads :
       {"[[force]]\nat = \"arm.P\"\nvector = [0, -1.5]\n[[force]]\nat = \"arm.P\"\nvector = [0, -1.5]\n",
        "[[force]]\nat = \"arm.P\"\nvector = [1.7, 1.7]\n",
        "[[spring]]\npoints = [\"ground.S\", \"arm.P\"]\nstiffness = 1\nfree_length = 0\n",
        "[[torsion_spring]]\nbodies = [\"ground\", \"arm\"]\nstiffness = 1.7\nfree_angle = 100\n"}) {
    SCOPED_TRACE(loads);
    Scene scene = parse_scene(R"(
      [ground]
      points = { O = [0, 0], S = [30, 40] }
      [body.arm]
      points = { O = [0, 0], P = [4, 0] }
      [[pin]]
      points = ["ground.O", "arm.O"]
    )" + loads,
                              "test.toml");
    for (Force& force : scene.forces) force.vector = 1e308 * force.vector;
    for (Element& element : scene.elements) std::get<LinearSpring>(element.law).stiffness *= 1e308;
    const StaticModel model(scene);
    for (const double angle : {0.0, 0.3, 0.92729521800161223, -M_PI_2, M_PI}) {
      const Check check = poise::check(model, coordinates_at(model, {{"arm", angle}}));
      EXPECT_FALSE(check.is_equilibrium());
      EXPECT_TRUE(contains(check.objection, "overflow")) << check.objection;
    }
    // Where everything is slack there is nothing to overflow.
    const Equilibrium found = solve(model, test::by(Method::virtual_work));
    EXPECT_TRUE(!found.found() || found.check.largest_force < 1e300);
    EXPECT_NE(found.why, "");
  }
}

TEST(Check, IsEmptyOfObjectionsWhereThereIsNone) {
  const StaticModel model(read_scene(test::dataset("thesis_four_bar.toml")));
  const Check check = solve(model, test::by(Method::virtual_work)).check;
  EXPECT_TRUE(check.is_equilibrium());
  EXPECT_EQ(check.objection, "");
  EXPECT_LT(check.closure_error, 1e-14 * model.scales().length);
  EXPECT_LT(check.imbalance, 1e-12 * check.largest_force);
  EXPECT_EQ(check.reactions.size(), model.scene().joints.size());
}

// --- reactions by hand -----------------------------------------------------------------------------------------------

TEST(Reactions, LeverHangingOnASpring) {
  // Level lever, 30 N at 1 m; the spring at 2 m pulls up with 100 (3 - 2.85) = 15 N, the pin bears the other 15 N.
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0], S = [2, 3] }
    [body.lever]
    points = { O = [0, 0], P = [2, 0] }
    mass = 3
    center = [1, 0]
    [[pin]]
    name = "hinge"
    points = ["ground.O", "lever.O"]
    [[spring]]
    points = ["ground.S", "lever.P"]
    stiffness = 100
    free_length = 2.85
  )");
  const Check check = poise::check(model, coordinates_at(model, {{"lever", 0.0}}));
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  const Reaction& hinge = reaction_of(check, "hinge");
  EXPECT_EQ(hinge.kind, "pin");
  expect_vector(hinge.force, {0.0, 15.0}, 1e-12);
  expect_vector(hinge.at, {0.0, 0.0}, 0.0);
  EXPECT_EQ(hinge.moment, 0.0);
  EXPECT_TRUE(hinge.determined);
  EXPECT_EQ(check.redundancy, 0);
  EXPECT_NEAR(check.largest_force, 30.0, 1e-12);
}

TEST(Reactions, ChangeSignWithTheOrderOfTheBodies) {
  const std::string arm = R"(
    gravity = [0, -10]
    [ground]
    points = { O = [1, 2] }
    [body.arm]
    points = { O = [0, 0] }
    mass = 2
    center = [1, 0]
    [[pin]]
    name = "hinge"
    points = )";
  const StaticModel forth = model_of(arm + "[\"ground.O\", \"arm.O\"]\n");
  const StaticModel back = model_of(arm + "[\"arm.O\", \"ground.O\"]\n");
  expect_vector(reaction_of(check(forth, coordinates_at(forth, {{"arm", -M_PI_2}})), "hinge").force, {0.0, 20.0},
                1e-12);
  expect_vector(reaction_of(check(back, coordinates_at(back, {{"arm", -M_PI_2}})), "hinge").force, {0.0, -20.0}, 1e-12);
  expect_vector(reaction_of(check(back, coordinates_at(back, {{"arm", -M_PI_2}})), "hinge").at, {1.0, 2.0}, 1e-15);
}

TEST(Reactions, TwoBarTrussOnASlide) {
  // Knee at (4, 3) between bars of 5 m, block at (8, 0). With 30 N down both bars bear 25 N of pressure, the block is
  // pushed down by 15 N and outwards by 20 N; with 30 N up all signs change.
  for (const double sign : {1.0, -1.0}) {
    const StaticModel model = model_of(R"(
      [ground]
      points = { A = [0, 0] }
      [body.knee]
      points = { P = [0, 0] }
      [body.block]
      points = { C = [0, 0] }
      [[bar]]
      name = "near"
      points = ["ground.A", "knee.P"]
      length = 5
      [[bar]]
      name = "far"
      points = ["knee.P", "block.C"]
      length = 5
      [[slide]]
      name = "rail"
      points = ["ground.A", "block.C"]
      axis = [1, 0]
      [[force]]
      at = "knee.P"
      vector = [0, )" + std::to_string(-30 * sign) +
                                       R"(]
      [[force]]
      at = "block.C"
      vector = [)" + std::to_string(-20 * sign) +
                                       ", 0]\n");
    const double rise = std::atan2(3.0, 4.0);
    const Check check = poise::check(model, coordinates_at(model, {{"near", rise}, {"far", -rise}, {"rail", 8.0}}));
    ASSERT_TRUE(check.is_equilibrium()) << check.objection;
    for (const char* bar : {"near", "far"}) {
      const Reaction& reaction = reaction_of(check, bar);
      EXPECT_EQ(reaction.kind, "bar");
      EXPECT_NEAR(reaction.axial, -25.0 * sign, 1e-12) << bar;
    }
    // On the second bodies: the near bar presses the knee away from A, the far one presses the block away from it.
    expect_vector(reaction_of(check, "near").force, {20.0 * sign, 15.0 * sign}, 1e-12);
    expect_vector(reaction_of(check, "far").force, {20.0 * sign, -15.0 * sign}, 1e-12);
    const Reaction& rail = reaction_of(check, "rail");
    EXPECT_EQ(rail.kind, "slide");
    expect_vector(rail.force, {0.0, 15.0 * sign}, 1e-12);
    EXPECT_NEAR(rail.moment, 0.0, 1e-12);
    expect_vector(rail.at, {8.0, 0.0}, 1e-15);
  }
}

TEST(Reactions, MomentsOfAWeldAndASlide) {
  // A carriage on a vertical rail, hung on a spring of 10 N, carries by a weld an arm with 10 N at 2 m.
  const StaticModel model = model_of(R"(
    [ground]
    points = { R = [0, 0], S = [0, 3] }
    [body.carriage]
    points = { P = [0, 0], W = [0.5, 0] }
    [body.arm]
    points = { Q = [0, 0], tip = [2, 0] }
    [[slide]]
    name = "rail"
    points = ["ground.R", "carriage.P"]
    axis = [0, 1]
    [[weld]]
    name = "joint"
    points = ["carriage.W", "arm.Q"]
    [[spring]]
    points = ["ground.S", "carriage.P"]
    stiffness = 10
    free_length = 2
    [[force]]
    at = "arm.tip"
    vector = [0, -10]
  )");
  const Check check = poise::check(model, coordinates_at(model, {{"rail", 0.0}}));
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  const Reaction& weld = reaction_of(check, "joint");
  EXPECT_EQ(weld.kind, "weld");
  expect_vector(weld.force, {0.0, 10.0}, 1e-12);
  EXPECT_NEAR(weld.moment, 20.0, 1e-12);
  expect_vector(weld.at, {0.5, 0.0}, 1e-15);
  const Reaction& rail = reaction_of(check, "rail");
  expect_vector(rail.force, {0.0, 0.0}, 1e-12);
  EXPECT_NEAR(rail.moment, 25.0, 1e-12);
}

TEST(Reactions, SlotPressesAcrossItsAxisOnly) {
  // A peg in a slot that rises at 30 degrees, pushed level by H: it rests where the weight balances along the slot.
  const double weight = 10.0;
  const double push = weight * std::tan(M_PI / 6);
  Scene scene = parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { O = [0, 0] }
    [body.peg]
    points = { P = [0, 0] }
    mass = 1
    [[pin_in_slot]]
    name = "slot"
    points = ["ground.O", "peg.P"]
    axis = [0.86602540378443865, 0.5]
    [[force]]
    name = "H"
    at = "peg.P"
    vector = [1, 0]
  )",
                            "test.toml");
  set_value(scene, "load.H", push);
  const StaticModel model(scene);
  const Check check = poise::check(model, coordinates_at(model, {{"slot", 3.0}}));
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  const double normal = weight / std::cos(M_PI / 6);
  expect_vector(reaction_of(check, "slot").force, {-0.5 * normal, std::cos(M_PI / 6) * normal}, 1e-12);
  EXPECT_EQ(reaction_of(check, "slot").kind, "pin_in_slot");
}

// --- redundancy ------------------------------------------------------------------------------------------------------

TEST(Redundancy, OnlyTheDoublyGuidedCarriageIsUndetermined) {
  // Two slides on one line guide the carriage; the pendulum below hangs on a pin of its own.
  const StaticModel model = model_of(R"(
    gravity = [0, -10]
    [ground]
    points = { A = [0, 0], S = [-3, 0] }
    [body.carriage]
    points = { L = [0, 0], R = [2, 0], H = [1.5, 0] }
    mass = 1
    center = [0.5, 0]
    [body.bob]
    points = { H = [0, 0] }
    mass = 2
    center = [1, 0]
    [[slide]]
    name = "left"
    points = ["ground.A", "carriage.L"]
    axis = [1, 0]
    [[slide]]
    name = "right"
    points = ["ground.A", "carriage.R"]
    axis = [1, 0]
    [[pin]]
    name = "hook"
    points = ["carriage.H", "bob.H"]
    [[spring]]
    points = ["ground.S", "carriage.L"]
    stiffness = 5
    free_length = 3
  )");
  const Check check = poise::check(model, coordinates_at(model, {{"left", 0.0}, {"right", 2.0}, {"bob", -M_PI_2}}));
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  EXPECT_EQ(check.redundancy, 2);
  EXPECT_FALSE(reaction_of(check, "left").determined);
  EXPECT_FALSE(reaction_of(check, "right").determined);
  EXPECT_TRUE(reaction_of(check, "hook").determined);
  expect_vector(reaction_of(check, "hook").force, {0.0, 20.0}, 1e-12);

  // Two normals and two moments (over size), shortest with  n1 + n2 = 30,  2 n2 + size (m1 + m2) = 5 + 30.
  const double size = model.scales().length;
  Eigen::MatrixXd equations(2, 4);
  equations << 1, 1, 0, 0, 0, 2, size, size;
  const Eigen::Vector2d loads(30, 35);
  const Eigen::Matrix2d normal = equations * equations.transpose();
  const Eigen::VectorXd shortest = equations.transpose() * (normal.inverse() * loads);
  expect_vector(reaction_of(check, "left").force, {0.0, shortest[0]}, 1e-11);
  expect_vector(reaction_of(check, "right").force, {0.0, shortest[1]}, 1e-11);
  EXPECT_NEAR(reaction_of(check, "left").moment, size * shortest[2], 1e-11);
  EXPECT_NEAR(reaction_of(check, "right").moment, size * shortest[3], 1e-11);

  const Mobility mobility = analyse_mobility(model);
  EXPECT_EQ(mobility.freedoms, 2);
  EXPECT_EQ(mobility.redundant, (std::vector<std::string>{"right", "right (angle)"}));
}

constexpr double crank_angle = 1.0;
constexpr double coupler_load = 100.0;

class Parallelogram : public testing::TestWithParam<int> {};

// Each massless crank passes on a force along itself, the first one the torque's besides; all pins' forces are shortest
// where the former are:  sum s_i = W sin,  sum i s_i = W / sin.
TEST_P(Parallelogram, SharesItsLoadByMinimumNorm) {
  const int cranks = GetParam();
  const StaticModel model(test::parallelogram(cranks, crank_angle, coupler_load));
  const Check check = poise::check(model, model.start());
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;

  const Vec2 along = unit(crank_angle);
  Eigen::MatrixXd equations(2, cranks);
  for (int i = 0; i < cranks; ++i) equations.col(i) << 1.0, i;
  const Eigen::Vector2d loads(coupler_load * along.y, coupler_load / along.y);
  const Eigen::Matrix2d normal = equations * equations.transpose();
  const Eigen::VectorXd share = equations.transpose() * (normal.inverse() * loads);
  for (int i = 0; i < cranks; ++i) {
    Vec2 force = share[i] * along;
    if (i == 0) force += coupler_load * std::cos(crank_angle) * quarter_turn(along);
    for (const char* end : {"A", "B"}) {
      const Reaction& pin = reaction_of(check, end + std::to_string(i));
      expect_vector(pin.force, force, 1e-9 * coupler_load);
      EXPECT_EQ(pin.determined, cranks == 2) << pin.name;
    }
  }
  EXPECT_EQ(check.redundancy, cranks - 2);
}

TEST_P(Parallelogram, HasOneFreedomAndNamesWhatIsRedundant) {
  const int cranks = GetParam();
  const StaticModel model(test::parallelogram(cranks, crank_angle, coupler_load));
  const Mobility mobility = analyse_mobility(model);
  EXPECT_TRUE(mobility.assembled) << mobility.gap;
  EXPECT_EQ(mobility.gruebler, 3 * (cranks + 1) - 4 * cranks);
  EXPECT_EQ(mobility.coordinates, cranks + 1);
  EXPECT_EQ(mobility.closures, 2 * (cranks - 1));
  EXPECT_EQ(mobility.rank, cranks);
  EXPECT_EQ(mobility.freedoms, 1);
  std::set<std::string> closing;
  for (const Closure& closure : model.layout().closures) closing.insert(closure.name);
  const std::set<std::string> named(mobility.redundant.begin(), mobility.redundant.end());
  EXPECT_EQ(named.size(), mobility.redundant.size()) << "a joint is named twice";
  EXPECT_TRUE(std::includes(closing.begin(), closing.end(), named.begin(), named.end()));
  // Each further crank is one too many, and every one of them may be taken for it.
  EXPECT_GE(static_cast<int>(named.size()), cranks - 2);
  EXPECT_EQ(named.empty(), cranks == 2);
}

// 4 unknown reactions a crank: dense up to 62 cranks, sparse above; the closures are sparse above 201.
INSTANTIATE_TEST_SUITE_P(Cranks, Parallelogram, testing::Values(2, 3, 10, 60, 70, 220));

// --- large mechanisms ------------------------------------------------------------------------------------------------

class HangingChain : public testing::TestWithParam<int> {};

// By symmetry each end bears half the weight; the level pull follows from the moments on the first link.
TEST_P(HangingChain, HasTheReactionsOfTheFunicularPolygon) {
  const int links = GetParam();
  const StaticModel model(test::hanging_chain(links, 10.0, 5.0, 6.0));
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  EXPECT_EQ(found.certificate.stability, Stability::stable);
  const double weight = 5.0 / links;
  const double first = test::angle_of(model, found.x, "1");
  const double pull = (2.5 - 0.5 * weight) / std::tan(first);
  double worst = 0.0;
  for (int i = 0; i <= links; ++i) {
    const std::string joint = i < links ? "joint" + std::to_string(i + 1) : "end";
    worst = std::max(worst, norm(reaction_of(found.check, joint).force - Vec2{pull, 2.5 - i * weight}));
    if (i > 0 && i < links) {
      const double angle = test::angle_of(model, found.x, std::to_string(i + 1));
      worst = std::max(worst, std::abs(std::sin(angle) * pull - std::cos(angle) * (2.5 - (i + 0.5) * weight)));
    }
  }
  EXPECT_LT(worst, 1e-10);
  EXPECT_EQ(found.check.redundancy, 0);
  for (const Reaction& reaction : found.check.reactions) EXPECT_TRUE(reaction.determined) << reaction.name;
}

INSTANTIATE_TEST_SUITE_P(Links, HangingChain, testing::Values(10, 60, 300, 1000));

TEST(LargeMechanisms, AreRefutedLikeSmallOnes) {
  const StaticModel model(test::hanging_chain(300, 10.0, 5.0, 6.0));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_TRUE(found.found()) << found.why;
  std::vector<double> x = found.x;
  x[150] += 1e-6;
  const Check check = poise::check(model, x);
  EXPECT_FALSE(check.is_equilibrium());
  EXPECT_EQ(check.worst_joint, model.layout().closures[0].name);
  // Closed, but not in equilibrium: the arc it starts from.
  const Check arc = poise::check(model, assemble(model));
  EXPECT_TRUE(arc.closed);
  EXPECT_FALSE(arc.balanced);
}

// --- stops -----------------------------------------------------------------------------------------------------------

StaticModel arm_on_stop(const std::string& stop, double mass = 3.0) {
  return model_of(
      "gravity = [0, -10]\n"
      "[ground]\npoints = { O = [0, 0] }\n"
      "[body.arm]\npoints = { O = [0, 0] }\ncenter = [1, 0]\nmass = " +
      std::to_string(mass) + "\n[[pin]]\npoints = [\"ground.O\", \"arm.O\"]\n" + stop);
}

TEST(Stops, PressWithTheMomentThatHoldsTheArm) {
  const StaticModel below =
      arm_on_stop("[[stop]]\nname = \"rest\"\nbodies = [\"ground\", \"arm\"]\nmin = 0\nmax = 2\n");
  const Check check = poise::check(below, coordinates_at(below, {{"arm", 0.0}}));
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  EXPECT_EQ(reaction_of(check, "rest").kind, "stop");
  EXPECT_NEAR(reaction_of(check, "rest").moment, 30.0, 1e-12);
  // With the bodies exchanged the stop is a maximum and acts on the ground.
  const StaticModel above = arm_on_stop("[[stop]]\nname = \"rest\"\nbodies = [\"arm\", \"ground\"]\nmax = 0\n");
  const Check exchanged = poise::check(above, coordinates_at(above, {{"arm", 0.0}}));
  ASSERT_TRUE(exchanged.is_equilibrium()) << exchanged.objection;
  EXPECT_NEAR(reaction_of(exchanged, "rest").moment, -30.0, 1e-12);
}

TEST(Stops, ThatWouldHaveToPullAreNotAccepted) {
  for (const char* stop : {"[[stop]]\nname = \"rest\"\nbodies = [\"ground\", \"arm\"]\nmax = 0\n",
                           "[[stop]]\nname = \"rest\"\nbodies = [\"arm\", \"ground\"]\nmin = 0\n"}) {
    const StaticModel model = arm_on_stop(stop);
    const Check check = poise::check(model, coordinates_at(model, {{"arm", 0.0}}));
    EXPECT_FALSE(check.is_equilibrium());
    EXPECT_TRUE(check.stops_kept);
    EXPECT_FALSE(check.balanced);
    EXPECT_EQ(check.objection, "stop \"rest\" would have to pull");
    for (const Reaction& reaction : check.reactions) EXPECT_NE(reaction.kind, "stop");
  }
}

TEST(Stops, WithoutPlayHoldBothWays) {
  for (const char* bodies : {"[\"ground\", \"arm\"]", "[\"arm\", \"ground\"]"}) {
    const StaticModel model =
        arm_on_stop(std::string("[[stop]]\nname = \"lock\"\nmin = 0\nmax = 0\nbodies = ") + bodies + "\n");
    const Check check = poise::check(model, coordinates_at(model, {{"arm", 0.0}}));
    ASSERT_TRUE(check.is_equilibrium()) << check.objection;
    EXPECT_NEAR(std::abs(reaction_of(check, "lock").moment), 30.0, 1e-12);
  }
}

TEST(Stops, TouchedWithoutPressureHoldNothing) {
  // Hanging straight down just at a stop: the stop carries nothing, so the degree of freedom remains.
  const StaticModel model =
      arm_on_stop(fmt::format("[[stop]]\nname = \"rest\"\nbodies = [\"ground\", \"arm\"]\nmin = {}\n", -M_PI_2));
  const Check check = poise::check(model, coordinates_at(model, {{"arm", -M_PI_2}}));
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  for (const Reaction& reaction : check.reactions) {
    if (reaction.kind == "stop") {
      EXPECT_NEAR(reaction.moment, 0.0, 1e-12);
    }
  }
}

std::string block_on_rail(double mass, const std::string& stop) {
  return "gravity = [0, -10]\n"
         "[ground]\npoints = { R = [0, 0], top = [0, 5] }\n"
         "[body.block]\npoints = { P = [0, 0] }\nmass = " +
         std::to_string(mass) +
         "\n[[slide]]\nname = \"rail\"\npoints = [\"ground.R\", \"block.P\"]\naxis = [0, 1]\n[[stop]]\n" +
         "name = \"stop\"\n" + stop;
}

TEST(Stops, OfATravelPushAlongIt) {
  const StaticModel model = model_of(block_on_rail(2.0, "slide = \"rail\"\nmin = -2\nmax = 4\n"));
  const Check check = poise::check(model, coordinates_at(model, {{"rail", -2.0}}));
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  expect_vector(reaction_of(check, "stop").force, {0.0, 20.0}, 1e-12);
  expect_vector(reaction_of(check, "stop").at, {0.0, -2.0}, 1e-15);
  EXPECT_FALSE(poise::check(model, coordinates_at(model, {{"rail", 4.0}})).is_equilibrium());
}

TEST(Stops, OfADistanceAreRopesAndProps) {
  // A rope of 7 m from above holds the block at -2: tension. A prop of 3 m from below: pressure.
  const StaticModel rope = model_of(block_on_rail(2.0, "points = [\"ground.top\", \"block.P\"]\nmax = 7\n"));
  const Check hung = poise::check(rope, coordinates_at(rope, {{"rail", -2.0}}));
  ASSERT_TRUE(hung.is_equilibrium()) << hung.objection;
  EXPECT_NEAR(reaction_of(hung, "stop").axial, 20.0, 1e-12);
  expect_vector(reaction_of(hung, "stop").force, {0.0, 20.0}, 1e-12);
  const StaticModel prop = model_of(block_on_rail(2.0, "points = [\"ground.R\", \"block.P\"]\nmin = 3\n"));
  const Check propped = poise::check(prop, coordinates_at(prop, {{"rail", 3.0}}));
  ASSERT_TRUE(propped.is_equilibrium()) << propped.objection;
  EXPECT_NEAR(reaction_of(propped, "stop").axial, -20.0, 1e-12);
  expect_vector(reaction_of(propped, "stop").force, {0.0, 20.0}, 1e-12);
  // Below the rail's origin the same prop would have to pull the block up.
  EXPECT_FALSE(poise::check(prop, coordinates_at(prop, {{"rail", -3.0}})).is_equilibrium());
}

// A block that no joint holds, with its origin P at (0, 0) and a load of 1 N down.
StaticModel loose_block(const std::string& stops, const std::string& load = "[0, -1]") {
  return model_of(
      "[ground]\npoints = { O = [0, 0], A = [-0.98480775301220802, -0.17364817766693033], "
      "B = [0.5, -0.8660254037844386], C = [-0.34202014332566871, 0.93969262078590843] }\n"
      "[body.block]\npoints = { P = [0, 0] }\n[[force]]\nat = \"block.P\"\nvector = " +
      load + "\n" + stops);
}

Check check_at_origin(const StaticModel& model) {
  std::vector<double> x = model.start();
  for (std::size_t t = 0; t < x.size(); ++t) x[t] = -model.layout().coordinates[t].origin;
  return check(model, x);
}

// Ropes at -170, -60 and 110 degrees. Of minimum norm the second and then the first would push; but the second and the
// third hold the load together:  t_B cos 60 = t_C cos 70,  t_C sin 70 = 1 + t_B sin 60.
TEST(Stops, ThatPullAreFoundTogether) {
  std::string ropes;
  for (const char* from : {"A", "B", "C"}) {
    ropes += fmt::format("[[stop]]\nname = \"{0}\"\npoints = [\"ground.{0}\", \"block.P\"]\nmax = 1\n", from);
  }
  const StaticModel model = loose_block(ropes);
  const Check check = check_at_origin(model);
  ASSERT_TRUE(check.is_equilibrium()) << check.objection;
  const double degree = M_PI / 180;
  const double b = 1 / (std::cos(60 * degree) * std::tan(70 * degree) - std::sin(60 * degree));
  ASSERT_EQ(check.reactions.size(), 2U);
  EXPECT_NEAR(reaction_of(check, "B").axial, b, 1e-12);
  EXPECT_NEAR(reaction_of(check, "C").axial, b * std::cos(60 * degree) / std::cos(70 * degree), 1e-12);
}

TEST(Stops, OfNoDistanceHoldLikePins) {
  const std::string stop = "[[stop]]\nname = \"knot\"\npoints = [\"ground.O\", \"block.P\"]\n";
  for (const std::string load : {"[0, -1]", "[3, 0.5]", "[-2, 4]"}) {
    const StaticModel model = loose_block(stop + "max = 0\n", load);
    const Check check = check_at_origin(model);
    ASSERT_TRUE(check.is_equilibrium()) << check.objection;
    expect_vector(reaction_of(check, "knot").force, -1.0 * model.scene().forces[0].vector, 1e-12);
    EXPECT_EQ(reaction_of(check, "knot").axial, 0.0);
    EXPECT_TRUE(reaction_of(check, "knot").determined);
    EXPECT_EQ(check.redundancy, 0);
  }
}

// Two points cannot come nearer than to coincide: there such a stop has no side on which it could push.
TEST(Stops, OfALeastDistanceOfZeroHoldNothing) {
  const StaticModel model =
      loose_block("[[stop]]\nname = \"idle\"\npoints = [\"ground.O\", \"block.P\"]\nmin = 0\nmax = 5\n", "[1, 0]");
  const Check check = check_at_origin(model);
  EXPECT_TRUE(check.stops_kept);
  EXPECT_FALSE(check.balanced);
  expect_vector(reaction_of(check, "idle").force, {0.0, 0.0}, 0.0);
  EXPECT_EQ(check.redundancy, 0);
}

}  // namespace
}  // namespace poise::check_test
