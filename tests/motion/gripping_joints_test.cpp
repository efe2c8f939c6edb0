// Friction of joints that grows with the forces in them, in motion.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/joint_friction.hpp"
#include "motion/simulate.hpp"
#include "statics/friction/held.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/seed.hpp"

namespace poise::motion_gripping_joints_test {
namespace {

constexpr double g = 9.81;

Scene scene_of(const std::string& text) { return parse_scene(text, "test"); }

MotionModel model_of(const std::string& text) { return MotionModel(resisted_by_joints(scene_of(text))); }

std::string incline(double slope, const std::string& friction, double mass = 2.0) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.block]
points = {{ A = [0, 0] }}
mass = {2}
[[slide]]
name = "s"
points = ["ground.O", "block.A"]
axis = [{0}, {1}]
friction = {{ {3} }}
)",
                     std::cos(slope), std::sin(slope), mass, friction);
}

// Kicked up the incline it stops after v0 / (g (sin + mu cos)), and comes back where tan > mu.
TEST(GrippingJoints, ABlockOnAnInclineStopsAndStaysOrComesBack) {
  constexpr double slope = 0.4, v0 = 2.0, rub = 1.0, mass = 2.0;
  for (const double mu : {0.1, 0.3, 0.6}) {
    const MotionModel model = model_of(incline(slope, fmt::format("coefficient = {}, force = {}", mu, rub), mass));
    const double up = g * (std::sin(slope) + mu * std::cos(slope)) + rub / mass;
    const double down = std::max(g * (std::sin(slope) - mu * std::cos(slope)) - rub / mass, 0.0);
    const Motion motion = test::moved(model, test::released(model, {{}, {{"s", v0}}}), 1.5);
    const auto s = static_cast<std::size_t>(test::coordinate_of(model, "s"));
    std::vector<double> times;
    for (int k = 0; k <= 150; ++k) times.push_back(0.01 * k);
    const std::vector<test::Reading> read = test::read_at(motion, times);
    const double top = v0 / up;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double t = times[i], after = std::max(t - top, 0.0), before = std::min(t, top);
      const double x = v0 * before - up * before * before / 2 - down * after * after / 2;
      ASSERT_NEAR(read[i].q[s], x, 1e-12) << "mu " << mu << " at " << t;
    }
    EXPECT_LT(motion.energy_error, 1e-12);
  }
}

std::string pendulum(const std::string& friction) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0.3, 0.2] }}
[body.arm]
points = {{ O = [0.1, 0], E = [1, 0] }}
mass = 1.5
center = [0.5, 0]
inertia = 0.04
[[pin]]
name = "bearing"
points = ["ground.O", "arm.O"]
friction = {{ {} }}
[start]
arm = -1.5707963267948966
)",
                     friction);
}

// The same by one equation: J theta'' = -m g l cos theta - sign(theta') (rho |F| + M), F = m (a - g).
class Pendulum {
 public:
  Pendulum(double rho, double torque) : rho_(rho), torque_(torque) {}

  double acceleration(double theta, double omega, double sign) const {
    double alpha = 0.0;
    for (int k = 0; k < 200; ++k) {
      const double radial = m * (-l * omega * omega + g * std::sin(theta)),
                   across = m * (l * alpha + g * std::cos(theta));
      alpha = (-m * g * l * std::cos(theta) - sign * (rho_ * std::hypot(radial, across) + torque_)) / J;
    }
    return alpha;
  }

  // The angle at multiples of `step`, from rest at theta: it turns where it stops, or stays there.
  std::vector<double> angles(double theta, double step, int count) const {
    std::array<double, 2> y{theta, 0.0};
    double sign = std::cos(theta) > 0 ? -1.0 : 1.0;
    std::vector<double> out;
    bool stays = false;
    for (int k = 0; k <= count; ++k) {
      out.push_back(y[0]);
      double left = step;
      while (left > 0 && !stays) {
        double h = left;
        std::array<double, 2> next = moved(y, sign, h);
        if (sign * next[1] < 0) {
          double low = 0.0, high = left;
          for (int b = 0; b < 100; ++b) {
            h = (low + high) / 2;
            next = moved(y, sign, h);
            (sign * next[1] < 0 ? high : low) = h;
          }
          sign = -sign;
          next[1] = 0.0;
          stays = sign * acceleration(next[0], 0.0, sign) <= 0;
        }
        y = next;
        left -= h;
        if (left < 1e-14) break;
      }
    }
    return out;
  }

 private:
  static constexpr double m = 1.5, l = 0.4, J = 0.04 + m * l * l;

  std::array<double, 2> moved(std::array<double, 2> y, double sign, double h) const {
    boost::numeric::odeint::runge_kutta_fehlberg78<std::array<double, 2>> stepper;
    constexpr int parts = 4;
    for (int k = 0; k < parts; ++k) {
      stepper.do_step(
          [&](const std::array<double, 2>& at, std::array<double, 2>& rates, double) {
            rates = {at[1], acceleration(at[0], at[1], sign)};
          },
          y, 0.0, h / parts);
    }
    return y;
  }

  double rho_, torque_;
};

TEST(GrippingJoints, APendulumInItsFrictionCircleSwingsAsOneEquationSays) {
  for (const double torque : {0.0, 0.05}) {
    for (const double from : {0.9, -1.0}) {
      constexpr double mu = 0.3, radius = 0.06;
      const MotionModel model =
          model_of(pendulum(fmt::format("coefficient = {}, radius = {}, torque = {}", mu, radius, torque)));
      EXPECT_EQ(model.mechanism().closures(), 1);
      const Motion motion = test::moved(model, test::released(model, {{{"arm", from}}, {}}), 6.0);
      const std::vector<double> expected =
          Pendulum(radius * mu / std::sqrt(1 + mu * mu), torque).angles(from, 0.01, 600);
      const auto arm = static_cast<std::size_t>(test::coordinate_of(model, "arm"));
      std::vector<double> times;
      for (int k = 0; k <= 600; ++k) times.push_back(0.01 * k);
      const std::vector<test::Reading> read = test::read_at(motion, times);
      for (std::size_t i = 0; i < times.size(); ++i) {
        ASSERT_NEAR(read[i].q[arm], expected[i], 1e-9) << "torque " << torque << " at " << times[i];
      }
      EXPECT_LT(motion.energy_error, 1e-10);
      EXPECT_EQ(read.back().v[arm] == 0.0, from < 0) << "it stays";
    }
  }
}

// Pulled by P beside its middle: P (1 - 2 mu h / length) - F accelerates it, and also where it is pressed by less.
std::string drawer(double pull, double press, const std::string& time = "") {
  return fmt::format(R"(
[ground]
points = {{ O = [0, 0] }}
[body.drawer]
points = {{ A = [0, 0], H = [0.15, 0.18] }}
mass = 4
inertia = 0.1
[[slide]]
name = "guides"
points = ["ground.O", "drawer.A"]
axis = [1, 0]
friction = {{ coefficient = 0.35, length = 0.3, force = 2 }}
[[force]]
name = "P"
at = "drawer.H"
vector = [{0}, 0]
{2}
[[force]]
name = "Q"
at = "drawer.A"
vector = [0, {1}]
)",
                     pull, press, time);
}

TEST(GrippingJoints, ADrawerIsPulledBesideItsMiddle) {
  for (const double press : {0.0, -5.0, 20.0}) {
    const double pull = 12.0, normal = std::abs(press), turn = 2 * pull * 0.18 / 0.3;
    const double acceleration = (pull - 0.35 * std::max(normal, turn) - 2) / 4;
    const MotionModel model = model_of(drawer(pull, press));
    const Motion motion = test::moved(model, test::released(model, {}), 1.0);
    const auto s = static_cast<std::size_t>(test::coordinate_of(model, "guides"));
    EXPECT_NEAR(test::q_at(motion, motion.trajectory.nodes() - 1)[s], acceleration / 2, 1e-12) << press;
    EXPECT_LT(motion.energy_error, 1e-12);
  }
}

// It is held until the pull of a ramp passes F / (1 - 2 mu h / length).
TEST(GrippingJoints, ADrawerIsHeldUntilItsPullPassesTheBound) {
  constexpr double slope = 5.0, share = 1 - 0.35 * 2 * 0.18 / 0.3;
  const MotionModel model = model_of(drawer(slope, 0.0, "time = { ramp = { from = 0, to = 4, start = 0, end = 4 } }"));
  const Motion motion = test::moved(model, test::released(model, {}), 3.0);
  const auto s = static_cast<std::size_t>(test::coordinate_of(model, "guides"));
  const double slips = 2 / share / slope;
  bool met = false;
  for (const double t : motion.trajectory.t) met = met || std::abs(t - slips) < 1e-13;
  EXPECT_TRUE(met) << "an event at " << slips;
  const std::vector<double> times{0.5 * slips, 0.99 * slips, slips + 0.1, 2.0, 3.0};
  const std::vector<test::Reading> read = test::read_at(motion, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double after = std::max(times[i] - slips, 0.0);
    EXPECT_NEAR(read[i].q[s], share * slope * after * after * after / 6 / 4, 1e-12) << times[i];
  }
}

// Of the same joints, bodies and loads as statics finds held or slipping.
std::string slider_crank(std::mt19937& random, double most) {
  const auto any = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  const double a = any(0.2, 1.0), b = any(1.2, 2.5), angle = any(0.3, 2.8);
  const double reach = a * std::cos(angle) + std::sqrt(b * b - a * a * std::sin(angle) * std::sin(angle));
  std::string friction[4];
  for (int k = 0; k < 4; ++k) {
    if (any(0, 1) < 0.2) continue;
    const double dry = any(0, k == 3 ? 0.3 : 0.1);
    const double length = k < 3 ? any(0.01, 0.1) : any(0, 1) < 0.3 ? 0.0 : any(0.3, 1.0);
    friction[k] = fmt::format("friction = {{ coefficient = {}, {} = {}, {} = {} }}", any(0.05, most),
                              k == 3 ? "length" : "radius", length, k == 3 ? "force" : "torque", dry);
  }
  const double T = any(-0.3, 0.3), Qy = any(-2, 2), Qx = any(-2, 2), Py = any(-2, 2), Px = any(-2, 2);
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.crank]
points = {{ O = [0, 0], B = [{0}, 0] }}
mass = 0.02
center = [{0}, 0.01]
inertia = 0.01
[body.rod]
points = {{ B = [0, 0], C = [{1}, 0], M = [{2}, 0.1] }}
mass = 0.03
center = [{2}, 0]
inertia = 0.02
[body.ram]
points = {{ C = [0, 0], D = [0.1, {9}] }}
mass = 0.05
inertia = 0.01
[[pin]]
name = "main"
points = ["ground.O", "crank.O"]
{3}
[[pin]]
name = "big"
points = ["crank.B", "rod.B"]
{4}
[[pin]]
name = "small"
points = ["rod.C", "ram.C"]
{5}
[[slide]]
name = "guide"
points = ["ground.O", "ram.C"]
axis = [1, 0]
{6}
[[force]]
name = "P"
at = "ram.D"
vector = [{10}, {11}]
[[force]]
name = "Q"
at = "rod.M"
vector = [{12}, {13}]
[[torque]]
name = "T"
on = "crank"
value = {14}
[start]
crank = {7}
guide = {8}
)",
                     a, b, b / 2, friction[0], friction[1], friction[2], friction[3], angle, reach, any(-0.3, 0.3), Px,
                     Py, Qx, Qy, T);
}

// A block in a vertical guide on a wedge on the floor.
std::string wedge(std::mt19937& random, double most) {
  const auto any = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(random); };
  std::string friction[3];
  for (std::string& one : friction) {
    if (any(0, 1) < 0.6) one = fmt::format("friction = {{ coefficient = {} }}", any(0.02, most));
  }
  const double angle = any(0.05, 0.9);
  const double Q = any(-500, 500), Py = any(-2000, 500), Px = any(-2000, 2000), block = any(0.1, 20);
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ F = [0, 0], G = [0, 0.04] }}
[body.wedge]
points = {{ F = [0, 0], W = [0, 0.02] }}
mass = {0}
[body.block]
points = {{ W = [0, 0], G = [0, 0.02] }}
mass = {1}
[[slide]]
name = "floor"
points = ["ground.F", "wedge.F"]
axis = [1, 0]
{2}
[[pin_in_slot]]
name = "face"
points = ["wedge.W", "block.W"]
axis = [{5}, {6}]
{3}
[[slide]]
name = "guide"
points = ["ground.G", "block.G"]
axis = [0, 1]
{4}
[[force]]
name = "P"
at = "block.W"
vector = [{7}, {8}]
[[force]]
name = "Q"
at = "wedge.W"
vector = [{9}, 0]
[start]
floor = 0
face = 0
guide = 0
)",
                     any(0.1, 20), block, friction[0], friction[1], friction[2], std::cos(angle), -std::sin(angle), Px,
                     Py, Q);
}

struct AtRest {
  int held = 0, moves = 0, ambiguous = 0, locked = 0;
};

/// Lets mechanisms at rest go that statics finds held or slipping.
AtRest let_go(int count, const std::function<std::string()>& scene_text) {
  AtRest out;
  for (int k = 0; k < count; ++k) {
    const Scene scene = scene_of(scene_text());
    const StaticModel still(scene);
    const HeldPose pose = held_pose(still, close_loops(still));
    EXPECT_NE(pose.verdict, Holding::not_decided) << k;
    const MotionModel model(resisted_by_joints(scene));
    MotionOptions options;
    options.duration = 1e-3;
    const Motion motion = simulate(model, start_motion(model, {}), options);
    if (!motion.completed()) {
      // Rest is one of the motions that agree with the laws of friction where statics finds it held.
      const bool is_ambiguous = motion.why.find("may hold or let go") != std::string::npos;
      const bool is_locked = motion.why.find("friction locks") != std::string::npos;
      EXPECT_TRUE(is_ambiguous || is_locked) << k << ": " << motion.why;
      EXPECT_EQ(is_ambiguous, pose.verdict == Holding::held) << k << ", least factor " << pose.least_factor;
      ++(is_ambiguous ? out.ambiguous : out.locked);
      continue;
    }
    const std::vector<double> v = test::v_at(motion, motion.trajectory.nodes() - 1);
    const bool rests = std::all_of(v.begin(), v.end(), [](double rate) { return std::abs(rate) < 1e-12; });
    EXPECT_EQ(rests, pose.verdict == Holding::held) << k << ", least factor " << pose.least_factor;
    ++(rests ? out.held : out.moves);
  }
  return out;
}

TEST(GrippingJoints, AMechanismAtRestStaysWhereStaticsFindsItHeld) {
  std::mt19937 random(static_cast<unsigned>(test::seed(7)));
  const AtRest found = let_go(200, [&] { return slider_crank(random, 0.4); });
  EXPECT_GT(found.held, 40);
  EXPECT_GT(found.moves, 60);
  EXPECT_LT(found.ambiguous + found.locked, 5);
}

// Friction of several slides may leave a choice between rest and motion, or between forces: it is never made silently.
TEST(GrippingJoints, AWedgeAtRestStaysWhereStaticsFindsItHeld) {
  std::mt19937 random(static_cast<unsigned>(test::seed(8)));
  const AtRest found = let_go(400, [&] { return wedge(random, 0.9); });
  EXPECT_GT(found.held, 100);
  EXPECT_GT(found.moves, 100);
  EXPECT_GT(found.ambiguous, 0);
  EXPECT_LT(found.ambiguous + found.locked, 30);
  RecordProperty("held", found.held);
  RecordProperty("moves", found.moves);
  RecordProperty("ambiguous", found.ambiguous);
  RecordProperty("locked", found.locked);
}

// Energy lost is what friction takes: sum of bound times rate, which the motion integrates with the rest.
TEST(GrippingJoints, AMovingMechanismBalancesItsEnergy) {
  std::mt19937 random(static_cast<unsigned>(test::seed(11)));
  int completed = 0;
  for (int k = 0; k < 20; ++k) {
    const MotionModel model(resisted_by_joints(scene_of(slider_crank(random, 0.2))));
    const MotionState start = test::released(model, {{}, {{"crank", 5.0}}});
    MotionOptions options;
    options.duration = 0.5;
    const Motion motion = simulate(model, start, options);
    if (!motion.completed()) {
      EXPECT_NE(motion.why.find("friction"), std::string::npos) << k << ": " << motion.why;
      continue;
    }
    ++completed;
    EXPECT_LT(motion.energy_error, 1e-9) << k;
  }
  EXPECT_GT(completed, 12);
}

// Painleve's rod, whose end slides on a rough line: a force across the line is (1 + 3 cos^2) N, one along it moves the
// end across by -+3 mu sin cos N, all over its mass; it locks where that is more. (F. Genot, B. Brogliato, "New results
// on Painleve paradoxes", European Journal of Mechanics A 18 (1999), 653-677.)
TEST(GrippingJoints, PainlevesRodLocksWhereItsForcesAreNotUnique) {
  constexpr double angle = 1.0, half = 0.5, mass = 1.0;
  const double sine = std::sin(angle), cosine = std::cos(angle);
  const double limit = (1 + 3 * cosine * cosine) / (3 * sine * cosine);
  for (const double share : {0.98, 1.02}) {
    const MotionModel model = model_of(fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.rod]
points = {{ A = [0, 0] }}
mass = {}
center = [{}, 0]
inertia = {}
[[pin_in_slot]]
name = "line"
points = ["ground.O", "rod.A"]
axis = [1, 0]
friction = {{ coefficient = {} }}
[start]
rod = {}
)",
                                                   mass, half, mass * half * half / 3, share * limit, angle));
    MotionOptions options;
    options.duration = 1e-3;
    const Motion motion = simulate(model, test::released(model, {{}, {{"line", 1.0}}}), options);
    EXPECT_EQ(motion.completed(), share < 1) << motion.why;
    EXPECT_EQ(motion.why.find("friction locks") != std::string::npos, share > 1) << motion.why;
  }
}

// Two slides tied by a coupling start to move, and stop where neither direction of the last one at rest has any forces
// that satisfy the laws of friction, or where several motions do.
TEST(GrippingJoints, SaysThatFrictionEndsAMotionWhereNoChoiceHasForces) {
  const MotionModel model = model_of(R"(
[ground]
points = { P_b0 = [-0.9205117945152372, -0.051419529903685035] }
[body.b0]
points = { Q = [0.0, 0.0], P_b1 = [-0.7746926663023523, -0.08355568913553069], p2 = [-0.27683383200687417, -0.4065679390724274] }
mass = 1.8281356166746918
center = [0.06046970189759504, -0.23422956930074293]
inertia = 0.06485341869881604
[body.b1]
points = { Q = [0.0, 0.0], p1 = [-0.11746728317879873, -0.15033331747473933] }
mass = 2.115125985336659
center = [-0.030038408022912577, 0.11372217056639507]
inertia = 0.08115451929541773
[[pin_in_slot]]
name = "j_b0"
points = ["ground.P_b0", "b0.Q"]
axis = [0.3418132345427992, -0.39339903080967553]
friction = { coefficient = 0.567, force = 3.5822078245330164 }
[[slide]]
name = "j_b1"
points = ["b0.P_b1", "b1.Q"]
axis = [0.08995471768109922, -0.5968276308102956]
angle = -0.117344
friction = { coefficient = 0.586, length = 0.24268315560933937, force = 2.0357322489572085 }
[[torsion_spring]]
name = "t_b0"
bodies = ["ground", "b0"]
stiffness = 6.918501977682046
free_angle = -2.606780193383722
[[spring]]
name = "l_b0"
slide = "j_b0"
stiffness = 9.761045429328522
free_length = -0.2578112269389723
[[spring]]
name = "l_b1"
slide = "j_b1"
stiffness = 6.307940358584336
free_length = 0.14069182274113345
[[spring]]
name = "e0"
bodies = ["ground", "b0"]
stiffness = 17.502921994960346
cubic = 14.580402009111562
free_angle = -2.178039302425815
[[coupling]]
name = "c0"
sum = [{ factor = 0.588, points = ["b1.p1", "b0.p2"] }, { factor = -0.69, bodies = ["b1", "b0"] }, { factor = -1.616, slide = "j_b0" }]
value = 0.4460366524264342
[start]
"j_b0" = -0.11614676778113403
"b0" = -2.436538916599157
"j_b1" = 0.02232017213521209
"b1" = -2.5538829165991572
)");
  // Which of them it meets depends on rounding; none is a matter of its poses.
  for (const double duration : {0.01, 1.0}) {
    MotionOptions options;
    options.duration = duration;
    const Motion motion = simulate(model, start_motion(model, {}), options);
    EXPECT_FALSE(motion.completed());
    EXPECT_NE(motion.why.find("friction"), std::string::npos) << motion.why;
    EXPECT_EQ(motion.why.find("singular position"), std::string::npos) << motion.why;
  }
}

// Without friction of its own a joint may also have the constant part alone, which is a [[friction]] of width 0.
TEST(GrippingJoints, AConstantPartIsAFrictionThatSticks) {
  const MotionModel own = model_of(pendulum("torque = 0.3"));
  EXPECT_EQ(own.mechanism().closures(), 0);
  std::string text = pendulum("torque = 0");
  text += "\n[[friction]]\nname = \"seal\"\nbodies = [\"ground\", \"arm\"]\ntorque = 0.3\nwidth = 0\n";
  const MotionModel given = model_of(text);
  const Motion a = test::moved(own, test::released(own, {{{"arm", -1.3}}, {}}), 4.0);
  const Motion b = test::moved(given, test::released(given, {{{"arm", -1.3}}, {}}), 4.0);
  EXPECT_LT(difference(a, b), 1e-12);
  EXPECT_EQ(test::v_at(a, a.trajectory.nodes() - 1)[0], 0.0);
}

// Two pins carry a beam: their forces along it are not known.
TEST(GrippingJoints, IndeterminateForcesAreRefused) {
  const MotionModel model = model_of(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], E = [1, 0] }
[body.beam]
points = { O = [0, 0], E = [1, 0] }
mass = 1
[body.arm]
points = { E = [0, 0] }
mass = 1
center = [0.2, 0]
[[pin]]
name = "left"
points = ["ground.O", "beam.O"]
friction = { coefficient = 0.2, radius = 0.01 }
[[pin]]
name = "right"
points = ["ground.E", "beam.E"]
[[pin]]
name = "free"
points = ["beam.E", "arm.E"]
)");
  const std::string message = test::message_of([&] { test::moved(model, start_motion(model, {}), 0.1); });
  EXPECT_NE(message.find("pin \"left\".friction: the mechanism is statically indeterminate"), std::string::npos)
      << message;
}

}  // namespace
}  // namespace poise::motion_gripping_joints_test
