#include "design/synthesis/four_bar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace poise::four_bar_test {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// The linkage with the known cognates.
FourBar crank_rocker() { return {{0, 0}, {4, 0}, 1.5, 3.5, 3.0, 2.5 * unit(40 * degree)}; }

TEST(FourBar, PosesHaveTheKnownCouplerPoints) {
  const FourBar linkage = crank_rocker();
  const auto pose = pose_of(linkage, 0.3, 1);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->point.x, 1.5721190708, 1e-10);
  EXPECT_NEAR(pose->point.y, 2.9394067493, 1e-10);
  const auto other = pose_of(linkage, 2, 1);
  EXPECT_NEAR(other->point.x, 0.5555516621, 1e-10);
  EXPECT_NEAR(other->point.y, 3.5680646089, 1e-10);
  EXPECT_NEAR(norm(other->output_pin - linkage.b), 3.0, 1e-14);
  EXPECT_NEAR(norm(other->output_pin - other->input_pin), 3.5, 1e-14);
  EXPECT_FALSE(pose_of({{0, 0}, {4, 0}, 1.5, 1.0, 1.0, {}}, 3, 1));
}

TEST(FourBar, ShortestLinkSaysWhatTurns) {
  const auto kind = [](double ground, double input, double coupler, double output) {
    return grashof_kind({{1, 2}, {1, 2 + ground}, input, coupler, output, {}});
  };
  EXPECT_EQ(kind(4, 1.5, 3.5, 3), GrashofKind::crank_rocker);
  EXPECT_EQ(kind(1.5, 4, 3.5, 3), GrashofKind::double_crank);
  EXPECT_EQ(kind(4, 3, 3.5, 1.5), GrashofKind::rocker_crank);
  EXPECT_EQ(kind(4, 3, 1.5, 3.5), GrashofKind::double_rocker);
  EXPECT_EQ(kind(4, 2.6, 3, 3.5), GrashofKind::triple_rocker);
  EXPECT_EQ(kind(4, 2.5, 3, 3.5), GrashofKind::change_point);
}

TEST(FourBar, CognatesHaveTheKnownLinks) {
  const FourBar linkage = crank_rocker();
  const auto [left, right] = roberts_cognates(linkage);
  EXPECT_NEAR(left.b.x, 2.1886984089, 1e-10);
  EXPECT_NEAR(left.b.y, 1.8365360277, 1e-10);
  EXPECT_NEAR(left.input, 2.5, 1e-14);
  EXPECT_NEAR(left.coupler, 1.0714285714, 1e-10);
  EXPECT_NEAR(left.output, 2.1428571429, 1e-10);
  EXPECT_NEAR(norm(left.point - 1.5 * unit(-40 * degree)), 0.0, 1e-14);
  EXPECT_NEAR(right.input, 2.2570383793, 1e-10);
  EXPECT_NEAR(right.coupler, 1.9346043251, 1e-10);
  EXPECT_NEAR(right.output, 0.9673021626, 1e-10);
  EXPECT_NEAR(norm(right.point - 3 * unit(45.396345 * degree)), 0.0, 1e-7);
}

TEST(FourBar, CognatesDrawTheSameCurve) {
  const FourBar linkage = crank_rocker();
  const auto [left, right] = roberts_cognates(linkage);
  for (const int closure : {-1, 1}) {
    for (double angle = 0.1; angle < 6.2; angle += 0.7) {
      // Links of the cognates stay parallel to lines of the coupler.
      const FourBarPose pose = *pose_of(linkage, angle, closure);
      const auto least = [&](const FourBar& cognate, const Vec2& link) {
        const double input_angle = std::atan2(link.y, link.x);
        double distance = INFINITY;
        for (const int way : {-1, 1}) {
          if (const auto at = pose_of(cognate, input_angle, way))
            distance = std::min(distance, norm(at->point - pose.point));
        }
        return distance;
      };
      EXPECT_LT(least(left, pose.point - pose.input_pin), 1e-12);
      EXPECT_LT(least(right, pose.point - pose.output_pin), 1e-12);
    }
  }
}

}  // namespace
}  // namespace poise::four_bar_test
