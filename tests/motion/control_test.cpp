// Controllers in motion and near equilibrium: closed forms, values integrated apart from Poise, published poles.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "motion/control_loop.hpp"
#include "motion/simulate.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::control_test {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;

constexpr double pi = std::numbers::pi;
constexpr double mass = 2.0;

/// A block of 2 kg on rails "x", and another one that nothing pushes, on rails "still", with a controller.
std::string blocks(const std::string& controller, const std::string& units = "") {
  return fmt::format(R"(
{}
[ground.points]
O = [0, 0]
[body.block]
mass = {}
points = {{ c = [0, 0] }}
[body.other]
mass = 1
points = {{ c = [0, 0] }}
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[slide]]
name = "still"
points = ["ground.O", "other.c"]
axis = [1, 0]
[[controller]]
name = "C"
slide = "x"
{}
)",
                     units, mass, controller);
}

/// Place, rate and state of the controller of the block.
struct Course {
  Motion motion;
  int x = 0;
  std::vector<test::Reading> at;

  double place(std::size_t k) const { return at[k].q[static_cast<std::size_t>(x)]; }
  double rate(std::size_t k) const { return at[k].v[static_cast<std::size_t>(x)]; }
};

Course course(const std::string& text, const std::vector<double>& times, const test::Release& release = {}) {
  const MotionModel model(parse_scene(text, "blocks.toml"));
  Course out{
      test::moved(model, test::released(model, release), times.back(), 1e-12), test::coordinate_of(model, "x"), {}};
  out.at = test::read_at(out.motion, times);
  EXPECT_LT(out.motion.energy_error, 1e-10);
  return out;
}

std::vector<double> instants(double duration, int count) {
  std::vector<double> out;
  for (int k = 1; k <= count; ++k) out.push_back(duration * k / count);
  return out;
}

// u = k (1 - exp(-t/T)) behind a step of the reference, so that m x'' = u:
// x = (k/m) (t^2/2 - T t + T^2 (1 - exp(-t/T))).
TEST(Control, AFilterOfFirstOrderAnswersAStepAsItsClosedFormSays) {
  constexpr double k = 3.0, T = 0.4;
  const std::vector<double> times = instants(5.0, 20);
  const Course found = course(blocks(fmt::format("reads = {{ slide = \"still\" }}\nreference = 1\n"
                                                 "transfer = {{ numerator = [{}], denominator = [1, {}] }}",
                                                 k, T)),
                              times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i], left = 1 - std::exp(-t / T);
    EXPECT_NEAR(found.place(i), k / mass * (t * t / 2 - T * t + T * T * left), 1e-11);
    EXPECT_NEAR(found.rate(i), k / mass * (t - T * left), 1e-11);
  }
}

// G = (1 + b p) / (1 + a1 p + a2 p^2) of an error that is constant: u = 1 + A e^(p1 t) + B e^(p2 t).
TEST(Control, ATransferFunctionOfSecondOrderAnswersAStepAsItsClosedFormSays) {
  constexpr double a1 = 0.2, a2 = 0.25, b = 0.6, r = 0.7;
  const Complex root = std::sqrt(Complex(a1 * a1 - 4 * a2)), p1 = (-a1 + root) / (2 * a2), p2 = (-a1 - root) / (2 * a2);
  // With the first derivative b/a2 at the start: A + B = -1, A p1 + B p2 = b/a2.
  const Complex A = (b / a2 + p2) / (p1 - p2), B = -1.0 - A;
  const std::vector<double> times = instants(6.0, 24);
  const Course found = course(blocks(fmt::format("reads = {{ slide = \"still\" }}\nreference = {}\n"
                                                 "transfer = {{ numerator = [1, {}], denominator = [1, {}, {}] }}",
                                                 r, b, a1, a2)),
                              times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i];
    const Complex sum = t + A * (std::exp(p1 * t) - 1.0) / p1 + B * (std::exp(p2 * t) - 1.0) / p2;
    EXPECT_NEAR(found.rate(i), r / mass * sum.real(), 1e-11);
  }
}

// With a limit on both sides and back-calculation, from three motions of linear pieces: by the exponential of their
// matrices and bisection for the instants at which pieces change, in a program of its own.
TEST(Control, PidWithLimitsAndBackCalculationFollowsItsLinearPieces) {
  const std::string pid =
      "proportional = 8\nintegral = 6\nderivative = 3\nmin = -1\nmax = 1.5\ntracking_time = 0.4\nreference = 1";
  const std::vector<double> times{1, 2, 3, 5, 8};
  const Course found = course(blocks(pid), times);
  const double places[] = {0.3749993581362552, 1.1407432350810174, 1.4633529994672605, 0.9293680327354331,
                           0.994484032559482};
  const double rates[] = {0.7498402659093183, 0.5726097643862331, 0.07260976438623312, -0.16895373578318054,
                          -0.10715441316054754};
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(found.place(i), places[i], 1e-12);
    EXPECT_NEAR(found.rate(i), rates[i], 1e-12);
  }
  // Steps end at the instants at which the effort reaches its limits and leaves them.
  for (const double t : {0.9879345324995487, 1.5393478074038685, 3.7882430255497206}) {
    const auto nearest = std::min_element(found.motion.trajectory.t.begin(), found.motion.trajectory.t.end(),
                                          [&](double a, double b) { return std::abs(a - t) < std::abs(b - t); });
    EXPECT_NEAR(*nearest, t, 1e-10);
  }
  // In other units of the scene the block goes the same way, of 1000 mm.
  const Course in_mm = course(blocks("proportional = 0.008\nintegral = 0.006\nderivative = 0.003\nmin = -1\nmax = 1.5\n"
                                     "tracking_time = 0.4\nreference = 1000",
                                     "units = { length = \"mm\" }"),
                              times);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(in_mm.place(i), places[i], 1e-12);
}

// Beyond a dead band of half the width d a block swings as on a spring, with the amplitude a, and crosses it evenly:
// its period is 2 pi/w + 4 d/(a w).
TEST(Control, ADeadBandLetsGo) {
  constexpr double k = 18.0, d = 0.2, a = 0.5;
  const double w = std::sqrt(k / mass), period = 2 * pi / w + 4 * d / (a * w);
  const Course found = course(blocks(fmt::format("proportional = {}\ndead_band = {}", k, d)),
                              {period / 4, period / 2, period, 3 * period}, {.places = {{"x", d + a}}});
  EXPECT_NEAR(found.place(0), 0.0, 1e-11);
  EXPECT_NEAR(found.rate(0), -a * w, 1e-11);
  EXPECT_NEAR(found.place(1), -d - a, 1e-11);
  EXPECT_NEAR(found.place(2), d + a, 1e-11);
  EXPECT_NEAR(found.place(3), d + a, 1e-10);
}

// A speed that is controlled: m v' = kp (r - v) + ki int (r - v) with (kp/m)^2 = 4 ki/m, a double pole at -kp/(2m); the
// reference comes at t = 1. v = r (1 - (1 - s t) exp(-s t)) with s = kp/(2m), the zero of which is at -ki/kp = -s/2.
TEST(Control, ARateFollowsAReferenceThatSteps) {
  constexpr double kp = 4.0, ki = 2.0, s = 1.0;
  const Course found = course(blocks(fmt::format("reads_rate = true\nproportional = {}\nintegral = {}\nreference = 3\n"
                                                 "time = {{ reference = {{ step = {{ at = 1, to = 1 }} }} }}",
                                                 kp, ki)),
                              {0.9, 1.5, 3.0, 6.0});
  EXPECT_EQ(found.rate(0), 0.0);
  for (std::size_t i = 1; i < 4; ++i) {
    const double t = std::vector{0.9, 1.5, 3.0, 6.0}[i] - 1;
    EXPECT_NEAR(found.rate(i), 3 * (1 - (1 - s * t) * std::exp(-s * t)), 1e-11);
  }
}

/// The derivatives of a motion by numbers agree with differences of motions.
void expect_derivatives(const std::string& text, const std::vector<std::string>& paths, double duration) {
  const Scene scene = parse_scene(text, "blocks.toml");
  const MotionModel model(scene);
  const MotionState start = test::released(model, {.places = {{"x", 0.3}}, .rates = {{"x", 0.2}}});
  MotionOptions options{.duration = duration, .accuracy = 1e-12, .sensitivities = true};
  for (const std::string& path : paths) {
    const ParameterRow row = parameter(scene, path);
    Influence influence;
    influence.force = {ForceNumber::Of::element, row.place.item, row.place.number};
    influence.by = row.dimension.per_scale(model.scales());
    options.influences.push_back(influence);
  }
  const Motion motion = simulate(model, start, options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const int x = test::coordinate_of(model, "x");
  TrajectoryReader reader(motion.trajectory, {x});
  reader.at(duration);
  const auto f = static_cast<std::size_t>(motion.freedoms);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const double value = value_at(scene, parameter(scene, paths[p]).place).value();
    const double h = 1e-4 * std::max(std::abs(value), 0.1);
    const auto at = [&](double by) {
      Scene other = scene;
      set_value_at(other, parameter(other, paths[p]).place, value + by);
      const MotionModel changed(other, model.scales());
      return test::read_at(test::moved(changed, start, duration, 1e-13), {duration})[0];
    };
    const test::Reading up = at(h), down = at(-h), far_up = at(2 * h), far_down = at(-2 * h);
    const auto by_differences = [&](auto part) {
      const auto value_of = [&](const test::Reading& reading) { return (reading.*part)[static_cast<std::size_t>(x)]; };
      return (8 * (value_of(up) - value_of(down)) - (value_of(far_up) - value_of(far_down))) / (12 * h);
    };
    EXPECT_NEAR(reader.q_p(0)[2 * f + p], by_differences(&test::Reading::q), 1e-6) << paths[p];
    EXPECT_NEAR(reader.v_p(0)[2 * f + p], by_differences(&test::Reading::v), 1e-6) << paths[p];
  }
}

TEST(Control, DerivativesByNumbersAreThoseOfMotions) {
  expect_derivatives(blocks("proportional = 8\nintegral = 6\nderivative = 3\nfilter = 0.1\nmin = -1\nmax = 1.5\n"
                            "tracking_time = 0.4\nreference = 1\ndead_band = 0.05"),
                     {"controller.C.proportional", "controller.C.integral", "controller.C.derivative",
                      "controller.C.filter", "controller.C.reference", "controller.C.dead_band", "controller.C.min",
                      "controller.C.max", "controller.C.tracking_time"},
                     4.0);
  expect_derivatives(
      blocks("transfer = { numerator = [8, 3, 0.2], denominator = [1, 0.2, 0.05] }\nreference = 1\nmax = 2"),
      {"controller.C.numerator.0", "controller.C.numerator.1", "controller.C.numerator.2", "controller.C.denominator.0",
       "controller.C.denominator.1", "controller.C.denominator.2", "controller.C.max"},
      3.0);
}

TEST(Control, AnUnstableLoopEndsWhereItRunsAway) {
  const MotionModel model(parse_scene(blocks("proportional = -50\nderivative = -30"), "blocks.toml"));
  MotionOptions options{.duration = 1e3};
  const Motion motion = simulate(model, test::released(model, {.places = {{"x", 0.1}}}), options);
  EXPECT_EQ(motion.status, MotionStatus::ran_away);
  EXPECT_NE(motion.why.find("\"x\" is faster than 100000 sizes of the mechanism per second"), std::string::npos)
      << motion.why;
  EXPECT_LT(motion.trajectory.t.back(), 2.0);
}

Scene with_value(Scene scene, const std::string& path, double value) {
  set_value(scene, path, value);
  return scene;
}

ControlLoop loop_of(const Scene& scene) {
  const MotionModel model(scene);
  return control_loop(model, model.from_si(start_motion(model, {}).q));
}

// ../shared/benchmarks.md 4.1: I phi'' + c phi' - G phi = -(kp phi + kd phi' + ki int phi).
TEST(Control, PolesOfAPidOnAnUprightPendulumAreThoseItWasDesignedFor) {
  const Scene scene = read_scene(test::dataset("machines/upright_pendulum_pid.toml"));
  const ControlLoop found = loop_of(scene);
  ASSERT_TRUE(found.known) << found.why;
  EXPECT_EQ(found.stability, ControlLoop::Stability::stable);
  ASSERT_EQ(found.poles.size(), 3U);
  EXPECT_NEAR(std::abs(found.poles[0] - Complex(-3, 0)), 0.0, 1e-9);
  EXPECT_NEAR(std::abs(found.poles[1] - Complex(-4, 3)), 0.0, 1e-9);
  EXPECT_NEAR(std::abs(found.poles[2] - Complex(-4, -3)), 0.0, 1e-9);
  // The mechanism alone falls.
  const double c = 0.1 / 0.25, g = 4.905 / 0.25;
  EXPECT_NEAR(found.open_poles[0].real(), -c / 2 + std::sqrt(c * c / 4 + g), 1e-11);
  // Stable while ki < (c + kd) (kp - G) / I = 134.75.
  EXPECT_EQ(loop_of(with_value(scene, "controller.pid.integral", 134.7)).stability, ControlLoop::Stability::stable);
  EXPECT_EQ(loop_of(with_value(scene, "controller.pid.integral", 134.75)).stability, ControlLoop::Stability::marginal);
  EXPECT_EQ(loop_of(with_value(scene, "controller.pid.integral", 134.8)).stability, ControlLoop::Stability::unstable);
}

// Near the limit of stability motions grow or decay as the poles say.
TEST(Control, MotionsGrowAndDecayAsPolesSay) {
  const Scene scene = read_scene(test::dataset("machines/upright_pendulum_pid.toml"));
  for (const double ki : {120.0, 150.0}) {
    const Scene other = with_value(scene, "controller.pid.integral", ki);
    const ControlLoop found = loop_of(other);
    const MotionModel model(other);
    const Complex pole = found.poles[0];
    ASSERT_GT(pole.imag(), 0.0);
    const double turn = 2 * pi / pole.imag();
    const Motion motion = test::moved(model, test::released(model, {.places = {{"pendulum", 1e-6}}}), 11 * turn, 1e-12);
    const auto i = static_cast<std::size_t>(test::coordinate_of(model, "pendulum"));
    const std::vector<test::Reading> read = test::read_at(motion, {9 * turn, 10 * turn});
    EXPECT_NEAR(read[1].q[i] / read[0].q[i], std::exp(pole.real() * turn), 1e-5);
  }
}

void expect_near(const MatrixXd& found, const MatrixXd& expected, double within) {
  ASSERT_EQ(found.rows(), expected.rows());
  ASSERT_EQ(found.cols(), expected.cols());
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), within) << found;
}

/// The poles of a loop in any order.
void expect_poles(const std::vector<Complex>& found, const std::vector<Complex>& expected, double within) {
  ASSERT_EQ(found.size(), expected.size());
  for (const Complex& one : expected) {
    double nearest = 1.0;
    for (const Complex& other : found) nearest = std::min(nearest, std::abs(one - other));
    EXPECT_LT(nearest, within) << one;
  }
}

// ../shared/benchmarks.md 4.2: Control Tutorials for MATLAB and Simulink, inverted pendulum, x = (cart, cart', phi,
// phi').
TEST(Control, TheCartAndPoleHaveThePublishedMatrices) {
  const Scene scene = read_scene(test::dataset("machines/cart_pole.toml"));
  const ControlLoop found = loop_of(scene);
  ASSERT_TRUE(found.known) << found.why;
  // Angles come before travels in Poise.
  ASSERT_EQ(found.open.states, (std::vector<std::string>{"pole", "d(pole)/dt", "rail", "d(rail)/dt"}));
  MatrixXd a(4, 4), b(4, 1), c(2, 4);
  a << 0, 1, 0, 0, 31.1818182, 0, 0, -0.454545455, 0, 0, 0, 1, 2.67272727, 0, 0, -0.181818182;
  b << 0, 4.54545455, 0, 1.81818182;
  c << 0, 0, 1, 0, 1, 0, 0, 0;
  expect_near(found.open.a, a, 1e-7);
  expect_near(found.open.b.leftCols(1), b, 1e-8);
  expect_near(found.open.b.rightCols(1), b, 1e-8);
  expect_near(found.open.c, c, 1e-14);
  expect_poles(found.open_poles, {0.0, -0.14283164, -5.60409413, 5.56510758}, 1e-7);
  EXPECT_EQ(found.stability, ControlLoop::Stability::stable);
  expect_poles(
      found.poles,
      {{-5.59778342, 0.40698593}, {-5.59778342, -0.40698593}, {-0.84938514, 0.83225575}, {-0.84938514, -0.83225575}},
      1e-6);
  // The closed loop is A - B K, and its inputs are the references, which the gains of the places multiply.
  MatrixXd k(1, 4);
  k << 18.6853959, 3.45943818, -1, -1.65671003;
  expect_near(found.closed.a, a - b * k, 1e-6);
  MatrixXd by_references(4, 2);
  by_references << -b, 18.6853959 * b;
  expect_near(found.closed.b, by_references, 1e-6);
  // These are the gains of Q = diag(5000, 0, 100, 0).
  Scene other = scene;
  set_value(other, "controller.place.proportional", -70.7106781);
  set_value(other, "controller.place.derivative", -37.8344540);
  set_value(other, "controller.pole.proportional", 105.529782);
  set_value(other, "controller.pole.derivative", 20.9238438);
  expect_poles(
      loop_of(other).poles,
      {{-8.49098024, 7.92827769}, {-8.49098024, -7.92827769}, {-4.75916101, 0.83091805}, {-4.75916101, -0.83091805}},
      1e-6);
}

// A pendulum that is held at 30 degrees: the integral has the effort m g l sin, with the linear system there.
TEST(Control, AnIntegralHoldsWhatGravityPulls) {
  Scene scene = read_scene(test::dataset("machines/upright_pendulum_pid.toml"));
  set_value(scene, "controller.pid.reference", pi / 6);
  const ControlLoop found = loop_of(scene);
  ASSERT_TRUE(found.known) << found.why;
  EXPECT_NEAR(found.controllers[0].value, pi / 6, 1e-12);
  EXPECT_NEAR(found.controllers[0].effort, -4.905 * std::sin(pi / 6), 1e-11);
  EXPECT_NEAR(found.closed.a(1, 0), (4.905 * std::cos(pi / 6) - 17.155) / 0.25, 1e-9);
  EXPECT_NEAR(found.closed.a(1, 2), 18.75 / 0.25, 1e-11);
  EXPECT_NEAR(found.closed.a(2, 0), -1.0, 1e-14);
}

// A lag of first order beside a plant 1/(m p^2 + kd p): poles of m T p^3 + (m + kd T) p^2 + kd p + k.
TEST(Control, PolesOfATransferFunctionAreRootsOfTheLoop) {
  const double k = 5.0, T = 0.3, kd = 4.0;
  for (const std::string& denominator : {fmt::format("[1, {}]", T), fmt::format("[1, {}, {}]", T, 0.02)}) {
    const Scene scene = parse_scene(
        blocks(fmt::format("transfer = {{ numerator = [{}], denominator = {} }}\n[[damper]]\nslide = \"x\"\n"
                           "coefficient = {}\n[[damper]]\nslide = \"still\"\ncoefficient = 1\n",
                           k, denominator, kd)),
        "blocks.toml");
    const ControlLoop found = loop_of(scene);
    ASSERT_TRUE(found.known) << found.why;
    const double a2 = denominator.find("0.02") != std::string::npos ? 0.02 : 0.0;
    int zeros = 0;
    for (const Complex& p : found.poles) {
      const Complex other = p * (p + 1.0);  // of the block that only its damper brakes
      const Complex loop = (mass * p * p + kd * p) * (1.0 + T * p + a2 * p * p) + k;
      zeros += std::min(std::abs(other), std::abs(loop)) < 1e-8 ? 1 : 0;
    }
    EXPECT_EQ(zeros, static_cast<int>(found.poles.size()));
    EXPECT_EQ(found.poles.size(), a2 > 0.0 ? 6U : 5U);
  }
}

TEST(Control, BadInputIsNamed) {
  const auto message = [](const std::string& controller) {
    return test::message_of([&] { parse_scene(blocks(controller), "blocks.toml"); });
  };
  const auto expect = [&](const std::string& controller, const std::string& words) {
    const std::string said = message(controller);
    EXPECT_NE(said.find(words), std::string::npos) << said;
    EXPECT_NE(said.find("controller \"C\""), std::string::npos) << said;
  };
  expect("", "expected one of the keys proportional, integral, derivative and transfer");
  expect("proportional = 1\nmin = 2\nmax = 1", "expected min < max");
  expect("proportional = 1\nderivative = 1\nfilter = -0.1", "expected a finite number > 0");
  expect("proportional = 1\nfilter = 0.1", "expected the key derivative beside it");
  expect("integral = 1\ntracking_time = 1", "expected the key min or max beside it");
  expect("proportional = 1\nreads = { slide = \"y\" }", "\"y\"");
  expect("derivative = 1\nreads_rate = true", "expected the key filter beside it, because it reads a rate");
  expect("transfer = { numerator = [1], denominator = [1] }", "expected 2 or 3 coefficients");
  expect("transfer = { numerator = [1, 2, 3], denominator = [1, 2] }", "at most those of the denominator");
  expect("transfer = { numerator = [1], denominator = [1, 0] }", "expected another highest coefficient than 0");
  expect("proportional = 1\ntime = { reference = { step = { at = 1, to = 1 } } }",
         "expected the key reference beside it");
}

}  // namespace
}  // namespace poise::control_test
