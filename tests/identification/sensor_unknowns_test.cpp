// Zero, factor and delay of a sensor as unknowns.

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/assessment/compare_models.hpp"
#include "identification/assessment/known_numbers.hpp"
#include "identification/fit/fit.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::sensor_unknowns_test {
namespace {

using app_tests::run_poise;

/// An arm on a torsion spring that carries another one on a line spring.
const char* const scene = R"(
title = "two arms"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], W = [0.5, 0.1] }
[body.upper]
points = { A = [0, 0], B = [0.4, 0] }
mass = 1.3
center = [0.2, 0]
inertia = 0.05
[body.lower]
points = { B = [0, 0], T = [0.3, 0] }
mass = 0.7
center = [0.15, 0.02]
inertia = 0.02
[[pin]]
points = ["ground.O", "upper.A"]
[[pin]]
points = ["upper.B", "lower.B"]
[[torsion_damper]]
name = "grease"
bodies = ["ground", "upper"]
coefficient = 0.08
[[torsion_damper]]
name = "oil"
bodies = ["upper", "lower"]
coefficient = 0.02
[[spring]]
name = "coil"
points = ["ground.W", "lower.T"]
stiffness = 30
free_length = 0.3
[start]
upper = -1.5707963267948966
lower = -1.5707963267948966
)";

const std::string angles = R"(
scene = "scene.toml"
[[sensor]]
name = "one"
angle = "upper"
noise = 1e-3
[[sensor]]
name = "two"
angle = ["upper", "lower"]
noise = 1e-3
)";

std::string unknown(const std::string& path, const std::string& more = "") {
  return "[[unknown]]\npath = \"" + path + "\"\n" + more + "\n";
}

const std::string swing = R"(
[[run]]
duration = 3
rate = 50
release = { upper = -0.9, lower = -2.1 }
)";

class SensorUnknowns : public test::WrittenExperiment {
 protected:
  SensorUnknowns() : WrittenExperiment(scene) {}

  /// A record of a problem's run as a CSV file, with all digits.
  std::string write_csv(const std::string& name, const Experiment& experiment, const Record& record) const {
    std::string text = "time";
    for (const Sensor& sensor : experiment.sensors) text += "," + sensor.column;
    for (std::size_t i = 0; i < record.sensors[0].time.size(); ++i) {
      text += fmt::format("\n{:.17g}", record.sensors[0].time[i]);
      for (const Series& series : record.sensors) text += fmt::format(",{:.17g}", series.value[i]);
    }
    return folder_.write(name, text + "\n");
  }
};

void expect_exact_jacobian(const FitProblem& problem) {
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    SCOPED_TRACE(run.run().name);
    std::vector<double> at = problem.unknowns_of(r, problem.starts());
    const auto unknowns = static_cast<std::ptrdiff_t>(at.size());
    const std::vector<double> start = run.released();
    at.insert(at.end(), start.begin(), start.end());
    const auto predict = [&](const std::vector<double>& values, bool jacobian) {
      Prediction out;
      run.predict(values.data(), values.data() + unknowns, INFINITY, jacobian ? 1e-11 : 1e-13, jacobian, out);
      EXPECT_TRUE(out.ok) << out.why;
      return out;
    };
    const Prediction exact = predict(at, true);
    const auto width = static_cast<std::size_t>(run.columns());
    for (std::size_t c = 0; c < width; ++c) {
      const std::vector<double> expected = test::derivative(
          [&](double by) {
            std::vector<double> moved = at;
            moved[c] += by;
            return predict(moved, false).reading;
          },
          1e-4);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_NEAR(exact.jacobian[width * i + c], expected[i], 3e-6 * (1 + std::abs(expected[i])))
            << "column " << c << ", reading " << i;
      }
    }
  }
}

TEST_F(SensorUnknowns, HaveExactDerivatives) {
  std::string text = R"(
scene = "scene.toml"
[[sensor]]
name = "angle"
angle = "upper"
noise = 1e-3
[[sensor]]
name = "rate"
angle = ["upper", "lower"]
rate = true
noise = 1e-3
zero = 0.1
[[sensor]]
name = "far"
distance = ["ground.O", "lower.T"]
noise = 1e-3
factor = -2
delay = 0.03
[[sensor]]
name = "pull"
force = "coil"
noise = 1e-2
[[sensor]]
name = "climb"
y = "lower.T"
rate = true
noise = 1e-2
)" + unknown("spring.coil.stiffness") +
                     unknown("point.lower.T.x");
  for (const char* const name : {"angle", "rate", "far", "pull", "climb"}) {
    const std::string path = fmt::format("sensor.{}.", name);
    text += unknown(path + "delay", "start = 0.0123\nmin = -0.05\nmax = 0.1");
    text += unknown(path + "zero", "start = 0.07");
    text += unknown(path + "factor", name == std::string("far") ? "start = -1.7" : "start = 1.3");
  }
  text += unknown("torsion_damper.oil.coefficient");
  text += swing;
  text += R"(
[[run]]
name = "held"
duration = 1
rate = 40
release = { upper = -0.9, lower = -2.1 }
start_known = true
[[run]]
name = "thrown"
duration = 1
rate = 40
release = { upper = -0.9, lower = -2.1 }
release_rate = { upper = 2 }
start_known = true
)";
  const Experiment e = read(text);
  const FitProblem problem(e);
  ASSERT_EQ(problem.run(0).unknowns(), 18);
  EXPECT_EQ(problem.run(0).left_out(), 5 * 5u) << "before 0.1 s";
  EXPECT_EQ(problem.run(1).left_out(), 0u) << "it stands at its release until 0 s";
  EXPECT_EQ(problem.run(2).left_out(), 5 * 4u);
  expect_exact_jacobian(problem);
}

TEST_F(SensorUnknowns, HaveExactDerivativesAboutAnEquilibrium) {
  Experiment e = test::experiment("lift_experiment");
  for (const auto of : {SensorNumber::Of::zero, SensorNumber::Of::factor, SensorNumber::Of::delay}) {
    Unknown number;
    number.path = number.name = fmt::format("sensor.angle.{}", static_cast<int>(of));
    number.of_sensor = SensorNumber{0, of};
    number.start = of == SensorNumber::Of::factor ? 1.2 : 0.001;
    e.unknowns.push_back(number);
  }
  e.sensors[0].most_delay = 0.0021;
  for (poise::Run& run : e.runs) run.duration = 0.1;
  expect_exact_jacobian(FitProblem(e));
}

// Predictions are those of the sensor as written; what the column would have had follows.
TEST_F(SensorUnknowns, ReadWhatTheFormulaSays) {
  const std::string run = "[[run]]\nduration = 1\nrate = 200\nrelease = { upper = -0.9, lower = -2.1 }\n";
  const Experiment plain = read(angles + run + "start_known = true\n");
  const Record now = FitProblem(plain).ideal_record(0);
  Experiment e = read(angles + unknown("sensor.two.zero") + unknown("sensor.two.factor") +
                      unknown("sensor.two.delay", "min = 0\nmax = 0.1") + run + "start_known = true\n");
  e.sensors[1].zero = 0.4;
  e.sensors[1].unit = -3;
  const FitProblem problem(e);
  const std::vector<double> unknowns{0.1, 2.0, 0.05};
  Prediction out;
  problem.run(0).predict(unknowns.data(), nullptr, INFINITY, 1e-11, false, out);
  ASSERT_TRUE(out.ok) << out.why;
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_NEAR(out.reading[i], now.sensors[0].value[i], 1e-8);
    const double quantity = now.sensors[1].value[i < 10 ? 0 : i - 10];
    EXPECT_NEAR(out.reading[200 + i], 0.4 - 3 * (quantity - 0.1) / 2.0, 1e-8) << i;
  }
}

TEST_F(SensorUnknowns, AKnownDelayIsHonoured) {
  const Experiment plain = read(angles + swing);
  const Record now = FitProblem(plain).ideal_record(0);
  const std::string delayed = angles + "delay = 0.04\n";
  const Experiment simulated = read(delayed + swing);
  const Record late = FitProblem(simulated).ideal_record(0);
  ASSERT_EQ(late.sensors[0].value.size(), 150u);
  ASSERT_EQ(late.sensors[1].value.size(), 148u) << "from 0.04 s on";
  for (std::size_t i = 0; i < 148; ++i) EXPECT_NEAR(late.sensors[1].value[i], now.sensors[1].value[i], 1e-8) << i;
  // Measured: the angle at t - 0.04 stands in the row of t.
  Record record = now;
  for (std::size_t i = 150; i-- > 0;) record.sensors[1].value[i] = now.sensors[1].value[i < 2 ? 0 : i - 2];
  write_csv("late.csv", plain, record);
  const std::string rest = unknown("spring.coil.stiffness", "start = 25") + "[[run]]\ndata = \"late.csv\"\n";
  for (const bool known : {true, false}) {
    const Experiment e = read((known ? delayed : angles) + rest);
    EXPECT_EQ(e.runs[0].left_out, known ? 2u : 0u);
    const FitProblem problem(e);
    const Fit fitted = fit(problem, problem.records());
    ASSERT_TRUE(fitted.usable()) << fitted.why;
    if (known) {
      EXPECT_NEAR(fitted.estimates[0].value, 30, 1e-6);
      EXPECT_LT(fitted.residual_over_noise, 1e-5);
    } else {
      EXPECT_GT(fitted.residual_over_noise, 10) << "without the delay";
    }
  }
}

// Numbers of both sensors beside those of the mechanism. The angles' zeros would be free with those of the arms'
// frames only, the springs and weights tell them.
const std::string all_unknowns = unknown("spring.coil.stiffness", "start = 27") +
                                 unknown("torsion_damper.grease.coefficient", "start = 0.06") +
                                 unknown("sensor.one.zero", "start = 0") + unknown("sensor.one.factor", "start = 1") +
                                 unknown("sensor.two.zero", "start = 0") + unknown("sensor.two.factor", "start = 1") +
                                 unknown("sensor.two.delay", "start = 0.01\nmin = 0\nmax = 0.06");
const std::string scaled_angles = R"(
scene = "scene.toml"
[[sensor]]
name = "one"
angle = "upper"
noise = 1e-3
zero = 0.05
factor = 0.97
[[sensor]]
name = "two"
angle = ["upper", "lower"]
noise = 1e-3
zero = -0.03
factor = 1.04
delay = 0.023
)";

TEST_F(SensorUnknowns, AreRecoveredToRoundingWithoutNoise) {
  for (const char* const start : {"", "start_known = true\n"}) {
    std::string text = scaled_angles;
    const Experiment e = read(text.append(all_unknowns).append(swing).append(start));
    const FitProblem problem(e);
    FitOptions options;
    options.function_tolerance = 1e-14;
    const Fit fitted = fit(problem, {problem.ideal_record(0)}, options);
    ASSERT_TRUE(fitted.usable()) << fitted.why;
    for (const Estimate& estimate : fitted.estimates) {
      EXPECT_NEAR(estimate.value, estimate.truth, 1e-6 * std::max(1.0, std::abs(estimate.truth))) << estimate.name;
      EXPECT_FALSE(estimate.withheld) << estimate.name << ": " << estimate.why;
    }
  }
}

TEST_F(SensorUnknowns, HaveIntervalsThatCoverTheTruth) {
  const Experiment e = read(scaled_angles + all_unknowns + swing);
  const FitProblem problem(e);
  const Record ideal = problem.ideal_record(0);
  constexpr int fits = 100;
  std::vector<int> covered(problem.parameters().size(), 0);
  for (int sample = 0; sample < fits; ++sample) {
    std::vector<Record> records{ideal};
    problem.add_noise(records[0], solvers::RandomStream(77, static_cast<std::uint32_t>(sample)));
    const Fit fitted = fit(problem, records);
    ASSERT_TRUE(fitted.usable()) << fitted.why;
    for (std::size_t p = 0; p < covered.size(); ++p) {
      const Estimate& one = fitted.estimates[p];
      if (sample == 0) {
        EXPECT_NEAR(one.value, one.truth, 3.5 * one.standard_error) << one.name;
      }
      covered[p] += one.low <= one.truth && one.truth <= one.high ? 1 : 0;
    }
  }
  for (std::size_t p = 0; p < covered.size(); ++p) EXPECT_GE(covered[p], 88) << problem.parameters()[p].name;
}

TEST_F(SensorUnknowns, ACommonDelayIsTheStart) {
  const std::string delays = unknown("sensor.one.delay", "min = -0.05\nmax = 0.05") +
                             unknown("sensor.two.delay", "min = 0\nmax = 0.06") + unknown("spring.coil.stiffness");
  Experiment e = read(scaled_angles + delays + swing);
  const FitProblem problem(e);
  const Fit fitted = fit(problem, problem.records());
  ASSERT_TRUE(fitted.usable()) << fitted.why;
  EXPECT_TRUE(fitted.estimates[0].withheld);
  EXPECT_TRUE(fitted.estimates[1].withheld);
  EXPECT_FALSE(fitted.estimates[2].withheld) << fitted.estimates[2].why;
  ASSERT_EQ(fitted.identifiability.combinations.size(), 1u);
  const Identifiability::Combination& difference = fitted.identifiability.combinations[0];
  const double sign = difference.unit_of == 0 ? -1.0 : 1.0;
  EXPECT_NEAR(difference.coefficient[0], -sign, 1e-6) << difference.words;
  EXPECT_NEAR(difference.coefficient[1], sign, 1e-6) << difference.words;
  EXPECT_NEAR(sign * difference.value, 0.023, 3.5 * difference.standard_error);
  EXPECT_LT(difference.standard_error, 1e-3);
  // Where the start is known both are.
  const Experiment known = read(scaled_angles + delays + swing + "start_known = true\n");
  const FitProblem of_known(known);
  const Identifiability found = assess(of_known, of_known.truths(), test::released(of_known));
  EXPECT_EQ(found.rank, 3);
  for (std::size_t p = 0; p < 3; ++p) EXPECT_LT(found.standard_error[p], 0.01 * (p < 2 ? 1 : 30)) << p;
}

TEST_F(SensorUnknowns, AZeroThatTheFreeLengthMayBeIsWithheld) {
  folder_.write("carriage.toml", R"(
[ground]
points = { O = [0, 0], W = [-1, 0] }
[body.cart]
points = { O = [0, 0] }
mass = 2
[[slide]]
name = "rail"
points = ["ground.O", "cart.O"]
axis = [1, 0]
[[spring]]
name = "coil"
slide = "rail"
stiffness = 50
free_length = 0.2
)");
  const Experiment e =
      read(R"(
scene = "carriage.toml"
[[sensor]]
name = "place"
travel = "rail"
noise = 1e-3
[[sensor]]
name = "rate"
travel = "rail"
rate = true
noise = 1e-3
)" + unknown("sensor.place.zero") +
           unknown("spring.coil.free_length") + unknown("spring.coil.stiffness") + unknown("sensor.place.factor") +
           unknown("sensor.rate.factor") + "[[run]]\nduration = 4\nrate = 50\nrelease = { rail = 0.5 }\n");
  const FitProblem problem(e);
  const Identifiability found = assess(problem, problem.truths(), test::released(problem));
  ASSERT_TRUE(found.ok);
  // zero with the free length, and both factors with it and the size of the motion.
  EXPECT_EQ(found.rank, 3);
  for (const std::size_t p : {0u, 1u, 3u, 4u}) EXPECT_TRUE(std::isinf(found.standard_error[p])) << p;
  EXPECT_LT(found.standard_error[2], 1);
}

TEST_F(SensorUnknowns, BelongToASession) {
  const Experiment e =
      read(scaled_angles + unknown("sensor.one.zero", "per = \"day\"") + unknown("spring.coil.stiffness") + swing +
           "name = \"a\"\nlabels = { day = \"1\" }\n" + swing + "name = \"b\"\nseed = 4\nlabels = { day = \"2\" }\n");
  const FitProblem problem(e);
  ASSERT_EQ(problem.parameters().size(), 3u);
  std::vector<Record> records = problem.records();
  for (double& value : records[1].sensors[0].value) value -= 0.02 * 1;  // of the column: (g - zero) / factor
  const Fit fitted = fit(problem, records);
  ASSERT_TRUE(fitted.usable()) << fitted.why;
  EXPECT_EQ(fitted.estimates[0].name, "sensor.one.zero (1)");
  const Estimate& other = fitted.estimates[test::parameter(problem, "sensor.one.zero (2)")];
  EXPECT_NEAR(fitted.estimates[0].value, 0.05, 4 * fitted.estimates[0].standard_error);
  EXPECT_NEAR(other.value, 0.05 + 0.02, 4 * other.standard_error);
}

TEST_F(SensorUnknowns, StandBesideNumbersThatAreKnownHowWell) {
  const Experiment e = read(scaled_angles + all_unknowns + "[[known]]\npath = \"body.upper.mass\"\nrelative = 0.001\n" +
                            swing + "seed = 2\n");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  FitOptions options;
  options.function_tolerance = 1e-14;
  const Fit fitted = fit(problem, records, options);
  ASSERT_TRUE(fitted.usable()) << fitted.why;
  const std::vector<KnownEffect> effects = known_effects(problem, fitted, records);
  ASSERT_EQ(effects.size(), 1u);
  // The same by a fit with the mass changed.
  Experiment heavier = e;
  heavier.scene.bodies[1].mass *= 1.001;
  const FitProblem other(heavier);
  options.from = &fitted;
  const Fit again = fit(other, records, options);
  for (std::size_t p = 0; p < effects[0].change.size(); ++p) {
    EXPECT_NEAR(again.parameters[p] - fitted.parameters[p], effects[0].change[p],
                0.05 * std::abs(effects[0].change[p]) + 0.02 * fitted.estimates[p].standard_error)
        << p;
  }
}

/// Two sensors of readings without noise, the second with these numbers, and unknowns of the scene and of the first.
std::string measured(double zero, double factor, double delay, double one_delay = 0) {
  return fmt::format(
             "{}zero = {:.17g}\nfactor = {:.17g}\ndelay = {:.17g}\n[[sensor]]\nname = \"one\"\nangle = "
             "\"upper\"\nnoise = 1e-3\ndelay = {:.17g}\n",
             "scene = \"scene.toml\"\n[[sensor]]\nname = \"two\"\nangle = [\"upper\", \"lower\"]\nnoise = 1e-3\n", zero,
             factor, delay, one_delay) +
         unknown("spring.coil.stiffness") + unknown("sensor.one.factor") +
         unknown("torsion_damper.grease.coefficient") + "[[run]]\ndata = \"read.csv\"\n";
}

// Each known number of a sensor, with one of the scene beside them: the estimates change as in fits with the number
// changed in the file. A delay that the file does not have may be uncertain, too.
TEST_F(SensorUnknowns, MoveTheEstimatesWhereTheyAreKnown) {
  const Experiment truth = read(angles + "delay = 0.023\n" + swing + "start_known = true\n");
  write_csv("read.csv", truth, FitProblem(truth).ideal_record(0));
  const std::string known = R"(
[[known]]
path = "sensor.two.zero"
deviation = 0.002
[[known]]
path = "body.upper.mass"
relative = 0.001
[[known]]
path = "sensor.two.factor"
relative = 0.001
[[known]]
path = "sensor.two.delay"
deviation = 0.0005
[[known]]
path = "sensor.one.delay"
deviation = 0.0005
)";
  FitOptions options;
  options.function_tolerance = 1e-14;
  const Experiment e = read(measured(0, 1, 0.023) + known);
  const FitProblem problem(e);
  const Fit fitted = fit(problem, problem.records(), options);
  ASSERT_TRUE(fitted.usable()) << fitted.why;
  const std::vector<KnownEffect> effects = known_effects(problem, fitted, problem.records());
  ASSERT_EQ(effects.size(), 5u);
  // Of the sensor without delay an earlier clock, with which no reading is left out.
  const std::vector<std::tuple<std::size_t, std::string, std::string, double>> others = {
      {0, "sensor.two.zero", measured(0.002, 1, 0.023), 1.0},
      {2, "sensor.two.factor", measured(0, 1.001, 0.023), 1.0},
      {3, "sensor.two.delay", measured(0, 1, 0.0235), 1.0},
      {4, "sensor.one.delay", measured(0, 1, 0.023, -0.0005), -1.0}};
  options.from = &fitted;
  for (const auto& [i, path, text, sign] : others) {
    const Experiment other = read(text);
    const FitProblem changed(other);
    const Fit again = fit(changed, changed.records(), options);
    ASSERT_TRUE(again.usable()) << path << ": " << again.why;
    EXPECT_EQ(effects[i].name, path);
    double largest = 0.0;  // of the changes, in standard errors
    for (std::size_t p = 0; p < effects[i].change.size(); ++p) {
      const double change = effects[i].change[p];
      const double error = fitted.estimates[p].standard_error;
      EXPECT_NEAR(sign * (again.parameters[p] - fitted.parameters[p]), change, 0.03 * std::abs(change) + 0.01 * error)
          << path << ", " << fitted.estimates[p].name;
      largest = std::max(largest, std::abs(change) / error);
    }
    EXPECT_GT(largest, 1.0) << path;
  }
}

TEST_F(SensorUnknowns, AreTheirOwnInExperimentsOfOneFit) {
  folder_.write("a.toml", scaled_angles + unknown("sensor.one.zero") + swing);
  folder_.write("b.toml", scaled_angles + unknown("sensor.one.zero") + swing);
  folder_.write("c.toml", angles + unknown("sensor.one.zero") + swing);
  const Experiment same = read("experiments = [\"a.toml\", \"b.toml\"]\n");
  EXPECT_EQ(FitProblem(same).parameters().size(), 1u);
  const Experiment other = read("experiments = [\"a.toml\", \"c.toml\"]\n");
  const FitProblem problem(other);
  ASSERT_EQ(problem.parameters().size(), 2u) << "the zeros of columns that were converted otherwise";
  EXPECT_EQ(problem.parameters()[0].name, "sensor.one (a).zero");
  EXPECT_EQ(problem.parameters()[1].name, "sensor.one (c).zero");
  EXPECT_EQ(problem.parameters()[0].truth, 0.05);
  EXPECT_EQ(problem.parameters()[1].truth, 0.0);
}

TEST_F(SensorUnknowns, AreTheirOwnInExperimentsOfOneFitWhereTheyAreKnown) {
  const std::string rest = unknown("spring.coil.stiffness") + swing;
  const std::string known = "[[known]]\npath = \"sensor.one.zero\"\ndeviation = 0.01\n";
  folder_.write("a.toml", scaled_angles + known + rest);
  folder_.write("b.toml", scaled_angles + known + rest);
  folder_.write("c.toml", angles + known + rest);
  const auto effects_of = [&](const std::string& files) {
    const Experiment joint = read("experiments = [" + files + "]\n");
    const FitProblem problem(joint);
    const std::vector<Record> records = problem.records();
    return known_effects(problem, fit(problem, records), records);
  };
  const std::vector<KnownEffect> same = effects_of("\"a.toml\", \"b.toml\"");
  ASSERT_EQ(same.size(), 1u) << "one sensor";
  EXPECT_EQ(same[0].name, "sensor.one.zero");
  const std::vector<KnownEffect> apart = effects_of("\"a.toml\", \"c.toml\"");
  ASSERT_EQ(apart.size(), 2u) << "the zeros of columns that were converted otherwise";
  EXPECT_EQ(apart[0].name, "sensor.one (a).zero");
  EXPECT_EQ(apart[1].name, "sensor.one (c).zero");
  // The error of one sensor acts in both parts, those of two are independent.
  const double together = std::abs(same[0].change[0]);
  EXPECT_NEAR(std::abs(apart[0].change[0] + apart[1].change[0]), together, 0.1 * together);
  EXPECT_LT(std::hypot(apart[0].change[0], apart[1].change[0]), 0.8 * together);
}

TEST_F(SensorUnknowns, AreRefusedInWordsWhereTheyAreKnown) {
  const auto of = [&](const std::string& path, const std::string& more) {
    return error(angles + unknown("sensor.one.zero") + "[[known]]\npath = \"" + path + "\"\n" + more + "\n" + swing);
  };
  const std::string known_1 = "experiment.toml:15: known 1.path: expected ";
  EXPECT_EQ(
      of("sensor.one.zero", "deviation = 1"),
      known_1 + "a number that is not unknown, it is in line 11; take one of them out, or give the unknown a prior");
  EXPECT_EQ(of("sensor.two.offset", "deviation = 1"),
            known_1 +
                "sensor.NAME.zero, sensor.NAME.factor or sensor.NAME.delay, found \"sensor.two.offset\"; known here: "
                "zero, factor, delay");
  EXPECT_EQ(of("sensor.too.zero", "deviation = 1"),
            known_1 + "the name of a sensor, found \"too\"; did you mean \"two\"?");
  EXPECT_EQ(
      of("sensor.two.delay", "relative = 0.1"),
      "experiment.toml:16: known 1.relative: expected deviation, since the number is 0, of which any part is none");
  // Its reading gives no start that is exact.
  const Experiment simulated = read(angles + swing);
  write_csv("read.csv", simulated, FitProblem(simulated).ideal_record(0));
  const Experiment uncertain =
      read(angles + unknown("spring.coil.stiffness") + "[[known]]\npath = \"sensor.two.zero\"\ndeviation = 0.01\n" +
           "[[run]]\ndata = \"read.csv\"\nstart_known = true\nrelease_rate = { upper = 0, lower = 0 }\n");
  try {
    const FitProblem problem(uncertain);
    ADD_FAILURE();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(
        text.find("expected where \"lower\" starts; add release = { \"lower\" = NUMBER } or a sensor of it without "
                  "delay and with exact numbers"),
        std::string::npos)
        << text;
  }
}

TEST_F(SensorUnknowns, AreComparedWithNone) {
  const Experiment simulated = read(scaled_angles + swing + "seed = 8\n");
  write_csv("late.csv", simulated, FitProblem(read(angles + swing)).records()[0]);
  const std::string rest = unknown("spring.coil.stiffness", "start = 25") + "[[run]]\ndata = \"late.csv\"\n";
  const std::string without = folder_.write("without.toml", angles + rest);
  const std::string with =
      folder_.write("with.toml", angles + unknown("sensor.two.delay", "min = -0.05\nmax = 0.1") + rest);
  const app_tests::ProgramRun run = run_poise({"identify", without, with});
  EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_NE(run.out.find("likelihood"), std::string::npos) << run.out;
}

TEST_F(SensorUnknowns, AreKeptForLaterRuns) {
  const std::string file = folder_.write("experiment.toml", scaled_angles + all_unknowns + swing + "seed = 5\n");
  const std::string fit_file = folder_.path("fit.json"), scene_file = folder_.path("fitted.toml");
  app_tests::ProgramRun run = run_poise({"identify", file, "--json", fit_file, "--scene", scene_file});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_NE(run.out.find("left out     3 readings for the delays of sensors"), std::string::npos) << run.out;
  EXPECT_NE(app_tests::contents(fit_file).find("\"readings_left_out\": 3"), std::string::npos);
  EXPECT_NE(app_tests::contents(scene_file)
                .find("# sensor.two.delay is a number of the experiment, for its [[sensor]]: 0.02"),
            std::string::npos)
      << app_tests::contents(scene_file);
  const std::string other =
      folder_.write("other.toml", scaled_angles + all_unknowns +
                                      "[[run]]\nduration = 2\nrate = 50\nseed = 6\nrelease = { upper = -1.2 }\n");
  for (const char* const starts : {"fitted", "measured"}) {
    run = run_poise({"validate", other, "--with", fit_file, "--starts", starts});
    EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
    if (starts == std::string("fitted")) {
      EXPECT_NE(run.out.find("agrees with the noise"), std::string::npos) << run.out;
    }
  }
  run = run_poise({"montecarlo", file, "--trials", "4"});
  EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
  run = run_poise({"identify", file, "--profile", "sensor.two.delay", "--bootstrap", "20"});
  EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
}

TEST_F(SensorUnknowns, ArePlanned) {
  const std::string file = folder_.write(
      "experiment.toml", scaled_angles + all_unknowns +
                             "[plan]\nruns = 2\ncandidates = 4\n[[plan.vary]]\nwhat = \"release.upper\"\nmin = "
                             "-1.5\nmax = -0.5\n" +
                             swing);
  const app_tests::ProgramRun run = run_poise({"plan", file});
  EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_NE(run.out.find("sensor.two.delay"), std::string::npos) << run.out;
}

TEST_F(SensorUnknowns, AreRefusedInWords) {
  const auto of = [&](const std::string& table) { return error(angles + table + swing); };
  const std::string unknown_1 = "experiment.toml:12: unknown 1.path: expected ";
  EXPECT_EQ(of(unknown("sensor.one.offset")),
            unknown_1 +
                "sensor.NAME.zero, sensor.NAME.factor or sensor.NAME.delay, found \"sensor.one.offset\"; known here: "
                "zero, factor, delay");
  EXPECT_EQ(of(unknown("sensor.too.zero")), unknown_1 + "the name of a sensor, found \"too\"; did you mean \"two\"?");
  EXPECT_EQ(of(unknown("sensor.zero")),
            unknown_1 +
                "sensor.NAME.zero, sensor.NAME.factor or sensor.NAME.delay, found \"sensor.zero\"; did you mean "
                "\"zero\"?");
  const std::string range =
      "experiment.toml:11: unknown 1: expected the range of the delay in s, which says how many readings are left "
      "out; ";
  EXPECT_EQ(of(unknown("sensor.one.delay")), range + "add min = NUMBER and max = NUMBER");
  EXPECT_EQ(of(unknown("sensor.one.delay", "min = 0")), range + "add max = NUMBER");
  EXPECT_EQ(of(unknown("sensor.one.delay", "max = 1")), range + "add min = NUMBER");
  EXPECT_EQ(of(unknown("sensor.one.delay", "min = 0\nmax = 3")),
            "experiment.toml:3: sensor \"one\".delay: expected delays shorter than run \"run 1\" of 3 s, found max = 3 "
            "s where it is unknown; narrow min and max, or leave the run out");
  EXPECT_EQ(of("delay = -4\n"),
            "experiment.toml:7: sensor \"two\".delay: expected delays shorter than run \"run 1\" of 3 s, found -4 s; "
            "correct it, or leave the run out");
  EXPECT_EQ(error(angles + "delay = 2.97\n" + swing + "sensors = [\"two\"]\n"),
            "experiment.toml:13: run \"run 1\": expected at least 3 readings, found 1 at which the motion is known for "
            "all delays that its sensors may have; narrow min and max of the delays, or leave the run out");
  EXPECT_EQ(of("delay = \"late\"\n"), "experiment.toml:11: sensor \"two\".delay: expected a number, found a string");
  EXPECT_EQ(of(unknown("sensor.one.factor", "min = -1")),
            "experiment.toml:13: unknown 1.min: expected a range of the factor without 0 inside; leave min and max out "
            "to keep its sign");
  EXPECT_EQ(of(unknown("sensor.one.factor", "start = 0")),
            "experiment.toml:13: unknown 1.start: expected a factor other than 0");
  EXPECT_EQ(of(unknown("sensor.one.factor", "start = -1")),
            "experiment.toml:13: unknown 1.start: expected a start of at least 0, found -1; change one of the two");
  EXPECT_EQ(of(unknown("sensor.one.zero", "includes = 1")),
            "experiment.toml:13: unknown 1.includes: expected a number of the scene, this is one of a sensor; leave "
            "includes out");
  const app_tests::ProgramRun run = run_poise(
      {"identify", folder_.write("experiment.toml", angles + unknown("sensor.one.delay", "max = 1") + swing)});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

}  // namespace
}  // namespace poise::sensor_unknowns_test
