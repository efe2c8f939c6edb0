// Forces and stiffnesses of merged energies in intervals against those of the mechanism in doubles.

#include "statics/all_equilibria/private/merged_mechanism.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random_linkages.hpp"
#include "tests/support/seed.hpp"

namespace poise::merged_mechanism_test {
namespace {

// A slide on a turning arm and one on the ground, springs of free length zero from each to each, weights and loads.
constexpr const char* slides = R"(
gravity = [0.3, -9.81]
[ground]
points = { O = [0.1, -0.2], S = [0.4, 1.3], Q = [-0.7, 0.2] }
[body.arm]
points = { O = [0.05, 0.1], A = [0.9, 0.2] }
mass = 1.3
center = [0.4, -0.1]
[body.block]
points = { P = [0.1, 0.2], E = [0.3, -0.4] }
mass = 0.6
center = [0.2, 0.1]
[body.cart]
points = { W = [0, 0.1], T = [0.5, 0.6] }
mass = 2
center = [0.1, 0.3]
[[pin]]
points = ["ground.O", "arm.O"]
[[slide]]
points = ["arm.A", "block.P"]
axis = [0.6, 0.3]
angle = 0.4
[[slide]]
points = ["ground.Q", "cart.W"]
axis = [1, 0.2]
[[spring]]
name = "a"
points = ["ground.S", "block.E"]
stiffness = 30
free_length = 0
[[spring]]
name = "b"
points = ["cart.T", "block.E"]
stiffness = 12
free_length = 0
[[spring]]
name = "c"
points = ["arm.A", "cart.W"]
stiffness = 7
free_length = 0
[[spring]]
name = "d"
points = ["arm.A", "ground.Q"]
stiffness = 5
free_length = 0.3
[[force]]
name = "F"
at = "block.E"
vector = [3, -4]
)";

void expect_enclosed(const Scene& scene, int places) {
  const StaticModel model(scene);
  const Mechanism<double>& plain = model.mechanism();
  MergedMechanism merged(model);
  const auto n = static_cast<std::size_t>(plain.coordinates());
  std::mt19937_64 random(test::seed(2015));
  std::uniform_real_distribution<double> angle(-3.0, 3.0);
  const std::size_t rows = static_cast<std::size_t>(plain.constraints());
  for (int k = 0; k < places; ++k) {
    std::vector<double> x(n), g(n), h(plain.tangent_row().size()), y(rows);
    for (double& v : x) v = angle(random);
    for (double& v : y) v = angle(random);
    std::vector<Planar<double>> pose(static_cast<std::size_t>(plain.pose_size()));
    plain.place(x.data(), pose.data());
    plain.negative_force(x.data(), pose.data(), g.data());
    plain.tangent(pose.data(), y.data(), h.data());
    for (const double half : {0.0, 1e-6, 0.1}) {
      std::vector<Interval> box(n), force(n), stiffness(h.size()), multipliers(rows);
      {
        const solvers::RoundingUp up;
        for (std::size_t i = 0; i < n; ++i) box[i] = Interval(x[i]) + Interval(-half, half);
        for (std::size_t r = 0; r < rows; ++r) multipliers[r] = Interval(y[r]);
        std::vector<Planar<Interval>> at(static_cast<std::size_t>(merged.pose_size()));
        merged.place(box.data(), at.data());
        merged.negative_force(box.data(), at.data(), force.data());
        merged.tangent(at.data(), multipliers.data(), stiffness.data());
      }
      constexpr double rounding = 1e-12;
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_GE(g[i], force[i].lower() - rounding);
        EXPECT_LE(g[i], force[i].upper() + rounding);
        if (half == 0.0) {
          EXPECT_LE(force[i].width(), rounding);
        }
      }
      for (std::size_t e = 0; e < h.size(); ++e) {
        EXPECT_GE(h[e], stiffness[e].lower() - rounding);
        EXPECT_LE(h[e], stiffness[e].upper() + rounding);
        if (half == 0.0) {
          EXPECT_LE(stiffness[e].width(), rounding);
        }
      }
    }
  }
}

TEST(MergedMechanism, EnclosesForcesWithSlides) { expect_enclosed(parse_scene(slides, "slides.toml"), 200); }

TEST(MergedMechanism, EnclosesForcesThatFollowABody) {
  std::string text = slides;
  text += "follows = \"arm\"\n";
  expect_enclosed(parse_scene(text, "slides.toml"), 200);
}

TEST(MergedMechanism, EnclosesForcesOfLinkages) {
  for (const std::string& kind : test::linkage_kinds()) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE(kind);
      expect_enclosed(test::random_linkage(kind, seed, {.springs = 3, .free_lengths = false, .torsion_springs = 1}), 5);
    }
  }
}

}  // namespace
}  // namespace poise::merged_mechanism_test
