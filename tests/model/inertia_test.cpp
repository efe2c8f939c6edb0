#include "model/inertia.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "model/scene.hpp"

namespace poise::inertia_test {
namespace {

// A crank, a block that slides along it, a bar of its own pinned to the block, and a slide on the ground: every kind
// of phasor at once.
Scene crank_block_and_trolley() {
  Scene scene = parse_scene(R"(
[ground]
points = { O = [0.2, -0.1], S = [0, 1] }
[body.crank]
points = { O = [0, 0], S = [0.1, 0.3] }
mass = 2
center = [0.4, 0.1]
inertia = 0.3
[body.block]
points = { C = [0.05, 0.02], P = [0.3, -0.1] }
mass = 1.5
center = [0.2, -0.07]
inertia = 0.11
[body.arm]
points = { P = [0.1, 0.2] }
mass = 0.7
center = [-0.3, 0.5]
inertia = 0.05
[body.trolley]
points = { S = [0, 0], H = [0.2, 0] }
mass = 3
inertia = 9
[body.pendulum]
points = { H = [0, 0] }
mass = 0.9
center = [0.6, 0]
inertia = 0.2
[[pin]]
points = ["ground.O", "crank.O"]
[[slide]]
name = "groove"
points = ["crank.S", "block.C"]
axis = [0.6, 0.8]
angle = 0.4
[[pin]]
points = ["block.P", "arm.P"]
[[slide]]
name = "rail"
points = ["ground.S", "trolley.S"]
axis = [0.8, -0.6]
[[pin]]
points = ["trolley.H", "pendulum.H"]
)",
                            "inertia_test");
  return scene;
}

struct Motion {
  explicit Motion(const Scene& given) : scene(given), mechanism(scene, Purpose::dynamics), inertia(scene, mechanism) {
    n = mechanism.coordinates();
    for (int i = 0; i < n; ++i) {
      q.push_back(0.3 + 0.7 * i - 0.2 * i * i);
      rate.push_back(std::cos(1.0 + 2.0 * i));
    }
  }

  std::vector<double> mass_matrix(const std::vector<double>& at) const {
    std::vector<Vec2> pose(mechanism.pose_size());
    std::vector<double> m(n * n);
    mechanism.place(at.data(), pose.data());
    inertia.mass_matrix(pose.data(), m.data());
    return m;
  }

  std::vector<double> displaced(double step) const {
    std::vector<double> out = q;
    for (int i = 0; i < n; ++i) out[i] += step * rate[i];
    return out;
  }

  Scene scene;
  Mechanism<double> mechanism;
  Inertia<double> inertia;
  int n = 0;
  std::vector<double> q, rate;
};

TEST(Inertia, KineticEnergyIsThatOfTheBodies) {
  const Motion motion(crank_block_and_trolley());
  ASSERT_EQ(motion.n, 5);
  const double h = 1e-5;
  const auto before = motion.mechanism.poses(motion.displaced(-h).data());
  const auto after = motion.mechanism.poses(motion.displaced(h).data());
  double bodies = 0.0;
  for (std::size_t i = 1; i < motion.scene.bodies.size(); ++i) {
    const Body& body = motion.scene.bodies[i];
    const Vec2 velocity = 0.5 / h * (after[i].world(body.center) - before[i].world(body.center));
    const double spin = 0.5 / h * (after[i].angle - before[i].angle);
    bodies += 0.5 * body.mass * dot(velocity, velocity) + 0.5 * body.inertia * spin * spin;
  }
  const std::vector<double> m = motion.mass_matrix(motion.q);
  double generalized = 0.0;
  for (int a = 0; a < motion.n; ++a) {
    for (int b = 0; b < motion.n; ++b) generalized += 0.5 * motion.rate[a] * m[a * motion.n + b] * motion.rate[b];
  }
  EXPECT_NEAR(generalized, bodies, 1e-8 * bodies);
}

TEST(Inertia, MassMatrixIsSymmetric) {
  const Motion motion(crank_block_and_trolley());
  const int n = motion.n;
  const std::vector<double> m = motion.mass_matrix(motion.q);
  for (int a = 0; a < n; ++a) {
    for (int b = 0; b < a; ++b) EXPECT_DOUBLE_EQ(m[a * n + b], m[b * n + a]);
  }
}

TEST(Inertia, CompoundPendulumHasTheParallelAxisMoment) {
  const Motion motion(parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0] }
mass = 2
center = [0.3, 0.4]
inertia = 0.1
[[pin]]
points = ["ground.O", "rod.O"]
)",
                                  "inertia_test"));
  ASSERT_EQ(motion.n, 1);
  EXPECT_DOUBLE_EQ(motion.mass_matrix(motion.q)[0], 0.1 + 2 * 0.25);
}

}  // namespace
}  // namespace poise::inertia_test
