// Derivatives of results by the numbers of a scene: closed forms, and differences in 50 digits on scenes and random
// mechanisms.

#include "statics/sensitivity/sensitivity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "solvers/real50.hpp"
#include "statics/model/reference.hpp"
#include "statics/quantities/linear_response.hpp"
#include "statics/quantities/quantity_value.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::statics_sensitivity_test {
namespace {

using test::dataset;

constexpr double accuracy = 1e-9;
constexpr int bits = 20;       // of the numbers of a scene, so that sums with a step are exact
constexpr int step_bits = 31;  // a number over its step

/// Every number rounded to few bits.
Scene with_short_numbers(Scene scene) {
  for (const ParameterRow& row : parameter_table(scene)) {
    if (row.place.owner == Owner::force || row.place.owner == Owner::start) continue;
    const auto value = value_at(scene, row.place);
    if (!value || *value == 0.0 || !std::isfinite(*value)) continue;
    const int exponent = std::ilogb(*value);
    set_value_at(scene, row.place, std::ldexp(std::round(std::ldexp(*value, bits - exponent)), exponent - bits));
  }
  return scene;
}

double step_of(double value, double unit) {
  return std::ldexp(1.0, std::ilogb(value == 0.0 ? unit : value) - step_bits);
}

/// f'(0) from f at -2h, -h, h, 2h.
Real50 central(const std::vector<Real50>& f, double h) {
  return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * Real50(h));
}

std::vector<SoughtQuantity> quantities(const Scene& scene, const std::vector<std::string>& names) {
  std::vector<SoughtQuantity> out;
  for (const std::string& name : names) out.push_back(find_quantity(scene, name));
  return out;
}

/// The quantities of a position of a scene, those of points of the first point of each body; loads at folds belong to
/// paths, and nothing is driven.
std::vector<std::string> all_of(const Scene& scene) {
  using Kind = SoughtQuantity::Kind;
  std::vector<std::string> out;
  for (const SoughtQuantity& one : all_quantities(scene)) {
    const bool is_coordinate =
        one.kind == Kind::measure && (one.on.kind == Measure::Kind::x || one.on.kind == Measure::Kind::y);
    if (one.kind == Kind::load_at_fold || one.kind == Kind::drive_force) continue;
    if ((is_coordinate && one.on.b.point > 0) || (one.kind == Kind::push && one.point.point > 0)) continue;
    out.push_back(one.name);
  }
  return out;
}

/// The equilibrium near z in 50 digits, by Newton's method with the inverse of a matrix in double.
std::vector<Real50> refined(const NumberedEquations& equations, const std::vector<Real50>& numbers,
                            const std::vector<double>& z, const Eigen::FullPivLU<Eigen::MatrixXd>& factors) {
  std::vector<Real50> out(z.begin(), z.end()), r(z.size());
  std::vector<NumberedEquations::Placed<Real50>> placed;
  for (int k = 0; k < 40; ++k) {
    equations.residual(numbers.data(), out.data(), r.data(), placed);
    Real50 largest = 0;
    for (const Real50& a : r) largest = std::max(largest, Real50(abs(a)));
    if (largest < 1e-45) break;
    Eigen::VectorXd rest(static_cast<Eigen::Index>(z.size()));
    for (std::size_t i = 0; i < z.size(); ++i) rest[static_cast<Eigen::Index>(i)] = static_cast<double>(r[i] / largest);
    const Eigen::VectorXd change = factors.solve(rest);
    for (std::size_t i = 0; i < z.size(); ++i) out[i] -= largest * Real50(change[static_cast<Eigen::Index>(i)]);
  }
  return out;
}

/// Compares all derivatives of all quantities with differences in 50 digits. Returns how many.
int expect_differences(const Scene& given, const std::string& name) {
  const StaticModel model(with_short_numbers(given));
  const std::vector<SoughtQuantity> of = quantities(model.scene(), all_of(model.scene()));
  const Sensitivities found = sensitivities(model, of);
  EXPECT_EQ(found.why, "") << name;
  if (!found.why.empty()) return 0;
  // The same equations, whose stops are those of the certificate.
  const Scene scene = model.scaled_scene();
  const std::vector<double> poses = poses_of(model, found.equilibrium.x);
  const std::vector<ActingStop> acting = acting_at(scene, poses, found.equilibrium.certificate.active_stops);
  const LinearResponse response(NumberedEquations(scene, acting), poses, 1e-10);
  const NumberedEquations& equations = response.equations();
  const Eigen::FullPivLU<Eigen::MatrixXd> factors(response.by_unknowns());
  if (!factors.isInvertible()) return 0;
  int compared = 0;
  std::vector<NumberedEquations::Placed<Real50>> placed;
  for (std::size_t row = 0; row < equations.rows().size(); ++row) {
    const std::string path = equations.rows()[row].path.text();
    const double value = equations.numbers()[row];
    const double h = step_of(value, 1.0);
    std::vector<std::vector<Real50>> at(of.size());
    bool is_used = false;
    for (const auto& one : found.of[0].by) is_used = is_used || one.number == path;
    if (!is_used) continue;
    for (const int k : {-2, -1, 1, 2}) {
      std::vector<Real50> numbers(equations.numbers().begin(), equations.numbers().end());
      numbers[row] = value + k * h;
      const std::vector<Real50> z = refined(equations, numbers, response.z(), factors);
      QuantityPlace<Real50> place(equations, numbers.data(), z.data());
      for (std::size_t q = 0; q < of.size(); ++q) at[q].push_back(place.value(of[q]));
    }
    for (std::size_t q = 0; q < of.size(); ++q) {
      const QuantitySensitivity& one = found.of[q];
      if (!one.why.empty()) continue;
      double largest = 0.0;
      const auto scaled = [&](const Sensitivity& s) {
        return s.derivative * one.of.dimension.per_scale(model.scales()) / s.dimension.per_scale(model.scales());
      };
      for (const Sensitivity& s : one.by) largest = std::max(largest, std::abs(scaled(s)));
      for (const Sensitivity& s : one.by) {
        if (s.number != path || !s.why.empty()) continue;
        const double difference = static_cast<double>(central(at[q], h));
        const double allowed = accuracy * std::max({std::abs(difference), 1e-3 * largest, 1e-4});
        EXPECT_NEAR(scaled(s), difference, allowed) << name << ": " << one.of.name << " by " << path;
        ++compared;
      }
    }
  }
  return compared;
}

class SensitivityOfScenes : public testing::TestWithParam<const char*> {};

TEST_P(SensitivityOfScenes, AgreeWithDifferencesIn50Digits) {
  EXPECT_GT(expect_differences(read_scene(dataset(GetParam() + std::string(".toml"))), GetParam()), 20);
}

INSTANTIATE_TEST_SUITE_P(Datasets, SensitivityOfScenes,
                         testing::Values("toggle_clamp", "four_bar_gravity", "four_bar_torsion", "knee_press",
                                         "six_bar", "heaton_timme", "zeeman", "vertical_slider_crank", "toggle_press",
                                         "andrews", "lift", "von_mises_toggle", "gas_lid"),
                         [](const auto& one) { return std::string(one.param); });

TEST(Sensitivity, AgreesWithDifferencesIn50DigitsOnRandomMechanisms) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3), .followers = seed % 4 == 0, .stops = seed % 2 == 0};
    const test::PlantedMechanism planted = test::plant_mechanism(seed, wish);
    if (planted.redundant > 0 || planted.falling() > 0) continue;
    compared += expect_differences(planted.in_equilibrium, fmt::format("seed {}", seed));
  }
  EXPECT_GT(compared, 1000);
}

TEST(Sensitivity, AgreesWithDifferencesIn50DigitsForSpringsOfAllLaws) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3), .other_laws = true};
    const test::PlantedMechanism planted = test::plant_mechanism(seed, wish);
    if (planted.redundant > 0 || planted.falling() > 0) continue;
    compared += expect_differences(planted.in_equilibrium, fmt::format("seed {}", seed));
  }
  EXPECT_GT(compared, 500);
}

TEST(Sensitivity, AgreesWithDifferencesIn50DigitsForCouplings) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3), .stops = seed % 2 == 0, .couplings = true};
    const test::PlantedMechanism planted = test::plant_mechanism(seed, wish);
    if (planted.redundant > 0 || planted.falling() > 0) continue;
    compared += expect_differences(planted.in_equilibrium, fmt::format("seed {}", seed));
  }
  EXPECT_GT(compared, 1000);
}

// The coordinates alone, from the compiled mechanism in 50 digits: other equations, in other unknowns.
TEST(Sensitivity, AnglesAgreeWithTheCompiledMechanismIn50Digits) {
  for (const char* name : {"toggle_clamp", "four_bar_gravity", "six_bar", "andrews"}) {
    const StaticModel model(with_short_numbers(read_scene(dataset(name + std::string(".toml")))));
    std::vector<std::string> names;
    for (int i = 0; i < model.layout().angles; ++i) names.push_back("angle." + model.layout().coordinates[i].name);
    const Sensitivities found = sensitivities(model, quantities(model.scene(), names));
    ASSERT_EQ(found.why, "") << name;
    for (const Sensitivity& first : found.of[0].by) {
      const double value = first.value, h = step_of(value, first.dimension.unit({}) * model.scales().length);
      const ParameterPlace place = parameter(model.scene(), first.number).place;
      if (place.owner == Owner::force) continue;  // its magnitude is not a double
      std::vector<std::vector<Real50>> at(names.size());
      for (const int k : {-2, -1, 1, 2}) {
        Scene changed = model.scene();
        set_value_at(changed, place, value + k * h);
        const StaticModel other(changed, model.scales(), VaryingNumbers(model.scene(), std::array{place}));
        ASSERT_EQ(other.layout().kept, model.layout().kept);
        const Reference exact = refine(other, found.equilibrium.x);
        ASSERT_TRUE(exact.refined) << name << " by " << first.number << ": " << exact.why;
        for (std::size_t q = 0; q < names.size(); ++q) at[q].push_back(Real50(exact.decimal[q]));
      }
      for (std::size_t q = 0; q < names.size(); ++q) {
        double largest = 0.0;
        const double per = first.dimension.per_scale(model.scales());
        for (const Sensitivity& s : found.of[q].by) {
          largest = std::max(largest, std::abs(s.derivative / s.dimension.per_scale(model.scales())));
        }
        const double difference = static_cast<double>(central(at[q], h)) / per;
        for (const Sensitivity& s : found.of[q].by) {
          if (s.number != first.number) continue;
          EXPECT_NEAR(s.derivative / per, difference, accuracy * std::max(std::abs(difference), 1e-3 * largest))
              << name << ": " << names[q] << " by " << s.number;
        }
      }
    }
  }
}

std::map<std::string, double> by_number(const QuantitySensitivity& of) {
  std::map<std::string, double> out;
  for (const Sensitivity& s : of.by) out[s.number] = s.derivative;
  return out;
}

// The stop of a lever pushes  S = P a / b,  its pin holds  P (1 + a / b).
TEST(Sensitivity, OfALeverIsItsLawOfTheLever) {
  const double a = 0.25, b = 0.5, P = 40.0;
  const StaticModel model(test::lever());
  const Sensitivities found =
      sensitivities(model, quantities(model.scene(), {"stop.foot", "reaction.O.y", "lever.load.y"}));
  ASSERT_EQ(found.why, "");
  EXPECT_NEAR(found.of[0].value, P * a / b, 1e-12);
  auto stop = by_number(found.of[0]), pin = by_number(found.of[1]), height = by_number(found.of[2]);
  EXPECT_NEAR(stop["load.P"], a / b, 1e-12);
  EXPECT_NEAR(stop["point.lever.load.x"], -P / b, 1e-9);
  EXPECT_NEAR(stop["point.lever.foot.x"], -P * a / (b * b), 1e-9);
  EXPECT_NEAR(pin["load.P"], -(1 + a / b), 1e-12);
  EXPECT_NEAR(height["stop.foot.min"], -a / b, 1e-12);
  EXPECT_NEAR(height["load.P"], 0.0, 1e-12);
}

TEST(Sensitivity, RefusesAStopWithoutPressure) {
  const StaticModel model(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], tip = [1, 0] }
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_spring]]
bodies = ["ground", "arm"]
stiffness = 3
[[stop]]
name = "just"
bodies = ["ground", "arm"]
min = 0
)",
                                      "arm"));
  const Sensitivities found = sensitivities(model, quantities(model.scene(), {"angle.arm"}));
  EXPECT_NE(found.why, "");
  EXPECT_TRUE(found.of.empty());
}

TEST(Sensitivity, OfRedundantForcesIsNotGiven) {
  const StaticModel model(read_scene(dataset("redundant_parallelogram.toml")));
  std::vector<std::string> names;
  for (const Joint& joint : model.scene().joints) names.push_back("reaction." + joint.name);
  names.push_back("angle." + model.scene().bodies[1].name);
  const Sensitivities found = sensitivities(model, quantities(model.scene(), names));
  ASSERT_EQ(found.why, "");
  EXPECT_TRUE(std::any_of(found.of.begin(), found.of.end() - 1, [](const auto& of) { return !of.why.empty(); }));
  const QuantitySensitivity& angle = found.of.back();
  EXPECT_EQ(angle.why, "");
  EXPECT_TRUE(std::any_of(angle.by.begin(), angle.by.end(), [](const Sensitivity& s) { return !s.why.empty(); }));
  EXPECT_TRUE(std::any_of(angle.by.begin(), angle.by.end(), [](const Sensitivity& s) { return s.why.empty(); }));
}

// The value of the reaction is the same in all its poses, how it changes is not.
TEST(Sensitivity, OfNeutralEquilibriaIsNotGiven) {
  const StaticModel model(read_scene(dataset("hard/counterweight.toml")));
  const Sensitivities found = sensitivities(model, quantities(model.scene(), {"reaction.A.y", "angle.crank"}));
  for (const QuantitySensitivity& of : found.of) {
    EXPECT_TRUE(of.by.empty());
    EXPECT_NE(of.why.find("neutral"), std::string::npos) << of.why;
  }
}

// What is proved to be isolated is not called free or redundant where its stiffnesses are far apart: a known
// derivative, or rounding as the reason.
TEST(Sensitivity, OfAnArmAsStiffAsCanBe) {
  const auto arm = [](double stiffness) {
    return parse_scene(fmt::format(R"(
      [ground]
      points = {{ O = [0, 0] }}
      [body.arm]
      points = {{ O = [0, 0], T = [1, 0] }}
      [[pin]]
      name = "O"
      points = ["ground.O", "arm.O"]
      [[torsion_spring]]
      name = "t"
      bodies = ["ground", "arm"]
      stiffness = {}
      [[force]]
      name = "M"
      at = "arm.T"
      vector = [0, -1]
      )",
                                   stiffness),
                       "arm");
  };
  for (const double stiffness : {1.0, 1e8, 1e10, 1e12}) {
    SCOPED_TRACE(stiffness);
    const StaticModel model(arm(stiffness));
    const Sensitivities found = sensitivities(model, quantities(model.scene(), {"angle.arm", "reaction.O.y"}));
    ASSERT_EQ(found.why, "");
    ASSERT_EQ(found.of[0].why, "");
    ASSERT_EQ(found.of[1].why, "");
    // k a = -P cos a
    const double slope = -std::cos(found.of[0].value) / (stiffness - std::sin(found.of[0].value));
    EXPECT_NEAR(by_number(found.of[0])["load.M"] / slope, 1.0, 1e-9);
    EXPECT_NEAR(by_number(found.of[1])["load.M"], 1.0, 1e-9);
  }
}

// The load at a fold against differences of the fold that paths find.
TEST(Sensitivity, OfTheLoadAtAFoldAgreesWithDifferences) {
  const auto fold = [](const Scene& scene, const std::string& name) {
    const StaticModel model(scene);
    return sensitivities(model, quantities(scene, {name})).of.at(0);
  };
  for (const auto& [file, load] : {std::pair("von_mises_toggle", "P"), std::pair("toggle_clamp", "P")}) {
    const Scene scene = read_scene(dataset(file + std::string(".toml")));
    const std::string name = std::string("load_at_fold.") + load;
    const QuantitySensitivity at = fold(scene, name);
    ASSERT_EQ(at.why, "") << file;
    double largest = 0.0;
    int compared = 0;
    for (const Sensitivity& s : at.by) largest = std::max(largest, std::abs(s.derivative * s.value));
    for (const Sensitivity& s : at.by) {
      if (!s.why.empty() || std::abs(s.derivative * s.value) < 0.01 * largest) continue;
      const double h = 1e-4 * s.value;
      std::vector<Real50> values;
      for (const int k : {-2, -1, 1, 2}) {
        Scene changed = scene;
        set_value_at(changed, parameter(scene, s.number).place, s.value + k * h);
        values.emplace_back(fold(changed, name).value);
      }
      const double difference = static_cast<double>(central(values, h));
      EXPECT_NEAR(s.derivative, difference, 1e-7 * std::abs(difference)) << file << " by " << s.number;
      ++compared;
    }
    EXPECT_GE(compared, 3) << file;
  }
}

// The load at a fold scales with all stiffnesses and weights together, and with all lengths as with all stiffnesses:
// P = k L f(m g / (k L)).
TEST(Sensitivity, OfTheLoadAtAFoldObeysTheScalingOfForcesAndLengths) {
  for (const char* file : {"von_mises_toggle.toml", "toggle_clamp.toml", "toggle_press.toml"}) {
    const Scene scene = read_scene(dataset(file));
    const std::string load = scene.forces.empty() ? scene.torques[0].name : scene.forces[0].name;
    const Sensitivities found = sensitivities(StaticModel(scene), quantities(scene, {"load_at_fold." + load}));
    ASSERT_EQ(found.why, "") << file;
    const QuantitySensitivity& at = found.of.at(0);
    ASSERT_EQ(at.why, "") << file;
    double by_lengths = 0.0, by_stiffness = 0.0, by_weights = 0.0, by_loads = 0.0;
    for (const Sensitivity& s : at.by) {
      const double part = s.derivative * s.value;
      if (s.number.ends_with(".x") || s.number.ends_with(".y") || s.number.ends_with("free_length")) {
        if (!s.number.starts_with("gravity")) by_lengths += part;
      } else if (s.number.ends_with("stiffness")) {
        by_stiffness += part;
      } else if (s.number.ends_with("mass")) {
        by_weights += part;
      } else if (s.number.starts_with("load.") && s.why.empty()) {
        by_loads += part;
      }
    }
    EXPECT_NEAR(by_stiffness + by_weights + by_loads, at.value, 1e-9 * std::abs(at.value)) << file;
    const double moment = at.of.dimension.length;  // a torque at the fold has a length more than a force
    EXPECT_NEAR(by_lengths, by_stiffness + moment * at.value, 1e-9 * std::abs(at.value)) << file;
  }
}

// An upright column on a torsion spring buckles at a branch point, P = k / L, where imperfections count like a root.
TEST(Sensitivity, OfTheLoadBehindABranchPointIsNotGiven) {
  const StaticModel model(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.column]
points = { O = [0, 0], top = [0, 2] }
[[pin]]
points = ["ground.O", "column.O"]
[[torsion_spring]]
bodies = ["ground", "column"]
stiffness = 10
[[force]]
name = "P"
at = "column.top"
vector = [0, -1]
)",
                                      "column"));
  const Sensitivities found = sensitivities(model, quantities(model.scene(), {"load_at_fold.P"}));
  ASSERT_EQ(found.why, "");
  EXPECT_NE(found.of.at(0).why.find("cross at load.P = 5 N before the first fold"), std::string::npos)
      << found.of.at(0).why;
}

// Derivatives that are zero: by the place of a weight along a level arm, by gravity where there are weights only, and
// by the mass of a coupler whose weight is shared like those of crank and rocker. In the world's units of the four-bar,
// a million metres from the origin, rounding leaves 1e-11 of them.
TEST(Sensitivity, OfWhatHasNoEffectIsZero) {
  struct Case {
    const char *scene, *of;
    std::vector<std::string> without;
  };
  for (const Case& c : {Case{"pendulum_a01.toml", "angle.arm", {"body.arm.center.x"}},
                        Case{"hard/far_four_bar.toml", "angle.crank", {"gravity.y", "body.coupler.mass"}},
                        Case{"redundant_parallelogram.toml", "force.spring", {"torsion_spring.spring.stiffness"}},
                        Case{"knee_press.toml", "angle.ram", {"point.ground.U.y", "point.upper.N.y", "load.P"}}}) {
    const StaticModel model(read_scene(dataset(c.scene)));
    const Sensitivities found = sensitivities(model, quantities(model.scene(), {c.of}));
    ASSERT_EQ(found.why, "") << c.scene;
    int with = 0;
    for (const Sensitivity& s : found.of.at(0).by) {
      const bool none = std::find(c.without.begin(), c.without.end(), s.number) != c.without.end();
      EXPECT_TRUE(!none || s.derivative == 0.0) << c.scene << " " << s.number << " " << s.derivative;
      with += s.derivative != 0.0 ? 1 : 0;
    }
    EXPECT_GT(with, 0) << c.scene;
  }
}

TEST(Sensitivity, NamesOfQuantitiesAreChecked) {
  const Scene scene = read_scene(dataset("toggle_clamp.toml"));
  for (const char* name : {"reaction.E", "reaction.B.z", "reaction.B.moment", "reaction.B.axial", "angle.hand",
                           "travel.B", "stop.close", "force.rub", "load_at_fold.Q", "angle.ground", "bogus", ""}) {
    EXPECT_THROW(find_quantity(scene, name), InputError) << name;
  }
  EXPECT_THROW(find_quantity(read_scene(dataset("hard/follower_arm.toml")), "energy"), InputError);
}

}  // namespace
}  // namespace poise::statics_sensitivity_test
