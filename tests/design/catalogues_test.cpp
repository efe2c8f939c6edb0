// Rows of catalogues and whole numbers against loops over all of them.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/planar.hpp"
#include "tests/design/lever_designs.hpp"

namespace poise::test::catalogues_test {
namespace {

using Status = GoalDesign::Status;

const char* const two_springs = R"(title = "lever"
source = "ours"
gravity = [0, -10]
[ground]
points = { O = [0, 0], S = [-0.3, 0.8], T = [0.2, 1.1] }
[body.lever]
points = { O = [0, 0], A = [0.25, 0.05], B = [0.4, -0.02] }
mass = 20
center = [0.5, 0]
[[pin]]
name = "O"
points = ["ground.O", "lever.O"]
[[spring]]
name = "one"
points = ["ground.S", "lever.A"]
stiffness = 300
free_length = 0.7
[[spring]]
name = "two"
points = ["ground.T", "lever.B"]
stiffness = 300
free_length = 0.7
)";

struct Row {
  double stiffness, free_length, longest;
};

constexpr double angles[] = {-0.3, 0.1, 0.5};

struct Spring {
  Vec2 on_ground, on_lever;

  double length(double angle) const { return norm(turned(angle) - on_ground); }
  /// The torque that holds the lever against it:  dV/da,  V = k (L - L0)^2 / 2.
  double torque(double angle, const Row& row) const {
    const Vec2 p = turned(angle), way{-p.y, p.x};
    const double slope = dot(p - on_ground, way) / length(angle);
    return row.stiffness * (length(angle) - row.free_length) * slope;
  }

 private:
  Vec2 turned(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * on_lever.x - s * on_lever.y, s * on_lever.x + c * on_lever.y};
  }
};

constexpr Spring one{{-0.3, 0.8}, {0.25, 0.05}}, two{{0.2, 1.1}, {0.4, -0.02}};

double torque(double angle, const Row& first, const Row& second) {
  return 20.0 * 10.0 * 0.5 * std::cos(angle) + one.torque(angle, first) + two.torque(angle, second);
}

std::vector<Row> forty_rows() {
  std::vector<Row> out;
  std::mt19937_64 random(4);
  const auto uniform = [&](double a, double b) { return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int k = 0; k < 40; ++k) {
    const double free = uniform(0.3, 0.9);
    out.push_back({uniform(50, 500), free, free * uniform(1.0, 2.0)});
  }
  return out;
}

std::string csv_of(const std::vector<Row>& rows) {
  std::string out = "name,stiffness,free_length,longest\n";
  for (std::size_t k = 0; k < rows.size(); ++k) {
    out += fmt::format("r{},{:.17g},{:.17g},{:.17g}\n", k, rows[k].stiffness, rows[k].free_length, rows[k].longest);
  }
  return out;
}

std::string goal(const std::string& limits) {
  return "[[goal]]\nof = \"force.drive\"\nalong = \"angle.lever\"\nat = [-0.3, 0.1, 0.5]\n" + limits + "\n";
}

const std::string both_catalogues =
    "[[catalogue]]\nfile = \"springs.csv\"\nitems = [\"spring.one\"]\n[[catalogue]]\nfile = \"springs.csv\"\nitems = "
    "[\"spring.two\"]\n";

TEST(Catalogues, TheBestOfAllPairsIsThatOfALoop) {
  const std::vector<Row> rows = forty_rows();
  const app_tests::TempFolder folder;
  folder.write("springs.csv", csv_of(rows));
  const auto fits = [&](const Spring& spring, const Row& row) {
    return std::all_of(std::begin(angles), std::end(angles), [&](double a) { return spring.length(a) <= row.longest; });
  };
  for (const bool is_limited : {true, false}) {
    // The greatest torque as small as possible, where it is at least 20 N m; or as far inside of limits as possible.
    const std::string text =
        both_catalogues + (is_limited ? goal("least = 20") + goal("aim = \"least\"") : goal("least = 30\nmost = 60"));
    double best = HUGE_VAL;
    int first = -1, second = -1;
    long kept = 0, by_length = 0;
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 40; ++j) {
        const Row &a = rows[static_cast<std::size_t>(i)], &b = rows[static_cast<std::size_t>(j)];
        if (!fits(one, a) || !fits(two, b)) {
          ++by_length;
          continue;
        }
        double least = HUGE_VAL, most = -HUGE_VAL;
        for (const double angle : angles) {
          least = std::min(least, torque(angle, a, b));
          most = std::max(most, torque(angle, a, b));
        }
        const bool keeps = is_limited ? least >= 20 : least >= 30 && most <= 60;
        if (!keeps) continue;
        ++kept;
        if (is_limited && most < best) {
          best = most;
          first = i;
          second = j;
        }
      }
    }
    ASSERT_GT(kept, 0);
    const GoalDesign found = design_of(folder, two_springs, text);
    ASSERT_EQ(found.status, Status::met) << found.check.why;
    EXPECT_EQ(found.met_starts, kept);
    EXPECT_EQ(found.catalogue.combinations, 1600.0);
    EXPECT_EQ(found.catalogue.by_length, by_length);
    EXPECT_EQ(found.catalogue.tried + found.catalogue.by_length + found.catalogue.by_proof, 1600);
    EXPECT_EQ(found.catalogue.left, 0);
    if (is_limited) {
      EXPECT_EQ(found.point.rows, (std::vector<int>{first, second}));
      EXPECT_NEAR(found.check.goals[1].most, best, 1e-9 * best);
    } else {
      const Row &a = rows[static_cast<std::size_t>(found.point.rows[0])],
                &b = rows[static_cast<std::size_t>(found.point.rows[1])];
      for (const double angle : angles) {
        EXPECT_GE(torque(angle, a, b), 30);
        EXPECT_LE(torque(angle, a, b), 60);
      }
    }
  }
}

TEST(Catalogues, NothingIsMetWhereNoPairCan) {
  const app_tests::TempFolder folder;
  folder.write("springs.csv", csv_of(forty_rows()));
  const GoalDesign found = design_of(folder, two_springs, both_catalogues + goal("least = 1e5"));
  EXPECT_EQ(found.status, Status::not_met);
  EXPECT_EQ(found.catalogue.left, 0);
  EXPECT_EQ(found.met_starts, 0);
}

// One row for both, and a number beside it: k and L0 are of a row, and the place of the second spring is free.
TEST(Catalogues, RowsWithANumberBesideThem) {
  const std::vector<Row> rows = forty_rows();
  const app_tests::TempFolder folder;
  folder.write("springs.csv", csv_of(rows));
  const std::string text =
      "[variables]\n\"body.lever.mass\" = [5, 30]\n[[catalogue]]\nfile = \"springs.csv\"\nitems = [\"spring.one\", "
      "\"spring.two\"]\n" +
      goal("least = 5\nmost = 9");
  // The mass adds m g c cos a, so that a row will do where the range of what remains is narrow enough.
  const auto can = [&](const Row& row) {
    double low = 5.0, high = 30.0;
    for (const double angle : angles) {
      if (one.length(angle) > row.longest || two.length(angle) > row.longest) return false;
      const double others = one.torque(angle, row) + two.torque(angle, row), by = 10.0 * 0.5 * std::cos(angle);
      low = std::max(low, (5.0 - others) / by);
      high = std::min(high, (9.0 - others) / by);
    }
    return low < high - 1e-3;
  };
  const long all = std::count_if(rows.begin(), rows.end(), can);
  const GoalDesign found = design_of(folder, two_springs, text);
  EXPECT_EQ(found.status == Status::met, all > 0);
  EXPECT_TRUE(all == 0 || can(rows[static_cast<std::size_t>(found.point.rows[0])]));
  EXPECT_EQ(found.catalogue.tried + found.catalogue.by_length + found.catalogue.by_proof + found.catalogue.left, 40);
}

TEST(Catalogues, WholeNumbers) {
  const app_tests::TempFolder folder;
  const std::string text =
      "[variables]\n\"spring.one.stiffness\" = { range = [300, 340], whole = true }\n\"spring.two.stiffness\" = { "
      "range = "
      "[100, 140], whole = true }\n" +
      goal("least = 20") + goal("aim = \"flat\"");
  double best = HUGE_VAL;
  int first = -1, second = -1;
  for (int i = 300; i <= 340; ++i) {
    for (int j = 100; j <= 140; ++j) {
      double least = HUGE_VAL, most = -HUGE_VAL;
      for (const double angle : angles) {
        const double value = torque(angle, {1.0 * i, 0.7, 9}, {1.0 * j, 0.7, 9});
        least = std::min(least, value);
        most = std::max(most, value);
      }
      if (least < 20 || most - least >= best) continue;
      best = most - least;
      first = i;
      second = j;
    }
  }
  ASSERT_GE(first, 300);
  const GoalDesign found = design_of(folder, two_springs, text);
  ASSERT_EQ(found.status, Status::met);
  EXPECT_EQ(found.point.rows, (std::vector<int>{first - 300, second - 100}));
  EXPECT_EQ(found.catalogue.combinations, 41.0 * 41.0);
}

}  // namespace
}  // namespace poise::test::catalogues_test
