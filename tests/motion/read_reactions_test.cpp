// Controllers that read forces in joints and of drives. The force that holds a mechanism changes its momentum, whatever
// moves within it: what an integral of that force gives follows from rates alone.

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/joint_friction.hpp"
#include "model/parameters.hpp"
#include "motion/control_loop.hpp"
#include "motion/quantities_along.hpp"
#include "motion/simulate.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motion_derivatives.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/seed.hpp"

namespace poise::read_reactions_test {
namespace {

constexpr double g = 9.81, m1 = 1.3, m2 = 0.7, l1 = 0.6, l2 = 0.5;

/// Two point masses hang from the pin "hook"; a mass of 2 kg moves for itself along "rail".
std::string pendulums(const std::string& tables, const std::string& friction = "") {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
Q = [3, 0]
[body.upper]
mass = {}
inertia = 0
points = {{ a = [0, 0], b = [0, {}] }}
center = [0, {}]
[body.lower]
mass = {}
inertia = 0
points = {{ b = [0, 0], P = [0, {}] }}
center = [0, {}]
[body.cart]
mass = 2
points = {{ c = [0, 0] }}
[[pin]]
name = "hook"
points = ["ground.O", "upper.a"]
{}[[pin]]
name = "knee"
points = ["upper.b", "lower.b"]
[[slide]]
name = "rail"
points = ["ground.Q", "cart.c"]
axis = [1, 0]
{})",
                     m1, -l1, -l1, m2, -l2, -l2, friction, tables);
}

std::string cell(const std::string& force, const std::string& law, const std::string& on = "slide = \"rail\"") {
  return fmt::format("[[controller]]\nname = \"cell\"\n{}\nreads = {{ {} }}\n{}", on, force, law);
}

const test::Release swung{.places = {{"upper", 0.9}, {"lower", -0.4}}};

Vec2 momentum(const MotionModel& model, const Motion& motion) {
  return m1 * test::end_of(model, motion, "upper.b").velocity + m2 * test::end_of(model, motion, "lower.P").velocity;
}

Scene read(const std::string& text, const std::string& file) { return resisted_by_joints(parse_scene(text, file)); }

double value_at_end(const Scene& scene, const MotionModel& model, const Motion& motion, const std::string& name) {
  QuantitiesAlong along(scene, model, motion);
  return along.value(find_quantity(scene, name, AskedOf::motion), motion.trajectory.t.back());
}

// From rest  u = k (r t - int R),  and  int R = (momentum) - (weight) t.
TEST(ReadReactions, AnIntegralOfTheForceOfAJointIsTheMomentum) {
  const double k = 3.0, r = 0.5;
  for (const bool is_x : {true, false}) {
    for (const std::string on : {"slide = \"rail\"", "bodies = [\"ground\", \"upper\"]"}) {
      for (const std::string friction :
           {"", "friction = { torque = 0.05 }\n", "friction = { coefficient = 0.3, radius = 0.02 }\n"}) {
        const std::string law = fmt::format("reference = {}\nintegral = {}\n", r, k);
        const Scene scene = read(
            pendulums(cell(fmt::format("reaction = \"hook\", along = \"{}\"", is_x ? "x" : "y"), law, on), friction),
            "cell.toml");
        const MotionModel model(scene);
        for (const double t : {0.4, 1.3}) {
          const Motion motion = test::moved(model, test::released(model, swung), t, 1e-12);
          const Vec2 gained = momentum(model, motion);
          const double pushed = is_x ? gained.x : gained.y + (m1 + m2) * g * t;
          EXPECT_NEAR(-value_at_end(scene, model, motion, "force.cell"), k * (r * t - pushed), 1e-8)
              << is_x << on << friction << t;
        }
      }
    }
  }
}

// A drive leads the trolley, and its force gives what moves on it its momentum.
TEST(ReadReactions, AnIntegralOfTheForceOfADriveIsTheMomentum) {
  const std::string trolley = R"([[drive]]
name = "motor"
slide = "x"
rate = 0.5
acceleration = 0.8
)";
  std::string text = pendulums(trolley + cell("force = \"motor\"", "integral = 2\n"));
  const std::string hung = "[[pin]]\nname = \"hook\"\npoints = [\"ground.O\"";
  text.replace(text.find(hung), hung.size(),
               "[body.trolley]\nmass = 1.5\npoints = { c = [0, 0] }\n[[slide]]\nname = \"x\"\npoints = "
               "[\"ground.O\", \"trolley.c\"]\naxis = [1, 0]\n[[pin]]\nname = \"hook\"\npoints = [\"trolley.c\"");
  const Scene scene = read(text, "cell.toml");
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {}), 0.9, 1e-12);
  const double gained = momentum(model, motion).x + 1.5 * test::end_of(model, motion, "trolley.c").velocity.x;
  const double begun = 0.5 * (m1 + m2 + 1.5);
  EXPECT_NEAR(-value_at_end(scene, model, motion, "force.cell"), -2 * (gained - begun), 1e-8);
}

// What is read has the sign of reaction.hook.x, the force on the body of the joint's second point.
TEST(ReadReactions, SamplesAreThoseOfTheForce) {
  const double period = 0.1, kp = 0.4, r = 1.0;
  const Scene scene =
      read(pendulums(cell("reaction = \"hook\", along = \"x\"",
                          fmt::format("reference = {}\nproportional = {}\nperiod = {}\n", r, kp, period))),
           "cell.toml");
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, swung), 1.05, 1e-12);
  QuantitiesAlong along(scene, model, motion);
  const SoughtQuantity hook = find_quantity(scene, "reaction.hook.x", AskedOf::motion);
  const SoughtQuantity effort = find_quantity(scene, "force.cell", AskedOf::motion);
  for (int k = 0; k <= 10; ++k) {
    const double read = along.value(hook, k * period);
    EXPECT_NEAR(-along.value(effort, k * period + 0.03), kp * (r - read), 1e-7) << k;
  }
}

/// A block slides on an arm that swings, with a spring, a damper and friction along the arm.
std::string arm(const std::string& kind, const std::string& law) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
[body.arm]
mass = 1.2
inertia = 0.1
points = {{ a = [0, 0], m = [0.4, 0.1] }}
center = [0.3, 0.05]
[body.block]
mass = 0.8
inertia = 0.02
points = {{ c = [0, 0] }}
center = [0.05, 0.02]
[[pin]]
name = "hook"
points = ["ground.O", "arm.a"]
[[{}]]
name = "rail"
points = ["arm.m", "block.c"]
axis = [0.8, 0.6]
[[spring]]
name = "S"
slide = "rail"
stiffness = 60
free_length = 0.1
[[damper]]
name = "D"
slide = "rail"
coefficient = 1.5
[start]
rail = 0.15
{})",
                     kind, cell("reaction = \"rail\", along = \"y\"", law, "bodies = [\"ground\", \"arm\"]"));
}

// What acts along a slide or a slot is none of its reaction.
TEST(ReadReactions, ASlideIsReadAcrossItsLine) {
  for (const std::string kind : {"slide", "pin_in_slot"}) {
    const Scene scene = read(arm(kind, "integral = 0.8\n"), "arm.toml");
    const MotionModel model(scene);
    const Motion motion = test::moved(model, test::released(model, {.places = {{"arm", 0.3}}}), 1.1, 1e-12);
    const double mean = value_at_end(scene, model, motion, "mean(reaction.rail.y)");
    EXPECT_GT(std::abs(mean), 0.5);
    EXPECT_NEAR(-value_at_end(scene, model, motion, "force.cell"), -0.8 * 1.1 * mean, 1e-8) << kind;
    test::expect_derivatives(scene, test::released(model, {.places = {{"arm", 0.3}}}),
                             {"controller.cell.integral", "spring.S.stiffness", "body.block.mass", "point.arm.m.y"},
                             {"arm", "rail"}, 0.7);
  }
}

TEST(ReadReactions, DerivativesAreThoseOfMotions) {
  const std::vector<std::string> numbers{"controller.cell.reference", "body.lower.center.y", "body.upper.mass",
                                         "torsion_spring.S.stiffness", "pin.hook.friction.coefficient"};
  const std::string spring =
      "[[torsion_spring]]\nname = \"S\"\nbodies = [\"upper\", \"lower\"]\nstiffness = 2\nfree_angle = 0.2\n";
  for (const std::string& law :
       {std::string("reference = 2\nintegral = 1.5\n"),
        std::string("reference = 2\nproportional = 0.1\nperiod = 0.06\n"),
        std::string("reference = 2\ntransfer = { numerator = [0.3], denominator = [1, 0.05] }\n")}) {
    std::vector<std::string> all = numbers;
    if (law.find("integral") != std::string::npos) all.emplace_back("controller.cell.integral");
    if (law.find("proportional") != std::string::npos) all.emplace_back("controller.cell.proportional");
    if (law.find("transfer") != std::string::npos) all.emplace_back("controller.cell.denominator.1");
    const Scene scene =
        read(pendulums(spring + cell("reaction = \"hook\", along = \"x\"", law, "bodies = [\"ground\", \"upper\"]"),
                       "friction = { coefficient = 0.2, radius = 0.05 }\n"),
             "cell.toml");
    SCOPED_TRACE(law);
    test::expect_derivatives(scene, test::released(MotionModel(scene), swung), all, {"upper", "lower"}, 0.8);
  }
}

// With s = sin of small angles, R the force on the pendulum:  R = -m g phi,  M x'' = u - k x - c x' + m g phi,
// l phi'' = -g phi - x'',  u' = k_i (r - R).
TEST(ReadReactions, PolesAreThoseOfTheLinearSystem) {
  const double M = 4.0, m = 2.5, l = 0.8, k = 30.0, c = 6.0, ki = 1.7;
  const Scene scene = read(fmt::format(R"(
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
[body.trolley]
mass = {}
points = {{ c = [0, 0] }}
[body.load]
mass = {}
points = {{ c = [0, 0] }}
center = [0, {}]
[[slide]]
name = "x"
points = ["ground.O", "trolley.c"]
axis = [1, 0]
[[pin]]
name = "hook"
points = ["trolley.c", "load.c"]
[[spring]]
name = "S"
slide = "x"
stiffness = {}
free_length = 0
[[damper]]
name = "D"
slide = "x"
coefficient = {}
[[controller]]
name = "cell"
slide = "x"
reads = {{ reaction = "hook", along = "x" }}
integral = {}
)",
                                       M, m, -l, k, c, ki),
                           "cell.toml");
  const MotionModel model(scene);
  const ControlLoop loop = control_loop(model, test::equilibrium_of(model));
  ASSERT_TRUE(loop.why.empty()) << loop.why;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(5, 5);  // x, x', phi, phi', u
  a(0, 1) = a(2, 3) = 1.0;
  a.row(1) << -k / M, -c / M, m * g / M, 0.0, 1 / M;
  a.row(3) = -a.row(1) / l;
  a(3, 2) -= g / l;
  a(4, 2) = ki * m * g;
  const Eigen::VectorXcd expected = a.eigenvalues();
  ASSERT_EQ(loop.poles.size(), 5U);
  for (const std::complex<double>& pole : loop.poles) {
    double nearest = 1e9;
    for (const std::complex<double>& one : expected) nearest = std::min(nearest, std::abs(pole - one));
    EXPECT_LT(nearest, 1e-8) << pole;
  }
  EXPECT_TRUE(std::none_of(loop.closed.states.begin(), loop.closed.states.end(),
                           [](const std::string& name) { return name.empty() || name == "d()/dt"; }));
  // The force that is read follows from places: R = -m g phi.
  const Eigen::RowVectorXd read = loop.closed.c.row(0);
  for (std::size_t i = 0; i < loop.closed.states.size(); ++i) {
    EXPECT_NEAR(read[static_cast<Eigen::Index>(i)], loop.closed.states[i] == "load" ? -m * g : 0.0, 1e-8)
        << loop.closed.states[i];
  }
}

// Where an integral reaches its limit a step ends at the border and another one just behind it. Accelerations between
// these are rounding: x'' = u - 20 x is continuous, so that samples tell its extremes.
TEST(QuantitiesAlong, NodesNearEachOtherMakeNoExtremes) {
  const Scene scene = parse_scene(R"(
[ground.points]
o = [0, 0]
[body.c]
points = { o = [0, 0] }
mass = 1
[[slide]]
name = "g"
points = ["ground.o", "c.o"]
axis = [1, 0]
[[spring]]
name = "s"
slide = "g"
stiffness = 20
free_length = 0
[[controller]]
name = "A"
slide = "g"
integral = 3
reference = 1
min = -1
max = 2
)",
                                  "limit.toml");
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {}), 4.0);
  QuantitiesAlong along(scene, model, motion);
  const SoughtQuantity acceleration = find_quantity(scene, "d(d(travel.g)/dt)/dt", AskedOf::motion);
  double least = 0.0, greatest = 0.0;
  for (int k = 0; k <= 4000; ++k) {
    const double value = along.value(acceleration, k * 1e-3);
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  const QuantityRange range = along.ranges({acceleration}).front();
  EXPECT_NEAR(range.least.value, least, 1e-4);
  EXPECT_NEAR(range.greatest.value, greatest, 1e-4);
}

TEST(ReadReactions, BadInputIsNamed) {
  const auto said = [](const std::string& force, const std::string& law, const std::string& more = "") {
    return test::message_of([&] { read(pendulums(cell(force, law) + more), "cell.toml"); });
  };
  const auto has = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  has(said("reaction = \"hook\"", "integral = 1\n"), "along");
  has(said("reaction = \"hook\", along = \"z\"", "integral = 1\n"), "expected \"x\" or \"y\"");
  has(said("reaction = \"hok\", along = \"x\"", "integral = 1\n"), "did you mean \"hook\"");
  has(said("reaction = \"hook\", along = \"x\"", "proportional = 1\n"), "give this one a period");
  has(said("reaction = \"hook\", along = \"x\"", "integral = 1\ndead_band = 1\n"), "dead_band");
  has(said("reaction = \"hook\", along = \"x\"", "integral = 1\ndelay = 1\n"), "delay");
  const std::string stop = "[[stop]]\nname = \"wall\"\nslide = \"rail\"\nmax = 1\n";
  const Scene scene = read(pendulums(cell("reaction = \"hook\", along = \"x\"", "integral = 1\n") + stop), "cell.toml");
  const MotionModel model(scene);
  has(test::message_of([&] { test::moved(model, test::released(model, swung), 0.1); }), "an impact makes the force");
  const Scene twice = read(pendulums(cell("reaction = \"hook\", along = \"x\"", "integral = 1\n") +
                                     "[[pin]]\nname = \"again\"\npoints = [\"ground.O\", \"upper.a\"]\n"),
                           "cell.toml");
  const MotionModel redundant(twice);
  has(test::message_of([&] { test::moved(redundant, test::released(redundant, swung), 0.1); }),
      "cell.toml:29: controller \"cell\".reads: the mechanism is statically indeterminate");
}

// Chains of random links from a pin that is read, with springs, dampers and friction within them: the momentum says
// what the integral of the force is.
TEST(ReadReactions, RandomChainsHaveTheirMomentum) {
  std::mt19937_64 random(test::seed(20261130));
  std::uniform_real_distribution<double> one(-1.0, 1.0);
  const int rounds = test::cases(12, 400);
  for (int round = 0; round < rounds; ++round) {
    const int links = 1 + static_cast<int>(random() % 4);
    std::string text = "gravity = [0, -9.81]\n[ground.points]\nO = [0, 0]\nF = [1, 2]\n";
    std::vector<double> mass;
    std::string joints, more;
    test::Release release;
    for (int i = 0; i < links; ++i) {
      mass.push_back(1.0 + 0.8 * one(random));
      text += fmt::format(
          "[body.b{0}]\nmass = {1}\ninertia = {2}\npoints = {{ a = [0, 0], e = [{3}, {4}], c = [{5}, {6}] }}\n"
          "center = [{5}, {6}]\n",
          i, mass.back(), 0.05 + 0.04 * one(random), 0.5 + 0.2 * one(random), 0.2 * one(random), 0.3 * one(random),
          0.3 * one(random));
      joints += fmt::format("[[pin]]\nname = \"p{0}\"\npoints = [\"{1}\", \"b{0}.a\"]\n{2}", i,
                            i == 0 ? std::string("ground.O") : fmt::format("b{}.e", i - 1),
                            random() % 3 == 0 ? "friction = { coefficient = 0.2, radius = 0.03 }\n" : "");
      release.places[fmt::format("b{}", i)] = 2 * one(random);
      if (i > 0 && random() % 2 == 0) {
        more += fmt::format(
            "[[torsion_spring]]\nname = \"s{0}\"\nbodies = [\"b{1}\", \"b{0}\"]\nstiffness = 3\nfree_angle = 0.4\n", i,
            i - 1);
      }
    }
    const bool is_x = random() % 2 == 0;
    const double k = 2 * one(random);
    more += fmt::format(
        "[[controller]]\nname = \"cell\"\nbodies = [\"ground\", \"b0\"]\nreads = {{ reaction = \"p0\", along = \"{}\" "
        "}}\n"
        "integral = {}\n",
        is_x ? "x" : "y", k);
    text += joints;
    text += more;
    const Scene scene = read(text, "chain.toml");
    const MotionModel model(scene);
    const double t = 0.5;
    const Motion motion = test::moved(model, test::released(model, release), t, 1e-11);
    Vec2 gained{};
    double weight = 0.0;
    for (int i = 0; i < links; ++i) {
      gained += mass[static_cast<std::size_t>(i)] * test::end_of(model, motion, fmt::format("b{}.c", i)).velocity;
      weight += g * mass[static_cast<std::size_t>(i)];
    }
    const double expected = -k * (is_x ? gained.x : gained.y + weight * t);
    EXPECT_NEAR(-value_at_end(scene, model, motion, "force.cell"), expected, 1e-7 * (1 + std::abs(expected)))
        << "round " << round << "\n"
        << text;
  }
}

}  // namespace
}  // namespace poise::read_reactions_test
