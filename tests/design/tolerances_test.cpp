// Designs that tolerances leave: worst corners by all corners, the share of samples, the widest tolerances.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/parameters.hpp"
#include "tests/design/lever_designs.hpp"

namespace poise::test::design_tolerances_test {
namespace {

using Status = GoalDesign::Status;

constexpr double limit = 7.0, at = 0.5;                   // of the torque, and the angle at which it is limited
constexpr double half_width[] = {0.2, 0.02, 0.05, 0.01};  // of stiffness, free angle, mass and center

// The torque at 1 rad as great as possible, so that the one at 0.5 rad is at its limit.
const std::string stiffest = fmt::format(R"(tolerances = "tolerances.toml"
[variables]
"torsion_spring.coil.stiffness" = [1, 20]
[[goal]]
of = "force.drive"
along = "angle.lever"
at = {}
most = {}
[[goal]]
of = "force.drive"
along = "angle.lever"
at = 1
aim = "greatest"
)",
                                         at, limit);

constexpr const char* names[] = {"torsion_spring.coil.stiffness", "torsion_spring.coil.free_angle", "body.lever.mass",
                                 "body.lever.center.x"};

std::string tolerances(const std::string& distribution) {
  std::string out = "[tolerances]\n";
  for (int k = 0; k < 4; ++k) {
    out +=
        fmt::format("\"{}\" = {{ half_width = {}, distribution = \"{}\" }}\n", names[k], half_width[k], distribution);
  }
  return out;
}

SprungLever lever_with(double stiffness) {
  SprungLever out;
  out.stiffness = stiffness;
  return out;
}

/// The lever with each number moved by a part of its half width.
SprungLever moved(SprungLever lever, const double (&parts)[4]) {
  lever.stiffness += parts[0] * half_width[0];
  lever.free_angle += parts[1] * half_width[1];
  lever.mass += parts[2] * half_width[2];
  lever.center += parts[3] * half_width[3];
  return lever;
}

/// By how much a half width moves the torque at the limit, to first order.
std::vector<double> moves(const SprungLever& lever) {
  return {std::abs(at - lever.free_angle) * half_width[0], lever.stiffness * half_width[1],
          lever.gravity * lever.center * std::cos(at) * half_width[2],
          lever.mass * lever.gravity * std::cos(at) * half_width[3]};
}

double greatest_of_corners(const SprungLever& lever) {
  double out = -HUGE_VAL;
  for (int corner = 0; corner < 16; ++corner) {
    double parts[4];
    for (int k = 0; k < 4; ++k) parts[k] = (corner >> k & 1) != 0 ? 1.0 : -1.0;
    out = std::max(out, moved(lever, parts).torque(at));
  }
  return out;
}

double stiffness_of(const GoalDesign& found) { return get_value(*found.scene, "torsion_spring.coil.stiffness"); }

TEST(DesignTolerances, AllCornersKeepTheLimit) {
  const app_tests::TempFolder folder;
  folder.write("tolerances.toml", tolerances("uniform"));
  const GoalDesign found = design_of(folder, SprungLever().text(), stiffest);
  ASSERT_EQ(found.status, Status::met);
  const SprungLever lever = lever_with(stiffness_of(found));
  // The worst corner reaches the limit; the first order leaves out products of two deviations.
  double first_order = 0.0;
  for (const double one : moves(lever)) first_order += one;
  EXPECT_GE(found.robust.tightened[0], first_order);
  EXPECT_NEAR(found.robust.tightened[0], greatest_of_corners(lever) - lever.torque(at), 1e-4 * first_order);
  EXPECT_TRUE(found.robust.corners_kept);
  EXPECT_LE(greatest_of_corners(lever), limit + 1e-9 * limit);
  EXPECT_NEAR(greatest_of_corners(lever), limit, 2e-4 * first_order);
  EXPECT_EQ(found.robust.kept, found.robust.samples);
}

TEST(DesignTolerances, WithoutThemTheLimitIsReachedAndACornerMissesIt) {
  const app_tests::TempFolder folder;
  const GoalDesign found = design_of(folder, SprungLever().text(), stiffest.substr(stiffest.find("[variables]")));
  ASSERT_EQ(found.status, Status::met);
  EXPECT_NEAR(lever_with(stiffness_of(found)).torque(at), limit, 1e-6);
  EXPECT_GT(greatest_of_corners(lever_with(stiffness_of(found))), limit + 0.1);
}

// One limit, nearly linear, three standard deviations away: the normal distribution leaves 0.99865 below it.
TEST(DesignTolerances, TheShareOfSamples) {
  const app_tests::TempFolder folder;
  folder.write("tolerances.toml", tolerances("normal"));
  GoalSearchOptions options;
  options.samples = 40'000;
  const GoalDesign found = design_of(folder, SprungLever().text(), "share = \"99.7 %\"\n" + stiffest, options);
  ASSERT_EQ(found.status, Status::met);
  const SprungLever lever = lever_with(stiffness_of(found));
  double variance = 0.0;
  for (const double one : moves(lever)) variance += one * one / 9.0;
  EXPECT_NEAR(found.robust.tightened[0], 3.0 * std::sqrt(variance), 1e-4);
  EXPECT_NEAR(lever.torque(at) + 3.0 * std::sqrt(variance), limit, 1e-4);
  EXPECT_EQ(found.robust.samples, 40'000);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal(0.0, 1.0 / 3.0);
  constexpr int samples = 400'000;
  int kept = 0;
  for (int i = 0; i < samples; ++i) {
    double parts[4];
    for (double& part : parts) part = normal(random);
    kept += moved(lever, parts).torque(at) <= limit ? 1 : 0;
  }
  const double share = static_cast<double>(kept) / samples;
  EXPECT_NEAR(static_cast<double>(found.robust.kept) / found.robust.samples, share,
              5.0 * std::sqrt(share * (1.0 - share) * (1.0 / 40'000 + 1.0 / samples)));
  EXPECT_NEAR(share, 0.99865, 5e-4);
}

// The least sum of (given / widest) for one limit  sum |g| t <= margin  has  t  in proportion to  sqrt(given / |g|).
TEST(DesignTolerances, TheWidestForOneLimit) {
  const app_tests::TempFolder folder;
  folder.write("tolerances.toml", tolerances("uniform"));
  const GoalProblem problem = read_design_text(folder, SprungLever().text(), stiffest);
  const GoalDesign found = design_for_goals(problem);
  ASSERT_EQ(found.status, Status::met);
  ASSERT_EQ(found.robust.widest.size(), 4u);
  const SprungLever lever = lever_with(stiffness_of(found));
  const std::vector<double> by = moves(lever);  // |g| given
  double sum = 0.0;
  for (const double one : by) sum += std::sqrt(one);
  const double margin = limit - lever.torque(at);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string& name = problem.tolerances[i].number;
    const auto k = static_cast<std::size_t>(std::find(std::begin(names), std::end(names), name) - std::begin(names));
    EXPECT_NEAR(found.robust.widest[i], half_width[k] * margin / (std::sqrt(by[k]) * sum), 1e-5 * half_width[k])
        << name;
  }
}

}  // namespace
}  // namespace poise::test::design_tolerances_test
