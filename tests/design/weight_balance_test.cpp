// Springs that balance weights: closed forms, random trees, and refutations that are checked by themselves.
#include "design/balance/weight_balance.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "design/balance/near_balance.hpp"
#include "solvers/random_stream.hpp"

namespace poise::weight_balance_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

FreeNumber number_of(const Scene& scene, const std::string& path, double min, double max) {
  return {path, parameter(scene, path).place, min, max};
}

BalanceProblem problem_of(Scene scene) {
  BalanceProblem out;
  out.file = "design.toml";
  out.scene = std::move(scene);
  return out;
}

// An arm upright at 0, on a spring from 0.3 m above its pivot to 0.1 m along it.
Scene arm(double free_length) {
  return parse_scene(fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0], S = [0, 0.3] }}
[body.arm]
points = {{ O = [0, 0], B = [0, 0.1] }}
mass = 1.2
center = [0, 0.5]
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
name = "s"
points = ["ground.S", "arm.B"]
stiffness = 10
free_length = {}
)",
                                 free_length),
                     "arm");
}

// An inner and an outer arm; the elbow block is kept level by a rod parallel to the inner arm and carries the hook of
// the outer spring.
Scene two_links(bool with_rod) {
  std::string text = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], Q = [0, 0.05], S = [0, 0.1] }
[body.inner]
points = { O = [0, 0], B = [0.2, 0], E = [0.4, 0] }
mass = 2
center = [0.2, 0]
[body.block]
points = { E = [0, 0], R = [0, 0.05], S = [0, 0.1] }
[body.outer]
points = { E = [0, 0], B = [0.15, 0], T = [0.3, 0] }
mass = 1.5
center = [0.15, 0]
[[pin]]
points = ["ground.O", "inner.O"]
[[pin]]
points = ["inner.E", "block.E"]
[[pin]]
points = ["block.E", "outer.E"]
[[force]]
at = "outer.T"
vector = [0, -4.905]
[[spring]]
name = "one"
points = ["ground.S", "inner.B"]
stiffness = 1
free_length = 0
[[spring]]
name = "two"
points = ["block.S", "outer.B"]
stiffness = 0
free_length = 0
[start]
inner = 0.5
outer = -0.3
)";
  if (with_rod) {
    text += R"(rod = 0.5
[body.rod]
points = { Q = [0, 0], R = [0.4, 0] }
[[pin]]
points = ["ground.Q", "rod.Q"]
[[pin]]
points = ["block.R", "rod.R"]
)";
  }
  return parse_scene(text, "arms");
}

TEST(WeightBalance, OneLinkHasItsClosedForm) {
  BalanceProblem problem = problem_of(arm(0.0));
  problem.stiffnesses = {number_of(problem.scene, "spring.s.stiffness", 0.0, 1000.0)};
  const WeightBalance found = balance_weights(problem);
  ASSERT_TRUE(found.balanced);
  EXPECT_NEAR(found.found[0], 196.2, 196.2e-14);
  EXPECT_LT(found.check.imbalance, 1e-12 * found.check.weight);
}

TEST(WeightBalance, ParallelogramKeepsTheElbowUpright) {
  BalanceProblem problem = problem_of(two_links(true));
  problem.stiffnesses = {number_of(problem.scene, "spring.one.stiffness", 0.0, 1000.0),
                         number_of(problem.scene, "spring.two.stiffness", 0.0, 1000.0)};
  const WeightBalance found = balance_weights(problem);
  ASSERT_TRUE(found.balanced);
  EXPECT_EQ(found.parallelograms, 1);
  EXPECT_NEAR(found.found[0], 588.6, 588.6e-13);
  EXPECT_NEAR(found.found[1], 245.25, 245.25e-13);
  EXPECT_EQ(found.check.poses, 100);
  EXPECT_LT(found.check.imbalance, 1e-12 * found.check.weight);
}

TEST(WeightBalance, WithoutTheRodTheBlockTurnsUnderItsSpring) {
  BalanceProblem problem = problem_of(two_links(false));
  problem.stiffnesses = {number_of(problem.scene, "spring.one.stiffness", 0.0, 1000.0),
                         number_of(problem.scene, "spring.two.stiffness", 0.0, 1000.0)};
  const WeightBalance found = balance_weights(problem);
  EXPECT_FALSE(found.balanced);
  EXPECT_TRUE(found.refuted);
  ASSERT_GE(found.row, 0);
  EXPECT_EQ(found.terms[found.row].name, "sin(outer)");
}

TEST(WeightBalance, FreeLengthLeavesABoundedTorque) {
  // The stiffness fixed at that of free length zero: the torque left is k L0 b at most, where cos = 1/3.
  BalanceProblem problem = problem_of(arm(0.02));
  problem.stiffnesses = {number_of(problem.scene, "spring.s.stiffness", 196.2, 196.2)};
  problem.over = {{*find_measure(problem.scene, "angle.arm"), -std::numbers::pi, std::numbers::pi}};
  const NearBalance found = balance_nearly(problem);
  ASSERT_TRUE(found.solved);
  EXPECT_NEAR(found.upper, 0.3924, 1e-7);
  EXPECT_GE(found.upper, 0.3924 * (1 - 1e-15));
  EXPECT_LE(found.lower, 0.3924 * (1 + 1e-15));
  EXPECT_GT(found.lower, 0.3924 * (1 - 1e-6));
  EXPECT_NEAR(std::abs(found.at[0]), 70.5287794 * degree, 1e-3);
}

// The least largest torque of a stiffness that is sought: a fine scan of stiffnesses and angles finds none below the
// lower bound, and the one found does not pass the upper bound.
TEST(WeightBalance, FreeLengthHasALeastLargestTorque) {
  BalanceProblem problem = problem_of(arm(0.05));
  problem.stiffnesses = {number_of(problem.scene, "spring.s.stiffness", 0.0, 1000.0)};
  problem.over = {{*find_measure(problem.scene, "angle.arm"), -100 * degree, 80 * degree}};
  const NearBalance found = balance_nearly(problem);
  ASSERT_TRUE(found.solved);
  EXPECT_LT(found.upper - found.lower, 1e-6 * found.upper);
  const auto largest = [](double k) {
    double out = 0.0;
    for (int i = 0; i <= 1800; ++i) {
      // The arm is upright at 0: l = |(0, 0.3) - 0.1 (-sin, cos)|, dl/d angle = 0.3 0.1 sin / l.
      const double angle = (-100 + 0.1 * i) * degree;
      const double l = std::sqrt(0.1 - 2 * 0.3 * 0.1 * std::cos(angle));
      const double torque = 1.2 * 9.81 * 0.5 * std::sin(angle) - k * (l - 0.05) * 0.03 * std::sin(angle) / l;
      out = std::max(out, std::abs(torque));
    }
    return out;
  };
  EXPECT_LE(largest(found.found[0]), found.upper);
  EXPECT_GT(largest(found.found[0]), found.upper * (1 - 1e-4));
  for (int k = 0; k <= 1000; ++k) EXPECT_GE(largest(k), found.lower * (1 - 1e-4)) << k;
}

// A four-bar whose crank and rocker hang on springs: its closure turns the coupler's weight into terms of theirs, and
// the hooks find their places.
TEST(WeightBalance, ClosuresCarryTheCouplersWeight) {
  BalanceProblem problem = problem_of(parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { A = [0, 0], D = [4, 1], S = [0, 0], T = [0, 0] }
[body.crank]
points = { A = [0, 0], B = [2, 0], E = [0.5, 0] }
mass = 2
center = [1, 0.2]
[body.coupler]
points = { B = [0, 0], C = [3.5, 0] }
mass = 3.5
center = [1.5, 0.4]
[body.rocker]
points = { D = [0, 0], C = [3, 0], E = [1, 0] }
mass = 3
center = [1.5, 0]
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "coupler.B"]
[[pin]]
points = ["coupler.C", "rocker.C"]
[[pin]]
points = ["ground.D", "rocker.D"]
[[spring]]
name = "s"
points = ["ground.S", "crank.E"]
stiffness = 1
free_length = 0
[[spring]]
name = "t"
points = ["ground.T", "rocker.E"]
stiffness = 1
free_length = 0
[start]
crank = -1.4
coupler = -0.3
rocker = -1.6
)",
                                                  "four-bar"));
  problem.stiffnesses = {number_of(problem.scene, "spring.s.stiffness", 0.0, 1000.0),
                         number_of(problem.scene, "spring.t.stiffness", 0.0, 1000.0)};
  for (const char* path : {"point.ground.S.x", "point.ground.S.y"}) {
    problem.coordinates.push_back(number_of(problem.scene, path, -1.5, 1.5));
  }
  const WeightBalance fixed = balance_weights(problem);
  EXPECT_FALSE(fixed.balanced);
  EXPECT_TRUE(fixed.complete);
  for (const char* path : {"point.ground.T.x", "point.ground.T.y"}) {
    problem.coordinates.push_back(number_of(problem.scene, path, 2.0, 6.0));
  }
  const WeightBalance found = balance_weights(problem);
  ASSERT_TRUE(found.balanced) << found.residual << " " << found.refuted << " " << found.row;
  EXPECT_GT(found.relations, 0);
  EXPECT_GT(found.check.poses, 50);
  EXPECT_LT(found.check.imbalance, 1e-12 * found.check.weight);
}

// An open tree of arms with springs to the ground, described by complex numbers alone: a point of body j is the sum of
// the pins of its ancestors and b, each times the direction z of its body. The energy of a spring k/2 |p - a|^2 has
//   -k conj(a) l_i z_i  for each part l_i z_i of p,  and  k conj(l_i) l_j conj(z_i) z_j  for each two parts.
struct RandomTree {
  using Complex = std::complex<double>;
  static constexpr double g = 9.81;
  struct Arm {
    int parent = -1;
    Complex pin;  // in the parent's frame
    double mass = 0.0;
    Complex first;  // mass times centre
  };
  struct Spring {
    int body = 0;
    Complex hook, at;
    double stiffness = 0.0;
  };
  std::vector<Arm> arms;
  std::vector<Spring> springs;

  // Coefficients of z_i in a point of a body.
  std::vector<Complex> parts(int body, Complex b) const {
    std::vector<Complex> out(arms.size());
    out[body] = b;
    for (int j = body; arms[j].parent >= 0; j = arms[j].parent) out[arms[j].parent] = arms[j].pin;
    return out;
  }
  Complex origin(int body) const {
    while (arms[body].parent >= 0) body = arms[body].parent;
    return arms[body].pin;
  }
  // Energy per stiffness of a spring: coefficients Re(c z_i), and Re(c conj(z_i) z_j) at (i, j), i < j.
  std::map<std::pair<int, int>, Complex> of_spring(const Spring& s) const {
    std::map<std::pair<int, int>, Complex> out;
    const std::vector<Complex> l = parts(s.body, s.at);
    const int n = static_cast<int>(l.size());
    for (int i = 0; i < n; ++i) {
      out[{i, i}] += std::conj(origin(s.body) - s.hook) * l[i];
      for (int j = i + 1; j < n; ++j) out[{i, j}] += std::conj(l[i]) * l[j];
    }
    return out;
  }
  std::map<std::pair<int, int>, Complex> of_weights() const {
    std::map<std::pair<int, int>, Complex> out;
    for (std::size_t b = 0; b < arms.size(); ++b) {
      const std::vector<Complex> l = parts(static_cast<int>(b), arms[b].first / arms[b].mass);
      // m g Im(p) = Re(-i m g p).
      for (std::size_t i = 0; i < l.size(); ++i) {
        out[{static_cast<int>(i), static_cast<int>(i)}] += Complex(0.0, -g * arms[b].mass) * l[i];
      }
    }
    return out;
  }

  std::string text() const {
    std::string ground = "O = [0, 0]", out = "gravity = [0, -9.81]\n[ground]\npoints = { ";
    std::vector<std::string> points(arms.size(), "O = [0, 0]");
    const auto at = [](Complex c) { return fmt::format("[{:.17g}, {:.17g}]", c.real(), c.imag()); };
    for (std::size_t b = 0; b < arms.size(); ++b) {
      std::string& of = arms[b].parent < 0 ? ground : points[arms[b].parent];
      of += fmt::format(", P{} = {}", b, at(arms[b].pin));
    }
    for (std::size_t s = 0; s < springs.size(); ++s) {
      ground += fmt::format(", S{} = {}", s, at(springs[s].hook));
      points[springs[s].body] += fmt::format(", S{} = {}", s, at(springs[s].at));
    }
    out += ground + " }\n";
    for (std::size_t b = 0; b < arms.size(); ++b) {
      out += fmt::format("[body.b{}]\npoints = {{ {} }}\nmass = {:.17g}\ncenter = {}\n", b, points[b], arms[b].mass,
                         at(arms[b].first / arms[b].mass));
    }
    for (std::size_t b = 0; b < arms.size(); ++b) {
      const std::string parent = arms[b].parent < 0 ? "ground" : fmt::format("b{}", arms[b].parent);
      out += fmt::format("[[pin]]\npoints = [\"{}.P{}\", \"b{}.O\"]\n", parent, b, b);
    }
    for (std::size_t s = 0; s < springs.size(); ++s) {
      out += fmt::format(
          "[[spring]]\nname = \"s{}\"\npoints = [\"ground.S{}\", \"b{}.S{}\"]\nstiffness = 1\nfree_length = 0\n", s, s,
          springs[s].body, s);
    }
    return out;
  }
};

// A tree that its springs balance: products of directions vanish where for each body that is not on the ground the sum
// of k b over its springs, and of all stiffnesses behind a pin times that, is zero, which one more spring brings about;
// the centres of mass then follow from the forces of the springs.
RandomTree balanced_tree(std::uint64_t index) {
  using Complex = RandomTree::Complex;
  solvers::RandomStream random(5, 0, index);
  const auto around = [&] {
    const double y = random.uniform(-1.0, 1.0), x = random.uniform(-1.0, 1.0);
    return Complex(x, y);
  };
  RandomTree out;
  const int n = 1 + static_cast<int>(4 * random.uniform());
  for (int b = 0; b < n; ++b) {
    const int parent = static_cast<int>((b + 1) * random.uniform()) - 1;
    out.arms.push_back({parent, around(), random.uniform(0.5, 2.0), {}});
  }
  std::vector<double> behind(static_cast<std::size_t>(n), 0.0);
  for (int b = n - 1; b >= 0; --b) {
    Complex sum{};
    const auto add = [&](Complex at, double k) {
      out.springs.push_back({b, 2.0 * around(), at, k});
      sum += k * at;
      behind[b] += k;
    };
    for (int s = 0; s < 2; ++s) {
      const double stiffness = random.uniform(5.0, 20.0);
      add(around(), stiffness);
    }
    for (int c = b + 1; c < n; ++c) {
      if (out.arms[c].parent != b) continue;
      sum += behind[c] * out.arms[c].pin;
      behind[b] += behind[c];
    }
    if (out.arms[b].parent < 0) continue;
    const double k = random.uniform(10.0, 40.0);
    add(-sum / k, k);
  }
  // m_b c_b i g makes up what is left of z_b, the masses behind the pins included.
  for (RandomTree::Arm& arm : out.arms) arm.first = {};
  auto left = out.of_weights();
  for (const RandomTree::Spring& s : out.springs) {
    for (const auto& [at, c] : out.of_spring(s)) left[at] += s.stiffness * c;
  }
  for (int b = 0; b < n; ++b) out.arms[b].first = left[{b, b}] / Complex(0.0, RandomTree::g);
  return out;
}

BalanceProblem forgotten(const RandomTree& tree, double greatest) {
  BalanceProblem out = problem_of(parse_scene(tree.text(), "tree"));
  for (std::size_t s = 0; s < tree.springs.size(); ++s) {
    out.stiffnesses.push_back(number_of(out.scene, fmt::format("spring.s{}.stiffness", s), 0.0, greatest));
  }
  return out;
}

TEST(WeightBalance, RandomTreesAreBalancedAgain) {
  for (std::uint64_t index = 0; index < 200; ++index) {
    const RandomTree tree = balanced_tree(index);
    const WeightBalance found = balance_weights(forgotten(tree, 1000.0));
    ASSERT_TRUE(found.balanced) << index << " " << found.residual << "\n" << tree.text();
    EXPECT_LT(found.residual, 1e-12) << index;
    EXPECT_LT(found.check.imbalance, 1e-12 * found.check.weight) << index;
    double least = 0.0, planted = 0.0;
    for (std::size_t s = 0; s < tree.springs.size(); ++s) {
      least += found.found[s];
      planted += tree.springs[s].stiffness;
    }
    EXPECT_LE(least, planted * (1 + 1e-9)) << index;
  }
}

// Without one of its springs, or with too soft ones, a tree is not balanced. The terms, their multipliers and what the
// springs give are compared with the complex numbers above, and the sum that the multipliers make cannot vanish.
TEST(WeightBalance, RefutationsOfRandomTreesHold) {
  int refuted = 0, several = 0;
  for (std::uint64_t index = 1000; refuted < 100; ++index) {
    ASSERT_LT(index, 1400u);
    RandomTree tree = balanced_tree(index);
    const double greatest = index % 3 == 0 ? 8.0 : 1000.0;
    if (index % 3 != 0) tree.springs.pop_back();
    const WeightBalance found = balance_weights(forgotten(tree, greatest));
    if (found.balanced) continue;
    ++refuted;
    ASSERT_TRUE(found.refuted) << index;
    if (found.row < 0) ++several;
    const auto coefficient = [](const std::map<std::pair<int, int>, RandomTree::Complex>& of, const std::string& name) {
      int i = -1, j = -1;
      const bool is_sine = name[0] == 's';
      if (std::sscanf(name.c_str() + 3, "(b%d - b%d)", &i, &j) < 2) j = i;
      const auto at = of.find({i, j});
      const RandomTree::Complex c = at == of.end() ? RandomTree::Complex{} : at->second;
      // Re(c z) = Re c cos - Im c sin; of conj(z_i) z_j the angle is the opposite of the difference in the name.
      return is_sine ? (i == j ? -1.0 : 1.0) * c.imag() : c.real();
    };
    double sum = 0.0, size = 0.0;
    std::vector<double> by(tree.springs.size(), 0.0);
    for (const EnergyTerm& term : found.terms) {
      const double weights = coefficient(tree.of_weights(), term.name);
      EXPECT_NEAR(term.weights, weights, 1e-9) << index << term.name;
      sum += term.multiplier * weights;
      size += std::abs(term.multiplier * weights);
      for (std::size_t s = 0; s < by.size(); ++s) {
        by[s] += term.multiplier * coefficient(tree.of_spring(tree.springs[s]), term.name);
      }
    }
    // The most that springs can add to the opposite of what the weights have.
    double most = 0.0;
    for (const double one : by) most += greatest * std::max(0.0, one);
    EXPECT_LT(most, -sum - 1e-9 * size) << index;
  }
  EXPECT_GT(several, 5);
}

}  // namespace
}  // namespace poise::weight_balance_test
