#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/joint_friction.hpp"
#include "model/read_scene.hpp"
#include "motion/confirmed_motion.hpp"
#include "motion/contacts.hpp"
#include "motion/simulate.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/touching_scenes.hpp"

namespace poise::touching_test {
namespace {

using Kind = ContactEvent::Kind;

constexpr double g = 9.81;

Motion moved(const std::string& text, double duration, const test::Release& release = {}) {
  const MotionModel model(resisted_by_joints(parse_scene(text, "scene.toml")));
  return test::moved(model, test::released(model, release), duration);
}

std::vector<ContactEvent> of_kind(const Motion& motion, Kind kind) {
  std::vector<ContactEvent> out;
  std::copy_if(motion.events.begin(), motion.events.end(), std::back_inserter(out),
               [&](const ContactEvent& event) { return event.kind == kind; });
  return out;
}

// A ball of 1 kg that falls by 1 m on a floor.
std::string ball(double e) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.ball]
points = {{ C = [0, 0] }}
mass = 1
[[slide]]
name = "y"
points = ["ground.O", "ball.C"]
axis = [0, 1]
[[stop]]
name = "floor"
slide = "y"
min = 0
restitution = {}
[start]
y = 1
)",
                     e);
}

// Times of impacts: t1, then flights of 2 v e^k / g; the end of all at t1 (1 + e) / (1 - e).
TEST(Touching, ABallBouncesAndComesToRestAtTheLimitOfItsTimes) {
  constexpr double e = 0.8;
  const double t1 = std::sqrt(2 / g), v1 = std::sqrt(2 * g);
  const Motion motion = moved(ball(e), 5.0);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  const std::vector<ContactEvent> impacts = of_kind(motion, Kind::impact);
  ASSERT_GE(impacts.size(), 30U);
  double t = t1, v = v1;
  for (std::size_t k = 0; k < 30; ++k) {
    EXPECT_NEAR(impacts[k].t, t, 1e-12) << "impact " << k;
    EXPECT_NEAR(impacts[k].rate_before, -v, 1e-11);
    EXPECT_NEAR(impacts[k].rate_after, e * v, 1e-11);
    EXPECT_NEAR(impacts[k].impulse, (1 + e) * v, 1e-11);
    EXPECT_NEAR(impacts[k].energy_lost, (1 - e * e) * v * v / 2, 1e-11);
    EXPECT_TRUE(impacts[k].unique);
    v *= e;
    t += 2 * v / g;
  }
  const std::vector<ContactEvent> rests = of_kind(motion, Kind::rest);
  ASSERT_EQ(rests.size(), 1U);
  EXPECT_NEAR(rests[0].t, t1 * (1 + e) / (1 - e), 1e-9);
  EXPECT_LT(motion.energy_error, 1e-11);
  EXPECT_NEAR(motion.trajectory.q.back(), 0.0, 1e-12);
  EXPECT_EQ(motion.trajectory.v.back(), 0.0);
}

// Bounces that are within the accuracy are left out; the time at which all of them end is that of their series.
TEST(Touching, ACoarseMotionLeavesOutSmallBounces) {
  constexpr double e = 0.8;
  const MotionModel model(parse_scene(ball(e), "scene.toml"));
  const Motion motion = test::moved(model, test::released(model, {}), 5.0, 1e-3);
  const std::size_t bounces = of_kind(motion, Kind::impact).size();
  // e^2k falls below the square of the accuracy.
  EXPECT_EQ(bounces, static_cast<std::size_t>(std::ceil(std::log(1e-3) / std::log(e))));
  const std::vector<ContactEvent> rests = of_kind(motion, Kind::rest);
  ASSERT_EQ(rests.size(), 1U);
  EXPECT_NEAR(rests[0].t, std::sqrt(2 / g) * (1 + e) / (1 - e), 1e-12);
}

TEST(Touching, ABounceCostsAFewSteps) {
  const Motion motion = moved(ball(0.95), 6.0);
  const std::size_t bounces = of_kind(motion, Kind::impact).size();
  ASSERT_GE(bounces, 8U);
  EXPECT_LE(motion.evaluations, 13 * 5 * static_cast<int>(bounces) + 500);
}

TEST(Touching, WithoutRestitutionItStays) {
  const Motion motion = moved(ball(0.0), 2.0);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  EXPECT_EQ(motion.events.size(), 1U);
  EXPECT_NEAR(motion.trajectory.q.back(), 0.0, 1e-15);
  EXPECT_NEAR(motion.events[0].energy_lost, g, 1e-12);
}

// With restitution 1 nothing is lost.
TEST(Touching, AnElasticBallRisesAsHighAgain) {
  const double t1 = std::sqrt(2 / g);
  const Motion motion = moved(ball(1.0), 2 * t1);
  EXPECT_NEAR(motion.trajectory.q.back(), 1.0, 1e-11);
  EXPECT_LT(motion.energy_error, 1e-12);
}

// A mass on a rope of length L that hangs from a point at the height of its start, thrown sideways: it falls until
// the rope is taut, whose impulse takes the rate along it; then it swings as a pendulum, with m v^2 / L + m g cos.
TEST(Touching, ARopeSnapsTautAndSwings) {
  const std::string text = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.mass]
points = { C = [0, 0] }
mass = 2
inertia = 0.1
[[rope]]
name = "rope"
over = ["ground.O", "mass.C"]
length = 1
[start]
position = { mass = [0.6, 0] }
)";
  const Motion motion = moved(text, 1.5);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  ASSERT_FALSE(motion.events.empty());
  // It falls straight down by 0.8.
  const double t = std::sqrt(2 * 0.8 / g), v = g * t;
  const ContactEvent& taut = motion.events[0];
  EXPECT_NEAR(taut.t, t, 1e-13);
  EXPECT_NEAR(taut.rate_before, -v * 0.8, 1e-12);
  EXPECT_NEAR(taut.rate_after, 0.0, 1e-12);
  EXPECT_NEAR(taut.impulse, 2 * v * 0.8, 1e-12);
  EXPECT_NEAR(taut.energy_lost, 2 * v * v * 0.64 / 2, 1e-12);
  EXPECT_LT(motion.energy_error, 1e-11);
}

// A cam at constant speed lifts its follower off where  m y'' + k y + F0 = 0  first: cycloidal rise of 10 mm in 90
// degrees, 0.35 kg, 12 N/mm preloaded by 150 N, dwell to 120, return to 210: at 1625.77 rpm.
std::string cam(double rpm) {
  return fmt::format(R"(
gravity = [0, 0]
[units]
length = "mm"
angle = "deg"
[ground]
points = {{ O = [0, 0], F = [0, 0] }}
[body.cam]
points = {{ O = [0, 0], P = [10, 0] }}
[body.follower]
points = {{ P = [0, 0] }}
mass = 0.35
[[pin]]
name = "shaft"
points = ["ground.O", "cam.O"]
[[slide]]
name = "guide"
points = ["ground.F", "follower.P"]
axis = [0, 1]
[[cam]]
name = "valve"
bodies = ["ground", "cam"]
follower = {{ slide = "guide" }}
law = [
  {{ to = 90, lift = 1, law = "cycloidal" }},
  {{ to = 120, lift = 1, law = "dwell" }},
  {{ to = 210, lift = 0, law = "cycloidal" }},
  {{ to = 360, lift = 0, law = "dwell" }},
]
lift = 10
base = 0
[[spring]]
name = "return"
slide = "guide"
stiffness = 12
free_length = -12.5
[[drive]]
name = "motor"
bodies = ["ground", "cam"]
rate = {}
[start]
cam = 0
guide = 0
)",
                     rpm * 6);
}

TEST(Touching, ACamLiftsItsFollowerOffAboveItsSpeed) {
  const double turn = 60 / 1625.77;
  const Motion below = moved(cam(1625.5), turn);
  ASSERT_EQ(below.status, MotionStatus::completed) << below.why;
  EXPECT_TRUE(of_kind(below, Kind::lift_off).empty());
  const Motion above = moved(cam(1626.0), turn);
  ASSERT_EQ(above.status, MotionStatus::completed) << above.why;
  EXPECT_FALSE(of_kind(above, Kind::lift_off).empty());
  EXPECT_FALSE(of_kind(above, Kind::impact).empty()) << "it comes back";
  EXPECT_LT(above.energy_error, 1e-8);
}

// x'' + 2 z x' + x = F cos(W t) and a wall at x = 1 with restitution 0.8: from a state just behind the impact of the
// periodic motion (phase and rate of ../shared/benchmarks.md 1.9) it hits once in each period, with that rate.
TEST(Touching, AnImpactOscillatorHitsOnceInEachPeriod) {
  const double period = 2 * std::numbers::pi / 0.8;
  const std::string text = R"toml(
gravity = [0, 0]
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 1
[[slide]]
name = "x"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[spring]]
name = "k"
slide = "x"
stiffness = 1
free_length = 0
[[damper]]
name = "c"
slide = "x"
coefficient = 0.1
[[force]]
name = "F"
at = "block.C"
vector = [0.6, 0]
time = { function = "cos(0.8*t + 0.00371112996)" }
[[stop]]
name = "wall"
slide = "x"
max = 1
restitution = 0.8
[start]
x = 1
)toml";
  const Motion motion = moved(text, 20 * period, {{}, {{"x", -0.8 * 0.698921656280}}});
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  const std::vector<ContactEvent> impacts = of_kind(motion, Kind::impact);
  ASSERT_GE(impacts.size(), 19U);
  for (std::size_t k = 0; k < 19; ++k) {
    EXPECT_NEAR(impacts[k].rate_before, -0.698921656280, 1e-9);
    EXPECT_NEAR(impacts[k].t, period * (static_cast<double>(k) + 1), 1e-8);
  }
}

/// Two rods in series that strike the stops of their elbow and a floor, which gives back as the last key says.
std::string two_rods(const char* floor) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.upper]
points = {{ O = [0, 0], E = [1, 0] }}
mass = 1
inertia = 0.1
center = [0.5, 0]
[body.lower]
points = {{ E = [0, 0], T = [1, 0] }}
mass = 1
inertia = 0.1
center = [0.5, 0]
[[pin]]
name = "O"
points = ["ground.O", "upper.O"]
[[pin]]
name = "E"
points = ["upper.E", "lower.E"]
[[stop]]
name = "elbow"
bodies = ["upper", "lower"]
min = -1
max = 0.5
restitution = 0.5
[[stop]]
name = "floor"
y = "lower.T"
min = -1.6
{}
[start]
upper = 0.4
lower = 0.3
)",
                     floor);
}

// Two rods in series hit their stops: energy balances, and no stop is passed.
TEST(Touching, NothingPassesItsStop) {
  const std::string text = two_rods("restitution = 0.3");
  const Motion motion = moved(text, 4.0);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  EXPECT_GT(motion.events.size(), 5U);
  EXPECT_LT(motion.energy_error, 1e-9);
  const std::size_t n = 2;
  for (std::size_t k = 0; k < motion.trajectory.nodes(); ++k) {
    const double a = motion.trajectory.q[k * n], b = motion.trajectory.q[k * n + 1];
    EXPECT_GT(b - a, -1 - 1e-10);
    EXPECT_LT(b - a, 0.5 + 1e-10);
    EXPECT_GT(std::sin(a) + std::sin(b), -1.6 - 1e-10);
  }
}

TEST(Touching, AStartInsideAStopIsRefused) { EXPECT_THROW(moved(ball(0.5), 1.0, {{{"y", -0.1}}, {}}), InputError); }

// A drive that pushes its own slide against the stop.
TEST(Touching, ADriveThatPushesAgainstAStopEndsTheMotion) {
  const MotionModel model(parse_scene(ball(0.5) + R"(
[[drive]]
name = "ram"
slide = "y"
rate = -1
)",
                                      "scene.toml"));
  MotionOptions options;
  options.duration = 2.0;
  const Motion motion = simulate(model, test::released(model, {}), options);
  EXPECT_EQ(motion.status, MotionStatus::jammed);
  EXPECT_NE(motion.why.find("drives push against stop \"floor\""), std::string::npos) << motion.why;
  EXPECT_NEAR(motion.trajectory.t.back(), 1.0, 1e-12);
}

// Derivatives across impacts, contact that lasts and lift-off are those of motions that differ a little.
TEST(Touching, SensitivitiesJumpWithTheMotion) {
  const auto end = [&](double x0, double rate, double t, bool sensitive) {
    const MotionModel model(parse_scene(two_rods(""), "scene.toml"));
    MotionOptions options;
    options.duration = t;
    options.accuracy = 1e-12;
    options.sensitivities = sensitive;
    const MotionState start{{x0, 0.3}, {rate, 0.0}};
    return simulate(model, start, options);
  };
  for (const double t : {0.3, 0.6, 0.9, 1.2}) {
    const Motion motion = end(0.4, 0.1, t, true);
    ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
    constexpr double d = 1e-6;
    const std::size_t last = motion.trajectory.q.size() - 2, columns = 4;
    for (int column = 0; column < 3; column += 2) {
      const Motion less = end(0.4 - (column == 0 ? d : 0), 0.1 - (column == 2 ? d : 0), t, false);
      const Motion more = end(0.4 + (column == 0 ? d : 0), 0.1 + (column == 2 ? d : 0), t, false);
      for (std::size_t i = 0; i < 2; ++i) {
        const double by = (more.trajectory.q[more.trajectory.q.size() - 2 + i] -
                           less.trajectory.q[less.trajectory.q.size() - 2 + i]) /
                          (2 * d);
        const double by_rate = (more.trajectory.v[more.trajectory.v.size() - 2 + i] -
                                less.trajectory.v[less.trajectory.v.size() - 2 + i]) /
                               (2 * d);
        const std::size_t at = (last + i) * columns + static_cast<std::size_t>(column);
        EXPECT_NEAR(motion.trajectory.q_p[at], by, 1e-6 * (1 + std::abs(by))) << t << " " << column << " " << i;
        EXPECT_NEAR(motion.trajectory.v_p[at], by_rate, 1e-5 * (1 + std::abs(by_rate)))
            << t << " " << column << " " << i;
      }
    }
  }
}

// A rod of 1 kg and half length 0.5 whose lower end slides on a rough floor at 1 m/s, at this angle and rate, such that
// friction presses it onto the floor (../shared/benchmarks.md 1.4).
std::string rod(double mu, double degrees, double e = 0.0) {
  const double angle = degrees * std::numbers::pi / 180;
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.rod]
points = {{ A = [-0.5, 0], B = [0.5, 0], C = [0, 0] }}
mass = 1
inertia = {}
[[stop]]
name = "floor"
y = "rod.A"
min = 0
friction = {}
restitution = {}
[start]
position = {{ rod = [0, {}] }}
rod = {}
)",
                     1.0 / 12, mu, e, 0.5 * std::sin(angle), angle);
}

std::size_t coordinate_named(const MotionModel& model, const std::string& name) {
  const std::vector<Coordinate>& all = model.layout().coordinates;
  return static_cast<std::size_t>(
      std::find_if(all.begin(), all.end(), [&](const Coordinate& one) { return one.name == name; }) - all.begin());
}

Motion slide(double mu, double degrees, double omega, double duration) {
  const double angle = degrees * std::numbers::pi / 180;
  const MotionModel model(resisted_by_joints(parse_scene(rod(mu, degrees), "scene.toml")));
  MotionState start = test::released(model, {});
  start.v[coordinate_named(model, "rod")] = omega;
  start.v[coordinate_named(model, "rod.x")] = -1.0 - 0.5 * std::sin(angle) * omega;
  start.v[coordinate_named(model, "rod.y")] = 0.5 * std::cos(angle) * omega;
  MotionOptions options;
  options.duration = duration;
  return simulate(model, start, options);
}

// N p + b = 0 with p = 1 + 3 cos^2 - 3 mu sin cos, b = l omega^2 sin - g, where that has one solution.
TEST(Touching, ARoughFloorCarriesASlidingRod) {
  for (const auto& [mu, degrees, N] : {std::tuple{1.2, 60.0, 51.3198048696}, std::tuple{2.0, 20.0, 5.70115542078}}) {
    const Motion motion = slide(mu, degrees, 0.0, 1e-3);
    ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
    // The second node has the accelerations with contact.
    const auto n = static_cast<std::size_t>(motion.trajectory.coordinates);
    EXPECT_NEAR(motion.trajectory.a[n + 2] + g, N, 1e-8);
    EXPECT_LT(motion.energy_error, 1e-10);
  }
}

// A block of 1 kg that slides at 2 m/s against a push of t N, on a floor with the friction 0.3: it stops after
// 2 = mu g t + t^2 / 2, and slides again once the push passes mu g.
TEST(Touching, FrictionThatHoldsAndSlidesAreEvents) {
  const MotionModel model(resisted_by_joints(parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 1
inertia = 1
[[stop]]
name = "floor"
y = "block.C"
min = 0
friction = 0.3
[[force]]
at = "block.C"
vector = [10, 0]
time = { ramp = { from = 0, to = 1, start = 0, end = 10, law = "linear" } }
[start]
position = { block = [0, 0] }
)",
                                                         "scene.toml")));
  MotionState start = test::released(model, {});
  start.v[coordinate_named(model, "block.x")] = -2.0;
  const Motion motion = test::moved(model, start, 3.5);
  const double bound = 0.3 * g;
  ASSERT_EQ(motion.events.size(), 2U) << "it begins on the floor";
  EXPECT_EQ(motion.events[0].kind, Kind::stick);
  EXPECT_NEAR(motion.events[0].t, std::sqrt(bound * bound + 4.0) - bound, 1e-11);
  EXPECT_EQ(motion.events[1].kind, Kind::slide);
  EXPECT_NEAR(motion.events[1].t, bound, 1e-11);
  EXPECT_FALSE(motion.events[1].at.upper);
}

// What an impact leaves of a rate by rounding is no bounce, which would end at a time that is rounding, too.
TEST(Touching, ABallThatDoesNotReboundRollsAtOnce) {
  const Motion motion = moved(test::ball_on_slope, 0.6);
  ASSERT_EQ(motion.events.size(), 2U);
  EXPECT_EQ(motion.events[0].kind, Kind::impact);
  EXPECT_EQ(motion.events[0].rate_after, 0.0);
  EXPECT_EQ(motion.events[1].kind, Kind::stick);
  EXPECT_EQ(motion.events[1].t, motion.events[0].t);
}

TEST(Touching, PainlevesRodIsNamed) {
  const Motion none = slide(2.0, 60.0, 0.0, 0.1);
  EXPECT_EQ(none.status, MotionStatus::stuck);
  EXPECT_NE(none.why.find("Painleve"), std::string::npos) << none.why;
  const Motion several = slide(2.0, 60.0, 6.0, 0.1);
  EXPECT_EQ(several.status, MotionStatus::stuck);
  EXPECT_NE(several.why.find("more than one motion"), std::string::npos) << several.why;
}

// A block of half width 0.1 and half height 0.5 that rocks on its corners without sliding (G. W. Housner, 1963):
// quarter periods of the exact equation, and the rates after each impact over those before, 1 - 1.5 sin^2 alpha =
// 49/52.
TEST(Touching, ABlockRocks) {
  const double alpha = std::atan(0.2), from = 0.5 * alpha, R = std::hypot(0.1, 0.5);
  // Tipped about its right corner by `from`, clockwise.
  const double x = 0.1 - R * std::sin(alpha - from), y = R * std::cos(alpha - from);
  const std::string text = fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.block]
points = {{ L = [-0.1, -0.5], R = [0.1, -0.5] }}
mass = 1
inertia = {}
[[stop]]
name = "left"
y = "block.L"
min = 0
friction = 2
[[stop]]
name = "right"
y = "block.R"
min = 0
friction = 2
[start]
position = {{ block = [{}, {}] }}
block = {}
)",
                                       (0.01 + 0.25) / 3, x, y, -from);
  const Motion motion = moved(text, 4.0);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  const std::vector<ContactEvent> impacts = of_kind(motion, Kind::impact);
  ASSERT_GE(impacts.size(), 3U);
  EXPECT_NEAR(impacts[0].t, 1.38837434716 / 4, 1e-10);
  // Amplitudes after one, two and four impacts from half of alpha, over alpha: half periods follow from them.
  const auto quarter = [&](double amplitude) {
    // The exact quarter period by quadrature with psi = alpha - a cosh-like substitution is left to a fine midpoint sum
    // in s, psi = alpha - theta0 + theta0 s^2.
    const double p2 = 3 * g / (4 * R);
    double sum = 0.0;
    constexpr int n = 200'000;
    for (int k = 0; k < n; ++k) {
      const double s = (k + 0.5) / n, theta0 = amplitude * alpha, psi = alpha - theta0 + theta0 * s * s;
      const double fall = std::cos(alpha - theta0) - std::cos(psi);
      sum += 2 * theta0 * s / std::sqrt(2 * p2 * fall) / n;
    }
    return sum;
  };
  EXPECT_NEAR(impacts[1].t - impacts[0].t, 2 * quarter(0.422193453732), 1e-8);
  EXPECT_NEAR(impacts[2].t - impacts[1].t, 2 * quarter(0.360967869687), 1e-8);
  EXPECT_LT(motion.energy_error, 1e-9);
}

// A cylinder of the radius 0.1 rolls from the top of another one of the radius 0.3, on which it is kept by its weight
// as long as  g cos a > (R + r) a'^2,  with  (R + r) a'^2 = 4/3 g (cos a_0 - cos a):  until cos a = 4/7 cos a_0.
TEST(Touching, ACylinderLeavesTheOneOnWhichItRolls) {
  constexpr double from = 0.05;
  const std::string text = fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.cylinder]
points = {{ C = [0, 0] }}
mass = 2
inertia = 0.01
[[rolling_on_circle]]
name = "ridge"
wheel = "cylinder.C"
center = "ground.O"
radius = 0.1
circle_radius = 0.3
[start]
position = {{ cylinder = [{:.17g}, {:.17g}] }}
cylinder = {:.17g}
ridge = {:.17g}
)",
                                       0.4 * std::sin(from), 0.4 * std::cos(from), 4 * (std::numbers::pi / 2 - from),
                                       std::numbers::pi / 2 - from);
  const MotionModel model(resisted_by_joints(parse_scene(text, "scene.toml")));
  MotionOptions options;
  options.duration = 5.0;
  options.accuracy = 1e-12;
  const Motion motion = simulate(model, test::released(model, {}), options);
  ASSERT_EQ(motion.status, MotionStatus::lifted_off) << motion.why;
  EXPECT_NE(motion.why.find("\"ridge\" lifts off"), std::string::npos) << motion.why;
  const std::size_t last = motion.trajectory.t.size() - 1;
  const double x = test::q_at(motion, last)[coordinate_named(model, "cylinder.x")];
  const double y = test::q_at(motion, last)[coordinate_named(model, "cylinder.y")];
  EXPECT_NEAR(y / std::hypot(x, y), 4.0 / 7 * std::cos(from), 1e-9);
}

// A wheel on a line that a load lifts by more than its weight from t = 9.81 / 4 on; and from the start.
TEST(Touching, AWheelLiftsOffItsLine) {
  const auto lifted = [](double slope, double constant) {
    const std::string text = fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.wheel]
points = {{ C = [0, 0] }}
mass = 1
inertia = 0.005
[[rolling]]
name = "tyre"
wheel = "wheel.C"
line = "ground.O"
axis = [1, 0]
radius = 0.1
[[force]]
at = "wheel.C"
vector = [0, 1]
time = {{ function = "{} + {}*t" }}
[start]
position = {{ wheel = [0, 0.1] }}
)",
                                         constant, slope);
    const MotionModel model(resisted_by_joints(parse_scene(text, "scene.toml")));
    MotionOptions options;
    options.duration = 5.0;
    return simulate(model, test::released(model, {}), options);
  };
  const Motion later = lifted(4.0, 0.0);
  EXPECT_EQ(later.status, MotionStatus::lifted_off) << later.why;
  EXPECT_NEAR(later.trajectory.t.back(), 9.81 / 4, 1e-8);
  const Motion at_once = lifted(0.0, 9.82);
  EXPECT_EQ(at_once.status, MotionStatus::lifted_off) << at_once.why;
  EXPECT_EQ(at_once.trajectory.t.back(), 0.0);
  EXPECT_EQ(lifted(0.0, 9.8).status, MotionStatus::completed);
}

// P. Flores, R. Leine, C. Glocker, Multibody System Dynamics 23, 2010: a slider with clearance in its guide, whose
// upper corners hit the guide first at once (../shared/benchmarks.md 1.7).
TEST(Touching, ASliderWithClearanceHitsItsGuide) {
  std::string text = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [0.153, 0] }
mass = 0.038
center = [0.0765, 0]
inertia = 7.4e-5
[body.rod]
points = { A = [0, 0], B = [0.306, 0] }
mass = 0.038
center = [0.153, 0]
inertia = 5.9e-4
[body.slider]
points = { B = [0, 0], LU = [-0.05, 0.025], RU = [0.05, 0.025], LL = [-0.05, -0.025], RL = [0.05, -0.025] }
mass = 0.076
inertia = 2.7e-6
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "rod.A"]
[[pin]]
name = "B"
points = ["rod.B", "slider.B"]
[start]
crank = 0
rod = 0
slider = 0
)";
  for (const char* corner : {"LU", "RU", "LL", "RL"}) {
    text += fmt::format(
        "[[stop]]\nname = \"{0}\"\ny = \"slider.{0}\"\nmin = -0.026\nmax = 0.026\nrestitution = 0.4\nfriction = 0.01\n",
        corner);
  }
  const MotionModel model(resisted_by_joints(parse_scene(text, "scene.toml")));
  MotionState start = test::released(model, {});
  start.v[coordinate_named(model, "crank")] = 150.0;
  start.v[coordinate_named(model, "rod")] = -75.0;
  MotionOptions options;
  options.duration = 0.1;
  const Motion motion = simulate(model, start, options);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  ASSERT_GT(motion.events.size(), 4U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(motion.events[k].t, 0.00269250275202, 1e-12);
    EXPECT_NEAR(motion.events[k].rate_before, -0.841612322033, 1e-9);
    EXPECT_TRUE(motion.events[k].at.upper);
  }
  EXPECT_LT(motion.energy_error, 1e-9);
}

// A cart of 1 kg that hits the end stop of its crank drive: the impulse through the stop is that of the reduced mass.
TEST(Touching, ASliderCrankHitsItsEndStop) {
  const std::string text = R"(
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [0.1, 0] }
inertia = 0.02
[body.rod]
points = { A = [0, 0], B = [0.3, 0] }
[body.ram]
points = { B = [0, 0] }
mass = 2
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "rod.A"]
[[pin]]
name = "B"
points = ["rod.B", "ram.B"]
[[slide]]
name = "guide"
points = ["ground.O", "ram.B"]
axis = [1, 0]
[[stop]]
name = "end"
slide = "guide"
min = 0.25
restitution = 0.5
[start]
crank = 0.6
rod = -0.19
guide = 0.37
)";
  const Motion motion = moved(text, 1.0, {{}, {{"crank", 3.0}}});
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  ASSERT_FALSE(motion.events.empty());
  const ContactEvent& hit = motion.events[0];
  // At x = r cos a + sqrt(l^2 - r^2 sin^2 a) = 0.25; energy gives the rate, I + m (dx/da)^2 is the mass of the angle.
  const double r = 0.1, l = 0.3;
  const auto place = [&](double a) { return r * std::cos(a) + std::sqrt(l * l - r * r * std::sin(a) * std::sin(a)); };
  const double from = motion.trajectory.q[0];
  double low = from, high = 3.0;
  for (int k = 0; k < 100; ++k) (place((low + high) / 2) > 0.25 ? low : high) = (low + high) / 2;
  const auto slope = [&](double a) {
    return -r * std::sin(a) * (1 + r * std::cos(a) / std::sqrt(l * l - r * r * std::sin(a) * std::sin(a)));
  };
  const auto mass = [&](double a) { return 0.02 + 2 * slope(a) * slope(a); };
  const double rate = 3.0 * std::sqrt(mass(from) / mass(low)), closing = slope(low) * rate;
  EXPECT_NEAR(hit.rate_before, closing, 1e-10);
  EXPECT_NEAR(hit.rate_after, -0.5 * closing, 1e-10);
  EXPECT_NEAR(hit.impulse, -1.5 * closing * mass(low) / (slope(low) * slope(low)), 1e-9);
}

Motion of_dataset(const std::string& name, double duration, const test::Release& release = {}) {
  const MotionModel model(read_scene(std::string(POISE_SOURCE_DIR) + "/datasets/" + name + ".toml"));
  return test::moved(model, test::released(model, release), duration);
}

// The clamp comes to rest where statics finds it, and where the static stop holds it.
TEST(Touching, TheToggleClampClosesOntoItsStop) {
  const Motion motion = of_dataset("toggle_clamp_closing", 0.05, {{{"handle", 92.5 * std::numbers::pi / 180}}, {}});
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  EXPECT_NEAR(motion.trajectory.q[motion.trajectory.q.size() - 3], 1.6337822873154150442, 1e-9);
  EXPECT_NEAR(of_kind(motion, Kind::impact).front().t, 0.00375, 1e-5);
  EXPECT_NEAR(of_kind(motion, Kind::rest).back().t, 0.00794, 1e-5);
  EXPECT_LT(motion.energy_error, 1e-9);
}

TEST(Touching, ALandingGearFallsIntoItsLock) {
  const Motion motion = of_dataset("landing_gear_drop", 2.0);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  EXPECT_NEAR(of_kind(motion, Kind::impact).front().t, 0.737, 1e-3);
  EXPECT_NEAR(of_kind(motion, Kind::rest).back().t, 0.8242, 1e-4);
  ASSERT_FALSE(motion.touched.empty());
  EXPECT_EQ(motion.touched.back().touching.size(), 1U);
}

// A block that falls turning on a floor with a spike: as outlines of both, it moves as with a contact for each of its
// corners on the floor, and one for the tip of the spike on its outline; without loss its energy stays.
TEST(Touching, ABlockFallsOnASpikeByItsOutline) {
  const std::string block = R"(
gravity = [0, -9.81]
[ground]
points = { L = [-3, 0], S = [-0.1, 0], T = [0, 0.15], U = [0.1, 0], R = [3, 0] }
[body.block]
points = { A = [-0.2, -0.1], B = [-0.2, 0.1], C = [0.2, 0.1], D = [0.2, -0.1] }
mass = 2
center = [0, 0]
inertia = 0.04
[start]
block = 0.4
[start.position]
block = [0.03, 0.9]
)";
  const std::string outlines = R"([[contact]]
name = "block on floor"
outline = ["block.A", "block.B", "block.C", "block.D"]
closed = true
against = ["ground.L", "ground.S", "ground.T", "ground.U", "ground.R"]
restitution = 1
)";
  std::string points;
  for (const char corner : {'A', 'B', 'C', 'D'}) {
    points += fmt::format(
        "[[contact]]\nname = \"corner {0}\"\npoint = \"block.{0}\"\nrestitution = 1\n"
        "outline = [\"ground.L\", \"ground.S\", \"ground.T\", \"ground.U\", \"ground.R\"]\n",
        corner);
  }
  points +=
      "[[contact]]\nname = \"tip\"\npoint = \"ground.T\"\nrestitution = 1\nclosed = true\n"
      "outline = [\"block.A\", \"block.B\", \"block.C\", \"block.D\"]\n";
  const test::Release release{{}, {{"block", 1.5}}};
  const auto split = block.find("[start]");
  const Motion whole = moved(block.substr(0, split) + outlines + block.substr(split), 1.2, release);
  const Motion parts = moved(block.substr(0, split) + points + block.substr(split), 1.2, release);
  ASSERT_GE(whole.events.size(), 3U);
  EXPECT_LT(whole.energy_error, 1e-8);
  for (const double t : {0.3, 0.6, 0.9, 1.2}) {
    const std::vector<double> a = test::read_at(whole, {t}).front().q, b = test::read_at(parts, {t}).front().q;
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-6) << t;
  }
  // The tip of the spike hits the block.
  const MotionModel model(parse_scene(block.substr(0, split) + outlines + block.substr(split), "scene.toml"));
  EXPECT_TRUE(std::any_of(whole.events.begin(), whole.events.end(), [&](const ContactEvent& event) {
    return event.kind == Kind::impact && model.scene().stops[static_cast<std::size_t>(event.at.stop)].on.b.body == 0;
  }));
}

// A bar that lies through a post, of which no corner is in the other.
TEST(Touching, NoMotionBeginsWhereOutlinesCross) {
  const std::string crossed = R"(
[ground]
points = { A = [-0.1, -1], B = [-0.1, 1], C = [0.1, 1], D = [0.1, -1] }
[body.bar]
points = { P = [-1, -0.1], Q = [-1, 0.1], R = [1, 0.1], S = [1, -0.1] }
mass = 1
inertia = 0.3
[[contact]]
name = "post"
outline = ["bar.P", "bar.Q", "bar.R", "bar.S"]
closed = true
against = ["ground.A", "ground.B", "ground.C", "ground.D"]
against_closed = true
[start.position]
bar = [0, 0]
)";
  EXPECT_EQ(
      test::message_of([&] { moved(crossed, 0.1); }),
      "scene.toml:8: contact \"post\": the motion would begin where its outlines cross each other; expected a start "
      "in which they are apart");
  const std::string beside = crossed.substr(0, crossed.find("bar = [0, 0]")) + "bar = [1.2, 0]\n";
  EXPECT_TRUE(moved(beside, 0.1).completed());
}

}  // namespace
}  // namespace poise::touching_test
