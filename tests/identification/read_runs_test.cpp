#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/experiment/experiment.hpp"
#include "tests/identification/bench.hpp"

namespace poise::read_runs_test {
namespace {

using test::Bench;
using test::degree;
using Numbers = std::vector<double>;

const std::string& header = test::bench_header;
const std::string& sensor = test::bench_sensor;
const std::string& run = test::bench_run;
const std::string& measured = test::bench_measured;

const char* const segments = "part,t,a\nx,0,1\nx,1,2\nx,2,3\nx,3,4\nx,4,5\ny,7,6\ny,8,7\ny,9,8\ny,10,9\ny,11,10\n";

/// Run 1 begins in line 6.
std::string error_of_run(const std::string& keys, const std::string& data = "") {
  return Bench(header + sensor + "[[run]]\n" + keys, data).error();
}

TEST(ReadRuns, ReadsSimulatedRunsInSi) {
  const std::vector<poise::Run> runs =
      Bench(
          header + sensor + run +
          "seed = 7\nset = { \"body.block.mass\" = 0, \"load.P\" = 3 }\nlabels = { load = \"none\", place = \"low\" }\n"
          "rest = { angle = \"crank\", at = 30, by = \"spring.coil.free_length\" }\n"
          "release = { crank = 5, rail = 2 }\nrelease_rate = { crank = -10 }\n" +
          "[[run]]\nname = \"other\"\nduration = 0.5\nrate = 4\nstart_known = true\n"
          "rest = { travel = \"rail\", at = 380, by = \"torsion_spring.wrap.free_angle\", known = true }\n")
          .read()
          .runs;
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].name, "run 1");
  EXPECT_EQ(runs[0].line, 6);
  EXPECT_DOUBLE_EQ(runs[0].duration, 2.0);
  EXPECT_DOUBLE_EQ(runs[0].sample_rate, 100.0);
  EXPECT_EQ(runs[0].seed, 7u);
  EXPECT_TRUE(runs[0].data.empty());
  ASSERT_EQ(runs[0].changes.size(), 2u);
  EXPECT_EQ(runs[0].changes[0].path, "body.block.mass");
  EXPECT_EQ(runs[0].changes[0].value, 0.0);
  EXPECT_EQ(runs[0].changes[1].path, "load.P");
  EXPECT_EQ(runs[0].changes[1].value, 3.0) << "as --set: in the scene's units";
  EXPECT_EQ(runs[0].changes[1].line, 10);
  using Label = std::pair<std::string, std::string>;
  EXPECT_EQ(runs[0].labels, (std::vector<Label>{{"load", "none"}, {"place", "low"}}));
  ASSERT_TRUE(runs[0].equilibrium);
  EXPECT_EQ(runs[0].equilibrium->body, 1);
  EXPECT_EQ(runs[0].equilibrium->joint, -1);
  EXPECT_DOUBLE_EQ(runs[0].equilibrium->at, 30 * degree);
  EXPECT_EQ(runs[0].equilibrium->by, "spring.coil.free_length");
  EXPECT_TRUE(runs[0].equilibrium->unknown);
  ASSERT_EQ(runs[0].release.size(), 3u);
  EXPECT_EQ(runs[0].release[0].body, 1);
  EXPECT_EQ(runs[0].release[0].joint, -1);
  EXPECT_FALSE(runs[0].release[0].rate);
  EXPECT_DOUBLE_EQ(runs[0].release[0].value, 5 * degree);
  EXPECT_EQ(runs[0].release[1].joint, 3);
  EXPECT_EQ(runs[0].release[1].body, -1);
  EXPECT_DOUBLE_EQ(runs[0].release[1].value, 2e-3);
  EXPECT_TRUE(runs[0].release[2].rate);
  EXPECT_DOUBLE_EQ(runs[0].release[2].value, -10 * degree);
  EXPECT_TRUE(runs[0].unknown_start);
  EXPECT_EQ(runs[1].name, "other");
  EXPECT_EQ(runs[1].equilibrium->joint, 3);
  EXPECT_DOUBLE_EQ(runs[1].equilibrium->at, 0.38);
  EXPECT_FALSE(runs[1].equilibrium->unknown);
  EXPECT_FALSE(runs[1].unknown_start);
}

TEST(ReadRuns, ReadsTheKeptPartOfARecord) {
  std::string data = "time,a\n";
  for (int i = 0; i < 30; ++i) data += fmt::format("{},{}\n", 100 + 0.5 * i, i == 12 ? -9999 : i);
  const auto read = [&](const std::string& keys) {
    return Bench(header + sensor + "missing = [-9999]\n" + measured + keys, data).read();
  };
  const Experiment kept = read("from = 102\nto = 107.2\nskip = [[103, 103.6], [105, 105]]\n");
  const Series& series = kept.records.at(0).sensors.at(0);
  EXPECT_EQ(series.time, (Numbers{0, 0.5, 2, 2.5, 3.5, 4.5, 5})) << "s since the first reading, without the marker";
  EXPECT_DOUBLE_EQ(series.value.front(), 4 * degree);
  EXPECT_DOUBLE_EQ(series.value.back(), 14 * degree);
  EXPECT_DOUBLE_EQ(kept.runs.at(0).clock_zero, 102);
  const std::string twice = header + sensor + "missing = [-9999]\n" + measured + "to = 105\n" + measured;
  const Experiment parts = Bench(twice + "from = 105.1\n", data).read();
  ASSERT_EQ(parts.records.size(), 2u) << "two runs may share a file where their parts are apart";
  EXPECT_DOUBLE_EQ(parts.records[1].sensors[0].value.front(), 11 * degree);
  EXPECT_EQ(Bench(twice + "from = 105\n", data)
                .error()
                .find("experiment.toml:11: run 2.data: expected the column \"a\" of "
                      "\"data.csv\" once, run \"run 1\" reads it too"),
            0u)
      << Bench(twice + "from = 105\n", data).error();
  EXPECT_EQ(error_of_run("data = \"data.csv\"\nfrom = 3\nto = 2\n", data),
            "experiment.toml:9: run 1.to: expected to > from; exchange them");
}

TEST(ReadRuns, RefusesNumbersOfReadingsAsTimes) {
  std::string data = "time,a\n";
  for (int i = 0; i < 30; ++i) data += fmt::format("{},{}\n", i + 1, std::sin(i));
  const std::string said = Bench(header + sensor + measured, data).error();
  EXPECT_NE(said.find("found 1, 2, 3, ... as the numbers of readings are; add time_factor"), std::string::npos) << said;
  EXPECT_EQ(Bench(header + sensor + measured + "time_factor = 1\n", data).error(), "");
}

TEST(ReadRuns, SimulatedRunsHaveEmptyRecords) {
  const Experiment experiment = Bench(header + sensor + run + run).read();
  ASSERT_EQ(experiment.records.size(), 2u);
  EXPECT_TRUE(experiment.records[0].empty());
  EXPECT_TRUE(experiment.records[1].empty());
}

TEST(ReadRuns, ReadsAMeasuredRunFromTimeZero) {
  const Experiment experiment =
      Bench(header + sensor + "zero = 90\nfactor = -2\n" + measured, "time,a\n5,0\n5.5,10\n7,20\n").read();
  ASSERT_EQ(experiment.records.size(), 1u);
  EXPECT_EQ(experiment.records[0].sensors[0].time, (Numbers{0, 0.5, 2}));
  ASSERT_EQ(experiment.records[0].sensors.size(), 1u);
  const double expected[] = {90 * degree, 70 * degree, 50 * degree};
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(experiment.records[0].sensors[0].value[i], expected[i], 1e-15);
  EXPECT_EQ(experiment.runs[0].name, "run 1");
  EXPECT_FALSE(experiment.runs[0].segment);
}

TEST(ReadRuns, MakesARunOfEachSegment) {
  const std::string keys = "time = \"t\"\nsplit = \"part\"\n";
  const Experiment experiment =
      Bench(header + sensor + measured + keys + "labels = { load = \"none\" }\n", segments).read();
  ASSERT_EQ(experiment.runs.size(), 2u);
  EXPECT_EQ(experiment.runs[0].name, "segment x");
  EXPECT_EQ(experiment.runs[0].segment, "x");
  EXPECT_EQ(experiment.runs[1].name, "segment y");
  EXPECT_EQ(experiment.runs[1].labels.size(), 1u);
  EXPECT_EQ(experiment.records[1].sensors[0].time, (Numbers{0, 1, 2, 3, 4}));
  EXPECT_DOUBLE_EQ(experiment.records[1].sensors[0].value[0], 6 * degree);

  const Experiment chosen = Bench(header + sensor + measured + keys +
                                      "name = \"late\"\nsegments = [\"y\"]\nevery = 2\n[[run]]\ndata = \"data.csv\"\n"
                                      "segments = [\"x\"]\n" +
                                      keys,
                                  segments)
                                .read();
  ASSERT_EQ(chosen.runs.size(), 2u);
  EXPECT_EQ(chosen.runs[0].name, "late y");
  EXPECT_EQ(chosen.records[0].sensors[0].time, (Numbers{0, 2, 4}));
  EXPECT_DOUBLE_EQ(chosen.records[0].sensors[0].value[2], 10 * degree);
  EXPECT_EQ(chosen.runs[1].name, "segment x");
  const Experiment ordered = Bench(header + sensor + measured + keys + "segments = [\"y\", \"x\"]\n", segments).read();
  ASSERT_EQ(ordered.runs.size(), 2u);
  EXPECT_EQ(ordered.runs[0].name, "segment y");
}

TEST(ReadRuns, TakesAnotherDataFile) {
  const Bench bench(header + sensor + measured);
  EXPECT_EQ(bench.error(),
            "experiment.toml:7: run 1.data: expected a data file, there is no \"data.csv\"; give it with --data FILE");
  const std::string other = bench.folder().write("other.csv", "time,a\n0,1\n1,2\n2,3\n");
  const Experiment experiment = bench.read({.data = other});
  EXPECT_EQ(experiment.runs[0].data, (std::vector<std::filesystem::path>{other}));
  EXPECT_DOUBLE_EQ(experiment.records[0].sensors[0].value[2], 3 * degree);
  EXPECT_EQ(bench.error({.data = bench.folder().path("none.csv")}),
            "experiment.toml:7: run 1.data: expected a data file, there is no \"none.csv\"; give it with --data FILE");
  EXPECT_EQ(Bench(header + sensor + run).error({.data = "d.csv"}),
            "--data d.csv: expected an experiment with measured runs; give one a data file");
  EXPECT_EQ(Bench(header + sensor + measured + "[[run]]\ndata = \"b.csv\"\n").error({.data = other}),
            "experiment.toml:9: run 2.data: expected all runs to name one data file, for --data to take its place");
}

TEST(ReadRuns, RejectsRuns) {
  EXPECT_EQ(error_of_run("rate = 100\n"),
            "experiment.toml:6: run 1: expected the key data, or duration and rate of a simulation; add duration = "
            "NUMBER");
  EXPECT_EQ(error_of_run("duration = 1\n"),
            "experiment.toml:6: run 1: expected the key data, or duration and rate of a simulation; add rate = NUMBER");
  EXPECT_EQ(
      error_of_run("duration = 1\nrate = 1\n"),
      "experiment.toml:7: run 1.duration: expected duration rate >= 2, for at least 3 readings; raise one of them");
  EXPECT_EQ(error_of_run("duration = 1e9\nrate = 1\n"),
            "experiment.toml:7: run 1.duration: expected duration rate <= 1e7 readings; lower one of them");
  EXPECT_EQ(error_of_run("duration = 0\nrate = 1\n"),
            "experiment.toml:7: run 1.duration: expected a finite number > 0, found 0");
  const std::string given = "duration = 2\nrate = 100\n";
  for (const std::string seed : {"-1", "0.5", "1e16"}) {
    EXPECT_EQ(error_of_run(fmt::format("{}seed = {}\n", given, seed)),
              "experiment.toml:9: run 1.seed: expected a whole number from 0 to 2^53");
  }
  EXPECT_EQ(
      error_of_run(given + "split = \"s\"\n"),
      "experiment.toml:9: run 1.split: expected split of a measured run only, this one has no data; leave it out, "
      "or add data = \"...\"");
  EXPECT_EQ(error_of_run(given + "splits = \"s\"\n"),
            "experiment.toml:9: run 1.splits: expected one of the keys name, set, labels, rest, release, release_rate, "
            "start_known, sensors, inputs, data, duration, rate, seed");
  EXPECT_EQ(error_of_run(given + "labels = { run = \"a\" }\n"),
            "experiment.toml:9: run 1.labels.run: expected another label; per = \"run\" means each run by itself");
  EXPECT_EQ(error_of_run(given + "labels = { h = \"\" }\n"),
            "experiment.toml:9: run 1.labels.h: expected a name that is not empty");
  EXPECT_EQ(error_of_run(given + "labels = { \"\" = \"a\" }\n"),
            "experiment.toml:9: run 1.labels.: expected a name that is not empty");
  EXPECT_EQ(
      error_of_run(given + "set = { \"load.Q\" = 1 }\n"),
      "experiment.toml:9: run 1.set: load.Q: expected the path of a number of the scene; did you mean \"load.P\"?");
  EXPECT_EQ(error_of_run(given + "release = { ground = 1 }\n"),
            "experiment.toml:9: run 1.release.ground: expected the name of a body, slide or pin_in_slot; known here: "
            "crank, rod, block, rail");
  EXPECT_EQ(error_of_run(given + "release_rate.arm.left = 1\n"),
            "experiment.toml:9: run 1.release_rate.arm: expected a number; put a name that holds dots in quotes");
  EXPECT_EQ(error_of_run(given + "start_known = 1\n"),
            "experiment.toml:9: run 1.start_known: expected true or false, without quotes");
  EXPECT_EQ(error_of_run(given + "name = \"a\"\n[[run]]\nname = \"a\"\n"),
            "experiment.toml:11: run \"a\".name: expected a name of its own; \"a\" is taken in line 9");
}

TEST(ReadRuns, RejectsEquilibriumPoses) {
  const auto error_of_equilibrium = [](const std::string& keys) {
    return error_of_run("duration = 2\nrate = 100\nrest = { " + keys + " }\n");
  };
  const std::string place = "experiment.toml:9: run 1.rest";
  const std::string by = ", by = \"spring.coil.free_length\"";
  EXPECT_EQ(error_of_equilibrium("at = 1" + by),
            place + ": expected one of the keys angle = \"BODY\", travel = \"JOINT\"");
  EXPECT_EQ(error_of_equilibrium("angle = \"rod\", travel = \"rail\", at = 1" + by),
            place + ": expected one of the keys angle = \"BODY\", travel = \"JOINT\"");
  EXPECT_EQ(error_of_equilibrium("angle = \"rod\"" + by), place + ": expected the key at; add at = NUMBER");
  EXPECT_EQ(error_of_equilibrium("angle = \"rod\", at = 1"), place + ": expected the key by; add by = \"...\"");
  EXPECT_EQ(error_of_equilibrium("angle = \"rod\", at = 1, fixed = true" + by),
            place + ".fixed: expected one of the keys angle, travel, at, by, known");
  EXPECT_EQ(error_of_equilibrium("angle = \"rod\", at = 1, known = 0" + by),
            place + ".known: expected true or false, without quotes");
  EXPECT_EQ(error_of_equilibrium("angle = \"rod\", at = 1, by = \"spring.coil.stiffness\""),
            place +
                ".by: expected spring.NAME.free_length or torsion_spring.NAME.free_angle, found "
                "\"spring.coil.stiffness\"; known here: spring.coil.free_length, torsion_spring.wrap.free_angle");
}

TEST(ReadRuns, RejectsMeasuredRuns) {
  const std::string data = "data = \"data.csv\"\n";
  const std::string good = "time,a\n0,1\n1,2\n2,3\n";
  EXPECT_EQ(error_of_run("data = \"\"\n"),
            "experiment.toml:7: run 1.data: expected the path of a data file, relative to this file");
  EXPECT_EQ(error_of_run(data + "duration = 2\n", good),
            "experiment.toml:8: run 1.duration: expected duration of a simulated run only, this one has data; leave it "
            "out, or leave data out to simulate");
  EXPECT_EQ(error_of_run(data + "time_factor = 0\n", good),
            "experiment.toml:8: run 1.time_factor: expected a finite number > 0, found 0");
  EXPECT_EQ(error_of_run(data + "every = 0\n", good),
            "experiment.toml:8: run 1.every: expected a whole number from 1 to 2^53");
  EXPECT_EQ(error_of_run(data + "every = 2\n", good),
            "data.csv:2: time: expected at least 3 rows, found 2 after thinning; take more of them");
  EXPECT_EQ(error_of_run(data + "split = \"\"\n", good),
            "experiment.toml:8: run 1.split: expected the name of a column");
  EXPECT_EQ(error_of_run(data + "segments = [\"x\"]\n", good),
            "experiment.toml:8: run 1.segments: expected the key split as well, the column that names the segments");
  const std::string split = data + "time = \"t\"\nsplit = \"part\"\n";
  EXPECT_EQ(error_of_run(split + "segments = []\n", segments),
            "experiment.toml:10: run 1.segments: expected a segment; leave the key out for all");
  EXPECT_EQ(error_of_run(split + "segments = [1]\n", segments),
            "experiment.toml:10: run 1.segments: expected a list of strings [\"...\", ...]");
  EXPECT_EQ(error_of_run(split + "segments = \"x\"\n", segments),
            "experiment.toml:10: run 1.segments: expected a list of strings [\"...\", ...]");
  EXPECT_EQ(
      error_of_run(split + "segments = [\"x\", \"z\"]\n", segments),
      "experiment.toml:10: run 1.segments: expected a value of the column \"part\", found \"z\"; known here: x, y");
  EXPECT_EQ(error_of_run(split, "part,t,a\n"),
            "experiment.toml:7: run 1.data: expected a data file with rows, \"data.csv\" has only a header");
  EXPECT_EQ(error_of_run(split + "[[run]]\nname = \"segment x\"\n" + data + "time = \"t\"\n", segments),
            "experiment.toml:10: run \"segment x\": expected a name of its own, it is taken in line 6; rename the run")
      << "rows of both segments ascend";
  EXPECT_EQ(error_of_run(data, "t,a\n0,1\n"),
            "data.csv:1: time: expected a column of this name in the header; known here: t, a");
  EXPECT_EQ(error_of_run(data, "time,phi\n0,1\n"),
            "data.csv:1: a: expected a column of this name in the header; known here: time, phi");
  EXPECT_EQ(
      error_of_run(data, "time,a\n0,1\n1,\n2,3\n"),
      "data.csv:3: a: expected a value, found a gap; fill it, leave the row out, or add gaps = true to the sensor "
      "\"a\" (experiment.toml:2)");
  EXPECT_EQ(error_of_run(data, "time,a\n0,1\n2,3\n1,2\n"),
            "data.csv:4: time: expected a time after that of the row before; sort the rows, or split the file by the "
            "column that names its segments");
}

TEST(ReadRuns, LeavesGapsOut) {
  const std::string gaps = "gaps = true\n[[sensor]]\nname = \"b\"\ntravel = \"rail\"\nnoise = 1\n";
  const std::string data = "time,a,b\n3,,1\n3.5,2,2\n4, ,3\n5,NaN,4\n6,5,5\n";
  const Experiment experiment = Bench(header + sensor + gaps + measured, data).read();
  const std::vector<Series>& series = experiment.records[0].sensors;
  EXPECT_EQ(series[0].time, (Numbers{0.5, 3})) << "from the earliest row of the run";
  EXPECT_DOUBLE_EQ(series[0].value[1], 5 * degree);
  EXPECT_EQ(series[1].time, (Numbers{0, 0.5, 1, 2, 3}));
  EXPECT_EQ(
      Bench(header + sensor + gaps + measured, "time,a,b\n0,,1\n1,2,\n2,3,3\n").error(),
      "data.csv:3: b: expected a value, found a gap; fill it, leave the row out, or add gaps = true to the sensor "
      "\"b\" (experiment.toml:7)");
  EXPECT_EQ(Bench(header + sensor + gaps + measured, "time,a,b\n0,inf,1\n1,2,2\n2,3,3\n").error(),
            "data.csv:2: a: expected a finite number, found \"inf\"; correct it or leave the row out");
  EXPECT_EQ(Bench(header + sensor + "gaps = true\n" + measured, "time,a\n0,1\n1,2\n2,\n").error(),
            "experiment.toml:8: run 1.data: expected at least 3 readings in run \"run 1\", found 2, all others are "
            "gaps or left out; "
            "leave the run out");
  EXPECT_EQ(Bench(header + sensor + "gaps = true\ncolumn = \"time\"\n" + measured, "time\n0\n\"\"\n2\n").error(),
            "data.csv:3: time: expected a value, found a gap; fill it or leave the row out")
      << "times are never left out";
}

TEST(ReadRuns, BeginsWhereASensorIsReadFirst) {
  const std::string late = "time,a\n0,\n0.5,\n1,7\n1.5,8\n2,9\n";
  const std::string gaps = header + sensor + "gaps = true\n" + measured;
  EXPECT_EQ(Bench(gaps, late).read().records[0].sensors[0].time, (Numbers{0, 0.5, 1}));
  EXPECT_EQ(Bench(gaps + "start_known = true\nrelease = { crank = 1 }\n", late).read().records[0].sensors[0].time,
            (Numbers{1, 1.5, 2}))
      << "a known start is that of the first row";
}

TEST(ReadRuns, ReadingsCountOnce) {
  const std::string data = "time,a\n0,1\n1,2\n2,3\n";
  EXPECT_EQ(
      Bench(header + sensor + measured + measured + "name = \"again\"\n", data).error(),
      "experiment.toml:9: run \"again\".data: expected the column \"a\" of \"data.csv\" once, run \"run 1\" reads it "
      "too; leave one of the runs out, or part them with from and to");
  EXPECT_EQ(
      Bench(header + sensor + "[[sensor]]\nname = \"b\"\nangle = \"rod\"\ncolumn = \"a\"\nnoise = 1\n" + measured, data)
          .error(),
      "experiment.toml:6: sensor \"b\": expected the column \"a\" of \"data.csv\" once, sensor \"a\" reads it too; "
      "leave one of the two out, or give it its own column");
}

// A copy of a run counts twice as the same file does; the clocks of the copies may begin elsewhere.
TEST(ReadRuns, CopiesOfARunAreRefused) {
  const std::string split = header + sensor + measured + "split = \"part\"\n";
  const std::string first = "part,time,a\n0,0.1,1\n0,0.2,2\n0,0.3,4\n";
  EXPECT_EQ(
      Bench(split, first + "1,7.1,1\n1,7.2,2\n1,7.3,4\n").error(),
      "experiment.toml:7: run 1.data: expected runs with readings of their own, all of run \"segment 1\" are those "
      "of run \"segment 0\"; leave one of the two out");
  EXPECT_EQ(Bench(split, first + "1,7.1,1\n1,7.2,2\n1,7.3,4.0001\n").error(), "") << "another reading";
  EXPECT_EQ(Bench(split, first + "1,7.1,1\n1,7.2,2\n1,7.35,4\n").error(), "") << "at another time";
  EXPECT_EQ(Bench(split, first + "1,7.1,1\n1,7.2,2\n1,7.3,4\n1,7.4,3\n").error(), "") << "one more reading";
  EXPECT_EQ(Bench(split, "part,time,a\n0,0,1\n0,1,1\n0,2,1\n1,3,1\n1,4,1\n1,5,1\n").error(), "") << "both stand still";
  const std::string data = "time,a\n0,1\n1,2\n2,4\n";
  EXPECT_EQ(Bench(header + sensor + measured + "[[run]]\nname = \"copy\"\ndata = \"slow.csv\"\n", data, data).error(),
            "experiment.toml:10: run \"copy\".data: expected runs with readings of their own, all of run \"copy\" are "
            "those of run \"run 1\"; leave one of the two out");
}

TEST(ReadRuns, WrappedAnglesAreRefusedOrUnwrapped) {
  // A rod that turns once in 4 s, backwards: 5 counts of an encoder of 20 in each second.
  std::string counts = "time,c\n";
  for (int i = 0; i <= 48; ++i)
    counts += std::to_string(i / 4.0) + "," + std::to_string((1000 - 5 * i / 4) % 20) + "\n";
  const auto bench = [&](const std::string& keys, const std::string& data) {
    return Bench(header + "[[sensor]]\nname = \"c\"\nangle = \"rod\"\nnoise = 1\nfactor = 18\n" + keys +
                     "[[run]]\ndata = \"data.csv\"\n",
                 data);
  };
  EXPECT_EQ(bench("", counts).error(),
            "experiment.toml:2: sensor \"c\": expected readings of a continuous angle, found a jump by 19 at 0.25 s of "
            "run \"run 1\", as of an encoder that starts again after each turn; add wraps = 20 (a turn in the column's "
            "unit), or wraps = 0 if it does not");
  const Series turned = bench("wraps = 20\n", counts).read().records[0].sensors[0];
  for (std::size_t i = 0; i < turned.value.size(); ++i) {
    EXPECT_NEAR(turned.value[i] - turned.value[0], -0.3141592653589793 * std::floor(1.25 * static_cast<double>(i)),
                1e-12);
  }
  EXPECT_NEAR(bench("wraps = 0\n", counts).read().records[0].sensors[0].value[1], 19 * 0.3141592653589793, 1e-12);
  // Two turns in a second, read five times in it, may be what they say.
  EXPECT_EQ(bench("", "time,c\n0,0\n0.2,8\n0.4,16\n0.6,24\n").error(), "");
  EXPECT_EQ(bench("wraps = -1\n", counts).error(),
            "experiment.toml:7: sensor \"c\".wraps: expected a finite number >= 0, found -1");
  EXPECT_EQ(Bench(header + sensor + "rate = true\nwraps = 1\n" + measured, counts).error(),
            "experiment.toml:7: sensor \"a\".wraps: expected wraps of a sensor of an angle only; leave it out");
}

TEST(ReadRuns, ReadsSeveralFilesOfOneRun) {
  const std::string sensors =
      "[[sensor]]\nname = \"b\"\ntravel = \"rail\"\nnoise = 1\n[[sensor]]\nname = \"c\"\nangle = \"rod\"\nnoise = 1\n";
  const std::string keys = "[[run]]\ndata = [\"data.csv\", \"slow.csv\"]\n";
  const auto bench = [&](const std::string& run_keys, const std::string& data, const std::string& slow) {
    return Bench(header + sensor + sensors + keys + run_keys, data, slow);
  };
  const std::string fast = "time,a,c\n10,1,2\n10.5,2,3\n11,3,4\n11.5,4,5\n";
  const std::string slow = "s,b\n9,1\n10,2\n11,3\n";
  const Experiment experiment = bench("time = [\"time\", \"s\"]\n", fast, slow).read();
  EXPECT_EQ(experiment.runs[0].data.size(), 2u);
  const std::vector<Series>& series = experiment.records[0].sensors;
  EXPECT_EQ(series[0].time, (Numbers{1, 1.5, 2, 2.5})) << "one clock, 0 at the earliest row of both";
  EXPECT_EQ(series[1].time, (Numbers{0, 1, 2}));
  EXPECT_DOUBLE_EQ(series[1].value[2], 3e-3);
  EXPECT_EQ(series[2].time, series[0].time);

  const std::vector<Series> units = bench("time = [\"time\", \"s\"]\ntime_factor = [0.1, 0.001]\n",
                                          "time,a,c\n1,1,2\n6,2,3\n11,3,4\n", "s,b\n90,1\n190,2\n290,3\n")
                                        .read()
                                        .records[0]
                                        .sensors;
  EXPECT_NEAR(units[0].time[2], 0.1 * 11 - 0.09, 1e-15) << "each file in its own unit";
  EXPECT_NEAR(units[1].time[2], 0.2, 1e-15);
  const std::string factors = "time = [\"time\", \"s\"]\ntime_factor = ";
  EXPECT_EQ(bench(factors + "[1, 1, 1]\n", fast, slow).error(),
            "experiment.toml:17: run 1.time_factor: expected one number, or one for each of the 2 data files, found 3");
  EXPECT_EQ(bench(factors + "[1, -1]\n", fast, slow).error(),
            "experiment.toml:17: run 1.time_factor: expected numbers > 0, seconds per unit, found -1");

  const Experiment fewer = bench("sensors = [\"c\", \"a\"]\n[[run]]\nsensors = [\"b\"]\nduration = 1\nrate = 10\n",
                                 fast, "time,x\n0,1\n1,2\n2,3\n")
                               .read();
  EXPECT_EQ(fewer.runs[0].sensors, (std::vector<std::size_t>{0, 2}));
  EXPECT_TRUE(fewer.records[0].sensors[1].value.empty());
  EXPECT_EQ(fewer.records[0].sensors[2].time, (Numbers{0, 0.5, 1, 1.5})) << "no sensor is read from the other file";
  EXPECT_EQ(fewer.runs[1].sensors, (std::vector<std::size_t>{1}));

  const std::string place = "experiment.toml:15: run 1.data: ";
  EXPECT_EQ(bench("", fast, "time,d\n0,1\n1,2\n2,3\n").error(),
            "experiment.toml:6: sensor \"b\": expected the column \"b\" in a file of the run in line 15, none has it; "
            "known here: time, a, c, d");
  EXPECT_EQ(
      bench("", fast, "time,b,a\n0,1,1\n1,2,1\n2,3,1\n").error(),
      "experiment.toml:2: sensor \"a\": expected the column \"a\" in one file of the run in line 15, \"data.csv\" "
      "and \"slow.csv\" have it; rename one of them");
  EXPECT_EQ(bench("time = [\"time\", \"s\", \"t\"]\n", fast, slow).error(),
            "experiment.toml:16: run 1.time: expected one column, or one for each of the 2 data files, found 3");
  EXPECT_EQ(Bench(header + sensor + "[[run]]\ndata = [\"data.csv\", \"./data.csv\"]\n", fast).error(),
            "experiment.toml:7: run 1.data: expected each file once, found \"./data.csv\" again");
  EXPECT_EQ(Bench(header + sensor + "[[run]]\ndata = []\n", fast).error(),
            "experiment.toml:7: run 1.data: expected the path of a data file; leave the key out to simulate");

  const std::string split = "time = \"t\"\nsplit = \"part\"\n";
  const std::string first = "part,t,a,c\nx,0,1,1\nx,1,2,1\nx,2,3,1\ny,5,4,1\ny,6,5,1\ny,7,6,1\n";
  const std::string second = "t,part,b\n4.5,y,1\n5,y,2\n5.5,y,3\n1,x,4\n2,x,5\n3,x,6\n";
  const Experiment parts = bench(split, first, second).read();
  ASSERT_EQ(parts.runs.size(), 2u);
  EXPECT_EQ(parts.records[1].sensors[0].time, (Numbers{0.5, 1.5, 2.5}));
  EXPECT_EQ(parts.records[1].sensors[1].time, (Numbers{0, 0.5, 1}));
  EXPECT_EQ(parts.records[0].sensors[1].time, (Numbers{1, 2, 3}));
  EXPECT_EQ(bench(split, first, "t,b\n0,1\n1,2\n2,3\n").error(),
            place +
                "expected the column \"part\" of split in every file of the run, \"slow.csv\" has none; name its "
                "segments there too");
  EXPECT_EQ(bench(split, first, "t,part,b\n0,x,1\n1,x,2\n2,x,3\n").error(),
            place +
                "expected the same segments in every file of the run, \"slow.csv\" has no \"y\"; name those that all "
                "have with segments = [...]");
  EXPECT_EQ(bench(split, "part,t,a,c\ny,0,1,1\ny,1,2,1\ny,2,3,1\n", second).error(),
            place +
                "expected the same segments in every file of the run, \"data.csv\" has no \"x\"; name those that all "
                "have with segments = [...]");
  EXPECT_EQ(bench(split + "segments = [\"y\"]\n", first, second).read().runs.size(), 1u);
}

TEST(ReadRuns, RejectsSensorsOfARun) {
  const std::string given = "duration = 2\nrate = 100\n";
  EXPECT_EQ(error_of_run(given + "sensors = []\n"),
            "experiment.toml:9: run 1.sensors: expected the name of a sensor; leave the key out for all");
  EXPECT_EQ(error_of_run(given + "sensors = [\"b\"]\n"),
            "experiment.toml:9: run 1.sensors: expected the name of a sensor, found \"b\"; known here: a");
  EXPECT_EQ(error_of_run(given + "sensors = [\"a\", \"a\"]\n"),
            "experiment.toml:9: run 1.sensors: expected each sensor once; take one of the two out");
  EXPECT_EQ(Bench(header + sensor + "[[sensor]]\nname = \"b\"\ntravel = \"rail\"\nnoise = 1\n[[run]]\n" + given +
                  "sensors = [\"a\"]\n")
                .error(),
            "experiment.toml:6: sensor \"b\": expected readings in at least one run, no run has any; name it in the "
            "sensors of a run, or leave it out");
}

}  // namespace
}  // namespace poise::read_runs_test
