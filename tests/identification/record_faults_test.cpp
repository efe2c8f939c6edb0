// Faults of records that no model is needed to see: each is found where it is, and none in a sound record.

#include "identification/assessment/record_faults.hpp"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "solvers/random_stream.hpp"
#include "tests/identification/experiments.hpp"

namespace poise::record_faults_test {
namespace {

constexpr double noise = 1e-3;

/// A measured run of an oscillator at 200 Hz for 5 s: x = exp(-0.1 t) cos(5 t) with noise, its clock beginning at 10 s.
Experiment measured(const std::function<double(double)>& place = [](double t) {
  return std::exp(-0.1 * t) * std::cos(5 * t);
}) {
  Experiment out = test::oscillator();
  out.runs.front().data = {"data.csv"};
  out.runs.front().name = "free";
  out.runs.front().clock_zero = 10;
  Series series;
  solvers::RandomStream random(1);
  for (int i = 0; i < 1000; ++i) {
    series.time.push_back(i / 200.0);
    series.value.push_back(place(series.time.back()) + noise * random.normal());
  }
  out.records = {Record{{series}}};
  return out;
}

Series& readings(Experiment& experiment) { return experiment.records.front().sensors.front(); }

std::string words_of(const std::vector<RecordFault>& faults) {
  std::string out;
  for (const RecordFault& fault : faults) out += fault.words + "; " + fault.cure + "\n";
  return out;
}

bool says(const Experiment& experiment, const std::string& words) {
  const std::string all = words_of(record_faults(experiment));
  EXPECT_NE(all.find(words), std::string::npos) << all;
  return all.find(words) != std::string::npos;
}

TEST(NoiseAtMost, IsNotLessThanWhiteOrCorrelatedNoiseBesideAMotion) {
  for (const double correlation : {0.0, 0.5, 0.9}) {
    for (const double rate : {20.0, 200.0, 2000.0}) {
      Series series;
      solvers::RandomStream random(2);
      double x = 0.0;
      for (int i = 0; i < 5000; ++i) {
        x = correlation * x + std::sqrt(1 - correlation * correlation) * random.normal();
        series.time.push_back(i / rate);
        series.value.push_back(noise * x + std::cos(5 * series.time.back()));
      }
      const double most = noise_at_most(series);
      EXPECT_GT(most, 0.9 * noise) << correlation << " at " << rate << " Hz";
      // The noise is seen to no better than the motion changes within a few readings.
      EXPECT_LT(most, 4.5 * noise + std::pow(5 / rate, 3)) << correlation << " at " << rate << " Hz";
      for (double& value : series.value) value = 0.05 * std::round(value / 0.05);
      EXPECT_GE(noise_at_most(series), 0.99 * 0.05 / std::sqrt(12.0)) << "coarse steps are noise too";
    }
  }
  EXPECT_TRUE(std::isinf(noise_at_most({{0, 1, 2}, {0, 1, 2}}))) << "three readings show none";
}

TEST(RecordFaults, ASoundRecordHasNone) {
  EXPECT_EQ(words_of(record_faults(measured())), "");
  Experiment coarse = measured();
  for (double& value : readings(coarse).value) value = std::round(value / 0.02) * 0.02;
  EXPECT_EQ(words_of(record_faults(coarse)), "") << "an encoder stands still where the motion turns round";
  EXPECT_EQ(words_of(record_faults(measured([](double t) { return 1e-6 * std::exp(4 * t); }))), "")
      << "an unstable equilibrium takes its time";
  EXPECT_EQ(words_of(record_faults(measured([](double) { return 0.3; }))), "");
  Experiment gap = measured();
  readings(gap).time.erase(readings(gap).time.begin() + 400, readings(gap).time.begin() + 460);
  readings(gap).value.erase(readings(gap).value.begin() + 400, readings(gap).value.begin() + 460);
  EXPECT_EQ(words_of(record_faults(gap)), "") << "what was not read is missed by nobody";
}

TEST(RecordFaults, CutOffReadings) {
  Experiment cut = measured();
  for (double& value : readings(cut).value) value = std::min(value, 0.7);
  EXPECT_TRUE(says(cut, "are cut off at 0.7"));
  EXPECT_TRUE(says(cut, "add skip = [[10, 10.1"));
  for (double& value : readings(cut).value) value = std::round(value / 0.01) * 0.01;
  EXPECT_TRUE(says(cut, "are cut off at 0.7"));
}

TEST(RecordFaults, StuckReadings) {
  Experiment stuck = measured();
  for (std::size_t i = 300; i < 360; ++i) readings(stuck).value[i] = readings(stuck).value[300];
  EXPECT_TRUE(says(stuck, "stand still at"));
  EXPECT_TRUE(says(stuck, "skip = [[11.5, 11.795]]"));
}

TEST(RecordFaults, ConstantReadingsAreNoFaultByThemselves) {
  const std::vector<RecordFault> faults = [] {
    Experiment constant = measured();
    for (double& value : readings(constant).value) value = 0.25;
    return record_faults(constant);
  }();
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_FALSE(faults[0].is_wrong);
  EXPECT_EQ(faults[0].words, "all 1000 readings of \"x\" in run \"free\" are 0.25");
}

TEST(RecordFaults, LostReadingsAndAClockThatJumps) {
  Experiment lost = measured();
  Series& series = readings(lost);
  series.value.erase(series.value.begin() + 430, series.value.begin() + 450);
  series.time.resize(series.value.size());
  EXPECT_TRUE(says(lost, " s of motion make: readings were lost"));
  EXPECT_TRUE(says(lost, "to = 12.145, and add a second run with from = 12.15"));
  Experiment jump = measured();
  for (std::size_t i = 430; i < 1000; ++i) readings(jump).time[i] += 0.1;
  EXPECT_TRUE(says(jump, "the clock jumped"));
}

TEST(RecordFaults, WildReadings) {
  Experiment wild = measured();
  readings(wild).value[200] += 0.8;
  readings(wild).value[500] -= 5;
  EXPECT_TRUE(says(wild, "2 readings are wild"));
  wild.loss = Loss::huber;
  EXPECT_EQ(words_of(record_faults(wild)), "") << "this loss bears them";
}

TEST(RecordFaults, AStandstillAtTheBeginning) {
  const auto waits = [](double t) { return t < 0.8 ? 1.0 : std::cos(5 * (t - 0.8)); };
  EXPECT_TRUE(says(measured(waits), "stands still until 10."));
  EXPECT_TRUE(says(measured(waits), "add from = 10."));
  Experiment driven = measured(waits);
  driven.scene.time_functions.emplace_back();
  EXPECT_EQ(words_of(record_faults(driven)), "") << "what is driven may wait";
}

/// What is said about a record in which readings are `value` at these places.
std::string marked(double value, const std::vector<std::size_t>& places) {
  Experiment experiment = measured();
  for (const std::size_t i : places) readings(experiment).value[i] = value;
  try {
    expect_no_markers(experiment);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Markers, AreRefused) {
  EXPECT_NE(marked(-9999, {400}).find("found -9999 once in run \"free\", first at 12 s"), std::string::npos)
      << marked(-9999, {400});
  EXPECT_NE(marked(65535, {0, 1, 2, 700}).find("found 65535 4 times"), std::string::npos);
  EXPECT_NE(marked(12.5, {100, 200, 300, 301}).find("add missing = [12.5]"), std::string::npos);
  EXPECT_NE(marked(0, {10, 110, 260, 370, 380, 510, 630}).find("found 0"), std::string::npos);
  EXPECT_EQ(marked(12.5, {100}), "") << "a single one is wild, no marker";
  EXPECT_EQ(marked(0.2, {}), "");
}

TEST(Markers, AreBelievedWhereTheSensorSaysSo) {
  Experiment experiment = measured();
  readings(experiment).value[400] = -9999;
  experiment.sensors.front().missing = std::vector<double>{};
  EXPECT_NO_THROW(expect_no_markers(experiment));
}

}  // namespace
}  // namespace poise::record_faults_test
