// Laws that resist motion, and stops that yield: motions against closed forms, and their derivatives against
// differences.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "motion/simulate.hpp"
#include "tests/support/motions.hpp"

namespace poise::resistance_test {
namespace {

/// A block of 2 kg on a straight slide without gravity, with these tables beside it.
Scene block(const std::string& tables) {
  return parse_scene(R"(
    gravity = [0, 0]
    [ground]
    points = { O = [0, 0] }
    [body.block]
    points = { c = [0, 0] }
    mass = 2
    [[slide]]
    name = "guide"
    points = ["ground.O", "block.c"]
    axis = [1, 0]
  )" + tables,
                     "block.toml");
}
constexpr double mass = 2.0;

struct Block {
  MotionModel model;
  Motion motion;

  Block(const std::string& tables, double place, double rate, double duration)
      : model(block(tables)),
        motion(test::moved(model, test::released(model, {{{"guide", place}}, {{"guide", rate}}}), duration, 1e-12)) {}
  double x(double t) const { return test::read_at(motion, {t}).front().q[0]; }
  double v(double t) const { return test::read_at(motion, {t}).front().v[0]; }
};

/// Times at which the formulas of the motion changed: at two nodes in a row.
std::vector<double> events(const Motion& motion) {
  std::vector<double> out;
  const std::vector<double>& t = motion.trajectory.t;
  for (std::size_t k = 1; k + 1 < t.size(); ++k) {
    const bool again = t[k + 1] == t[k] && t[k] > 0.0;
    if (again && (out.empty() || out.back() != t[k])) out.push_back(t[k]);
  }
  return out;
}

TEST(Resistance, DragSlowsByItsClosedForm) {
  // m v' = -d v^2 and m v' = -(c v + d v^2).
  const double v0 = 3.0, d = 0.7, c = 0.4;
  const Block drag("[[damper]]\nslide = \"guide\"\ndrag = 0.7\n", 0.0, v0, 5.0);
  const Block both("[[damper]]\nslide = \"guide\"\ncoefficient = 0.4\ndrag = 0.7\n", 0.0, v0, 5.0);
  for (const double t : {0.5, 2.0, 5.0}) {
    const double grown = 1 + d * v0 * t / mass;
    EXPECT_NEAR(drag.v(t), v0 / grown, 1e-12);
    EXPECT_NEAR(drag.x(t), mass / d * std::log(grown), 1e-12);
    const double left = std::exp(-c * t / mass);
    EXPECT_NEAR(both.v(t), v0 * left / (1 + d * v0 / c * (1 - left)), 1e-12);
  }
}

// Half swings alternate between free and damped ones.
TEST(Resistance, OneWayDampersActOnOneWay) {
  const double k = 8.0, c = 1.0, omega = std::sqrt(k / mass), delta = c / (2 * mass);
  const double damped = std::sqrt(omega * omega - delta * delta);
  const double half = std::numbers::pi / damped, free = std::numbers::pi / omega;
  const double decay = std::exp(-delta * half);
  for (const bool grows : {true, false}) {
    const Block swing(fmt::format("[[spring]]\nslide = \"guide\"\nstiffness = 8\nfree_length = 0\n[[damper]]\nslide = "
                                  "\"guide\"\ncoefficient = 1\nacts = \"{}\"\n",
                                  grows ? "tension" : "compression"),
                      0.5, 0.0, 12.0);
    double t = 0.0, x = 0.5;
    for (int n = 0; n < 6; ++n) {
      const bool acts = (n % 2 == 1) == grows;
      t += acts ? half : free;
      x *= acts ? -decay : -1.0;
      EXPECT_NEAR(swing.x(t), x, 1e-12) << n;
      EXPECT_NEAR(swing.v(t), 0.0, 1e-11) << n;
    }
  }
}

// Between points the force over the rate is a line, so that the rate decays exponentially towards that of the line.
TEST(Resistance, CurvesOfDampersAreThoseOfTheirPoints) {
  const std::string curve = "[[damper]]\nslide = \"guide\"\nforce = {{ curve = {} }}\nscale = 2\n";
  const Block line(fmt::format(fmt::runtime(curve), "[[1, 3], [2, 6]]"), 0.0, -1.5, 3.0);
  for (const double t : {0.3, 3.0}) EXPECT_NEAR(line.v(t), -1.5 * std::exp(-2 * 3 * t / mass), 1e-12);
  // The time follows by quadrature of dt = -m dv / T(v).
  const Scene scene = block(fmt::format(fmt::runtime(curve), "[[-2, -1], [-0.5, -0.6], [0.25, 1], [1, 1.5], [3, 2]]"));
  const MotionModel model(scene);
  const Law& law = scene.elements[0].law;
  for (const double from : {2.8, -1.9}) {
    const double to = from / 10;
    const int parts = 20000;
    double t = 0.0;
    for (int i = 0; i < parts; ++i) {
      const double h = (to - from) / parts, at = from + i * h;
      const auto per_force = [&](double v) { return -mass / force_of_motion(law, 0.0, v).value; };
      t += h / 6 * (per_force(at) + 4 * per_force(at + h / 2) + per_force(at + h));
    }
    const Motion motion = test::moved(model, test::released(model, {{}, {{"guide", from}}}), 1.1 * t, 1e-12);
    EXPECT_NEAR(test::read_at(motion, {t}).front().v[0], to, 1e-12);
  }
}

TEST(Resistance, AdjustableDampersFollowTime) {
  // m v' = -c(t) v with c(t) = 2 (1 + sin(2 pi t) / 2): v = v0 exp(-2/m (t + (1 - cos(2 pi t)) / (4 pi))).
  const Block linear(
      "[[damper]]\nslide = \"guide\"\ncoefficient = 2\ntime = { coefficient = { sine = { amplitude = 0.5, frequency = "
      "1, offset = 1 } } }\n",
      0.0, 3.0, 2.0);
  const double pi = std::numbers::pi;
  for (const double t : {0.3, 1.1, 2.0}) {
    const double lost = 2 / mass * (t + (1 - std::cos(2 * pi * t)) / (4 * pi));
    EXPECT_NEAR(linear.v(t), 3 * std::exp(-lost), 1e-12);
  }
  EXPECT_LT(linear.motion.energy_error, 1e-12);
  // m v' = -d(t) v^2: 1/v = 1/v0 + integral of d / m.
  const Block drag(
      "[[damper]]\nslide = \"guide\"\ndrag = 2\ntime = { drag = { sine = { amplitude = 0.5, frequency = 1, offset = 1 "
      "} "
      "} }\n",
      0.0, 3.0, 2.0);
  for (const double t : {0.3, 1.1, 2.0}) {
    const double grown = 2 / mass * (t + (1 - std::cos(2 * pi * t)) / (4 * pi));
    EXPECT_NEAR(drag.v(t), 1 / (1.0 / 3 + grown), 1e-12);
  }
}

/// A block of 1 kg on a spring of 1 N/m to the ground and on a belt that moves at 0.2 m/s, with this friction.
Scene belt(const std::string& friction) {
  return parse_scene(R"(
    gravity = [0, 0]
    [ground]
    points = { O = [0, 0] }
    [body.belt]
    points = { c = [0, 0] }
    mass = 1
    [body.block]
    points = { c = [0, 0] }
    mass = 1
    [[slide]]
    name = "conveyor"
    points = ["ground.O", "belt.c"]
    axis = [1, 0]
    [[slide]]
    name = "guide"
    points = ["ground.O", "block.c"]
    axis = [1, 0]
    [[spring]]
    slide = "guide"
    stiffness = 1
    free_length = 0
    [[drive]]
    slide = "conveyor"
    rate = 0.2
    [[friction]]
    points = ["belt.c", "block.c"]
    axis = [1, 0]
    width = 0
  )" + friction,
                     "belt.toml");
}

struct Belt {
  MotionModel model;
  Motion motion;
  std::size_t guide;

  Belt(const std::string& friction, double place, double duration)
      : model(belt(friction)),
        motion(test::moved(model, test::released(model, {{{"guide", place}}, {{"guide", 0.2}}}), duration, 1e-13)),
        guide(static_cast<std::size_t>(test::coordinate_of(model, "guide"))) {}
  test::Reading at(double t) const { return test::read_at(motion, {t}).front(); }
  double x(double t) const { return at(t).q[guide]; }
  /// The extreme place between two times, by bisection of the rate.
  double extreme(double from, double to) const {
    const bool rises = at(from).v[guide] > 0;
    for (int k = 0; k < 60; ++k) {
      const double middle = (from + to) / 2;
      ((at(middle).v[guide] > 0) == rises ? from : to) = middle;
    }
    return x(from);
  }
};

TEST(Resistance, StaticFrictionAboveSlidingSticksAndSlips) {
  const Belt run("force = 0.5\nstatic = 1\n", 0.0, 25.0);
  const std::vector<double> t = events(run.motion);
  ASSERT_GE(t.size(), 5U);
  EXPECT_NEAR(t[0], 5.0, 1e-11);
  EXPECT_NEAR(t[1] - t[0], 3.90260540781, 5e-12);
  EXPECT_NEAR(t[2] - t[1], 5.0, 1e-11);
  EXPECT_NEAR(t[2] - t[0], 8.90260540781, 5e-12);
  EXPECT_NEAR(run.x(t[0]), 1.0, 1e-12);
  EXPECT_NEAR(run.x(t[1]), 0.0, 1e-11);
  const double middle = (t[0] + t[1]) / 2;
  EXPECT_NEAR(run.extreme(t[0], middle), 1.03851648071, 5e-12);
  EXPECT_NEAR(run.extreme(middle, t[1]), -0.0385164807135, 5e-13);
  EXPECT_LT(run.motion.energy_error, 1e-11);
}

// R. I. Leine, D. H. van Campen, A. de Kraker, L. van den Steen, "Stick-slip vibrations induced by alternate friction
// models", Nonlinear Dynamics 16, 1998.
TEST(Resistance, FrictionThatFallsWithTheRateSticksAndSlips) {
  const Belt run("force = 0\nstatic = 1\nstribeck = \"hyperbolic\"\nstribeck_rate = 0.3333333333333333\n",
                 -0.5410063539, 33.0);
  const std::vector<double> t = events(run.motion);
  ASSERT_GE(t.size(), 4U);
  EXPECT_NEAR(t[0], 7.7050317694, 1e-9);
  EXPECT_NEAR(t[1] - t[0], 4.2959995255, 5e-11);
  EXPECT_NEAR(t[2] - t[1], 7.7050317694, 5e-10);
  EXPECT_NEAR(t[2] - t[0], 12.0010312948, 1e-9);
  EXPECT_NEAR(run.x(t[0]), 1.0, 1e-11);
  EXPECT_NEAR(run.x(t[1]), -0.5410063539, 5e-11);
  const double middle = (t[0] + t[1]) / 2;
  EXPECT_NEAR(run.extreme(t[0], middle), 1.1339446764, 5e-11);
  // Recomputed by Runge and Kutta's formula in tiny steps.
  EXPECT_NEAR(run.extreme(middle, t[1]), -0.55543269006033, 5e-12);
}

TEST(Resistance, StaticFrictionHoldsWhatComesToRestWithinIt) {
  // It comes to rest at x with 0.5 < k |x| < 1, where friction of 0.5 alone would let it slide back.
  const Block held(
      "[[spring]]\nslide = \"guide\"\nstiffness = 1\nfree_length = 0\n[[friction]]\nslide = \"guide\"\nforce = "
      "0.5\nstatic = 1\nwidth = 0\n",
      1.7, 0.0, 30.0);
  const double turn = std::numbers::pi * std::sqrt(mass);
  EXPECT_NEAR(held.x(turn), 0.5 - 1.2, 1e-12);
  EXPECT_NEAR(held.x(30.0), 0.5 - 1.2, 1e-12);
  const Block slides(
      "[[spring]]\nslide = \"guide\"\nstiffness = 1\nfree_length = 0\n[[friction]]\nslide = "
      "\"guide\"\nforce = 0.5\nstatic = 0.6\nwidth = 0\n",
      1.7, 0.0, 30.0);
  EXPECT_NEAR(slides.x(30.0), 0.5 - 1.2 + 0.4, 1e-11);
}

// D (1 + e) = ln((1 + D) / (1 - e D)) with D = a v, whatever k and n are.
TEST(Resistance, StopsThatYieldThrowBackByTheirRatio) {
  struct Case {
    double d, e;
  };
  for (const auto& [d, e] : {Case{0.1, 0.937475579950},
                             {0.5, 0.748434931597},
                             {1, 0.593624260040},
                             {2, 0.410719686061},
                             {0.0789266052874, 0.95},
                             {1.43275053327, 0.5},
                             {9.99815939750, 0.1}}) {
    for (const double n : {1.0, 1.5, 2.5}) {
      const double v = n == 1.5 ? 1.0 : 2.0;
      const Block thrown(fmt::format("[[stop]]\nslide = \"guide\"\nmax = 0\nstiffness = 1e5\nexponent = {}\ndamping = "
                                     "{:.17g}\n",
                                     n, d / v),
                         -0.05, v, 1.0);
      // Derivatives of the force with the exponent 1.5 have no bound where it begins.
      const double within = n == 1.5 ? 3e-9 * v : 3e-11 * v;
      EXPECT_NEAR(thrown.v(1.0), -e * v, within) << d << ", " << n;
      const Block at_min(fmt::format("[[stop]]\nslide = \"guide\"\nmin = 0\nstiffness = 1e5\nexponent = {}\ndamping = "
                                     "{:.17g}\n",
                                     n, d / v),
                         0.05, -v, 1.0);
      EXPECT_NEAR(at_min.v(1.0), e * v, within) << d << ", " << n;
    }
  }
}

TEST(Resistance, StopsThatYieldAreIndentedByTheirClosedForm) {
  // k dm^(n + 1) / ((n + 1) m) = v/a - ln(1 + a v) / a^2.
  Scene scene = block("[[stop]]\nslide = \"guide\"\nmax = 0\nstiffness = 1e6\nexponent = 1.5\ndamping = 0.5\n");
  scene.bodies[1].mass = 1.0;
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {{{"guide", -0.01}}, {{"guide", 1.0}}}), 0.05, 1e-13);
  double from = 0.01, to = 0.05;
  for (int k = 0; k < 60; ++k) {
    const double middle = (from + to) / 2;
    (test::read_at(motion, {middle}).front().v[0] > 0 ? from : to) = middle;
  }
  EXPECT_NEAR(test::read_at(motion, {from}).front().q[0], 0.00389257377822, 1e-14);
}

// In the scene's units of length the stiffness is the force at the indentation 1.
TEST(Resistance, StopsThatYieldAreReadInUnitsOfTheScene) {
  const auto read = [](const std::string& units, const std::string& max) {
    return parse_scene(units + R"(
    [ground]
    points = { O = [0, 0] }
    [body.block]
    points = { c = [0, 0] }
    mass = 2
    [[slide]]
    name = "guide"
    points = ["ground.O", "block.c"]
    axis = [1, 0]
    [[stop]]
    slide = "guide"
    exponent = 1.5
  )" + max,
                       "block.toml");
  };
  const Scene in_mm = read("units = { length = \"mm\" }", "max = 2\nstiffness = 5\ndamping = 0.001\n");
  const Scene in_m = read("", fmt::format("max = 0.002\nstiffness = {:.17g}\ndamping = 1\n", 5 * std::pow(1e3, 1.5)));
  for (const double g : {0.001, 0.0025, 0.01}) {
    const double a = force_at_rest(in_mm.elements[0].law, g).value, b = force_at_rest(in_m.elements[0].law, g).value;
    EXPECT_NEAR(a, b, 1e-12 * (1 + std::abs(b)));
    EXPECT_NEAR(a, g < 0.002 ? 0.0 : 5 * std::pow(1e3 * g - 2, 1.5), 1e-12 * (1 + std::abs(a)));
    const double w = force_of_motion(in_mm.elements[0].law, g, 0.3).value;
    EXPECT_NEAR(w, 0.3 * a, 1e-12 * (1 + std::abs(a)));
  }
}

TEST(Resistance, GasStrutsDampMoreAtTheEndOfTheirWayOut) {
  // Without preload m v' = -(c + c_e y) v in x, so that  m dv = -(c + c_e y(x)) dx.
  const Scene scene = block(R"(
    [start]
    guide = 0.5
    [[spring]]
    points = ["ground.O", "block.c"]
    gas = { preload = 0, length = 0.9, stroke = 0.5, ratio = 1.3, damping = 3, end_damping = 20, end_stroke = 0.1 }
  )");
  const MotionModel model(scene);
  const Motion motion = test::moved(model, test::released(model, {{{"guide", 0.5}}, {{"guide", 1.0}}}), 0.6, 1e-12);
  const auto rate_at = [](double x) {
    const double before = 1.0 - 3 * (x - 0.5) / mass, in = std::max(0.0, x - 0.8);
    return before - 20 / 0.1 * in * in / (2 * mass);
  };
  for (const double t : {0.1, 0.35, 0.45, 0.6}) {
    const test::Reading now = test::read_at(motion, {t}).front();
    EXPECT_NEAR(now.v[0], rate_at(now.q[0]), 1e-12) << t;
  }
  EXPECT_GT(test::read_at(motion, {0.6}).front().q[0], 0.81) << "it has reached the end";
}

// A spring of one stiffness in tension and another in compression: half swings of both.
TEST(Resistance, StepsEndAtCornersOfSprings) {
  const Block swing(
      "[[spring]]\nslide = \"guide\"\nstiffness = 8\nfree_length = 0.1\nacts = \"tension\"\n[[spring]]\nname = "
      "\"push\"\nslide = \"guide\"\nstiffness = 50\nfree_length = 0.1\nacts = \"compression\"\n",
      0.6, 0.0, 20.0);
  const double slow = std::sqrt(8 / mass), fast = std::sqrt(50 / mass);
  const double period = std::numbers::pi * (1 / slow + 1 / fast);
  for (int n = 1; n * period < 20.0; ++n) EXPECT_NEAR(swing.x(n * period), 0.6, 1e-12) << n;
  EXPECT_LT(swing.motion.energy_error, 1e-13);
}

/// Derivatives by these numbers, and by start values unless something is held there, agree with differences of motions.
void expect_derivatives(const Scene& scene, const test::Release& release, const std::vector<std::string>& paths,
                        const std::vector<double>& times, bool starts = true) {
  const MotionModel model(scene);
  MotionOptions options;
  options.duration = times.back();
  options.sensitivities = true;
  options.accuracy = 1e-12;
  for (const std::string& path : paths) {
    const ParameterRow row = parameter(scene, path);
    Influence influence;
    influence.force = {ForceNumber::Of::element, row.place.item, row.place.number};
    influence.by = row.dimension.per_scale(model.scales());
    options.influences.push_back(influence);
  }
  const MotionState start = test::released(model, release);
  const Motion motion = simulate(model, start, options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  const auto n = static_cast<std::size_t>(motion.trajectory.coordinates);
  std::vector<int> all;
  for (std::size_t i = 0; i < n; ++i) all.push_back(static_cast<int>(i));
  TrajectoryReader reader(motion.trajectory, all);
  const auto expect_column = [&](std::size_t column, double size,
                                 const std::function<std::vector<test::Reading>(double)>& at, const std::string& what) {
    double best = 1.0;
    for (const double step : {1e-3, 1e-4, 1e-5}) {
      const double h = step * size;
      const auto up = at(h), down = at(-h), far_up = at(2 * h), far_down = at(-2 * h);
      double apart = 0.0, largest = 0.0;
      for (std::size_t k = 0; k < times.size(); ++k) {
        reader.at(times[k]);
        for (std::size_t i = 0; i < n; ++i) {
          const auto compare = [&](auto part, double found) {
            const double by =
                (8 * ((up[k].*part)[i] - (down[k].*part)[i]) - ((far_up[k].*part)[i] - (far_down[k].*part)[i])) /
                (12 * h);
            apart = std::max(apart, std::abs(found - by));
            largest = std::max(largest, std::abs(by));
          };
          compare(&test::Reading::q, reader.q_p(static_cast<int>(i))[column]);
          compare(&test::Reading::v, reader.v_p(static_cast<int>(i))[column]);
        }
      }
      best = std::min(best, largest > 0.0 ? apart / largest : apart);
    }
    EXPECT_LT(best, 2e-6) << what;
  };
  const auto f = static_cast<std::size_t>(motion.freedoms);
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const double value = value_at(scene, parameter(scene, paths[p]).place).value();
    expect_column(
        2 * f + p, value == 0.0 ? 1.0 : std::abs(value),
        [&](double by) {
          Scene other = scene;
          set_value_at(other, parameter(other, paths[p]).place, value + by);
          const MotionModel changed(other, model.scales());
          return test::read_at(test::moved(changed, start, times.back(), 1e-13), times);
        },
        paths[p]);
  }
  for (std::size_t k = 0; starts && k < 2 * f; ++k) {
    const int moved = motion.independent[k % f];
    expect_column(
        k, 1.0,
        [&](double by) {
          std::vector<StartValue> wanted;
          for (const int i : motion.independent) {
            wanted.push_back({i, false, start.q[static_cast<std::size_t>(i)]});
            wanted.push_back({i, true, start.v[static_cast<std::size_t>(i)]});
          }
          for (StartValue& one : wanted) {
            if (one.coordinate == moved && one.rate == (k >= f)) one.value += by;
          }
          return test::read_at(test::moved(model, start_motion(model, wanted, &start.q), times.back(), 1e-13), times);
        },
        k < f ? "start" : "start rate");
  }
}

TEST(Resistance, HasExactDerivativesWhereStaticFrictionBreaks) {
  expect_derivatives(belt("force = 0.5\nstatic = 1\nname = \"rub\"\n"), {{{"guide", 0.3}}, {{"guide", 0.2}}},
                     {"friction.rub.force", "friction.rub.static", "spring.spring 1.stiffness"}, {3.0, 4.5, 6.0, 11.0},
                     false);
  expect_derivatives(
      belt("force = 0.2\nstatic = 1\nstribeck_rate = 0.3\nstribeck_exponent = 2\nname = \"rub\"\n"),
      {{{"guide", 0.3}}, {{"guide", 0.25}}},
      {"friction.rub.force", "friction.rub.static", "friction.rub.stribeck_rate", "friction.rub.stribeck_exponent"},
      {3.0, 4.5, 6.0});
}

TEST(Resistance, HasExactDerivativesAcrossBorders) {
  const std::string spring = "[[spring]]\nname = \"s\"\nslide = \"guide\"\nstiffness = 30\nfree_length = 0.1\n";
  expect_derivatives(block(spring + "acts = \"tension\"\n[[stop]]\nname = \"b\"\nslide = \"guide\"\nmin = "
                                    "-0.2\nmax = 0.7\nstiffness = 300\nexponent = 1.5\ndamping = 0.3\n"),
                     {{{"guide", 0.3}}, {{"guide", -1.0}}},
                     {"spring.s.stiffness", "spring.s.free_length", "stop.b.min", "stop.b.stiffness", "stop.b.damping",
                      "stop.b.exponent", "stop.b.max"},
                     {0.2, 0.7, 1.5, 3.0});
  expect_derivatives(block(spring + "[[damper]]\nname = \"d\"\nslide = \"guide\"\ncoefficient = 2\nacts = "
                                    "\"compression\"\n"),
                     {{{"guide", 0.5}}, {}}, {"spring.s.free_length", "damper.d.coefficient"}, {0.3, 1.0, 2.0});
  expect_derivatives(
      block(spring + "[[damper]]\nname = \"d\"\nslide = \"guide\"\nforce = { curve = [[0.2, 1], "
                     "[0.5, 1.2], [1.5, 3]] }\n"),
      {{{"guide", 0.5}}, {}},
      {"spring.s.free_length", "damper.d.scale", "damper.d.force.1", "damper.d.force.2", "damper.d.force.3"},
      {0.3, 1.0, 2.0});
  expect_derivatives(block(spring + "[[damper]]\nname = \"d\"\nslide = \"guide\"\ncoefficient = 0.5\ndrag = 2\ntime = "
                                    "{ drag = { sine = { amplitude = 0.5, frequency = 1, offset = 1 } } }\n"),
                     {{{"guide", 0.5}}, {}}, {"damper.d.coefficient", "damper.d.drag"}, {0.3, 1.0, 2.0});
}

}  // namespace
}  // namespace poise::resistance_test
