// Functions of time of loads and drives: values, derivatives, reading, and the scene at one time.

#include "model/time_function.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "tests/support/message_of.hpp"

namespace poise::time_function_test {
namespace {

std::string scene_with(const std::string& load_time, const std::string& drive = "") {
  return fmt::format(R"(
[units]
length = "mm"
angle = "deg"
[numbers]
T = 1.3
w = 2.1
[ground.points]
O = [0, 0]
[body.block]
mass = 2
[body.block.points]
c = [0, 0]
[body.wheel]
inertia = 1
[body.wheel.points]
c = [0, 0]
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[pin]]
points = ["ground.O", "wheel.c"]
[[force]]
name = "F"
at = "block.c"
vector = [3, 0]
{}
{}
)",
                     load_time, drive);
}

TimeFunction function_of(const std::string& time) {
  return parse_scene(scene_with("time = " + time), "time.toml").time_functions.at(0);
}

const std::vector<std::string>& all_kinds() {
  static const std::vector<std::string> kinds{
      "{ sine = { amplitude = 1.5, frequency = 0.7, phase = 40, offset = 0.3 } }",
      "{ ramp = { from = -1, to = 2, start = 0.4, end = 1.7 } }",
      "{ ramp = { from = -1, to = 2, start = 0.4, end = 1.7, law = \"polynomial_345\" } }",
      "{ step = { at = 0.9, from = 0.5, to = -2 } }",
      "{ table = [[0.3, 1], [0.8, 2], [1.0, 2.5], [1.9, -1]] }",
      "{ table = [[0.3, 1], [0.8, 2], [1.0, 2.5], [1.9, -1]], interpolation = \"monotone\" }",
      "{ table = [[0.3, 1], [0.8, 2], [1.0, 2.5], [1.9, -1]], interpolation = \"spline\" }",
      "{ ramp = { from = -1, to = 2, start = 0.4, end = 1.7, law = \"cubic\" } }",
      "{ ramp = { from = -1, to = 2, start = 0.4, end = 1.7, law = \"trapezoidal\" } }",
      "{ ramp = { from = -1, to = 2, start = 0.4, end = 1.7, law = \"s_curve\" } }",
      "{ table = [[0.3, 1], [0.8, 2], [1.0, 2.5], [1.9, -1]], interpolation = \"cubic\" }",
      "{ table = [[0.3, 1], [0.8, 2], [1.0, 2.5], [1.9, -1]], interpolation = \"trapezoidal\" }",
      "{ table = [[0.3, 1], [0.8, 2], [1.0, 2.5], [1.9, -1]], interpolation = \"s_curve\" }",
      "{ function = \"0.1*(1 - cos(2*pi*t/T))*exp(-w*t) + sqrt(1 + t)\" }",
      "{ function = \"0.3*atan2(t, 1 + w) + (t + 1)^T\" }",
      "{ sum = [{ function = \"w*t\" }, { sine = { amplitude = 1.5, frequency = 0.7 } }, "
      "{ ramp = { to = 2, start = 0.4, end = 1.7 } }] }",
      "{ product = [{ ramp = { from = 1, to = 2, start = 0.4, end = 1.7 } }, { function = \"cos(w*t)\" }, "
      "{ table = [[0.3, 1], [1.9, -1]] }] }",
      "{ piecewise = [{ until = 0.7, function = \"t^2\" }, { until = 1.6, function = \"0.49 + 1.4*(t - 0.7)\" }, "
      "{ sine = { amplitude = 1.5, frequency = 0.7 } }] }"};
  return kinds;
}

TEST(TimeFunction, HasTheValuesOfItsFormula) {
  const TimeFunction sine = function_of(all_kinds()[0]);
  EXPECT_DOUBLE_EQ(sine.at(0.6), 0.3 + 1.5 * std::sin(2 * std::numbers::pi * 0.7 * 0.6 + 40 * std::numbers::pi / 180));
  const TimeFunction ramp = function_of(all_kinds()[1]);
  EXPECT_EQ(ramp.at(0), -1);
  EXPECT_DOUBLE_EQ(ramp.at(0.4 + 1.3 / 3), 0);
  EXPECT_EQ(ramp.at(5), 2);
  const TimeFunction smooth = function_of(all_kinds()[2]);
  EXPECT_DOUBLE_EQ(smooth.at(0.4 + 1.3 / 2), 0.5);
  EXPECT_DOUBLE_EQ(smooth.at(0.4 + 1.3 / 2, 1), 3 * 1.875 / 1.3) << "the largest rate of a 3-4-5 polynomial";
  const TimeFunction step = function_of(all_kinds()[3]);
  EXPECT_EQ(step.at(0.9 - 1e-12), 0.5);
  EXPECT_EQ(step.at(0.9), -2);
  EXPECT_EQ(step.at(0.9, 0, 0.8), 0.5) << "the formula that holds before";
  for (int k = 4; k < 7; ++k) {
    const TimeFunction table = function_of(all_kinds()[static_cast<std::size_t>(k)]);
    EXPECT_EQ(table.at(0.3), 1);
    EXPECT_NEAR(table.at(0.8), 2, 1e-15);
    EXPECT_NEAR(table.at(1.9), -1, 1e-15);
    if (k < 6) {
      EXPECT_EQ(table.at(0), 1);
      EXPECT_EQ(table.at(7), -1);
    }
  }
  EXPECT_DOUBLE_EQ(function_of(all_kinds()[4]).at(0.55), 1.5);
}

TEST(TimeFunction, HasItsDerivativesByTimeAndNumbers) {
  for (const std::string& kind : all_kinds()) {
    const TimeFunction f = function_of(kind);
    for (const double t : {0.1, 0.55, 0.93, 1.31, 1.88, 2.5}) {
      const double h = 1e-4;
      for (int d = 1; d <= 2; ++d) {
        const double slope = (f.at(t + h, d - 1, t) - f.at(t - h, d - 1, t)) / (2 * h);
        EXPECT_NEAR(f.at(t, d), slope, 1e-5 * (1 + std::abs(slope))) << kind << " " << t << " " << d;
      }
      for (int n = 0; n < static_cast<int>(f.numbers().size()); ++n) {
        if (!f.is_smooth_in(n)) continue;
        for (int d = 0; d <= 2; ++d) {
          const auto changed = [&](double by) {
            TimeFunction other = f;
            std::visit(
                [&](auto& law) {
                  const Number& number = other.numbers()[static_cast<std::size_t>(n)];
                  number.set(&law, *number.get(&law) + by);
                },
                other.law);
            return other.at(t, d, t);
          };
          const double slope = (changed(h) - changed(-h)) / (2 * h);
          EXPECT_NEAR(f.by(n, t, d, t), slope, 1e-4 * (1 + std::abs(slope)))
              << kind << " " << t << " " << n << " " << d;
        }
      }
    }
  }
}

TEST(TimeFunction, IsAsSmoothAsItsKindSays) {
  std::array<int, 4> seen{};
  for (const std::string& kind : all_kinds()) {
    const TimeFunction f = function_of(kind);
    const int smoothness = f.law.smoothness();
    ++seen[static_cast<std::size_t>(smoothness + 1)];
    double largest = 0.0;  // of the first derivative that need not be continuous
    for (const double t : f.breaks()) {
      for (int d = 0; d <= 2; ++d) {
        const double jump = std::abs(f.at(t, d, t - 1e-9) - f.at(t, d, t + 1e-9));
        if (d <= smoothness)
          EXPECT_NEAR(jump, 0, 1e-12) << kind << " " << t << " " << d;
        else if (d == smoothness + 1)
          largest = std::max(largest, jump);
      }
    }
    if (smoothness < 2 && !f.breaks().empty()) {
      EXPECT_GT(largest, 0.1) << kind;
    }
  }
  for (const int count : seen) EXPECT_GT(count, 0) << "all of them";
}

// Their rates at a third and in the middle, and their largest accelerations, of a way of 1 in a time of 1.
TEST(TimeFunction, WaysHaveTheRatesOfTheirNames) {
  struct Known {
    const char* word;
    double third, middle, fastest;
  };
  for (const Known& way :
       {Known{"cubic", 4.0 / 3, 1.5, 6}, Known{"trapezoidal", 1.5, 1.5, 4.5}, Known{"s_curve", 1.5, 1.5, 9},
        Known{"polynomial_345", 30.0 * 4 / 81, 1.875, 10 / std::sqrt(3.0)}}) {
    const TimeFunction f = function_of(fmt::format("{{ ramp = {{ to = 1, end = 1, law = \"{}\" }} }}", way.word));
    EXPECT_NEAR(f.at(1.0 / 3, 1), way.third, 1e-14) << way.word;
    EXPECT_NEAR(f.at(0.5, 1), way.middle, 1e-14) << way.word;
    EXPECT_NEAR(f.at(0.5), 0.5, 1e-15) << way.word;
    EXPECT_NEAR(f.at(0.1) + f.at(0.9), 1, 1e-15) << way.word;
    double fastest = 0.0;
    for (int i = 0; i < 12000; ++i) fastest = std::max(fastest, std::abs(f.at(i / 12000.0, 2)));
    EXPECT_NEAR(fastest, way.fastest, 2e-3) << way.word;
  }
}

// A function of named numbers follows them, and so has derivatives by them.
TEST(TimeFunction, FormulasFollowNamedNumbers) {
  Scene scene =
      parse_scene(scene_with("time = { sum = [{ function = \"2*cos(w*t)\" }, { function = \"t/T\" }] }"), "time.toml");
  EXPECT_DOUBLE_EQ(scene.time_functions[0].at(0.5), 2 * std::cos(1.05) + 0.5 / 1.3);
  set_value(scene, "numbers.T", 2.5);
  set_value(scene, "numbers.w", 1.0);
  EXPECT_DOUBLE_EQ(scene.time_functions[0].at(0.5), 2 * std::cos(0.5) + 0.2);
  EXPECT_EQ(get_value(scene, "load.F.time.sum.1.function.w"), 1.0);
  const std::string message = test::message_of([&] { set_value(scene, "load.F.time.sum.2.function.T", 3.0); });
  EXPECT_NE(message.find("T"), std::string::npos) << message;
}

// A velocity and an acceleration give the place by integrals, exact but for rounding over many periods.
TEST(TimeFunction, VelocitiesAndAccelerationsAreIntegrated) {
  const auto drive = [](const std::string& time) {
    return parse_scene(scene_with("", "[[drive]]\nslide = \"x\"\ntime = " + time), "time.toml").time_functions.at(0);
  };
  const double w = 2 * std::numbers::pi * 3;
  const TimeFunction rate = drive("{ as = \"velocity\", start = 40, sine = { amplitude = 30, frequency = 3 } }");
  const TimeFunction pull =
      drive("{ as = \"acceleration\", start = 40, rate = -2, sine = { amplitude = 30, frequency = 3, phase = 90 } }");
  for (const double t : {-0.3, 0.0, 0.01, 0.77, 5.0, 1000.3}) {
    EXPECT_NEAR(rate.at(t), 0.04 + 0.03 / w * (1 - std::cos(w * t)), 1e-15 * (1 + std::abs(t))) << t;
    EXPECT_NEAR(rate.at(t, 1), 0.03 * std::sin(w * t), 1e-16 * (1 + w * std::abs(t))) << t;
    EXPECT_NEAR(rate.at(t, 2), 0.03 * w * std::cos(w * t), 1e-15 * (1 + w * w * std::abs(t))) << t;
    EXPECT_NEAR(pull.at(t), 0.04 - 0.002 * t + 0.03 / (w * w) * (1 - std::cos(w * t)), 1e-15 * (1 + t * t)) << t;
    EXPECT_NEAR(pull.at(t, 1), -0.002 + 0.03 / w * std::sin(w * t), 1e-15 * (1 + std::abs(t))) << t;
    // Derivatives by the amplitude and by both starts are known too.
    EXPECT_NEAR(rate.by(1, t, 0, t), (1 - std::cos(w * t)) / w, 1e-13 * (1 + std::abs(t))) << t;
    EXPECT_EQ(rate.by(0, t, 0, t), 1.0);
    EXPECT_EQ(pull.by(1, t, 0, t), t);
  }
  // A ramp of the rate goes on at its end.
  const TimeFunction ramp =
      drive("{ as = \"velocity\", start = 0, ramp = { to = 10, start = 0.5, end = 1.5, law = \"linear\" } }");
  EXPECT_NEAR(ramp.at(0.5), 0, 1e-18);
  EXPECT_NEAR(ramp.at(1), 0.01 / 8, 1e-17);
  EXPECT_NEAR(ramp.at(4.5), 0.01 * 3.5, 1e-16);
}

TEST(TimeFunction, NumbersAreOnesOfTheScene) {
  Scene scene = parse_scene(
      scene_with("time = " + all_kinds()[0], "[[drive]]\nslide = \"x\"\ntime = { ramp = { to = 20, end = 3 } }"),
      "time.toml");
  EXPECT_EQ(get_value(scene, "load.F.time.amplitude"), 1.5);
  EXPECT_NEAR(get_value(scene, "load.F.time.phase"), 40, 1e-12) << "degrees";
  set_value(scene, "load.F.time.offset", 4);
  // Those of drives come first.
  EXPECT_DOUBLE_EQ(scene.time_functions[1].at(0), 4 + 1.5 * std::sin(40 * std::numbers::pi / 180));
  EXPECT_NEAR(get_value(scene, "drive.drive 1.time.to"), 20, 1e-12) << "mm";
  EXPECT_THROW(set_value(scene, "drive.drive 1.rate", 1), InputError) << "which the function has taken the place of";
  EXPECT_DOUBLE_EQ(scene.time_functions[0].at(9), 0.02) << "m";
  const std::string message = test::message_of([&] { set_value(scene, "drive.drive 1.time.end", -1); });
  EXPECT_NE(message.find("starts before it ends"), std::string::npos) << message;
}

TEST(TimeFunction, TablesOfDrivesAreScaledWithTheirScene) {
  const Scene scene = parse_scene(
      scene_with("", "[[drive]]\nslide = \"x\"\ntime = { table = [[0, 10], [1, 30], [2, 20]] }"), "time.toml");
  const Scales scales{.length = 0.25, .force = 8};
  const Scene small = scaled(scene, scales);
  EXPECT_EQ(small.time_functions[0].at(0.7), scene.time_functions[0].at(0.7) / 0.25);
  EXPECT_DOUBLE_EQ(scene.time_functions[0].at(1), 0.03);
  EXPECT_NEAR(scene.time_functions[0].at(4, 2), 0, 1e-15) << "on along the tangent";
  // By the second time, in the units of the scene.
  EXPECT_EQ(small.time_functions[0].by(3, 0.7, 1, 0.7), scene.time_functions[0].by(3, 0.7, 1, 0.7) / 0.25);
  EXPECT_EQ(small.time_functions[0].by(2, 0.7, 1, 0.7), scene.time_functions[0].by(2, 0.7, 1, 0.7));
  EXPECT_NEAR(scene.time_functions[0].at(4) - scene.time_functions[0].at(3), scene.time_functions[0].at(3, 1), 1e-15);
}

TEST(TimeFunction, SceneAtATimeHoldsTheLoadsOfThatTime) {
  const Scene scene = parse_scene(scene_with("time = { ramp = { to = 2, end = 4 } }"), "time.toml");
  const Scene then = at_time(scene, 1.0);
  EXPECT_TRUE(then.time_functions.empty());
  EXPECT_EQ(then.forces[0].vector, (Vec2{1.5, 0}));
  ASSERT_EQ(then.held_loads.size(), 1U);
  EXPECT_EQ(then.held_loads[0].name, "F");
  EXPECT_EQ(then.held_loads[0].factor, 0.5);
}

TEST(TimeFunction, RefusesWhatItCannotMean) {
  const auto message = [](const std::string& time, const std::string& drive = "") {
    return test::message_of([&] { parse_scene(scene_with(time, drive), "time.toml"); });
  };
  const auto expect = [&](const std::string& found, const std::string& part) {
    EXPECT_NE(found.find(part), std::string::npos) << found;
    EXPECT_EQ(found.find("time.toml:"), 0U) << found;
  };
  expect(message("time = 3"), "expected a table");
  expect(message("time = {}"), "expected one of sine");
  expect(message("time = { sine = { amplitude = 1, frequency = 1 }, step = { to = 1 } }"), "leave one out");
  expect(message("time = { sin = { amplitude = 1 } }"), "sine");
  expect(message("time = { sine = { frequency = 1 } }"), "amplitude");
  expect(message("time = { sine = { amplitude = 1, frequency = -1 } }"), "frequency");
  expect(message("time = { ramp = { to = 1, start = 2, end = 1 } }"), "before it ends");
  expect(message("time = { table = [[0, 1]] }"), "two points");
  expect(message("time = { table = [[0, 1], [0, 2]] }"), "a time after that of the point before");
  expect(message("time = { table = [[0, 1], [1, 2]], interpolation = \"qubic\" }"), "cubic");
  expect(message("time = { function = \"2*v\" }"), "found \"v\"");
  expect(message("time = { function = \"2*\" }"), "a number, a name");
  expect(message("time = { function = 3 }"), "string");
  expect(message("time = { sum = [] }"), "expected a list of functions");
  expect(message("time = { sum = [{ sine = { amplitude = 1 } }] }"), "frequency");
  expect(message("time = { piecewise = [{ function = \"1\" }, { function = \"2\" }] }"), "until");
  expect(message("time = { piecewise = [{ until = 2, function = \"1\" }, { until = 1, function = \"2\" }, "
                 "{ function = \"3\" }] }"),
         "ascend");
  expect(message("time = { piecewise = [{ until = 2, function = \"1\" }, { until = 3, function = \"2\" }] }"), "until");
  expect(message("time = { as = \"velocity\", function = \"t\" }"), "as");
  expect(message("time = { file = \"no.csv\" }"), "no.csv");
  const std::string drive = "[[drive]]\nslide = \"x\"\n";
  const std::string jumps = "rate never jumps";
  expect(message("", drive + "time = { step = { to = 1 } }"), jumps);
  expect(message("", drive + "time = { ramp = { to = 1, end = 1, law = \"linear\" } }"), jumps);
  expect(message("", drive + "time = { table = [[0, 1], [1, 2]], interpolation = \"linear\" }"), jumps);
  expect(message("", drive + "time = { function = \"abs(t - 1)\" }"), jumps);
  expect(message("", drive + "time = { function = \"atan2(t, 1)\" }"), jumps);
  expect(message("", drive + "time = { function = \"1/t\" }"), "t = 0 s");
  expect(message("", drive + "time = { piecewise = [{ until = 1, function = \"t\" }, { function = \"1\" }] }"), jumps);
  expect(message("", drive + "time = { as = \"velocity\", start = 0, step = { to = 1 } }"), jumps);
  expect(message("", drive + "time = { as = \"velocity\", function = \"t\" }"), "start");
  expect(message("", drive + "time = { as = \"speed\", function = \"t\" }"), "velocity");
  expect(message("", drive + "rate = 3\ntime = { ramp = { to = 1, end = 1 } }"), "leave one out");
}

}  // namespace
}  // namespace poise::time_function_test
