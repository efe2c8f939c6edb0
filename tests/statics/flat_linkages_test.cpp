// Sets of equilibria of four-bars whose links fold flat, with springs and weights: where branches of motion cross, and
// elsewhere. The judge walks along each branch in closed form.

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "statics/all_equilibria/all_equilibria.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/random_mechanism.hpp"
#include "tests/support/seed.hpp"

namespace poise::flat_linkages_test {
namespace {

using Complex = std::complex<double>;
using Angles = std::array<double, 3>;  // of crank, coupler and rocker

constexpr const char* names[] = {"crank", "coupler", "rocker"};

double cross(const Complex& a, const Complex& b) { return std::imag(std::conj(a) * b); }

/// a e^(i crank) + b e^(i coupler) = ground + c e^(i rocker), with springs from the ground to points of the links and
/// weights on them.
struct FourBar {
  struct Spring {
    int body;
    Complex end, at;  // on the ground, in the body's frame
    double stiffness, free_length;
  };

  std::string kind;
  double a = 0.0, b = 0.0, c = 0.0;
  Complex ground;
  std::vector<Spring> springs;
  std::array<double, 3> mass{};  // at the middle of each
  Angles start{};

  double length(int body) const { return body == 0 ? a : body == 1 ? b : c; }
  double scale() const {
    double sum = 9.81 * (mass[0] + mass[1] + mass[2]);
    for (const Spring& spring : springs) sum += spring.stiffness * (a + b + c);
    return sum * (a + b + c);
  }

  std::string text() const {
    std::string out = mass[0] + mass[1] + mass[2] > 0 ? "gravity = [0, -9.81]\n" : "";
    out += fmt::format("[ground]\npoints = {{ A = [0, 0], D = [{}, {}]", ground.real(), ground.imag());
    for (std::size_t k = 0; k < springs.size(); ++k) {
      out += fmt::format(", S{} = [{}, {}]", k, springs[k].end.real(), springs[k].end.imag());
    }
    out += " }\n";
    for (int body = 0; body < 3; ++body) {
      out += fmt::format("[body.{}]\npoints = {{ near = [0, 0], far = [{}, 0]", names[body], length(body));
      for (std::size_t k = 0; k < springs.size(); ++k) {
        if (springs[k].body != body) continue;
        out += fmt::format(", P{} = [{}, {}]", k, springs[k].at.real(), springs[k].at.imag());
      }
      out += fmt::format(" }}\nmass = {}\ncenter = [{}, 0]\n", mass[static_cast<std::size_t>(body)], length(body) / 2);
    }
    for (const auto& [from, to] : {std::pair("ground.A", "crank.near"), std::pair("crank.far", "coupler.near"),
                                   std::pair("coupler.far", "rocker.far"), std::pair("ground.D", "rocker.near")}) {
      out += fmt::format("[[pin]]\npoints = [\"{}\", \"{}\"]\n", from, to);
    }
    for (std::size_t k = 0; k < springs.size(); ++k) {
      const Spring& spring = springs[k];
      out += fmt::format("[[spring]]\npoints = [\"ground.S{}\", \"{}.P{}\"]\nstiffness = {}\nfree_length = {}\n", k,
                         names[spring.body], k, spring.stiffness, spring.free_length);
    }
    out += "[start]\n";
    for (std::size_t i = 0; i < 3; ++i) out += fmt::format("{} = {:.17g}\n", names[i], start[i]);
    return out;
  }

  double gap(const Angles& q) const {
    return std::abs(std::polar(a, q[0]) + std::polar(b, q[1]) - ground - std::polar(c, q[2]));
  }

  /// dV/dq, N m.
  Angles force(const Angles& q) const {
    const Complex origin[] = {0.0, std::polar(a, q[0]), ground};
    Angles out{};
    // A force on a body, of which the coupler's acts on the crank too.
    const auto add = [&](std::size_t body, const Complex& arm, const Complex& slope) {
      out[body] += cross(arm, slope);
      if (body == 1) out[0] += cross(origin[1], slope);
    };
    for (const Spring& spring : springs) {
      const auto body = static_cast<std::size_t>(spring.body);
      const Complex arm = spring.at * std::polar(1.0, q[body]);
      const Complex along = origin[body] + arm - spring.end;
      add(body, arm, spring.stiffness * (1.0 - spring.free_length / std::abs(along)) * along);
    }
    for (std::size_t body = 0; body < 3; ++body) {
      add(body, std::polar(0.5 * length(static_cast<int>(body)), q[body]), Complex(0, 9.81 * mass[body]));
    }
    return out;
  }

  /// Rates of a motion that keeps it closed, zero at change points.
  Angles motion(const Angles& q) const {
    return {std::sin(q[1] - q[2]) / a, std::sin(q[2] - q[0]) / b, std::sin(q[1] - q[0]) / c};
  }

  /// The pose in which the crank, or the rocker, has that angle, on one of both sides.
  std::optional<Angles> pose(bool by_crank, double angle, double side) const {
    const Complex from = by_crank ? std::polar(a, angle) : ground + std::polar(c, angle);
    const Complex to = by_crank ? ground : Complex(0);
    const double first = b;
    const double second = by_crank ? c : a;
    const double apart = std::abs(to - from);
    const double x = (first * first - second * second + apart * apart) / (2 * apart);
    if (!(std::abs(x) <= first)) return std::nullopt;
    const Complex joint = from + (to - from) / apart * Complex(x, side * std::sqrt(first * first - x * x));
    if (by_crank) return Angles{angle, std::arg(joint - from), std::arg(joint - to)};
    return Angles{std::arg(joint), std::arg(from - joint), angle};
  }
};

double size_of(const Angles& v) { return std::hypot(v[0], v[1], v[2]); }
double dot(const Angles& v, const Angles& w) { return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]; }

double distance(const Angles& v, const std::vector<double>& x) {
  double most = 0.0;
  for (std::size_t i = 0; i < 3; ++i) most = std::max(most, std::abs(std::remainder(v[i] - x[i], 2 * M_PI)));
  return most;
}

FourBar random_four_bar(std::uint64_t seed) {
  test::Random random(seed);
  const auto rounded = [&](double low, double high) { return std::round(100 * random.uniform(low, high)) / 100; };
  FourBar out;
  double g = rounded(0.5, 1.5);
  out.a = rounded(0.3, 1.0);
  switch (random.index(4)) {
    case 0:
      out.kind = "parallelogram";
      out.b = g;
      out.c = out.a;
      break;
    case 1:
      out.kind = "rhombus";
      g = out.b = out.c = out.a;
      break;
    case 2:
      out.kind = "kite";
      out.b = out.c = out.a;
      (random.chance(0.5) ? out.a : out.c) = g;
      break;
    default:
      out.kind = "flat four-bar";
      do {
        out.b = rounded(0.3, 1.2);
        const double rockers[] = {g + out.a - out.b, g + out.b - out.a, out.a + out.b - g};
        out.c = std::round(100 * rockers[random.index(3)]) / 100;
      } while (!(out.c > 0.15));
  }
  // Along x, or where lengths are decimal numbers too.
  const Complex along = random.chance(0.5) ? Complex(1, 0) : Complex(0.6, -0.8);
  out.ground = g * along;
  const bool is_in_line = random.chance(0.3);
  const int springs = 1 + random.index(3);
  for (int k = 0; k < springs; ++k) {
    // On the coupler one at least, so that nothing turns freely.
    const int body = k == 0 ? 1 : random.index(3);
    const double far = out.length(body);
    const double beside = is_in_line ? 0.0 : rounded(-1.0, 1.0);
    const Complex end = is_in_line ? rounded(-1.0, 2.0) * along : Complex(rounded(-0.5, 1.5), beside);
    const double across = is_in_line || random.chance(0.5) ? 0.0 : rounded(-0.3, 0.3);
    const Complex at(rounded(0.1, far), across);
    out.springs.push_back({body, end, at, std::round(random.uniform(20, 200)), rounded(0.1, 0.9)});
  }
  if (!is_in_line && random.chance(0.5)) out.mass[static_cast<std::size_t>(random.index(3))] = 1.0;
  for (;;) {
    const int elbow = random.chance(0.5) ? 1 : -1;
    const auto start = out.pose(true, random.uniform(-M_PI, M_PI), elbow);
    if (!start) continue;
    out.start = *start;
    return out;
  }
}

/// Equilibria with a motion, away from change points: where the work along a branch changes its sign.
std::vector<Angles> rests_along_branches(const FourBar& bars) {
  constexpr int steps = 8'000;
  constexpr double next_to_crossing = 1e-4;
  std::vector<Angles> out;
  for (const bool by_crank : {true, false}) {
    for (const double side : {1.0, -1.0}) {
      const auto slope = [&](double angle) -> std::optional<double> {
        const auto q = bars.pose(by_crank, angle, side);
        if (!q) return std::nullopt;
        const Angles t = bars.motion(*q);
        return dot(bars.force(*q), t) / t[by_crank ? 0 : 2];
      };
      for (int k = 0; k < steps; ++k) {
        double below = 2 * M_PI * (k + 0.371) / steps;
        double above = 2 * M_PI * (k + 1.371) / steps;
        auto low = slope(below);
        const auto high = slope(above);
        if (!low || !high || !(*low * *high < 0)) continue;
        for (int halving = 0; halving < 60; ++halving) {
          const double middle = 0.5 * (below + above);
          const auto between = slope(middle);
          if (!between) break;
          (*low * *between > 0 ? below : above) = middle;
        }
        const auto q = bars.pose(by_crank, below, side);
        const Angles t = bars.motion(*q);
        if (size_of(t) < next_to_crossing) continue;
        if (std::abs(dot(bars.force(*q), t)) < 1e-7 * bars.scale() * size_of(t)) out.push_back(*q);
      }
    }
  }
  return out;
}

struct FlatPose {
  Angles at;
  double along;  // what loads do along motions of the links in line that keep their length, over the scale
};

std::vector<FlatPose> flat_poses(const FourBar& bars) {
  std::vector<FlatPose> out;
  const double direction = std::arg(bars.ground);
  for (int signs = 0; signs < 8; ++signs) {
    const double a = (signs & 1 ? -1 : 1) * bars.a;
    const double b = (signs & 2 ? -1 : 1) * bars.b;
    const double c = (signs & 4 ? -1 : 1) * bars.c;
    if (std::abs(a + b - c - std::abs(bars.ground)) > 1e-9) continue;
    FlatPose pose{{direction + (a < 0 ? M_PI : 0), direction + (b < 0 ? M_PI : 0), direction + (c < 0 ? M_PI : 0)},
                  0.0};
    const Angles row{a, b, -c};
    Angles rest = bars.force(pose.at);
    const double part = dot(rest, row) / dot(row, row);
    for (std::size_t i = 0; i < 3; ++i) rest[i] -= part * row[i];
    pose.along = size_of(rest) / bars.scale();
    out.push_back(pose);
  }
  return out;
}

/// What is wrong with the set; empty if nothing.
std::string fault(const FourBar& bars, const EquilibriumSet& set) {
  const auto is_listed = [&](const Angles& q, double within) {
    return std::any_of(set.equilibria.begin(), set.equilibria.end(),
                       [&](const Equilibrium& e) { return distance(q, e.x) < within; });
  };
  for (const Equilibrium& e : set.equilibria) {
    const Angles q{e.x[0], e.x[1], e.x[2]};
    if (bars.gap(q) > 1e-9) return "an open loop";
    const Angles t = bars.motion(q);
    if (size_of(t) < 1e-5) continue;
    if (std::abs(dot(bars.force(q), t)) > 1e-9 * bars.scale() * size_of(t)) {
      return fmt::format("no equilibrium: {} {} {}", q[0], q[1], q[2]);
    }
  }
  for (const FlatPose& flat : flat_poses(bars)) {
    if (flat.along > 1e-9 && is_listed(flat.at, 1e-7)) return fmt::format("none where flat at {}", flat.at[0]);
    if (flat.along > 1e-14) continue;
    const auto at = std::find_if(set.equilibria.begin(), set.equilibria.end(),
                                 [&](const Equilibrium& e) { return distance(flat.at, e.x) < 1e-6; });
    if (at == set.equilibria.end()) {
      if (set.claim == Claim::complete) return fmt::format("the flat one at {} is missing", flat.at[0]);
    } else if (!is_change_point(*at)) {
      return fmt::format("the flat one at {} is not called a change point", flat.at[0]);
    }
  }
  if (set.claim != Claim::complete) return "";
  for (const Angles& q : rests_along_branches(bars)) {
    if (!is_listed(q, 1e-6)) return fmt::format("missing: {} {} {}", q[0], q[1], q[2]);
  }
  return "";
}

TEST(FlatLinkages, AreProvedComplete) {
  const int count = test::cases(25, 400);
  int complete = 0, crossings = 0;
  std::vector<long> boxes;
  for (int k = 0; k < count; ++k) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(k) + 1);
    const FourBar bars = random_four_bar(seed);
    const EquilibriumSet set =
        all_equilibria(StaticModel(parse_scene(bars.text(), "scene.toml")), {.starts = 20, .settling = false});
    EXPECT_EQ(fault(bars, set), "") << bars.kind << " " << seed << ": " << set.statement << "\n" << bars.text();
    boxes.push_back(set.boxes);
    crossings += static_cast<int>(std::count_if(set.equilibria.begin(), set.equilibria.end(), is_change_point));
    if (set.claim == Claim::complete) {
      ++complete;
    } else {
      std::cout << bars.kind << " " << seed << ": " << set.statement << std::endl << bars.text();
    }
  }
  std::sort(boxes.begin(), boxes.end());
  const long most = boxes[boxes.size() * 9 / 10];
  std::cout << fmt::format("{} flat linkages: {} complete, {} equilibria at change points, {} boxes or fewer in 90 %\n",
                           count, complete, crossings, most);
  EXPECT_GE(complete, count * 9 / 10);
  EXPECT_GT(crossings, count / 10);
  EXPECT_LT(most, 10'000);
}

}  // namespace
}  // namespace poise::flat_linkages_test
