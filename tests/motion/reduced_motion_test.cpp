// Equations of motion against mechanics independent of them, and their derivatives against differences in 50 digits.

#include "motion/reduced_motion.hpp"

#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "motion/motion_model.hpp"
#include "solvers/real50.hpp"
#include "tests/motion/compiled_motion.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::reduced_motion_test {
namespace {

using Real = Real50;
using test::closed_pose;
using test::Compiled;
using test::evaluate;
using test::random_state;
using test::start;
using test::State;

State<Real> in_50_digits(const State<double>& s) {
  return {Real(s.t), {s.q.begin(), s.q.end()}, {s.z.begin(), s.z.end()}, {s.w.begin(), s.w.end()}};
}

using Values = std::vector<Real>;

// Largest difference over the largest value.
double apart(const Values& a, const Values& b) {
  Real difference = 0;
  Real size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = std::max<Real>(difference, abs(a[i] - b[i]));
    size = std::max<Real>({size, Real(abs(a[i])), Real(abs(b[i]))});
  }
  return size > 0 ? static_cast<double>(difference / size) : 0.0;
}

Values difference(const Values& ahead, const Values& behind, const Real& step) {
  Values out(ahead.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = (ahead[i] - behind[i]) / step;
  return out;
}

Values part(const Real* begin, std::size_t count) { return {begin, begin + count}; }

// Truncation of central differences is about 1e-24 here, rounding far less.
const Real step = Real(1e-12);
constexpr double same = 1e-18;

Scene friction_pendulum() {
  Scene scene = read_scene(test::dataset("double_pendulum.toml"));
  for (int k = 0; k < test::count_of(scene, "friction"); ++k) {
    test::law<DryFriction>(scene, "friction", k) = {2e-2, 0.9};
  }
  return scene;
}

struct Case {
  std::string name;
  std::function<Scene()> scene;
  std::vector<std::string> freedoms{};  // what moves on its own, by the names of drives, where joints have friction
};

std::vector<Case> cases() {
  return {{"DoublePendulum", friction_pendulum},
          {"FourBar", test::four_bar_with_everything},
          {"Follower", test::four_bar_with_follower},
          {"QuickReturn", test::quick_return},
          {"EveryMeasure", test::quick_return_with_every_measure},
          {"Driven", test::driven_five_bar},
          {"Lift", [] { return read_scene(test::dataset("lift.toml")); }},
          {"Andrews", [] { return read_scene(test::dataset("andrews.toml")); }}};
}

std::vector<Case> rubbing_cases() {
  return {{"Planet", test::rubbing_planet, {"sun"}},
          {"Rack", test::rubbing_rack, {"beam", "guide"}},
          {"Rollers", test::rubbing_rollers, {"cam", "wheel"}}};
}

/// Loops, lengths behind the states of controllers, and controllers with all kinds of states, one behind another.
Scene controlled_slider_crank() {
  return parse_scene(R"(
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
[body.crank]
points = { O = [0, 0], A = [0.3, 0] }
mass = 2
center = [0.1, 0.02]
inertia = 0.05
[body.rod]
points = { A = [0, 0], B = [0.9, 0], tip = [1, 0.2] }
mass = 1
center = [0.4, 0]
inertia = 0.1
[body.slider]
points = { B = [0, 0] }
mass = 3
[body.arm]
points = { B = [0, 0], end = [0, -0.4] }
mass = 1
center = [0, -0.3]
inertia = 0.02
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.A", "rod.A"]
[[pin]]
points = ["rod.B", "slider.B"]
[[pin]]
points = ["slider.B", "arm.B"]
[[slide]]
name = "guide"
points = ["ground.O", "slider.B"]
axis = [1, 0]
[[controller]]
name = "pid"
bodies = ["ground", "crank"]
proportional = 3
integral = 2
derivative = 0.4
filter = 0.1
reference = 0.3
[[controller]]
name = "second"
slide = "guide"
reads = { bodies = ["crank", "arm"] }
transfer = { numerator = [2, 0.3], denominator = [1, 0.2, 0.05] }
[[controller]]
name = "place"
reads = { x = "arm.end" }
proportional = 1.5
integral = 0.7
[[controller]]
name = "rate"
y = "arm.end"
reads = { points = ["ground.O", "arm.end"] }
reads_rate = true
follows = "place"
proportional = 2
integral = 0.5
[start]
crank = 0.7
rod = -0.2
guide = 1.1
)",
                     "controlled.toml");
}

std::vector<Case> all_cases() {
  std::vector<Case> all = cases();
  all.push_back({"Controlled", controlled_slider_crank});
  for (Case& one : rubbing_cases()) all.push_back(std::move(one));
  return all;
}

class MovingMechanism : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    scene_ = GetParam().scene();
    q0_ = closed_pose(scene_);
  }

  Scene scene_;
  std::vector<double> q0_;
};

// Forces that do not depend on other forces, so that the equations are linear in loads.
class WithoutRubbingJoints : public MovingMechanism {};

TEST_P(MovingMechanism, LinearizesAsDifferencesDo) {
  test::Random random(7);
  for (int trial = 0; trial < 3; ++trial) {
    const State<Real> state = in_50_digits(random_state(scene_, q0_, random));
    Compiled<Real> at(scene_);
    start(at, q0_, state);
    ASSERT_TRUE(evaluate(at, state));
    at.motion.linearize();
    Compiled<Real> near(scene_);
    start(near, q0_, state);
    const auto n = static_cast<std::size_t>(at.motion.coordinates());
    const auto f = static_cast<std::size_t>(at.motion.freedoms());
    ASSERT_EQ(near.motion.independent(), at.motion.independent());
    struct Sides {
      Values q, v, a, alpha;
    };
    const auto side = [&](bool of_rate, std::size_t k, const Real& shift) {
      State<Real> moved = state;
      (of_rate ? moved.w : moved.z)[k] += shift;
      EXPECT_TRUE(evaluate(near, moved));
      const auto& m = near.motion;
      return Sides{part(m.q(), n), part(m.v(), n), part(m.a(), n), part(m.alpha(), f)};
    };
    for (std::size_t k = 0; k < f; ++k) {
      SCOPED_TRACE(k);
      const int column = static_cast<int>(k);
      const Sides up = side(false, k, step);
      const Sides down = side(false, k, -step);
      EXPECT_LT(apart(difference(up.q, down.q, 2 * step), part(at.motion.B(column), n)), same);
      EXPECT_LT(apart(difference(up.v, down.v, 2 * step), part(at.motion.v_z(column), n)), same);
      EXPECT_LT(apart(difference(up.a, down.a, 2 * step), part(at.motion.a_z(column), n)), same);
      EXPECT_LT(apart(difference(up.alpha, down.alpha, 2 * step), part(at.motion.alpha_z(column), f)), same);
      const Sides faster = side(true, k, step);
      const Sides slower = side(true, k, -step);
      EXPECT_LT(apart(difference(faster.v, slower.v, 2 * step), part(at.motion.B(column), n)), same);
      EXPECT_LT(apart(difference(faster.a, slower.a, 2 * step), part(at.motion.a_w(column), n)), same);
      EXPECT_LT(apart(difference(faster.alpha, slower.alpha, 2 * step), part(at.motion.alpha_w(column), f)), same);
    }
  }
}

TEST_P(MovingMechanism, EvaluatesInDoubleWhat50DigitsSay) {
  test::Random random(11);
  const State<double> state = random_state(scene_, q0_, random);
  Compiled<double> rough(scene_);
  start(rough, q0_, state);
  ASSERT_TRUE(evaluate(rough, state));
  rough.motion.linearize();
  Compiled<Real> fine(scene_);
  start(fine, q0_, in_50_digits(state));
  ASSERT_TRUE(evaluate(fine, in_50_digits(state)));
  fine.motion.linearize();
  const auto n = static_cast<std::size_t>(fine.motion.coordinates());
  for (int k = 0; k < fine.motion.freedoms(); ++k) {
    const double* rough_columns[] = {rough.motion.B(k), rough.motion.v_z(k), rough.motion.a_z(k), rough.motion.a_w(k)};
    const Real* fine_columns[] = {fine.motion.B(k), fine.motion.v_z(k), fine.motion.a_z(k), fine.motion.a_w(k)};
    for (int c = 0; c < 4; ++c) {
      EXPECT_LT(apart({rough_columns[c], rough_columns[c] + n}, part(fine_columns[c], n)), 1e-11) << c;
    }
  }
}

// A number of the scene: how the equations of motion depend on it, and the scene in which it is `by` larger.
struct Number {
  std::string name;
  Influence influence;
  std::function<void(Scene&, double by)> add;
};

// A body of that mass, centre and inertia welded to the origin of another.
void burden(Scene& scene, int body, double mass, Vec2 center, double inertia) {
  const std::string name = "burden" + std::to_string(scene.bodies.size());
  const int extra = scene.add_body(name);
  scene.bodies[extra].mass = mass;
  scene.bodies[extra].center = center;
  scene.bodies[extra].inertia = inertia;
  const PointRef a = scene.add_point(body, name, {0, 0});
  const PointRef b = scene.add_point(extra, "o", {0, 0});
  Joint weld;
  weld.kind = Joint::Kind::weld;
  weld.name = name;
  weld.a = a;
  weld.b = b;
  scene.add_joint(weld);
}

Influence inertial(int body, double mass, Vec2 first, double moment) {
  Influence influence;
  influence.body = body;
  influence.mass = mass;
  influence.first = first;
  influence.moment = moment;
  return influence;
}

Influence forceful(const ForceNumber& number) {
  Influence influence;
  influence.force = number;
  return influence;
}

std::vector<Number> inertias_of(const Scene& scene) {
  std::vector<Number> numbers;
  for (int body = 1; body < static_cast<int>(scene.bodies.size()); ++body) {
    const std::string name = scene.bodies[body].name;
    numbers.push_back({name + ".m", inertial(body, 1, {0, 0}, 0), [=](Scene& s, double by) {
                         burden(s, body, by, {0, 0}, 0);
                       }});
    numbers.push_back({name + ".mx", inertial(body, 0, {1, 0}, 0), [=](Scene& s, double by) {
                         burden(s, body, by, {1, 0}, -by);
                         burden(s, body, -by, {0, 0}, 0);
                       }});
    numbers.push_back({name + ".my", inertial(body, 0, {0, 1}, 0), [=](Scene& s, double by) {
                         burden(s, body, by, {0, 1}, -by);
                         burden(s, body, -by, {0, 0}, 0);
                       }});
    numbers.push_back({name + ".J", inertial(body, 0, {0, 0}, 1), [=](Scene& s, double by) {
                         burden(s, body, 0, {0, 0}, by);
                       }});
  }
  return numbers;
}

// All numbers of all force elements.
std::vector<Number> elements_of(const Scene& scene) {
  std::vector<Number> numbers;
  for (int i = 0; i < static_cast<int>(scene.elements.size()); ++i) {
    const Element& element = scene.elements[i];
    const std::span<const poise::Number> all = numbers_of(element.law);
    for (int k = 0; k < static_cast<int>(all.size()); ++k) {
      const auto add = [=](Scene& s, double by) {
        std::visit(
            [&](auto& law) {
              const poise::Number& number = numbers_of_law(law)[static_cast<std::size_t>(k)];
              number.set(&law, number.get(&law).value() + by);
            },
            s.elements[i].law);
      };
      numbers.push_back({element.family() + " \"" + element.name + "\", " + std::string(all[k].key),
                         forceful({ForceNumber::Of::element, i, k}), add});
    }
  }
  return numbers;
}

std::vector<Number> loads_of(const Scene& s) {
  std::vector<Number> numbers;
  for (int i = 0; i < static_cast<int>(s.torques.size()); ++i) {
    numbers.push_back({"torque " + s.torques[i].name, forceful({ForceNumber::Of::torque, i, 0}),
                       [=](Scene& scene, double by) { scene.torques[i].value += by; }});
  }
  for (int i = 0; i < static_cast<int>(s.forces.size()); ++i) {
    if (s.forces[i].follows >= 0) continue;
    const Vec2 along = (1 / norm(s.forces[i].vector)) * s.forces[i].vector;
    numbers.push_back({"force " + s.forces[i].name, forceful({ForceNumber::Of::force, i, 0}),
                       [=](Scene& scene, double by) { scene.forces[i].vector += by * along; }});
  }
  return numbers;
}

// alpha of the scene with a number changed, in the same state.
Values changed(const Scene& scene, const Number& number, double by, const std::vector<double>& q0,
               const State<Real>& state) {
  Scene other = scene;
  number.add(other, by);
  Compiled<Real> m(other);
  start(m, q0, state);
  EXPECT_TRUE(evaluate(m, state));
  return part(m.motion.alpha(), state.z.size());
}

TEST_P(WithoutRubbingJoints, FeelsEachNumberAsDifferencesDo) {
  // The least inertia here is 1e-7 kg m^2. Forces are linear in loads, so that only rounding of these counts, and
  // smooth in the numbers of elements, where the steps are exact in double.
  struct Group {
    std::vector<Number> numbers;
    double step, tolerance;
  };
  test::Random random(23);
  const State<Real> state = in_50_digits(random_state(scene_, q0_, random));
  Compiled<Real> at(scene_);
  start(at, q0_, state);
  ASSERT_TRUE(evaluate(at, state));
  for (const auto& [numbers, by, tolerance] :
       {Group{inertias_of(scene_), 0x1p-70, 1e-15}, Group{elements_of(scene_), 0x1p-25, 1e-12},
        Group{loads_of(scene_), 0x1p-3, 1e-12}}) {
    for (const Number& number : numbers) {
      SCOPED_TRACE(number.name);
      const Values more = changed(scene_, number, by, q0_, state);
      const Values less = changed(scene_, number, -by, q0_, state);
      Values alpha(state.z.size());
      at.motion.influence(number.influence, alpha.data());
      EXPECT_LT(apart(difference(more, less, Real(2 * by)), alpha), tolerance);
    }
  }
}

// M of the independent coordinates by the kinetic energy:  T(e_j + e_k) - T(e_j) - T(e_k) + T(0).
Values mass_times(Compiled<Real>& m, const Values& alpha) {
  const std::size_t f = alpha.size();
  const auto energy = [&](std::size_t j, std::size_t k) {
    Values w(f, Real(0));
    if (j < f) w[j] += 1;
    if (k < f) w[k] += 1;
    m.motion.move(w.data());
    return m.motion.kinetic_energy();
  };
  Values product(f, Real(0));
  for (std::size_t j = 0; j < f; ++j) {
    for (std::size_t k = 0; k < f; ++k) {
      product[j] += (energy(j, k) - energy(j, f) - energy(k, f) + energy(f, f)) * alpha[k];
    }
  }
  return product;
}

// What all bodies take together grows by M with the accelerations; the accelerations answer one body's part by -M^-1.
TEST_P(WithoutRubbingJoints, TakesForItsBodiesWhatTheKineticEnergySays) {
  test::Random random(29);
  const State<Real> state = in_50_digits(random_state(scene_, q0_, random));
  Compiled<Real> m(scene_);
  start(m, q0_, state);
  ASSERT_TRUE(evaluate(m, state));
  const std::size_t f = state.z.size();
  const Values alpha = part(m.motion.alpha(), f);
  Values more(f);
  for (Real& a : more) a = random.uniform(-3.0, 3.0);
  Values influence(f), answered(f);
  m.motion.influence(inertial(1, 0.3, {0.1, -0.2}, 0.7), influence.data());
  m.motion.reduced_inertia(1, {Real(0.3), {Real(0.1), Real(-0.2)}, Real(0.7)}, answered.data());
  const auto taken = [&](const Values& accelerations) {
    m.motion.accelerate_as(accelerations.data());
    Values sum(f, Real(0));
    for (std::size_t b = 1; b < scene_.bodies.size(); ++b) {
      const Body& body = scene_.bodies[b];
      const Real mass = body.mass;
      const Planar<Real> first = mass * planar_cast<Real>(body.center);
      Values own(f);
      m.motion.reduced_inertia(static_cast<int>(b),
                               {mass, first, body.inertia + dot(first, planar_cast<Real>(body.center))}, own.data());
      for (std::size_t j = 0; j < f; ++j) sum[j] += own[j];
    }
    return sum;
  };
  const Values low = taken(alpha);
  const Values high = taken(more);
  Values rise(f);
  for (std::size_t j = 0; j < f; ++j) rise[j] = more[j] - alpha[j];
  EXPECT_LT(apart(difference(high, low, Real(1)), mass_times(m, rise)), 1e-30);
  for (Real& x : answered) x = -x;
  EXPECT_LT(apart(answered, mass_times(m, influence)), 1e-30);
}

// Newton and Euler's equations of every body cut free, by motion/inverse_dynamics, which shares no formula with the
// reduced equations.
TEST_P(MovingMechanism, BalancesEveryBodyCutFree) {
  test::Random random(3);
  const MotionModel model(scene_);
  // Friction of joints is found under drives, which have to do nothing.
  std::vector<Drive> drives = scene_.drives;
  for (const std::string& freedom : GetParam().freedoms) drives.push_back(find_drive(scene_, freedom));
  for (int trial = 0; trial < 10; ++trial) {
    const State<double> state = random_state(scene_, q0_, random);
    Compiled<double> m(scene_);
    start(m, q0_, state);
    ASSERT_TRUE(evaluate(m, state));
    const auto n = static_cast<std::size_t>(m.motion.coordinates());
    const auto all = [&](const double* values) { return model.from_si({values, values + n}); };
    const Forces forces = forces_of(model, all(m.motion.q()), all(m.motion.v()), all(m.motion.a()), drives);
    EXPECT_EQ(forces.friction.state,
              GetParam().freedoms.empty() ? SlidingFriction::State::none : SlidingFriction::State::solved);
    EXPECT_LT(forces.imbalance, 1e-12 * forces.largest_force) << forces.worst_body;
    EXPECT_LT(forces.power.error, 1e-12);
    for (std::size_t k = 0; k < scene_.drives.size(); ++k) {
      const double value = forces.drives[k].value;
      EXPECT_NEAR(m.motion.drive_force(static_cast<int>(k)), value, 1e-11 * forces.largest_force);
    }
    for (std::size_t k = scene_.drives.size(); k < drives.size(); ++k) {
      EXPECT_NEAR(forces.drives[k].value, 0.0, 1e-11 * forces.largest_force) << drives[k].name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, MovingMechanism, testing::ValuesIn(all_cases()),
                         [](const auto& mechanism) { return mechanism.param.name; });
INSTANTIATE_TEST_SUITE_P(Each, WithoutRubbingJoints, testing::ValuesIn(cases()),
                         [](const auto& mechanism) { return mechanism.param.name; });

// The textbook's equations of two pinned bodies with masses m, centres r along their axes and moments I about them:
//   (I1 + m1 r1^2 + m2 l^2) a1 + m2 l r2 cos(d) a2 = -m2 l r2 sin(d) w2^2 - (m1 r1 + m2 l) g cos(q1),   d = q1 - q2
//   (I2 + m2 r2^2) a2 + m2 l r2 cos(d) a1 = m2 l r2 sin(d) w1^2 - m2 r2 g cos(q2).
TEST(ReducedMotion, DoublePendulumAcceleratesAsInTheTextbook) {
  constexpr double m1 = 1.3, m2 = 0.8, r1 = 0.3, r2 = 0.45, l = 0.7, i1 = 0.04, i2 = 0.03, g = 9.81;
  Scene scene = test::chain(2, l, 1.0);
  scene.gravity = {0, -g};
  scene.bodies[1].mass = m1;
  scene.bodies[1].center = {r1, 0};
  scene.bodies[1].inertia = i1;
  scene.bodies[2].mass = m2;
  scene.bodies[2].center = {r2, 0};
  scene.bodies[2].inertia = i2;
  test::Random random(5);
  Compiled<double> m(scene);
  for (int trial = 0; trial < 100; ++trial) {
    State<double> state;
    for (auto* values : {&state.z, &state.w}) *values = {random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0)};
    state.q = state.z;
    start(m, state.q, state);
    ASSERT_TRUE(evaluate(m, state));
    const double d = state.z[0] - state.z[1];
    const double m11 = i1 + m1 * r1 * r1 + m2 * l * l, m12 = m2 * l * r2 * std::cos(d), m22 = i2 + m2 * r2 * r2;
    const double f1 =
        -m2 * l * r2 * std::sin(d) * state.w[1] * state.w[1] - (m1 * r1 + m2 * l) * g * std::cos(state.z[0]);
    const double f2 = m2 * l * r2 * std::sin(d) * state.w[0] * state.w[0] - m2 * r2 * g * std::cos(state.z[1]);
    const double det = m11 * m22 - m12 * m12;
    const double a1 = (m22 * f1 - m12 * f2) / det, a2 = (m11 * f2 - m12 * f1) / det;
    EXPECT_NEAR(m.motion.alpha()[0], a1, 1e-13 * (std::abs(a1) + std::abs(a2)));
    EXPECT_NEAR(m.motion.alpha()[1], a2, 1e-13 * (std::abs(a1) + std::abs(a2)));
  }
}

}  // namespace
}  // namespace poise::reduced_motion_test
