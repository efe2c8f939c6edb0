#include "motion/inverse_dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/equilibrium_pose.hpp"
#include "motion/kinematics.hpp"
#include "motion/reduced_motion.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::inverse_dynamics_test {
namespace {

using nlohmann::json;

constexpr double gravity = 9.81;

// Forces for coordinates, rates and accelerations in SI.
Forces forces_at(const MotionModel& model, const std::vector<double>& q, const std::vector<double>& v,
                 const std::vector<double>& a, const std::vector<Drive>& drives = {}) {
  return forces_of(model, model.from_si(q), model.from_si(v), model.from_si(a), drives);
}

const Reaction& reaction(const Forces& forces, const std::string& name) {
  const auto found =
      std::find_if(forces.reactions.begin(), forces.reactions.end(), [&](const Reaction& r) { return r.name == name; });
  if (found == forces.reactions.end()) throw std::out_of_range(name);
  return *found;
}

void expect_consistent(const Forces& forces) {
  EXPECT_TRUE(forces.balanced) << forces.worst_body << " is out of balance by " << forces.imbalance << " of "
                               << forces.largest_force;
  EXPECT_LT(forces.work_error, 1e-10);
  EXPECT_LT(forces.power.error, 1e-10);
  EXPECT_LT(forces.loop_error, 1e-10);
}

// m at 0.4 out, I about it, on ground.O.
Scene pendulum(double m, double inertia) {
  Scene scene;
  scene.gravity = {0, -gravity};
  scene.bodies[0].points.push_back({"O", {0, 0}});
  test::add_link(scene, "arm", 1.0, m);
  scene.bodies[1].center = {0.4, 0};
  scene.bodies[1].inertia = inertia;
  test::add_pin(scene, "ground.O", "arm.a", "O");
  return scene;
}

// The pin pulls along the rod with m g cos + m L w^2 and across it with what gravity's moment leaves.
TEST(InverseDynamics, SwingingPendulumPullsAtItsPin) {
  constexpr double m = 3.0, l = 0.4, inertia = 0.2, below = 0.7, w = 2.3;
  const double about_pin = inertia + m * l * l;
  const double angular_acceleration = -m * gravity * l * std::sin(below) / about_pin;
  const MotionModel model(pendulum(m, inertia));
  const Forces forces = forces_at(model, {below - M_PI / 2}, {w}, {angular_acceleration});
  expect_consistent(forces);
  const Vec2 outward = unit(below - M_PI / 2);
  const Vec2 force = reaction(forces, "O").force;
  EXPECT_NEAR(-dot(force, outward), m * gravity * std::cos(below) + m * l * w * w, 1e-12);
  EXPECT_NEAR(cross(outward, force), m * l * angular_acceleration + m * gravity * std::sin(below), 1e-12);
}

TEST(InverseDynamics, MotorGivesTheMomentThatTheMotionTakes) {
  constexpr double m = 3.0, inertia = 0.2, q = 0.9, w = -1.7, angular_acceleration = 40.0;
  Scene scene = pendulum(m, inertia);
  scene.elements.push_back(test::torsion_damper("oil", 0, 1, 0.6));
  scene.elements.push_back(test::friction("rub", 0, 1, 1.5, 0.1));
  test::add_torsion_spring(scene, 0, 1, 7.0, 0.2);
  const MotionModel model(scene);
  const Forces forces = forces_at(model, {q}, {w}, {angular_acceleration}, {find_drive(scene, "arm")});
  expect_consistent(forces);
  const double friction = 1.5 * std::tanh(w / 0.1);
  ASSERT_EQ(forces.drives.size(), 1u);
  EXPECT_NEAR(forces.drives[0].value,
              (inertia + m * 0.16) * angular_acceleration + m * gravity * 0.4 * std::cos(q) + 7.0 * (q - 0.2) +
                  0.6 * w + friction,
              1e-11);
  EXPECT_NEAR(forces.drives[0].power, forces.drives[0].value * w, 1e-12);
  // The moments on the second body are their opposites.
  const auto against = [&](const char* table) { return forces.element_force[test::index_of(scene, table)]; };
  EXPECT_NEAR(-against("torsion_damper"), -0.6 * w, 1e-15);
  EXPECT_NEAR(-against("friction"), -friction, 1e-15);
  EXPECT_NEAR(-against("torsion_spring"), -7.0 * (q - 0.2), 1e-15);
}

TEST(InverseDynamics, SaysWhatNothingTakesUp) {
  const MotionModel model(pendulum(3.0, 0.2));
  const Forces forces = forces_at(model, {0.0}, {0.0}, {0.0});
  EXPECT_FALSE(forces.balanced);
  EXPECT_EQ(forces.worst_body, "arm");
  EXPECT_GT(forces.work_error, 1e-3);
}

// A block on a turning rod: along it m (s'' - s w^2 + g sin q), about O (I + m s^2) w' + 2 m s s' w + m g s cos q.
TEST(InverseDynamics, BlockOnATurningRodFeelsCoriolis) {
  constexpr double m = 2.0, s = 0.8, s1 = 1.1, s2 = -3.0, q = 0.6, w = 2.5, w1 = -4.0, c = 9.0;
  Scene scene;
  scene.gravity = {0, -gravity};
  scene.bodies[0].points.push_back({"O", {0, 0}});
  test::add_link(scene, "rod", 2.0);
  scene.bodies[1].inertia = 0.3;
  test::add_link(scene, "block", 0.1, m);
  scene.bodies[2].center = {0, 0};
  scene.bodies[2].inertia = 0.02;
  test::add_pin(scene, "ground.O", "rod.a", "O");
  test::add_slide(scene, "rod.a", "block.a", {1, 0}, "run");
  scene.elements.push_back(test::line_damper("drag", test::point(scene, "ground.O"), test::point(scene, "block.a"), c));
  const MotionModel model(scene);
  const std::vector<Drive> drives = {find_drive(scene, "rod"), find_drive(scene, "run")};
  const Forces forces = forces_at(model, {q, s}, {w, s1}, {w1, s2}, drives);
  expect_consistent(forces);
  EXPECT_NEAR(forces.drives[0].value, (0.32 + m * s * s) * w1 + 2 * m * s * s1 * w + m * gravity * s * std::cos(q),
              1e-12);
  EXPECT_NEAR(forces.drives[1].value, m * (s2 - s * w * w + gravity * std::sin(q)) + c * s1, 1e-12);
  EXPECT_NEAR(forces.drives[1].rate, s1, 1e-15);
  EXPECT_NEAR(forces.element_force[test::index_of(scene, "damper")], c * s1, 1e-14);
}

// Thesis eqs. 44-46: the pose that hangs in balance takes no torque at the first bar, and its pins carry the weights
// below them and the pull.
TEST(InverseDynamics, ThesisChainHangsWithoutTorque) {
  const Scene scene = read_scene(test::dataset("pendulum_chain.toml"));
  const MotionModel model(scene);
  const std::vector<double> below = {0.31143065331515225247, 0.59688848705719631498, 1.1827696789057091057};
  std::vector<double> q;
  for (double angle : below) q.push_back(angle - M_PI / 2);
  const std::vector<double> still(3, 0.0);
  const Forces forces = forces_at(model, q, still, still, {find_drive(scene, "upper")});
  expect_consistent(forces);
  EXPECT_NEAR(forces.drives[0].value, 0.0, 1e-13);
  double carried = 0.0;
  for (int bar = 3; bar >= 1; --bar) {
    carried += scene.bodies[static_cast<std::size_t>(bar)].mass * gravity;
    const Vec2 force = forces.reactions[static_cast<std::size_t>(bar - 1)].force;
    EXPECT_NEAR(force.x, -6.0, 1e-12);
    EXPECT_NEAR(force.y, carried, 1e-12);
  }
}

// Turned away from it the torque is the moment of all loads about O.
TEST(InverseDynamics, TorqueHoldsTheThesisChainElsewhere) {
  Scene scene = read_scene(test::dataset("pendulum_chain.toml"));
  // Welded in a line, so that one torque can hold it.
  for (int i : {1, 2}) scene.joints[static_cast<std::size_t>(i)].kind = Joint::Kind::weld;
  const MotionModel model(scene);
  const Forces forces = forces_at(model, {0.3}, {0.0}, {0.0}, {find_drive(scene, "upper")});
  expect_consistent(forces);
  const double arm = 1.2 * 0.2 + 0.8 * 0.55 + 0.5 * 0.95;
  EXPECT_NEAR(forces.drives[0].value, gravity * arm * std::cos(0.3) + 6.0 * 1.2 * std::sin(0.3), 1e-12);
}

// Newton's law for every body of a driven four-bar, with momenta from the places of the bodies alone.
TEST(InverseDynamics, FourBarReactionsChangeTheMomenta) {
  const Scene scene = read_scene(test::dataset("four_bar_gravity.toml"));
  const MotionModel model(scene);
  constexpr double rate = 4.0, q = 1.1, h = 1e-3;
  SweepOptions options;
  options.rate = rate;
  options.steps = 4;
  const KinematicsResult path = sweep(scene, {{"crank", q - 2 * h * rate, q + 2 * h * rate}}, options);
  ASSERT_TRUE(path.complete);
  const KinematicSample& at = path.samples[2];
  const Forces forces = forces_at(model, at.q, at.rate, at.acceleration, {find_drive(scene, "crank")});
  expect_consistent(forces);
  // Second differences of fourth order of a quantity of the samples.
  const auto second = [&](auto quantity) {
    const auto f = [&](std::size_t k) { return quantity(path.samples[k]); };
    return (-f(0) + 16 * f(1) - 30 * f(2) + 16 * f(3) - f(4)) / (12 * h * h);
  };
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const auto center = [&](const KinematicSample& s) { return s.bodies[i].pose.world(body.center); };
    Vec2 force = body.mass * scene.gravity;
    double moment = i == 1 ? forces.drives[0].value : 0.0;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      const double sign = joint.b.body == static_cast<int>(i) ? 1.0 : joint.a.body == static_cast<int>(i) ? -1.0 : 0.0;
      const Reaction& r = reaction(forces, joint.name);
      force += sign * r.force;
      moment += sign * cross(r.at - center(at), r.force);
    }
    EXPECT_NEAR(force.x, body.mass * second([&](const KinematicSample& s) { return center(s).x; }), 1e-6) << body.name;
    EXPECT_NEAR(force.y, body.mass * second([&](const KinematicSample& s) { return center(s).y; }), 1e-6) << body.name;
    EXPECT_NEAR(moment, body.inertia * second([&](const KinematicSample& s) { return s.bodies[i].pose.angle; }), 1e-6)
        << body.name;
  }
}

// Power of the motor over a full turn of the crank is what the damper took: the energies come back to themselves.
TEST(InverseDynamics, MotorPaysForTheDamperOverATurn) {
  Scene scene = read_scene(test::dataset("four_bar_gravity.toml"));
  scene.elements.push_back(test::torsion_damper("oil", 0, 3, 0.8));
  const MotionModel model(scene);
  SweepOptions options;
  options.rate = 3.0;
  options.steps = 720;
  const KinematicsResult path = sweep(scene, {{"crank", 0.0, 2 * M_PI}}, options);
  ASSERT_TRUE(path.complete);
  double given = 0.0, taken = 0.0;
  for (std::size_t k = 0; k + 1 < path.samples.size(); ++k) {
    const KinematicSample& at = path.samples[k];
    const Forces forces = forces_at(model, at.q, at.rate, at.acceleration, {find_drive(scene, "crank")});
    given += forces.drives[0].power;
    taken += 0.8 * std::pow(at.bodies[3].rate, 2);
    ASSERT_LT(forces.power.error, 1e-10);
    ASSERT_LT(forces.work_error, 1e-10);
  }
  EXPECT_NEAR(given, taken, 1e-9 * taken);
}

/// A slider-crank at constant speed with a counterweight of the moment W opposite the crank, kg m.
Scene shaking_slider_crank(double W) {
  return parse_scene(fmt::format(R"(
[ground.points]
O = [0, 0]
[body.crank]
points = {{ O = [0, 0], A = [0.05, 0] }}
mass = 0.4
center = [{}, 0]
[body.rod]
points = {{ A = [0, 0], B = [0.2, 0] }}
mass = 0.6
center = [{}, 0]
inertia = 0.003
[body.piston]
points = {{ B = [0, 0] }}
mass = 0.5
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.A", "rod.A"]
[[pin]]
points = ["rod.B", "piston.B"]
[[slide]]
points = ["ground.O", "piston.B"]
axis = [1, 0]
[start]
crank = 0.1
rod = -0.02
"ground.O-piston.B" = 0.25
)",
                                 0.01 - W / 0.4, 0.2 / 3),
                     "slider_crank.toml");
}

/// The force of the links on the frame in `steps` equal steps of a range, and the torque of the drive.
struct Shaking {
  std::vector<Vec2> force;
  std::vector<double> torque;
};
Shaking shaking_of(double W, double to, int steps) {
  const Scene scene = shaking_slider_crank(W);
  const MotionModel model(scene);
  SweepOptions options;
  options.rate = 100.0;
  options.steps = steps;
  const KinematicsResult path = sweep(scene, {{"crank", 0.0, to}}, options);
  EXPECT_TRUE(path.complete);
  Shaking out;
  for (const KinematicSample& at : path.samples) {
    const Forces forces = forces_at(model, at.q, at.rate, at.acceleration, {find_drive(scene, "crank")});
    expect_consistent(forces);
    Vec2 on_frame{};
    for (const Reaction& one : forces.reactions) {
      if (one.body_a == 0) on_frame = on_frame - one.force;
    }
    out.force.push_back(on_frame);
    out.torque.push_back(forces.drives.at(0).value);
  }
  return out;
}

// The shaking force is minus the rate of the momentum, of crank, rod and piston in closed form: here with ten digits
// from NumPy, at 100 rad/s without gravity.
TEST(InverseDynamics, SliderCrankShakesItsFrame) {
  const Shaking found = shaking_of(0.0, M_PI, 4);
  ASSERT_EQ(found.force.size(), 5U);
  const std::vector<Vec2> force{
      {677.5, 0}, {418.6268733, 169.7056275}, {-90.3696114, 240}, {-415.7591285, 169.7056275}, {-502.5, 0}};
  const std::vector<double> torque{0, 11.109754445, -4.518480571, -7.865271570, 0};
  for (std::size_t k = 0; k < force.size(); ++k) {
    EXPECT_NEAR(found.force[k].x, force[k].x, 1e-7) << k;
    EXPECT_NEAR(found.force[k].y, force[k].y, 1e-7) << k;
    EXPECT_NEAR(found.torque[k], torque[k], 1e-8) << k;
  }
  for (const auto& [W, largest] :
       {std::pair{0.0, 677.5}, {0.024, 437.5}, {0.0415, 262.5}, {0.0446476996, 231.023006}}) {
    double found_largest = 0.0;
    for (const Vec2& one : shaking_of(W, 2 * M_PI, 720).force) found_largest = std::max(found_largest, norm(one));
    EXPECT_NEAR(found_largest, largest, 5e-4 * largest) << W;
    EXPECT_LE(found_largest, largest * (1 + 1e-8)) << W;
  }
}

// The force in the shut cylinder of lift_dynamics.json, with the cylinder as a drive instead of a spring.
TEST(InverseDynamics, CylinderHoldsTheLift) {
  const json answers = test::read_json(test::dataset("lift_dynamics.json"));
  for (const json& known : answers.at("entries")) {
    SCOPED_TRACE(known.dump());
    Scene scene = read_scene(test::dataset("lift.toml"));
    test::erase_elements(scene, "spring");
    set_value(scene, "body.payload.mass", known.at("payload"));
    const MotionModel model(scene);
    const double q = known.at("q");
    SweepOptions options;
    options.rate = 0.3;
    const KinematicSample at = sweep(scene, {{"obd", q, q + 0.01}}, options).samples.front();
    const std::vector<double> still(at.q.size(), 0.0);
    const std::vector<Drive> cylinder = {find_drive(scene, "stroke")};
    const Forces holds = forces_at(model, at.q, still, still, cylinder);
    expect_consistent(holds);
    const double exact = known.at("cyl_force_N");
    EXPECT_NEAR(holds.drives[0].value, exact, 1e-10 * exact);
    const Forces moves = forces_at(model, at.q, at.rate, at.acceleration, cylinder);
    expect_consistent(moves);
    const double rate = 0.3 * known.at("dl_dq").get<double>();
    EXPECT_NEAR(moves.drives[0].rate, rate, 1e-10 * rate);
    EXPECT_NEAR(moves.element_force[test::index_of(scene, "damper")], 4000 * rate, 1e-6 * rate);
  }
}

// Free motions need no drive: what the reduced equations of motion give is balanced body by body.
TEST(InverseDynamics, FreeMotionsOfRandomMechanismsAreInBalance) {
  int moved = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    test::Wish wish;
    wish.loops = static_cast<int>(seed % 3);
    wish.followers = seed % 5 == 0;
    Scene scene = test::plant_mechanism(seed, wish).in_equilibrium;
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      scene.bodies[i].mass += 0.5;
      scene.bodies[i].inertia += 0.1;
    }
    const int last = static_cast<int>(scene.bodies.size()) - 1;
    scene.elements.push_back(test::torsion_damper("oil", 1, last, 0.4));
    scene.elements.push_back(test::friction("rub", 0, last, 0.7, 0.5));
    const StaticModel statics(scene);
    const MotionModel model(scene);
    const std::vector<double> x = motion_coordinates(model, statics, assemble(statics));
    ReducedMotion<double> motion(model.scaled_scene(), model.mechanism(), model.inertia());
    using Status = ReducedMotion<double>::Status;
    if (motion.choose(0.0, x.data(), false) != Status::ok) continue;
    std::vector<double> z, w;
    test::Random random(seed);
    for (int k : motion.independent()) {
      z.push_back(x[static_cast<std::size_t>(k)]);
      w.push_back(random.uniform(-2.0, 2.0));
    }
    motion.expect(x.data());
    if (motion.place(0.0, z.data()) != Status::ok) continue;
    motion.move(w.data());
    if (motion.accelerate() != Status::ok) continue;
    const auto n = static_cast<std::size_t>(motion.coordinates());
    const Forces forces =
        forces_of(model, {motion.q(), motion.q() + n}, {motion.v(), motion.v() + n}, {motion.a(), motion.a() + n}, {});
    expect_consistent(forces);
    ++moved;
  }
  EXPECT_GT(moved, 45);
}

// Two motors on one crank share the torque, which is undetermined; together they give what one would.
TEST(InverseDynamics, RedundantDrivesAreMarked) {
  const Scene scene = pendulum(3.0, 0.2);
  const MotionModel model(scene);
  Drive second = find_drive(scene, "arm");
  second.name = "second";
  const Forces forces = forces_at(model, {0.0}, {0.0}, {0.0}, {find_drive(scene, "arm"), second});
  expect_consistent(forces);
  EXPECT_EQ(forces.redundancy, 1);
  EXPECT_FALSE(forces.drives[0].determined);
  EXPECT_TRUE(reaction(forces, "O").determined);
  EXPECT_NEAR(forces.drives[0].value + forces.drives[1].value, 3.0 * gravity * 0.4, 1e-12);
}

// Balance leaves open how a drive and a stop on the same angle share a load: the drive carries it, the stop only
// touches.
TEST(InverseDynamics, DriveAtAStopCarriesAllOfTheLoad) {
  constexpr double m = 3.0, q = 0.4;
  Scene scene = pendulum(m, 0.2);
  test::add_stop(scene, "rest", 0, 1, q, 1.0);
  const MotionModel model(scene);
  const double moment = m * gravity * 0.4 * std::cos(q);
  const Forces held = forces_at(model, {q}, {0.0}, {0.0}, {find_drive(scene, "arm")});
  expect_consistent(held);
  EXPECT_NEAR(held.drives[0].value, moment, 1e-12);
  EXPECT_TRUE(held.drives[0].determined);
  EXPECT_EQ(held.redundancy, 0);
  EXPECT_EQ(held.idle_stops, std::vector<std::string>{"rest"});
  EXPECT_EQ(held.overrun, std::vector<double>{0.0});
  const Forces alone = forces_at(model, {q}, {0.0}, {0.0});
  expect_consistent(alone);
  EXPECT_NEAR(reaction(alone, "rest").moment, moment, 1e-12) << "without a drive the stop holds it";
  EXPECT_TRUE(alone.idle_stops.empty());
  const Forces beyond = forces_at(model, {q - 0.1}, {0.0}, {0.0}, {find_drive(scene, "arm")});
  EXPECT_NEAR(beyond.overrun[0], 0.1, 1e-15);
  EXPECT_NEAR(beyond.drives[0].value, m * gravity * 0.4 * std::cos(q - 0.1), 1e-12);
}

// A drive on the first of two links: the second leans on its stop against the first, which the drive cannot hold.
TEST(InverseDynamics, StopCarriesWhatTheDriveDoesNotDecide) {
  constexpr double m = 2.0, q1 = 0.3, q2 = -0.5;
  Scene scene = test::chain(2, 1.0, m);
  scene.gravity = {0, -gravity};
  test::add_stop(scene, "elbow", 1, 2, q2 - q1, 1.0);
  const MotionModel model(scene);
  const Forces forces = forces_at(model, {q1, q2}, {0, 0}, {0, 0}, {find_drive(scene, "1")});
  expect_consistent(forces);
  EXPECT_TRUE(forces.idle_stops.empty());
  EXPECT_NEAR(reaction(forces, "elbow").moment, m * gravity * 0.5 * std::cos(q2), 1e-12);
  EXPECT_NEAR(forces.drives[0].value, m * gravity * (1.5 * std::cos(q1) + 0.5 * std::cos(q2)), 1e-12);
  // With both links driven it only touches.
  const Forces both = forces_at(model, {q1, q2}, {0, 0}, {0, 0}, {find_drive(scene, "1"), find_drive(scene, "2")});
  EXPECT_EQ(both.idle_stops, std::vector<std::string>{"elbow"});
  EXPECT_NEAR(both.drives[1].value, m * gravity * 0.5 * std::cos(q2), 1e-12);
  EXPECT_NEAR(both.drives[0].value, m * gravity * 1.5 * std::cos(q1), 1e-12);
}

// A hood on its four-bar: the reach of the strut is decided by the hood's angle, whatever the geometry between.
TEST(InverseDynamics, CurveHasNoCliffAtAStop) {
  const Scene scene = read_scene(test::dataset("car_hood.toml"));
  const KinematicsResult path = sweep(scene, {{"hood", 0.8, 1.25}});
  ASSERT_TRUE(path.stop.has_value());
  EXPECT_EQ(scene.stops[path.stop->stop].name, "reach");
  const MotionModel model(scene);
  const std::vector<Drive> drives = {find_drive(scene, "hood")};
  const auto effort = [&](const KinematicSample& at) {
    const std::vector<double> still(at.q.size(), 0.0);
    return forces_at(model, at.q, still, still, drives).drives[0].value;
  };
  // The last piece of the curve goes on as steeply as the one before.
  const std::size_t n = path.samples.size();
  const auto slope = [&](std::size_t k) {
    const KinematicSample &a = path.samples[k - 1], &b = path.samples[k];
    return (effort(b) - effort(a)) / (b.drive[0] - a.drive[0]);
  };
  EXPECT_NEAR(slope(n - 1), slope(n - 2), 0.1 * std::abs(slope(n - 2)));
}

TEST(InverseDynamics, NamesWhatActsInParallelWithADrive) {
  const auto named = [](const Scene& scene, const std::string& drive) {
    std::string out;
    for (const ParallelElement& p : parallel_elements(MotionModel(scene), {find_drive(scene, drive)})) {
      EXPECT_EQ(p.drive, drive);
      out += scene.elements[p.element].name + ", ";
    }
    return out;
  };
  // The oil acts between A and D, which pins keep at the cylinder's ends.
  const Scene lift = read_scene(test::dataset("lift.toml"));
  EXPECT_EQ(named(lift, "stroke"), "oil, oil film, ");
  EXPECT_EQ(named(lift, "obd"), "");
  Scene scene = test::chain(3, 1.0, 1.0);
  const auto body = [&](const std::string& name) { return test::point(scene, name + ".a").body; };
  scene.elements.push_back(test::torsion_damper("back", body("1"), 0, 1.0));
  scene.elements.push_back(test::friction("elsewhere", body("1"), body("2"), 1.0));
  test::add_link(scene, "block", 0.1);
  const int run = test::add_slide(scene, "3.a", "block.a", {1, 0}, "run");
  const PointRef end = test::point(scene, "block.b");
  scene.elements.push_back(test::line_spring("beside", end, test::point(scene, "3.b"), 5.0, 0.1));
  scene.elements.push_back(test::line_spring("to the ground", test::point(scene, "ground.O"), end, 5.0, 0.1));
  scene.elements.push_back(test::make_element("spring", "lock", Measure::travel_of(run), LinearSpring{5.0}));
  EXPECT_EQ(named(scene, "1"), "back, ");
  EXPECT_EQ(named(scene, "run"), "beside, lock, ");
}

TEST(InverseDynamics, MeasuresRatesThatOpenALoop) {
  const Scene scene = read_scene(test::dataset("four_bar_gravity.toml"));
  const MotionModel model(scene);
  KinematicSample at = sweep(scene, {{"crank", 1.0, 1.2}}).samples.front();
  at.rate[1] += 1e-3;
  EXPECT_GT(forces_at(model, at.q, at.rate, at.acceleration).loop_error, 1e-5);
}

}  // namespace
}  // namespace poise::inverse_dynamics_test
