// Scenes of which one number varies, and their compiled form with derivatives by the number.

#include "statics/model/varied_scene.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "statics/paths/varied_mechanism.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::varied_scene_test {
namespace {

std::string refusal(const Scene& scene, const std::string& name, double from, double to) {
  try {
    const VariedScene varied(scene, name, from, to);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(VariedScene, RefusesWhatCannotVary) {
  const Scene scene = read_scene(test::dataset("toggle_clamp.toml"));
  EXPECT_EQ(refusal(scene, "load.Q", 0, 1),
            "load.Q: expected the path of a number of the scene; did you mean \"load.P\"?");
  EXPECT_EQ(refusal(scene, "load.P", 3, 3), "load.P: the range 3..3 has no length; expected two different values");
  EXPECT_EQ(refusal(scene, "spring.rubber.stiffness", -1, 3),
            "spring.rubber.stiffness: expected a finite number >= 0, found -1");
  EXPECT_EQ(refusal(scene, "angle.handel", 0, 1),
            "angle.handel: expected the name of a body; did you mean \"handle\"?");
  EXPECT_NE(refusal(scene, "travel.A", 0, 1).find("expected the name of a slide or a pin in a slot"),
            std::string::npos);
  EXPECT_NE(refusal(scene, "start.arm", 0, 1).find("equilibrium does not depend on it"), std::string::npos);
  EXPECT_NE(refusal(read_scene(test::dataset("four_bar_gravity.toml")), "loads", 0, 1).find("the scene has no loads"),
            std::string::npos);
  EXPECT_EQ(refusal(scene, "stop.open.min", -5, 40), "stop.open.min: expected min <= max; set the other limit first");
  EXPECT_NE(refusal(scene, "load.P", 0, NAN).find("expected a finite number"), std::string::npos);
}

TEST(VariedScene, ReversesForcesAndScalesAllLoads) {
  const Scene scene = read_scene(test::dataset("toggle_clamp.toml"));
  const VariedScene load(scene, "load.P", -10, 10);
  EXPECT_EQ(load.scene_at(-4.0).forces[0].vector, (Vec2{0, -4}));
  const VariedScene all(scene, "loads", 0, 2);
  EXPECT_EQ(all.scene_at(1.5).forces[0].vector, (Vec2{0, 37.5}));
  EXPECT_EQ(all.unit_name(), "");
}

// A chain that carries nothing but one force is the same chain where the force is zero.
TEST(VariedScene, KeepsCoordinatesWhereTheNumberVanishes) {
  Scene scene = test::chain(3, 1.0, 0.0);
  test::add_force(scene, "3.b", {1, 0}, "P");
  const VariedScene varied(scene, "load.P", 0, 2);
  EXPECT_EQ(varied.model_at(0.0)->mechanism().coordinates(), 3);
  EXPECT_EQ(varied.model_at(2.0)->mechanism().coordinates(), 3);
}

// Values of a problem at one point, its sparse parts as full matrices.
struct Whole {
  std::vector<double> force, measures, jacobian, tangent, lower, upper;
};

std::vector<double> filled(int rows, int columns, const std::vector<int>& row, const std::vector<int>& column,
                           const double* values) {
  std::vector<double> out(static_cast<std::size_t>(rows * columns), 0.0);
  for (std::size_t e = 0; e < row.size(); ++e) out[static_cast<std::size_t>(row[e] * columns + column[e])] += values[e];
  return out;
}

Whole whole(VariedMechanism& m, const std::vector<double>& x, const std::vector<double>& y, double p) {
  std::vector<double> values(m.values()), tangent(m.tangent_pattern().size());
  m.evaluate(x, p, values, {});
  m.tangent(x, p, y, tangent);
  const auto part = [&](int first, int count) {
    return std::vector<double>(values.begin() + first, values.begin() + first + count);
  };
  const solvers::Pattern &of_j = m.jacobian_pattern(), &of_k = m.tangent_pattern();
  return {part(0, m.variables()),
          part(m.first_row(), m.rows()),
          filled(m.rows(), m.variables(), of_j.row, of_j.column, values.data() + m.first_entry()),
          filled(m.variables(), m.variables(), of_k.row, of_k.column, tangent.data()),
          part(m.first_lower(), m.inequalities()),
          part(m.first_upper(), m.inequalities())};
}

Whole whole(const Mechanism<double>& m, const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> g(m.coordinates()), c(m.constraints()), j(m.jacobian_row().size()), k(m.tangent_row().size());
  m.place(x.data(), pose.data());
  m.negative_force(x.data(), pose.data(), g.data());
  m.constraint(x.data(), pose.data(), c.data());
  m.jacobian(pose.data(), j.data());
  m.tangent(pose.data(), y.data(), k.data());
  return {g,
          c,
          filled(m.constraints(), m.coordinates(), m.jacobian_row(), m.jacobian_column(), j.data()),
          filled(m.coordinates(), m.coordinates(), m.tangent_row(), m.tangent_column(), k.data()),
          m.lower(),
          m.upper()};
}

// Those that the model has too: stops of one-way springs come behind.
void expect_same(const std::vector<double>& of, const std::vector<double>& model, const std::string& what) {
  ASSERT_GE(of.size(), model.size()) << what;
  double most = 1.0;
  for (const double one : model) {
    if (std::isfinite(one)) most = std::max(most, std::abs(one));
  }
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (of[i] == model[i]) continue;  // infinite limits
    ASSERT_NEAR(of[i], model[i], 1e-11 * most) << what << " " << i;
  }
}

struct Compared {
  int scenes = 0, values = 0;
};

void compare_with_scenes(const Scene& scene, const std::string& name, double from, double to,
                         comparison::Random& random, Compared& compared) {
  if (!refusal(scene, name, from, to).empty()) return;
  const VariedScene varied(scene, name, from, to);
  const std::vector<int> one_way = VariedMechanism::one_way_springs(varied.scene());
  const std::string what = scene.title + " " + name;
  ++compared.scenes;
  for (const double p : {0.0, 0.37, 1.0}) {
    std::unique_ptr<StaticModel> model;
    try {
      model = varied.model_at(varied.value_at(p));
    } catch (const InputError&) {
      continue;  // angles that contradict each other there
    }
    const Mechanism<double>& at = model->mechanism();
    std::vector<double> x = model->start(), y(at.constraints() + one_way.size(), 0.0);
    for (double& one : x) one += random.uniform(-0.05, 0.05);
    for (int r = 0; r < at.constraints(); ++r) y[r] = random.uniform(-1.0, 1.0);
    std::vector<char> acts(one_way.size(), 1);
    VariedMechanism both(varied, acts);
    if (both.variables() != at.coordinates()) continue;  // a spring of no stiffness moves nothing
    const Whole there = whole(both, x, y, p);
    for (std::size_t k = 0; k < acts.size(); ++k) {
      const std::size_t row = there.measures.size() - acts.size() + k, limit = there.lower.size() - acts.size() + k;
      const bool is_long = there.measures[row] > there.lower[limit];
      const auto& spring = std::get<LinearSpring>(scene.elements[one_way[k]].law);
      acts[k] = is_long == (spring.acts == LinearSpring::Acts::tension) ? 1 : 0;
    }
    VariedMechanism piece(varied, acts);
    const Whole of = whole(piece, x, y, p), expected = whole(at, x, y);
    expect_same(of.force, expected.force, what + ": force");
    expect_same(of.measures, expected.measures, what + ": measures");
    expect_same(of.jacobian, expected.jacobian, what + ": Jacobian");
    expect_same(of.tangent, expected.tangent, what + ": tangent");
    expect_same(of.lower, expected.lower, what + ": lower limits");
    expect_same(of.upper, expected.upper, what + ": upper limits");
    if (testing::Test::HasFatalFailure()) return;
    ++compared.values;
  }
}

// Over a range from the value of the scene, one to zero, and one from there.
void compare_all(const Scene& scene, comparison::Random& random, Compared& compared) {
  for (const ParameterRow& row : parameter_table(scene)) {
    const Owner owner = row.place.owner;
    if (owner == Owner::start || owner == Owner::drive || owner == Owner::time) continue;
    const auto si = value_at(scene, row.place);
    if (!si || !std::isfinite(*si)) continue;
    const std::string name = row.path.text();
    const double value = get_value(scene, name), other = value == 0.0 ? 0.1 : 1.2 * value;
    compare_with_scenes(scene, name, value, other, random, compared);
    if (value != 0.0) compare_with_scenes(scene, name, value, 0.0, random, compared);
    compare_with_scenes(scene, name, 0.0, other, random, compared);
    if (testing::Test::HasFatalFailure()) return;
  }
  if (!scene.forces.empty()) compare_with_scenes(scene, "loads", -0.5, 1.5, random, compared);
}

// What is evaluated from a list of numbers is the scene with each of them.
TEST(VariedMechanism, IsThatOfTheSceneAtEveryValue) {
  comparison::Random random(20261128);
  Compared compared;
  for (const std::string& name : test::scene_names()) {
    const Scene scene = at_time(read_scene(test::dataset(name)), 0.0);
    if (scene.bodies.size() > 30) continue;
    compare_all(scene, random, compared);
    if (HasFatalFailure()) return;
  }
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3),
                          .followers = seed % 4 == 0,
                          .stops = seed % 2 == 0,
                          .other_laws = seed % 3 == 0,
                          .couplings = seed > 12};
    compare_all(test::plant_mechanism(seed, wish).in_equilibrium, random, compared);
    if (HasFatalFailure()) return;
  }
  EXPECT_GE(compared.scenes, 1000);
  EXPECT_GE(compared.values, 3000);
}

// Evaluations of a mechanism at (x + e u, y + e v, p + e w), for differences by e.
struct Sampled {
  std::vector<double> values, by_p, tangent;
};

Sampled sample(VariedMechanism& m, const std::vector<double>& x, const std::vector<double>& y, double p) {
  Sampled out;
  out.values.resize(m.values());
  out.by_p.resize(m.values());
  out.tangent.resize(m.tangent_pattern().size());
  m.evaluate(x, p, out.values, out.by_p);
  m.tangent(x, p, y, out.tangent);
  return out;
}

std::vector<double> moved(std::vector<double> a, const std::vector<double>& b, double e) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += e * b[i];
  return a;
}

// Difference of fourth order; infinite bounds have none.
std::vector<double> slope(const std::vector<double> at[4], double h) {
  std::vector<double> out(at[0].size(), 0.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::isfinite(at[0][i])) out[i] = (at[0][i] - 8 * at[1][i] + 8 * at[2][i] - at[3][i]) / (12 * h);
  }
  return out;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance,
                 const std::string& what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double value = std::isfinite(a[i]) ? a[i] : 0.0;
    ASSERT_NEAR(value, b[i], tolerance * (1 + std::abs(b[i]))) << what << " " << i;
  }
}

void check_derivatives(const Scene& scene, const std::string& name, comparison::Random& random) {
  const double value = get_value(scene, name);
  if (value == 0.0 || !refusal(scene, name, value, 1.3 * value).empty()) return;
  const VariedScene varied(scene, name, value, 1.3 * value);
  const std::vector<int> one_way = VariedMechanism::one_way_springs(scene);
  VariedMechanism m(varied, std::vector<char>(one_way.size(), 1));
  const auto model = varied.model_at(value);
  const auto drawn = [&](int count) {
    std::vector<double> out(count);
    for (double& v : out) v = random.uniform(-1.0, 1.0);
    return out;
  };
  const std::vector<double> x = moved(model->start(), drawn(m.variables()), 0.01);
  const std::vector<double> y = drawn(m.rows()), u = drawn(m.variables()), v = drawn(m.rows());
  const double p = 0.4, w = 0.7, h = 2e-4;
  std::vector<double> values[4], by_p[4], tangent[4], values_of_p[4];
  for (int k = 0; k < 4; ++k) {
    const double e = (k < 2 ? k - 2 : k - 1) * h;
    const Sampled along = sample(m, moved(x, u, e), moved(y, v, e), p + e * w);
    values[k] = along.values;
    by_p[k] = along.by_p;
    tangent[k] = along.tangent;
    values_of_p[k] = sample(m, x, y, p + e).values;
  }
  const Sampled here = sample(m, x, y, p);
  const std::string what = scene.title + " " + name;
  expect_near(here.by_p, slope(values_of_p, h), 1e-8, what + ": by p");
  std::vector<double> d_values(m.values()), d_by_p(m.values()), d_tangent(here.tangent.size());
  m.change(x, p, y, u, v, w, d_values, d_by_p, d_tangent);
  expect_near(d_values, slope(values, h), 1e-8, what + ": values");
  expect_near(d_by_p, slope(by_p, h), 1e-8, what + ": by p, along");
  expect_near(d_tangent, slope(tangent, h), 1e-8, what + ": tangent");
}

// Every number of random mechanisms, by differences.
TEST(VariedMechanism, HasTheDerivativesOfItsValues) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const test::Wish wish{.loops = static_cast<int>(seed % 3),
                          .followers = seed % 4 == 0,
                          .stops = seed % 2 == 0,
                          .couplings = seed > 12};
    const Scene scene = test::plant_mechanism(seed, wish).in_equilibrium;
    comparison::Random random(seed);
    for (const ParameterRow& row : parameter_table(scene)) {
      const Owner owner = row.place.owner;
      if (owner == Owner::start || owner == Owner::drive) continue;
      const auto value = value_at(scene, row.place);
      if (!value || !std::isfinite(*value)) continue;
      check_derivatives(scene, row.path.text(), random);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace poise::varied_scene_test
