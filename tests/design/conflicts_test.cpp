// Goals that contradict each other are named, and no others.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/design/lever_designs.hpp"
#include "tests/support/seed.hpp"

namespace poise::test::goal_conflicts_test {
namespace {

using Status = GoalDesign::Status;

// Of a lever without weight the torque is T(a) = k a - k a0: a straight line over the angle, whose slope is in [1, 10].
constexpr double least_slope = 1.0, most_slope = 10.0, most_free = 10.0;
const std::string chosen = R"([variables]
"torsion_spring.coil.stiffness" = [1, 10]
"torsion_spring.coil.free_angle" = [-10, 10]
)";

/// A limit on the torque at an angle.
struct Limit {
  double at = 0.0, value = 0.0;
  bool is_least = false;

  std::string text() const {
    return fmt::format("[[goal]]\nof = \"force.drive\"\nalong = \"angle.lever\"\nat = {:.17g}\n{} = {:.17g}\n", at,
                       is_least ? "least" : "most", value);
  }
};

/// Half planes  a k + b m <= c  of the slope k and of m = k a0.
using HalfPlane = std::array<double, 3>;

/// Whether some k and m keep these limits, all loosened by `room`: the corners of the polygon are tried.
bool can_hold(const std::vector<Limit>& limits, double room) {
  std::vector<HalfPlane> planes{{1, 0, most_slope}, {-1, 0, -least_slope}, {-most_free, 1, 0}, {-most_free, -1, 0}};
  for (const Limit& one : limits) {
    const double sign = one.is_least ? -1.0 : 1.0;
    planes.push_back({sign * one.at, -sign, sign * one.value + room});
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const HalfPlane &p = planes[i], &q = planes[j];
      const double det = p[0] * q[1] - p[1] * q[0];
      if (std::abs(det) < 1e-12) continue;
      const double k = (p[2] * q[1] - p[1] * q[2]) / det, m = (p[0] * q[2] - p[2] * q[0]) / det;
      if (std::all_of(planes.begin(), planes.end(),
                      [&](const HalfPlane& one) { return one[0] * k + one[1] * m <= one[2] + 1e-9; })) {
        return true;
      }
    }
  }
  return false;
}

GoalDesign design_of_limits(const std::vector<Limit>& limits) {
  const app_tests::TempFolder folder;
  SprungLever lever;
  lever.gravity = 0.0;
  std::string text = chosen;
  for (const Limit& one : limits) text += one.text();
  GoalSearchOptions options;
  options.starts = 30;
  return design_of(folder, lever.text(), text, options);
}

void expect_conflict(const std::vector<Limit>& limits, const std::vector<int>& conflict) {
  const GoalDesign found = design_of_limits(limits);
  EXPECT_EQ(found.status, conflict.empty() ? Status::met : Status::not_met);
  EXPECT_EQ(found.conflict, conflict);
}

TEST(GoalConflicts, AreNamedAloneOrTogether) {
  const Limit easy{0.5, -90, true}, also_easy{2.0, 95, false};
  // One value at least 5 and at most 3.
  expect_conflict({easy, {1, 5, true}, also_easy, {1, 3, false}}, {1, 3});
  // T(1) - T(0) >= 12, while the slope is at most 10.
  expect_conflict({{0, 2, false}, easy, {1, 14, true}, also_easy}, {0, 2});
  // T(1) - T(0) <= 2 and T(0) - T(-1) >= 4: each two of the three can be kept.
  expect_conflict({{1, 3, false}, {0, 1, true}, {-1, -3, false}, easy}, {0, 1, 2});
  // Impossible alone: k (1 - a0) <= 110.
  expect_conflict({easy, {1, 120, true}, also_easy}, {1});
  // Alone, beside two others that conflict too.
  expect_conflict({{1, 5, true}, {1, 3, false}, {2, 130, true}}, {2});
  expect_conflict({easy, also_easy, {0, 2, false}, {1, 3, true}}, {});
}

// Lengths that a point cannot both have: its distances from two points that are 1 m apart differ by at most 1 m.
TEST(GoalConflicts, OfTwoLengths) {
  const app_tests::TempFolder folder;
  const std::string scene = R"(title = "lever"
source = "ours"
[ground]
points = { O = [0, 0], S = [3, 0], T = [4, 0] }
[body.lever]
points = { O = [0, 0], B = [1, 0.2] }
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[spring]]
name = "s"
points = ["ground.S", "lever.B"]
stiffness = 1
free_length = 1
[[spring]]
name = "t"
points = ["ground.T", "lever.B"]
stiffness = 1
free_length = 1
)";
  const auto goal = [](const char* of, const char* limit) {
    return fmt::format("[[goal]]\nof = \"length.{}\"\nalong = \"angle.lever\"\nat = 0.3\n{}\n", of, limit);
  };
  const std::string variables =
      "[variables]\n\"point.lever.B.x\" = [0.5, 2]\n\"point.lever.B.y\" = [-1, 1]\n\"spring.s.stiffness\" = [1, 2]\n";
  const std::string fine = "[[goal]]\nof = \"y.lever.B\"\nalong = \"angle.lever\"\nat = 0.3\nmost = 3\n";
  const GoalDesign found =
      design_of(folder, scene, variables + goal("s", "most = 1.5") + fine + goal("t", "least = 2.6"));
  EXPECT_EQ(found.status, Status::not_met);
  EXPECT_EQ(found.conflict, (std::vector<int>{0, 2}));
  EXPECT_TRUE(found.conflict_is_smallest);
  const GoalDesign can =
      design_of(folder, scene, variables + goal("s", "most = 1.8") + fine + goal("t", "least = 2.6"));
  EXPECT_EQ(can.status, Status::met);
}

// Each of two rows meets one of two goals: neither goal is impossible alone.
TEST(GoalConflicts, AreNotThoseOfOneRow) {
  const app_tests::TempFolder folder;
  folder.write("coils.csv", "name,stiffness\nsoft,3\nhard,8\n");
  SprungLever lever;
  lever.gravity = 0.0;
  const std::string text =
      "[variables]\n\"torsion_spring.coil.free_angle\" = [-0.1, 0.1]\n[[catalogue]]\nfile = \"coils.csv\"\nitems = "
      "[\"torsion_spring.coil\"]\n";
  for (const bool is_reversed : {false, true}) {
    const std::string one = Limit{1, 7, true}.text(), other = Limit{1, 4, false}.text();
    const GoalDesign found = design_of(folder, lever.text(), text + (is_reversed ? other + one : one + other));
    EXPECT_EQ(found.status, Status::not_met);
    EXPECT_NE(found.conflict.size(), 1u);
  }
}

// Random limits, whose smallest sets that contradict each other follow from corners of polygons.
TEST(RandomGoalConflicts, AreSmallestSets) {
  std::mt19937_64 random(seed(11));
  const auto uniform = [&](double a, double b) { return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53; };
  int conflicts = 0;
  for (int k = 0; k < cases(15, 400); ++k) {
    std::vector<Limit> limits(4 + random() % 3);
    for (Limit& one : limits) one = {uniform(-2, 2), uniform(-30, 30), uniform(0, 1) < 0.5};
    // Clear cases: no set is nearly kept, or nearly not.
    const std::size_t sets = std::size_t{1} << limits.size();
    std::vector<char> holds(sets, 1);
    bool is_clear = true;
    const auto members = [&](std::size_t set) {
      std::vector<Limit> out;
      for (std::size_t i = 0; i < limits.size(); ++i) {
        if ((set >> i & 1U) != 0) out.push_back(limits[i]);
      }
      return out;
    };
    for (std::size_t set = 1; set < sets; ++set) {
      holds[set] = can_hold(members(set), 0.0) ? 1 : 0;
      is_clear = is_clear && can_hold(members(set), 0.5) == (holds[set] != 0) &&
                 can_hold(members(set), -0.5) == (holds[set] != 0);
    }
    if (!is_clear) {
      --k;
      continue;
    }
    const GoalDesign found = design_of_limits(limits);
    std::string what;
    for (const Limit& one : limits) what += one.text();
    EXPECT_EQ(found.status == Status::met, holds[sets - 1] != 0) << what;
    EXPECT_EQ(found.conflict.empty(), holds[sets - 1] != 0) << what;
    if (holds[sets - 1] != 0) continue;
    ++conflicts;
    std::size_t named = 0;
    for (const int i : found.conflict) named |= std::size_t{1} << i;
    EXPECT_FALSE(holds[named]) << what;
    std::size_t smallest = limits.size();
    for (std::size_t set = 1; set < sets; ++set) {
      // No part of it is enough.
      EXPECT_TRUE(holds[set] != 0 || set == named || (set & named) != set) << what;
      if (holds[set] == 0) smallest = std::min(smallest, members(set).size());
    }
    EXPECT_TRUE(!found.conflict_is_smallest || found.conflict.size() == smallest) << what;
  }
  EXPECT_GT(conflicts, 5);
}

}  // namespace
}  // namespace poise::test::goal_conflicts_test
