#include "motion/friction_forces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::friction_forces_test {
namespace {

using Size = FrictionForces::Size;

double size_of(Size size, const Planar<double>& force) {
  return size == Size::pin ? norm(force) : std::max(std::abs(force.x), std::abs(force.y));
}

/// Responses of about `strength`.
FrictionForces random_system(std::mt19937& random, std::size_t most, double strength) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::vector<Size> sizes(1 + random() % most);
  for (Size& size : sizes) size = std::array{Size::normal, Size::carriage, Size::pin}[random() % 3];
  FrictionForces out(sizes);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const bool is_line = sizes[i] == Size::normal;
    out.force(i) = {any(random), is_line ? 0.0 : any(random)};
    for (std::size_t j = 0; j < sizes.size(); ++j) {
      out.response(i, j) = strength * Planar<double>{any(random), is_line ? 0.0 : any(random)};
    }
  }
  return out;
}

std::vector<Planar<double>> forces_at(FrictionForces& system, const std::vector<double>& g) {
  std::vector<Planar<double>> out;
  for (std::size_t i = 0; i < g.size(); ++i) {
    out.push_back(system.force(i));
    for (std::size_t j = 0; j < g.size(); ++j) out.back() += g[j] * system.response(i, j);
  }
  return out;
}

// g = |f + r g|: g = f / (1 - r) where that is not negative, and -f / (1 + r).
TEST(FrictionForces, OfOneNormalForceAreThoseOfTwoLines) {
  FrictionForces system({Size::normal});
  for (const double f : {1.0, -1.0}) {
    for (const double r : {-3.0, -0.5, 0.0, 0.9, 1.1}) {
      system.force(0) = {f, 0};
      system.response(0, 0) = {r, 0};
      std::vector<double> expected;
      if (f / (1 - r) >= 0) expected.push_back(f / (1 - r));
      if (-f / (1 + r) >= 0) expected.push_back(-f / (1 + r));
      std::sort(expected.begin(), expected.end());
      FrictionForces::All found = system.all();
      std::sort(found.sizes.begin(), found.sizes.end());
      EXPECT_TRUE(found.complete);
      ASSERT_EQ(found.sizes.size(), expected.size()) << f << " " << r;
      for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(found.sizes[k][0], expected[k], 1e-12);
      EXPECT_EQ(system.is_unique(), std::abs(r) < 1) << r;
    }
  }
}

// g^2 = |f|^2 + 2 g f . r + g^2 |r|^2.
TEST(FrictionForces, OfOnePinAreTheRootsOfAQuadratic) {
  std::mt19937 random(static_cast<unsigned>(test::seed(3)));
  std::uniform_real_distribution<double> any(-2.0, 2.0);
  FrictionForces system({Size::pin});
  int none = 0, two = 0;
  for (int k = 0; k < 2000; ++k) {
    const Planar<double> f{any(random), any(random)}, r{any(random), any(random)};
    system.force(0) = f;
    system.response(0, 0) = r;
    const double a = 1 - dot(r, r), half = dot(f, r), c = -dot(f, f);
    const double under = half * half - a * c;
    if (std::abs(under) < 1e-6 || std::abs(a) < 1e-6) continue;
    std::vector<double> expected;
    if (under > 0) {
      for (const double root : {(half + std::sqrt(under)) / a, (half - std::sqrt(under)) / a}) {
        if (root >= 0) expected.push_back(root);
      }
    }
    std::sort(expected.begin(), expected.end());
    FrictionForces::All found = system.all();
    std::sort(found.sizes.begin(), found.sizes.end());
    ASSERT_TRUE(found.complete) << k;
    ASSERT_EQ(found.sizes.size(), expected.size()) << k;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(found.sizes[i][0], expected[i], 1e-9 * (1 + expected[i])) << k;
    }
    EXPECT_EQ(system.is_unique(), norm(r) < 1 - 1e-3) << norm(r);
    none += expected.empty() ? 1 : 0;
    two += expected.size() == 2 ? 1 : 0;
  }
  EXPECT_GT(none, 100);
  EXPECT_GT(two, 100);
}

// Newton's method from many starts finds no solution but these, and these satisfy the equations.
TEST(FrictionForces, AreAllThatNewtonsMethodFinds) {
  std::mt19937 random(static_cast<unsigned>(test::seed(5)));
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int complete = 0, none = 0, one = 0, several = 0, unique = 0, beyond_contraction = 0;
  constexpr int cases = 3000;
  for (int k = 0; k < cases; ++k) {
    FrictionForces system = random_system(random, 4, 0.2 + 1.2 * share(random));
    const std::size_t n = system.joints();
    const bool is_unique = system.is_unique();
    FrictionForces::All found = system.all();
    if (!found.complete) continue;
    ++complete;
    (found.sizes.empty() ? none : found.sizes.size() == 1 ? one : several) += 1;
    if (is_unique) {
      ++unique;
      ASSERT_EQ(found.sizes.size(), 1U) << k;
      double reach = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        double row = 0.0;
        for (std::size_t j = 0; j < n; ++j) row += norm(system.response(i, j));
        reach = std::max(reach, row);
      }
      beyond_contraction += reach > 1.5 ? 1 : 0;
    }
    for (const std::vector<double>& g : found.sizes) {
      const std::vector<Planar<double>> forces = forces_at(system, g);
      for (std::size_t i = 0; i < n; ++i) {
        // A normal force has no second component, so that the sizes are those of a carriage.
        const bool is_pin = system.size(i) == Size::pin;
        EXPECT_NEAR(g[i], size_of(is_pin ? Size::pin : Size::carriage, forces[i]), 1e-8 * (1 + g[i])) << k;
      }
    }
    for (int start = 0; start < 30; ++start) {
      Eigen::VectorXd g(static_cast<Eigen::Index>(n));
      for (double& x : g) x = std::pow(10.0, 4.0 * share(random) - 2.0);
      double left = 1.0;
      for (int step = 0; step < 60; ++step) {
        const std::vector<Planar<double>> forces = forces_at(system, {g.begin(), g.end()});
        Eigen::VectorXd miss(g.size());
        Eigen::MatrixXd by = Eigen::MatrixXd::Identity(g.size(), g.size());
        for (std::size_t i = 0; i < n; ++i) {
          const auto row = static_cast<Eigen::Index>(i);
          const Planar<double> f = forces[i];
          Planar<double> w = system.size(i) == Size::pin      ? (1.0 / norm(f)) * f
                             : std::abs(f.x) >= std::abs(f.y) ? Planar<double>{f.x < 0 ? -1.0 : 1.0, 0}
                                                              : Planar<double>{0, f.y < 0 ? -1.0 : 1.0};
          miss[row] = g[row] - dot(w, f);
          for (std::size_t j = 0; j < n; ++j) by(row, static_cast<Eigen::Index>(j)) -= dot(w, system.response(i, j));
        }
        left = miss.norm();
        if (left < 1e-12 * (1 + g.norm())) break;
        g -= by.partialPivLu().solve(miss);
      }
      if (!(left < 1e-12 * (1 + g.norm())) || g.minCoeff() < 0) continue;
      const bool known = std::any_of(found.sizes.begin(), found.sizes.end(), [&](const std::vector<double>& other) {
        double apart = 0.0;
        for (std::size_t i = 0; i < n; ++i)
          apart = std::max(apart, std::abs(other[i] - g[static_cast<Eigen::Index>(i)]));
        return apart < 1e-6 * (1 + g.norm());
      });
      EXPECT_TRUE(known) << k << ": " << g.transpose();
    }
  }
  EXPECT_GT(complete, cases * 99 / 100);
  EXPECT_GT(none, cases / 20);
  EXPECT_GT(one, cases / 4);
  EXPECT_GT(several, cases / 20);
  EXPECT_GT(unique, cases / 5);
  EXPECT_GT(beyond_contraction, 20);
  RecordProperty("complete", complete);
  RecordProperty("none", none);
  RecordProperty("one", one);
  RecordProperty("several", several);
  RecordProperty("unique", unique);
}

}  // namespace
}  // namespace poise::friction_forces_test
