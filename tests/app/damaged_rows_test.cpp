// Damage to readings at rest and to columns of loads, as a person would see it: the cause, and what to write.

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "solvers/random_stream.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::app_tests::damaged_rows_test {
namespace {

/// An arm on a spring from a point above its pivot, with weights at its tip; positions where the moments balance, by
/// bisection.
struct Lamp {
  double stiffness = 950.0, free_length = 0.23, mass = 0.8;

  double moment(double phi, double weight) const {
    const double x = 0.1 * std::cos(phi), y = 0.1 * std::sin(phi) - 0.3, length = std::hypot(x, y);
    const double along = -x * 0.1 * std::sin(phi) + y * 0.1 * std::cos(phi);  // d(length^2/2)/d(phi)
    return -stiffness * (length - free_length) * along / length - (mass * 9.81 * 0.25 + weight * 0.5) * std::cos(phi);
  }
  double position(double weight) const {
    double low = -1.4, high = 1.4;
    for (int k = 0; k < 100; ++k) {
      const double middle = (low + high) / 2;
      (moment(middle, weight) > 0 ? low : high) = middle;
    }
    return low;
  }
};

struct Row {
  double weight, angle;
};

std::vector<Row> rows_of_lamp() {
  solvers::RandomStream random(3);
  std::vector<Row> out;
  for (double weight = 0.0; weight <= 10.0; weight += 0.5) {
    out.push_back({weight, Lamp().position(weight) + 1e-3 * random.normal()});
  }
  return out;
}

/// Fits k and l0 to the rows in this folder.
ProgramRun identify_lamp(const TempFolder& folder, const std::vector<Row>& rows) {
  folder.write("rig.toml", R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0], S = [0, 0.3] }
[body.arm]
points = { O = [0, 0], T = [0.5, 0], E = [0.1, 0] }
mass = 0.8
center = [0.25, 0]
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
name = "s"
points = ["ground.S", "arm.E"]
stiffness = 800
free_length = 0.2
[[force]]
name = "W"
at = "arm.T"
direction = [0, -1]
size = 0
[start]
arm = 0.2
)");
  folder.write("exp.toml", R"(scene = "rig.toml"
[[sensor]]
name = "phi"
angle = "arm"
noise = 1e-3
[[unknown]]
path = "spring.s.stiffness"
name = "k"
[[unknown]]
path = "spring.s.free_length"
name = "l0"
[[static]]
data = "w.csv"
inputs = { "load.W" = "W" }
)");
  std::string data = "W,phi\n";
  for (const Row& row : rows) data += fmt::format("{:.10g},{:.9f}\n", row.weight, row.angle);
  folder.write("w.csv", data);
  return run_poise({"identify", folder.path("exp.toml").string()});
}

TEST(DamagedRows, ASoundFileIsFitted) {
  const TempFolder folder;
  const ProgramRun run = identify_lamp(folder, rows_of_lamp());
  EXPECT_EQ(run.exit_code, 0) << run.out;
}

// Each is cured by what is named.
TEST(DamagedRows, CausesAreNamed) {
  struct Case {
    std::function<void(Row&)> damage;
    std::vector<std::string> words;
  };
  const std::vector<Case> all = {
      {[](Row& row) { row.angle *= 180 / M_PI; },
       {"the sensor \"phi\" has another unit, by pi/180", "factor = 0.0174"}},
      {[](Row& row) { row.angle *= -1; }, {"the sensor \"phi\" counts the other way", "factor = -1"}},
      {[](Row& row) { row.weight *= -1; }, {"the input \"load.W\" counts the other way"}},
      {[](Row& row) { std::swap(row.weight, row.angle); },
       {"the columns of \"phi\" and the input \"load.W\" are exchanged"}},
  };
  for (const Case& one : all) {
    const TempFolder folder;
    std::vector<Row> rows = rows_of_lamp();
    for (Row& row : rows) one.damage(row);
    const ProgramRun run = identify_lamp(folder, rows);
    EXPECT_EQ(run.exit_code, 1) << run.out;
    for (const std::string& words : one.words) EXPECT_TRUE(has(run.out, words)) << run.out << run.err;
  }
}

TEST(DamagedRows, MarkersAndCopiesAreNamed) {
  const TempFolder folder;
  std::vector<Row> rows = rows_of_lamp();
  rows[4].angle = -9999;
  const ProgramRun angle = identify_lamp(folder, rows);
  EXPECT_EQ(angle.exit_code, 2);
  EXPECT_TRUE(has(angle.err, "found -9999 once") && has(angle.err, "first in row 5")) << angle.err;
  rows = rows_of_lamp();
  rows[7].weight = 99999;
  const ProgramRun weight = identify_lamp(folder, rows);
  EXPECT_EQ(weight.exit_code, 2);
  EXPECT_TRUE(has(weight.err, "input \"load.W\"") && has(weight.err, "leave these rows out")) << weight.err;
  rows = rows_of_lamp();
  const std::vector<Row> once = rows;
  for (int k = 0; k < 3; ++k) rows.insert(rows.end(), once.begin(), once.end());
  const ProgramRun copied = identify_lamp(folder, rows);
  EXPECT_EQ(copied.exit_code, 1) << copied.out;
  EXPECT_TRUE(has(copied.out, "63 of 84 rows")) << copied.out;
}

// An arm that a torque drives against a damper: I w' = T - c w, read by its angle.
struct Driven {
  double inertia = 0.02, damping = 0.05;
};

enum class Damage { none, markers, stuck };  // in the column of the torque

ProgramRun identify_driven(const TempFolder& folder, double noise, double stated, Damage damage) {
  folder.write("rig.toml", R"([ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
inertia = 0.015
[[pin]]
points = ["ground.O", "arm.O"]
[[torsion_damper]]
name = "c"
bodies = ["ground", "arm"]
coefficient = 0.1
[[torque]]
name = "motor"
on = "arm"
value = 0
[start]
arm = 0
)");
  folder.write("exp.toml", fmt::format(R"(scene = "rig.toml"
[[sensor]]
name = "phi"
angle = "arm"
noise = {}
[[unknown]]
path = "body.arm.inertia"
[[unknown]]
path = "torsion_damper.c.coefficient"
[[run]]
data = "r.csv"
inputs = {{ "load.motor" = "tau" }}
)",
                                       stated));
  solvers::RandomStream random(7);
  std::string data = "time,phi,tau\n";
  const Driven arm;
  double phi = 0.0, w = 0.0;
  const auto torque = [](double t) { return 0.3 * std::sin(4 * t) + 0.1 * std::cos(9 * t); };
  constexpr int within = 100;
  for (int i = 0; i <= 300; ++i) {
    const double t = 0.01 * i;
    const bool is_lost = damage == Damage::markers && (i == 77 || i == 78 || i == 200);
    const bool is_stuck = damage == Damage::stuck && i >= 120 && i < 135;
    data += fmt::format("{:.9g},{:.9f},{:.9g}\n", t, phi + noise * random.normal(),
                        is_lost ? -9999.0 : torque(is_stuck ? 1.2 : t));
    for (int k = 0; k < within; ++k) {  // the torque is straight between readings
      const double h = 0.01 / within, part = (k + 0.5) / within;
      const double now = (1 - part) * torque(t) + part * torque(t + 0.01);
      const double middle = w + h / 2 * (now - arm.damping * w) / arm.inertia;
      w += h * (now - arm.damping * middle) / arm.inertia;
      phi += h * middle;
    }
  }
  folder.write("r.csv", data);
  return run_poise({"identify", folder.path("exp.toml").string()});
}

TEST(DamagedRows, ALoadThatStandsStillIsNamed) {
  const TempFolder folder;
  const ProgramRun run = identify_driven(folder, 1e-3, 1e-3, Damage::stuck);
  EXPECT_EQ(run.exit_code, 1) << run.out;
  EXPECT_TRUE(has(run.out, "he load of input \"load.motor\"") && has(run.out, "15 readings, from 1.2 s on")) << run.out;
}

TEST(DamagedRows, MarkersInALoadAreRefused) {
  const TempFolder folder;
  EXPECT_EQ(identify_driven(folder, 1e-3, 1e-3, Damage::none).exit_code, 0);
  const ProgramRun run = identify_driven(folder, 1e-3, 1e-3, Damage::markers);
  EXPECT_EQ(run.exit_code, 2) << run.out;
  EXPECT_TRUE(has(run.err, "input \"load.motor\"") && has(run.err, "found -9999 3 times") &&
              has(run.err, "first at 0.77 s") && has(run.err, "gaps = true"))
      << run.err;
}

TEST(DamagedRows, NoiseThatIsStatedTooSmallIsNamed) {
  const TempFolder folder;
  const ProgramRun run = identify_driven(folder, 1e-3, 1e-4, Damage::none);
  EXPECT_EQ(run.exit_code, 1) << run.out;
  EXPECT_TRUE(has(run.out, "the noise is stated too small, residuals are white (noise = 0.00")) << run.out;
}

}  // namespace
}  // namespace poise::app_tests::damaged_rows_test
