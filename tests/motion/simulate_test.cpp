#include "motion/simulate.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/vector_mechanics.hpp"

namespace poise::simulate_test {
namespace {

std::vector<double> times(double end, int count) {
  std::vector<double> t;
  for (int k = 0; k <= count; ++k) t.push_back(end * k / count);
  return t;
}

// m x'' + c x' + k (x - 1) = 0 on a rail, from x = 1.5 at rest: x is the distance of two points, the travel, a
// coordinate, or half the sum of two of them.
TEST(Simulate, MassOnASpringDiesAwayByItsClosedForm) {
  constexpr double m = 2.0, k = 50.0, c = 1.2;
  Scene rail;
  rail.add_point(0, "O", {0, 0});
  const int body = rail.add_body("mass");
  rail.add_point(body, "c", {0, 0});
  rail.bodies[body].mass = m;
  const int x_travel = test::add_slide(rail, "ground.O", "mass.c", {1, 0}, "x");
  rail.start.travel[x_travel] = 1.5;
  const PointRef b = test::point(rail, "mass.c");
  const Measure distance = Measure::distance_between(test::point(rail, "ground.O"), b);
  const Measure travel = Measure::travel_of(x_travel);
  const double decay = c / (2 * m);
  const double omega = std::sqrt(k / m - decay * decay);
  for (const Measure& on : {distance, travel, Measure::x_of(b), Measure::sum_of({{0.5, distance}, {0.5, travel}})}) {
    SCOPED_TRACE(static_cast<int>(on.kind));
    Scene scene = rail;
    scene.elements.push_back(test::make_element("spring", "", on, LinearSpring{k, 1.0}));
    scene.elements.push_back(test::make_element("damper", "oil", on, Damper{c}));
    const MotionModel model(scene);
    const Motion motion = test::moved(model, test::released(model, {}), 10.0);
    const std::vector<double> t = times(10.0, 777);
    const std::vector<test::Reading> read = test::read_at(motion, t);
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double fading = 0.5 * std::exp(-decay * t[i]);
      const double x = 1 + fading * (std::cos(omega * t[i]) + decay / omega * std::sin(omega * t[i]));
      ASSERT_NEAR(read[i].q[0], x, 1e-10) << t[i];
      ASSERT_NEAR(read[i].v[0], -fading * (omega + decay * decay / omega) * std::sin(omega * t[i]), 1e-9) << t[i];
    }
    EXPECT_LT(motion.energy_error, 1e-11);
  }
}

// I w' = -T tanh(w / width) - dry friction alone:  sinh(w / width) = sinh(w0 / width) exp(-T t / (I width)).
TEST(Simulate, DryFrictionBringsAWheelToACreep) {
  constexpr double moment = 0.4, torque = 0.3, width = 0.2, w0 = 3.0;
  Scene scene;
  scene.add_point(0, "O", {0, 0});
  test::add_link(scene, "wheel", 1.0);
  scene.bodies[1].inertia = moment;
  test::add_pin(scene, "ground.O", "wheel.a");
  scene.elements.push_back(test::friction("rub", 0, 1, torque, width));
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {{}, {{"wheel", w0}}}), 8.0);
  const std::vector<double> t = times(8.0, 200);
  const std::vector<test::Reading> read = test::read_at(motion, t);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double w = width * std::asinh(std::sinh(w0 / width) * std::exp(-torque * t[i] / (moment * width)));
    ASSERT_NEAR(read[i].v[0], w, 1e-9 * w0) << t[i];
  }
  EXPECT_LT(motion.work.back(), -0.99 * moment * w0 * w0 / 2);
}

// The same of a block, m v' = -F tanh(v / width); and with a constant force in place of friction v = v0 - F t / m.
TEST(Simulate, DryFrictionOnARailBringsABlockToACreep) {
  constexpr double m = 2.0, force = 3.0, width = 0.25, v0 = 4.0;
  Scene scene;
  scene.add_point(0, "O", {0, 0});
  const int body = scene.add_body("block");
  scene.add_point(body, "c", {0, 0});
  scene.bodies[body].mass = m;
  const int rail = test::add_slide(scene, "ground.O", "block.c", {0.6, 0.8}, "rail");
  scene.elements.push_back(test::make_element("friction", "rub", Measure::travel_of(rail), DryFriction{force, width}));
  const std::vector<double> t = times(4.0, 200);
  const auto rates = [&](const Scene& given) {
    const MotionModel model(given);
    std::vector<double> v;
    for (const auto& read : test::read_at(test::moved(model, test::released(model, {{}, {{"rail", v0}}}), 4.0), t)) {
      v.push_back(read.v[0]);
    }
    return v;
  };
  const std::vector<double> rubbed = rates(scene);
  test::element(scene, "friction").law = ConstantForce{force};
  const std::vector<double> pulled = rates(scene);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double v = width * std::asinh(std::sinh(v0 / width) * std::exp(-force * t[i] / (m * width)));
    ASSERT_NEAR(rubbed[i], v, 1e-9 * v0) << t[i];
    ASSERT_NEAR(pulled[i], v0 - force / m * t[i], 1e-12 * v0) << t[i];
  }
}

struct Case {
  std::string name;
  std::function<Scene()> scene;
  test::Release release;
};

std::vector<Case> cases() {
  const auto lift = [] { return read_scene(test::dataset("lift.toml")); };
  return {{"FourBar", test::four_bar_with_everything, {{}, {{"crank", 3.0}}}},
          {"Follower", test::four_bar_with_follower, {}},
          {"QuickReturn", test::quick_return, {{}, {{"crank", 4.0}}}},
          {"EveryMeasure", test::quick_return_with_every_measure, {{}, {{"crank", 4.0}}}},
          {"Driven", test::driven_five_bar, {}},
          {"Lift", lift, {{{"obd", 0.42}}, {}}}};
}

class Simulated : public testing::TestWithParam<Case> {
 protected:
  Simulated() : model_(GetParam().scene()), start_(test::released(model_, GetParam().release)) {}

  MotionModel model_;
  MotionState start_;
};

INSTANTIATE_TEST_SUITE_P(Each, Simulated, testing::ValuesIn(cases()),
                         [](const auto& mechanism) { return mechanism.param.name; });

// Energies from the places and velocities of the bodies; work of what resists, follows and drives from the power that
// inverse dynamics finds, summed by Simpson's rule over readings.
TEST_P(Simulated, BalancesItsEnergyWithWorkFoundApart) {
  constexpr double end = 2.0;
  const Motion motion = test::moved(model_, start_, end);
  EXPECT_LT(motion.energy_error, 1e-10);
  const Trajectory& path = motion.trajectory;
  double exchanged = 0.0;
  for (double kinetic : motion.kinetic) exchanged = std::max(exchanged, kinetic);
  for (std::size_t node = 0; node < path.nodes(); ++node) {
    const std::vector<double> x = model_.from_si(test::q_at(motion, node));
    const std::vector<double> v = model_.from_si(test::v_at(motion, node));
    double kinetic = 0.0;
    const auto bodies = body_motions(model_, x, v, std::vector<double>(x.size(), 0.0));
    for (std::size_t i = 1; i < model_.scene().bodies.size(); ++i) {
      const Body& body = model_.scene().bodies[i];
      const Vec2 velocity = bodies[i].velocity_of(body.center);
      kinetic += (body.mass * dot(velocity, velocity) + body.inertia * bodies[i].rate * bodies[i].rate) / 2;
    }
    ASSERT_NEAR(motion.kinetic[node], kinetic, 1e-12 * exchanged);
    const double potential = test::potential_energy(model_.scene(), model_.poses(x));
    const double first = test::potential_energy(model_.scene(), model_.poses(model_.from_si(test::q_at(motion, 0))));
    ASSERT_NEAR(motion.potential[node] - motion.potential[0], potential - first, 1e-12 * (std::abs(first) + exchanged));
  }
}

// Readings between nodes against a motion of a thousandth the error.
TEST_P(Simulated, ReadsBetweenNodesAsWellAsItSteps) {
  constexpr double end = 2.0;
  const Motion motion = test::moved(model_, start_, end);
  const Motion fine = test::moved(model_, start_, end, 1e-13);
  const std::vector<double> t = times(end, 1999);
  const std::vector<test::Reading> read = test::read_at(motion, t);
  const std::vector<test::Reading> truth = test::read_at(fine, t);
  for (std::size_t c = 0; c < truth[0].q.size(); ++c) {
    double reach = 0.0, fastest = 0.0, q_apart = 0.0, v_apart = 0.0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      reach = std::max(reach, std::abs(truth[i].q[c] - truth[0].q[c]));
      fastest = std::max(fastest, std::abs(truth[i].v[c]));
      q_apart = std::max(q_apart, std::abs(read[i].q[c] - truth[i].q[c]));
      v_apart = std::max(v_apart, std::abs(read[i].v[c] - truth[i].v[c]));
    }
    EXPECT_LT(q_apart, 1e-10 * reach) << c;
    EXPECT_LT(v_apart, 1e-9 * fastest) << c;
  }
  EXPECT_LT(difference(motion, fine), 1e-10);
}

// With every freedom driven nothing is left to integrate: places, rates and accelerations are those of kinematics, and
// the motor gives what inverse dynamics asks for.
TEST(Simulate, FullyDrivenFourBarMovesAsKinematicsSays) {
  Scene scene = test::four_bar_with_everything();
  constexpr double rate = 5.0;
  Drive drive;
  drive.name = "motor";
  drive.on = Measure::angle_between(0, 1);
  drive.rate = rate;
  drive.start = 1.0;
  scene.drives.push_back(drive);
  const MotionModel model(scene);
  constexpr double end = 2 * M_PI / rate;
  const Motion motion = test::moved(model, test::released(model, {}), end);
  EXPECT_EQ(motion.freedoms, 0);
  SweepOptions options;
  options.steps = 90;
  options.rate = rate;
  const KinematicsResult swept = sweep(scene, {{"crank", 1.0, 1.0 + 2 * M_PI}}, options);
  ASSERT_TRUE(swept.complete) << swept.why;
  const std::vector<test::Reading> read = test::read_at(motion, times(end, options.steps));
  for (std::size_t i = 0; i < read.size(); ++i) {
    for (std::size_t c = 0; c < read[i].q.size(); ++c) {
      ASSERT_NEAR(read[i].q[c], swept.samples[i].q[c], 1e-9) << i;
      ASSERT_NEAR(read[i].v[c], swept.samples[i].rate[c], 1e-8 * rate) << i;
    }
  }
  for (std::size_t node = 0; node < motion.trajectory.nodes(); ++node) {
    const auto n = static_cast<std::ptrdiff_t>(motion.trajectory.coordinates);
    const auto a = motion.trajectory.a.begin() + static_cast<std::ptrdiff_t>(node) * n;
    const Forces forces = forces_of(model, model.from_si(test::q_at(motion, node)),
                                    model.from_si(test::v_at(motion, node)), model.from_si({a, a + n}), scene.drives);
    EXPECT_NEAR(motion.drive_force[0][node], forces.drives[0].value, 1e-10 * (1 + std::abs(forces.drives[0].value)));
  }
  EXPECT_LT(motion.energy_error, 1e-9);
}

// Parallel cranks of 1 m, all but the first two without mass.
Scene parallelogram(int cranks) {
  Scene scene;
  scene.gravity = {0, -9.81};
  const int coupler = scene.add_body("coupler");
  scene.bodies[coupler].mass = 4.0;
  scene.bodies[coupler].center = {1.2, 0.3};
  scene.bodies[coupler].inertia = 0.7;
  for (int i = 0; i < cranks; ++i) {
    const std::string number = std::to_string(i);
    scene.add_point(0, "A" + number, {static_cast<double>(i), 0.0});
    scene.add_point(coupler, "B" + number, {static_cast<double>(i), 0.0});
    const int crank = test::add_link(scene, "crank" + number, 1.0, i < 2 ? 3.0 : 0.0);
    scene.start.angle[crank] = -0.4;
    test::add_pin(scene, "ground.A" + number, "crank" + number + ".a");
    test::add_pin(scene, "crank" + number + ".b", "coupler.B" + number);
  }
  return scene;
}

TEST(Simulate, RedundantCrankChangesNothing) {
  const MotionModel two(parallelogram(2));
  const MotionModel three(parallelogram(3));
  const std::vector<double> t = times(5.0, 100);
  const Motion by_two = test::moved(two, test::released(two, {}), 5.0);
  const Motion by_three = test::moved(three, test::released(three, {}), 5.0);
  EXPECT_EQ(by_three.freedoms, 1);
  const std::vector<test::Reading> a = test::read_at(by_two, t);
  const std::vector<test::Reading> b = test::read_at(by_three, t);
  const auto of = [](const MotionModel& model, const std::string& name) {
    return static_cast<std::size_t>(test::coordinate_of(model, name));
  };
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double angle = a[i].q[of(two, "crank0")];
    EXPECT_NEAR(b[i].q[of(three, "crank0")], angle, 1e-9);
    EXPECT_NEAR(b[i].q[of(three, "crank2")], angle, 1e-9);
    EXPECT_NEAR(b[i].q[of(three, "coupler")], 0.0, 1e-9);
  }
}

Scene pendulum() { return read_scene(test::dataset("pendulum_a01.toml")); }

TEST(Simulate, StopsWhereItIsInterrupted) {
  const MotionModel model(pendulum());
  std::atomic<bool> interrupt{false};
  MotionOptions options;
  options.duration = 10.0;
  options.interrupt = &interrupt;
  options.progress = [&](double t) { interrupt = t > 3.0; };
  const Motion motion = simulate(model, test::released(model, {}), options);
  EXPECT_EQ(motion.status, MotionStatus::interrupted);
  EXPECT_FALSE(motion.completed());
  EXPECT_NE(motion.why.find("interrupted at t = 3."), std::string::npos) << motion.why;
  EXPECT_GT(motion.trajectory.t.back(), 3.0);
  EXPECT_LT(motion.trajectory.t.back(), 4.0);
}

TEST(Simulate, StopsAfterTheStepsAllowed) {
  const MotionModel model(pendulum());
  MotionOptions options;
  options.duration = 10.0;
  options.most_steps = 7;
  const Motion motion = simulate(model, test::released(model, {}), options);
  EXPECT_EQ(motion.status, MotionStatus::step_limit);
  EXPECT_LE(motion.trajectory.nodes(), 8u);
  EXPECT_FALSE(motion.why.empty());
}

TEST(Simulate, SaysThatAFreedomHasNoInertia) {
  Scene scene = test::chain(2, 1.0, 1.0);
  scene.bodies[2].mass = 0.0;
  test::add_torsion_spring(scene, 1, 2, 3.0);
  scene.gravity = {0, -9.81};
  const MotionModel model(scene);
  const Motion motion = simulate(model, test::released(model, {}), {});
  EXPECT_EQ(motion.status, MotionStatus::no_inertia);
  EXPECT_NE(motion.why.find("no inertia"), std::string::npos) << motion.why;
}

// A block drawn by a motor faster than its crank and rod are long.
TEST(Simulate, IsStuckWhereADriveMeetsADeadCentre) {
  Scene scene = test::chain(2, 1.0, 1.0);
  const int block = scene.add_body("block");
  scene.add_point(block, "c", {0, 0});
  scene.bodies[block].mass = 1.0;
  test::add_pin(scene, "2.b", "block.c");
  const int rail = test::add_slide(scene, "ground.O", "block.c", {1, 0}, "rail");
  scene.start.angle[1] = 1.0;
  scene.start.angle[2] = -1.0;
  scene.start.travel[rail] = 1.1;
  Drive drive;
  drive.name = "winch";
  drive.on = Measure::travel_of(rail);
  drive.start = 1.0;
  drive.rate = 0.5;
  scene.drives.push_back(drive);
  const MotionModel model(scene);
  MotionOptions options;
  options.duration = 5.0;
  const Motion motion = simulate(model, test::released(model, {}), options);
  EXPECT_EQ(motion.status, MotionStatus::stuck);
  // The dead centre is met at 2 m, after 2 s.
  EXPECT_NEAR(motion.trajectory.t.back(), 2.0, 1e-3);
  EXPECT_FALSE(motion.why.empty());
  for (double q : motion.trajectory.q) EXPECT_TRUE(std::isfinite(q));
}

// What the command line prints as its error: the difference to the same motion at a tenth of the tolerance.
TEST(Difference, BoundsTheErrorOfThePendulum) {
  const MotionModel model(pendulum());
  const MotionState start = test::released(model, {});
  const Motion truth = test::moved(model, start, 20.0, 1e-13);
  for (double accuracy : {1e-4, 1e-6, 1e-8, 1e-10}) {
    const Motion motion = test::moved(model, start, 20.0, accuracy);
    const double estimated = difference(motion, test::moved(model, start, 20.0, accuracy / 10));
    const double real = difference(motion, truth);
    EXPECT_LT(real, 1.5 * estimated) << accuracy;
    EXPECT_GT(real, 0.5 * estimated) << accuracy;
    EXPECT_LT(real, accuracy) << accuracy;
  }
}

}  // namespace
}  // namespace poise::simulate_test
