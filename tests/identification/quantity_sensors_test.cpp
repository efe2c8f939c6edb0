// Forces of joints and other quantities as readings of motion: closed forms, derivatives, fits, and what they tell.

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::quantity_sensors_test {
namespace {

// A pendulum with m = 2, d = 0.3, J = 0.25 about its pin.
const std::string pendulum = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.rod]
points = { O = [0, 0], C = [0.3, 0], P = [0.5, 0.1] }
mass = 2
center = [0.3, 0]
inertia = 0.07
[[pin]]
name = "O"
points = ["ground.O", "rod.O"]
[[force]]
name = "push"
at = "rod.P"
vector = [0.6, 0.8]
[start]
rod = -1.5707963267948966
)";

const std::string four_bar = R"(
gravity = [0, -9.81]
[ground]
points = { A = [0, 0], D = [0.4, 0], S = [0.5, 0.4] }
[body.crank]
points = { A = [0, 0], B = [0.12, 0] }
mass = 0.5
center = [0.05, 0.01]
inertia = 0.002
[body.coupler]
points = { B = [0, 0], C = [0.35, 0], P = [0.2, 0.1] }
mass = 0.8
center = [0.17, 0.02]
inertia = 0.01
[body.rocker]
points = { D = [0, 0], C = [0.25, 0] }
mass = 0.6
center = [0.12, 0]
inertia = 0.004
[[pin]]
name = "A"
points = ["ground.A", "crank.A"]
[[pin]]
name = "B"
points = ["crank.B", "coupler.B"]
[[pin]]
name = "C"
points = ["coupler.C", "rocker.C"]
[[pin]]
name = "D"
points = ["rocker.D", "ground.D"]
[[spring]]
name = "coil"
points = ["ground.S", "coupler.P"]
stiffness = 60
free_length = 0.2
[[torsion_damper]]
name = "oil"
bodies = ["ground", "rocker"]
coefficient = 0.05
[[torque]]
name = "M"
on = "crank"
value = 0.4
time = { sine = { amplitude = 1, frequency = 1.3 } }
[start]
crank = 1
coupler = 0.3
rocker = 1.6
)";

std::string sensor(const std::string& name, const std::string& read, double noise, const std::string& more = "") {
  return fmt::format("[[sensor]]\nname = \"{}\"\nread = \"{}\"\nnoise = {}\n{}\n", name, read, noise, more);
}

std::string unknown(const std::string& path, const std::string& more = "") {
  return "[[unknown]]\npath = \"" + path + "\"\n" + more + "\n";
}

const std::string head = "scene = \"scene.toml\"\n";
const std::string swing = "[[run]]\nduration = 2\nrate = 50\nrelease = { rod = -0.4 }\n";

class QuantitySensors : public test::WrittenExperiment {
 protected:
  QuantitySensors() : WrittenExperiment(pendulum) {}

  static std::vector<double> predicted(const Experiment& e) {
    const FitProblem problem(e);
    const RunModel& run = problem.run(0);
    Prediction out;
    run.predict(run.scene_values().data(), run.released().data(), INFINITY, 1e-11, false, out);
    EXPECT_TRUE(out.ok) << out.why;
    return out.reading;
  }
};

// Along the rod and across it, with  w^2 = 2 m g d / J (sin a0 - sin a),  w' = -m g d / J cos a:
//   m (-d w^2 + g sin a),  m (d w' + g cos a).
TEST_F(QuantitySensors, ReadTheForceInAPin) {
  const std::vector<double> read =
      predicted(this->read(head + "set = { \"load.push\" = 0 }\n" + sensor("pin", "reaction.O", 0.1) +
                           sensor("angle", "angle.rod", 1e-3) + swing));
  const std::size_t n = read.size() / 2;
  ASSERT_EQ(n, 100U);
  const double m = 2, g = 9.81, d = 0.3, J = 0.25;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = read[n + i];
    const double along = m * (-2 * m * g * d * d / J * (std::sin(-0.4) - std::sin(a)) + g * std::sin(a));
    const double across = m * g * std::cos(a) * (1 - m * d * d / J);
    EXPECT_NEAR(read[i], std::hypot(along, across), 1e-7);
  }
}

// With a force that was measured:  R + F(t) + m g = m a.
TEST_F(QuantitySensors, KnowTheForcesThatWereRead) {
  folder_.write("push.csv", "time,F\n0,0\n1,30\n1.5,-20\n3,5\n");
  const std::vector<double> read =
      predicted(this->read(head + sensor("x", "reaction.O.x", 0.1) + sensor("y", "reaction.O.y", 0.1) +
                           sensor("ax", "d(d(x.rod.C)/dt)/dt", 0.1) + sensor("ay", "d(d(y.rod.C)/dt)/dt", 0.1) + swing +
                           "inputs = { \"load.push\" = { column = \"F\", file = \"push.csv\" } }\n"));
  const std::size_t n = read.size() / 4;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 0.02 * static_cast<double>(i);
    const double force = t < 1 ? 30 * t : t < 1.5 ? 30 - 100 * (t - 1) : -20 + 25 * (t - 1.5) / 1.5;
    EXPECT_NEAR(read[i], 2 * read[2 * n + i] - 0.6 * force, 1e-6) << t;
    EXPECT_NEAR(read[n + i], 2 * (read[3 * n + i] + 9.81) - 0.8 * force, 1e-6) << t;
  }
}

TEST_F(QuantitySensors, HaveDerivatives) {
  folder_.write("scene.toml", four_bar);
  std::string text = head + sensor("B", "reaction.B", 0.1, "factor = 1.1\nzero = 0.2\ndelay = 0.004") +
                     sensor("D", "reaction.D.y - 0.3*reaction.A.x", 0.1) + sensor("C", "reaction.C.x", 0.1) +
                     sensor("damper", "force.oil", 0.1);
  for (const char* const path :
       {"body.crank.mass", "body.coupler.inertia", "body.rocker.center.x", "point.coupler.C.x", "point.ground.S.x",
        "gravity.y", "spring.coil.stiffness", "torsion_damper.oil.coefficient", "load.M", "load.M.time.frequency",
        "sensor.B.zero", "sensor.B.factor"}) {
    text += unknown(path);
  }
  const Experiment e = read(text + unknown("sensor.B.delay", "min = 0\nmax = 0.01") +
                            "[[run]]\nduration = 0.8\nrate = 40\nrelease = { crank = 1.2 }\n");
  test::expect_derivatives(e, FitProblem(e).run(0).released());
}

// Angles tell  m c / J  alone; a load cell in the pin tells all three.
TEST_F(QuantitySensors, TellTheMass) {
  const std::string angle = sensor("angle", "angle.rod", 1e-3), pin = sensor("pin", "reaction.O.y", 0.2);
  const std::string numbers = unknown("body.rod.mass") + unknown("body.rod.inertia") + unknown("body.rod.center.x");
  const std::string set = "set = { \"load.push\" = 0 }\n";
  const Experiment without = read(head + set + angle + numbers + swing),
                   with = read(head + set + angle + pin + numbers + swing);
  const FitProblem one(without), two(with);
  EXPECT_EQ(assess(one, one.truths(), test::released(one)).rank, 1);
  // Across gravity the pin feels  m c  times an acceleration alone.
  const Experiment level = read(head + set + angle + sensor("pin", "reaction.O.x", 0.2) + numbers + swing);
  const FitProblem across(level);
  EXPECT_EQ(assess(across, across.truths(), test::released(across)).rank, 2);
  const Identifiability found = assess(two, two.truths(), test::released(two));
  EXPECT_EQ(found.rank, 3);
  test::expect_found(with, 0.1);
}

// A strain gauge beside an encoder: the moment in the rod behind the gauge, of what hangs beyond it.
TEST_F(QuantitySensors, ReadAStrainGauge) {
  folder_.write("scene.toml", pendulum + R"(
[body.rod.section]
line = ["O", "C", "E"]
area = 1e-4
second_moment = 1e-9
modulus = 7e10
height = 0.01
)");
  std::string text = app_tests::contents(folder_.path("scene.toml"));
  const std::string points = "points = { O = [0, 0], C = [0.3, 0], P = [0.5, 0.1] }";
  text.replace(text.find(points), points.size(),
               "points = { O = [0, 0], G = [0.2, 0], C = [0.3, 0], P = [0.5, 0.1], E = [0.6, 0] }");
  folder_.write("scene.toml", text);
  const std::string gauge = sensor("gauge", "moment.rod.G", 1e-3, "factor = 1.2");
  Experiment e = read(head + "set = { \"load.push\" = 0 }\n" + sensor("angle", "angle.rod", 1e-3) + gauge +
                      unknown("body.rod.mass") + unknown("body.rod.inertia") + unknown("sensor.gauge.zero") + swing +
                      "start_known = true\n");
  test::expect_derivatives(e, FitProblem(e).run(0).released());
  test::expect_found(e, 0.1);
}

TEST_F(QuantitySensors, SayWhatIsWrong) {
  const auto says = [&](const std::string& sensor) { return error(head + sensor + swing); };
  EXPECT_EQ(says(sensor("s", "push.rod.P.x", 0.1)),
            "experiment.toml:4: sensor \"s\".read: push.rod.P.x belongs to mechanisms at rest; expected a quantity of "
            "motions, or add [[static]]");
  EXPECT_EQ(says(sensor("s", "energy", 0.1, "rate = true")),
            "experiment.toml:6: sensor \"s\".rate: expected the rate of a position or angle; the rate of energy is not "
            "available");
}

// Where drives leave no freedom a measured run is inverse dynamics: a motor's torque tells the moment of inertia.
TEST_F(QuantitySensors, ReadTheTorqueOfADriveThatLeavesNoFreedom) {
  folder_.write("scene.toml", pendulum + "[[drive]]\nname = \"motor\"\nbodies = [\"ground\", \"rod\"]\nrate = 0\n");
  std::string text = "time,angle,torque";
  for (int i = 0; i <= 200; ++i) {
    const double t = 0.01 * i, a = -1.2 + 0.5 * std::sin(5 * t), by = -12.5 * std::sin(5 * t);
    const double noise = 1e-3 * std::sin(1e3 * i * i);
    text += fmt::format("\n{:.17g},{:.17g},{:.17g}", t, a, 0.25 * by + 2 * 9.81 * 0.3 * std::cos(a) + noise);
  }
  folder_.write("driven.csv", text + "\n");
  const Experiment e = read(head + "set = { \"load.push\" = 0 }\n" + sensor("torque", "force.motor", 1e-3) +
                            unknown("body.rod.inertia", "start = 0.1") +
                            "[[run]]\ndata = \"driven.csv\"\ninputs = { \"drive.motor\" = \"angle\" }\n");
  const FitProblem problem(e);
  EXPECT_TRUE(problem.run(0).natural_frequencies(problem.starts().data(), 0.0, {}).empty());
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable()) << found.why;
  EXPECT_NEAR(found.estimates[0].value, 0.07, 1e-4);
}

TEST_F(QuantitySensors, BelongToReadingsAtRestWhereThereAreAny) {
  const std::string sensors = head + sensor("angle", "angle.rod", 1e-3) + sensor("pin", "reaction.O.y", 0.1);
  const std::string rest = "[[static]]\ninputs = { \"load.push\" = [0, 1] }\n";
  const Experiment both = read(sensors + swing + rest);
  EXPECT_TRUE(both.runs[0].reads(0));
  EXPECT_FALSE(both.runs[0].reads(1));
  const Experiment named = read(sensors + swing + "sensors = [\"angle\", \"pin\"]\n" + rest);
  EXPECT_TRUE(named.runs[0].reads(1));
  EXPECT_TRUE(read(sensors + swing).runs[0].reads(1));
}

}  // namespace
}  // namespace poise::quantity_sensors_test
