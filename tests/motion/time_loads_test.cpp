// Motions under loads and drives that follow functions of time of the scene, against closed forms.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "motion/forces_along.hpp"
#include "motion/motion_input.hpp"
#include "motion/motion_record.hpp"
#include "motion/release.hpp"
#include "motion/simulate.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_model.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/moving_scenes.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::time_loads_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double m = 2.0, k = 50.0, F = 3.0;
const double omega = std::sqrt(k / m);

/// A mass on a spring, pushed by F times a function of time.
Scene oscillator(const std::string& time) {
  return parse_scene(fmt::format(R"(
[ground.points]
O = [0, 0]
[body.block]
mass = {}
[body.block.points]
c = [0, 0]
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[spring]]
slide = "x"
stiffness = {}
free_length = 0
[[force]]
name = "F"
at = "block.c"
vector = [{}, 0]
time = {}
)",
                                 m, k, F, time),
                     "oscillator.toml");
}

Motion moved(const MotionModel& model, double duration, double accuracy = 1e-10) {
  return test::moved(model, test::released(model, {}), duration, accuracy);
}

/// Compares x(t) with a closed form, relative to its largest value.
template <class Exact>
void expect_course(const std::string& time, double duration, Exact exact) {
  const MotionModel model(oscillator(time));
  const Motion motion = moved(model, duration);
  EXPECT_LT(motion.energy_error, 1e-9) << time;
  std::vector<double> t;
  for (int i = 0; i <= 400; ++i) t.push_back(duration * i / 400);
  const std::vector<test::Reading> read = test::read_at(motion, t);
  double worst = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    worst = std::max(worst, std::abs(read[i].q[0] - exact(t[i])));
    largest = std::max(largest, std::abs(exact(t[i])));
  }
  EXPECT_LT(worst, 1e-9 * largest) << time;
}

// m x'' + k x = F sin(W t) from rest: (F/k)/(1 - r^2) (sin W t - r sin w t), r = W/w.
TEST(TimeLoads, SineHasItsTransientAndItsSteadyPart) {
  for (const double f : {0.3, 0.7, 2.0}) {
    const double W = 2 * pi * f, r = W / omega;
    expect_course(fmt::format("{{ sine = {{ amplitude = 1, frequency = {} }} }}", f), 6.0,
                  [&](double t) { return F / k / (1 - r * r) * (std::sin(W * t) - r * std::sin(omega * t)); });
  }
}

// At W = w: (F / 2k) (sin w t - w t cos w t), which grows linearly.
TEST(TimeLoads, ResonanceGrowsLinearly) {
  expect_course(fmt::format("{{ sine = {{ amplitude = 1, frequency = {:.17g} }} }}", omega / (2 * pi)), 10.0,
                [&](double t) { return F / (2 * k) * (std::sin(omega * t) - omega * t * std::cos(omega * t)); });
}

// A load that comes at once: (F/k) (1 - cos w (t - t0)), twice the deflection at rest.
TEST(TimeLoads, StepOvershootsTwice) {
  const auto exact = [&](double t) { return t < 0.37 ? 0.0 : F / k * (1 - std::cos(omega * (t - 0.37))); };
  expect_course("{ step = { at = 0.37, to = 1 } }", 4.0, exact);
  const MotionModel model(oscillator("{ step = { at = 0.37, to = 1 } }"));
  const Motion motion = moved(model, 0.37 + pi / omega);
  EXPECT_NEAR(motion.trajectory.q.back(), 2 * F / k, 1e-10);
  // Before and behind the jump there is a node, and the acceleration jumps by F/m.
  const auto at = std::find(motion.trajectory.t.begin(), motion.trajectory.t.end(), 0.37);
  ASSERT_NE(at, motion.trajectory.t.end());
  const auto node = static_cast<std::size_t>(at - motion.trajectory.t.begin());
  ASSERT_EQ(motion.trajectory.t[node + 1], 0.37);
  EXPECT_EQ(motion.trajectory.a[node], 0.0);
  EXPECT_DOUBLE_EQ(motion.trajectory.a[node + 1], F / m);
}

// F(t) = F t/T up to T: (F/k) (t - sin(w t)/w)/T, then on from there about F/k.
TEST(TimeLoads, RampLeavesAnOscillation) {
  const double T = 0.8;
  expect_course("{ ramp = { to = 1, end = 0.8 } }", 4.0, [&](double t) {
    const auto rising = [&](double s) { return F / k * (s - std::sin(omega * s) / omega) / T; };
    return t < T ? rising(t) : rising(t) - rising(t - T);
  });
}

// A step by superposition: a table with a tooth, of three ramps.
TEST(TimeLoads, TableIsASumOfRamps) {
  expect_course("{ table = [[0, 0], [0.5, 1], [1.25, -2], [1.5, 0]] }", 3.0, [&](double t) {
    const auto ramp = [&](double from) {
      const double s = t - from;
      return s < 0 ? 0.0 : F / k * (s - std::sin(omega * s) / omega);
    };
    return 2 * ramp(0) + (-4 - 2) * ramp(0.5) + (8 + 4) * ramp(1.25) - 8 * ramp(1.5);
  });
}

TEST(TimeLoads, StaticsTakesTheLoadsAtTimeZero) {
  const StaticModel model(oscillator("{ sine = { amplitude = 2, frequency = 1, offset = 0.5, phase = 0.3 } }"));
  const Equilibrium found = solve(model);
  ASSERT_TRUE(found.found());
  EXPECT_NEAR(model.to_si(found.x)[0], F / k * (0.5 + 2 * std::sin(0.3)), 1e-12);
  ASSERT_EQ(model.scene().held_loads.size(), 1U);
  EXPECT_EQ(model.scene().held_loads[0].name, "F");
}

// A block that sticks under 1 N, of friction 2 N, slides under 5 N from 0.4 s to 0.9 s and is stopped by the friction:
// x = (5 - 2)/(2 m) (t - 0.4)^2, then with the rate v = 3/m 0.5 s on over v^2 m/(2 2).
TEST(TimeLoads, JumpsFreeWhatSticks) {
  const MotionModel model(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "x"
points = ["ground.O", "block.C"]
axis = [1, 0]
[[friction]]
slide = "x"
force = 2
width = 0
[[force]]
name = "up"
at = "block.C"
vector = [1, 0]
time = { step = { at = 0.4, from = 1, to = 5 } }
[[force]]
name = "down"
at = "block.C"
vector = [-5, 0]
time = { step = { at = 0.9, to = 1 } }
)",
                                      "block.toml"));
  const Motion motion = moved(model, 3.0);
  EXPECT_LT(motion.energy_error, 1e-10);
  const std::vector<test::Reading> read = test::read_at(motion, {0.3, 0.4, 0.6, 0.9, 2.9});
  const double v = 3.0 / 2 * 0.5, end = 3.0 / 4 * 0.25;
  EXPECT_NEAR(read[0].q[0], 0, 1e-14);
  EXPECT_NEAR(read[1].q[0], 0, 1e-14);
  EXPECT_NEAR(read[2].q[0], 3.0 / 4 * 0.04, 1e-12);
  EXPECT_NEAR(read[3].q[0], end, 1e-12);
  EXPECT_NEAR(read[4].q[0], end + v * v * 2 / 4, 1e-12);
  EXPECT_NEAR(read[4].v[0], 0, 1e-12);
}

/// A crank whose angle a function of time prescribes.
Scene driven_crank(const std::string& time) {
  return parse_scene(fmt::format(R"(
[units]
angle = "deg"
[ground.points]
O = [0, 0]
[body.crank]
mass = 2
inertia = 0.3
center = [0.4, 0]
[body.crank.points]
O = [0, 0]
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
time = {}
)",
                                 time),
                     "crank.toml");
}

// h = 90 degrees in T: w = (h/T) 30 s^2 (1-s)^2, w' = (h/T^2) 60 s (1 - s)(1 - 2 s); torque = (I + m c^2) w'.
TEST(TimeLoads, RampOfADriveIsA345Polynomial) {
  const MotionModel model(driven_crank("{ ramp = { from = 10, to = 100, start = 0.2, end = 1.2 } }"));
  const Motion motion = moved(model, 1.5);
  const double inertia = 0.3 + 2 * 0.4 * 0.4;
  EXPECT_LT(motion.energy_error, 1e-9);
  for (std::size_t i = 0; i < motion.trajectory.nodes(); ++i) {
    const double s = std::clamp(motion.trajectory.t[i] - 0.2, 0.0, 1.0);
    EXPECT_NEAR(motion.trajectory.q[i], pi / 18 + pi / 2 * s * s * s * (10 - 15 * s + 6 * s * s), 1e-12);
    EXPECT_NEAR(motion.trajectory.v[i], pi / 2 * 30 * s * s * (1 - s) * (1 - s), 1e-12);
    const double alpha = pi / 2 * 60 * s * (1 - s) * (1 - 2 * s);
    EXPECT_NEAR(motion.trajectory.a[i], alpha, 1e-11);
    EXPECT_NEAR(motion.drive_force[0][i], inertia * alpha, 1e-11);
  }
  EXPECT_NEAR(motion.trajectory.q.back(), pi * 100 / 180, 1e-12);
}

TEST(TimeLoads, InverseDynamicsHasTheLoadOfEachTime) {
  const MotionModel model(driven_crank("{ table = [[0, 0], [0.5, 40], [1, 30], [1.5, 90]] }"));
  const Motion driven = moved(model, 1.5);
  Scene loaded = model.scene();
  loaded.torques.push_back({.name = "M", .body = 1, .value = 5.0});
  loaded.time_functions.push_back({TimeFunction::Of::torque, 0, SineInTime{1.0, 0.8, 0.2, 0.5}});
  const MotionModel with_load(loaded);
  std::vector<double> times;
  GivenMotion given;
  for (std::size_t i = 0; i < driven.trajectory.nodes(); i += 3) {
    times.push_back(driven.trajectory.t[i]);
    given.x.push_back({driven.trajectory.q[i]});
    given.v.push_back({driven.trajectory.v[i]});
    given.a.push_back({driven.trajectory.a[i]});
  }
  const ForcesAlong forces = forces_along(with_load, times, given);
  EXPECT_TRUE(forces.balanced());
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double expected = (0.3 + 2 * 0.16) * given.a[i][0] - 5.0 * (0.5 + std::sin(2 * pi * 0.8 * times[i] + 0.2));
    EXPECT_NEAR(forces.poses[i].drives[0].value, expected, 1e-9);
  }
  EXPECT_THROW(forces_over(with_load, {{"motor", 0.0, 1.0}}, {}, false), InputError);
}

const std::vector<TimeLaw>& some_laws() {
  static const std::vector<TimeLaw> laws{
      SineInTime{1.3, 1.7, 0.4, 0.2},
      RampInTime{-0.5, 1.5, 0.1, 0.5, Way::linear},
      RampInTime{0.5, -1.5, 0.2, 0.45, Way::polynomial_345},
      StepInTime{0.3, 0.4, 1.6},
      TableInTime::through({0.05, 0.2, 0.33, 0.6}, {1.0, -1.0, 2.0, 0.5}, TimeTable::Between::linear, true),
      TableInTime::through({0.05, 0.2, 0.33, 0.6}, {1.0, -1.0, 2.0, 0.5}, TimeTable::Between::monotone, true),
      TableInTime::through({-0.1, 0.2, 0.33, 0.9}, {1.0, -1.0, 2.0, 0.5}, TimeTable::Between::spline, true)};
  return laws;
}

TEST(TimeLoads, SensitivitiesAreThoseOfDifferences) {
  const double duration = 0.7;
  for (const bool follower : {false, true}) {
    const Scene written = follower ? test::four_bar_with_follower() : test::four_bar_with_everything();
    for (const TimeFunction::Of of : {TimeFunction::Of::force, TimeFunction::Of::torque}) {
      for (const TimeLaw& law : some_laws()) {
        Scene scene = written;
        const int item = of == TimeFunction::Of::force ? static_cast<int>(scene.forces.size()) - 1 : 0;
        scene.time_functions.push_back({of, item, law});
        const TimeFunction& function = scene.time_functions[0];
        const MotionModel model(scene);
        const MotionState start = test::released(model, {{}, {{"crank", 2.0}}});
        MotionOptions options;
        options.duration = duration;
        options.accuracy = 1e-11;
        options.sensitivities = true;
        const auto load = of == TimeFunction::Of::force ? ForceNumber::Of::force : ForceNumber::Of::torque;
        std::vector<ParameterPlace> places;
        for (int n = 0; n < static_cast<int>(function.numbers().size()); ++n) {
          options.influences.push_back({.force = {load, item, 0, n}});
          places.push_back({Owner::time, 0, 0, n});
        }
        // The magnitude of the load itself too.
        const bool force = of == TimeFunction::Of::force;
        options.influences.push_back(
            {.force = {load, item, 0},
             .by = (force ? scene.forces[static_cast<std::size_t>(item)].numbers()[0].dimension : dimension::torque)
                       .per_scale(model.scales())});
        places.push_back({force ? Owner::force : Owner::torque, item});
        const Motion motion = simulate(model, start, options);
        ASSERT_TRUE(motion.completed()) << motion.why;
        EXPECT_LT(motion.energy_error, 1e-8);
        options.sensitivities = false;
        const std::size_t n = start.q.size();
        const std::size_t last = (motion.trajectory.nodes() - 1) * n;
        const auto width = static_cast<std::size_t>(motion.trajectory.columns);
        for (std::size_t p = 0; p < places.size(); ++p) {
          const double h = 1e-4;
          std::vector<std::vector<double>> ends;
          for (const double by : {-h, h}) {
            Scene other = scene;
            set_value_at(other, places[p], *value_at(scene, places[p]) + by);
            MotionOptions plain = options;
            plain.influences.clear();
            const MotionModel changed(other, model.scales());
            const Motion end = simulate(changed, start, plain);
            ASSERT_TRUE(end.completed());
            ends.push_back(test::q_at(end, end.trajectory.nodes() - 1));
          }
          for (std::size_t i = 0; i < n; ++i) {
            const double slope = (ends[1][i] - ends[0][i]) / (2 * h);
            const double found = motion.trajectory.q_p[(last + i) * width + width - places.size() + p];
            EXPECT_NEAR(found, slope, 2e-6 * (1 + std::abs(slope)))
                << function.kind() << " " << p << " of " << places.size() << " at " << i;
          }
        }
      }
    }
  }
}

// Energy of random mechanisms under random functions of time, and the steps of breaks.
TEST(TimeLoads, KeepTheEnergyOfRandomMechanisms) {
  int with_loads = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3), .followers = seed % 2 == 0, .other_laws = true};
    Scene scene = test::plant_mechanism(seed, wish).in_equilibrium;
    if (scene.forces.empty() && scene.torques.empty()) continue;
    std::size_t next = seed;
    for (std::size_t i = 0; i < scene.forces.size(); ++i) {
      scene.time_functions.push_back(
          {TimeFunction::Of::force, static_cast<int>(i), some_laws()[next++ % some_laws().size()]});
    }
    for (std::size_t i = 0; i < scene.torques.size(); ++i) {
      scene.time_functions.push_back(
          {TimeFunction::Of::torque, static_cast<int>(i), some_laws()[next++ % some_laws().size()]});
    }
    const MotionModel model(scene);
    MotionOptions options;
    options.duration = 0.6;
    options.accuracy = 1e-9;
    options.most_steps = 20000;
    const Motion motion = simulate(model, test::released(model, {}), options);
    if (!motion.completed()) continue;  // singular poses
    ++with_loads;
    EXPECT_LT(motion.energy_error, 1e-7) << seed;
  }
  EXPECT_GT(with_loads, 30);
}

/// A mass on a slide, without gravity, with a spring and what is added.
std::string mass_on_spring(const std::string& spring, const std::string& more) {
  return fmt::format(R"(
[numbers]
a = 0.7
q = 0.5
[ground.points]
O = [0, 0]
[body.block]
mass = 1
[body.block.points]
c = [0, 0]
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[spring]]
name = "s"
slide = "x"
{}
{}
)",
                     spring, more);
}

// x'' + (a - 2 q cos 2t) x = 0 has solutions of period 2 pi at its characteristic values: odd ones at b1, even ones at
// a1 (Mathieu functions; values of SciPy's mathieu_b and mathieu_a, to 12 digits).
TEST(TimeLoads, SpringsThatVaryInTimeFollowMathieusEquation) {
  struct Known {
    double q, a;
    bool is_odd;
  };
  for (const Known& known : {Known{0.5, 0.470654354934, true}, Known{0.5, 1.46676684252, false},
                             Known{2, -1.39067650123, true}, Known{5, 1.85818754155, false}}) {
    Scene scene = parse_scene(mass_on_spring("stiffness = 1\nfree_length = 0\n"
                                             "time = { stiffness = { function = \"a - 2*q*cos(2*t)\" } }",
                                             ""),
                              "mathieu.toml");
    set_value(scene, "numbers.a", known.a);
    set_value(scene, "numbers.q", known.q);
    const MotionModel model(scene);
    const Channel x = channels_of(model).at(0);
    const MotionState start = release(model, {}, {{x, known.is_odd, 1.0}});
    MotionOptions options;
    options.duration = 2 * pi;
    options.accuracy = 1e-11;
    const Motion motion = simulate(model, start, options);
    ASSERT_TRUE(motion.completed()) << motion.why;
    const double size =
        std::max(1.0, std::abs(*std::max_element(motion.trajectory.q.begin(), motion.trajectory.q.end())));
    EXPECT_NEAR(motion.trajectory.q.back(), known.is_odd ? 0.0 : 1.0, 1e-9 * size) << known.a;
    EXPECT_NEAR(motion.trajectory.v.back(), known.is_odd ? 1.0 : 0.0, 1e-9 * size) << known.a;
    EXPECT_LT(motion.energy_error, 1e-9);
  }
}

// m x'' = -k (x - L c(t)): the free length that oscillates pushes as a load k L c(t).
TEST(TimeLoads, FreeLengthsThatVaryPushAsLoadsDo) {
  const double duration = 5.0;
  const MotionModel by_length(parse_scene(
      mass_on_spring("stiffness = 9\nfree_length = 0.2\ntime = { free_length = { function = \"1 + sin(2*t)\" } }", ""),
      "length.toml"));
  const MotionModel by_load(parse_scene(mass_on_spring("stiffness = 9\nfree_length = 0.2",
                                                       "[[force]]\nat = \"block.c\"\nvector = [1.8, 0]\n"
                                                       "time = { function = \"sin(2*t)\" }"),
                                        "load.toml"));
  const Motion a = moved(by_length, duration), b = moved(by_load, duration);
  EXPECT_LT(a.energy_error, 1e-9);
  EXPECT_NEAR(a.trajectory.q.back(), b.trajectory.q.back(), 1e-10);
  EXPECT_NEAR(a.trajectory.v.back(), b.trajectory.v.back(), 1e-10);
}

const std::string pendulum_on = R"(
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
[body.cart]
[body.cart.points]
c = [0, 0]
[body.pole]
mass = 1.2
inertia = 0.02
center = [0.4, 0.05]
[body.pole.points]
c = [0, 0]
[[pin]]
points = ["cart.c", "pole.c"]
[start]
pole = -1.1
)";

// A pendulum on a cart that is driven, and one whose frame moves as the cart does, swing alike.
TEST(TimeLoads, MovingFramesActAsDrivenCarts) {
  const std::string function = "{ function = \"0.1*sin(7*t) + 0.02*t^2\" }";
  for (const std::string axis : {"x", "y"}) {
    const std::string direction = axis == "x" ? "[1, 0]" : "[0, 1]";
    const MotionModel driven(
        parse_scene(pendulum_on + "[[slide]]\nname = \"s\"\npoints = [\"ground.O\", \"cart.c\"]\naxis = " + direction +
                        "\n[[drive]]\nslide = \"s\"\ntime = " + function + "\n",
                    "cart.toml"));
    for (const std::string& as : {function, std::string("{ as = \"velocity\", function = \"0.7*cos(7*t) + 0.04*t\" }"),
                                  std::string("{ as = \"acceleration\", function = \"0.04 - 4.9*sin(7*t)\" }")}) {
      const MotionModel moving(parse_scene(
          pendulum_on + "[[weld]]\npoints = [\"ground.O\", \"cart.c\"]\n[frame]\n" + axis + " = " + as + "\n",
          "frame.toml"));
      const Motion a = moved(driven, 3.0), b = moved(moving, 3.0);
      ASSERT_TRUE(a.completed()) << a.why;
      ASSERT_TRUE(b.completed()) << b.why;
      EXPECT_LT(b.energy_error, 1e-9);
      const auto angle_at_end = [](const MotionModel& model, const Motion& motion) {
        const std::vector<Channel> channels = channels_of(model);
        const Channel& pole = channel_named("pole", "pole", channels);
        const std::size_t first = motion.trajectory.q.size() - static_cast<std::size_t>(model.layout().kept);
        return motion.trajectory.q[first + static_cast<std::size_t>(pole.coordinate)] + pole.offset;
      };
      EXPECT_NEAR(angle_at_end(driven, a), angle_at_end(moving, b), 1e-9) << axis << " " << as;
    }
  }
}

/// The last place and rate of a scene's one coordinate, started with these.
Vec2 last_state(const Scene& scene, double duration, Vec2 start) {
  const MotionModel model(scene);
  MotionOptions options;
  options.duration = duration;
  options.accuracy = 1e-12;
  const Motion motion = simulate(model, {{start.x}, {start.y}}, options);
  EXPECT_TRUE(motion.completed()) << motion.why;
  return {motion.trajectory.q.back(), motion.trajectory.v.back()};
}

// At the threshold a multiplier of a period is -1:  1 + trace + determinant = 0.
TEST(TimeLoads, PumpedSpringsBeginToSwingAtTheThresholdOfHill) {
  struct Known {
    double e, W;
  };
  for (const Known& known : {Known{0.0800069996632, 2.0}, Known{0.2, 1.90678656992}, Known{0.2, 2.08994774342}}) {
    Scene scene = read_scene(std::string(POISE_SOURCE_DIR) + "/datasets/pumped_spring.toml");
    set_value(scene, "numbers.e", known.e);
    set_value(scene, "numbers.W", known.W);
    const double period = 2 * pi / known.W;
    const Vec2 middle{0.5, 0};
    const Vec2 a = last_state(scene, period, middle + Vec2{1, 0}) - middle;
    const Vec2 b = last_state(scene, period, middle + Vec2{0, 1}) - middle;
    EXPECT_NEAR(1 + a.x + b.y + a.x * b.y - a.y * b.x, 0, 1e-9) << known.W;
    EXPECT_NEAR(a.x * b.y - a.y * b.x, std::exp(-0.04 * period), 1e-10) << "Liouville";
  }
}

// Shaken by a cosine, it comes back after a period where it stands just so (ce0 has that period), and after two, in the
// opposite direction or not, where hanging begins or ends to be unstable (ce1, se1).
TEST(TimeLoads, ShakenPendulumsStandAndFallAsMathieuSays) {
  struct Known {
    double h, ratio, angle;
    int periods;
    bool is_rate;
  };
  constexpr double up = pi / 2, down = -pi / 2;
  for (const Known& known : {Known{0.05, 28.2997163519, up, 1, false}, Known{0.1, 14.1728900208, up, 1, false},
                             Known{0.2, 7.13152811249, up, 1, false}, Known{0.4, 3.64909553093, up, 1, false},
                             Known{0.05, 1.90802320363, down, 2, false}, Known{0.05, 2.10963239264, down, 2, true},
                             Known{0.2, 1.70313843982, down, 2, false}, Known{0.2, 2.62391146774, down, 2, true}}) {
    const std::string dataset = std::string(POISE_SOURCE_DIR) + "/datasets/shaken_pendulum.toml";
    std::ifstream file(dataset);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    text.replace(text.find("sin(W*t)"), 8, "cos(W*t)");
    text.replace(text.find("\"l/10\""), 6, fmt::format("\"l*{}\"", known.h));
    Scene scene = parse_scene(text, dataset);
    set_value(scene, "numbers.ratio", known.ratio);
    const double omega0 = std::sqrt(9.81 / 0.4), period = 2 * pi / (known.ratio * omega0);
    constexpr double small = 1e-5;  // its cube is left out
    const Vec2 start = known.is_rate ? Vec2{known.angle, small} : Vec2{known.angle + small, 0};
    const Vec2 end = last_state(scene, known.periods * period, start);
    EXPECT_NEAR((end.x - known.angle) / small, known.is_rate ? 0 : 1, 2e-6) << known.h << " " << known.ratio;
    EXPECT_NEAR(end.y / small / (known.is_rate ? 1 : omega0), known.is_rate ? 1 : 0, 1e-4)
        << known.h << " " << known.ratio;
  }
}

// The force of a drive jumps with its acceleration, by the mass times that, and the motion has both sides.
TEST(TimeLoads, ForcesOfDrivesJumpWithTheirAccelerations) {
  const MotionModel model(
      parse_scene(mass_on_spring("stiffness = 9\nfree_length = 0",
                                 "[[drive]]\nslide = \"x\"\ntime = { ramp = { to = 0.9, start = 0.3, end = 1.2, law = "
                                 "\"trapezoidal\" } }"),
                  "trapezoidal.toml"));
  const Motion motion = moved(model, 1.5);
  ASSERT_TRUE(motion.completed()) << motion.why;
  EXPECT_LT(motion.energy_error, 1e-12);
  const double a = 0.9 * 4.5 / (0.9 * 0.9);
  const std::vector<double> jumps{a, -a, -a, a};
  for (std::size_t j = 0; j < jumps.size(); ++j) {
    const double at = 0.3 + 0.3 * static_cast<double>(j);
    const auto node = static_cast<std::size_t>(std::find_if(motion.trajectory.t.begin(), motion.trajectory.t.end(),
                                                            [&](double t) { return std::abs(t - at) < 1e-12; }) -
                                               motion.trajectory.t.begin());
    ASSERT_LT(node + 1, motion.trajectory.nodes());
    EXPECT_EQ(motion.trajectory.t[node + 1], motion.trajectory.t[node]);
    EXPECT_NEAR(motion.drive_force[0][node + 1] - motion.drive_force[0][node], jumps[j], 1e-9) << j;
  }
}

TEST(TimeLoads, AMotionEndsWhereAFunctionHasNoValue) {
  const MotionModel model(oscillator("{ function = \"sqrt(1.5 - t)\" }"));
  MotionOptions options;
  options.duration = 2.0;
  options.accuracy = 1e-6;
  const Motion motion = simulate(model, test::released(model, {}), options);
  EXPECT_EQ(motion.status, MotionStatus::stuck);
  EXPECT_NE(motion.why.find("the function of time of \"F\" has no value"), std::string::npos) << motion.why;
  EXPECT_NEAR(motion.trajectory.t.back(), 1.5, 1e-6);
}

}  // namespace
}  // namespace poise::time_loads_test
