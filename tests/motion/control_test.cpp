// Controllers in motion and near equilibrium: closed forms, values integrated apart from Poise, published poles.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "motion/control_loop.hpp"
#include "motion/simulate.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motion_derivatives.hpp"
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

Scene with_value(Scene scene, const std::string& path, double value) {
  set_value(scene, path, value);
  return scene;
}

ControlLoop loop_of(const Scene& scene) {
  const MotionModel model(scene);
  return control_loop(model, model.from_si(start_motion(model, {}).q));
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

/// A linear system x' = A x with a constant 1 as its last state: x at the times k step, by the exponential of its
/// matrix.
std::vector<Eigen::VectorXd> solved(const MatrixXd& a, const Eigen::VectorXd& start, double step, int count) {
  const MatrixXd over = (a * step).exp();
  std::vector<Eigen::VectorXd> out{start};
  for (int k = 0; k < count; ++k) out.emplace_back(over * out.back());
  return out;
}

// A controller of the place gives the rate that one of the rate follows: with x, v, s and 1,
//   m v' = kv (kp (r - x) - v) + ki s,   s' = kp (r - x) - v.
constexpr double place_gain = 3.0, rate_gain = 5.0, rate_integral = 4.0;
std::string cascade(double reference = 0.0) {
  return blocks(
      fmt::format("follows = \"outer\"\nreads_rate = true\nproportional = {}\nintegral = {}\n"
                  "[[controller]]\nname = \"outer\"\nreads = {{ slide = \"x\" }}\nproportional = {}\n"
                  "reference = {}",
                  rate_gain, rate_integral, place_gain, reference));
}

TEST(Control, ACascadeFollowsItsClosedForm) {
  constexpr double r = 0.7;
  MatrixXd a = MatrixXd::Zero(4, 4);
  a.row(0) << 0, 1, 0, 0;
  a.row(1) << -rate_gain * place_gain, -rate_gain, rate_integral, rate_gain * place_gain * r;
  a.row(1) /= mass;
  a.row(2) << -place_gain, -1, 0, place_gain * r;
  const std::vector<double> times = instants(4.0, 16);
  const Course found = course(cascade(r), times);
  const auto exact = solved(a, Eigen::Vector4d(0, 0, 0, 1), 0.25, 16);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_NEAR(found.place(i), exact[i + 1][0], 1e-11);
    EXPECT_NEAR(found.rate(i), exact[i + 1][1], 1e-11);
  }
  // Its poles are the roots of m p^3 + kv p^2 + (kv kp + ki) p + ki kp.
  Scene scene = parse_scene(cascade(r), "blocks.toml");
  const ControlLoop loop = loop_of(scene);
  ASSERT_TRUE(loop.known) << loop.why;
  int zeros = 0;
  for (const Complex& p : loop.poles) {
    const Complex at =
        ((mass * p + rate_gain) * p + rate_gain * place_gain + rate_integral) * p + rate_integral * place_gain;
    zeros += std::abs(at) < 1e-9 ? 1 : 0;
  }
  EXPECT_EQ(zeros, 3);
  // The mechanism alone has no controller: its inputs are the efforts of what acts.
  EXPECT_EQ(loop.open.inputs, (std::vector<std::string>{"C.effort"}));
  EXPECT_LT(loop.open.a.cwiseAbs().maxCoeff(), 1.0 + 1e-14);
  // References act through both.
  EXPECT_EQ(loop.closed.inputs, (std::vector<std::string>{"C.reference", "outer.reference"}));
  EXPECT_NEAR(loop.closed.d(3, 1), place_gain, 1e-12);
  EXPECT_NEAR(loop.closed.d(2, 1), rate_gain * place_gain, 1e-12);
}

// Two integrators in a circle are no algebraic loop: u'' = a b (r - u), so that  u = r (1 - cos w t)  pushes the block:
// x = (r/m) (t^2/2 - (1 - cos w t)/w^2).
TEST(Control, IntegratorsThatReadEachOtherSwing) {
  constexpr double a = 2.0, b = 3.0, r = 0.8;
  const std::string text =
      blocks(fmt::format("follows = \"first\"\nreads = \"nothing\"\nintegral = {}\n[[controller]]\nname = \"first\"\n"
                         "reads = {{ controller = \"C\" }}\nintegral = {}\nreference = {}\n",
                         b, a, r));
  const double w = std::sqrt(a * b);
  const std::vector<double> times = instants(5.0, 10);
  const Course found = course(text, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i];
    EXPECT_NEAR(found.place(i), r / mass * (t * t / 2 - (1 - std::cos(w * t)) / (w * w)), 1e-10);
  }
}

// A filter behind a filter: two of first order in series are one of second order.
TEST(Control, TransferFunctionsInSeriesAreTheirProduct) {
  const std::string product =
      "reads = { slide = \"still\" }\nreference = 0.6\n"
      "transfer = { numerator = [2, 0.8], denominator = [1, 0.7, 0.1] }\n";
  const std::string series =
      "follows = \"lead\"\nreads = \"nothing\"\ntransfer = { numerator = [2], denominator = [1, 0.2] }\n"
      "[[controller]]\nname = \"lead\"\nreads = { slide = \"still\" }\nreference = 0.6\n"
      "transfer = { numerator = [1, 0.4], denominator = [1, 0.5] }\n";
  const std::vector<double> times = instants(4.0, 8);
  const Course one = course(blocks(product), times), two = course(blocks(series), times);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(one.place(i), two.place(i), 1e-11);
}

// The points of a table are those of a spring with the curve T(x) = -F(-x), and of two points a gain.
TEST(Control, ATableActsAsTheSpringWithItsCurve) {
  const std::vector<double> times = instants(6.0, 12);
  const test::Release release{.places = {{"x", 0.9}}};
  const Course table =
      course(blocks("table = { curve = [[-1, -4], [-0.25, -2.5], [0.125, 0], [0.5, 2], [1, 7]] }"), times, release);
  std::string spring = blocks("proportional = 1");
  const std::size_t at = spring.find("[[controller]]");
  spring = spring.substr(0, at) +
           "[[spring]]\nslide = \"x\"\nforce = { curve = [[-1, -7], [-0.5, -2], [-0.125, 0], [0.25, 2.5], [1, 4]] }\n";
  const Course other = course(spring, times, release);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(table.place(i), other.place(i), 1e-10);
  const Course line = course(blocks("table = { curve = [[-1, -8], [1, 8]] }"), times, release),
               gain = course(blocks("proportional = 8"), times, release);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(line.place(i), gain.place(i), 1e-11);
  EXPECT_NEAR(gain.place(0), 0.9 * std::cos(2.0 * times[0]), 1e-11);
}

// Steps end at the points of a table, which the dead band moves outwards.
TEST(Control, StepsEndAtThePointsOfATable) {
  const Course found =
      course(blocks("table = { curve = [[-1, -4], [-0.25, -2.5], [0.125, 0], [1, 7]] }\ndead_band = 0.1"), {3.0},
             {.places = {{"x", 1.4}}});
  const auto& q = found.motion.trajectory;
  for (const double border : {0.35, -0.225}) {
    const auto crossings = static_cast<int>(q.nodes());
    bool is_there = false;
    for (int k = 0; k < crossings; ++k) {
      is_there = is_there ||
                 std::abs(test::q_at(found.motion, static_cast<std::size_t>(k))[static_cast<std::size_t>(found.x)] -
                          border) < 1e-11;
    }
    EXPECT_TRUE(is_there) << border;
  }
}

/// The block under PID samples each T, of the states x, v and the sum s:  u = kp e + ki s - kd v with e = r - x, held;
/// s grows by T e. The exact map from sample to sample, of x, v, s and 1.
MatrixXd map_of_samples(double kp, double ki, double kd, double r, double T) {
  MatrixXd out = MatrixXd::Identity(4, 4);
  Eigen::RowVector4d u(-kp, -kd, ki, kp * r);
  out.row(0) += Eigen::RowVector4d(0, T, 0, 0) + T * T / (2 * mass) * u;
  out.row(1) += T / mass * u;
  out.row(2) += Eigen::RowVector4d(-T, 0, 0, T * r);
  return out;
}

TEST(Control, SamplesAreHeldUntilTheNextOne) {
  constexpr double kp = 4.0, ki = 1.5, kd = 3.0, r = 0.6, T = 0.125;
  const std::string text = blocks(
      fmt::format("proportional = {}\nintegral = {}\nderivative = {}\nreference = {}\nperiod = {}", kp, ki, kd, r, T));
  const std::vector<double> times = instants(4.0, 32);
  const Course found = course(text, times, {.places = {{"x", -0.2}}, .rates = {{"x", 0.3}}});
  const MatrixXd map = map_of_samples(kp, ki, kd, r, T);
  Eigen::VectorXd state = Eigen::Vector4d(-0.2, 0.3, 0, 1);
  for (std::size_t i = 0; i < times.size(); ++i) {
    state = map * state;
    EXPECT_NEAR(found.place(i), state[0], 1e-11);
    EXPECT_NEAR(found.rate(i), state[1], 1e-11);
  }
  // Its poles z are those of the map, and at the stability limit one has the size 1.
  const ControlLoop loop = loop_of(parse_scene(text, "blocks.toml"));
  ASSERT_TRUE(loop.known) << loop.why;
  EXPECT_EQ(loop.period, T);
  EXPECT_EQ(loop.stability, ControlLoop::Stability::marginal);  // the other block stands where it is
  EXPECT_EQ(loop.closed.states, (std::vector<std::string>{"x", "d(x)/dt", "still", "d(still)/dt", "C integral"}));
  const Eigen::VectorXcd exact = MatrixXd(map.topLeftCorner(3, 3)).eigenvalues();
  for (Eigen::Index k = 0; k < 3; ++k) {
    double nearest = 1.0;
    for (const Complex& z : loop.poles) nearest = std::min(nearest, std::abs(z - exact[k]));
    EXPECT_LT(nearest, 1e-10) << exact[k];
  }
  for (const Eigen::Index row : {0, 1, 4}) {
    const Eigen::Index own = row == 4 ? 2 : row;
    EXPECT_NEAR(loop.closed.a(row, 0), map(own, 0), 1e-12);
    EXPECT_NEAR(loop.closed.a(row, 1), map(own, 1), 1e-12);
    EXPECT_NEAR(loop.closed.a(row, 4), map(own, 2), 1e-12);
    EXPECT_NEAR(loop.closed.b(row, 0) * r, map(own, 3), 1e-12);
  }
}

// A lag that samples: x' = (e_k - x)/T_1 with what it read held, u = k x of the sample: exact with exp(-T/T_1). The
// outer controller of a cascade that samples, the inner one at all times, by the exponential of its matrix.
TEST(Control, StatesBetweenSamplesAreThoseOfTheZeroOrderHold) {
  constexpr double k = 3.0, lag = 0.3, T = 0.25, r = 0.5, kv = 4.0;
  const std::string text = blocks(fmt::format(
      "follows = \"outer\"\nreads_rate = true\nproportional = {}\n[[controller]]\nname = \"outer\"\n"
      "reads = {{ slide = \"x\" }}\ntransfer = {{ numerator = [{}], denominator = [1, {}] }}\nreference = {}\n"
      "period = {}\n",
      kv, k, lag, r, T));
  const std::vector<double> times = instants(3.0, 12);
  const Course found = course(text, times);
  // x, v, the state of the lag, and what is held: its output and its input.
  MatrixXd a = MatrixXd::Zero(5, 5);
  a.row(0) << 0, 1, 0, 0, 0;
  a.row(1) << 0, -kv / mass, 0, kv / mass, 0;
  a.row(2) << 0, 0, -1 / lag, 0, 1 / lag;
  const MatrixXd over = (a * T).exp();
  Eigen::VectorXd state = Eigen::VectorXd::Zero(5);
  for (std::size_t i = 0; i < times.size(); ++i) {
    state[3] = k * state[2];
    state[4] = r - state[0];
    state = over * state;
    EXPECT_NEAR(found.place(i), state[0], 1e-11);
    EXPECT_NEAR(found.rate(i), state[1], 1e-11);
  }
  MatrixXd hold = MatrixXd::Identity(5, 3);
  hold.row(3) << 0, 0, k;
  hold.row(4) << -1, 0, 0;
  const Eigen::VectorXcd exact = MatrixXd((over * hold).topRows(3)).eigenvalues();
  const ControlLoop loop = loop_of(parse_scene(text, "blocks.toml"));
  ASSERT_TRUE(loop.known) << loop.why;
  for (Eigen::Index i = 0; i < 3; ++i) {
    double nearest = 1.0;
    for (const Complex& z : loop.poles) nearest = std::min(nearest, std::abs(z - exact[i]));
    EXPECT_LT(nearest, 1e-10) << exact[i];
  }
}

// K. J. Astrom, B. Wittenmark, Computer-Controlled Systems: a double integrator is at rest after two samples.
TEST(Control, ADeadbeatControllerIsThereAfterTwoSamples) {
  const Scene scene = read_scene(test::dataset("machines/deadbeat_table.toml"));
  const MotionModel model(scene);
  const Motion motion =
      test::moved(model, test::released(model, {.places = {{"table", -0.3}}, .rates = {{"table", 2.0}}}), 0.5, 1e-12);
  for (const test::Reading& there : test::read_at(motion, {0.2, 0.27, 0.3, 0.5})) {
    const auto i = static_cast<std::size_t>(test::coordinate_of(model, "table"));
    EXPECT_NEAR(there.q[i], 0.5, 1e-12);
    EXPECT_NEAR(there.v[i], 0.0, 1e-11);
  }
  const ControlLoop loop = loop_of(scene);
  ASSERT_TRUE(loop.known) << loop.why;
  EXPECT_EQ(loop.stability, ControlLoop::Stability::stable);
  // A double pole is known to the root of rounding.
  for (const Complex& z : loop.poles) EXPECT_LT(std::abs(z), 1e-7);
  EXPECT_LT((loop.closed.a * loop.closed.a).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(Control, TheCascadeOfAnAxisHasItsPoles) {
  const Scene scene = read_scene(test::dataset("machines/cascade_axis.toml"));
  const ControlLoop loop = loop_of(scene);
  ASSERT_TRUE(loop.known) << loop.why;
  expect_poles(loop.poles, {-2.0, -6.0, -12.0}, 1e-9);
  // Its outer controller limits the rate: it never becomes more than about that.
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {.places = {{"axis", 0.0}}}), 5.0, 1e-11);
  const auto i = static_cast<std::size_t>(test::coordinate_of(model, "axis"));
  double fastest = 0.0;
  for (std::size_t k = 0; k < motion.trajectory.nodes(); ++k) fastest = std::max(fastest, test::v_at(motion, k)[i]);
  EXPECT_GT(fastest, 0.38);
  EXPECT_LT(fastest, 0.45);
  EXPECT_NEAR(test::read_at(motion, {5.0})[0].q[i], 0.3, 1e-4);
}

void expect_derivatives(const std::string& text, const std::vector<std::string>& paths, double duration) {
  const Scene scene = parse_scene(text, "blocks.toml");
  const MotionState start = test::released(MotionModel(scene), {.places = {{"x", 0.3}}, .rates = {{"x", 0.2}}});
  test::expect_derivatives(scene, start, paths, {"x"}, duration);
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

TEST(Control, DerivativesOfChainsTablesAndSamplesAreThoseOfMotions) {
  expect_derivatives(cascade(0.7),
                     {"controller.C.proportional", "controller.C.integral", "controller.outer.proportional",
                      "controller.outer.reference"},
                     2.0);
  expect_derivatives(blocks("table = { curve = [[-1, -4], [-0.25, -2.5], [0.125, 0.1], [1, 7]] }\ndead_band = 0.05\n"
                            "proportional = 1\nreference = 0.4"),
                     {"controller.C.table.1", "controller.C.table.2", "controller.C.table.3", "controller.C.table.4",
                      "controller.C.dead_band", "controller.C.reference"},
                     3.0);
  expect_derivatives(
      blocks("follows = \"outer\"\nreads_rate = true\nproportional = 4\nintegral = 2\nmax = 3\nperiod = 0.25\n"
             "[[controller]]\nname = \"outer\"\nreads = { slide = \"x\" }\nproportional = 2\nderivative = 0.3\n"
             "filter = 0.2\nreference = 0.9\nperiod = 0.5\ntime = { reference = { step = { at = 1, to = 1.5 } } }"),
      {"controller.C.proportional", "controller.C.integral", "controller.C.max", "controller.outer.proportional",
       "controller.outer.derivative", "controller.outer.filter", "controller.outer.reference"},
      2.1);
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

// An integral comes to rest at the end of its dead band, where rounding alone would decide whether it acts.
TEST(Control, AtTheEndOfADeadBandNoLinearSystemIsKnown) {
  for (const double integral : {12.0, 40.0}) {
    const MotionModel model(
        parse_scene(blocks(fmt::format(
                        "proportional = 5\nintegral = {}\nreference = 1\ndead_band = 0.3\n[[spring]]\nslide = \"x\"\n"
                        "stiffness = 10\nfree_length = 0\n[[spring]]\nslide = \"still\"\nstiffness = 1\n"
                        "free_length = 0",
                        integral)),
                    "blocks.toml"));
    const ControlLoop loop = control_loop(model, test::released(model, {}).q);
    EXPECT_FALSE(loop.known);
    EXPECT_NE(loop.why.find("controller \"C\" is at the end of its dead band"), std::string::npos) << loop.why;
  }
}

// An angle that a slide keeps: nothing of the scene is ignored without a word.
TEST(Control, AControllerThatCanDoNothingIsNamed) {
  const MotionModel model(parse_scene(blocks("proportional = 1\n[[controller]]\nname = \"idle\"\nbodies = "
                                             "[\"ground\", \"block\"]\nproportional = 1"),
                                      "blocks.toml"));
  for (const std::string& said :
       {test::message_of([&] { simulate(model, test::released(model, {}), {.duration = 1.0}); }),
        test::message_of([&] { control_loop(model, test::released(model, {}).q); })}) {
    EXPECT_NE(said.find("controller \"idle\": expected a measure that can change"), std::string::npos) << said;
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
  expect("", "expected one of the keys proportional, integral, derivative, transfer and table");
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
  const auto with_outer = [](const std::string& inner, const std::string& outer) {
    return inner + "\n[[controller]]\nname = \"outer\"\n" + outer;
  };
  expect(with_outer("proportional = 1\nfollows = \"outer\"", "slide = \"x\"\nproportional = 1"),
         "expected a controller that gives what this one reads, in m; \"outer\" gives N");
  expect("proportional = 1\nfollows = \"C\"", "expected another controller, found its own name");
  expect("proportional = 1\nfollows = \"D\"", "expected the name of another controller, found \"D\"");
  expect("proportional = 1\nperiod = 0", "expected a finite number > 0");
  expect("proportional = 1\nreads = \"nothing\"", "expected the key follows beside it");
  expect("table = [[0, 1]]", "expected the table of a curve");
  expect("table = { curve = [[0, 1]] }", "expected two points [error, output] or more");
  const auto expect_of_outer = [&](const std::string& inner, const std::string& outer, const std::string& words) {
    const std::string said = message(with_outer(inner, outer));
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect_of_outer("proportional = 1", "proportional = 1\nreads = { slide = \"still\" }",
                  "expected what it acts on or sets, or a controller with follows = \"outer\"");
  expect_of_outer("proportional = 1\nreads = \"nothing\"\nfollows = \"outer\"",
                  "proportional = 1\nreads = { controller = \"C\" }",
                  "controllers \"C\", \"outer\" are an algebraic loop");
  expect_of_outer("proportional = 1\nreads = \"nothing\"\nfollows = \"outer\"",
                  "derivative = 1\nreads = { controller = \"C\" }",
                  "expected the key filter beside it, because it reads what a controller gives");
}

}  // namespace
}  // namespace poise::control_test
