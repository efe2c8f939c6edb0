// Controllers that set the acceleration of a drive. What a drive is led to does not depend on the mechanism behind it:
// closed forms of the course, the same course as a formula of time, and poles worked out by hand.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "motion/control_loop.hpp"
#include "motion/quantities_along.hpp"
#include "motion/response.hpp"
#include "motion/simulate.hpp"
#include "statics/bodies/body_measures.hpp"
#include "tests/support/every_measure.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motion_derivatives.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/seed.hpp"

namespace poise::set_drives_test {
namespace {

/// The answer of  g'' = w^2 (r - g) - 2 z w g'  from rest at g0, z < 1, and its rate.
struct Servo {
  double w = 5.0, z = 0.6, r = 1.0, g0 = 0.0;

  double damped() const { return w * std::sqrt(1 - z * z); }
  double place(double t) const {
    const double f = damped();
    return r + (g0 - r) * std::exp(-z * w * t) * (std::cos(f * t) + z * w / f * std::sin(f * t));
  }
  double rate(double t) const { return (r - g0) * w * w / damped() * std::exp(-z * w * t) * std::sin(damped() * t); }
  double acceleration(double t) const { return w * w * (r - place(t)) - 2 * z * w * rate(t); }

  std::string keys() const {
    return fmt::format("reference = {:.17g}\nproportional = {:.17g}\nderivative = {:.17g}\n", r, w * w, 2 * z * w);
  }
};

constexpr double length = 0.8, swung = 2.5, carried = 4.0, g = 9.81;

/// A trolley on rails "x" that is driven, and a mass that hangs from it.
std::string trolley(const std::string& tables, const std::string& units = "", double per_metre = 1.0) {
  return fmt::format(R"(
gravity = [0, -9.81]
{0}
[ground.points]
O = [0, 0]
[body.trolley]
mass = {1}
points = {{ c = [0, 0] }}
[body.load]
mass = {2}
inertia = 0
points = {{ c = [0, 0], P = [0, {3}] }}
center = [0, {3}]
[[slide]]
name = "x"
points = ["ground.O", "trolley.c"]
axis = [1, 0]
[[pin]]
name = "hook"
points = ["trolley.c", "load.c"]
[[drive]]
name = "motor"
slide = "x"
{4})",
                     units, carried, swung, -length * per_metre, tables);
}

std::string led(const std::string& law, const std::string& drive = "motor", const std::string& name = "servo") {
  return fmt::format("[[controller]]\nname = \"{}\"\nsets = \"drive.{}.acceleration\"\n{}", name, drive, law);
}

struct Read {
  Motion motion;
  std::vector<test::Reading> at;
};

Read read(const MotionModel& model, const test::Release& release, const std::vector<double>& times) {
  Read out{test::moved(model, test::released(model, release), times.back(), 1e-12), {}};
  EXPECT_LT(out.motion.energy_error, 1e-10);
  out.at = test::read_at(out.motion, times);
  return out;
}

const std::vector<double> times{0.2, 0.5, 0.9, 1.6, 2.5};

// The load swings by  phi'' = -(g sin phi + x'' cos phi)/l,  which Runge and Kutta's method integrates at 20 us; the
// motor pushes with (M + m) x'' + m l (phi'' cos phi - phi'^2 sin phi).
TEST(SetDrives, ATrolleyMovesAsItsServoSays) {
  const Servo servo;
  const std::string reads = "reads = { slide = \"x\" }\n";
  const Scene scene = parse_scene(trolley(led(reads + servo.keys())), "servo.toml");
  const MotionModel model(scene);
  const Read found = read(model, {.places = {{"load", 0.3}}}, times);
  const auto x = static_cast<std::size_t>(test::coordinate_of(model, "x")),
             load = static_cast<std::size_t>(test::coordinate_of(model, "load"));
  QuantitiesAlong along(scene, model, found.motion);
  const SoughtQuantity force = find_quantity(scene, "force.motor", AskedOf::motion);
  double phi = 0.3, rate = 0.0;
  const auto swing = [&](double t, double angle) {
    return -(g * std::sin(angle) + servo.acceleration(t) * std::cos(angle)) / length;
  };
  constexpr double h = 2e-5;
  std::size_t next = 0;
  for (int step = 1; next < times.size(); ++step) {
    const double t = (step - 1) * h, a1 = swing(t, phi), v2 = rate + h / 2 * a1;
    const double a2 = swing(t + h / 2, phi + h / 2 * rate), v3 = rate + h / 2 * a2;
    const double a3 = swing(t + h / 2, phi + h / 2 * v2), v4 = rate + h * a3, a4 = swing(t + h, phi + h * v3);
    phi += h / 6 * (rate + 2 * v2 + 2 * v3 + v4);
    rate += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (std::abs(step * h - times[next]) > h / 2) continue;
    const test::Reading& at = found.at[next];
    EXPECT_NEAR(at.q[x], servo.place(times[next]), 1e-10);
    EXPECT_NEAR(at.v[x], servo.rate(times[next]), 1e-10);
    EXPECT_NEAR(at.q[load], phi, 1e-8);
    EXPECT_NEAR(at.v[load], rate, 1e-8);
    const double acceleration = servo.acceleration(times[next]);
    const double pushes = (carried + swung) * acceleration +
                          swung * length * (swing(times[next], phi) * std::cos(phi) - rate * rate * std::sin(phi));
    EXPECT_NEAR(along.value(force, times[next]), pushes, 1e-6);
    ++next;
  }
  EXPECT_LT(along.imbalance(), 1e-9);

  // It is the same in millimetres, and an acceleration of the drive itself adds to that of its controller.
  Servo millimetres = servo;
  millimetres.r *= 1e3;
  const MotionModel other(parse_scene(
      trolley("acceleration = 500\n" + led(reads + millimetres.keys()), "[units]\nlength = \"mm\"\n", 1e3), "mm.toml"));
  const Read added = read(other, {.places = {{"load", 0.3}}}, times);
  Servo moved = servo;
  moved.r += 0.5 / (servo.w * servo.w);
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(added.at[k].q[x], moved.place(times[k]), 1e-10);
}

/// A crank-rocker with masses and a spring, whose crank a drive moves.
std::string four_bar(const std::string& tables) {
  return R"(
gravity = [0, -9.81]
[ground.points]
A = [0, 0]
D = [1, 0]
[body.crank]
mass = 2
inertia = 0.05
points = { A = [0, 0], B = [0.3, 0] }
center = [0.1, 0.05]
[body.coupler]
mass = 3
inertia = 0.2
points = { B = [0, 0], C = [0.9, 0], P = [0.5, 0.4] }
center = [0.4, 0.1]
[body.rocker]
mass = 2
inertia = 0.1
points = { D = [0, 0], C = [0.7, 0] }
center = [0.35, 0]
[body.bob]
mass = 0.7
inertia = 0.02
points = { P = [0, 0] }
center = [0, -0.3]
[[pin]]
points = ["ground.A", "crank.A"]
name = "A"
[[pin]]
points = ["crank.B", "coupler.B"]
name = "B"
[[pin]]
points = ["coupler.C", "rocker.C"]
name = "C"
[[pin]]
points = ["ground.D", "rocker.D"]
name = "D"
[[pin]]
points = ["coupler.P", "bob.P"]
name = "P"
[[spring]]
name = "S"
points = ["ground.D", "coupler.P"]
stiffness = 60
free_length = 0.2
[[drive]]
name = "motor"
bodies = ["ground", "crank"]
start = 0.4
[start]
crank = 0.4
coupler = 0.7
rocker = 1.9
bob = 0
)" + tables;
}

const std::string reads_crank = "reads = { bodies = [\"ground\", \"crank\"] }\n";

// A servo of the crank moves all bodies, and loads a pin, as the same course does as a formula of time.
TEST(SetDrives, ALoopIsDrivenAsByTheFormulaOfTheCourse) {
  const Servo servo{.r = 2.9, .g0 = 0.4};
  const double f = servo.damped(), decay = servo.z * servo.w;
  const std::string formula =
      fmt::format("{:.17g} + {:.17g} * exp(-{:.17g} * t) * (cos({:.17g} * t) + {:.17g} * sin({:.17g} * t))", servo.r,
                  servo.g0 - servo.r, decay, f, decay / f, f);
  const Scene scene = parse_scene(four_bar(led(reads_crank + servo.keys())), "servo.toml");
  std::string text = four_bar("");
  const std::string start = "start = 0.4\n";
  text.replace(text.find(start), start.size(), "time = { function = \"" + formula + "\" }\n");
  const Scene timed = parse_scene(text, "timed.toml");
  const MotionModel model(scene), other(timed);
  const Read found = read(model, {}, times), expected = read(other, {}, times);
  QuantitiesAlong along(scene, model, found.motion), along_time(timed, other, expected.motion);
  for (std::size_t k = 0; k < times.size(); ++k) {
    for (const char* const name : {"crank", "coupler", "rocker", "bob"}) {
      const auto i = static_cast<std::size_t>(test::coordinate_of(model, name)),
                 j = static_cast<std::size_t>(test::coordinate_of(other, name));
      EXPECT_NEAR(found.at[k].q[i], expected.at[k].q[j], 1e-9) << name;
      EXPECT_NEAR(found.at[k].v[i], expected.at[k].v[j], 1e-8) << name;
    }
    for (const char* const name : {"force.motor", "reaction.C.x", "reaction.C.y"}) {
      const double value = along_time.value(find_quantity(timed, name, AskedOf::motion), times[k]);
      EXPECT_NEAR(along.value(find_quantity(scene, name, AskedOf::motion), times[k]), value, 1e-6 * std::abs(value))
          << name;
    }
  }
  EXPECT_LT(along.imbalance(), 1e-9);
}

// Derivatives by numbers of the controllers, of the drive and of the spring are those of differences of motions.
TEST(SetDrives, DerivativesAreThoseOfMotions) {
  const Servo servo{.r = 1.6, .g0 = 0.4};
  const std::string text =
      four_bar(led(reads_crank + servo.keys() + "integral = 3\nfilter = 0.05\nfollows = \"bob\"\n") +
               "[[controller]]\nname = \"bob\"\nreads = { bodies = [\"crank\", \"bob\"] }\n"
               "proportional = 0.02\nderivative = 0.03\n");
  const Scene scene = parse_scene(text, "servo.toml");
  test::expect_derivatives(scene, test::released(MotionModel(scene), {}),
                           {"controller.servo.proportional", "controller.servo.derivative", "controller.servo.integral",
                            "controller.servo.filter", "controller.servo.reference", "controller.bob.derivative",
                            "spring.S.stiffness", "drive.motor.acceleration"},
                           {"crank", "rocker", "bob"}, 1.2);
}

// The load swings against a stop while the trolley moves: the motor gives impulses, and moves on as if there were none.
TEST(SetDrives, AnImpactDoesNotStopTheCourse) {
  const Servo servo;
  const Scene scene = parse_scene(
      trolley(led("reads = { slide = \"x\" }\n" + servo.keys()) +
              "[[stop]]\nname = \"bumper\"\nbodies = [\"ground\", \"load\"]\nmin = -0.2\nrestitution = 0.5\n"),
      "servo.toml");
  const MotionModel model(scene);
  const Read found = read(model, {}, times);
  ASSERT_FALSE(found.motion.events.empty());
  const auto x = static_cast<std::size_t>(test::coordinate_of(model, "x"));
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_NEAR(found.at[k].q[x], servo.place(times[k]), 1e-10);
    EXPECT_NEAR(found.at[k].v[x], servo.rate(times[k]), 1e-10);
  }
}

// What is limited and decided at samples is made of pieces of parabolas.
TEST(SetDrives, SamplesAndLimitsMakeParabolas) {
  const double period = 0.1, limit = 2.0, kp = 9.0, kd = 5.0, r = 0.7;
  const MotionModel model(parse_scene(
      trolley(led(fmt::format("reads = {{ slide = \"x\" }}\nreference = {}\nproportional = {}\nderivative = {}\n"
                              "min = {}\nmax = {}\nperiod = {}\n",
                              r, kp, kd, -limit, limit, period))),
      "servo.toml"));
  const std::vector<double> instants{0.35, 0.8, 1.45, 2.25};
  const Read found = read(model, {.places = {{"load", 0.3}}}, instants);
  const auto i = static_cast<std::size_t>(test::coordinate_of(model, "x"));
  double x = 0.0, v = 0.0;
  std::size_t next = 0;
  for (int k = 0; next < instants.size(); ++k) {
    const double u = std::clamp(kp * (r - x) - kd * v, -limit, limit);
    for (; next < instants.size() && instants[next] < (k + 1) * period; ++next) {
      const double t = instants[next] - k * period;
      EXPECT_NEAR(found.at[next].q[i], x + v * t + u * t * t / 2, 1e-10);
      EXPECT_NEAR(found.at[next].v[i], v + u * t, 1e-10);
    }
    x += v * period + u * period * period / 2;
    v += u * period;
  }
}

// The crane of datasets/ has the poles of (p^2 + 2 p + 2)(p^2 + 2 p + 5), and its trolley follows the reference by
// kp (s^2 + g/l) over that.
TEST(SetDrives, ACraneThatSeesItsLoadHasItsPoles) {
  const Scene scene = read_scene(test::dataset("machines/gantry_crane.toml"));
  const MotionModel model(scene);
  const ControlLoop found = control_loop(model, test::released(model, {}).q);
  ASSERT_TRUE(found.known) << found.why;
  EXPECT_EQ(found.stability, ControlLoop::Stability::stable);
  ASSERT_EQ(found.poles.size(), 4U);
  const auto characteristic = [](const std::complex<double>& p) {
    return (p * p + 2.0 * p + 2.0) * (p * p + 2.0 * p + 5.0);
  };
  for (const std::complex<double>& p : found.poles) EXPECT_LT(std::abs(characteristic(p)), 1e-5);
  // The mechanism alone: the course of the trolley, which nothing moves, and the load that swings.
  ASSERT_EQ(found.open_poles.size(), 4U);
  for (const std::complex<double>& p : found.open_poles) {
    EXPECT_LT(std::abs(p * p * (p * p + 9.81 / 2.0)), 1e-8);
  }
  const double kp = *value_at(scene, parameter(scene, "controller.trolley.proportional").place);
  const FrequencyResponse response(model, found, excitation_of(scene, "controller.trolley.reference"),
                                   find_quantity(scene, "x.trolley.c", AskedOf::motion));
  for (const double frequency : {0.01, 0.2, 0.4, 2.0}) {
    const std::complex<double> s(0.0, 2 * M_PI * frequency);
    const std::complex<double> expected = kp * (s * s + 9.81 / 2.0) / characteristic(s);
    EXPECT_LT(std::abs(response.at(frequency) / expected - 1.0), 1e-6) << frequency;
  }
}

/// Adds a drive of this measure, and a controller that leads it by what it reads of the same.
void add_servo(Scene& scene, const Measure& on, const Servo& servo) {
  scene.drives.push_back({.name = "D", .on = on, .start = {}});
  Feedback feedback;
  feedback.reads = on;
  feedback.acts = false;
  feedback.sets = {.of = TimeFunction::Of::drive, .item = 0, .number = 2, .path = "drive.D.acceleration"};
  feedback.signal = on.dimension();
  feedback.output = on.dimension() * dimension::time.power(-2);
  Controller law;
  law.given |= 1U << Controller::proportional | 1U << Controller::derivative;
  law.declare(feedback.signal, false, feedback.output);
  law.values[Controller::proportional] = servo.w * servo.w;
  law.values[Controller::derivative] = 2 * servo.z * servo.w;
  law.values[Controller::reference] = servo.r;
  feedback.course = scene.add_body("servo course");
  scene.bodies.back().inertia = Body::inertia_of_states;
  Element element;
  element.table = "controller";
  element.name = "servo";
  element.law = std::move(law);
  element.feedback = std::move(feedback);
  scene.elements.push_back(std::move(element));
}

/// The value of the drive's measure in closed coordinates, SI.
double driven(const MotionModel& model, const std::vector<double>& q) {
  const Scene& scaled = model.scaled_scene();
  const Measure& on = scaled.drives[0].on;
  const double value = value_of(scaled, on, model.mechanism().poses(model.from_si(q).data()));
  return on.is_angle() ? value : value * model.scales().length;
}

// Drives of measures of all kinds in random mechanisms with loops, and springs, dampers and friction on any measure:
// the measure follows the closed form of its servo, whatever moves behind it, and energies balance.
TEST(SetDrives, RandomMechanismsFollowTheirServos) {
  int compared = 0, ended = 0, refused = 0;
  const int wanted = test::cases(60, 1500);
  for (std::uint64_t seed = test::seed(1); compared < wanted; ++seed) {
    ASSERT_LT(ended + refused, wanted + 20);
    test::Random random(seed);
    test::Wish wish;
    wish.loops = random.index(3);
    wish.couplings = random.chance(0.3);
    Scene scene = test::plant_mechanism(seed, wish).in_equilibrium;
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
      if (scene.bodies[b].mass == 0.0) scene.bodies[b].mass = random.uniform(0.5, 2.0);
      if (scene.bodies[b].inertia == 0.0) scene.bodies[b].inertia = random.uniform(0.02, 0.1);
    }
    std::vector<test::NamedMeasure> measures = test::measures_of(scene, random, true);
    // At the corners of outlines rates jump, by impulses of the drive that are in no energy.
    std::erase_if(measures, [](const test::NamedMeasure& one) {
      return one.name.find("along") != std::string::npos || one.name.find("clearance") != std::string::npos;
    });
    const Measure on = measures[static_cast<std::size_t>(random.index(measures.size()))].measure;
    scene.drives = {{.name = "D", .on = on, .start = {}}};
    Servo servo{.w = random.uniform(3.0, 8.0), .z = random.uniform(0.2, 0.9)};
    try {
      const MotionModel plain(scene);
      servo.g0 = driven(plain, test::released(plain, {}).q);
      servo.r = servo.g0 + random.uniform(-0.1, 0.1);
      scene.drives.clear();
      add_servo(scene, on, servo);
      const MotionModel model(scene);
      const Motion motion = simulate(model, test::released(model, {}), {.duration = 0.5, .accuracy = 1e-11});
      if (!motion.completed()) {
        ++ended;
        continue;
      }
      EXPECT_LT(motion.energy_error, 1e-5) << seed;  // of stiff springs, or next to a singular pose
      const std::vector<double> instants{0.1, 0.23, 0.5};
      const std::vector<test::Reading> at = test::read_at(motion, instants);
      for (std::size_t k = 0; k < instants.size(); ++k) {
        EXPECT_NEAR(driven(model, at[k].q), servo.place(instants[k]), 1e-8) << seed << " " << scene.file;
      }
      ++compared;
    } catch (const InputError&) {
      ++refused;  // a measure that the joints hold
    }
  }
  RecordProperty("ended", ended);
  RecordProperty("refused", refused);
}

TEST(SetDrives, BadInputIsNamed) {
  const auto expect = [&](const std::string& tables, const std::string& words) {
    const std::string said = test::message_of([&] { parse_scene(trolley(tables), "servo.toml"); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_NE(said.find("servo.toml:"), std::string::npos) << said;
  };
  const std::string law = "reads = { slide = \"x\" }\nproportional = 1\n";
  const auto sets = [&](const std::string& path) {
    return "[[controller]]\nname = \"C\"\nsets = \"" + path + "\"\n" + law;
  };
  expect(sets("drive.motor.rate"), "expected \"drive.motor.acceleration\"");
  expect(sets("drive.moter.acceleration"), "drive.motor.acceleration");
  expect(sets("drive.motor.acceleration") + led(law), "found that of \"C\"");
  expect(led(law) + "[body.\"servo course\"]\nmass = 1\npoints = { c = [0, 0] }\n", "has that of its state");
  // A drive that moves by itself has no equilibrium.
  const Scene moving = parse_scene(trolley("rate = 0.1\n" + led(law)), "servo.toml");
  const MotionModel model(moving);
  const std::string said = test::message_of([&] { control_loop(model, test::released(model, {}).q); });
  EXPECT_NE(said.find("drive \"motor\""), std::string::npos) << said;
}

}  // namespace
}  // namespace poise::set_drives_test
