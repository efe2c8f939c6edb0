#include "identification/fit/first_readings.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/experiments.hpp"

namespace poise::first_readings_test {
namespace {

TEST(FirstReadings, GiveTheStartAndNoOtherNuisance) {
  const Experiment lift = test::experiment("lift_experiment");
  const FitProblem problem(lift);
  const RunModel& run = problem.run(2);
  std::vector<double> displaced = run.released();
  displaced[0] += 0.001;
  displaced[1] += 1.0;
  const std::vector<double> started =
      started_from_readings(run, run.scene_values(), displaced, problem.ideal_record(2));
  ASSERT_EQ(started.size(), 3U);
  EXPECT_EQ(started[0], displaced[0]) << "the first readings do not determine the equilibrium";
  // A quarter of a period takes 46 ms: over 15 ms a parabola follows it to about 1 % of its 5 mrad.
  EXPECT_NEAR(started[1], run.released()[1], 5e-5) << "rad";
  EXPECT_NEAR(started[2], 0.0, 0.02) << "rad/s";
}

TEST(FirstReadings, AreTheGuessOnlyWhereNoReleaseIsGiven) {
  Experiment lift = test::experiment("lift_experiment");
  {
    const FitProblem problem(lift);
    EXPECT_EQ(first_guess(problem.run(0), problem.run(0).scene_values(), problem.ideal_record(3)),
              problem.run(0).released());
  }
  const Record record = FitProblem(lift).ideal_record(0);
  lift.runs[0].release.clear();
  const FitProblem problem(lift);
  EXPECT_EQ(first_guess(problem.run(0), problem.run(0).scene_values(), Record{}), problem.run(0).released());
  const std::vector<double> guess = first_guess(problem.run(0), problem.run(0).scene_values(), record);
  EXPECT_NEAR(guess[1], record.sensors[0].value[0], 5e-5) << "rad: obd itself is read";
}

// Of two sensors of one angle the one that is read more often gives the guess: the other's first 16 readings are spread
// over many oscillations.
TEST(FirstReadings, AreTakenFromTheFastestSensor) {
  Experiment lift = test::experiment("lift_experiment");
  const Record record = FitProblem(lift).ideal_record(0);
  lift.runs[0].release.clear();
  lift.sensors.insert(lift.sensors.begin(), lift.sensors[0]);
  const FitProblem problem(lift);
  Record both{{{}, record.sensors[0]}};
  for (std::size_t i = 0; i < record.sensors[0].time.size(); i += 50) {
    both.sensors[0].time.push_back(record.sensors[0].time[i]);
    both.sensors[0].value.push_back(record.sensors[0].value[i]);
  }
  EXPECT_NEAR(first_guess(problem.run(0), problem.run(0).scene_values(), both)[1], record.sensors[0].value[0], 5e-5);
}

TEST(FirstReadings, StartWorseThanTheFit) {
  const Experiment lift = test::experiment("lift_experiment");
  const FitProblem problem(lift);
  const std::vector<Record> records = problem.records();
  const Fit fitted = fit(problem, records);
  ASSERT_TRUE(fitted.usable()) << fitted.why;
  const std::vector<double> rms = rms_from_first_readings(problem, fitted, records);
  ASSERT_EQ(rms.size(), 1U);
  // With the fitted starts it is the noise; noise and curvature of the first 16 readings add an oscillation of their
  // own.
  EXPECT_GT(rms[0], 1.05 * fitted.rms[0]);
  EXPECT_LT(rms[0], 20 * fitted.rms[0]);
}

}  // namespace
}  // namespace poise::first_readings_test
