// Motion with contact: the judge against closed forms, and a small part of what poise_contacts runs.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"
#include "tests/judge/contact_campaign.hpp"
#include "tests/support/seed.hpp"

namespace poise::judge::random_contacts_test {
namespace {

/// A ball that falls on a floor.
struct Ball : ContactMechanism {
  explicit Ball(double restitution) {
    contacts = {{"floor", restitution, 0.0}};
    start = {1.0};
    start_rates = {0.0};
  }
  SmallSquare mass(const Small&) const override { return SmallSquare::Constant(1, 1, 2.0); }
  Small force(double, double, const Small&, const Small&) const override { return Small::Constant(1, -2.0 * 9.81); }
  double gap(std::size_t, double, const Small& q) const override { return q[0]; }
  Small row(std::size_t, double, const Small&) const override { return Small::Constant(1, 1.0); }
};

// Drop height 1 m, e = 0.8: impacts from sqrt(2 h/g) on, the last of them at that times (1 + e)/(1 - e).
TEST(ContactJudge, ABallComesToRestInFiniteTime) {
  const double fall = std::sqrt(2 / 9.81), e = 0.8, end = fall * (1 + e) / (1 - e);
  const Ball ball(e);
  const SteppedMotion found = step_motion(ball, {1e-3, 1e-10}, {end - 0.05, end + 0.1});
  ASSERT_TRUE(found.complete);
  EXPECT_NEAR(found.q[1][0], 0.0, 1e-8);
  EXPECT_NEAR(found.v[1][0], 0.0, 1e-8);
  ASSERT_GE(found.impacts.size(), 25U);
  double at = fall;
  for (std::size_t k = 0; k < 25; ++k) {
    EXPECT_NEAR(found.impacts[k], at, 1e-8) << k;
    at += 2 * fall * std::pow(e, static_cast<double>(k + 1));
  }
  EXPECT_NEAR(end, 4.06371276887, 1e-11);
}

TEST(ContactJudge, ABallWithoutLossKeepsItsHeight) {
  const double fall = std::sqrt(2 / 9.81);
  const Ball ball(1.0);
  const SteppedMotion found = step_motion(ball, {1e-3, 1e-10}, {20 * fall});
  EXPECT_NEAR(found.q[0][0], 1.0, 1e-7);
}

/// A block of half width 0.1 and half height 0.5 that rocks about its corners, with friction in which these stick.
struct RockingBlock : ContactMechanism {
  static constexpr double b = 0.1, h = 0.5;
  /// Turned clockwise by `angle` about its right corner, which is at the origin.
  explicit RockingBlock(double angle) {
    contacts = {{"left", 0.0, 5.0}, {"right", 0.0, 5.0}};
    start = {-b * std::cos(angle) + h * std::sin(angle), b * std::sin(angle) + h * std::cos(angle), -angle};
    start_rates = {0.0, 0.0, 0.0};
  }
  static double side(std::size_t corner) { return corner == 0 ? -b : b; }
  SmallSquare mass(const Small&) const override {
    SmallSquare out = SmallSquare::Identity(3, 3);
    out(2, 2) = (b * b + h * h) / 3;
    return out;
  }
  Small force(double, double, const Small&, const Small&) const override { return -9.81 * Small::Unit(3, 1); }
  double gap(std::size_t corner, double, const Small& q) const override {
    return q[1] + side(corner) * std::sin(q[2]) - h * std::cos(q[2]);
  }
  Small row(std::size_t corner, double, const Small& q) const override {
    Small out = Small::Unit(3, 1);
    out[2] = side(corner) * std::cos(q[2]) + h * std::sin(q[2]);
    return out;
  }
  Small tangent(std::size_t corner, const Small& q) const override {
    Small out = Small::Unit(3, 0);
    out[2] = -side(corner) * std::sin(q[2]) + h * std::cos(q[2]);
    return out;
  }
};

// G. W. Housner's block (1963) from half of its angle alpha: it is upright after a quarter of its exact period, where
// its rate falls to 49/52, and reaches 0.422193453732 alpha on the other side.
TEST(ContactJudge, ABlockRocks) {
  const double b = RockingBlock::b, h = RockingBlock::h, alpha = std::atan(b / h);
  const double p = std::sqrt(3 * 9.81 / (4 * std::hypot(b, h)));
  const RockingBlock block(alpha / 2);
  const double quarter = 1.38837434716 / 4;
  std::vector<double> times{quarter - 1e-5, quarter + 1e-5};
  for (int k = 1; k <= 200; ++k) times.push_back(quarter + 0.5 * k / 200);
  const SteppedMotion found = step_motion(block, {2e-4, 1e-9}, times);
  ASSERT_TRUE(found.complete);
  EXPECT_NEAR(found.v[0][2], p * std::sqrt(2 * (std::cos(alpha / 2) - std::cos(alpha))), 1e-4);
  EXPECT_NEAR(found.v[1][2] / found.v[0][2], 49.0 / 52, 1e-4);
  double most = 0.0;
  for (const Small& q : found.q) most = std::max(most, q[2]);
  EXPECT_NEAR(most / alpha, 0.422193453732, 2e-5);
}

TEST(RandomContacts, AgreeWithSmallStepsThatKnowNoEvents) {
  const app_tests::TempFolder folder;
  const int cases = test::cases(60, 1000);
  int confirmed = 0, marked = 0;
  for (int k = 1; k <= cases; ++k) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(k));
    JudgedContacts run = judge_contacts(seed, POISE_EXECUTABLE, folder.path("").string());
    if (run.beyond > 1) run = judge_contacts(seed, POISE_EXECUTABLE, folder.path("").string(), 4.0);
    EXPECT_LE(run.beyond, 1.0) << run.kind << " " << seed << ": apart by " << run.apart << ", errors " << run.error
                               << " and " << run.unknown << ", " << run.where;
    EXPECT_TRUE(run.exit_code == 0 || run.exit_code == 1) << run.kind << " " << seed << ": " << run.why;
    confirmed += run.confirmed ? 1 : 0;
    marked += run.until ? 1 : 0;
    if (!run.confirmed) RecordProperty("not_confirmed", run.kind + " " + std::to_string(seed) + ": " + run.why);
  }
  EXPECT_GE(100 * confirmed, 99 * cases);
  EXPECT_LE(100 * marked, 5 * cases);
}

// Energy never grows through a contact, and nothing passes a stop by more than the error that is printed.
TEST(RandomContacts, NeverPassAStopNorGainEnergy) {
  const app_tests::TempFolder folder;
  const int cases = test::cases(12, 700);
  int events = 0, confirmed = 0;
  for (int k = 1; k <= cases; ++k) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(k));
    const WatchedEvents run = watch_events(seed, POISE_EXECUTABLE, folder.path("").string(), 10.0);
    if (!run.confirmed) continue;
    ++confirmed;
    events += run.events;
    EXPECT_LE(run.passed, 1.0) << run.kind << " " << seed << ": " << run.where << " by " << run.depth;
    EXPECT_LE(run.gained, 1e-9) << run.kind << " " << seed;
  }
  EXPECT_GT(events, 10 * cases);
  EXPECT_GE(10 * confirmed, 9 * cases);
}

}  // namespace
}  // namespace poise::judge::random_contacts_test
