#include "design/synthesis/function_generation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace poise::function_generation_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// A task with Chebyshev's points, as many as the starts that are free ask for.
FunctionTask task_of(const WantedFunction& wanted, std::optional<double> input_start,
                     std::optional<double> output_start) {
  FunctionTask task;
  task.input_start = input_start;
  task.output_start = output_start;
  task.last = wanted.input_turn;
  for (const double x : chebyshev_points(wanted.from, wanted.to, 3 + !input_start + !output_start)) {
    task.turns.push_back(wanted.turns_at(x));
  }
  return task;
}

struct KnownFunction {
  const char* y;
  double from, to;
  double input_start, input_turn, output_start, output_turn;  // deg
  double input, output, coupler, error;                       // the last in deg
};

TEST(FunctionGeneration, ThreePointsOfKnownTasks) {
  for (const KnownFunction& known :
       {KnownFunction{"log(x)/log(10)", 1, 2, 45, 60, 135, 90, 1.8508606188995, -1.9205111314537, 2.8680075408980,
                      0.168637},
        KnownFunction{"x^1.5", 1, 4, 30, 90, 90, 90, -1.6999649792230, -2.2238001070732, 2.8102258093182, 0.831477},
        KnownFunction{"sin(x)", 0, std::numbers::pi / 2, 97, 120, 60, 60, 0.5546432139920, 0.7246280300276,
                      1.4408399874353, 0.838852}}) {
    const WantedFunction wanted{Expression(known.y, {"x"}), known.from, known.to, known.input_turn * degree,
                                known.output_turn * degree};
    const FunctionLinkages found =
        linkages_for(task_of(wanted, known.input_start * degree, known.output_start * degree));
    ASSERT_TRUE(found.complete);
    ASSERT_EQ(found.linkages.size(), 1u);
    const FunctionLinkage& linkage = found.linkages.front();
    EXPECT_NEAR(linkage.input, known.input, 2e-13 * 5);
    EXPECT_NEAR(linkage.output, known.output, 2e-13 * 5);
    EXPECT_NEAR(linkage.linkage.coupler, known.coupler, 2e-13 * 5);
    EXPECT_LT(linkage.misfit, 1e-13);
    ASSERT_EQ(linkage.passage.defect, Defect::none) << known.y;
    const auto error = structural_error(linkage, wanted);
    ASSERT_TRUE(error);
    EXPECT_NEAR(error->largest / degree, known.error, 5e-7) << known.y;
    EXPECT_TRUE(error->proved) << known.y;
    EXPECT_GE(error->bound, error->largest);
    EXPECT_LT(error->bound, error->largest * 1.00001);
  }
}

TEST(FunctionGeneration, FivePointsOfTheKnownTaskHaveOneSolution) {
  const WantedFunction wanted{Expression("log(x)/log(10)", {"x"}), 1, 2, 60 * degree, 90 * degree};
  const FunctionLinkages found = linkages_for(task_of(wanted, {}, {}));
  ASSERT_TRUE(found.complete);
  ASSERT_EQ(found.linkages.size(), 1u);
  EXPECT_EQ(found.complex, 2);
  const FunctionLinkage& linkage = found.linkages.front();
  EXPECT_NEAR(linkage.input_start / degree, 30.68662684, 1e-7);
  EXPECT_NEAR(linkage.output_start / degree, 57.98495549, 1e-7);
  EXPECT_NEAR(linkage.input, 3.057181500, 1e-8);
  EXPECT_NEAR(linkage.output, 8.529191228, 1e-8);
  EXPECT_NEAR(linkage.linkage.coupler * linkage.linkage.coupler, 40.529198920, 1e-7);
}

TEST(FunctionGeneration, LargestErrorIsThatOfManySamples) {
  const WantedFunction wanted{Expression("exp(x)", {"x"}), 0, 1.3, 75 * degree, 60 * degree};
  int measured = 0;
  for (double start = 20; start < 100; start += 12) {
    const FunctionLinkages found = linkages_for(task_of(wanted, start * degree, 200 * degree));
    for (const FunctionLinkage& linkage : found.linkages) {
      const auto error = structural_error(linkage, wanted);
      EXPECT_EQ(error.has_value(), linkage.passage.defect == Defect::none);
      if (!error) continue;
      double largest = 0.0;
      for (int k = 0; k <= 20000; ++k) {
        const Vec2 turns = wanted.turns_at(1.3 * k / 20000);
        // The equation itself is asked, not the pose of the linkage.
        const double phi = linkage.input_start + turns.x, psi = linkage.output_start + turns.y;
        const auto value = [&](double at) {
          const double a = linkage.input, b = linkage.linkage.coupler, c = linkage.output;
          return norm(Vec2{1, 0} + c * unit(at) - a * unit(phi)) - b;
        };
        double at = psi;
        for (int step = 0; step < 30; ++step) at -= value(at) / ((value(at + 1e-6) - value(at - 1e-6)) / 2e-6);
        largest = std::max(largest, std::abs(at - psi));
      }
      EXPECT_NEAR(error->largest, largest, 1e-6 * (largest + 1e-3));
      EXPECT_TRUE(error->proved);
      ++measured;
    }
  }
  EXPECT_GT(measured, 2);
}

TEST(FunctionGeneration, ForgottenLinkagesAreFound) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> length(0.6, 3), angle(-3, 3);
  std::array<int, 4> recovered{};
  for (int task = 0; task < 400; ++task) {
    const FourBar linkage{{}, {1, 0}, length(random), length(random), length(random), {}};
    const double start = angle(random);
    FunctionTask asked;
    const int kind = task % 4;  // which starts are given
    const std::size_t pairs = kind == 0 ? 3 : kind == 3 ? 5 : 4;
    std::vector<FourBarPose> poses;
    for (std::size_t k = 0; k < pairs; ++k) {
      const auto pose = pose_of(linkage, start + 0.25 * static_cast<double>(k), 1);
      if (pose) poses.push_back(*pose);
    }
    if (poses.size() < pairs) continue;
    for (const FourBarPose& pose : poses) {
      asked.turns.push_back({pose.input_angle - start, pose.output_angle - poses.front().output_angle});
    }
    asked.last = asked.turns.back().x;
    if (kind == 0 || kind == 1) asked.input_start = start;
    if (kind == 0 || kind == 2) asked.output_start = poses.front().output_angle;
    const FunctionLinkages found = linkages_for(asked);
    ASSERT_TRUE(found.complete) << task;
    double least = INFINITY;
    Defect defect = Defect::undecided;
    for (const FunctionLinkage& one : found.linkages) {
      EXPECT_LT(one.misfit, 1e-6) << task;
      const double distance = std::abs(one.linkage.input - linkage.input) +
                              std::abs(one.linkage.output - linkage.output) +
                              std::abs(one.linkage.coupler - linkage.coupler);
      if (distance < least) defect = one.passage.defect;
      least = std::min(least, distance);
    }
    bool closes = true;
    for (int k = 0; k <= 1000; ++k) closes = closes && pose_of(linkage, start + asked.last * k / 1000, 1).has_value();
    EXPECT_EQ(defect == Defect::none, closes) << task;
    EXPECT_LT(least, 1e-6) << task << " kind " << kind;
    ++recovered[static_cast<std::size_t>(kind)];
  }
  for (const int count : recovered) EXPECT_GT(count, 30);
}

/// Distinct lengths of input and output with five pairs, by Newton's method on Freudenstein's equations from random
/// starts.
std::vector<Vec2> by_newton(const FunctionTask& task, std::mt19937& random) {
  std::uniform_real_distribution<double> angle(-3.2, 3.2);
  std::vector<Vec2> out;
  for (int start = 0; start < 600; ++start) {
    Eigen::Vector<double, 5> x;  // K1, K2, K3, input start, output start
    for (int k = 0; k < 5; ++k) x[k] = angle(random);
    // Some links are long, and their constants small.
    for (int k = 0; k < 2; ++k) x[k] *= std::exp(angle(random));
    double change = INFINITY;
    for (int step = 0; step < 60 && change > 1e-12 && x.norm() < 1e4; ++step) {
      Eigen::Matrix<double, 5, 5> slopes;
      Eigen::Vector<double, 5> values;
      for (int i = 0; i < 5; ++i) {
        const double phi = x[3] + task.turns[static_cast<std::size_t>(i)].x;
        const double psi = x[4] + task.turns[static_cast<std::size_t>(i)].y;
        values[i] = x[0] * std::cos(psi) - x[1] * std::cos(phi) + x[2] - std::cos(phi - psi);
        slopes.row(i) << std::cos(psi), -std::cos(phi), 1.0, x[1] * std::sin(phi) + std::sin(phi - psi),
            -x[0] * std::sin(psi) - std::sin(phi - psi);
      }
      const Eigen::Vector<double, 5> step_taken = slopes.partialPivLu().solve(values);
      x -= step_taken;
      change = step_taken.norm();
    }
    if (!(change <= 1e-12) || std::abs(x[0]) < 1e-6 || std::abs(x[1]) < 1e-6) continue;
    const Vec2 lengths{1 / std::abs(x[0]), 1 / std::abs(x[1])};
    const bool known =
        std::any_of(out.begin(), out.end(), [&](const Vec2& at) { return norm(at - lengths) < 1e-6 * norm(at); });
    if (!known) out.push_back(lengths);
  }
  return out;
}

TEST(FunctionGeneration, FivePairsHaveAsManyAsNewtonsMethodFinds) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> step(0.2, 0.9);
  std::array<int, 4> tasks_with{};
  for (int task = 0; task < 60; ++task) {
    FunctionTask asked;
    Vec2 at{};
    for (int k = 0; k < 5; ++k) {
      asked.turns.push_back(at);
      at += Vec2{step(random), step(random)};
    }
    const FunctionLinkages found = linkages_for(asked);
    ASSERT_TRUE(found.complete) << task;
    ASSERT_EQ(found.infinite, 0) << task;
    EXPECT_EQ(static_cast<int>(found.linkages.size()) + found.complex, 3) << task;
    for (const FunctionLinkage& one : found.linkages) EXPECT_LT(one.misfit, 1e-8) << task;
    const std::vector<Vec2> other = by_newton(asked, random);
    EXPECT_EQ(other.size(), found.linkages.size()) << task;
    for (const Vec2& lengths : other) {
      EXPECT_TRUE(std::any_of(found.linkages.begin(), found.linkages.end(), [&](const FunctionLinkage& one) {
        return norm(Vec2{one.linkage.input, one.linkage.output} - lengths) < 1e-5 * norm(lengths);
      })) << task;
    }
    ++tasks_with[found.linkages.size()];
  }
  EXPECT_GT(tasks_with[1], 10);
  EXPECT_GT(tasks_with[3], 3);
}

TEST(FunctionGeneration, PairsThatDependAreSaid) {
  FunctionTask task;
  task.input_start = 0.3;
  task.output_start = 0.3;
  task.turns = {{0, 0}, {0.4, 0.4}, {0.9, 0.9}};  // a parallelogram with links of any length
  EXPECT_TRUE(linkages_for(task).dependent);
  // Pairs that are a thousandth of a turn apart are ill-conditioned, not dependent.
  task.output_start.reset();
  task.turns = {{0, 0}, {0.006, 0.004}, {0.012, 0.0081}, {0.018, 0.0123}};
  const FunctionLinkages found = linkages_for(task);
  EXPECT_TRUE(found.complete);
  for (const FunctionLinkage& one : found.linkages) EXPECT_LT(one.misfit, 1e-9);
}

}  // namespace
}  // namespace poise::function_generation_test
