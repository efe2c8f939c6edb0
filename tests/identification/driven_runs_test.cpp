// Runs whose loads or drives follow measured columns.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/assessment/input_readings.hpp"
#include "identification/assessment/known_numbers.hpp"
#include "identification/fit/fit.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "tests/identification/crane.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::driven_runs_test {
namespace {

const std::string scene = test::crane("value = 0", "", "start = 0", "-1.5707963267948966");

double motor(double t) { return 0.9 * std::sin(5.1 * t) + 0.6 * std::sin(2.3 * t + 1); }
double wind(double t) { return 0.7 * std::cos(3.7 * t); }
double belt(double t) { return 0.15 * std::sin(2 * t) + 0.05 * std::cos(6 * t); }

/// Readings of the inputs, `rate` per second up to `end`.
std::string inputs_csv(double rate, double end, double noise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::string text = "time,tau,wind,belt\n";
  for (int i = 0; i <= std::lround(end * rate); ++i) {
    const double t = i / rate;
    text += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}\n", t, motor(t), wind(t), belt(t) + noise * normal(random));
  }
  return text;
}

/// A record of the one sensor, whose clock begins at `begin`.
std::string angles_csv(const Record& record, double begin) {
  std::string text = "time,angle\n";
  for (std::size_t i = 0; i < record.sensors[0].time.size(); ++i) {
    text += fmt::format("{:.9g},{:.12g}\n", begin + record.sensors[0].time[i], record.sensors[0].value[i]);
  }
  return text;
}

const std::string sensor = R"(
scene = "scene.toml"
[[sensor]]
name = "angle"
angle = ["cart", "arm"]
noise = 1e-4
)";
const std::string unknowns = R"(
[[unknown]]
path = "torsion_damper.grease.coefficient"
name = "c"
start = 0.05
[[unknown]]
path = "body.arm.inertia"
name = "J"
start = 0.08
)";

class DrivenRuns : public test::WrittenExperiment {
 protected:
  DrivenRuns() : WrittenExperiment(scene) {}

  /// The error of the inputs of a simulated run.
  std::string error_of(const std::string& inputs) const {
    return error(sensor + "[[run]]\nduration = 2\nrate = 100\ninputs = " + inputs + "\n");
  }
};

TEST_F(DrivenRuns, AreSimulatedByTheirInputs) {
  folder_.write("inputs.csv", inputs_csv(1000, 3, 0));
  const Experiment e = read(sensor + R"(
[[run]]
duration = 3
rate = 200
release_rate = { arm = 1 }
inputs = { "load.motor" = { column = "tau", file = "inputs.csv" }, "load.wind" = "wind", "drive.belt" = "belt" }
)");
  ASSERT_EQ(e.runs[0].inputs.size(), 3u);
  EXPECT_TRUE(e.is_simulated());
  EXPECT_NEAR(e.runs[0].inputs[2].motion.curve->at(1.2345), belt(1.2345), 1e-12);
  EXPECT_NEAR(e.runs[0].inputs[2].motion.curve->at(1.2345, 2), -0.6 * std::sin(2.469) - 1.8 * std::cos(7.407), 1e-6);
  const FitProblem problem(e);
  const Record record = problem.ideal_record(0);
  // The same by equations written out: (J + m r^2) a = motor + moments of weight, wind, carriage and grease.
  const double J = 0.05 + 1.3 * 0.09;
  const auto acceleration = [&](double t, double angle, double rate) {
    const double x = -0.6 * std::sin(2 * t) - 1.8 * std::cos(6 * t);
    return (motor(t) - 1.3 * 0.3 * (9.81 * std::cos(angle) - x * std::sin(angle)) - 0.4 * std::sin(angle) * wind(t) -
            0.08 * rate) /
           J;
  };
  double angle = -M_PI / 2, rate = 1.0;
  constexpr double h = 1e-4;
  std::size_t next = 0;
  for (int i = 0; next < record.sensors[0].time.size(); ++i) {
    const double t = i * h;
    if (std::abs(t - record.sensors[0].time[next]) < h / 2) {
      EXPECT_NEAR(record.sensors[0].value[next], angle, 5e-6) << "of straight lines between readings 1 ms apart";
      ++next;
    }
    const double k1 = rate, l1 = acceleration(t, angle, rate);
    const double k2 = rate + h / 2 * l1, l2 = acceleration(t + h / 2, angle + h / 2 * k1, k2);
    const double k3 = rate + h / 2 * l2, l3 = acceleration(t + h / 2, angle + h / 2 * k2, k3);
    const double k4 = rate + h * l3, l4 = acceleration(t + h, angle + h * k3, k4);
    angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    rate += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }
}

TEST_F(DrivenRuns, HaveExactJacobians) {
  folder_.write("inputs.csv", inputs_csv(100, 1, 0));
  const Experiment e = read(sensor + unknowns + R"([[unknown]]
path = "point.arm.T.x"

[[run]]
duration = 1
rate = 50
inputs = { "load.motor" = { column = "tau", file = "inputs.csv" }, "load.wind" = "wind", "drive.belt" = "belt" }
)");
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  ASSERT_EQ(run.columns(), 5);
  const auto predict = [&](std::vector<double> at, bool jacobian) {
    Prediction out;
    run.predict(at.data(), at.data() + 3, INFINITY, jacobian ? 1e-11 : 1e-13, jacobian, out);
    EXPECT_TRUE(out.ok) << out.why;
    return out;
  };
  std::vector<double> at = run.scene_values();
  const std::vector<double> start = run.released();
  at.insert(at.end(), start.begin(), start.end());
  const Prediction exact = predict(at, true);
  for (std::size_t c = 0; c < 5; ++c) {
    const std::vector<double> expected = test::derivative(
        [&](double by) {
          std::vector<double> moved = at;
          moved[c] += by;
          return predict(moved, false).reading;
        },
        1e-3);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(exact.jacobian[5 * i + c], expected[i], 1e-7 * (1 + std::abs(expected[i]))) << c;
    }
  }
}

TEST_F(DrivenRuns, AreIdentifiedFromMeasuredTorqueAndPosition) {
  // Truth: inputs without noise at 1 kHz. Measured: torque at 200 Hz, position with noise at 500 Hz, the angle at 100
  // Hz.
  folder_.write("inputs.csv", inputs_csv(1000, 4.1, 0));
  const Experiment truth = read(sensor + R"(
[[run]]
duration = 4
rate = 100
seed = 3
inputs = { "load.motor" = { column = "tau", file = "inputs.csv" }, "drive.belt" = "belt", "load.wind" = "wind" }
)");
  const Record record = FitProblem(truth).records()[0];
  folder_.write("angles.csv", angles_csv(record, 100));
  constexpr double position_noise = 2e-5;
  std::string motor_csv = "t,volt\n", belt_csv = "time,mm,wind\n";
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  for (int i = -20; i <= 820; ++i)
    motor_csv += fmt::format("{:.9g},{:.12g}\n", 100 + i / 200.0, 10 * motor(i / 200.0) - 3);
  for (int i = 0; i <= 2000; ++i) {
    belt_csv += fmt::format("{:.9g},{:.12g},{:.12g}\n", 100 + i / 500.0,
                            1e3 * (belt(i / 500.0) + position_noise * normal(random)), wind(i / 500.0));
  }
  folder_.write("motor.csv", motor_csv);
  folder_.write("belt.csv", belt_csv);
  const Experiment e = read(sensor + unknowns + R"(
[[run]]
data = ["angles.csv", "belt.csv"]
[run.inputs]
"load.motor" = { column = "volt", factor = 0.1, zero = 0.3, file = "motor.csv", time = "t" }
"drive.belt" = { column = "mm", factor = 1e-3, noise = 2e-5 }
"load.wind" = "wind"
)");
  ASSERT_EQ(e.runs[0].data.size(), 2u);
  EXPECT_EQ(e.runs[0].inputs[0].file.filename(), "motor.csv");
  EXPECT_LT(e.runs[0].inputs[0].motion.curve->breaks().front(), 0.0) << "before the first reading of a sensor";
  EXPECT_LT(e.runs[0].inputs[1].motion.curve->breaks().size(), 60u) << "smoothed";
  const FitProblem problem(e);
  const Fit fitted = fit(problem, problem.records());
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  EXPECT_NEAR(fitted.residual_over_noise, 1.0, 5 * fitted.residual_over_noise_sigma);
  for (const Estimate& estimate : fitted.estimates) {
    EXPECT_NEAR(estimate.value, estimate.truth, 5 * estimate.standard_error) << estimate.name;
    EXPECT_LT(estimate.standard_error, 0.003 * estimate.truth) << estimate.name;
  }
}

/// The motor's torque is 0.12 per unit of the current, the wind's force 0.3 per unit of its pressure.
const std::string proportional = R"(
set = { "load.motor" = 0.12, "load.wind" = 0.3 }
)" + sensor;
const std::string proportional_unknowns = unknowns + R"([[unknown]]
path = "load.motor"
start = 0.2
[[unknown]]
path = "load.wind"
start = 0.2
[[unknown]]
path = "point.arm.T.x"
start = 0.35
prior = [0.4, 0.01]
)";
const std::string by_current = R"(
inputs = { "load.motor" = { column = "tau", factor = 8.333333333333333333, multiplies = true, file = "inputs.csv" }, "load.wind" = { column = "wind", factor = 3.333333333333333333, multiplies = true }, "drive.belt" = "belt" }
)";

TEST_F(DrivenRuns, HaveLoadsThatAreProportionalToAColumn) {
  folder_.write("inputs.csv", inputs_csv(200, 3, 0));
  const std::string run = "[[run]]\nduration = 3\nrate = 100\nrelease_rate = { arm = 1 }\n";
  const Experiment own =
      read(sensor + run +
           "inputs = { \"load.motor\" = { column = \"tau\", file = \"inputs.csv\" }, \"load.wind\" = "
           "\"wind\", \"drive.belt\" = \"belt\" }\n");
  const Experiment e = read(proportional + proportional_unknowns + run + by_current);
  const FitProblem problem(e);
  const Record expected = FitProblem(own).ideal_record(0);
  const Record found = problem.ideal_record(0);
  ASSERT_EQ(found.sensors[0].value.size(), 300u);
  for (std::size_t i = 0; i < 300; ++i) EXPECT_NEAR(found.sensors[0].value[i], expected.sensors[0].value[i], 1e-8);
  // Derivatives.
  const RunModel& model = problem.run(0);
  const auto predict = [&](const std::vector<double>& at, bool jacobian) {
    Prediction out;
    model.predict(at.data(), at.data() + 5, INFINITY, jacobian ? 1e-11 : 1e-13, jacobian, out);
    EXPECT_TRUE(out.ok) << out.why;
    return out;
  };
  std::vector<double> at = problem.unknowns_of(0, problem.starts());
  const std::vector<double> start = model.released();
  at.insert(at.end(), start.begin(), start.end());
  ASSERT_EQ(at.size(), 7u);
  const Prediction exact = predict(at, true);
  for (std::size_t c = 0; c < 7; ++c) {
    const std::vector<double> expected_by = test::derivative(
        [&](double by) {
          std::vector<double> moved = at;
          moved[c] += by;
          return predict(moved, false).reading;
        },
        1e-3);
    for (std::size_t i = 0; i < expected_by.size(); ++i) {
      ASSERT_NEAR(exact.jacobian[7 * i + c], expected_by[i], 1e-6 * (1 + std::abs(expected_by[i]))) << c;
    }
  }
  // Estimates.
  const Fit fitted = fit(problem, problem.records());
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  for (const Estimate& estimate : fitted.estimates) {
    EXPECT_NEAR(estimate.value, estimate.truth, 4 * estimate.standard_error) << estimate.name;
  }
  EXPECT_LT(fitted.estimates[2].standard_error, 0.01 * 0.12);
}

// Loads that are proportional to a column scale with masses.
TEST_F(DrivenRuns, LeaveTheScaleOfProportionalLoadsFree) {
  folder_.write("inputs.csv", inputs_csv(200, 3, 0));
  const std::string all = R"(
[[unknown]]
path = "body.arm.mass"
[[unknown]]
path = "body.arm.inertia"
[[unknown]]
path = "torsion_damper.grease.coefficient"
[[unknown]]
path = "load.motor"
)";
  const std::string run = R"([[run]]
duration = 3
rate = 100
inputs = { "load.motor" = { column = "tau", multiplies = true, file = "inputs.csv" } }
)";
  const std::string still = "set = { \"load.motor\" = 0.8, \"load.wind\" = 0 }\n" + sensor;
  const Experiment e = read(still + all + run);
  const FitProblem problem(e);
  const Identifiability found = assess(problem, problem.truths(), test::released(problem));
  ASSERT_TRUE(found.ok);
  ASSERT_EQ(found.null_directions.size(), 1u);
  EXPECT_TRUE(found.null_directions[0].scale) << found.null_directions[0].words;
  // A torque that the readings take the place of, as written in the scene, changes nothing, one that they multiply all.
  for (const bool multiplies : {false, true}) {
    const Experiment known =
        read(still + unknowns + "[[known]]\npath = \"load.motor\"\nrelative = 0.01\n" +
             (multiplies ? run
                         : "[[run]]\nduration = 3\nrate = 100\ninputs = { \"load.motor\" = { column = \"tau\", file = "
                           "\"inputs.csv\" } }\n"));
    const FitProblem of_known(known);
    const std::vector<Record> records = of_known.records();
    const std::vector<KnownEffect> effects = known_effects(of_known, fit(of_known, records), records);
    ASSERT_EQ(effects.size(), 1u);
    for (const double change : effects[0].change) {
      EXPECT_EQ(std::abs(change) > 1e-5, multiplies) << change;
      EXPECT_TRUE(multiplies || change == 0) << change;
    }
  }
}

// A torque that is read too rarely: the error of the straight lines is what input_effects() says.
TEST_F(DrivenRuns, SayWhatTheLinesBetweenReadingsChange) {
  folder_.write("inputs.csv", inputs_csv(1000, 4.1, 0));
  const Experiment truth = read(sensor + R"(
[[run]]
duration = 4
rate = 100
seed = 4
inputs = { "load.motor" = { column = "tau", file = "inputs.csv" } }
)");
  const Record record = FitProblem(truth).records()[0];
  folder_.write("angles.csv", angles_csv(record, 0));
  for (const double rate : {15.0, 1000.0}) {
    folder_.write("motor.csv", inputs_csv(rate, 4.1, 0));
    const Experiment e = read(sensor + unknowns + R"(
[[run]]
data = "angles.csv"
inputs = { "load.motor" = { column = "tau", file = "motor.csv" } }
)");
    const FitProblem problem(e);
    const std::vector<Record> records = problem.records();
    const Fit fitted = fit(problem, records);
    ASSERT_TRUE(fitted.usable()) << fitted.why;
    const std::vector<KnownEffect> effects = input_effects(problem, fitted, records);
    ASSERT_EQ(effects.size(), 1u);
    EXPECT_EQ(effects[0].name, "load.motor between readings");
    for (std::size_t p = 0; p < fitted.estimates.size(); ++p) {
      const Estimate& estimate = fitted.estimates[p];
      const double white = fitted.errors.white[p] / std::max(1.0, fitted.residual_over_noise);
      const double change = effects[0].change[p];
      EXPECT_NEAR(estimate.value + change, estimate.truth, 4 * white + 0.1 * std::abs(change)) << estimate.name;
      EXPECT_EQ(std::abs(change) > 10 * white, rate == 15) << "the test shows something";
      EXPECT_EQ(std::abs(change) < 0.3 * white, rate == 1000);
    }
  }
}

// A torque that is read with noise moves the predicted readings: no noise of a sensor, and no gap in the model.
TEST_F(DrivenRuns, NameInputsAsCausesOfAMisfit) {
  folder_.write("inputs.csv", inputs_csv(200, 4.1, 0));
  const Experiment truth = read(sensor + R"(
[[run]]
duration = 4
rate = 100
inputs = { "load.motor" = { column = "tau", file = "inputs.csv" } }
)");
  const std::vector<Record> records = FitProblem(truth).records();
  folder_.write("angles.csv", angles_csv(records[0], 0));
  std::string noisy = "time,tau\n";
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i <= 820; ++i) {
    noisy += fmt::format("{:.17g},{:.17g}\n", i / 200.0, motor(i / 200.0) + 0.05 * normal(random));
  }
  folder_.write("motor.csv", noisy);
  const std::string measured = sensor + unknowns + "[[run]]\ndata = \"angles.csv\"\n";
  const auto fit_with = [&](const std::string& inputs) {
    const Experiment e = read(measured + inputs);
    const FitProblem problem(e);
    return fit(problem, problem.records());
  };
  const Fit with_input = fit_with("inputs = { \"load.motor\" = { column = \"tau\", file = \"motor.csv\" } }\n");
  EXPECT_EQ(with_input.status, FitStatus::misfit);
  EXPECT_NE(with_input.why.find("or inputs that count as exact have errors (load.motor);"), std::string::npos)
      << with_input.why;
  const Fit without = fit_with("");
  EXPECT_EQ(without.status, FitStatus::misfit);
  EXPECT_EQ(without.why.find("input"), std::string::npos) << without.why;
}

TEST_F(DrivenRuns, AreRefusedInWords) {
  folder_.write("inputs.csv", inputs_csv(100, 1, 0));
  const std::string place = "experiment.toml:10: run 1.inputs.";
  EXPECT_EQ(
      error_of("{ \"load.moter\" = \"tau\" }"),
      place +
          "load.moter: expected load.NAME of a force or torque, drive.NAME, or a number of a force element, in quotes; "
          "did you mean \"load.motor\"?");
  EXPECT_EQ(
      error_of("{ load.motor = \"tau\" }"),
      place +
          "load: expected load.NAME of a force or torque, drive.NAME, or a number of a force element, in quotes; known "
          "here: load.wind, load.motor, drive.belt, torsion_damper.grease.coefficient");
  EXPECT_EQ(error_of("{ \"load.motor\" = \"tau\" }"),
            place + "load.motor: expected the file of the column; write { column = \"tau\", file = \"...\" }");
  EXPECT_EQ(error_of("{ \"load.motor\" = { column = \"tau\", file = \"none.csv\" } }"),
            place + "load.motor.file: expected a data file, there is no \"none.csv\"; correct the path");
  EXPECT_EQ(error_of("{ \"load.motor\" = { column = \"tau\", file = \"inputs.csv\" } }"),
            place +
                "load.motor: expected readings from the start of run \"run 1\", 0 s, to its end, 2 s, found them from "
                "0 s to 1 s; leave out the rows of the run before and after them");
  EXPECT_EQ(
      error_of("{ \"load.motor\" = { column = \"tau\", file = \"inputs.csv\", noise = 1 } }"),
      place +
          "load.motor.noise: expected noise of a load in a measured run, found it in a simulated one; leave it out");
  EXPECT_EQ(error_of("{ \"load.motor\" = { column = \"tau\", time = \"t\" } }"),
            place + "load.motor.time: expected the key file as well; the times of data files are in time of the run");
  EXPECT_EQ(error_of("{ \"load.motor\" = { file = \"inputs.csv\" } }"),
            place + "load.motor: expected the key column; add column = \"...\"");
  folder_.write("rough.csv", inputs_csv(100, 3, 1e-2));
  EXPECT_EQ(error_of("{ \"drive.belt\" = { column = \"belt\", file = \"rough.csv\", noise = 1e-4 } }"),
            place +
                "drive.belt: expected readings that scatter about a smooth curve by their noise, found more, or fewer "
                "than two for each interval of the curve; raise noise, or leave it out for a curve through every "
                "reading");
  EXPECT_EQ(
      error(sensor + "[[unknown]]\npath = \"load.motor\"\n[[run]]\nduration = 1\nrate = 100\ninputs = { "
                     "\"load.motor\" = { column = \"tau\", file = \"inputs.csv\" } }\n"),
      "experiment.toml:7: unknown \"load.motor\".path: expected a number that no input takes the place of, run "
      "\"run 1\" has \"load.motor\" as an input in line 12; take one of the two out, or let the input multiply it "
      "with multiplies = true");
  EXPECT_EQ(error_of("{ \"drive.belt\" = { column = \"belt\", file = \"inputs.csv\", multiplies = true } }"),
            place + "drive.belt.multiplies: expected multiplies of a load only; leave it out");
}

}  // namespace
}  // namespace poise::driven_runs_test
