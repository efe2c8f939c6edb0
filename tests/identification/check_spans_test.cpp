// Records whose time column is not in seconds.

#include "identification/assessment/check_spans.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"

namespace poise::check_spans_test {
namespace {

using app_tests::TempFolder;

/// A wheel of 4 rad/s read 1200 times at 200 Hz, the times in units of `unit` seconds.
Experiment wheel_read_in(const TempFolder& folder, double unit, double rate, int readings, const std::string& keys) {
  std::string data = "time,turn\n";
  for (int i = 0; i < readings; ++i) {
    const double t = i / rate;
    data += std::to_string(t / unit) + "," + std::to_string(20 * std::cos(4 * t)) + "\n";
  }
  folder.write("wheel.csv", data);
  return read_experiment(
      app_tests::experiment(folder, std::string(app_tests::wheel_unknowns) + "[[run]]\ndata = \"wheel.csv\"\n" + keys));
}

std::string objection(const Experiment& experiment) {
  try {
    check_spans(FitProblem(experiment));
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("wheel.csv"));
  }
  return "";
}

TEST(CheckSpans, MillisecondsAreRefusedWithARemedy) {
  const TempFolder folder;
  EXPECT_EQ(
      objection(wheel_read_in(folder, 1e-3, 200, 1200, "")),
      "wheel.csv: time: expected a record in seconds, found 6e+03 s = 3.2e+03 periods of 1.9 s in run \"run 1\"; "
      "if the column is in milliseconds, add time_factor = 0.001 to the run, if it is in seconds, time_factor = 1");
}

TEST(CheckSpans, TimeFactorGivesSeconds) {
  const TempFolder folder;
  const Experiment e = wheel_read_in(folder, 1e-3, 200, 1200, "time_factor = 0.001\n");
  EXPECT_NEAR(e.records[0].sensors[0].time.back(), 1199.0 / 200, 1e-9);
  EXPECT_EQ(objection(e), "");
}

TEST(CheckSpans, HoursAreRefused) {
  const TempFolder folder;
  EXPECT_NE(objection(wheel_read_in(folder, 3600, 200, 1200, "")).find("time_factor = 60"), std::string::npos);
}

TEST(CheckSpans, SecondsAreTaken) {
  const TempFolder folder;
  EXPECT_EQ(objection(wheel_read_in(folder, 1, 200, 1200, "")), "");
  // 1500 oscillations, read four times in each.
  EXPECT_EQ(objection(wheel_read_in(folder, 1, 2.5, 6000, "")), "");
  // Half a second of a slow start.
  EXPECT_EQ(objection(wheel_read_in(folder, 1, 2000, 100, "")), "");
  // A strange record that states its unit.
  EXPECT_EQ(objection(wheel_read_in(folder, 1e-3, 200, 1200, "time_factor = 1\n")), "");
}

TEST(CheckSpans, SlackSpringsAreTakenAsTight) {
  const TempFolder folder;
  const auto one_way = [&](double unit) {
    wheel_read_in(folder, unit, 200, 1200, "");
    std::string scene = app_tests::wheel;
    scene.insert(scene.find("stiffness"), "acts = \"tension\"\nfree_angle = 30\n");  // slack at 20 degrees
    folder.write("wheel.toml", scene);
    return objection(read_experiment(folder.path("experiment.toml")));
  };
  EXPECT_EQ(one_way(1), "");
  EXPECT_NE(one_way(1e-3).find("time_factor = 0.001"), std::string::npos);
}

}  // namespace
}  // namespace poise::check_spans_test
