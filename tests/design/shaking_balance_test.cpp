// Counterweights: the conditions of Berkof and Lowen, random four-bars by inverse dynamics, a slider-crank by a scan.
#include "design/balance/shaking_balance.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "solvers/random_stream.hpp"

namespace poise::shaking_balance_test {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double full_turn = 2 * std::numbers::pi;

struct Link {
  double mass = 0.0;
  Vec2 center;
};

Scene four_bar(double ground, double crank, double coupler, double rocker, const Link& a, const Link& b,
               const Link& c) {
  const auto body = [](const Link& link) {
    return fmt::format("mass = {:.17g}\ncenter = [{:.17g}, {:.17g}]\ninertia = 1e-4\n", link.mass, link.center.x,
                       link.center.y);
  };
  return parse_scene(fmt::format(R"(
gravity = [0, 0]
[ground]
points = {{ A = [0, 0], D = [{}, 0] }}
[body.crank]
points = {{ A = [0, 0], B = [{}, 0] }}
{}
[body.coupler]
points = {{ B = [0, 0], C = [{}, 0] }}
{}
[body.rocker]
points = {{ D = [0, 0], C = [{}, 0] }}
{}
[[pin]]
points = ["ground.A", "crank.A"]
[[pin]]
points = ["crank.B", "coupler.B"]
[[pin]]
points = ["coupler.C", "rocker.C"]
[[pin]]
points = ["ground.D", "rocker.D"]
[start]
crank = 0.5
coupler = 0.3
rocker = 1.2
)",
                                 ground, crank, body(a), coupler, body(b), rocker, body(c)),
                     "four-bar");
}

BalanceProblem shaking_problem(Scene scene, const std::vector<std::string>& bodies, double radius) {
  BalanceProblem out;
  out.file = "design.toml";
  out.of = BalanceProblem::Of::shaking;
  out.scene = std::move(scene);
  for (const std::string& name : bodies) {
    for (std::size_t b = 0; b < out.scene.bodies.size(); ++b) {
      if (out.scene.bodies[b].name == name) out.counterweights.push_back({static_cast<int>(b), radius, {}});
    }
  }
  out.drive = "crank";
  out.rate = 100.0;
  out.range_to = full_turn;
  return out;
}

Vec2 polar(double size, double degrees) { return size * unit(degrees * degree); }

// Force of all joints with the ground on it, by free bodies.
Vec2 force_on_frame(const MotionModel& model, const Scene& scene, const KinematicSample& at) {
  const Forces forces = forces_of(model, model.from_si(at.q), model.from_si(at.rate), model.from_si(at.acceleration),
                                  {find_drive(scene, "crank")});
  Vec2 out{};
  for (const Reaction& reaction : forces.reactions) {
    if (reaction.body_a == 0) out -= reaction.force;
    if (reaction.body_b == 0) out += reaction.force;
  }
  return out;
}

TEST(ShakingBalance, FourBarOfBerkofAndLowen) {
  const Scene scene =
      four_bar(0.14, 0.05, 0.15, 0.075, {0.05, {0.025, 0.0}}, {0.10, polar(0.08, 15)}, {0.12, {0.04, 0.0}});
  const ShakingBalance found = balance_shaking(shaking_problem(scene, {"crank", "rocker"}, 0.02));
  ASSERT_TRUE(found.balanced) << found.residual << " " << found.moved;
  const Vec2 crank = polar(0.00373846005, 169.36118340), rocker = polar(0.00872533963, -173.18570658);
  EXPECT_LT(norm(found.weights[0].first_moment - crank), 2e-11);
  EXPECT_LT(norm(found.weights[1].first_moment - rocker), 2e-11);
  EXPECT_NEAR(found.weights[0].mass, 0.00373846005 / 0.02, 1e-9);
  EXPECT_NEAR(found.before->force, 224.5468, 1e-4);
  EXPECT_LT(found.after->force, 1e-12 * found.before->force);
  EXPECT_GT(found.after->moment, 0.01);
}

TEST(ShakingBalance, OneCounterweightOfTwoIsNotEnough) {
  const Scene scene =
      four_bar(0.14, 0.05, 0.15, 0.075, {0.05, {0.025, 0.0}}, {0.10, polar(0.08, 15)}, {0.12, {0.04, 0.0}});
  const ShakingBalance found = balance_shaking(shaking_problem(scene, {"crank"}, 0.02));
  EXPECT_FALSE(found.balanced);
  EXPECT_TRUE(found.complete);
  EXPECT_TRUE(found.is_least);
  EXPECT_LT(found.after->force, found.before->force);
  EXPECT_LE(found.lower, found.after->force * (1 + 1e-9));
}

// The slider-crank at 100 rad/s: its rotating moment is 0.024 kg m, its reciprocating one 0.035.
Scene slider_crank() {
  return parse_scene(R"(
gravity = [0, 0]
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], A = [0.05, 0] }
mass = 0.4
center = [0.01, 0]
[body.rod]
points = { A = [0, 0], B = [0.2, 0] }
mass = 0.6
center = ["0.2/3", 0]
inertia = 0.003
[body.piston]
points = { B = [0, 0] }
mass = 0.5
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.A", "rod.A"]
[[pin]]
points = ["rod.B", "piston.B"]
[[slide]]
name = "bore"
points = ["ground.O", "piston.B"]
axis = [1, 0]
[start]
crank = 0.3
bore = 0.24
)",
                     "slider-crank");
}

TEST(ShakingBalance, SliderCrankHasALeastLargestForce) {
  const BalanceProblem problem = shaking_problem(slider_crank(), {"crank"}, 0.04);
  const ShakingBalance found = balance_shaking(problem);
  EXPECT_FALSE(found.balanced);
  EXPECT_TRUE(found.complete);
  ASSERT_TRUE(found.is_least);
  EXPECT_NEAR(found.before->force, 677.5, 1e-6);
  // Golden sections over the moment and over the angle search the closed form of the slider-crank.
  EXPECT_NEAR(found.after->force, 231.0230563364, 1e-7);
  EXPECT_NEAR(found.lower, 231.0230563364, 1e-7);
  EXPECT_NEAR(found.weights[0].first_moment.x, -0.04464769436636, 1e-11);
  EXPECT_NEAR(found.weights[0].first_moment.y, 0.0, 1e-8);
  // No moment of a fine scan around it has a smaller largest force.
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) {
      Scene other = problem.scene;
      Body& crank = other.bodies[1];
      const Vec2 moment = found.weights[0].first_moment + Vec2{2e-4 * i, 2e-4 * j};
      crank.center = (1 / (crank.mass + 1.0)) * (crank.mass * crank.center + moment);
      crank.mass += 1.0;
      std::string why;
      EXPECT_GE(shaking_of(problem, other, why).force, found.after->force * (1 - 1e-9)) << i << " " << j;
    }
  }
}

TEST(ShakingBalance, RandomFourBarsStandStill) {
  int balanced = 0;
  for (std::uint64_t index = 0; balanced < 20; ++index) {
    ASSERT_LT(index, 100u);
    solvers::RandomStream random(11, 0, index);
    const auto link = [&] {
      return Link{random.uniform(0.5, 2.0), {random.uniform(-0.5, 1.0), random.uniform(-0.5, 0.5)}};
    };
    const double crank = 1.0, coupler = random.uniform(2.5, 4.0), rocker = random.uniform(2.5, 4.0);
    const double ground = random.uniform(std::abs(coupler - rocker) + 1.3, coupler + rocker - 1.3);
    if (ground < 1.2) continue;
    const Link of_rocker = link(), of_coupler = link(), of_crank = link();
    const Scene scene = four_bar(ground, crank, coupler, rocker, of_crank, of_coupler, of_rocker);
    BalanceProblem problem = shaking_problem(scene, {"crank", "rocker"}, 0.5);
    problem.drive.clear();
    const ShakingBalance found = balance_shaking(problem);
    ASSERT_TRUE(found.balanced) << index << " " << found.residual << " " << found.moved;
    double before = 0.0, after = 0.0;
    const MotionModel unbalanced(scene), model(found.scene);
    for (const auto& [of, in, largest] :
         {std::tuple{&unbalanced, &scene, &before}, std::tuple{&model, &found.scene, &after}}) {
      SweepOptions options;
      options.steps = 36;
      const KinematicsResult motion = sweep(*in, {{"crank", 0.0, full_turn}}, options);
      ASSERT_TRUE(motion.complete) << index << motion.why;
      for (const KinematicSample& at : motion.samples) {
        *largest = std::max(*largest, norm(force_on_frame(*of, *in, at)));
      }
    }
    EXPECT_LT(after, 1e-12 * before) << index;
    ++balanced;
  }
}

}  // namespace
}  // namespace poise::shaking_balance_test
