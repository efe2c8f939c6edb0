#include "design/synthesis/passage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace poise::passage_test {
namespace {

constexpr double turn = 2 * std::numbers::pi;
constexpr int steps = 20000;

/// Steps from a position in which the input can turn one way in its closure, up to a turn, before it does not close.
int steps_possible(const FourBar& linkage, const InputPosition& from, int way) {
  for (int k = 1; k < steps; ++k) {
    if (!pose_of(linkage, from.angle + way * turn * k / steps, from.closure)) return k - 1;
  }
  return steps;
}

/// In steps, how far the input turns one way to get to an angle.
double steps_to(const InputPosition& from, const InputPosition& to, int way) {
  const double angle = way * (to.angle - from.angle);
  return (angle - turn * std::floor(angle / turn)) * steps / turn;
}

/// How far the input can turn from an angle in one closure, both ways.
struct Reach {
  InputPosition from;
  int forwards, backwards;

  Reach(const FourBar& linkage, const InputPosition& first)
      : from(first), forwards(steps_possible(linkage, first, 1)), backwards(steps_possible(linkage, first, -1)) {}
  bool turns() const { return forwards == steps; }
  bool has(const InputPosition& p) const {
    return p.closure == from.closure && (steps_to(from, p, 1) <= forwards || steps_to(from, p, -1) <= backwards);
  }
};

/// The defect found by turning the input in small steps; a circuit is all that is reached through dead points too.
Defect simulated(const FourBar& linkage, const std::vector<InputPosition>& positions) {
  const InputPosition& first = positions.front();
  const Reach same(linkage, first), other(linkage, {first.angle, -first.closure});
  const auto all = [&](auto fits) { return std::all_of(positions.begin(), positions.end(), fits); };
  // Both closures are one circuit where the input stops at a dead point.
  if (!all([&](const InputPosition& p) { return same.has(p) || (!same.turns() && other.has(p)); })) {
    return Defect::circuit;
  }
  if (!all([&](const InputPosition& p) { return same.has(p); })) return Defect::branch;
  for (const int way : {1, -1}) {
    double total = 0.0;
    for (std::size_t k = 1; k < positions.size(); ++k) total += steps_to(positions[k - 1], positions[k], way);
    if (total <= (way == 1 ? same.forwards : same.backwards)) return Defect::none;
  }
  return Defect::order;
}

TEST(Passage, DefectsAreThoseOfSmallSteps) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> length(0.5, 4), angle(0, turn);
  std::array<int, 5> counts{};
  int tasks = 0;
  for (int task = 0; task < 300; ++task) {
    const Vec2 direction = unit(angle(random));
    const FourBar linkage{{0.3, -0.2},    Vec2{0.3, -0.2} + length(random) * direction,
                          length(random), length(random),
                          length(random), {1, 1}};
    // A third of the tasks has a chance to pass in order: angles that rise.
    std::vector<InputPosition> positions;
    const int number = 3 + task % 3;
    const double span = task % 2 == 0 ? 0.3 : 1.0;
    const double start = angle(random);
    for (int k = 0; k < number; ++k) {
      const double at = task % 3 == 0 ? start + k * 0.2 : start + span * angle(random);
      const int closure = task % 3 < 2 || angle(random) < 3 ? 1 : -1;
      if (pose_of(linkage, at, closure)) positions.push_back({at, closure});
    }
    if (positions.size() < 3) continue;
    ++tasks;
    const Passage found = passage_of(linkage, positions);
    EXPECT_EQ(to_string(found.defect), to_string(simulated(linkage, positions))) << task;
    ++counts[static_cast<std::size_t>(found.defect)];
    if (found.defect != Defect::none) continue;
    double least = 1.0;
    for (int k = 0; k <= steps; ++k) {
      const auto pose = pose_of(linkage, found.from + (found.to - found.from) * k / steps, positions.front().closure);
      ASSERT_TRUE(pose) << task;
      least = std::min(least, std::abs(std::sin(pose->coupler_angle - pose->output_angle)));
    }
    EXPECT_NEAR(std::sin(found.transmission), least, 1e-6) << task;
  }
  EXPECT_GT(tasks, 100);
  for (const Defect defect : {Defect::none, Defect::circuit, Defect::branch, Defect::order}) {
    EXPECT_GT(counts[static_cast<std::size_t>(defect)], 10) << to_string(defect);
  }
}

TEST(Passage, OverARangeStopsAtDeadPoints) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> length(0.5, 4), angle(-turn, turn);
  int passed = 0, stopped = 0;
  for (int task = 0; task < 300; ++task) {
    const Vec2 direction = unit(angle(random));
    const FourBar linkage{{0, 0}, length(random) * direction, length(random), length(random), length(random), {}};
    const double from = angle(random), to = from + 0.6 * angle(random);
    bool closes = true;
    for (int k = 0; k <= 2000; ++k) closes = closes && pose_of(linkage, from + (to - from) * k / 2000, 1).has_value();
    const Passage found = passage_over(linkage, from, to, 1);
    EXPECT_EQ(found.defect == Defect::none, closes) << task;
    ++(closes ? passed : stopped);
  }
  EXPECT_GT(passed, 50);
  EXPECT_GT(stopped, 50);
}

TEST(Passage, FourBarOfTwoDyadsHasTheirPositions) {
  const FourBar linkage{{0, 0}, {4, 0.5}, 1.5, 3.5, 3.0, {2, 1.4}};
  for (const int closure : {1, -1}) {
    const FourBarPose pose = *pose_of(linkage, 0.8, closure);
    // The body's frame is at the coupler's point and turned against the coupler.
    const double frame = 0.4;
    const BodyPosition position{pose.point, pose.coupler_angle + frame};
    const auto in_frame = [&](const Vec2& at) { return unit(-position.angle) * (at - position.at); };
    GuidingDyad input, output;
    input.fixed = linkage.a;
    input.moving = in_frame(pose.input_pin);
    input.length = linkage.input;
    output.fixed = linkage.b;
    output.moving = in_frame(pose.output_pin);
    output.length = linkage.output;
    const FourBar found = four_bar_of(input, output);
    EXPECT_NEAR(found.coupler, linkage.coupler, 1e-14);
    EXPECT_NEAR(norm(found.point - linkage.point), 0.0, 1e-14);
    const InputPosition at = input_position(input, output, position);
    EXPECT_NEAR(at.angle, 0.8, 1e-14);
    EXPECT_EQ(at.closure, closure);
  }
}

}  // namespace
}  // namespace poise::passage_test
