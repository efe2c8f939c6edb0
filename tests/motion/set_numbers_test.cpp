// Controllers that set numbers of springs, dampers and loads, and that read forces: closed forms, values integrated
// apart from Poise, and the same mechanism written with controllers that act on measures.

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "motion/control_loop.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/quantities_along.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/response.hpp"
#include "motion/simulate.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motion_derivatives.hpp"
#include "tests/support/motions.hpp"

namespace poise::set_numbers_test {
namespace {

constexpr double mass = 2.0;

/// A block of 2 kg on rails "x" between what `tables` say.
std::string block(const std::string& tables, const std::string& units = "") {
  return fmt::format(R"(
gravity = [0, 0]
{}
[ground.points]
O = [0, 0]
[body.block]
mass = {}
points = {{ c = [0, 0] }}
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
{})",
                     units, mass, tables);
}

/// An arm of 0.5 m and 0.6 kg m^2 about O that gravity pulls.
std::string arm(const std::string& tables) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
P = [0.3, 1]
[body.arm]
mass = 1.5
inertia = 0.225
points = {{ O = [0, 0], tip = [0.5, 0] }}
center = [0.5, 0]
[[pin]]
points = ["ground.O", "arm.O"]
{})",
                     tables);
}

/// Readings of the coordinate NAME: its place, then its rate.
std::vector<std::pair<double, double>> course(const std::string& text, const std::string& name,
                                              const std::vector<double>& times, const test::Release& release) {
  const MotionModel model(parse_scene(text, "set.toml"));
  const Motion motion = test::moved(model, test::released(model, release), times.back(), 1e-12);
  EXPECT_LT(motion.energy_error, 1e-10);
  std::vector<std::pair<double, double>> out;
  const auto i = static_cast<std::size_t>(test::coordinate_of(model, name));
  for (const test::Reading& at : test::read_at(motion, times)) out.emplace_back(at.q[i], at.v[i]);
  return out;
}

const std::vector<double> times{0.3, 0.9, 1.7, 2.6, 4.0};

void expect_same(const std::string& text, const std::string& other, const std::string& name,
                 const test::Release& release, double within = 1e-10) {
  const auto found = course(text, name, times, release), expected = course(other, name, times, release);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_NEAR(found[k].first, expected[k].first, within) << text;
    EXPECT_NEAR(found[k].second, expected[k].second, within) << text;
  }
}

// k = k0 + a (r - x): the energy m v^2/2 + (k0 + a r) x^2/2 - a x^3/3 stays, in metres and in millimetres.
TEST(SetNumbers, AStiffnessThatFollowsThePlaceKeepsItsEnergy) {
  const double k0 = 20.0, a = 6.0, r = 0.4;
  const std::string tables = R"(
[[spring]]
name = "main"
slide = "x"
stiffness = {}
free_length = 0
[[controller]]
name = "C"
sets = "spring.main.stiffness"
reads = {{ slide = "x" }}
reference = {}
proportional = {}
)";
  const auto metres = course(block(fmt::format(fmt::runtime(tables), k0, r, a)), "x", times,
                             {.places = {{"x", 0.5}}, .rates = {{"x", 0.7}}});
  const auto energy = [&](double x, double v) {
    return mass * v * v / 2 + (k0 + a * r) * x * x / 2 - a * x * x * x / 3;
  };
  for (const auto& [x, v] : metres) EXPECT_NEAR(energy(x, v), energy(0.5, 0.7), 1e-9);
  const auto millimetres =
      course(block(fmt::format(fmt::runtime(tables), k0 / 1e3, r * 1e3, a / 1e6), "[units]\nlength = \"mm\"\n"), "x",
             times, {.places = {{"x", 0.5}}, .rates = {{"x", 0.7}}});
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(metres[k].first, millimetres[k].first, 1e-10);
}

// m x'' + (c0 + a (r - x)) x' + k x = 0 by Runge and Kutta's method at 20 us.
TEST(SetNumbers, ADamperThatFollowsThePlace) {
  const double k = 30.0, c0 = 0.2, a = 3.0, r = 0.9;
  const std::string text = block(R"(
[[spring]]
slide = "x"
stiffness = 30
free_length = 0
[[damper]]
name = "D"
slide = "x"
coefficient = 0.2
[[controller]]
name = "C"
sets = "damper.D.coefficient"
reads = { slide = "x" }
reference = 0.9
proportional = 3
)");
  const auto found = course(text, "x", times, {.places = {{"x", 0.8}}});
  double x = 0.8, v = 0.0;
  const auto acceleration = [&](double at, double rate) { return -((c0 + a * (r - at)) * rate + k * at) / mass; };
  constexpr double h = 2e-5;
  std::size_t next = 0;
  for (int step = 1; next < times.size(); ++step) {
    const double a1 = acceleration(x, v), v2 = v + h / 2 * a1, a2 = acceleration(x + h / 2 * v, v2);
    const double v3 = v + h / 2 * a2, a3 = acceleration(x + h / 2 * v2, v3), v4 = v + h * a3;
    const double a4 = acceleration(x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (std::abs(step * h - times[next]) > h / 2) continue;
    EXPECT_NEAR(found[next].first, x, 1e-8);
    EXPECT_NEAR(found[next].second, v, 1e-8);
    ++next;
  }
}

// A free length that is moved is a force on the measure: the same as a controller that acts on it.
TEST(SetNumbers, AFreeLengthIsAForce) {
  const std::string spring = "[[spring]]\nname = \"S\"\nslide = \"x\"\nstiffness = 40\nfree_length = 0.1\n";
  const std::string law = "reference = 0.3\nintegral = {}\nproportional = {}\nderivative = {}\nmin = {}\nmax = {}\n";
  const auto with = [&](double factor, const std::string& on) {
    return block(spring + "[[controller]]\nname = \"C\"\n" + on +
                 fmt::format(fmt::runtime(law), 2 * factor, factor, 0.2 * factor, -0.3 * factor, 0.25 * factor));
  };
  expect_same(with(1.0, "sets = \"spring.S.free_length\"\nreads = { slide = \"x\" }\n"), with(40.0, "slide = \"x\"\n"),
              "x", {.places = {{"x", 0.2}}});
}

// The thrust of a force that follows the arm, at its tip and square to it, is a torque; so is a torque.
TEST(SetNumbers, ThrustAndTorqueActAsAControllerOnTheAngle) {
  const std::string law = "reference = 0.4\nproportional = {}\nderivative = {}\nintegral = {}\n";
  const std::string reads = "reads = { bodies = [\"ground\", \"arm\"] }\n";
  const auto with = [&](const std::string& tables, const std::string& on, double factor) {
    return arm(tables + "[[controller]]\nname = \"C\"\n" + on +
               fmt::format(fmt::runtime(law), 12 * factor, 1.5 * factor, 4 * factor));
  };
  const std::string expected = with("", "bodies = [\"ground\", \"arm\"]\n", 1.0);
  expect_same(with("[[force]]\nname = \"thrust\"\nat = \"arm.tip\"\ndirection = [0, 1]\nsize = 0\nfollows = \"arm\"\n",
                   "sets = \"load.thrust\"\n" + reads, 2.0),
              expected, "arm", {.places = {{"arm", -0.5}}});
  expect_same(with("[[torque]]\nname = \"motor\"\non = \"arm\"\nvalue = 0\n", "sets = \"load.motor\"\n" + reads, 1.0),
              expected, "arm", {.places = {{"arm", -0.5}}});
  // One that keeps its direction is a force on the height of its point.
  expect_same(with("[[force]]\nname = \"lift\"\nat = \"arm.tip\"\ndirection = [0, 1]\nsize = 3\n",
                   "sets = \"load.lift\"\nreads = { y = \"arm.tip\" }\n", 1.0),
              with("[[force]]\nat = \"arm.tip\"\nvector = [0, 3]\n", "y = \"arm.tip\"\n", 1.0), "arm",
              {.places = {{"arm", -0.5}}});
}

// A spring's force k (g - g0) is a scaled reading; a damper's force c w too.
TEST(SetNumbers, ForcesAreReadAsMeasures) {
  const std::string elements =
      "[[spring]]\nname = \"S\"\npoints = [\"ground.P\", \"arm.tip\"]\nstiffness = 25\nfree_length = 0.4\n"
      "[[damper]]\nname = \"D\"\nbodies = [\"ground\", \"arm\"]\ncoefficient = 0.8\n";
  const auto with = [&](const std::string& reads, double factor, double reference) {
    return arm(elements + "[[controller]]\nname = \"C\"\nbodies = [\"ground\", \"arm\"]\nreads = { " + reads +
               fmt::format("\nreference = {}\nproportional = {}\nintegral = {}\nmax = 2\n", reference, 0.3 * factor,
                           0.5 * factor));
  };
  expect_same(with("force = \"S\" }", 1.0, 2.0), with("points = [\"ground.P\", \"arm.tip\"] }", 25.0, 0.4 + 2.0 / 25),
              "arm", {.places = {{"arm", 0.2}}});
  expect_same(with("force = \"D\" }", 1.0, 0.1),
              with("bodies = [\"ground\", \"arm\"] }\nreads_rate = true", 0.8, 0.125), "arm",
              {.places = {{"arm", 0.2}}});
}

/// A spring of which one controller holds the force by its free length, another one brakes by a damper, and a force
/// that a third sets.
const std::string& all_together() {
  static const std::string text = arm(R"(
[[spring]]
name = "S"
points = ["ground.P", "arm.tip"]
stiffness = 25
free_length = 0.4
[[damper]]
name = "D"
bodies = ["ground", "arm"]
coefficient = 0.8
[[force]]
name = "thrust"
at = "arm.tip"
direction = [0.6, 0.8]
size = 1
follows = "arm"
[[controller]]
name = "tension"
sets = "spring.S.free_length"
reads = { force = "S" }
reference = 3
integral = -0.05
[[controller]]
name = "brake"
sets = "damper.D.coefficient"
reads = { points = ["ground.P", "arm.tip"] }
reference = 0.9
proportional = -1.5
min = -0.7
[[controller]]
name = "thrust"
sets = "load.thrust"
reads = { force = "D" }
reference = 0.5
proportional = 0.4
integral = 0.3
)");
  return text;
}

TEST(SetNumbers, DerivativesAreThoseOfMotions) {
  const Scene scene = parse_scene(all_together(), "set.toml");
  const MotionState start = test::released(MotionModel(scene), {.places = {{"arm", 0.3}}, .rates = {{"arm", 0.5}}});
  test::expect_derivatives(
      scene, start,
      {"spring.S.stiffness", "spring.S.free_length", "damper.D.coefficient", "load.thrust",
       "controller.tension.integral", "controller.tension.reference", "controller.brake.proportional",
       "controller.thrust.proportional", "controller.thrust.integral"},
      {"arm"}, 1.5);
}

// Newton's laws of each body, with forces from places and rates of bodies, and the equations of motion, which know
// phasors alone, agree on what controllers set.
TEST(SetNumbers, BodiesBalance) {
  const Scene scene = parse_scene(all_together(), "set.toml");
  const MotionModel model(scene);
  const Motion motion =
      test::moved(model, test::released(model, {.places = {{"arm", 0.3}}, .rates = {{"arm", 0.5}}}), 2.0, 1e-12);
  EXPECT_LT(motion.energy_error, 1e-10);
  QuantitiesAlong along(scene, model, motion);
  const auto at = [&](const std::string& name, double t) {
    return along.value(find_quantity(scene, name, AskedOf::motion), t);
  };
  const std::vector<double> instants{0.4, 1.1, 2.0};
  const std::vector<test::Reading> read = test::read_at(motion, instants);
  const auto arm = static_cast<std::size_t>(test::coordinate_of(model, "arm"));
  for (std::size_t k = 0; k < instants.size(); ++k) {
    const double t = instants[k], phi = read[k].q[arm], w = read[k].v[arm];
    const double length = std::hypot(0.5 * std::cos(phi) - 0.3, 0.5 * std::sin(phi) - 1.0);
    EXPECT_NEAR(at("force.D", t), (0.8 + std::max(-0.7, -1.5 * (0.9 - length))) * w, 1e-9);
    // Readings are outputs with the other sign: that of a free length takes 25 N/m of the spring.
    EXPECT_NEAR(at("force.S", t), 25 * (length - 0.4 + at("force.tension", t)), 1e-9);
  }
  EXPECT_LT(along.imbalance(), 1e-9);

  ReducedMotion<double> reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  const std::vector<double> q = model.from_si(read[1].q), v = model.from_si(read[1].v);
  reduced.set_inputs(model.scaled_scene(), {});
  reduced.begin(0.0, q.data());
  std::vector<double> z, rates;
  for (const int i : reduced.independent()) {
    z.push_back(q[static_cast<std::size_t>(i)]);
    rates.push_back(v[static_cast<std::size_t>(i)]);
  }
  ASSERT_EQ(reduced.evaluate(0.0, z.data(), rates.data()), ReducedMotion<double>::Status::ok);
  const Forces forces = forces_of(model, q, v, {reduced.a(), reduced.a() + reduced.coordinates()}, {});
  EXPECT_LT(forces.power.error, 1e-9);
  EXPECT_LT(forces.imbalance, 1e-9 * forces.largest_force);
}

// About the place where it rests: m s^2 + c s + k0 + a (r - x) - a x = 0 of a stiffness that follows the place, pulled
// by a force P with (k0 + a (r - x)) x = P.
TEST(SetNumbers, PolesAreThoseOfTheLinearStiffness) {
  const double k0 = 20.0, a = 6.0, r = 0.4, c = 1.2, x = 0.7;
  const double load = (k0 + a * (r - x)) * x;
  const Scene scene = parse_scene(block(fmt::format(R"(
[[spring]]
name = "main"
slide = "x"
stiffness = {}
free_length = 0
[[damper]]
slide = "x"
coefficient = {}
[[force]]
at = "block.c"
vector = [{:.17g}, 0]
[[controller]]
name = "C"
sets = "spring.main.stiffness"
reads = {{ slide = "x" }}
reference = {}
proportional = {}
)",
                                                    k0, c, load, r, a)),
                                  "set.toml");
  const MotionModel model(scene);
  const ControlLoop found = control_loop(model, test::released(model, {.places = {{"x", 0.6}}}).q);
  ASSERT_TRUE(found.known) << found.why;
  EXPECT_NEAR(found.controllers[0].effort, a * (r - x), 1e-10);
  const double k = k0 + a * (r - x) - a * x;
  ASSERT_EQ(found.poles.size(), 2U);
  EXPECT_NEAR(found.poles[0].real(), -c / (2 * mass), 1e-10);
  EXPECT_NEAR(std::abs(found.poles[0].imag()), std::sqrt(k / mass - c * c / (4 * mass * mass)), 1e-10);
  // The mechanism alone keeps the stiffness that is set there, and that is its input.
  EXPECT_NEAR(found.open.a(1, 0), -(k0 + a * (r - x)) / mass, 1e-10);
  EXPECT_NEAR(found.open.b(1, 0), -x / mass, 1e-10);
  EXPECT_EQ(found.closed.inputs, std::vector<std::string>{"C.reference"});
}

// (p + a)(I p^2 + c p) + k p + a (kp + kd p) with a = 0.4 k; the arm follows its reference by a kp over that.
TEST(SetNumbers, AnElasticActuatorHasItsPoles) {
  const Scene scene = read_scene(test::dataset("machines/elastic_actuator.toml"));
  const MotionModel model(scene);
  const ControlLoop found = control_loop(model, test::released(model, {}).q);
  ASSERT_TRUE(found.known) << found.why;
  EXPECT_EQ(found.stability, ControlLoop::Stability::stable);
  ASSERT_EQ(found.poles.size(), 3U);
  const auto characteristic = [](const std::complex<double>& p) {
    return (p + 60.0) * (0.2 * p * p + 0.1 * p) + 150.0 * p + 60.0 * (20.0 + 2.0 * p);
  };
  for (const std::complex<double>& p : found.poles) EXPECT_LT(std::abs(characteristic(p)), 1e-8);
  const FrequencyResponse response(model, found, excitation_of(scene, "controller.place.reference"),
                                   find_quantity(scene, "angle.arm", AskedOf::motion));
  for (const double f : {0.01, 0.5, 2.0, 7.0, 40.0}) {
    EXPECT_LT(std::abs(response.at(f) * characteristic({0.0, 2 * M_PI * f}) / 1200.0 - 1.0), 1e-10) << f;
  }
  // What is set is not told.
  const std::string said = test::message_of([&] {
    FrequencyResponse(model, found, excitation_of(scene, "controller.place.reference"),
                      find_quantity(scene, "force.series", AskedOf::motion));
  });
  EXPECT_NE(said.find("controller \"torque\" sets a number of it"), std::string::npos) << said;
}

// The paths in a part are those of its own items; mirrored it moves the other way.
TEST(SetNumbers, PartsSetTheirOwnNumbers) {
  const app_tests::TempFolder folder;
  const std::string springs = all_together().substr(0, all_together().rfind("[[controller]]"));
  const auto as_part = [&](const std::string& text, const std::string& more) {
    folder.write("part.toml", text);
    const MotionModel model(
        parse_scene("gravity = [0, -9.81]\n[[part]]\nname = \"P\"\nfile = \"part.toml\"\nat = [1, 2]\n" + more,
                    folder.path("whole.toml")));
    const double start = more.empty() ? 0.3 : M_PI - 0.3;
    const Motion motion = test::moved(model, test::released(model, {.places = {{"P.arm", start}}}), 2.0, 1e-12);
    return test::read_at(motion, {2.0})[0].q[static_cast<std::size_t>(test::coordinate_of(model, "P.arm"))];
  };
  const auto alone = [&](const std::string& text) {
    const MotionModel model(parse_scene(text, "set.toml"));
    const Motion motion = test::moved(model, test::released(model, {.places = {{"arm", 0.3}}}), 2.0, 1e-12);
    return test::read_at(motion, {2.0})[0].q[static_cast<std::size_t>(test::coordinate_of(model, "arm"))];
  };
  EXPECT_NEAR(as_part(all_together(), ""), alone(all_together()), 1e-9);
  EXPECT_NEAR(as_part(springs, "mirror = true\nangle = 3.141592653589793\n"), M_PI - alone(springs), 1e-9);
  EXPECT_NE(test::message_of([&] {
              as_part(all_together(), "mirror = true\n");
            }).find("expected a number of a spring or a damper where the controller is mirrored"),
            std::string::npos);
}

TEST(SetNumbers, BadInputIsNamed) {
  const auto expect = [&](const std::string& tables, const std::string& words) {
    const std::string said = test::message_of([&] { parse_scene(block(tables), "set.toml"); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_NE(said.find("set.toml:"), std::string::npos) << said;
  };
  const std::string spring = "[[spring]]\nname = \"S\"\nslide = \"x\"\nstiffness = 4\nfree_length = 0\n";
  const auto controller = [](const std::string& keys) { return "[[controller]]\nproportional = 1\n" + keys; };
  const std::string reads = "\nreads = { slide = \"x\" }\n";
  expect(controller("sets = \"spring.S.stifness\"" + reads) + spring, "spring.S.stiffness");
  expect(controller("sets = \"spring.S.stiffness\"\n") + spring, "expected the key follows beside it");
  expect(controller("sets = \"body.block.mass\"" + reads), "expected a number of a spring, a damper");
  expect(controller("sets = \"spring.S.stiffness\"\nslide = \"x\"\n") + spring, "expected sets, or a measure");
  expect(controller("name = \"A\"\nsets = \"spring.S.stiffness\"" + reads) +
             controller("name = \"B\"\nsets = \"spring.S.free_length\"" + reads) + spring,
         "found spring.S.stiffness, which \"A\" sets");
  expect(controller("sets = \"spring.S.free_length\"" + reads) + spring + "acts = \"tension\"\n",
         "it acts on one side only");
  expect(controller("sets = \"load.F\"" + reads) + "[[force]]\nname = \"F\"\nat = \"block.c\"\nvector = [1, 0]\n",
         "a load that is given by direction and size");
  expect(controller("slide = \"x\"\nreads = { force = \"T\" }\n") + spring, "they are \"S\"");
  expect(controller("derivative = 1\nslide = \"x\"\nreads = { force = \"S\" }\n") + spring,
         "expected the key filter beside it, because it reads a force");
  expect(controller("name = \"A\"\nsets = \"spring.S.stiffness\"\nreads = { force = \"S\" }\n") + spring,
         "are an algebraic loop");
}

}  // namespace
}  // namespace poise::set_numbers_test
