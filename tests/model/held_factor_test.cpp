// Loads that follow named numbers through their functions of time, in the scene and in the scene at one time.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <boost/math/constants/constants.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/dependent_number.hpp"
#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene.hpp"
#include "solvers/real50.hpp"
#include "tests/support/message_of.hpp"

namespace poise::held_factor_test {
namespace {

std::string scene_with(const std::string& vector, const std::string& time, const std::string& value = "2",
                       const std::string& torque_time = "") {
  return fmt::format(R"(
[units]
length = "mm"
force = "kN"
angle = "deg"
[numbers]
F = 2
T = 0.5
twice = "2*F"
[ground.points]
O = [0, 0]
[body.block]
mass = 2
points = {{ c = [0, 0], d = [30, 0] }}
[[slide]]
name = "x"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[distributed_load]]
name = "P"
points = ["block.c", "block.d"]
vector = {}
time = {}
[[torque]]
name = "M"
on = "block"
value = {}
{}
[[drive]]
slide = "x"
time = {{ ramp = {{ from = "F", to = "10*F", start = "T", end = "2*T" }} }}
)",
                     vector, time, value, torque_time);
}

/// A spring and a frame that follow named numbers too.
const std::string spring_and_frame = R"toml(
[[spring]]
name = "s"
slide = "x"
stiffness = "F"
free_length = 4
time = { stiffness = { function = "1 + T*t" }, free_length = { function = "F*cos(t)" } }
[frame]
x = { function = "0.1*sin(F*t)" }
y = { as = "acceleration", function = "F*cos(T*t)" }
)toml";

const std::vector<std::pair<std::string, std::string>>& loads() {
  static const std::vector<std::pair<std::string, std::string>> all{
      {"[\"F\", 1]", "{ sine = { amplitude = 1.5, frequency = 0.7, phase = 40 } }"},
      {"[3, -1]", "{ sine = { amplitude = \"F/2\", frequency = \"1/F\", phase = \"40*F\", offset = \"F^2\" } }"},
      {"[\"F\", \"-twice\"]", "{ ramp = { from = \"F\", to = \"3*F\", start = \"T/5\", end = \"twice*T\" } }"},
      {"[\"F\", 0]", "{ step = { to = \"F\", from = \"T\" } }"},
      {"[\"F\", 0]", "{ table = [[0, \"F\"], [0.4, \"T\"], [0.9, 3]] }"},
      {"[\"F\", 0]", "{ table = [[0, \"F\"], [0.4, \"T\"], [0.9, 3]], interpolation = \"monotone\" }"},
      {"[1, 2]", "{ table = [[0, \"F\"], [0.4, \"T\"], [0.9, 3]], interpolation = \"spline\" }"},
      {"[\"F\", 0]", "{ table = [[-0.1, \"F\"], [\"T/5\", \"T\"], [\"T + F\", 3]] }"},
      {"[1, 2]",
       "{ table = [[-0.1, 5], [\"T/5\", \"T\"], [\"T + F\", \"F/2\"], [6, 8]], interpolation = \"monotone\" }"},
      {"[1, 2]", "{ table = [[0, \"F\"], [\"T/5\", \"T\"], [\"T + F\", 3]], interpolation = \"spline\" }"},
      {"[1, 2]", "{ table = [[-0.1, \"F\"], [\"T/5\", \"T\"], [\"T + F\", 3]], interpolation = \"trapezoidal\" }"},
      {"[1, 2]", "{ ramp = { from = \"F\", to = 7, start = \"T - 1\", end = \"twice*T\", law = \"s_curve\" } }"},
      {"[\"F\", 0]", "{ function = \"twice*exp(-t/T) + atan2(F, 1 + t)\" }"},
      {"[\"F\", 0]", "{ sum = [{ function = \"F*t\" }, { sine = { amplitude = \"T\", frequency = \"F\" } }] }"},
      {"[2, 0]",
       "{ product = [{ function = \"F*t + 1\" }, { ramp = { to = \"T\", start = -1, end = \"F\" } }, "
       "{ function = \"cos(T*t)\" }] }"},
      {"[2, 0]",
       "{ piecewise = [{ until = \"T\", function = \"F*t^2\" }, { until = \"T + 1\", function = \"F*T^2\" }, "
       "{ sine = { amplitude = 1, frequency = 2 } }] }"}};
  return all;
}

void expect_same(const Scene& found, const Scene& expected) {
  for (const ParameterRow& row : parameter_table(expected)) {
    const std::optional<double> a = value_at(found, row.place), b = value_at(expected, row.place);
    ASSERT_EQ(a.has_value(), b.has_value()) << row.path.text();
    EXPECT_NEAR(a.value_or(0.0), b.value_or(0.0), 1e-13 * (1 + std::abs(b.value_or(0.0)))) << row.path.text();
  }
  for (std::size_t f = 0; f < expected.forces.size(); ++f) {
    EXPECT_DOUBLE_EQ(found.forces[f].vector.x, expected.forces[f].vector.x);
    EXPECT_DOUBLE_EQ(found.forces[f].vector.y, expected.forces[f].vector.y);
  }
}

// Setting a named number and then holding the scene at a time is the same as the other way round.
TEST(HeldFactor, NumbersMayBeSetBeforeAndAfter) {
  for (const auto& [vector, time] : loads()) {
    SCOPED_TRACE(vector + time);
    const Scene scene = parse_scene(
        scene_with(vector, time, "3", "time = { sine = { amplitude = \"F\", frequency = \"T\" } }") + spring_and_frame,
        "time.toml");
    for (const double t : {0.0, 0.3, 0.7}) {
      for (const auto& [number, value] : {std::pair<std::string, double>{"numbers.F", 3.25}, {"numbers.T", 0.75}}) {
        Scene before = scene;
        set_value(before, number, value);
        Scene after = at_time(scene, t);
        EXPECT_TRUE(after.time_functions.empty());
        set_value(after, number, value);
        before = at_time(before, t);
        // Drives have no numbers that follow: statics leaves them out.
        before.drives = after.drives;
        expect_same(after, before);
        expect_same(scaled(scaled(after, {0.25, 8}), {4, 0.125}), before);
      }
    }
  }
}

TEST(HeldFactor, HasItsDerivatives) {
  for (const auto& [vector, time] : loads()) {
    SCOPED_TRACE(vector + time);
    for (const double t : {0.0, 0.3, 0.7}) {
      const Scene scene = at_time(parse_scene(scene_with(vector, time) + spring_and_frame, "time.toml"), t);
      for (const int named : {0, 1}) {
        const std::vector<double> at = named_values(scene);
        const std::vector<double> slopes = dependents_by(scene, named, at);
        const auto values = [&](double by) {
          std::vector<double> moved = at;
          moved[static_cast<std::size_t>(named)] += by;
          return dependent_values(scene, moved, false);
        };
        constexpr double h = 1e-4;
        const std::vector<double> a = values(-h), b = values(h), aa = values(-2 * h), bb = values(2 * h);
        for (std::size_t k = 0; k < slopes.size(); ++k) {
          const double slope = (8 * (b[k] - a[k]) - (bb[k] - aa[k])) / (12 * h);
          EXPECT_NEAR(slopes[k], slope, 1e-8 * (1 + std::abs(slope))) << (*scene.dependents)[k].item << " " << t;
        }
      }
    }
  }
}

// c(t) of some laws, by named numbers F and T, in 50 digits.
struct ExactFactor {
  std::string time;
  std::function<Real50(const Real50& F, const Real50& T, double t)> at;
};

Real50 on_smooth_ramp(const Real50& from, const Real50& to, const Real50& s) {
  return from + (to - from) * s * s * s * (10 - 15 * s + 6 * s * s);
}

std::vector<ExactFactor> exact_factors() {
  const auto degrees = [](const Real50& a) { return Real50(a * boost::math::constants::pi<Real50>() / 180); };
  const auto turns = [](const Real50& a) { return Real50(2 * boost::math::constants::pi<Real50>() * a); };
  return {
      {"{ sine = { amplitude = \"F/2\", frequency = \"1/F\", phase = \"40*T\", offset = \"F^2\" } }",
       [=](const Real50& F, const Real50& T, double t) {
         return Real50(F / 2 * sin(turns(Real50(t) / F) + degrees(40 * T)) + F * F);
       }},
      {"{ ramp = { from = \"F\", to = \"T^3\", start = \"T/5\", end = \"twice*T\" } }",
       [](const Real50& F, const Real50& T, double t) {
         return Real50(F + (T * T * T - F) * (t - T / 5) / (2 * F * T - T / 5));
       }},
      {"{ ramp = { from = \"F\", to = 3, start = \"T/5\", end = \"twice*T\", law = \"polynomial_345\" } }",
       [](const Real50& F, const Real50& T, double t) {
         return on_smooth_ramp(F, 3, Real50((t - T / 5) / (2 * F * T - T / 5)));
       }},
      {"{ step = { to = \"F/T\", at = 0.1 } }", [](const Real50& F, const Real50& T, double) { return Real50(F / T); }},
      {"{ table = [[-0.1, \"F\"], [\"T/5\", \"T*F\"], [\"T + F\", 3]] }",
       [](const Real50& F, const Real50& T, double t) {
         const Real50 h = T + F - T / 5;
         return Real50(T * F + (3 - T * F) * (t - T / 5) / h);
       }},
      // Before the second point force and time fall and rise again, so that the slope there is zero.
      {"{ table = [[-0.1, 5], [\"T/5\", \"T\"], [\"T + F\", \"F/2\"], [6, 8]], interpolation = \"monotone\" }",
       [](const Real50& F, const Real50& T, double t) {
         const Real50 h = T + F - T / 5, after = 6 - T - F;
         const Real50 secant = (F / 2 - T) / h, next = (8 - F / 2) / after;
         const Real50 share = (h + 2 * after) / (3 * (h + after));
         const Real50 slope = 1 / (share / secant + (1 - share) / next), s = (t - T / 5) / h;
         return Real50(T + (F / 2 - T) * s * s * (3 - 2 * s) - h * slope * s * s * (1 - s));
       }},
      {"{ table = [[0, \"F\"], [\"T/5\", \"T\"], [\"T + F\", 3]], interpolation = \"spline\" }",
       [](const Real50& F, const Real50& T, double t) {
         const Real50 before = T / 5, h = T + F - T / 5;
         const Real50 curvature = 3 * ((3 - T) / h - (T - F) / before) / (before + h);
         const Real50 s = (t - T / 5) / h, r = 1 - s;
         return Real50(T * r + 3 * s + curvature * h * h / 6 * (r * r * r - r));
       }}};
}

// The second derivative of the first component of the load, in the units of the file, along a line of F and T.
double bend_of_load(const Scene& held, double by_f, double by_t) {
  const auto load = std::find_if(held.dependents->begin(), held.dependents->end(), [](const DependentNumber& one) {
    return one.at.place.owner == Owner::force && one.at.component == 0;
  });
  const std::vector<double> slopes{by_f, by_t, 2 * by_f};
  return load->bend(named_values(held), slopes, std::vector<double>(slopes.size(), 0.0));
}

// Second differences in 50 digits, of a load F c(t).
TEST(HeldFactor, HasItsSecondDerivatives) {
  for (const ExactFactor& factor : exact_factors()) {
    for (const double t : {0.3, 0.7}) {
      const Scene held = at_time(parse_scene(scene_with("[\"F\", 0]", factor.time), "time.toml"), t);
      for (const auto& [by_f, by_t] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {1.0, -0.75}}) {
        const auto load = [&, f = by_f, along_t = by_t](const Real50& e) {
          const Real50 F = 2 + e * f, T = Real50(0.5) + e * along_t;
          return Real50(F * factor.at(F, T, t));
        };
        const Real50 h = 1e-12;
        const auto second = static_cast<double>(Real50((load(h) - 2 * load(0) + load(-h)) / (h * h)));
        EXPECT_NEAR(bend_of_load(held, by_f, by_t), second, 4e-14 * (1 + std::abs(second)))
            << factor.time << " " << t << " along " << by_f << ", " << by_t;
      }
    }
  }
}

// A sine at its crest.
TEST(HeldFactor, BendsWhereItsSlopeIsZero) {
  const std::string sine = "{ sine = { amplitude = 3, frequency = 0, phase = \"45*F\" } }";
  const Scene held = at_time(parse_scene(scene_with("[1, 0]", sine), "time.toml"), 0.0);
  EXPECT_NEAR(bend_of_load(held, 1.0, 0.0), -3.0 * std::pow(std::numbers::pi / 4, 2), 1e-14);
}

// The second derivative of a monotone table jumps where a piece begins.
TEST(HeldFactor, HasNoSecondDerivativeByTheTimeOfAPointOfAMonotoneTable) {
  const std::string table = "{ table = [[0, 1], [\"T\", 3], [1, 4], [2, 9]], interpolation = \"monotone\" }";
  const Scene scene = parse_scene(scene_with("[1, 0]", table), "time.toml");
  const auto is_known = [&](double t) { return std::isfinite(bend_of_load(at_time(scene, t), 0.0, 1.0)); };
  EXPECT_FALSE(is_known(0.5));
  EXPECT_TRUE(is_known(0.50001));
  EXPECT_TRUE(is_known(1.0));
}

TEST(HeldFactor, SaysWhatALoadFollows) {
  const Scene scene = at_time(parse_scene(scene_with("[3, 0]", loads()[1].second), "time.toml"), 0.25);
  EXPECT_EQ(test::message_of([&] {
              Scene changed = scene;
              set_value(changed, "load.P", 2);
            }),
            "load.P: expected a number of its own, found the expression \"(3) * sine(0.25 s)\"; change numbers.F");
}

// The time of a step at which a load jumps: no derivative there, and none by that time at all.
TEST(HeldFactor, HasNoDerivativeByTheTimeOfAJump) {
  const Scene scene =
      at_time(parse_scene(scene_with("[3, 0]", "{ step = { to = 2, at = \"T\" } }"), "time.toml"), 0.25);
  bool is_known = true;
  for (const double slope : dependents_by(scene, 1, named_values(scene))) is_known = is_known && std::isfinite(slope);
  EXPECT_FALSE(is_known);
}

// Where others take the place of the drives.
TEST(HeldFactor, LoadsFollowWithoutTheFunctionsOfDrives) {
  for (const auto& [vector, time] : loads()) {
    Scene scene = parse_scene(scene_with(vector, time), "time.toml"), expected = scene;
    forget_functions_of_drives(scene);
    EXPECT_EQ(scene.time_functions.size(), 1U);
    set_value(scene, "numbers.F", 3.5);
    set_value(expected, "numbers.F", 3.5);
    expect_same(at_time(scene, 0.3), [&] {
      Scene held = at_time(expected, 0.3);
      held.drives = scene.drives;
      return held;
    }());
  }
}

TEST(HeldFactor, FunctionsFollowTogether) {
  Scene scene = parse_scene(scene_with(loads()[2].first, loads()[2].second), "time.toml");
  set_value(scene, "numbers.T", 7);
  EXPECT_EQ(get_value(scene, "load.P.time.start"), 1.4);
  EXPECT_EQ(get_value(scene, "load.P.time.end"), 28);
  EXPECT_EQ(get_value(scene, "drive.drive 1.time.start"), 7);
  const std::string message = test::message_of([&] { set_value(scene, "numbers.T", -1); });
  EXPECT_NE(message.find("numbers.T: "), std::string::npos) << message;
  EXPECT_NE(message.find("before it ends"), std::string::npos) << message;
  EXPECT_EQ(get_value(scene, "numbers.T"), 7) << "nothing has changed";
  EXPECT_NE(test::message_of([&] { set_value(scene, "load.P.time.end", 3); }).find("\"twice*T\""), std::string::npos);
}

TEST(HeldFactor, ScenesAreWrittenBackWithTheirExpressions) {
  const std::string text = scene_with("[\"F\", 1]", "{ table = [[0, 1], [0.4, \"T\"], [0.9, 3]] }");
  Scene scene = parse_scene(text, "time.toml");
  set_value(scene, "numbers.F", 5);
  set_value(scene, "load.P.time.table.3", 4.5);
  std::string expected = text;
  expected.replace(expected.find("F = 2"), 5, "F = 5.0");
  expected.replace(expected.find("[0.9, 3]"), 8, "[0.9, 4.5]");
  EXPECT_EQ(rewritten_scene(text, "time.toml", scene), expected);
}

// At the time of a kink, of a line or at an end of a table, the value has no derivative by that time.
TEST(HeldFactor, HasNoDerivativeByTheTimeOfAKink) {
  const auto is_known = [](const std::string& time, double t) {
    const Scene scene = at_time(parse_scene(scene_with("[3, 0]", time), "time.toml"), t);
    bool all = true;
    for (const double slope : dependents_by(scene, 1, named_values(scene))) all = all && std::isfinite(slope);
    return all;
  };
  const std::string points = "[[0, 1], [\"T\", 3], [1, 4], [2, 9]]", first = "[[\"T\", 1], [1, 4], [2, 9]]";
  for (const std::string between : {"linear", "monotone", "spline"}) {
    const std::string end = ", interpolation = \"" + between + "\" }";
    EXPECT_EQ(is_known("{ table = " + points + end, 0.5), between != "linear") << between;
    EXPECT_TRUE(is_known("{ table = " + points + end, 0.50001)) << between;
    EXPECT_TRUE(is_known("{ table = " + points + end, 1.0)) << between << ": of another point";
    EXPECT_EQ(is_known("{ table = " + first + end, 0.5), between == "spline") << between;
  }
  EXPECT_FALSE(is_known("{ ramp = { to = 2, start = \"T\", end = 3 } }", 0.5));
  EXPECT_TRUE(is_known("{ ramp = { to = 2, start = \"T\", end = 3, law = \"polynomial_345\" } }", 0.5));
}

TEST(HeldFactor, TimesOfTablesAscend) {
  const std::string text = scene_with("[1, 1]", "{ table = [[0, 1], [\"T\", 2], [\"T + F\", 5], [9, 0]] }");
  Scene scene = parse_scene(text, "time.toml");
  EXPECT_EQ(get_value(scene, "load.P.time.table.3.t"), 2.5);
  set_value(scene, "load.P.time.table.1.t", 0.25);
  set_value(scene, "numbers.T", 6);  // beyond the third point until that follows too
  EXPECT_EQ(get_value(scene, "load.P.time.table.2.t"), 6);
  EXPECT_EQ(get_value(scene, "load.P.time.table.3.t"), 8);
  EXPECT_EQ(scene.time_functions[1].at(7), 3.5);
  EXPECT_EQ(test::message_of([&] { set_value(scene, "load.P.time.table.4.t", 8); }),
            "load.P.time.table.4.t: expected times of points that ascend; keep each between those beside it");
  const std::string message = test::message_of([&] { set_value(scene, "numbers.T", 7); });
  EXPECT_EQ(message.find("numbers.T: distributed_load \"P\".time.table"), 0U) << message;
  EXPECT_NE(message.find("times of points that ascend"), std::string::npos) << message;
  EXPECT_EQ(get_value(scene, "numbers.T"), 6) << "nothing has changed";
  EXPECT_EQ(scene.time_functions[1].at(7), 3.5);
  const std::string written = rewritten_scene(text, "time.toml", scene);
  EXPECT_NE(written.find("[[0.25, 1], [\"T\", 2], [\"T + F\", 5], [9, 0]]"), std::string::npos) << written;
  EXPECT_NE(test::message_of([&] {
              parse_scene(scene_with("[1, 1]", "{ table = [[\"T\", 1], [0, 2]] }"), "time.toml");
            }).find("a time after that of the point before"),
            std::string::npos);
}

TEST(HeldFactor, LongTablesHaveNoNumbers) {
  std::string long_table = "{ table = [";
  for (int k = 0; k < 65; ++k) long_table += fmt::format("{}[{}, {}]", k > 0 ? ", " : "", k, k % 7);
  const Scene scene = parse_scene(scene_with("[1, 1]", long_table + "] }"), "time.toml");
  EXPECT_FALSE(find_parameter(scene, "load.P.time.table.1").has_value()) << "more than 64 points have none";
  EXPECT_FALSE(find_parameter(scene, "load.P.time.table.1.t").has_value());
}

}  // namespace
}  // namespace poise::held_factor_test
