#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "identification/experiment/experiment.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/identification/bench.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::read_experiment_test {
namespace {

using app_tests::TempFolder;
using test::Bench;
using test::degree;
constexpr double infinity = std::numeric_limits<double>::infinity();

const std::string& header = test::bench_header;
const std::string& sensor = test::bench_sensor;
const std::string& run = test::bench_run;

std::string error_of(const std::string& experiment, const std::string& data = "") {
  return Bench(experiment, data).error();
}

std::string error_of_sensor(const std::string& keys) { return error_of(header + "[[sensor]]\n" + keys + run); }

std::string error_of_unknown(const std::string& keys) {
  return error_of(header + sensor + "[[unknown]]\n" + keys + run);
}

TEST(ReadExperiment, ReadsHeaderSceneAndKnownChanges) {
  const Bench bench("title = \"T\"\nsource = \"S\"\nset = { \"body.block.mass\" = 900, \"load.P\" = 7 }\n" + header +
                    sensor + run);
  const Experiment experiment = bench.read();
  EXPECT_EQ(experiment.title, "T");
  EXPECT_EQ(experiment.source, "S");
  EXPECT_EQ(std::filesystem::path(experiment.file).filename(), "experiment.toml");
  EXPECT_EQ(experiment.scene.title, "Crank and block");
  EXPECT_DOUBLE_EQ(experiment.scene.bodies[3].mass, 0.9);
  EXPECT_DOUBLE_EQ(experiment.scene.forces[0].vector.x, -7);
  // The command line overrides the file.
  EXPECT_DOUBLE_EQ(bench.read({.settings = {"body.block.mass=1000"}}).scene.bodies[3].mass, 1.0);
  EXPECT_EQ(bench.error({.settings = {"body.block.mas=1000"}}),
            "--set body.block.mas: expected the path of a number of the scene; did you mean \"body.block.mass\"?");
}

TEST(ReadExperiment, ReadsEveryKindOfSensorInSi) {
  const std::string tail = "\nnoise = 0.5\n";
  const Experiment experiment =
      Bench(header + "[[sensor]]\nangle = \"crank\"\nzero = 90\nfactor = -2" + tail +
            "[[sensor]]\nname = \"knee\"\nangle = [\"crank\", \"rod\"]\ncolumn = \"phi\"\nrate = true" + tail +
            "[[sensor]]\ntravel = \"rail\"\nzero = 10" + tail + "[[sensor]]\ndistance = [\"ground.O\", \"rod.C\"]" +
            tail + "[[sensor]]\nx = \"rod.B\"\nfactor = 1000" + tail + "[[sensor]]\ny = \"rod.B\"" + tail +
            "[[sensor]]\nforce = \"coil\"" + tail + run)
          .read();
  const std::vector<Sensor>& sensors = experiment.sensors;
  ASSERT_EQ(sensors.size(), 7u);
  EXPECT_EQ(sensors[0].on.kind, Measure::Kind::angle);
  EXPECT_EQ(sensors[0].name, "sensor 1");
  EXPECT_EQ(sensors[0].column, "sensor 1");
  EXPECT_EQ(sensors[0].line, 2);
  EXPECT_EQ(sensors[0].on.body_a, 0);
  EXPECT_EQ(sensors[0].on.body_b, 1);
  EXPECT_EQ(sensors[0].by_time, 0);
  EXPECT_DOUBLE_EQ(sensors[0].noise, 0.5 * degree);
  EXPECT_DOUBLE_EQ(sensors[0].zero, 90 * degree);
  EXPECT_DOUBLE_EQ(sensors[0].unit, -2 * degree);
  EXPECT_EQ(sensors[1].on.kind, Measure::Kind::angle);
  EXPECT_EQ(sensors[1].name, "knee");
  EXPECT_EQ(sensors[1].column, "phi");
  EXPECT_EQ(sensors[1].on.body_a, 1);
  EXPECT_EQ(sensors[1].on.body_b, 2);
  EXPECT_EQ(sensors[1].by_time, 1);
  EXPECT_DOUBLE_EQ(sensors[1].unit, degree);
  EXPECT_EQ(sensors[2].on.kind, Measure::Kind::travel);
  EXPECT_EQ(sensors[2].on.joint, 3);
  EXPECT_DOUBLE_EQ(sensors[2].zero, 0.01);
  EXPECT_DOUBLE_EQ(sensors[2].unit, 1e-3);
  EXPECT_EQ(sensors[3].on.kind, Measure::Kind::distance);
  EXPECT_EQ(experiment.scene.name_of(sensors[3].on.a), "ground.O");
  EXPECT_EQ(experiment.scene.name_of(sensors[3].on.b), "rod.C");
  EXPECT_EQ(sensors[4].on.kind, Measure::Kind::x);
  EXPECT_EQ(experiment.scene.name_of(sensors[4].on.b), "rod.B");
  EXPECT_DOUBLE_EQ(sensors[4].unit, 1.0);
  EXPECT_EQ(sensors[5].on.kind, Measure::Kind::y);
  EXPECT_TRUE(sensors[6].reads_force());
  EXPECT_EQ(sensors[6].element, static_cast<int>(test::index_of(experiment.scene, "spring", 0)));
  EXPECT_EQ(sensors[6].on.kind, Measure::Kind::distance);
  for (int i = 0; i < 6; ++i) EXPECT_FALSE(sensors[i].reads_force());
  EXPECT_DOUBLE_EQ(sensors[6].noise, 0.5);
}

// A name of a quantity reads the same as the key that says it.
TEST(ReadExperiment, ReadsSensorsByNamesOfQuantities) {
  const std::string tail = "\nnoise = 0.5\n";
  const auto both = [&](const std::string& by_name, const std::string& by_key) {
    const Experiment experiment =
        Bench(header + "[[sensor]]\n" + by_name + tail + "[[sensor]]\n" + by_key + tail + run).read();
    const Sensor &a = experiment.sensors[0], &b = experiment.sensors[1];
    EXPECT_EQ(a.on.kind, b.on.kind) << by_name;
    EXPECT_EQ(a.on.body_a, b.on.body_a) << by_name;
    EXPECT_EQ(a.on.body_b, b.on.body_b) << by_name;
    EXPECT_EQ(a.on.joint, b.on.joint) << by_name;
    EXPECT_TRUE(a.on.b == b.on.b) << by_name;
    EXPECT_EQ(a.element, b.element) << by_name;
    EXPECT_EQ(a.by_time, b.by_time) << by_name;
    EXPECT_DOUBLE_EQ(a.noise, b.noise) << by_name;
  };
  both("read = \"angle.crank\"", "angle = \"crank\"");
  both("read = \"travel.rail\"", "travel = \"rail\"");
  both("read = \"d(travel.rail)/dt\"", "travel = \"rail\"\nrate = true");
  both("read = \"x.rod.B\"", "x = \"rod.B\"");
  both("read = \"d(y.rod.B)/dt\"", "y = \"rod.B\"\nrate = true");
  both("read = \"force.coil\"", "force = \"coil\"");
  EXPECT_EQ(error_of_sensor("read = \"reaction.rail\"" + tail), "");
  EXPECT_EQ(
      error_of_sensor("read = \"mode.1.frequency\"" + tail),
      "experiment.toml:3: sensor 1.read: sensors read angle.BODY, travel.JOINT, x.BODY.POINT, y.BODY.POINT, "
      "length.ELEMENT between two points or bodies, their d(A)/dt and d(d(A)/dt)/dt, other quantities of a motion "
      "without rates, and at rest all quantities but stresses, loads inside of links, modes and those over a path; "
      "found "
      "mode.1.frequency");
  EXPECT_NE(error_of_sensor("read = \"angle.crnk\"" + tail).find("\"angle.crank\""), std::string::npos);
  EXPECT_NE(error_of_sensor("read = \"d(angle.crank)/dt\"\nrate = true" + tail).find("is a rate already"),
            std::string::npos);
}

TEST(ReadExperiment, ReadsUnknownsInSi) {
  const std::vector<Unknown> unknowns =
      Bench(header + sensor +
            "[[unknown]]\npath = \"body.block.mass\"\nname = \"m\"\nincludes = 50\nstart = 400\nmin = 60\nmax = 2000\n"
            "prior = [700, 100]\nscale = 50\nper = \"load\"\n"
            "[[unknown]]\npath = \"spring.coil.stiffness\"\n[[unknown]]\npath = \"body.crank.inertia\"\nper = \"run\"\n"
            "[[unknown]]\npath = \"body.crank.center.x\"\n[[unknown]]\npath = \"torsion_damper.grease.coefficient\"\n" +
            run + "labels = { load = \"low\" }\n")
          .read()
          .unknowns;
  ASSERT_EQ(unknowns.size(), 5u);
  EXPECT_EQ(unknowns[0].path, "body.block.mass");
  EXPECT_EQ(unknowns[0].name, "m");
  EXPECT_EQ(unknowns[0].per, "load");
  EXPECT_EQ(unknowns[0].line, 6);
  EXPECT_DOUBLE_EQ(unknowns[0].unit, 1e-3);
  EXPECT_DOUBLE_EQ(unknowns[0].includes, 0.05);
  EXPECT_DOUBLE_EQ(unknowns[0].start.value(), 0.4);
  EXPECT_DOUBLE_EQ(unknowns[0].min, 0.06);
  EXPECT_DOUBLE_EQ(unknowns[0].max, 2.0);
  EXPECT_DOUBLE_EQ(unknowns[0].prior.value(), 0.7);
  EXPECT_DOUBLE_EQ(unknowns[0].prior_deviation, 0.1);
  EXPECT_DOUBLE_EQ(unknowns[0].scale.value(), 0.05);
  EXPECT_EQ(unknowns[1].name, "spring.coil.stiffness");
  EXPECT_EQ(unknowns[1].per, "");
  EXPECT_DOUBLE_EQ(unknowns[1].unit, 1e3);
  EXPECT_EQ(unknowns[1].min, 0.0);
  EXPECT_EQ(unknowns[1].max, infinity);
  EXPECT_FALSE(unknowns[1].start);
  EXPECT_FALSE(unknowns[1].prior);
  EXPECT_FALSE(unknowns[1].scale);
  EXPECT_DOUBLE_EQ(unknowns[2].unit, 1e-9);
  EXPECT_EQ(unknowns[2].min, 0.0);
  EXPECT_EQ(unknowns[2].per, "run");
  EXPECT_EQ(unknowns[3].min, -infinity) << "a centre may lie on either side";
  EXPECT_EQ(unknowns[4].min, 0.0);
}

TEST(ReadExperiment, RejectsTheFile) {
  EXPECT_EQ(error_of("scene = 'scene.toml"),
            "experiment.toml:1: TOML syntax: Error while parsing literal string: "
            "encountered end-of-file");
  EXPECT_EQ(error_of(sensor + run), "experiment.toml:1: expected the key scene; add scene = \"...\"");
  EXPECT_EQ(error_of("scene = \"s.toml\"\n" + sensor + run),
            "experiment.toml:1: scene: expected a scene file, relative to this file; there is no \"s.toml\"");
  EXPECT_EQ(error_of("sensors = 1\n" + header),
            "experiment.toml:1: sensors: expected one of the keys title, source, scene, set, loss, sensor, unknown, "
            "known, run, static, plan; did "
            "you mean \"sensor\"?");
  EXPECT_EQ(error_of(header + run), "experiment.toml:1: sensor: expected at least one sensor; add [[sensor]]");
  EXPECT_EQ(error_of(header + sensor), "experiment.toml:1: run: expected at least one run; add [[run]]");
  EXPECT_EQ(error_of("set = { \"body.block.mas\" = 1 }\n" + header + sensor + run),
            "experiment.toml:1: set: body.block.mas: expected the path of a number of the scene; did you mean "
            "\"body.block.mass\"?");
  EXPECT_EQ(error_of("set = { \"body.block.mass\" = -1 }\n" + header + sensor + run),
            "experiment.toml:1: set: body.block.mass: expected a finite number >= 0, found -1");
  EXPECT_EQ(error_of("set.body.block.mass = 1\n" + header + sensor + run),
            "experiment.toml:1: set.body: expected a number; put the path in quotes: \"body.NAME.mass\" = 2");
  const TempFolder folder;
  try {
    read_experiment(folder.path("none.toml"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              folder.path("none.toml").string() + ": cannot be read: No such file or directory; check the path");
  }
}

TEST(ReadExperiment, RejectsSensors) {
  const std::string place = "experiment.toml:2: sensor 1: ";
  const std::string kinds =
      "expected one of the keys read, angle, travel, distance, x, y, force, impacts, accelerometer, slips";
  EXPECT_EQ(error_of_sensor("noise = 1\n"), place + kinds);
  EXPECT_EQ(error_of_sensor("noise = 1\nx = \"rod.B\"\ny = \"rod.B\"\n"),
            place + kinds + ", found x and y; leave one in, or give each a sensor");
  EXPECT_EQ(
      error_of_sensor("angle = \"crank\"\n"),
      "experiment.toml:2: sensor \"sensor 1\".noise: expected a number, since run \"run 1\" is simulated; add noise = "
      "NUMBER");
  const std::string third = "experiment.toml:3: sensor 1.";
  EXPECT_EQ(error_of_sensor("angles = \"crank\"\n"),
            third +
                "angles: expected one of the keys name, read, angle, travel, "
                "distance, x, y, force, impacts, accelerometer, slips, direction, rate, column, gaps, missing, wraps, "
                "noise, zero, factor, delay; did you mean \"angle\"?");
  EXPECT_EQ(error_of_sensor("angle = \"crnk\"\n"),
            third + "angle: expected the name of a body other than ground, found \"crnk\"; did you mean \"crank\"?");
  EXPECT_EQ(error_of_sensor("angle = [\"rod\", \"rod\"]\n"), third + "angle: expected two different bodies");
  EXPECT_EQ(error_of_sensor("angle = [\"rod\"]\n"),
            third + "angle: expected two names [\"...\", \"...\"], found a list of 1");
  EXPECT_EQ(error_of_sensor("travel = \"rial\"\n"),
            third + "travel: expected the name of a slide or pin_in_slot, found \"rial\"; did you mean \"rail\"?");
  EXPECT_EQ(error_of_sensor("distance = [\"rod.B\", \"rod.C\"]\n"),
            third + "distance: expected points of two different bodies, the distance of these never changes");
  EXPECT_EQ(error_of_sensor("x = \"rod.X\"\n"),
            third + "x: expected a point of \"rod\", found \"rod.X\"; did you mean \"rod.B\"?");
  EXPECT_EQ(error_of_sensor("y = \"ground.O\"\n"),
            third + "y: expected a point of a body that can move, found one of the ground");
  EXPECT_EQ(error_of_sensor("force = \"wrap\"\n"),
            third + "force: expected the name of a line spring, found \"wrap\"; known here: coil");
  EXPECT_EQ(error_of_sensor("rate = true\nforce = \"coil\"\n"),
            third + "rate: expected the rate of a position or angle; the rate of a force is not available");
  EXPECT_EQ(error_of_sensor("rate = \"yes\"\nangle = \"rod\"\n"),
            third + "rate: expected true or false, without quotes");
  EXPECT_EQ(error_of_sensor("noise = 0\nangle = \"rod\"\n"), third + "noise: expected a finite number > 0, found 0");
  EXPECT_EQ(error_of_sensor("factor = 0\nangle = \"rod\"\nnoise = 1\n"),
            third + "factor: expected a number other than 0; leave it out for 1");
  EXPECT_EQ(error_of_sensor("column = \"\"\nangle = \"rod\"\nnoise = 1\n"),
            third + "column: expected the name of a column");
  EXPECT_EQ(error_of(header + sensor + sensor + run),
            "experiment.toml:7: sensor \"a\".name: expected a name of its own; \"a\" is taken in line 3");
}

TEST(ReadExperiment, RejectsUnknowns) {
  const std::string path = "path = \"body.block.mass\"\n";
  EXPECT_EQ(error_of_unknown("name = \"m\"\n"),
            "experiment.toml:6: unknown \"m\": expected the key path; add path = \"...\"");
  const std::string seventh = "experiment.toml:7: unknown 1.";
  EXPECT_EQ(error_of_unknown("path = \"body.block.mas\"\n"),
            seventh +
                "path: body.block.mas: expected the path of a number of the scene; did you mean "
                "\"body.block.mass\"?");
  for (const std::string guess : {"start.crank", "start.rail"}) {
    EXPECT_EQ(error_of_unknown("path = \"" + guess + "\"\n"),
              seventh +
                  "path: expected a number that the motion depends on; start values of a run are estimated "
                  "unless start_known = true");
  }
  const std::string eighth = "experiment.toml:8: unknown 1.";
  EXPECT_EQ(error_of_unknown(path + "from = 1\n"),
            eighth + "from: expected one of the keys path, name, per, start, min, max, includes, prior, scale");
  EXPECT_EQ(error_of_unknown(path + "min = 5\nmax = 5\n"),
            "experiment.toml:9: unknown 1.max: expected max > min = 5; exchange them");
  EXPECT_EQ(error_of_unknown(path + "max = -5\n"), eighth + "max: expected max > min = 0; exchange them");
  EXPECT_EQ(error_of_unknown(path + "start = -5\n"),
            eighth + "start: expected a start of at least 0, found -5; change one of the two");
  EXPECT_EQ(error_of_unknown("path = \"body.rod.center.x\"\nmax = 1\nstart = 2\n"),
            "experiment.toml:9: unknown 1.start: expected a start of at most 1, found 2; change one of the two");
  EXPECT_EQ(error_of_unknown(path + "max = 700\n"),
            "experiment.toml:6: unknown 1.start: expected a start from 0 to 700, found 800, the scene's value; add "
            "start = NUMBER");
  EXPECT_EQ(error_of_unknown(path + "max = 820\nincludes = 50\n"),
            "experiment.toml:6: unknown 1.start: expected a start from 0 to 820, found 850, the scene's value; add "
            "start = NUMBER");
  EXPECT_EQ(error_of_unknown(path + "scale = 0\n"), eighth + "scale: expected a finite number > 0, found 0");
  EXPECT_EQ(error_of_unknown(path + "prior = [1, 0]\n"),
            eighth + "prior: expected [MEAN, STANDARD DEVIATION], the second > 0");
  EXPECT_EQ(error_of_unknown(path + "per = \"\"\n"),
            eighth + "per: expected \"run\" or a label of the runs; leave it out for one value");
  EXPECT_EQ(error_of_unknown(path + "[[unknown]]\n" + path),
            "experiment.toml:9: unknown 2.path: expected another path, it is unknown in line 7");
  EXPECT_EQ(error_of_unknown(path + "name = \"m\"\n[[unknown]]\npath = \"body.rod.mass\"\nname = \"m\"\n"),
            "experiment.toml:11: unknown \"m\".name: expected a name of its own; \"m\" is taken in line 8");
}

// The errors of two tables would be added up as one error.
TEST(ReadExperiment, RejectsANumberThatIsKnownTwice) {
  const std::string known = "[[known]]\npath = \"body.block.mass\"\nrelative = 0.01\n";
  EXPECT_EQ(error_of(header + sensor + known + run), "");
  EXPECT_EQ(error_of(header + sensor + known + known + run),
            "experiment.toml:10: known 2.path: expected another path, it is known in line 7; take one of the two out");
  EXPECT_EQ(error_of(header + sensor + known + "per = \"run\"\n" + known + run),
            "experiment.toml:11: known 2.path: expected another path, it is known in line 7; take one of the two out");
}

TEST(ReadExperiment, RejectsUnknownsThatARunContradicts) {
  const std::string unknown = header + sensor + "[[unknown]]\npath = \"body.block.mass\"\nname = \"m\"\n";
  EXPECT_EQ(
      error_of(unknown + "per = \"hight\"\n" + run + "labels = { height = \"low\" }\n"),
      "experiment.toml:6: unknown \"m\".per: expected \"run\" or a label that all runs have, run \"run 1\" has no "
      "\"hight\"; did you mean \"height\"?");
  EXPECT_EQ(error_of(unknown + "per = \"h\"\n" + run + "labels = { h = \"low\" }\n" + run),
            "experiment.toml:6: unknown \"m\".per: expected \"run\" or a label that all runs have, run \"run 2\" has "
            "no \"h\"; known here: run");
  EXPECT_EQ(error_of(unknown + run + "set = { \"body.block.mass\" = 3 }\n"),
            "experiment.toml:6: unknown \"m\".path: expected a number that no run sets, run \"run 1\" does in line 12; "
            "take it out of one");
  EXPECT_EQ(error_of(header + sensor + "[[unknown]]\npath = \"spring.coil.free_length\"\n" + run +
                     "rest = { angle = \"crank\", at = 3, by = \"spring.coil.free_length\" }\n"),
            "experiment.toml:6: unknown \"spring.coil.free_length\".path: expected a number that no equilibrium "
            "position sets, rest of run \"run 1\" sets it in line 11; take one of the two out");
}

TEST(ReadExperiment, ReadsTheExampleOfItsPage) {
  const std::string page =
      app_tests::contents(std::filesystem::path(POISE_SOURCE_DIR) / "docs" / "experiment-files.md");
  const std::size_t begin = page.find("```toml\n") + 8;
  const TempFolder folder;
  std::filesystem::create_directory(folder.path("datasets"));
  folder.write("datasets/lift.toml", app_tests::contents(test::dataset("lift.toml")));
  folder.write("middle_loaded.csv", "time,obd\n0,0.37\n0.1,0.38\n0.2,0.37\n");
  const std::string example = page.substr(begin, page.find("```", begin) - begin);
  const Experiment experiment = read_experiment(folder.write("lift_experiment.toml", example));
  EXPECT_EQ(experiment.runs.size(), 2u);
  EXPECT_EQ(experiment.unknowns[0].includes, 19.68);
  EXPECT_EQ(experiment.records[1].count(), 3u);
}

TEST(ReadExperiment, ReadsTheMeasuredDoublePendulum) {
  const std::filesystem::path data =
      std::filesystem::path(POISE_SOURCE_DIR) / "../shared/data/multi_arm_pendulum/double.csv";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << data << " is not there";
  for (const std::string name : {"double_pendulum_experiment.toml", "double_pendulum_dry_experiment.toml"}) {
    SCOPED_TRACE(name);
    const Experiment experiment = read_experiment(test::dataset(name), {.data = data});
    ASSERT_EQ(experiment.runs.size(), 26u);
    EXPECT_EQ(experiment.runs[25].name, "segment 25");
    for (const Record& record : experiment.records) {
      // What the authors call pi, hanging, is -pi/2 of the scene's arms; no arm goes over the top.
      for (const Series& angles : record.sensors) {
        ASSERT_EQ(angles.time.size(), 2667u);
        EXPECT_EQ(angles.time.front(), 0.0);
        double mean = 0.0;
        for (const double angle : angles.value) mean += angle / static_cast<double>(angles.value.size());
        EXPECT_NEAR(mean, -std::numbers::pi / 2, 0.5);
      }
    }
  }
}

}  // namespace
}  // namespace poise::read_experiment_test
