// Forces at every instant of a simulated motion, and motors in place of drives, against closed forms and by feeding
// efforts back into free motion.

#include "motion/forces_in_time.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "model/read_scene.hpp"
#include "model/scene.hpp"
#include "motion/force_courses.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::forces_in_time_test {
namespace {

constexpr double pi = std::numbers::pi;

/// A scene that was moved, and its forces.
class Forced {
 public:
  Forced(Scene given, const test::Release& release, double duration, double rate,
         const std::vector<std::string>& motors = {})
      : scene(std::move(given)),
        model(resisted_by_joints(scene)),
        motion(test::moved(model, test::released(model, release), duration)),
        read(record(model, motion, rate)) {
    ForcesInTimeOptions options;
    for (const std::string& name : motors) options.motors.push_back(find_motor("--motors", scene, name));
    found = forces_in_time(scene, model, motion, read, options);
  }

  std::vector<double> course(const std::string& name) const {
    for (const auto& courses : {force_courses(scene, found.found), inertia_courses(scene, found.found)}) {
      for (const ForceCourse& one : courses) {
        if (one.name == name) return one.value;
      }
    }
    ADD_FAILURE() << "no course " << name;
    return std::vector<double>(read.time.size());
  }
  const LinkCourse& link(const std::string& name, const std::string& key) const {
    for (const LinkCourse& one : found.links) {
      if (one.link == name && one.key == key) return one;
    }
    throw std::out_of_range(name + "." + key);
  }

  Scene scene;
  MotionModel model;
  Motion motion;
  MotionRecord read;
  ForceHistory found;
};

constexpr double m = 2.0, l = 0.8, inertia = 0.1, g = 9.81, drag = 0.7;

/// A bar on a pin whose angle is driven as 0.4 sin(3 t) rad, with a damper in the pin.
std::string bar(const std::string& more) {
  return fmt::format(R"(
gravity = [0, {}]
[ground]
points = {{ O = [0, 0] }}
[body.bar]
points = {{ A = [0, 0], B = [{}, 0] }}
mass = {}
center = [{}, 0]
inertia = {}
[[pin]]
name = "shaft"
points = ["ground.O", "bar.A"]
[[damper]]
name = "oil"
bodies = ["ground", "bar"]
coefficient = {}
{})",
                     -g, l, m, l / 2, inertia, drag, more);
}
const std::string rocking =
    "[[drive]]\nname = \"motor\"\nbodies = [\"ground\", \"bar\"]\nstart = 0\namplitude = 0.4\n"
    "frequency = 0.477464829275686\n";  // 3 rad/s

TEST(ForcesInTime, ABarThatIsRockedFollowsItsClosedForm) {
  const Forced bar_driven(parse_scene(bar(rocking), "bar.toml"), {}, 2.0, 50.0);
  const std::vector<double> effort = bar_driven.course("effort.motor"), power = bar_driven.course("power.motor"),
                            oil = bar_driven.course("damper.oil"), x = bar_driven.course("reaction.shaft.x"),
                            pull = bar_driven.course("inertia.bar.x"), turn = bar_driven.course("inertia.bar.moment");
  double lost = 0.0;
  for (std::size_t k = 0; k < bar_driven.read.time.size(); ++k) {
    const double t = bar_driven.read.time[k], a = 0.4 * std::sin(3 * t), w = 1.2 * std::cos(3 * t),
                 b = -3.6 * std::sin(3 * t);
    const double torque = (inertia + m * l * l / 4) * b + drag * w + m * g * l / 2 * std::cos(a);
    ASSERT_NEAR(effort[k], torque, 1e-9) << t;
    ASSERT_NEAR(power[k], torque * w, 1e-9);
    ASSERT_NEAR(oil[k], -drag * w, 1e-9);
    const double ax = l / 2 * (-b * std::sin(a) - w * w * std::cos(a));
    ASSERT_NEAR(pull[k], -m * ax, 1e-9);
    ASSERT_NEAR(x[k], m * ax, 1e-9) << "the pin alone accelerates the centre";
    ASSERT_NEAR(turn[k], -inertia * b, 1e-9);
    // The drive gives the energies and what the damper takes: the integral of drag w^2.
    lost = drag * 1.44 * (t / 2 + std::sin(6 * t) / 12);
    const double energies = (inertia + m * l * l / 4) / 2 * (w * w - 1.44) + m * g * l / 2 * std::sin(a);
    ASSERT_NEAR(bar_driven.found.work[0][k], energies + lost, 1e-9);
    ASSERT_NEAR(bar_driven.read.acceleration[0][k], b, 1e-9);
    ASSERT_NEAR(bar_driven.read.points[0].acceleration[k].x, 0.0, 1e-12) << "bar.A";
  }
  EXPECT_GT(lost, 0.5);
  EXPECT_LT(bar_driven.found.imbalance, 1e-12);
  EXPECT_LT(bar_driven.found.power_error, 1e-12);
  EXPECT_LT(bar_driven.found.energy_error, 1e-9);
  EXPECT_TRUE(bar_driven.found.balanced());
}

// N = m w^2 (l^2 - x^2) / (2 l) in a bar of even mass that turns at w = 2 t: it grows with time, most at the pin.
TEST(ForcesInTime, TheEnvelopeOfALinkSaysWhereAndWhen) {
  const std::string section =
      "[body.bar.section]\narea = 3e-3\nsecond_moment = 8e-6\nmodulus = 2.1e11\nheight = 0.2\nline = [\"A\", \"B\"]\n";
  Scene scene = parse_scene(
      bar("[[drive]]\nname = \"motor\"\nbodies = [\"ground\", \"bar\"]\nacceleration = 2\n" + section), "bar.toml");
  scene.gravity = {0, 0};
  scene.bodies[1].inertia = m * l * l / 12;
  const Forced turned(scene, {}, 1.0, 20.0);
  ASSERT_TRUE(turned.found.without_loads.empty()) << turned.found.without_loads.front();
  const LinkCourse& normal = turned.link("bar", "normal");
  ASSERT_EQ(normal.value.size(), 21U);
  for (std::size_t k = 0; k < normal.value.size(); ++k) {
    const double w = 2 * turned.read.time[k];
    ASSERT_NEAR(normal.value[k].value, m * w * w * l / 2, 1e-9);
  }
  EXPECT_EQ(normal.largest, 20U);
  EXPECT_EQ(normal.value[normal.largest].s, 0.0);
  // The angular acceleration is 2, and the moment at the pin is that of the whole bar.
  EXPECT_NEAR(std::abs(turned.link("bar", "moment").value[10].value), m * l * l / 3 * 2, 1e-9);
}

// Springs, dampers, a driven measure, several bodies: the powers and energies close, with the kinetic energy of the
// phasor model.
TEST(ForcesInTime, PowersAndEnergiesClose) {
  const Forced four_bar(test::four_bar_with_everything(), {{}, {{"crank", 3.0}}}, 1.0, 100.0);
  EXPECT_LT(four_bar.found.imbalance, 1e-9);
  EXPECT_LT(four_bar.found.power_error, 1e-9);
  EXPECT_LT(four_bar.found.energy_error, 1e-8);
  const Forced five_bar(test::driven_five_bar(), {}, 1.0, 100.0);
  EXPECT_LT(five_bar.found.imbalance, 1e-9);
  EXPECT_LT(five_bar.found.power_error, 1e-9);
  EXPECT_LT(five_bar.found.energy_error, 1e-8);
}

// Accelerations are the derivatives of rates, everywhere between steps.
TEST(ForcesInTime, AccelerationsAreThoseOfTheRates) {
  const Scene scene = test::four_bar_with_everything();
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {{}, {{"crank", 3.0}}}), 1.0, 1e-12);
  const double rate = 2000.0;
  const MotionRecord read = record(model, motion, rate);
  for (std::size_t c = 0; c < read.channels.size(); ++c) {
    double largest = 0.0;
    for (const double one : read.acceleration[c]) largest = std::max(largest, std::abs(one));
    for (std::size_t k = 2; k + 2 < read.time.size(); k += 7) {
      const std::vector<double>& v = read.rate[c];
      const double slope = (8 * (v[k + 1] - v[k - 1]) - (v[k + 2] - v[k - 2])) / 12 * rate;
      ASSERT_NEAR(read.acceleration[c][k], slope, 2e-7 * largest) << read.channels[c].name << " at " << read.time[k];
    }
  }
  for (const PointRecord& point : read.points) {
    for (std::size_t k = 2; k + 2 < read.time.size(); k += 7) {
      const auto& p = point.place;
      const Vec2 slope = rate / 12 * (8 * (p[k + 1] - p[k - 1]) - (p[k + 2] - p[k - 2]));
      ASSERT_NEAR(norm(point.velocity[k] - slope), 0.0, 1e-6 * (1 + norm(slope))) << point.name;
    }
  }
}

// The place of the end is driven, y = l sin(a), and a motor in the pin makes it: a closed form of the torque.
TEST(Motors, OneInThePinMakesTheEndRise) {
  const std::string lift =
      "[[drive]]\nname = \"rise\"\ny = \"bar.B\"\nstart = 0.1\nrate = 0.2\nacceleration = 0.1\n"
      "[start]\nbar = 0.125\n";
  const Forced lifted(parse_scene(bar(lift), "bar.toml"), {}, 1.5, 50.0, {"shaft"});
  ASSERT_TRUE(lifted.found.motors);
  EXPECT_TRUE(lifted.found.motors->is_made);
  EXPECT_EQ(lifted.found.motors->freedoms, 1);
  const std::vector<double> torque = lifted.course("effort.shaft");
  const std::vector<double> x = lifted.course("reaction.shaft.x"), y = lifted.course("reaction.shaft.y");
  for (std::size_t k = 0; k < lifted.read.time.size(); ++k) {
    const double t = lifted.read.time[k], h = 0.1 + 0.2 * t + 0.05 * t * t, dh = 0.2 + 0.1 * t;
    const double a = std::asin(h / l), w = dh / (l * std::cos(a)), b = (0.1 / l + w * w * std::sin(a)) / std::cos(a);
    ASSERT_NEAR(torque[k], (inertia + m * l * l / 4) * b + drag * w + m * g * l / 2 * std::cos(a), 1e-9) << t;
    const Vec2 c{l / 2 * (-b * std::sin(a) - w * w * std::cos(a)), l / 2 * (b * std::cos(a) - w * w * std::sin(a))};
    ASSERT_NEAR(x[k], m * c.x, 1e-9) << "nothing pushes at the end";
    ASSERT_NEAR(y[k], m * (c.y + g), 1e-9);
  }
  EXPECT_LT(lifted.found.imbalance, 1e-10);
  ASSERT_TRUE(lifted.found.motors->followed);
  EXPECT_LT(*lifted.found.motors->followed, 1e-8);
}

/// Two arms whose angles are driven.
const std::string two_arms = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.upper]
points = { O = [0, 0], E = [0.5, 0] }
mass = 2
center = [0.25, 0]
inertia = 0.05
[body.lower]
points = { E = [0, 0], P = [0.4, 0] }
mass = 1
center = [0.2, 0]
inertia = 0.02
[[pin]]
name = "shoulder"
points = ["ground.O", "upper.O"]
[[pin]]
name = "elbow"
points = ["upper.E", "lower.E"]
[[drive]]
name = "one"
bodies = ["ground", "upper"]
start = 0.3
amplitude = 0.5
frequency = 0.5
[[drive]]
name = "two"
bodies = ["ground", "lower"]
start = -0.4
amplitude = 0.3
frequency = 0.7
[start]
upper = 0.3
lower = -0.4
)";

// Drives act between the ground and each arm, motors in the joints: the elbow's torque is that of the second drive, the
// shoulder's the sum of both.
TEST(Motors, InTheJointsOfAnArm) {
  const Forced by_drives(parse_scene(two_arms, "arms.toml"), {}, 2.0, 50.0);
  const Forced by_motors(parse_scene(two_arms, "arms.toml"), {}, 2.0, 50.0, {"elbow", "shoulder"});
  const std::vector<double> one = by_drives.course("effort.one"), two = by_drives.course("effort.two"),
                            shoulder = by_motors.course("effort.shoulder"), elbow = by_motors.course("effort.elbow");
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_NEAR(elbow[k], two[k], 1e-9);
    ASSERT_NEAR(shoulder[k], one[k] + two[k], 1e-9);
  }
  // Their powers do the same work.
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_NEAR(by_motors.found.work[0][k] + by_motors.found.work[1][k],
                by_drives.found.work[0][k] + by_drives.found.work[1][k], 1e-8);
  }
  ASSERT_TRUE(by_motors.found.motors->followed);
  EXPECT_LT(*by_motors.found.motors->followed, 1e-8);
}

// A third motor, between the ground and the lower arm, shares with the others: of all torques (s, e, u) with
// e + u = two and s + e ... the least sum of squares.
TEST(Motors, MoreThanFreedomsShareByLeastSquares) {
  const Forced by_drives(parse_scene(two_arms, "arms.toml"), {}, 1.0, 20.0);
  const Forced shared(parse_scene(two_arms, "arms.toml"), {}, 1.0, 20.0, {"shoulder", "elbow", "angle.lower"});
  ASSERT_TRUE(shared.found.motors->is_made);
  const std::vector<double> one = by_drives.course("effort.one"), two = by_drives.course("effort.two"),
                            s = shared.course("effort.shoulder"), e = shared.course("effort.elbow"),
                            u = shared.course("effort.angle.lower");
  for (std::size_t k = 0; k < one.size(); ++k) {
    // On the upper arm s - e, on the lower one e + u. The least squares are orthogonal to what changes neither.
    ASSERT_NEAR(s[k] - e[k], one[k], 1e-9);
    ASSERT_NEAR(e[k] + u[k], two[k], 1e-9);
    ASSERT_NEAR(s[k] + e[k] - u[k], 0.0, 1e-9);
  }
  EXPECT_LT(shared.found.imbalance, 1e-10);
}

// The shoulder alone cannot hold the lower arm: what is left is found by vector mechanics too.
TEST(Motors, FewerThanFreedomsLeaveAForceUnbalanced) {
  const Forced few(parse_scene(two_arms, "arms.toml"), {}, 1.0, 20.0, {"shoulder"});
  ASSERT_TRUE(few.found.motors);
  EXPECT_FALSE(few.found.motors->is_made);
  EXPECT_GT(few.found.motors->left, 0.01);
  EXPECT_FALSE(few.found.balanced());
  const Forced by_drives(parse_scene(two_arms, "arms.toml"), {}, 1.0, 20.0);
  const std::vector<double> two = by_drives.course("effort.two");
  double largest = 0.0;
  for (const double one : two) largest = std::max(largest, std::abs(one));
  ASSERT_EQ(few.found.motors->unbalanced.size(), 2U);
  for (const UnbalancedForce& one : few.found.motors->unbalanced) {
    if (one.name == "lower") {
      EXPECT_NEAR(std::abs(one.value), largest, 1e-9);
    } else {
      EXPECT_NEAR(one.value, 0.0, 1e-9) << one.name;
    }
  }
}

TEST(Motors, OtherNamesAreRefused) {
  const Scene scene = parse_scene(two_arms, "arms.toml");
  const std::string said = test::message_of([&] { find_motor("--motors elbw", scene, "elbw"); });
  EXPECT_NE(said.find("--motors elbw: there is no joint or measure \"elbw\" for a motor; expected"), std::string::npos)
      << said;
  EXPECT_NE(said.find("elbow"), std::string::npos) << said;
}

// The robot of the thesis' kind: end point on a circle, hand level, motors of arm and parallelograms.
TEST(Motors, ThreeOfARobotLeadItsHandRoundACircle) {
  const Forced robot(read_scene(test::dataset("three_motor_robot.toml")), {}, 2.0, 100.0,
                     {"shoulder", "elbow", "wrist"});
  ASSERT_TRUE(robot.found.motors);
  EXPECT_TRUE(robot.found.motors->is_made);
  EXPECT_EQ(robot.found.motors->freedoms, 3);
  EXPECT_LT(robot.found.imbalance, 1e-9);
  EXPECT_LT(robot.found.power_error, 1e-9);
  ASSERT_TRUE(robot.found.motors->followed);
  EXPECT_LT(*robot.found.motors->followed, 1e-8);
  for (const PointRecord& point : robot.read.points) {
    if (point.name != "hand.P") continue;
    for (const Vec2& at : point.place) EXPECT_NEAR(norm(at - Vec2{0.75, 0.2}), 0.12, 1e-6);
  }
  // At rest, at both ends, motors hold the weights: the forearm's and the hand's are 3 g and 18.1 g, the arm's 31.2 g.
  const double g9 = 9.81, arm = robot.read.value[0].front();
  const std::vector<double> shoulder = robot.course("effort.shoulder");
  ASSERT_EQ(robot.read.channels[0].name, "arm");
  const double x_of_f = 0.6 * std::cos(arm);
  const double forearm = std::atan2(0.2 - 0.6 * std::sin(arm), 0.77 - x_of_f);
  const double moment = g9 * (31.2 * 0.2128 * std::cos(arm) + 3 * (x_of_f + 0.2 * std::cos(forearm)) + 18.1 * 0.87);
  EXPECT_NEAR(shoulder.front(), moment, 1e-2 * moment) << "the spline of the way begins nearly at rest";
}

}  // namespace
}  // namespace poise::forces_in_time_test
