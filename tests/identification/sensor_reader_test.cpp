// What sensors read, against the places and velocities of the bodies.

#include "identification/prediction/private/sensor_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "motion/body_motion.hpp"
#include "motion/simulate.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::sensor_reader_test {
namespace {

struct State {
  std::vector<double> q, v, a;
};

// States of a motion, loops closed.
std::vector<State> moving_states(const MotionModel& model) {
  MotionOptions options;
  options.duration = 0.5;
  const Motion motion = simulate(model, start_motion(model, {}), options);
  EXPECT_TRUE(motion.completed()) << motion.why;
  const auto n = static_cast<std::ptrdiff_t>(motion.trajectory.coordinates);
  std::vector<State> states;
  for (int part = 1; part <= 4; ++part) {
    const auto first =
        static_cast<std::ptrdiff_t>((motion.trajectory.nodes() - 1) * static_cast<std::size_t>(part) / 4) * n;
    const auto of = [&](const std::vector<double>& all) {
      return std::vector<double>(all.begin() + first, all.begin() + first + n);
    };
    states.push_back({of(motion.trajectory.q), of(motion.trajectory.v), of(motion.trajectory.a)});
  }
  return states;
}

// Derivatives hold for open loops too.
State random_state(const MotionModel& model, std::uint64_t seed) {
  test::Random random(seed);
  State state;
  for (int i = 0; i < model.layout().kept; ++i) {
    state.q.push_back(random.uniform(-2.0, 2.0));
    state.v.push_back(random.uniform(-3.0, 3.0));
    state.a.push_back(random.uniform(-5.0, 5.0));
  }
  return state;
}

struct Taken {
  double value = 0.0;
  std::vector<double> by_q, by_v, by_a;  // over all coordinates of the layout
};

Taken take(const MotionModel& model, const Sensor& sensor, const State& state) {
  SensorReader reader(model, sensor);
  const std::vector<int>& own = reader.coordinates();
  std::vector<double> q, v, a;
  for (const int i : own) {
    q.push_back(state.q[static_cast<std::size_t>(i)]);
    v.push_back(state.v[static_cast<std::size_t>(i)]);
    a.push_back(state.a[static_cast<std::size_t>(i)]);
  }
  const std::vector<double> none(state.q.size(), 0.0);
  Taken out{0.0, none, none, none};
  out.value = reader.read(q.data(), v.data(), a.data());
  for (std::size_t i = 0; i < own.size(); ++i) {
    out.by_q[static_cast<std::size_t>(own[i])] = reader.derivatives().by_q[i];
    out.by_v[static_cast<std::size_t>(own[i])] = reader.derivatives().by_v[i];
    out.by_a[static_cast<std::size_t>(own[i])] = reader.derivatives().by_a[i];
  }
  return out;
}

// The definition of every kind, by vectors.
double expected(const MotionModel& model, const Sensor& sensor, const State& state) {
  const Scene& scene = model.scene();
  const std::vector<double> x = model.from_si(state.q);
  const std::vector<BodyMotion> bodies = body_motions(model, x, model.from_si(state.v), model.from_si(state.a));
  const auto place = [&](PointRef p) { return bodies[static_cast<std::size_t>(p.body)].pose.world(scene.local(p)); };
  const auto velocity = [&](PointRef p) {
    return bodies[static_cast<std::size_t>(p.body)].velocity_of(scene.local(p));
  };
  const auto acceleration = [&](PointRef p) {
    return bodies[static_cast<std::size_t>(p.body)].acceleration_of(scene.local(p));
  };
  const auto by_time = [&](double value, double rate, double second) {
    return sensor.by_time == 0 ? value : sensor.by_time == 1 ? rate : second;
  };
  const auto apart = [&](PointRef a, PointRef b) {
    const Vec2 d = place(b) - place(a), u = velocity(b) - velocity(a);
    const double l = norm(d), rate = dot(d, u) / l;
    return by_time(l, rate, (dot(d, acceleration(b) - acceleration(a)) + dot(u, u) - rate * rate) / l);
  };
  const Measure& on = sensor.on;
  if (sensor.is_accelerometer()) {
    const BodyMotion& body = bodies[static_cast<std::size_t>(on.b.body)];
    return dot(unit(body.pose.angle + *sensor.axis), acceleration(on.b) - scene.gravity);
  }
  if (sensor.reads_force()) {
    const Element& element = scene.elements[static_cast<std::size_t>(sensor.element)];
    const auto& spring = std::get<LinearSpring>(element.law);
    const double excess = apart(element.on.a, element.on.b) - spring.free_length;
    if (spring.acts == LinearSpring::Acts::tension) return spring.stiffness * std::max(0.0, excess);
    if (spring.acts == LinearSpring::Acts::compression) return spring.stiffness * std::min(0.0, excess);
    return spring.stiffness * excess;
  }
  const BodyMotion& a = bodies[static_cast<std::size_t>(on.body_a)];
  const BodyMotion& b = bodies[static_cast<std::size_t>(on.body_b)];
  switch (on.kind) {
    case Measure::Kind::angle:
      return by_time(b.pose.angle - a.pose.angle, b.rate - a.rate, b.angular_acceleration - a.angular_acceleration);
    case Measure::Kind::travel: {
      // Along the axis, which turns with the body of the joint's first point.
      const Joint& joint = scene.joints[static_cast<std::size_t>(on.joint)];
      const BodyMotion& rail = bodies[static_cast<std::size_t>(joint.a.body)];
      const Vec2 axis = joint.direction() * unit(rail.pose.angle);
      const Vec2 d = place(joint.b) - place(joint.a);
      const Vec2 u = velocity(joint.b) - velocity(joint.a), across = quarter_turn(axis);
      return by_time(dot(axis, d), dot(axis, u) + rail.rate * dot(across, d),
                     dot(axis, acceleration(joint.b) - acceleration(joint.a)) + 2 * rail.rate * dot(across, u) +
                         rail.angular_acceleration * dot(across, d) - rail.rate * rail.rate * dot(axis, d));
    }
    case Measure::Kind::distance:
      return apart(on.a, on.b);
    case Measure::Kind::x:
      return by_time(place(on.b).x, velocity(on.b).x, acceleration(on.b).x);
    case Measure::Kind::y:
      return by_time(place(on.b).y, velocity(on.b).y, acceleration(on.b).y);
    case Measure::Kind::component:
    case Measure::Kind::clearance:
    case Measure::Kind::along_outline:
    case Measure::Kind::slip_on_cam:
    case Measure::Kind::rope:
    case Measure::Kind::sum:
      break;
  }
  throw std::logic_error("no sensor here reads this");
}

struct Case {
  std::string name;
  Scene scene;
  std::vector<Sensor> sensors;
};

Sensor of(std::string name, Measure on) {
  Sensor s;
  s.name = std::move(name);
  s.on = std::move(on);
  return s;
}

Sensor angle(int a, int b) { return of("angle", Measure::angle_between(a, b)); }
Sensor travel(int joint) { return of("travel", Measure::travel_of(joint)); }
Sensor distance(const Scene& scene, const std::string& a, const std::string& b) {
  return of(a + " " + b, Measure::distance_between(test::point(scene, a), test::point(scene, b)));
}
Sensor x(const Scene& scene, const std::string& p) { return of("x of " + p, Measure::x_of(test::point(scene, p))); }
Sensor y(const Scene& scene, const std::string& p) { return of("y of " + p, Measure::y_of(test::point(scene, p))); }

Sensor force_of_spring(const Scene& scene, int n) {
  Sensor s = of("force", test::element(scene, "spring", n).on);
  s.element = static_cast<int>(test::index_of(scene, "spring", n));
  return s;
}

Sensor accelerometer(const Scene& scene, const std::string& p, double axis) {
  Sensor s = of("accelerometer at " + p, Measure::y_of(test::point(scene, p)));
  s.axis = axis;
  return s;
}

// Every quantity also as a rate and an acceleration, but a force.
Case all_ways(std::string name, Scene scene, std::vector<Sensor> sensors) {
  const std::size_t count = sensors.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!sensors[i].is_of_measure()) continue;
    for (const int by_time : {1, 2}) {
      sensors.push_back(sensors[i]);
      sensors.back().by_time = by_time;
      sensors.back().name += by_time == 1 ? " rate" : " acceleration";
    }
  }
  return {std::move(name), std::move(scene), std::move(sensors)};
}

std::vector<Case> cases() {
  // A block on a rail that turns with the rocker; both share one angle.
  const Scene turning = test::quick_return();
  const int crank = 1, rocker = 2, block = 3;
  Case on_rail =
      all_ways("QuickReturn", turning,
               {angle(0, crank), angle(crank, rocker), angle(0, block), angle(rocker, block), angle(block, crank),
                travel(2), travel(3), distance(turning, "ground.E", "block.c"), distance(turning, "crank.B", "block.c"),
                x(turning, "block.c"), y(turning, "block.c"), force_of_spring(turning, 0),
                accelerometer(turning, "crank.B", 0.0), accelerometer(turning, "block.c", 0.7)});
  // A carriage on a fixed rail.
  const Scene still = test::driven_five_bar();
  const auto track =
      std::find_if(still.joints.begin(), still.joints.end(), [](const Joint& j) { return j.has_travel(); });
  Case on_track = all_ways(
      "FiveBar", still,
      {travel(static_cast<int>(track - still.joints.begin())), distance(still, "ground.A", "swing.D"),
       distance(still, "carriage.E", "left.C"), x(still, "carriage.E"), y(still, "swing.D"), force_of_spring(still, 0),
       accelerometer(still, "swing.D", -0.4), accelerometer(still, "carriage.E", 1.1)});
  // Springs that take only pull or only push, one of each slack and taut as the states go.
  Scene pair = turning;
  pair.elements.push_back(test::element(pair, "spring"));
  test::law<LinearSpring>(pair, "spring", 0).acts = LinearSpring::Acts::tension;
  test::law<LinearSpring>(pair, "spring", 1).acts = LinearSpring::Acts::compression;
  Case one_sided{"OneSided", pair, {force_of_spring(pair, 0), force_of_spring(pair, 1)}};
  return {std::move(on_rail), std::move(on_track), std::move(one_sided)};
}

class SensorReaders : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Each, SensorReaders, testing::ValuesIn(cases()),
                         [](const auto& mechanism) { return mechanism.param.name; });

TEST_P(SensorReaders, ReadWhatTheBodiesDo) {
  const MotionModel model(GetParam().scene);
  for (const Sensor& sensor : GetParam().sensors) {
    for (const State& state : moving_states(model)) {
      EXPECT_NEAR(take(model, sensor, state).value, expected(model, sensor, state),
                  sensor.reads_force() || sensor.reads_acceleration() ? 1e-10 : 1e-12)
          << sensor.name;
    }
  }
}

TEST_P(SensorReaders, HaveExactDerivatives) {
  const MotionModel model(GetParam().scene);
  const double h = 1e-5;
  for (const Sensor& sensor : GetParam().sensors) {
    SCOPED_TRACE(sensor.name);
    const State state = random_state(model, 9);
    const Taken here = take(model, sensor, state);
    double size = 1.0;
    for (const double d : here.by_q) size = std::max(size, std::abs(d));
    for (std::size_t i = 0; i < state.q.size(); ++i) {
      const auto difference = [&](std::vector<double> State::*which) {
        State up = state, down = state;
        (up.*which)[i] += h;
        (down.*which)[i] -= h;
        return (take(model, sensor, up).value - take(model, sensor, down).value) / (2 * h);
      };
      EXPECT_NEAR(here.by_q[i], difference(&State::q), 1e-8 * size);
      EXPECT_NEAR(here.by_v[i], difference(&State::v), 1e-8 * size);
      EXPECT_NEAR(here.by_a[i], difference(&State::a), 1e-8 * size);
    }
  }
}

// A rate is the time derivative of its quantity, whatever the coordinates do.
TEST_P(SensorReaders, RatesAreTimeDerivatives) {
  const MotionModel model(GetParam().scene);
  const double h = 1e-5;
  const State state = random_state(model, 21);
  for (const Sensor& rate : GetParam().sensors) {
    if (rate.by_time == 0) continue;
    Sensor sensor = rate;
    --sensor.by_time;
    const auto after = [&](double t) {
      State moved = state;
      for (std::size_t i = 0; i < moved.q.size(); ++i) {
        moved.q[i] += t * moved.v[i] + t * t / 2 * moved.a[i];
        moved.v[i] += t * moved.a[i];
      }
      return take(model, sensor, moved).value;
    };
    EXPECT_NEAR(take(model, rate, state).value, (after(h) - after(-h)) / (2 * h), 1e-7) << rate.name;
  }
}

// A weightless bead on a link: its place along the link carries no load, but turns with the link.
TEST(SensorReader, WhatTheModelDropsIsCarriedAlong) {
  Scene scene = test::chain(1, 4.0, 1.0);
  const int bead = scene.add_body("bead");
  scene.add_point(bead, "c", {0, 0});
  test::add_slide(scene, "1.a", "bead.c", {0.6, 0.8}, "wire");
  scene.start.travel[1] = 2.5;
  const MotionModel model(scene);
  ASSERT_EQ(model.layout().kept, 1);
  const State state{{0.3}, {2.0}, {0.0}};
  const Vec2 at = 2.5 * (Vec2{0.6, 0.8} * unit(0.3));
  Sensor height = y(scene, "bead.c");
  EXPECT_NEAR(take(model, height, state).value, at.y, 1e-14);
  height.by_time = 1;
  EXPECT_NEAR(take(model, height, state).value, 2.0 * at.x, 1e-14);
  EXPECT_DOUBLE_EQ(take(model, travel(1), state).value, 2.5);
}

TEST(SensorReader, BodiesThatNothingMovesStayAtTheirStart) {
  Scene scene = test::chain(1, 1.0, 1.0);
  scene.gravity = {0, -9.81};
  test::add_link(scene, "pointer", 0.5);
  test::add_pin(scene, "ground.O", "pointer.a");
  scene.start.angle[2] = 0.7;
  const MotionModel model(scene);
  ASSERT_EQ(model.layout().kept, 1);
  const State state{{0.3}, {2.0}, {0.0}};
  EXPECT_DOUBLE_EQ(take(model, angle(0, 2), state).value, 0.7);
  EXPECT_DOUBLE_EQ(take(model, angle(1, 2), state).value, 0.4);
  EXPECT_NEAR(take(model, x(scene, "pointer.b"), state).value, 0.5 * std::cos(0.7), 1e-15);
}

}  // namespace
}  // namespace poise::sensor_reader_test
