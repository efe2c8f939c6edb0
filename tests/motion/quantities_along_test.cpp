// Quantities of mechanisms in motion, against closed forms, hand-written energies and differences over time.

#include "motion/quantities_along.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "model/scene.hpp"
#include "statics/bodies/forces_on_bodies.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::quantities_along_test {
namespace {

constexpr double pi = std::numbers::pi;

/// A scene that moves, and quantities of it over time.
class Moving {
 public:
  Moving(Scene given, const test::Release& release, double duration)
      : scene_(std::move(given)),
        model_(resisted_by_joints(scene_)),
        motion_(test::moved(model_, test::released(model_, release), duration)),
        along_(scene_, model_, motion_) {}

  SoughtQuantity find(const std::string& name) const { return find_quantity(scene_, name, AskedOf::motion); }
  double at(const std::string& name, double t) { return along_.value(find(name), t); }
  QuantityRange range(const std::string& name) { return along_.ranges({find(name)}).front(); }
  double imbalance() const { return along_.imbalance(); }
  const Scene& scene() const { return scene_; }
  const MotionModel& model() const { return model_; }
  const Motion& motion() const { return motion_; }
  double end() const { return motion_.trajectory.t.back(); }

 private:
  Scene scene_;
  MotionModel model_;
  Motion motion_;
  QuantitiesAlong along_;
};

/// A derivative by differences of fourth order.
template <class F>
double slope(F f, double x, double h) {
  return (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h);
}

// ---- A pendulum ----

constexpr double m = 2.0, l = 0.8, d = 0.3, inertia = 0.1, g = 9.81;
constexpr double about_pin = inertia + m * d * d;

Scene pendulum() {
  return parse_scene(fmt::format(R"(
gravity = [0, {}]
[ground]
points = {{ O = [0.4, 1.5] }}
[body.bar]
points = {{ A = [0, 0], B = [{}, 0] }}
mass = {}
center = [{}, 0]
inertia = {}
[[pin]]
name = "O"
points = ["ground.O", "bar.A"]
[[damper]]
name = "idle"
points = ["ground.O", "bar.B"]
coefficient = 3
)",
                                 -g, l, m, d, inertia),
                     "pendulum.toml");
}

constexpr double released_at = 1.1;  // rad from the vertical

/// Released at rest; the bar hangs at -90 degrees.
Moving swinging(double duration) { return {pendulum(), {.places = {{"bar", released_at - pi / 2}}}, duration}; }

// The square of the rate is that of the energy, m g d (cos phi - cos phi_0) = J w^2 / 2.
TEST(QuantitiesAlong, APinCarriesAPendulumAsInClosedForm) {
  Moving moving = swinging(2.0);
  for (int k = 0; k <= 40; ++k) {
    const double t = 0.05 * k;
    const double phi = moving.at("angle.bar", t) + pi / 2;
    const double w_squared = 2 * m * g * d * (std::cos(phi) - std::cos(released_at)) / about_pin;
    const double alpha = -m * g * d * std::sin(phi) / about_pin;
    // Along the bar to the pin, and across it, where the bar turns forward.
    const double along = m * g * std::cos(phi) + m * d * w_squared;
    const double across = m * g * std::sin(phi) + m * d * alpha;
    const double x = -along * std::sin(phi) + across * std::cos(phi);
    const double y = along * std::cos(phi) + across * std::sin(phi);
    EXPECT_NEAR(moving.at("reaction.O.x", t), x, 1e-7 * m * g) << t;
    EXPECT_NEAR(moving.at("reaction.O.y", t), y, 1e-7 * m * g) << t;
    EXPECT_NEAR(moving.at("reaction.O", t), std::hypot(x, y), 1e-7 * m * g) << t;
    EXPECT_NEAR(moving.at("shaking.x", t), -x, 1e-7 * m * g) << t;
    EXPECT_NEAR(moving.at("shaking.y", t), -y, 1e-7 * m * g) << t;
    EXPECT_NEAR(moving.at("shaking.moment", t), -(0.4 * y - 1.5 * x), 2e-7 * m * g) << t;
    EXPECT_NEAR(moving.at("energy.kinetic", t), about_pin * w_squared / 2, 1e-9) << t;
    EXPECT_NEAR(moving.at("d(d(angle.bar)/dt)/dt", t), alpha, 1e-6 * g / d) << t;
    EXPECT_NEAR(moving.at("force.idle", t), 0.0, 1e-9) << "its length does not change";
    EXPECT_TRUE(std::isnan(moving.at("d(x.bar.B)/d(length.idle)", t))) << t;
  }
  EXPECT_LT(moving.imbalance(), 1e-7);
}

// A slender bar of mass m and length l that falls about its end, at the angle a above the ground, its rate w: at x
//   M = m g cos(a) x (l - x)^2 / (4 l^2),  V = dM/dx,  N = m/l (w^2 (l^2 - x^2)/2 - g sin(a) (l - x)),
// and the largest stress is in the extreme fibres where N/A and M e/I add up most.
TEST(QuantitiesAlong, AFallingChimneyIsBentAsInClosedForm) {
  constexpr double mass = 90000, length = 30, start = 80 * pi / 180, area = 2.5, second_moment = 2.0, half = 1.5;
  Scene scene = read_scene(test::dataset("structures/falling_chimney.toml"));
  for (const double x : {10.0, 17.0}) scene.bodies[1].points.push_back({fmt::format("P{:.0f}", x), {x, 0.2}});
  Moving moving(scene, {}, 3.0);
  double most = 0.0;
  for (int k = 0; k <= 12; ++k) {
    const double t = 0.25 * k, a = moving.at("angle.chimney", t);
    const double square = 3 * g / length * (std::sin(start) - std::sin(a));
    const auto bent = [&](double x) {
      return mass * g * std::cos(a) * x * (length - x) * (length - x) / (4 * length * length);
    };
    const auto pulled = [&](double x) {
      return mass / length * (square * (length * length - x * x) / 2 - g * std::sin(a) * (length - x));
    };
    for (const double x : {10.0, 17.0}) {
      const std::string point = fmt::format("chimney.P{:.0f}", x);
      const double size = mass * g * length;
      EXPECT_NEAR(std::abs(moving.at("moment." + point, t)), bent(x), 1e-9 * size) << t << point;
      const double shear = moving.at("shear." + point, t);
      const double sign = moving.at("moment." + point, t) > 0 ? 1.0 : -1.0;
      EXPECT_NEAR(sign * shear, slope(bent, x, 1e-3), 1e-8 * size) << t << point;
      EXPECT_NEAR(moving.at("normal." + point, t), pulled(x), 1e-8 * size) << t << point;
    }
    double largest = 0.0;
    for (int i = 0; i <= 3000; ++i) {
      const double x = length * i / 3000, by_bending = bent(x) * half / second_moment;
      largest = std::max(largest, std::abs(pulled(x) / area) + by_bending);
    }
    EXPECT_NEAR(moving.at("stress.chimney", t), largest, 1e-6 * largest) << t;
    most = std::max(most, largest);
  }
  EXPECT_GE(moving.range("stress.chimney").greatest.value, most);
  EXPECT_NEAR(moving.at("moment.chimney.T", 1.0), 0.0, 1e-6);
}

// It first hangs down after a quarter of the period 4 K(sin(phi_0 / 2)) / w_0, and there the pin carries most.
TEST(QuantitiesAlong, TheGreatestForceInThePinIsFoundBetweenTheSteps) {
  const double quarter = std::comp_ellint_1(std::sin(released_at / 2)) / std::sqrt(m * g * d / about_pin);
  Moving moving = swinging(1.9 * quarter);
  const QuantityRange force = moving.range("reaction.O");
  const double most = m * g + m * d * 2 * m * g * d * (1 - std::cos(released_at)) / about_pin;
  EXPECT_NEAR(force.greatest.value, most, 1e-7 * most);
  EXPECT_NEAR(force.greatest.time, quarter, 1e-4);
  const QuantityRange angle = moving.range("angle.bar");
  EXPECT_NEAR(angle.greatest.value, released_at - pi / 2, 1e-12);
  EXPECT_EQ(angle.greatest.time, 0.0);
  const QuantityRange rate = moving.range("d(angle.bar)/dt");
  EXPECT_NEAR(rate.mean, (moving.at("angle.bar", moving.end()) - angle.greatest.value) / moving.end(), 1e-9);
  EXPECT_NEAR(rate.least.value, -std::sqrt(2 * m * g * d * (1 - std::cos(released_at)) / about_pin), 1e-8);
}

TEST(QuantitiesAlong, RatesAreTheDifferencesOfWhatTheyAreOf) {
  Moving moving = swinging(1.0);
  constexpr double h = 1e-3;
  for (const std::string name : {"angle.bar", "x.bar.B", "reaction.O", "energy", "energy.kinetic", "shaking.moment",
                                 "x.bar.B * y.bar.B", "energy.kinetic * energy", "d(y.bar.B)/dt"}) {
    for (const double t : {0.1, 0.33, 0.52, 0.9}) {
      const double by_differences = slope([&](double at) { return moving.at(name, at); }, t, h);
      EXPECT_NEAR(moving.at("d(" + name + ")/dt", t), by_differences, 1e-6 * (1 + std::abs(by_differences)))
          << name << " at " << t;
    }
  }
  EXPECT_NEAR(moving.at("d(energy)/dt", 0.4), -moving.at("d(energy.kinetic)/dt", 0.4), 1e-6) << "nothing is lost";
}

// ---- A driven slider crank ----

constexpr double crank = 0.05, rod = 0.2, speed = 30.0, crank_center = 0.01, rod_center = 0.08;
constexpr double crank_mass = 1.0, rod_mass = 0.7, block_mass = 1.3, crank_inertia = 4e-3, rod_inertia = 3e-3;
constexpr double pressing = 12.0, damping = 5.0;

Scene slider_crank() {
  return parse_scene(fmt::format(R"(
gravity = [0, {}]
[ground]
points = {{ O = [0, 0] }}
[body.crank]
points = {{ A = [0, 0], B = [{}, 0] }}
mass = {}
center = [{}, 0]
inertia = {}
[body.rod]
points = {{ A = [0, 0], B = [{}, 0] }}
mass = {}
center = [{}, 0]
inertia = {}
[body.block]
points = {{ C = [0, 0] }}
mass = {}
[[pin]]
name = "O"
points = ["ground.O", "crank.A"]
[[pin]]
name = "B"
points = ["crank.B", "rod.A"]
[[pin]]
name = "C"
points = ["rod.B", "block.C"]
[[slide]]
name = "rail"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[force]]
name = "gas"
at = "block.C"
vector = [{}, 0]
[[damper]]
name = "oil"
slide = "rail"
coefficient = {}
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
start = 0.3
rate = {}
[start]
crank = 0.3
)",
                                 -g, crank, crank_mass, crank_center, crank_inertia, rod, rod_mass, rod_center,
                                 rod_inertia, block_mass, -pressing, damping, speed),
                     "slider_crank.toml");
}

double rod_angle(double theta) { return -std::asin(crank / rod * std::sin(theta)); }
double block_place(double theta) { return crank * std::cos(theta) + rod * std::cos(rod_angle(theta)); }
constexpr double small = 1e-3;
double block_slope(double theta) { return slope(block_place, theta, small); }

Vec2 rod_place(double theta) {
  const double beta = rod_angle(theta);
  return {crank * std::cos(theta) + rod_center * std::cos(beta), crank * std::sin(theta) + rod_center * std::sin(beta)};
}

/// Kinetic and potential energy at the angle theta while the crank turns at `speed`.
double energy_of(double theta) {
  const auto by_theta = [&](auto f) { return slope(f, theta, small); };
  const double x = by_theta([](double at) { return rod_place(at).x; });
  const double y = by_theta([](double at) { return rod_place(at).y; });
  const double beta = by_theta(rod_angle), s = block_slope(theta);
  const double reduced = crank_inertia + crank_mass * crank_center * crank_center + rod_mass * (x * x + y * y) +
                         rod_inertia * beta * beta + block_mass * s * s;
  const double height = crank_mass * crank_center * std::sin(theta) + rod_mass * rod_place(theta).y;
  return reduced * speed * speed / 2 + g * height;
}

/// What the motor needs: the rate of the energy, what the force takes and what the damper loses, over the speed.
double torque_of(double theta) {
  const double s = block_slope(theta);
  return slope(energy_of, theta, small) + pressing * s + damping * s * s * speed;
}

TEST(QuantitiesAlong, TheTorqueOfACrankIsThatOfVirtualPower) {
  Moving moving(slider_crank(), {}, 2 * pi / speed);
  for (int k = 0; k <= 50; ++k) {
    const double t = moving.end() * k / 50.0, theta = moving.at("angle.crank", t);
    EXPECT_NEAR(theta, 0.3 + speed * t, 1e-10);
    const double torque = torque_of(theta), s = block_slope(theta);
    EXPECT_NEAR(moving.at("force.motor", t), torque, 2e-6) << t;
    EXPECT_NEAR(moving.at("force.oil", t), damping * s * speed, 1e-8) << t;
    EXPECT_NEAR(moving.at("d(travel.rail)/d(angle.crank)", t), s, 1e-9) << t;
    EXPECT_NEAR(moving.at("d(travel.rail)/dt", t), s * speed, 1e-8) << t;
    if (std::abs(s) > 1e-3) {
      EXPECT_NEAR(moving.at("push.block.C.x", t), torque / s, 1e-5 / std::abs(s)) << t;
    }
  }
  EXPECT_LT(moving.imbalance(), 1e-7);
}

// ---- Everything else ----

/// Sum of m v of all bodies, and of their moments about the origin of the world.
struct Momentum {
  Vec2 linear{};
  double angular = 0.0;
};
Momentum momentum_at(const Moving& moving, double t) {
  const std::vector<test::Reading> read = test::read_at(moving.motion(), {t});
  const std::vector<double> none(read[0].q.size(), 0.0);
  const std::vector<BodyMotion> motions =
      body_motions(moving.model(), moving.model().from_si(read[0].q), moving.model().from_si(read[0].v), none);
  Momentum out;
  for (std::size_t i = 1; i < moving.scene().bodies.size(); ++i) {
    const Body& body = moving.scene().bodies[i];
    const Vec2 one = body.mass * motions[i].velocity_of(body.center);
    out.linear += one;
    out.angular += cross(motions[i].pose.world(body.center), one) + body.inertia * motions[i].rate;
  }
  return out;
}

TEST(QuantitiesAlong, WhatShakesTheGroundIsTheRateOfMomentum) {
  Scene scene = slider_crank();
  scene.forces.clear();
  Moving moving(std::move(scene), {}, 0.2);
  const double weight = g * (crank_mass + rod_mass + block_mass);
  constexpr double h = 2e-4;
  for (const double t : {0.01, 0.05, 0.12, 0.19}) {
    const double x = slope([&](double at) { return momentum_at(moving, at).linear.x; }, t, h);
    const double y = slope([&](double at) { return momentum_at(moving, at).linear.y; }, t, h);
    EXPECT_NEAR(moving.at("shaking.x", t), -x, 1e-4) << t;
    EXPECT_NEAR(moving.at("shaking.y", t), -weight - y, 1e-4) << t;
    EXPECT_NEAR(moving.at("shaking.size", t), std::hypot(x, weight + y), 1e-4) << t;
    const double turning = slope([&](double at) { return momentum_at(moving, at).angular; }, t, h);
    const double of_weights =
        -g * (crank_mass * crank_center * std::cos(moving.at("angle.crank", t)) +
              rod_mass * rod_place(moving.at("angle.crank", t)).x + block_mass * moving.at("travel.rail", t));
    EXPECT_NEAR(moving.at("shaking.moment", t), of_weights - turning, 1e-4) << t;
  }
}

// The sum of what joints, springs, dampers and drives do to the ground, where nothing else does.
TEST(QuantitiesAlong, WhatShakesTheGroundIsWhatActsOnIt) {
  const std::vector<Scene> scenes{slider_crank(), test::four_bar_with_everything(), test::driven_five_bar()};
  for (const Scene& scene : scenes) {
    Moving moving(scene, {}, 0.15);
    const auto n = static_cast<std::size_t>(moving.motion().trajectory.coordinates);
    std::vector<double> x(n), v(n), a(n);
    const std::size_t node = moving.motion().trajectory.nodes() - 1;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = moving.motion().trajectory.q[node * n + i];
      v[i] = moving.motion().trajectory.v[node * n + i];
      a[i] = moving.motion().trajectory.a[node * n + i];
    }
    const MotionModel& model = moving.model();
    const Forces forces = forces_in_motion(scene, model, model.from_si(x), model.from_si(v), model.from_si(a));
    Vec2 force{};
    double moment = 0.0;
    for (const SourcedForce& one : forces_on_bodies(scene, forces)) {
      if (one.on.body != 0) continue;
      force += one.on.force;
      moment += cross(one.on.at, one.on.force) + one.on.moment;
    }
    const double size = 1e-8 * (1 + forces.largest_force), t = moving.end();
    EXPECT_NEAR(moving.at("shaking.x", t), force.x, size) << scene.title;
    EXPECT_NEAR(moving.at("shaking.y", t), force.y, size) << scene.title;
    EXPECT_NEAR(moving.at("shaking.moment", t), moment, size * (1 + model.scales().length)) << scene.title;
  }
}

// The bodies balance where the forces are the ones that the accelerations need.
TEST(QuantitiesAlong, EveryBodyIsInBalanceWithItsInertia) {
  for (const auto& make : {test::four_bar_with_everything, test::four_bar_with_follower, test::quick_return,
                           test::quick_return_with_every_measure, test::driven_five_bar}) {
    Moving moving(make(), {}, 0.3);
    const std::string joint = "reaction." + moving.scene().joints.front().name;
    for (const double t : {0.02, 0.11, 0.2, 0.29}) moving.at(joint, t);
    EXPECT_LT(moving.imbalance(), 1e-6) << moving.scene().title;
  }
}

// Friction of joints makes forces in joints, on which it depends. The equations of motion know it in another way; at
// the steps of the integrator accelerations are theirs.
TEST(QuantitiesAlong, FrictionOfJointsIsTheOneThatTheMotionHas) {
  for (const auto& make : {test::rubbing_planet, test::rubbing_rack, test::rubbing_rollers}) {
    Moving moving(make(), {}, 0.3);
    const std::string joint = "reaction." + moving.scene().joints.front().name;
    const std::vector<double>& times = moving.motion().trajectory.t;
    int known = 0;
    for (std::size_t k = 2; k + 2 < times.size(); k += times.size() / 6) {
      const bool jumps = times[k] == times[k - 1] || times[k] == times[k + 1];
      if (!jumps && !std::isnan(moving.at(joint, times[k]))) ++known;
    }
    EXPECT_GT(known, 2) << moving.scene().title;
    EXPECT_LT(moving.imbalance(), 1e-6) << moving.scene().title;
  }
}

/// A block on a rail with dry friction of 5 N, pulled by c(t) N.
Scene block(const std::string& pull) {
  return parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.block]
points = { P = [0, 0] }
mass = 2
[[slide]]
name = "rail"
points = ["ground.O", "block.P"]
axis = [1, 0]
[[friction]]
name = "rub"
slide = "rail"
force = 5
width = 0
[[force]]
name = "pull"
at = "block.P"
vector = [1, 0]
)" + pull,
                     "block.toml");
}

// It holds until the pull exceeds 5 N, after which it slides.
TEST(QuantitiesAlong, FrictionThatHoldsIsWhatItHolds) {
  Scene scene = block("time = { table = [[0, 0], [1, 8]] }\n");
  Moving moving(std::move(scene), {}, 1.0);
  for (const double t : {0.1, 0.3, 0.6}) {
    EXPECT_NEAR(moving.at("force.rub", t), 8 * t, 1e-9) << "tension: it pulls back";
    EXPECT_NEAR(moving.at("d(force.rub)/dt", t), 8.0, 1e-7);
    EXPECT_NEAR(moving.at("shaking.x", t), 8 * t, 1e-9);
  }
  EXPECT_NEAR(moving.at("force.rub", 0.8), 5.0, 1e-9);
  EXPECT_NEAR(moving.at("d(d(travel.rail)/dt)/dt", 0.8), (8 * 0.8 - 5.0) / 2, 1e-7);
  EXPECT_NEAR(moving.range("force.rub").greatest.value, 5.0, 1e-9);
}

TEST(QuantitiesAlong, WhatHasNoMeaningInMotionIsRefused) {
  const Scene hanging = pendulum(), driven = slider_crank();
  const auto refused = [](const Scene& scene, const std::string& name) {
    return test::message_of([&] { refuse_at_rest_only(scene, find_quantity(scene, name, AskedOf::motion)); });
  };
  EXPECT_EQ(refused(hanging, "push.bar.B.x"),
            "push.bar.B.x: a push takes the place of the drive of a motion, and this one has none; expected another "
            "quantity, or one [[drive]] in the scene");
  EXPECT_EQ(refused(driven, "2 * fold.load.gas"),
            "2 * fold.load.gas: a load at a fold belongs to equilibria, not to a motion; expected another quantity");
  EXPECT_EQ(refused(driven, "push.block.C.x + 2 * force.oil * d(travel.rail)/d(x.block.C)"), "");
  EXPECT_EQ(refused(driven, "mode.1.frequency"),
            "mode.1.frequency: it belongs to an equilibrium, not to a motion; expected another quantity");
  EXPECT_NE(test::message_of([&] { find_quantity(hanging, "moment.bar.B"); }).find("moment.bar.B"), std::string::npos)
      << "a link without a section";
  EXPECT_NE(test::message_of([&] { find_quantity(hanging, "d(angle.bar)/dt"); }).find("nothing changes with time"),
            std::string::npos);
  EXPECT_NE(test::message_of([&] { find_quantity(hanging, "force.idle"); }).find("no force at rest"),
            std::string::npos);
}

}  // namespace
}  // namespace poise::quantities_along_test
