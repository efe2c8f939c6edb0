// Controllers with delays: polynomials of the method of steps, published margins, an integration apart from Poise.

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "motion/control_loop.hpp"
#include "motion/response.hpp"
#include "motion/simulate.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motion_derivatives.hpp"
#include "tests/support/motions.hpp"

namespace poise::delays_test {
namespace {

using Complex = std::complex<double>;
constexpr double mass = 2.0;

/// A block of 2 kg on rails "x", and one that nothing pushes, on rails "still", with a controller.
std::string blocks(const std::string& controller) {
  return fmt::format(R"(
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
                     mass, controller);
}

struct Course {
  std::vector<test::Reading> at;
  std::size_t x = 0;

  double place(std::size_t k) const { return at[k].q[x]; }
  double rate(std::size_t k) const { return at[k].v[x]; }
};

Course course(const std::string& text, const std::vector<double>& times, const test::Release& release = {}) {
  const MotionModel model(parse_scene(text, "blocks.toml"));
  const Motion motion = test::moved(model, test::released(model, release), times.back(), 1e-11);
  EXPECT_EQ(motion.status, MotionStatus::completed) << motion.why;
  EXPECT_LT(motion.energy_error, 1e-9);
  return {test::read_at(motion, times), static_cast<std::size_t>(test::coordinate_of(model, "x"))};
}

std::vector<double> instants(double duration, int count) {
  std::vector<double> out;
  for (int k = 1; k <= count; ++k) out.push_back(duration * k / count);
  return out;
}

using Polynomial = std::vector<double>;

double value_of(const Polynomial& p, double s) {
  double out = 0.0;
  for (std::size_t k = p.size(); k-- > 0;) out = out * s + p[k];
  return out;
}
Polynomial slope_of(const Polynomial& p) {
  Polynomial out;
  for (std::size_t k = 1; k < p.size(); ++k) out.push_back(static_cast<double>(k) * p[k]);
  return out.empty() ? Polynomial{0.0} : out;
}
Polynomial integral_of(const Polynomial& p, double begin) {
  Polynomial out{begin};
  for (std::size_t k = 0; k < p.size(); ++k) out.push_back(p[k] / static_cast<double>(k + 1));
  return out;
}

// m x'' = -kp x(t - T) - kd x'(t - T) is a polynomial over each delay, from the one before; before the start it is what
// the controller decides there.
TEST(Delays, MotionsAreThePolynomialsOfTheMethodOfSteps) {
  constexpr double x0 = 0.3, v0 = -0.2;
  for (const double delay : {0.25, 0.05}) {
    for (const double kd : {0.0, 1.5}) {
      constexpr double kp = 3.0;
      const std::vector<double> times = instants(2.0, 37);
      const Course found = course(blocks(fmt::format("proportional = {}\nderivative = {}\ndelay = {}", kp, kd, delay)),
                                  times, {.places = {{"x", x0}}, .rates = {{"x", v0}}});
      std::vector<Polynomial> steps;
      double x = x0, v = v0;
      Polynomial push{-(kp * x0 + kd * v0) / mass};
      for (double from = 0.0; from < 2.0; from += delay) {
        const Polynomial rate = integral_of(push, v), place = integral_of(rate, x);
        steps.push_back(place);
        x = value_of(place, delay);
        v = value_of(rate, delay);
        push.assign(place.size(), 0.0);
        for (std::size_t k = 0; k < place.size(); ++k) push[k] -= kp / mass * place[k];
        const Polynomial rates = slope_of(place);
        for (std::size_t k = 0; k < rates.size(); ++k) push[k] -= kd / mass * rates[k];
      }
      for (std::size_t k = 0; k < times.size(); ++k) {
        const auto step = std::min(static_cast<std::size_t>(times[k] / delay), steps.size() - 1);
        const double s = times[k] - static_cast<double>(step) * delay;
        EXPECT_NEAR(found.place(k), value_of(steps[step], s), 1e-10) << delay << " at " << times[k];
        EXPECT_NEAR(found.rate(k), value_of(slope_of(steps[step]), s), 1e-9) << delay << " at " << times[k];
      }
    }
  }
}

// Delays that are short beside all else are as none: x'' = -(kp x + kd x')/m. Rates within steps as short are no
// differences of places, which would be rounding.
TEST(Delays, ShortOnesAreAsNone) {
  const std::string text = blocks("proportional = 8\nderivative = 4\n");
  const std::vector<double> times = {1e-5, 2e-4};
  const test::Release release{.places = {{"x", 0.3}}, .rates = {{"x", 0.1}}};
  const Course none = course(text, times, release), late = course(text + "delay = 1e-7\n", times, release);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_NEAR(late.place(k), none.place(k), 1e-12);
    EXPECT_NEAR(late.rate(k), none.rate(k), 1e-9);
  }
}

// A reference that steps at t1 pushes from t1 + T on.
TEST(Delays, JumpsComeBackAfterTheDelay) {
  constexpr double k = 3.0, t1 = 0.4, T = 0.35;
  const std::vector<double> times = instants(2.0, 20);
  const Course found = course(blocks(fmt::format("reads = {{ slide = \"still\" }}\nproportional = {}\nreference = 1\n"
                                                 "time = {{ reference = {{ step = {{ at = {}, to = 1 }} }} }}\n"
                                                 "delay = {}",
                                                 k, t1, T)),
                              times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double s = std::max(0.0, times[i] - t1 - T);
    EXPECT_NEAR(found.place(i), k / mass * s * s / 2, 1e-11);
    EXPECT_NEAR(found.rate(i), k / mass * s, 1e-11);
  }
}

// What a controller with samples decides acts later: the push is constant from k T + D to (k + 1) T + D.
TEST(Delays, SamplesActAfterADelay) {
  constexpr double kp = 4.0, kd = 3.0, T = 0.125, D = 0.05;
  const std::vector<double> times = instants(2.0, 16);
  const Course found =
      course(blocks(fmt::format("reads = \"nothing\"\nfollows = \"samples\"\nproportional = 1\ndelay = {}\n"
                                "[[controller]]\nname = \"samples\"\nreads = {{ slide = \"x\" }}\nproportional = {}\n"
                                "derivative = {}\nperiod = {}",
                                D, kp, kd, T)),
             times, {.places = {{"x", 0.4}}, .rates = {{"x", 0.1}}});
  double x = 0.4, v = 0.1, held = -(kp * x + kd * v);
  const auto move = [&](double duration) {
    x += duration * (v + duration * held / mass / 2);
    v += duration * held / mass;
  };
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double decided = -(kp * x + kd * v);
    move(D);
    held = decided;
    move(T - D);
    EXPECT_NEAR(found.place(i), x, 1e-11);
    EXPECT_NEAR(found.rate(i), v, 1e-10);
  }
}

ControlLoop loop_of(const Scene& scene) {
  const MotionModel model(scene);
  return control_loop(model, model.from_si(start_motion(model, {}).q));
}
Scene with_value(Scene scene, const std::string& path, double value) {
  set_value(scene, path, value);
  return scene;
}
double distance_of(const ControlLoop& loop, const Complex& pole) {
  double out = 1e300;
  for (const Complex& one : loop.poles) out = std::min(out, std::abs(one - pole));
  return out;
}

// ../shared/benchmarks.md 4.5; the last one is the pendulum of the datasets. Where another block stands where it is two
// poles are zero.
TEST(Delays, MarginsAreThoseOfTheirClosedForms) {
  struct Case {
    std::string text;
    double margin, frequency;
  };
  // x' = -k x(t - T), of the rate.
  const double k = 1.7;
  const std::vector<Case> cases{
      {blocks(fmt::format("reads_rate = true\nproportional = {}\ndelay = 1", k * mass)), M_PI / (2 * k), k},
      {blocks("proportional = 8\nderivative = 4\ndelay = 1"), 0.355559324358, 2.54403929903},
      {"", 0.144523615692, 6.14003243523}};
  for (const Case& one : cases) {
    const bool is_dataset = one.text.empty();
    const Scene scene =
        is_dataset ? read_scene(test::dataset("machines/late_pendulum.toml")) : parse_scene(one.text, "blocks.toml");
    const std::string path = is_dataset ? "controller.hand.delay" : "controller.C.delay";
    const auto at = [&](double delay) { return loop_of(with_value(scene, path, delay)); };
    const ControlLoop there = at(one.margin);
    ASSERT_TRUE(there.known) << there.why;
    EXPECT_LT(distance_of(there, {0.0, one.frequency}), 1e-10 * one.frequency / one.margin);
    // Right of the zeros of the other block nothing is left but the pair, on one side of the margin.
    const auto growing = [](const ControlLoop& loop) {
      EXPECT_TRUE(loop.known) << loop.why;
      return std::count_if(loop.poles.begin(), loop.poles.end(), [](const Complex& p) { return p.real() > 1e-7; });
    };
    EXPECT_EQ(growing(at(one.margin * (1 - 1e-5))), 0);
    EXPECT_EQ(growing(at(one.margin * (1 + 1e-5))), 2);
  }
}

// Poles are roots of  m s^2 + (kp + kd s) exp(-s T) = 0, all that are right of the line: on a grid of starts Newton's
// method finds no other.
TEST(Delays, AllPolesRightOfTheLineAreListed) {
  constexpr double kp = 9.0, kd = 5.0;
  for (const double T : {0.02, 0.3, 2.0}) {
    const ControlLoop loop = loop_of(
        parse_scene(blocks(fmt::format("proportional = {}\nderivative = {}\ndelay = {}", kp, kd, T)), "blocks.toml"));
    ASSERT_TRUE(loop.known) << loop.why;
    const auto left = [&](const Complex& s) { return mass * s * s + (kp + kd * s) * std::exp(-s * T); };
    const auto slope = [&](const Complex& s) { return 2 * mass * s + (kd - T * (kp + kd * s)) * std::exp(-s * T); };
    int own = 0;
    for (const Complex& s : loop.poles) {
      if (std::abs(s) < 1e-6) continue;  // of the other block
      ++own;
      EXPECT_LT(std::abs(left(s)), 1e-10 * (kp + mass * std::norm(s)));
      EXPECT_GT(s.real(), loop.poles_right_of);
    }
    EXPECT_GE(own, 2);
    int found = 0;
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 80; ++j) {
        Complex s(loop.poles_right_of + (i + 0.5) * 0.5 / T, (j + 0.5) * 0.5 / T);
        for (int step = 0; step < 50; ++step) s -= left(s) / slope(s);
        if (!(std::abs(left(s)) < 1e-9 * (kp + mass * std::norm(s)))) continue;
        if (s.real() < loop.poles_right_of + 1e-9) continue;
        ++found;
        EXPECT_LT(distance_of(loop, s), 1e-7 * (1 + std::abs(s))) << T << ": " << s;
      }
    }
    EXPECT_GT(found, 100);
  }
}

TEST(Delays, MotionsDecayAsTheirRightmostPolesSay) {
  const Scene scene =
      with_value(read_scene(test::dataset("machines/late_pendulum.toml")), "controller.hand.delay", 0.14);
  const ControlLoop loop = loop_of(scene);
  ASSERT_TRUE(loop.known) << loop.why;
  EXPECT_EQ(loop.stability, ControlLoop::Stability::stable);
  const Complex pole = loop.poles.front();
  ASSERT_GT(pole.imag(), 0.0);
  const double turn = 2 * M_PI / pole.imag();
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {.places = {{"pendulum", 1e-4}}}), 9 * turn, 1e-12);
  const auto i = static_cast<std::size_t>(test::coordinate_of(model, "pendulum"));
  const std::vector<test::Reading> read = test::read_at(motion, {8 * turn, 9 * turn});
  EXPECT_NEAR(read[1].q[i] / read[0].q[i] / std::exp(pole.real() * turn), 1.0, 1e-5);
}

// A ball that bounces pushes a mass of 1 kg by its rate, late: v(t) = y(t - T) - y(0).
TEST(Delays, ImpactsAreHeardAfterTheDelay) {
  for (const double restitution : {0.7, 0.0}) {
    for (const double delay : {0.03, 0.1, 0.25, 0.6}) {
      const MotionModel model(parse_scene(fmt::format(R"(gravity = [0, -10]
[ground]
points = {{ O = [0, 0] }}
[body.ball]
points = {{ P = [0, 0] }}
mass = 1
[body.pushed]
points = {{ P = [0, 0] }}
mass = 1
[[slide]]
name = "y"
points = ["ground.O", "ball.P"]
axis = [0, 1]
[[slide]]
name = "x"
points = ["ground.O", "pushed.P"]
axis = [1, 0]
[[stop]]
slide = "y"
min = 0
restitution = {}
[[controller]]
slide = "x"
reads = {{ slide = "y" }}
reads_rate = true
proportional = -1
delay = {}
[start]
y = 1.25
)",
                                                      restitution, delay),
                                          "ball.toml"));
      const std::vector<double> times{0.3, 0.55, 0.8, 1.3};
      const Motion motion = test::moved(model, test::released(model, {}), 1.5, 1e-11);
      const std::vector<test::Reading> at = test::read_at(motion, times);
      const auto x = static_cast<std::size_t>(test::coordinate_of(model, "x"));
      const auto height = [&](double t) {
        if (t < 0.0) return 1.25;
        double up = 0.0;
        for (double begin = -0.5; begin <= t; begin += up / 5) {
          up = begin < 0.0 ? 5.0 : up * restitution;
          const double since = t - begin;
          if (since < up / 5 || up == 0.0) return up == 0.0 ? 0.0 : up * since - 5 * since * since;
        }
        return 0.0;
      };
      for (std::size_t k = 0; k < times.size(); ++k) {
        EXPECT_NEAR(at[k].v[x], height(times[k] - delay) - 1.25, 1e-9) << restitution << " " << delay;
      }
    }
  }
}

// m x'' = -k x + u with what was sampled at 0, T, ..., a delay later: circles between the events. Delays that samples
// and old echoes meet are as others.
TEST(Delays, SamplesActAfterAnyDelay) {
  constexpr double k = 8.0, end = 6.1;
  const double w = std::sqrt(k / mass);
  for (const auto& [period, delay] : {std::pair{0.2, 0.15}, {0.1, 0.15}, {0.2, 0.3}, {0.2, 0.4}, {0.2, 0.5}}) {
    const Course found =
        course(blocks(fmt::format("reads = \"nothing\"\nfollows = \"D\"\nproportional = 1\ndelay = {}\n"
                                  "[[controller]]\nname = \"D\"\nreads = {{ slide = \"x\" }}\nproportional = 1\n"
                                  "period = {}\n[[spring]]\nslide = \"x\"\nstiffness = {}\nfree_length = 0",
                                  delay, period, k)),
               {end}, {.places = {{"x", 0.3}}});
    struct Event {
      double time;
      int sample;
      bool acts;
    };
    std::vector<Event> events;
    for (int n = 0; n * period < end; ++n) {
      events.push_back({n * period, n, false});
      if (n * period + delay < end) events.push_back({n * period + delay, n, true});
    }
    events.push_back({end, -1, false});
    std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.time < b.time; });
    double x = 0.3, v = 0.0, t = 0.0, u = -0.3;
    std::vector<double> sampled;
    for (const Event& event : events) {
      const double h = event.time - t, a = x - u / k, turned = a * std::cos(w * h) + v / w * std::sin(w * h);
      v = -a * w * std::sin(w * h) + v * std::cos(w * h);
      x = turned + u / k;
      t = event.time;
      if (event.acts)
        u = sampled[static_cast<std::size_t>(event.sample)];
      else
        sampled.push_back(-x);
    }
    EXPECT_NEAR(found.place(0), x, 1e-8) << period << " " << delay;
    EXPECT_NEAR(found.rate(0), v, 1e-8) << period << " " << delay;
  }
}

// u(t) = r(t) + 0.9 u(t - T) behind a step of r at 0.25: 10 (1 - 0.9^n) over the n-th delay from there.
TEST(Delays, WhatControllersBringBackToEachOtherGoesOn) {
  constexpr double delay = 0.1, step = 0.25, end = 3.0;
  const Course found = course(
      blocks(
          "reads = \"nothing\"\nfollows = \"A\"\nproportional = 1\n[[controller]]\nname = \"A\"\nreads = "
          "\"nothing\"\nfollows = \"B\"\nproportional = 1\nreference = 1\ntime = { reference = { step = { at = 0.25, "
          "from = 0, to = 1 } } }\n[[controller]]\nname = \"B\"\nreads = { controller = \"A\" }\nproportional = "
          "-0.9\ndelay = 0.1"),
      {end}, {.places = {{"x", 0.3}}});
  double x = 0.3, v = 0.0, u = 0.0;
  for (double t = step; t < end; t += delay) {
    u = 1 + 0.9 * u;
    const double h = std::min(delay, end - t);
    x += v * h + u / mass * h * h / 2;
    v += u / mass * h;
  }
  EXPECT_NEAR(found.place(0), x, 1e-8);
  EXPECT_NEAR(found.rate(0), v, 1e-8);
}

/// Compares derivatives of the block's place and rate, by numbers of controllers, with differences of motions.
void expect_derivatives(const std::string& tables, const std::vector<std::string>& paths, double duration) {
  const Scene scene = parse_scene(blocks(tables), "blocks.toml");
  const MotionState start = test::released(MotionModel(scene), {.places = {{"x", 0.3}}, .rates = {{"x", -0.2}}});
  test::expect_derivatives(scene, start, paths, {"x"}, duration);
}

// They are exact by the delay itself, too, with which echoes move: of the start, of a reference that steps, of limits
// that are reached.
TEST(Delays, DerivativesAreThoseOfMotions) {
  expect_derivatives("proportional = 3\nderivative = 1.5\nintegral = 0.7\ndelay = 0.25",
                     {"controller.C.proportional", "controller.C.derivative", "controller.C.integral",
                      "controller.C.reference", "controller.C.delay", "body.block.mass"},
                     1.6);
  expect_derivatives(
      "proportional = 6\nderivative = 2\nfilter = 0.1\nmin = -1.5\nmax = 1.2\ndelay = 0.2\n"
      "reference = 1\ntime = { reference = { step = { at = 0.7, to = 0.4 } } }",
      {"controller.C.proportional", "controller.C.filter", "controller.C.min", "controller.C.max",
       "controller.C.reference", "controller.C.delay"},
      2.3);
  expect_derivatives(
      "reads_rate = true\nproportional = 2\ndelay = 0.1\nfollows = \"D\"\n[[controller]]\nname = \"D\"\n"
      "reads = { slide = \"x\" }\nproportional = 1.5\ndelay = 0.17\nreference = 0.5\n"
      "time = { reference = { step = { at = 0.31, to = 2 } } }",
      {"controller.C.proportional", "controller.D.proportional", "controller.D.reference"}, 1.9);
}

// Two delayed controllers that follow each other begin where both agree, whatever else is in the scene: the solution of
// a = 0.5 (0.3 - b), b = 0.7 (0.1 - a).
TEST(Delays, ACircleBeginsWhereAllAgree) {
  const std::string circle =
      "reads = \"nothing\"\nfollows = \"A\"\nproportional = 1\n"
      "[[controller]]\nname = \"A\"\nreads = { controller = \"B\" }\nreference = 0.3\nproportional = 0.5\ndelay = 0.2\n"
      "[[controller]]\nname = \"B\"\nreads = { controller = \"A\" }\nreference = 0.1\nproportional = 0.7\ndelay = "
      "0.05\n";
  const std::string idle = "[[controller]]\nname = \"idle\"\nslide = \"still\"\nproportional = 0\ndelay = 0.3\n";
  const double a = 0.5 * (0.3 - 0.7 * 0.1) / (1 - 0.35);
  for (const std::string& text : {circle, circle + idle}) {
    const Course found = course(blocks(text), {0.04});
    EXPECT_NEAR(found.rate(0), a / mass * 0.04, 1e-13);
  }
  const MotionModel diverging(parse_scene(blocks("reads = \"nothing\"\nfollows = \"A\"\nproportional = "
                                                 "1\n[[controller]]\nname = \"A\"\nreads = { controller = "
                                                 "\"B\" }\nreference = 0.3\nproportional = 2\ndelay = "
                                                 "0.2\n[[controller]]\nname = \"B\"\nreads = { controller = "
                                                 "\"A\" }\nproportional = 2\ndelay = 0.05"),
                                          "blocks.toml"));
  const Motion motion = simulate(diverging, test::released(diverging, {}), {.duration = 1.0});
  EXPECT_FALSE(motion.completed());
  EXPECT_NE(motion.why.find("do not agree"), std::string::npos) << motion.why;
}

// A delay of two periods moves what a sample brings, however often others come back at that time.
TEST(Delays, DerivativesByADelayOfSeveralPeriods) {
  expect_derivatives(
      "reads = \"nothing\"\nfollows = \"D\"\nproportional = 1\ndelay = 0.2\n[[controller]]\nname = \"D\"\n"
      "reads = { slide = \"x\" }\nproportional = 3\nreference = 0.6\nperiod = 0.1",
      {"controller.C.delay", "controller.D.proportional", "body.block.mass"}, 1.73);
}

// What comes back moves with those of several delays that it has passed: those of controllers side by side, of delays
// of which one is twice the other, of equal ones, and of chains.
TEST(Delays, DerivativesBySeveralDelays) {
  for (const double other : {0.17, 0.1, 0.2}) {
    expect_derivatives(fmt::format("proportional = 3\nderivative = 1\ndelay = 0.2\nreference = 0.4\n"
                                   "time = {{ reference = {{ step = {{ at = 0.31, to = 2 }} }} }}\n[[controller]]\n"
                                   "name = \"D\"\nslide = \"x\"\nproportional = 2\nderivative = 0.7\nreference = 1\n"
                                   "delay = {}\ntime = {{ reference = {{ step = {{ at = 0.6, to = -1 }} }} }}",
                                   other),
                       {"controller.C.delay", "controller.D.delay", "controller.D.proportional"}, 1.93);
  }
  expect_derivatives(
      "reads_rate = true\nproportional = 2\ndelay = 0.1\nfollows = \"D\"\n[[controller]]\nname = \"D\"\n"
      "reads = { slide = \"x\" }\nproportional = 1.5\ndelay = 0.17\nreference = 0.5\n"
      "time = { reference = { step = { at = 0.31, to = 2 } } }",
      {"controller.C.delay", "controller.D.delay"}, 1.87);
  // At 0.5 s the reference of D steps where what stepped at 0.3 s comes back through C and D.
  const std::string said = test::message_of([] {
    expect_derivatives(
        "reads = \"nothing\"\nproportional = 2\ndelay = 0.1\nfollows = \"D\"\nreference = 1\n"
        "time = { reference = { step = { at = 0.3, to = 2 } } }\n[[controller]]\nname = \"D\"\n"
        "reads = { controller = \"C\" }\nproportional = -0.2\ndelay = 0.1\nreference = 0.5\n"
        "time = { reference = { step = { at = 0.5, to = 2 } } }",
        {"controller.C.delay"}, 1.0);
  });
  EXPECT_NE(said.find("where what comes back behind several of them meets"), std::string::npos) << said;
}

// A computer decides at samples and acts later: places at samples satisfy the polynomial of the poles z.
TEST(Delays, PolesOfSamplesThatActLateAreThoseOfTheMotion) {
  const double period = 0.1;
  for (const double delay : {0.03, 0.1, 0.17, 0.2, 0.25}) {
    const std::string text = blocks(
        fmt::format("reads = \"nothing\"\nfollows = \"D\"\nproportional = 0.9\ndelay = {}\n[[controller]]\n"
                    "name = \"D\"\nreads = {{ slide = \"x\" }}\nproportional = 3\nderivative = 4\nintegral = 0.5\n"
                    "period = {}\n[[damper]]\nname = \"R\"\nslide = \"x\"\ncoefficient = 0.7\n",
                    delay, period));
    const ControlLoop loop = loop_of(parse_scene(text, "blocks.toml"));
    ASSERT_TRUE(loop.known) << loop.why;
    // The states are x, its rate and the integral, the two of the other block, and what is on the way.
    ASSERT_EQ(loop.poles.size(), 5 + static_cast<std::size_t>(std::floor(delay / period + 1e-9)) + 1) << delay;
    std::vector<Complex> polynomial{1.0};
    for (const Complex& z : loop.poles) {
      polynomial.emplace_back(0.0);
      for (std::size_t i = polynomial.size() - 1; i > 0; --i) polynomial[i] -= z * polynomial[i - 1];
    }
    const std::size_t degree = polynomial.size() - 1;
    std::vector<double> times;
    for (std::size_t k = 1; k <= degree + 6; ++k) times.push_back(period * static_cast<double>(k));
    const Course found = course(text, times, {.places = {{"x", 0.3}}, .rates = {{"x", -0.4}}});
    for (std::size_t k = 0; k < 6; ++k) {
      Complex sum = 0.0;
      double terms = 0.0;
      for (std::size_t i = 0; i <= degree; ++i) {
        sum += polynomial[degree - i] * found.place(k + i);
        terms += std::abs(polynomial[degree - i] * found.place(k + i));
      }
      EXPECT_LT(std::abs(sum), 1e-9 * terms) << delay << " " << k;
    }
  }
  const std::string late = blocks(
      "proportional = 1\ndelay = 0.1\n[[controller]]\nname = \"D\"\nslide = \"x\"\nproportional = 1\nperiod = 0.1");
  EXPECT_NE(test::message_of([&] { loop_of(parse_scene(late, "blocks.toml")); }).find("of what changes between them"),
            std::string::npos);
}

// What samples decide acts after a delay.
TEST(Delays, DerivativesOfSamplesThatActLateAreThoseOfMotions) {
  expect_derivatives(
      "reads = \"nothing\"\nfollows = \"D\"\nproportional = 1\ndelay = 0.08\n[[controller]]\n"
      "name = \"D\"\nreads = { slide = \"x\" }\nproportional = 3\nderivative = 1.2\nintegral = 1\n"
      "reference = 0.6\nperiod = 0.3",
      {"controller.D.proportional", "controller.D.derivative", "controller.D.integral", "controller.C.delay"}, 1.7);
}

// They are exact in a loop, too, by numbers of springs: a slider crank whose crank a late controller turns.
TEST(Delays, DerivativesOfALoopAreThoseOfMotions) {
  const Scene scene = parse_scene(R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.crank]
mass = 1
inertia = 0.02
center = [0.1, 0]
points = { O = [0, 0], A = [0.2, 0] }
[body.rod]
mass = 1.5
inertia = 0.05
center = [0.3, 0]
points = { A = [0, 0], B = [0.6, 0] }
[body.piston]
mass = 2
points = { B = [0, 0] }
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "rod.A"]
[[pin]]
name = "B"
points = ["rod.B", "piston.B"]
[[slide]]
name = "guide"
points = ["ground.O", "piston.B"]
axis = [1, 0]
[[spring]]
name = "S"
slide = "guide"
stiffness = 40
free_length = 0.7
[[controller]]
name = "C"
bodies = ["ground", "crank"]
reference = 1
proportional = 6
derivative = 0.8
integral = 2
delay = 0.05
[start]
crank = 0.4
)",
                                  "crank.toml");
  test::expect_derivatives(scene, test::released(MotionModel(scene), {}),
                           {"spring.S.stiffness", "spring.S.free_length", "controller.C.proportional",
                            "controller.C.derivative", "controller.C.delay"},
                           {"crank", "guide"}, 0.9);
}

// A pendulum with a PID controller that is limited, late: by a Runge-Kutta method of fourth order, whose steps are a
// part of the delay, with what was decided between steps by cubics.
TEST(Delays, ALimitedPendulumFollowsWhatIsIntegratedApart) {
  const std::string text = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.rod]
mass = 1
center = [0, 0.5]
inertia = 0.05
points = { P = [0, 0] }
[[pin]]
points = ["ground.O", "rod.P"]
[[controller]]
name = "C"
bodies = ["ground", "rod"]
proportional = 12
integral = 4
derivative = 2.5
min = -3
max = 3
delay = 0.04
)";
  const MotionModel model(parse_scene(text, "rod.toml"));
  const Motion motion = test::moved(model, test::released(model, {.places = {{"rod", 0.35}}}), 3.0, 1e-10);
  ASSERT_EQ(motion.status, MotionStatus::completed) << motion.why;
  const auto i = static_cast<std::size_t>(test::coordinate_of(model, "rod"));
  constexpr double inertia = 0.05 + 0.25, weight = 9.81 * 0.5, T = 0.04;
  constexpr int per_delay = 200, steps = 3 * 25 * per_delay;
  constexpr double h = T / per_delay;
  struct State {
    double q, v, s;
  };
  const auto decided = [](const State& y) { return std::clamp(-12 * y.q - 2.5 * y.v + 4 * y.s, -3.0, 3.0); };
  State y{0.35, 0.0, 0.0};
  std::vector<double> u{decided(y)};
  const auto given = [&](int node, bool half) {
    const auto at = [&](int k) { return u[static_cast<std::size_t>(std::max(0, k))]; };
    const int k = node - per_delay;
    if (!half) return at(k);
    return k < 1 ? (at(k) + at(k + 1)) / 2 : (9 * (at(k) + at(k + 1)) - at(k - 1) - at(k + 2)) / 16;
  };
  const auto slope = [&](const State& a, double push) {
    return State{a.v, (weight * std::sin(a.q) + push) / inertia, -a.q};
  };
  const auto moved = [](const State& a, const State& by, double t) {
    return State{a.q + t * by.q, a.v + t * by.v, a.s + t * by.s};
  };
  for (int k = 0; k < steps; ++k) {
    const double half = given(k, true);
    const State k1 = slope(y, given(k, false)), k2 = slope(moved(y, k1, h / 2), half),
                k3 = slope(moved(y, k2, h / 2), half), k4 = slope(moved(y, k3, h), given(k + 1, false));
    const State sum{k1.q + 2 * (k2.q + k3.q) + k4.q, k1.v + 2 * (k2.v + k3.v) + k4.v, k1.s + 2 * (k2.s + k3.s) + k4.s};
    y = moved(y, sum, h / 6);
    u.push_back(decided(y));
    if ((k + 1) % (steps / 6) != 0) continue;
    const std::vector<test::Reading> read = test::read_at(motion, {(k + 1) * h});
    EXPECT_NEAR(read[0].q[i], y.q, 2e-7) << (k + 1) * h;
    EXPECT_NEAR(read[0].v[i], y.v, 2e-6) << (k + 1) * h;
  }
  EXPECT_EQ(*std::min_element(u.begin(), u.end()), -3.0) << "it was limited";
}

// Under a force the block answers by  H = 1/(m s^2 + (kp + kd s + ki/s) exp(-s T)), and where its reference swings by
// (kp + ki/s) exp(-s T) H.
TEST(Delays, ClosedLoopsAnswerAsTheirTransferFunctions) {
  constexpr double kp = 40.0, kd = 12.0, ki = 30.0;
  for (const double T : {0.0, 0.06}) {
    const std::string text =
        blocks(fmt::format("proportional = {}\nderivative = {}\nintegral = {}\n{}\n[[force]]\nname = \"P\"\n"
                           "at = \"block.c\"\nvector = [1, 0]",
                           kp, kd, ki, T > 0.0 ? fmt::format("delay = {}", T) : ""));
    const Scene scene = parse_scene(text, "blocks.toml");
    const MotionModel model(scene);
    const ControlLoop loop = loop_of(scene);
    ASSERT_TRUE(loop.known) << loop.why;
    const FrequencyResponse of_place(model, loop, excitation_of(scene, "load.P"),
                                     find_quantity(scene, "x.block.c", AskedOf::motion));
    const FrequencyResponse of_reference(model, loop, excitation_of(scene, "controller.C.reference"),
                                         find_quantity(scene, "x.block.c", AskedOf::motion));
    const FrequencyResponse of_rate(model, loop, excitation_of(scene, "load.P"),
                                    find_quantity(scene, "d(x.block.c)/dt", AskedOf::motion));
    const auto answer = [&](double f) {
      const Complex s(0.0, 2 * M_PI * f);
      return 1.0 / (mass * s * s + (kp + kd * s + ki / s) * std::exp(-s * T));
    };
    for (const double f : {0.01, 0.3, 0.7, 1.5, 6.0}) {
      EXPECT_LT(std::abs(of_place.at(f) / answer(f) - 1.0), 1e-11) << f;
      const Complex s(0.0, 2 * M_PI * f);
      EXPECT_LT(std::abs(of_rate.at(f) / (s * answer(f)) - 1.0), 1e-11) << f;
      EXPECT_LT(std::abs(of_reference.at(f) / ((kp + ki / s) * std::exp(-s * T) * answer(f)) - 1.0), 1e-11) << f;
    }
    for (const Resonance& one : of_reference.resonances(0.05, 5.0)) {
      const auto size = [&](double f) {
        const Complex s(0.0, 2 * M_PI * f);
        return std::abs((kp + ki / s) * answer(f));
      };
      const double sign = one.kind == Resonance::Kind::peak ? 1.0 : -1.0;
      for (const double aside : {1 - 1e-4, 1 + 1e-4}) {
        EXPECT_GT(sign * (size(one.frequency) - size(aside * one.frequency)), 0.0);
      }
    }
    // At its peak the amplitude falls to both sides.
    const std::vector<Resonance> all = of_place.resonances(0.05, 5.0);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].kind, Resonance::Kind::peak);
    const double peak = std::abs(answer(all[0].frequency));
    for (const double aside : {1 - 1e-4, 1 + 1e-4}) EXPECT_LT(std::abs(answer(aside * all[0].frequency)), peak);
  }
  const Scene sampled =
      parse_scene(blocks("proportional = 1\nderivative = 1\nperiod = 0.1\n[[force]]\nname = \"P\"\nat = \"block.c\"\n"
                         "vector = [1, 0]"),
                  "a");
  const MotionModel model(sampled);
  const std::string said = test::message_of([&] {
    FrequencyResponse(model, loop_of(sampled), excitation_of(sampled, "load.P"),
                      find_quantity(sampled, "x.block.c", AskedOf::motion));
  });
  EXPECT_NE(said.find("controller \"C\".period: frequency responses of samples are not known"), std::string::npos)
      << said;
}

TEST(Delays, WhatIsNotKnownIsRefusedByName) {
  const std::string both =
      test::message_of([] { parse_scene(blocks("proportional = 1\ndelay = 1\nperiod = 1"), "a"); });
  EXPECT_NE(both.find("expected delay or period, found both"), std::string::npos) << both;
  const std::string none = test::message_of([] { parse_scene(blocks("proportional = 1\ndelay = 0"), "a"); });
  EXPECT_NE(none.find("expected a finite number > 0"), std::string::npos) << none;
  const MotionModel model(
      parse_scene(blocks("proportional = 1\ndelay = 0.1\n[[stop]]\nname = \"wall\"\nslide = \"x\"\nmax = 2"), "a"));
  const std::string by =
      test::message_of([&] { simulate(model, test::released(model, {}), {.duration = 1.0, .sensitivities = true}); });
  EXPECT_NE(by.find("controller \"C\".delay: derivatives of a motion with a delay and with stops"), std::string::npos)
      << by;
  // Delayed controllers in a circle are no algebraic loop, but their echoes do not decay.
  const ControlLoop circle = loop_of(
      parse_scene(blocks("proportional = 1\ndelay = 0.1\nfollows = \"D\"\n[[controller]]\nname = \"D\"\nreads = "
                         "\"nothing\"\nfollows = \"C2\"\nproportional = 0.5\ndelay = 0.2\n[[controller]]\nname = "
                         "\"C2\"\nreads = \"nothing\"\nfollows = \"D\"\nproportional = 0.5\ndelay = 0.1"),
                  "a"));
  EXPECT_FALSE(circle.known);
  EXPECT_NE(circle.why.find("follow each other in a circle"), std::string::npos) << circle.why;
}

}  // namespace
}  // namespace poise::delays_test
