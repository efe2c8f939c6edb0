// Small motions of mechanisms on blades about an equilibrium, against closed forms and motions.

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "model/input_error.hpp"
#include "motion/control_loop.hpp"
#include "motion/response.hpp"
#include "motion/simulate.hpp"
#include "statics/quantities/quantity.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::blades_at_rest_test {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Stability = ControlLoop::Stability;

ControlLoop loop_of(const MotionModel& model) { return control_loop(model, model.from_si(start_motion(model, {}).q)); }
ControlLoop loop_of(const std::string& text) {
  const MotionModel model(parse_scene(text, "blades.toml"));
  return loop_of(model);
}

/// Each of these is a pole, in any order.
void expect_poles(std::vector<Complex> found, const std::vector<Complex>& expected, double within) {
  ASSERT_EQ(found.size(), expected.size());
  for (const Complex& one : expected) {
    const auto nearest = std::min_element(found.begin(), found.end(), [&](const Complex& a, const Complex& b) {
      return std::abs(a - one) < std::abs(b - one);
    });
    EXPECT_LT(std::abs(*nearest - one), within) << one;
    found.erase(nearest);
  }
}

std::size_t zeros(const std::vector<Complex>& poles) {
  return static_cast<std::size_t>(std::count(poles.begin(), poles.end(), Complex{}));
}

double entry(const StateSpace& system, const std::string& row, const std::string& column) {
  const auto at = [&](const std::string& name) {
    return std::find(system.states.begin(), system.states.end(), name) - system.states.begin();
  };
  return system.a(at(row), at(column));
}

// The wheel trails by e behind the pivot, the mass by a: m (e - a)^2 + J, with the blade y = e phi.
constexpr double m = 2.0, a = 0.02, J = 0.05, e = 0.1, k = 2e4, c = 0.3;
std::string castor() {
  return fmt::format(R"(
[ground.points]
O = [0, 0]
[body.pivot]
points = {{ K = [0, 0] }}
[body.castor]
points = {{ K = [0, 0], W = [{}, 0] }}
mass = {}
center = [{}, 0]
inertia = {}
[[slide]]
name = "sway"
points = ["ground.O", "pivot.K"]
axis = [0, 1]
[[pin]]
name = "K"
points = ["pivot.K", "castor.K"]
[[blade]]
name = "wheel"
at = "castor.W"
[[spring]]
name = "side"
slide = "sway"
stiffness = {}
free_length = 0
[[torsion_damper]]
name = "pivot"
bodies = ["pivot", "castor"]
coefficient = {}
[[force]]
name = "push"
at = "pivot.K"
vector = [0, 1e-6]
)",
                     -e, m, -a, J, k, c);
}

TEST(BladesAtRest, ACastorSwingsOnItsSpringAsItsClosedFormSays) {
  const ControlLoop loop = loop_of(castor());
  ASSERT_TRUE(loop.known) << loop.why;
  const double inertia = m * (e - a) * (e - a) + J;
  const Complex pole = (-c + std::sqrt(Complex(c * c - 4 * inertia * k * e * e))) / (2 * inertia);
  expect_poles(loop.poles, {0.0, pole, std::conj(pole)}, 1e-10 * std::abs(pole));
  EXPECT_EQ(zeros(loop.poles), 1U);
  EXPECT_EQ(loop.closed.states, (std::vector<std::string>{"castor", "d(castor)/dt", "sway"}));
  EXPECT_NEAR(entry(loop.closed, "sway", "d(castor)/dt"), e, 1e-12);
  EXPECT_NEAR(entry(loop.closed, "d(castor)/dt", "sway"), -k * e / inertia, 1e-9 * k);
  EXPECT_EQ(loop.stability, Stability::stable);
}

// phi = e F/(I s^2 + c s + k e^2), of which 0 Hz is known, because no load excites what the blade leaves at zero.
TEST(BladesAtRest, ACastorAnswersALoadAsItsClosedFormSays) {
  const Scene scene = parse_scene(castor(), "blades.toml");
  const MotionModel model(scene);
  const FrequencyResponse response(model, loop_of(model), excitation_of(scene, "load.push"),
                                   find_quantity(scene, "angle.castor", AskedOf::motion));
  const double inertia = m * (e - a) * (e - a) + J;
  for (const double f : {0.0, 0.5, 8.0, 9.0, 30.0}) {
    const Complex s(0.0, 2 * M_PI * f), exact = e / (inertia * s * s + c * s + k * e * e);
    EXPECT_LT(std::abs(response.at(f) - exact), 1e-10 * std::abs(exact)) << f;
  }
}

/// A sled on a runner across a slope that falls along y by g, with springs, dampers and a rudder.
std::string sled(double g, const std::string& more) {
  return fmt::format(R"(
gravity = [0, {}]
[ground.points]
O = [0, 0]
[body.sled]
points = {{ P = [0, 0] }}
mass = 2
inertia = 0.02
[[blade]]
name = "runner"
at = "sled.P"
[[torsion_spring]]
name = "straight"
bodies = ["ground", "sled"]
stiffness = 0.7
[[torsion_damper]]
name = "turning"
bodies = ["ground", "sled"]
coefficient = 0.2
{}
)",
                     g, more);
}

std::string rudder(const std::string& keys) {
  return "[[controller]]\nname = \"rudder\"\nbodies = [\"ground\", \"sled\"]\nreads = { x = \"sled.P\" }\n" + keys;
}

// The force of the blade, m g, turns with the sled: x'' = g phi.
TEST(BladesAtRest, TheForceOfABladeTurnsWithIt) {
  const ControlLoop loop = loop_of(sled(4.0, ""));
  ASSERT_TRUE(loop.known) << loop.why;
  ASSERT_EQ(loop.blade_force.size(), 1U);
  EXPECT_NEAR(loop.blade_force[0], -8.0, 1e-12);
  EXPECT_NEAR(entry(loop.closed, "d(sled.x)/dt", "sled"), 4.0, 1e-12);
  EXPECT_NEAR(entry(loop.closed, "d(sled.x)/dt", "sled.y"), 0.0, 1e-12);
  EXPECT_NEAR(entry(loop.closed, "sled.y", "d(sled.x)/dt"), 0.0, 1e-12);
  const Complex pole(-5.0, std::sqrt(10.0));
  // The place along the slope has a double pole, which is known to the root of rounding.
  expect_poles(loop.poles, {0.0, 0.0, 0.0, pole, std::conj(pole)}, 1e-7);
  EXPECT_EQ(loop.stability, Stability::marginal);
}

// J s^4 + c s^3 + k s^2 + g (kp + kd s) = 0 and one zero; with an integral s times it, + g ki.
TEST(BladesAtRest, ASteeredSledHasTheRootsOfItsCharacteristicPolynomial) {
  constexpr double g = 4.0, kp = 0.12, kd = 0.25, ki = 0.02;
  const ControlLoop pd = loop_of(sled(g, rudder(fmt::format("proportional = {}\nderivative = {}", kp, kd))));
  ASSERT_TRUE(pd.known) << pd.why;
  expect_poles(pd.poles, {0.0, -1.0, -2.0, -3.0, -4.0}, 1e-11);
  EXPECT_EQ(pd.stability, Stability::stable);
  EXPECT_EQ(zeros(pd.poles), 1U);
  EXPECT_EQ(pd.open.a.rows(), 5);

  const ControlLoop pid =
      loop_of(sled(g, rudder(fmt::format("proportional = {}\nderivative = {}\nintegral = {}", kp, kd, ki))));
  ASSERT_TRUE(pid.known) << pid.why;
  ASSERT_EQ(pid.poles.size(), 6U);
  EXPECT_EQ(zeros(pid.poles), 1U);
  for (const Complex& s : pid.poles) {
    if (s == Complex{}) continue;
    const Complex left = s * s * s * (0.02 * s * s + 0.2 * s + 0.7) + g * (kp * s + kd * s * s + ki);
    EXPECT_LT(std::abs(left), 1e-12);
  }
}

// What a blade keeps, C z, is a pole z = 1 from sample to sample; the others are those of the zero-order hold.
TEST(BladesAtRest, ASledWithSamplesHasThePolesOfTheHold) {
  constexpr double g = 4.0, kp = 0.12, kd = 0.25, T = 0.3;
  const ControlLoop loop =
      loop_of(sled(g, rudder(fmt::format("proportional = {}\nderivative = {}\nperiod = {}", kp, kd, T))));
  ASSERT_TRUE(loop.known) << loop.why;
  MatrixXd rates = MatrixXd::Zero(5, 5);  // phi, phi', x, x', u
  rates(0, 1) = rates(2, 3) = 1.0;
  rates(1, 0) = -0.7 / 0.02;
  rates(1, 1) = -0.2 / 0.02;
  rates(1, 4) = 1 / 0.02;
  rates(3, 0) = g;
  const MatrixXd step = (rates * T).exp();
  MatrixXd decides = MatrixXd::Zero(1, 4);
  decides << 0.0, 0.0, -kp, -kd;
  const MatrixXd map = step.topLeftCorner(4, 4) + step.topRightCorner(4, 1) * decides;
  const Eigen::VectorXcd exact = map.eigenvalues();
  std::vector<Complex> expected(exact.begin(), exact.end());
  expected.emplace_back(1.0);
  expect_poles(loop.poles, expected, 1e-11);
  EXPECT_EQ(loop.stability, Stability::stable);
  EXPECT_EQ(loop.closed.a.rows(), 5);
}

TEST(BladesAtRest, ASledWithADelayHasTheRootsOfItsTranscendentalEquation) {
  constexpr double g = 4.0, kp = 0.12, kd = 0.25, T = 0.05;
  const ControlLoop loop =
      loop_of(sled(g, rudder(fmt::format("proportional = {}\nderivative = {}\ndelay = {}", kp, kd, T))));
  ASSERT_TRUE(loop.known) << loop.why;
  EXPECT_EQ(zeros(loop.poles), 1U);
  ASSERT_GE(loop.poles.size(), 5U);
  for (const Complex& s : loop.poles) {
    if (s == Complex{}) continue;
    const Complex left = s * s * (0.02 * s * s + 0.2 * s + 0.7), late = g * (kp + kd * s) * std::exp(-s * T);
    EXPECT_LT(std::abs(left + late), 1e-9 * (std::abs(left) + std::abs(late)));
  }
  EXPECT_EQ(loop.stability, Stability::stable);
}

// Springs kx and ky at the runner, the mass ahead of it by 0.3: at y = 0.1 the blade holds ky y, which turns with it.
TEST(BladesAtRest, ABodyOnSpringsHasModesAtAllPositionsThatItsBladeHolds) {
  constexpr double kx = 300.0, ky = 50.0, turn = 6.0, ahead = 0.3, y = 0.1, inertia = 0.4 + 2 * ahead * ahead;
  const ControlLoop loop = loop_of(fmt::format(R"(
[ground.points]
O = [0, 0]
[body.plate]
points = {{ P = [0, 0] }}
mass = 2
center = [{}, 0]
inertia = 0.4
[[blade]]
name = "edge"
at = "plate.P"
[[spring]]
name = "along"
x = "plate.P"
stiffness = {}
free_length = 0
[[spring]]
name = "across"
y = "plate.P"
stiffness = {}
free_length = 0
[[torsion_spring]]
name = "turn"
bodies = ["ground", "plate"]
stiffness = {}
[start]
position = {{ plate = [0.2, {}] }}
)",
                                               ahead, kx, ky, turn, y));
  ASSERT_TRUE(loop.known) << loop.why;
  const Complex along(0.0, std::sqrt(kx / 2)), turns(0.0, std::sqrt(turn / inertia));
  expect_poles(loop.poles, {0.0, along, std::conj(along), turns, std::conj(turns)}, 1e-11);
  EXPECT_NEAR(loop.blade_force[0], ky * y, 1e-10);
  EXPECT_NEAR(entry(loop.closed, "d(plate.x)/dt", "plate"), -ky * y / 2, 1e-10);
  EXPECT_NEAR(entry(loop.closed, "d(plate)/dt", "plate.y"), 0.0, 1e-12);
}

// Two bodies on a slope, of which each has a blade, one of them on the other body: from places nearby, across the edges
// too, motions are those of the linear system to second order.
TEST(BladesAtRest, SmallMotionsAreThoseOfTheLinearSystem) {
  const std::string text = R"(
gravity = [1.1, -2.3]
[ground.points]
O = [0, 0]
[body.tractor]
points = { P = [0, 0], H = [-0.4, 0.1] }
mass = 3
center = [0.1, 0.05]
inertia = 0.2
[body.trailer]
points = { H = [0, 0], W = [-0.5, 0.05] }
mass = 1.5
center = [-0.2, 0]
inertia = 0.1
[[pin]]
name = "H"
points = ["tractor.H", "trailer.H"]
[[blade]]
name = "front"
at = "tractor.P"
angle = 0.3
[[blade]]
name = "rear"
at = "trailer.W"
on = "tractor"
angle = 1.2
[[spring]]
name = "rope"
points = ["ground.O", "trailer.W"]
stiffness = 30
free_length = 0.2
[[spring]]
name = "side"
x = "tractor.P"
stiffness = 40
free_length = 0
[[torsion_spring]]
name = "heading"
bodies = ["ground", "tractor"]
stiffness = 25
[[torsion_spring]]
name = "hitch"
bodies = ["tractor", "trailer"]
stiffness = 9
[[damper]]
name = "drag"
y = "trailer.W"
coefficient = 2
[start]
tractor = 0.1
position = { tractor = [0.3, 0.4] }
)";
  const MotionModel model(parse_scene(text, "blades.toml"));
  const ControlLoop loop = loop_of(model);
  ASSERT_TRUE(loop.known) << loop.why;
  EXPECT_EQ(loop.closed.a.rows(), 4 + 2);
  EXPECT_EQ(zeros(loop.poles), 2U);
  EXPECT_GT(std::abs(loop.blade_force[0]), 1.0);
  EXPECT_GT(std::abs(loop.blade_force[1]), 1.0);
  const std::vector<double> q = model.to_si(loop.x);
  for (const double size : {1e-4, 1e-5}) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(loop.closed.a.rows());
    std::vector<double> displaced = q;
    double by = size;
    for (std::size_t i = 0; i < loop.closed.states.size(); ++i) {
      const std::string& name = loop.closed.states[i];
      if (name.starts_with("d(")) continue;
      x[static_cast<Index>(i)] = by;
      for (std::size_t j = 0; j < q.size(); ++j) {
        if (model.layout().coordinates[j].name == name) displaced[j] += by;
      }
      by *= -0.7;
    }
    constexpr double duration = 1.5;
    const Motion motion = test::moved(model, test::released(model, {}, &displaced), duration, 1e-13);
    const test::Reading end = test::read_at(motion, {duration}).front();
    const Eigen::VectorXd then = (loop.closed.a * duration).exp() * x;
    for (std::size_t i = 0; i < loop.closed.states.size(); ++i) {
      for (std::size_t j = 0; j < q.size(); ++j) {
        const std::string& name = model.layout().coordinates[j].name;
        const double linear = then[static_cast<Index>(i)];
        if (loop.closed.states[i] == name) {
          EXPECT_NEAR(end.q[j] - q[j], linear, 20 * size * size) << name;
        } else if (loop.closed.states[i] == "d(" + name + ")/dt") {
          EXPECT_NEAR(end.v[j], linear, 100 * size * size) << name;
        }
      }
    }
  }
}

TEST(BladesAtRest, ABladeThatHoldsTheOnlyFreedomLeavesAZeroAlone) {
  const ControlLoop loop = loop_of(R"(
gravity = [0, -9.81]
[ground.points]
O = [0, 0]
[body.block]
mass = 2
points = { P = [0, 0] }
[[slide]]
name = "rail"
points = ["ground.O", "block.P"]
axis = [0, 1]
[[blade]]
name = "edge"
at = "block.P"
)");
  ASSERT_TRUE(loop.known) << loop.why;
  EXPECT_EQ(loop.poles, (std::vector<Complex>{0.0}));
  EXPECT_NEAR(loop.blade_force[0], 2 * 9.81, 1e-12);
  EXPECT_EQ(loop.closed.states, (std::vector<std::string>{"rail"}));
}

// Nothing holds a sled on a slope whose edge is kept at an angle to it.
TEST(BladesAtRest, AreNotKnownWithoutAnEquilibriumAlongTheEdges) {
  std::string text = sled(4.0, "");
  text.insert(text.find("at = \"sled.P\""), "angle = 0.5\n");
  const ControlLoop loop = loop_of(text);
  EXPECT_FALSE(loop.known);
  EXPECT_NE(loop.why.find("along the edges of its blades"), std::string::npos) << loop.why;
}

TEST(BladesAtRest, RefuseFrictionAndDrivesByName) {
  const std::string rub = "[[friction]]\nname = \"rub\"\nx = \"sled.P\"\nforce = 1\nwidth = 0.1\n";
  EXPECT_EQ(
      test::message_of([&] { loop_of(sled(4.0, rub)); }),
      "blades.toml:20: friction \"rub\": the linear system of a mechanism with blades is not known with it; expected "
      "a scene without it");
  const Scene towed = read_scene(test::dataset("machines/castor.toml"));
  EXPECT_NE(test::message_of([&] { loop_of(MotionModel(towed)); }).find("drive \"towing\": the linear system"),
            std::string::npos);
}

}  // namespace
}  // namespace poise::blades_at_rest_test
