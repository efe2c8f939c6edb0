// Numbers for which a quantity has a value: closed forms, and random problems whose answers are planted.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "statics/inverse/find_numbers.hpp"
#include "statics/model/static_numbers.hpp"
#include "statics/paths/path_measures.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/mixed_mechanisms.hpp"
#include "tests/support/seed.hpp"

namespace poise::statics_find_test {
namespace {

using Status = FoundSet::Status;

FoundSet find(const Scene& scene, const std::string& number, double from, double to, const std::string& quantity,
              double value, FindOptions options = {}) {
  const VariedScene varied(scene, number, from, to);
  const SoughtQuantity of = find_quantity(varied.scene(), quantity);
  return find_numbers(varied, {of, value * of.dimension.unit(scene.units)}, options);
}

void expect_one(const FoundSet& found, double number, double relative = 1e-13) {
  ASSERT_EQ(found.status, Status::found) << found.why;
  ASSERT_EQ(found.values.size(), 1u);
  EXPECT_TRUE(found.values[0].proved) << found.values[0].at.statement;
  EXPECT_NEAR(found.values[0].numbers[0], number, relative * std::abs(number));
  EXPECT_LT(found.values[0].radii[0], 1e-12 * std::abs(number));
}

// A lever of 0.3 m on a torsion spring, with a force P up at its tip:  k a = P L cos(a).
Scene sprung_lever(const std::string& more = "") {
  return parse_scene(R"(
title = "lever"
source = "ours"
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], B = [0.3, 0] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "lever"]
stiffness = 2.0
free_angle = 0.0
[[force]]
name = "P"
at = "lever.B"
vector = [0, 4]
)" + more,
                     "lever.toml");
}

TEST(Find, TheStiffnessThatHoldsALeverAtAnAngle) {
  constexpr double angle = std::numbers::pi / 6;
  const FoundSet found = find(sprung_lever(), "torsion_spring.coil.stiffness", 0.5, 10.0, "angle.lever", angle);
  expect_one(found, 4.0 * 0.3 * std::cos(angle) / angle);
  EXPECT_EQ(found.values[0].at.stability, Stability::stable);
  EXPECT_EQ(found.paths, 1);
}

TEST(Find, TheLoadThatGivesAForceInAJoint) {
  // The pin at O carries P.
  expect_one(find(sprung_lever(), "load.P", 1.0, 20.0, "reaction.O", 7.5), 7.5);
}

// Crank of 50 mm, coupler of 180 mm, near the outer dead centre, where the number answers by the root of the value's
// rounding: the exact angle has  cos a = (V^2 + r^2 - l^2) / (2 r V).
TEST(Find, TheRadiusHoldsTheExactNumberNearADeadCentre) {
  std::string text = R"(
title = "slider-crank"
source = "ours"
[units]
length = "mm"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [50, 0] }
[body.rod]
points = { A = [0, 0], B = [180, 0] }
[body.ram]
points = { B = [0, 0] }
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.A", "rod.A"]
[[pin]]
points = ["rod.B", "ram.B"]
[[slide]]
name = "g"
points = ["ground.O", "ram.B"]
axis = [1, 0]
[start]
crank = 30
rod = -8
g = 220
)";
  const Scene scene = parse_scene(text, "crank.toml");
  for (const double value : {229.9999, 229.99999999, 200.0, 150.123}) {
    const FoundSet found = find(scene, "angle.crank", 0.0001, 170.0, "travel.g", value);
    ASSERT_EQ(found.values.size(), 1u) << value;
    const long double v = value, r = 50.0L, l = 180.0L;
    // 1 - cos a without cancellation.
    const long double sine = std::sqrt((l * l - (v - r) * (v - r)) / (4.0L * r * v));
    const long double exact = 2.0L * std::asin(sine);
    EXPECT_TRUE(found.values[0].proved) << value;
    EXPECT_LE(std::abs(static_cast<long double>(found.values[0].numbers[0]) - exact), found.values[0].radii[0])
        << value;
  }
}

TEST(Find, AValueThatIsNotReachedIsAnsweredWithTheNearest) {
  const FoundSet found = find(sprung_lever(), "load.P", 1.0, 20.0, "angle.lever", 2.0);
  ASSERT_EQ(found.status, Status::none);
  ASSERT_TRUE(found.nearest);
  EXPECT_NEAR(found.nearest->numbers[0], 20.0, 1e-9);
}

TEST(Find, AQuantityWithoutAValueIsUndefined) {
  // The lever moves in no other way than about O, where the pin stands still.
  const FoundSet found = find(sprung_lever(), "load.P", 1.0, 20.0, "push.lever.O.x", 1.0);
  EXPECT_EQ(found.status, Status::undefined);
}

// Crank of 1, coupler of 3, the slide along x:  x = cos(a) + sqrt(9 - sin(a)^2),  dx/da = -sin(a) (1 + cos(a) / w).
const char* const slider_crank = R"(
title = "slider-crank"
source = "ours"
[units]
length = "m"
angle = "deg"
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [1, 0] }
[body.coupler]
points = { A = [0, 0], B = [3, 0] }
[body.block]
points = { B = [0, 0] }
[[pin]]
name = "O"
points = ["ground.O", "crank.O"]
[[pin]]
name = "A"
points = ["crank.A", "coupler.A"]
[[pin]]
name = "B"
points = ["coupler.B", "block.B"]
[[slide]]
name = "guide"
points = ["ground.O", "block.B"]
axis = [1, 0]
[[force]]
name = "P"
at = "block.B"
vector = [-10, 0]
[start]
crank = 30
coupler = -10
guide = 3.8
)";

double leverage(double a) {
  const double w = std::sqrt(9.0 - std::sin(a) * std::sin(a));
  return -std::sin(a) * (1.0 + std::cos(a) / w);
}

TEST(Find, TheTravelAtWhichALeverageHasAValueIsFoundOnBothSidesOfItsExtreme) {
  const Scene scene = parse_scene(slider_crank, "slider_crank.toml");
  const double unit = std::numbers::pi / 180;  // m per deg
  for (const double wanted : {-0.5, -0.9, -1.0, -1.04}) {
    const FoundSet found = find(scene, "angle.crank", 10.0, 170.0, "d(travel.guide)/d(angle.crank)", wanted * unit);
    ASSERT_EQ(found.status, Status::found) << wanted;
    ASSERT_EQ(found.values.size(), 2u) << wanted;
    for (const FoundNumbers& one : found.values) {
      EXPECT_TRUE(one.proved) << one.at.statement;
      EXPECT_NEAR(leverage(one.numbers[0]), wanted, 1e-13);
    }
  }
  EXPECT_EQ(find(scene, "angle.crank", 10.0, 170.0, "d(travel.guide)/d(angle.crank)", -1.06 * unit).status,
            Status::none);
}

// A push at a point grows without bound where the point stands still: no value there is a solution.
TEST(Find, APoleIsNoValue) {
  const Scene scene = parse_scene(slider_crank, "slider_crank.toml");
  const FoundSet found = find(scene, "angle.crank", -40.0, 40.0, "push.coupler.A.x", 0.5);
  for (const FoundNumbers& one : found.values) EXPECT_NEAR(one.values[0], 0.5, 1e-9);
}

TEST(Find, TwoNumbersForTwoConditions) {
  // Which spring and which load hold the lever at 0.4 rad with 5 N in its pin?
  const Scene scene = sprung_lever();
  const VariedPair pair(scene, {"load.P", 1.0, 20.0}, {"torsion_spring.coil.stiffness", 0.5, 10.0});
  const std::vector<WantedValue> wanted{{find_quantity(scene, "angle.lever"), 0.4},
                                        {find_quantity(scene, "reaction.O"), 5.0}};
  const FoundSet found = find_numbers(pair, wanted);
  ASSERT_EQ(found.status, Status::found) << found.why;
  ASSERT_EQ(found.values.size(), 1u);
  EXPECT_TRUE(found.values[0].proved) << found.values[0].at.statement;
  EXPECT_NEAR(found.values[0].numbers[0], 5.0, 1e-12);
  EXPECT_NEAR(found.values[0].numbers[1], 5.0 * 0.3 * std::cos(0.4) / 0.4, 1e-12);
}

TEST(Find, NumbersFollowFromTheOneThatIsSoughtByAnyExpression) {
  // The spring has the stiffness c^2 / 2, and P leans by one part in c:  k a = P L cos(a) + (P / c) L sin(a).
  const Scene scene = parse_scene(R"(
title = "lever"
source = "ours"
[numbers]
c = 1.5
[ground]
points = { O = [0, 0] }
[body.lever]
points = { O = [0, 0], B = [0.3, 0] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "lever"]
stiffness = "c^2/2"
free_angle = 0.0
[[force]]
name = "P"
at = "lever.B"
vector = ["-4/c", 4]
)",
                                  "lever.toml");
  const FoundSet found = find(scene, "numbers.c", 1.0, 3.0, "angle.lever", 0.5);
  double low = 1.0, high = 3.0;
  const auto excess = [](double c) {
    return 0.5 * c * c * 0.5 - 4.0 * 0.3 * std::cos(0.5) - 4.0 / c * 0.3 * std::sin(0.5);
  };
  for (int k = 0; k < 100; ++k) (excess(0.5 * (low + high)) > 0.0 ? high : low) = 0.5 * (low + high);
  expect_one(found, low);
}

// Of the two angles at which a pendulum hangs and stands under a force sideways one is on the curve of the other.
TEST(Find, AllBeginsFromAllEquilibria) {
  const Scene scene = parse_scene(R"(
title = "pendulum"
source = "ours"
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], B = [1, 0] }
mass = 1
center = [1, 0]
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
[[force]]
name = "P"
at = "arm.B"
vector = [1, 0]
)",
                                  "pendulum.toml");
  // Hanging and standing  tan(a) = -10 / P;  the pin carries hypot(10, P) in both.
  const double load = 4.0;
  const FoundSet own = find(scene, "load.P", 1.0, 20.0, "reaction.O", std::hypot(10.0, load));
  expect_one(own, load);
  FindOptions options;
  options.all = true;
  const FoundSet all = find(scene, "load.P", 1.0, 20.0, "reaction.O", std::hypot(10.0, load), options);
  ASSERT_EQ(all.values.size(), 2u);
  for (const FoundNumbers& one : all.values) {
    EXPECT_TRUE(one.proved);
    EXPECT_NEAR(one.numbers[0], load, 1e-12);
  }
  EXPECT_NE(all.values[0].at.stability, all.values[1].at.stability);
  EXPECT_NE(all.sets.find("complete, proved"), std::string::npos) << all.sets;
}

TEST(Find, AStopThatHoldsIsPartOfTheAnswer) {
  // The stop holds at 0.3 rad; the load for which it presses with 1 N m:  P L cos(0.3) = k 0.3 + 1.
  const Scene scene = sprung_lever("[[stop]]\nname = \"high\"\nbodies = [\"ground\", \"lever\"]\nmax = 0.3\n");
  const FoundSet found = find(scene, "load.P", 0.5, 20.0, "stop.high", 1.0);
  expect_one(found, 1.6 / (0.3 * std::cos(0.3)));
  EXPECT_EQ(found.values[0].at.active_stops, std::vector<int>{0});
}

TEST(Find, TheStiffnessForWhichAClampSnapsOpen) {
  const Scene clamp = read_scene(test::dataset("toggle_clamp.toml"));
  const FoundSet found = find(clamp, "spring.rubber.stiffness", 100.0, 900.0, "fold.load.P", 40.0);
  ASSERT_EQ(found.status, Status::found) << found.why;
  ASSERT_EQ(found.values.size(), 1u);
  EXPECT_TRUE(found.values[0].proved) << found.values[0].at.statement;
  EXPECT_LT(found.values[0].radii[0], 1e-9);
  // The path over the load with that stiffness has its fold at 40 N.
  Scene there = clamp;
  set_value(there, "spring.rubber.stiffness", found.values[0].numbers[0] / 1000.0);
  const Path path = poise::path(VariedScene(there, "load.P", 25.0, 80.0), {});
  const auto fold = std::find_if(path.events.begin(), path.events.end(),
                                 [](const PathEvent& event) { return event.kind == PathEvent::Kind::fold; });
  ASSERT_NE(fold, path.events.end());
  EXPECT_NEAR(fold->at.parameter, 40.0, 1e-8);
}

// A number, a range around it and a quantity that changes with it.
struct PlantedProblem {
  std::string number, quantity;
  double from = 0.0, to = 0.0, planted = 0.0, wanted = 0.0;  // SI
};

/// Nothing where the curve from the first value does not come to the planted one, or the quantity does not change.
std::optional<PlantedProblem> plant(const Scene& scene, std::mt19937_64& random) {
  const auto unit_interval = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<std::string> numbers, quantities;
  for (const ParameterRow& row : parameter_table(scene)) {
    const std::optional<double> value = value_at(scene, row.place);
    if (value && std::isfinite(*value) && *value != 0.0 && acts_in_statics(scene, row.place)) {
      numbers.push_back(row.path.text());
    }
  }
  for (const std::string& name : quantity_names(scene)) {
    if (!name.starts_with("fold.") && !name.starts_with("push.")) quantities.push_back(name);
  }
  PlantedProblem out;
  out.number = numbers[random() % numbers.size()];
  out.quantity = quantities[random() % quantities.size()];
  // Not at the numbers of the scene, which are round, so that stops touch and bodies are in line.
  const double value = get_value(scene, out.number);
  const double a = value * (1.0 - 0.3 * unit_interval()), b = value * (1.0 + 0.3 * unit_interval());
  const double planted = a + (0.05 + 0.9 * unit_interval()) * (b - a);
  try {
    const VariedScene varied(scene, out.number, a, b);
    PathOptions options;
    options.certify = false;
    options.at = {planted * varied.unit()};
    const Path found = path(varied, options);
    if (found.wanted.size() != 1 || found.wanted[0].empty()) return std::nullopt;
    PathReader reader(varied);
    const SoughtQuantity of = find_quantity(varied.scene(), out.quantity);
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (const PathPoint& point : found.branches[0].points) {
      const double here = reader.value(of, point);
      least = std::min(least, here);
      most = std::max(most, here);
    }
    out.wanted = reader.value(of, found.wanted[0][0]);
    const double natural = 1.0 / of.dimension.per_scale(varied.scales());
    bool changes = std::isfinite(out.wanted) && most - least > 1e-3 * std::max(std::abs(most), std::abs(least)) &&
                   most - least > 1e-6 * natural;
    // Not all along a part of the range, as where a stop holds it.
    for (const PathPoint& point : found.branches[0].points) {
      const bool is_level = std::abs(reader.value(of, point) - out.wanted) < 1e-9 * (most - least);
      changes = changes && (!is_level || std::abs(point.parameter - options.at[0]) < 1e-9 * std::abs(options.at[0]));
    }
    if (!changes) return std::nullopt;
    out.from = a;
    out.to = b;
    out.planted = options.at[0];
    return out;
  } catch (const InputError&) {
    return std::nullopt;  // the number cannot vary so
  }
}

TEST(Find, ReturnsPlantedNumbersProved) {
  const int wanted = test::cases(25, 1000);
  int problems = 0, proved = 0;
  for (std::uint64_t seed = test::seed(38); problems < wanted; ++seed) {
    const Scene scene = test::mixed_mechanism(test::mixed_kinds()[seed % test::mixed_kinds().size()], seed);
    std::mt19937_64 random(seed);
    const std::optional<PlantedProblem> problem = plant(scene, random);
    if (!problem) continue;
    ++problems;
    const VariedScene varied(scene, problem->number, problem->from, problem->to);
    const SoughtQuantity of = find_quantity(varied.scene(), problem->quantity);
    const FoundSet found = find_numbers(varied, {of, problem->wanted});
    const double near = 1e-7 * std::abs(varied.to() - varied.from());
    const auto planted = std::find_if(found.values.begin(), found.values.end(), [&](const FoundNumbers& one) {
      return std::abs(one.numbers[0] - problem->planted) < near;
    });
    const std::string what = "seed " + std::to_string(seed) + ": " + problem->number + ", " + problem->quantity;
    if (planted == found.values.end()) {
      ADD_FAILURE() << what << ": not found, " << found.why;
      continue;
    }
    proved += planted->proved ? 1 : 0;
    // Round numbers put one-way springs at their free length for good.
    EXPECT_TRUE(planted->proved || planted->at.statement.find("changes its piece") != std::string::npos)
        << what << ": " << planted->at.statement;
  }
  RecordProperty("proved", proved);
  EXPECT_GE(proved, 0.97 * problems);
}

}  // namespace
}  // namespace poise::statics_find_test
