// Experiments on scenes whose loads and drives are functions of time: their numbers as unknowns.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "model/parameters.hpp"
#include "tests/identification/crane.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"
#include "tests/support/message_of.hpp"

namespace poise::functions_of_time_test {
namespace {

/// With these functions of time.
std::string crane(const std::string& motor, const std::string& wind, const std::string& belt) {
  return test::crane("value = 0.8\n" + motor, wind, belt, "-1.3");
}

const std::string sines = crane("time = { sine = { amplitude = 0.7, frequency = 0.9, phase = 0.3, offset = 0.2 } }",
                                "time = { ramp = { from = 0.2, to = 2, start = 0.3, end = 0.9 } }",
                                "time = { ramp = { from = 0.1, to = 0.4, start = 0.2, end = 1.1 } }");
const std::string steps = crane("time = { step = { at = 0.4, from = 0.5, to = -1 } }",
                                "time = { ramp = { from = 1, to = 0, start = 0.25, end = 0.75, law = "
                                "\"polynomial_345\" } }",
                                "time = { sine = { amplitude = 0.1, frequency = 0.8 } }");

const std::string sensor = R"(
scene = "scene.toml"
[[sensor]]
name = "angle"
angle = ["cart", "arm"]
noise = 1e-4
)";

std::string unknowns(const std::vector<std::string>& paths) {
  std::string out;
  for (const std::string& path : paths) out += "[[unknown]]\npath = \"" + path + "\"\n";
  return out;
}

const std::vector<std::string> numbers_of_sines{
    "load.motor",           "load.motor.time.amplitude", "load.motor.time.frequency", "load.motor.time.phase",
    "load.wind.time.from",  "load.wind.time.to",         "load.wind.time.start",      "load.wind.time.end",
    "drive.belt.time.from", "drive.belt.time.to",        "drive.belt.time.start",     "drive.belt.time.end",
    "body.arm.mass"};
const std::vector<std::string> numbers_of_steps{
    "load.motor.time.at",     "load.motor.time.from",      "load.motor.time.to",        "load.wind.time.start",
    "load.wind.time.end",     "drive.belt.time.amplitude", "drive.belt.time.frequency", "drive.belt.time.phase",
    "drive.belt.time.offset", "body.arm.inertia"};

class FunctionsOfTime : public test::WrittenExperiment {
 protected:
  FunctionsOfTime() : WrittenExperiment(sines) {}
};

/// Derivatives of all readings by all unknowns, and by an unknown start, against differences of predictions.
void expect_exact_jacobian(const Experiment& e, std::size_t unknowns, double accuracy = 2e-6) {
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  const auto columns = static_cast<std::size_t>(run.columns());
  ASSERT_EQ(columns, unknowns + (e.runs[0].unknown_start ? 2U : 0U));
  const auto predict = [&](std::vector<double> at, bool jacobian) {
    Prediction out;
    run.predict(at.data(), at.data() + run.unknowns(), INFINITY, jacobian ? 1e-11 : 1e-13, jacobian, out);
    EXPECT_TRUE(out.ok) << out.why;
    return out;
  };
  std::vector<double> at = run.scene_values();
  const std::vector<double> start = run.released();
  at.insert(at.end(), start.begin(), start.end());
  const Prediction exact = predict(at, true);
  for (std::size_t c = 0; c < columns; ++c) {
    const std::vector<double> expected = test::derivative(
        [&](double by) {
          std::vector<double> moved = at;
          moved[c] += by;
          return predict(moved, false).reading;
        },
        5e-4);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(exact.jacobian[columns * i + c], expected[i], accuracy * (1 + std::abs(expected[i])))
          << "column " << c << " reading " << i;
    }
  }
}

const std::string unknown_start = "[[run]]\nduration = 1.2\nrate = 41\n";
const std::string known_start = "[[run]]\nduration = 1.2\nrate = 41\nstart_known = true\nrelease_rate = { arm = 0 }\n";

TEST_F(FunctionsOfTime, HaveExactJacobians) {
  for (const bool stepped : {false, true}) {
    for (const std::string& run : {unknown_start, known_start}) {
      SCOPED_TRACE(run);
      folder_.write("scene.toml", stepped ? steps : sines);
      const std::vector<std::string>& paths = stepped ? numbers_of_steps : numbers_of_sines;
      expect_exact_jacobian(read(sensor + unknowns(paths) + run), paths.size());
    }
  }
}

// Named numbers in formulas, products, integrals, numbers of springs and the frame, and all numbers of what is
// composed.
TEST_F(FunctionsOfTime, HaveExactJacobiansByWhatFormulasAndComposedFunctionsUse) {
  const std::string composed =
      crane("time = { function = \"0.4 + u*sin(w*t)*exp(-P*t)\" }",
            "time = { product = [{ ramp = { from = 0.2, to = 2, start = 0.3, end = 0.9, law = \"s_curve\" } }, "
            "{ function = \"1 + spread*cos(w*t)\" }] }",
            "time = { as = \"velocity\", start = 0.1, sum = [{ sine = { amplitude = 0.2, frequency = 0.8 } }, "
            "{ function = \"u*t*(1 - t/P)\" }] }") +
      "[numbers]\nP = 0.8\nw = 3\nu = 0.5\nspread = 0.3\n"
      "[frame]\nx = { as = \"acceleration\", function = \"0.6*sin(w*t)\" }\n"
      "y = { function = \"0.02*cos(4*w*t)\" }\n"
      "[[torsion_spring]]\nname = \"elbow\"\nbodies = [\"cart\", \"arm\"]\nstiffness = 2\nfree_angle = -1\n"
      "time = { stiffness = { function = \"1 + spread*sin(2*w*t)\" }, free_angle = { sine = { amplitude = 0.3, "
      "frequency = 1.1, offset = 1 } } }\n";
  folder_.write("scene.toml", composed);
  const std::vector<std::string> paths{"numbers.P",
                                       "numbers.w",
                                       "numbers.u",
                                       "numbers.spread",
                                       "load.wind.time.product.1.to",
                                       "load.wind.time.product.1.start",
                                       "drive.belt.time.start",
                                       "drive.belt.time.sum.1.amplitude",
                                       "drive.belt.time.sum.1.frequency",
                                       "torsion_spring.elbow.stiffness",
                                       "torsion_spring.elbow.free_angle",
                                       "torsion_spring.elbow.time.free_angle.amplitude",
                                       "body.arm.mass",
                                       "body.arm.inertia"};
  for (const std::string& run : {unknown_start, known_start}) {
    expect_exact_jacobian(read(sensor + unknowns(paths) + run), paths.size());
  }
}

// Drives whose accelerations jump, at times that are unknown or follow from unknowns.
TEST_F(FunctionsOfTime, HaveExactJacobiansByTimesAtWhichAccelerationsOfDrivesJump) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> all{
      {"time = { ramp = { from = 0.1, to = 0.4, start = 0.2, end = 0.9, law = \"trapezoidal\" } }",
       {"drive.belt.time.from", "drive.belt.time.to", "drive.belt.time.start", "drive.belt.time.end"}},
      {"time = { table = [[0.05, 0.1], [0.4, 0.3], [0.8, 0.2], [1.1, 0.5]], interpolation = \"cubic\" }",
       {"drive.belt.time.table.1.t", "drive.belt.time.table.2.t", "drive.belt.time.table.3",
        "drive.belt.time.table.4.t"}},
      {"time = { as = \"acceleration\", start = 0.2, step = { at = 0.45, from = 0.5, to = -0.4 } }",
       {"drive.belt.time.start", "drive.belt.time.rate", "drive.belt.time.at", "drive.belt.time.from",
        "drive.belt.time.to"}},
      {"time = { as = \"velocity\", start = 0.2, ramp = { from = 0.1, to = -0.4, start = \"b\", end = \"2*b\", law = "
       "\"linear\" } }",
       {"numbers.b", "drive.belt.time.to"}}};
  for (const auto& [drive, paths] : all) {
    SCOPED_TRACE(drive);
    folder_.write("scene.toml", crane("", "", drive) + "[numbers]\nb = 0.4\n");
    for (const std::string& run : {unknown_start, known_start}) {
      expect_exact_jacobian(read(sensor + unknowns(paths) + run), paths.size());
    }
  }
}

// Points of tables, of all interpolations.
TEST_F(FunctionsOfTime, HaveExactJacobiansByTheValuesOfTables) {
  folder_.write("scene.toml",
                crane("time = { table = [[0.1, 0.5], [0.4, -1], [0.9, 0.7]] }",
                      "time = { table = [[0, 0.2], [0.3, 1], [0.7, 1.5], [1, 0.1]], interpolation = \"monotone\" }",
                      "time = { table = [[0, 0.1], [0.4, 0.3], [0.8, 0.2], [1.4, 0.5]] }"));
  std::vector<std::string> paths;
  for (const char* k : {"1", "2", "3"}) paths.push_back("load.motor.time.table." + std::string(k));
  for (const char* k : {"1", "2", "3", "4"}) paths.push_back("load.wind.time.table." + std::string(k));
  for (const char* k : {"1", "2", "3", "4"}) paths.push_back("drive.belt.time.table." + std::string(k));
  for (const std::string& run : {unknown_start, known_start}) {
    expect_exact_jacobian(read(sensor + unknowns(paths) + run), paths.size());
  }
}

// Their times, at which a linear table has a kink, and a monotone one at its ends: accelerations stay continuous, while
// formulas meet earlier or later. (Where a formula begins with the motion differences to both sides are half as
// accurate.)
TEST_F(FunctionsOfTime, HaveExactJacobiansByTheTimesOfTables) {
  folder_.write("scene.toml",
                crane("time = { table = [[0.1, 0.5], [0.4, -1], [0.9, 0.7]] }",
                      "time = { table = [[0.05, 0.2], [0.3, 1], [0.7, 1.5], [1, 0.1]], interpolation = \"monotone\" }",
                      "time = { table = [[0.05, 0.1], [0.4, 0.3], [0.8, 0.2], [1.1, 0.5]] }"));
  std::vector<std::string> paths;
  for (const char* k : {"1", "2", "3"}) paths.push_back("load.motor.time.table." + std::string(k) + ".t");
  for (const char* k : {"1", "2", "3", "4"}) paths.push_back("load.wind.time.table." + std::string(k) + ".t");
  for (const char* k : {"1", "2", "3", "4"}) paths.push_back("drive.belt.time.table." + std::string(k) + ".t");
  for (const std::string& run : {unknown_start, known_start}) {
    expect_exact_jacobian(read(sensor + unknowns(paths) + run), paths.size());
  }
}

TEST_F(FunctionsOfTime, TimesOfTablesAreFound) {
  folder_.write("scene.toml", crane("time = { table = [[0.1, 0.5], [0.4, -1], [0.9, 0.7]] }", "",
                                    "time = { table = [[0, 0.1], [0.4, 0.3], [0.8, 0.2], [1.4, 0.5]] }"));
  const Experiment e = read(sensor + R"(
[[unknown]]
path = "load.motor.time.table.2.t"
start = 0.5
[[unknown]]
path = "drive.belt.time.table.3.t"
start = 0.75
[[run]]
duration = 2
rate = 100
seed = 4
)");
  test::expect_found(e, 0.01);
  const FitProblem problem(e);
  Prediction out;
  const std::vector<double> reversed{0.95, 0.75};
  problem.run(0).predict(reversed.data(), problem.run(0).released().data(), INFINITY, 1e-10, false, out);
  EXPECT_FALSE(out.ok);
  EXPECT_NE(out.why.find("load.motor.time.table.2.t is out of its range"), std::string::npos) << out.why;
}

// Named numbers in functions, in the loads that they multiply and in everything else at once, along all expressions.
const std::string named = "[numbers]\np = 0.7\nwhen = 0.4\nnone = 0\n";

TEST_F(FunctionsOfTime, HaveExactJacobiansByNamedNumbers) {
  const auto with = [](const std::string& motor, const std::string& wind, const std::string& belt) {
    std::string text = test::crane("value = \"0.3 + p^2\"\n" + motor, wind, belt, "-1.3") + named;
    const auto replace = [&](const std::string& from, const std::string& to) {
      text.replace(text.find(from), from.size(), to);
    };
    replace("mass = 1.3", "mass = \"2*p\"");
    replace("T = [0.4, 0]", "T = [\"p/2\", 0]");
    replace("vector = [0.5, 0]", "vector = [\"p\", \"none\"]");
    return text;
  };
  const std::vector<std::string> scenes{
      with("time = { sine = { amplitude = \"p\", frequency = \"1/p\", phase = \"p/2\", offset = \"when\" } }",
           "time = { ramp = { from = \"p\", to = 2, start = \"when/2\", end = \"when + p\" } }",
           "time = { ramp = { from = \"p/7\", to = \"when\", start = \"when/3\", end = \"1.5*p\" } }"),
      with("time = { step = { at = \"when\", from = \"p\", to = -1 } }",
           "time = { ramp = { from = 1, to = \"-p\", start = \"when\", end = 0.75, law = \"polynomial_345\" } }",
           "time = { sine = { amplitude = \"p/5\", frequency = \"p\", offset = \"when^2\" } }"),
      with("time = { table = [[0.1, \"p\"], [0.4, -1], [0.9, \"when\"]] }",
           "time = { table = [[0, 0.2], [0.3, \"p\"], [0.7, \"3*p\"]], interpolation = \"monotone\" }",
           "time = { table = [[0, \"p/7\"], [0.4, 0.3], [0.8, \"when/2\"], [1.4, 0.5]] }"),
      with("time = { table = [[\"when - 0.3\", \"p\"], [\"when\", -1], [\"when + p\", \"when\"]] }",
           "time = { table = [[0, 0.2], [\"p/2\", \"p\"], [\"p\", \"3*p\"]], interpolation = \"monotone\" }",
           "time = { table = [[0, \"p/7\"], [\"when\", 0.3], [0.8, \"when/2\"], [\"2*p\", 0.5]] }")};
  for (const std::string& scene : scenes) {
    folder_.write("scene.toml", scene);
    for (const std::string& run : {unknown_start, known_start}) {
      SCOPED_TRACE(run);
      expect_exact_jacobian(read(sensor + unknowns({"numbers.p", "numbers.when"}) + run), 2);
    }
  }
}

// A whole turn more is the same sine: one minimum, and not several that explain the readings equally well.
TEST_F(FunctionsOfTime, APhaseIsSoughtWithinATurn) {
  folder_.write("scene.toml", sines);
  const Experiment e = read(sensor + R"(
[[unknown]]
path = "load.motor.time.phase"
start = 0.4
[[run]]
duration = 2
rate = 50
start_known = true
)");
  EXPECT_DOUBLE_EQ(e.unknowns.at(0).min, 0.4 - M_PI);
  EXPECT_DOUBLE_EQ(e.unknowns.at(0).max, 0.4 + M_PI);
  const FitProblem problem(e);
  const Fit fitted = fit(problem, problem.records());
  EXPECT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  EXPECT_NEAR(fitted.parameters.at(0), 0.3, 0.05);
}

// A force of zero that a named number moves, of which a function takes its part.
TEST_F(FunctionsOfTime, HaveExactJacobiansByTheForcesOfZero) {
  std::string text =
      crane("", "time = { sine = { amplitude = 0.7, frequency = 0.9, offset = 0.4 } }", "start = 0") + named;
  text.replace(text.find("vector = [0.5, 0]"), 17, "vector = [\"none\", \"2*none\"]");
  folder_.write("scene.toml", text);
  expect_exact_jacobian(read(sensor + unknowns({"numbers.none"}) + known_start), 1);
}

TEST_F(FunctionsOfTime, NamedNumbersAreFound) {
  folder_.write("scene.toml",
                test::crane("value = \"p\"\ntime = { sine = { amplitude = \"p\", frequency = \"p + when\" } }",
                            "time = { step = { at = \"when\", to = -1 } }", "start = 0", "-1.3") +
                    named);
  const Experiment e = read(sensor + R"(
[[unknown]]
path = "numbers.p"
start = 0.8
[[unknown]]
path = "numbers.when"
start = 0.45
[[run]]
duration = 2
rate = 100
seed = 4
)");
  test::expect_found(e, 0.02);
}

// The motor, written out: J a = motor - weight - grease, on a carriage that stands still.
TEST_F(FunctionsOfTime, ActAsWritten) {
  folder_.write("scene.toml",
                crane("time = { sine = { amplitude = 0.7, frequency = 0.9, phase = 0.3 } }", "", "start = 0"));
  const Experiment e = read(sensor + "[[run]]\nduration = 2\nrate = 50\nrelease_rate = { arm = 0.5 }\n");
  const FitProblem problem(e);
  const Record record = problem.ideal_record(0);
  const auto acceleration = [](double t, double angle, double rate) {
    const double motor = 0.8 * 0.7 * std::sin(2 * M_PI * 0.9 * t + 0.3);
    return (motor - 1.3 * 0.3 * 9.81 * std::cos(angle) - 0.4 * std::sin(angle) * 0.5 - 0.08 * rate) /
           (0.05 + 1.3 * 0.09);
  };
  double angle = -1.3, rate = 0.5;
  constexpr int steps_per_reading = 200;
  constexpr double h = 1.0 / 50 / steps_per_reading;
  for (std::size_t i = 0; i < record.sensors[0].time.size(); ++i) {
    EXPECT_NEAR(record.sensors[0].value[i], angle, 1e-8) << i;
    for (int step = 0; step < steps_per_reading; ++step) {
      const double t = (static_cast<double>(i) * steps_per_reading + step) * h;
      const double k1 = rate, l1 = acceleration(t, angle, rate);
      const double k2 = rate + h / 2 * l1, l2 = acceleration(t + h / 2, angle + h / 2 * k1, k2);
      const double k3 = rate + h / 2 * l2, l3 = acceleration(t + h / 2, angle + h / 2 * k2, k3);
      const double k4 = rate + h * l3, l4 = acceleration(t + h, angle + h * k3, k4);
      angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      rate += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
    }
  }
}

TEST_F(FunctionsOfTime, AreFoundFromOneSensor) {
  folder_.write("scene.toml", steps);
  const Experiment e = read(sensor + R"(
[[unknown]]
path = "load.motor.time.at"
start = 0.5
[[unknown]]
path = "load.motor.time.to"
start = -0.6
[[unknown]]
path = "drive.belt.time.frequency"
start = 0.82
[[unknown]]
path = "load.wind.time.end"
start = 0.6
[[run]]
duration = 2
rate = 100
seed = 4
)");
  test::expect_found(e, 0.02);
}

// Both ends of a ramp lie behind the end that is written: they can only be set together.
TEST_F(FunctionsOfTime, MoveBothEndsOfARamp) {
  const Experiment e =
      read(sensor + unknowns({"load.wind.time.start", "load.wind.time.end"}) + "[[run]]\nduration = 2\nrate = 50\n");
  const FitProblem problem(e);
  Prediction out;
  for (const auto& ends : {std::vector{1.2, 1.7}, std::vector{0.05, 0.25}}) {
    problem.run(0).predict(ends.data(), problem.run(0).released().data(), INFINITY, 1e-10, false, out);
    EXPECT_TRUE(out.ok) << out.why;
  }
  const std::vector<double> reversed{0.8, 0.5};
  problem.run(0).predict(reversed.data(), problem.run(0).released().data(), INFINITY, 1e-10, false, out);
  EXPECT_FALSE(out.ok);
  EXPECT_NE(out.why.find("load.wind.time.end is out of its range"), std::string::npos) << out.why;
}

// Only the product of a load and the values of its function acts. A step beyond the last reading acts on none.
TEST_F(FunctionsOfTime, AreFreeWhereTheDataLeaveThemSo) {
  folder_.write("scene.toml", steps);
  const auto free_in = [&](const std::vector<std::string>& paths, const std::string& changes) {
    const Experiment e = read(sensor + unknowns(paths) + "[[run]]\nduration = 2\nrate = 50\nset = {" + changes + "}\n");
    const FitProblem problem(e);
    return fit(problem, problem.records());
  };
  const Fit product = free_in({"load.motor", "load.motor.time.from", "load.motor.time.to"}, "");
  for (const Estimate& estimate : product.estimates) EXPECT_TRUE(estimate.withheld) << estimate.name;
  const Fit beyond =
      free_in({"load.motor.time.from", "load.motor.time.at", "load.motor.time.to"}, "\"load.wind.time.end\" = 0.8");
  for (const Estimate& estimate : beyond.estimates) EXPECT_FALSE(estimate.withheld) << estimate.name;
  folder_.write("scene.toml", crane("time = { step = { at = 2.5, from = 0.5, to = -1 } }", "", "start = 0"));
  const Fit late = free_in({"load.motor.time.from", "load.motor.time.at"}, "");
  EXPECT_FALSE(late.estimates[0].withheld);
  EXPECT_TRUE(late.estimates[1].withheld);
}

// An input of a run takes the place of a function, of which neither the number nor the start of a drive counts then.
TEST_F(FunctionsOfTime, GiveWayToInputs) {
  std::string csv = "time,tau,belt\n";
  for (int i = 0; i <= 120; ++i) {
    csv += fmt::format("{:.6g},{:.12g},{:.12g}\n", i / 50.0, 0.3 * std::sin(0.1 * i), 0.2 + 0.05 * std::cos(0.04 * i));
  }
  folder_.write("inputs.csv", csv);
  const std::string run = R"([[run]]
duration = 2
rate = 50
inputs = { "load.motor" = { column = "tau", file = "inputs.csv" }, "drive.belt" = "belt" }
)";
  const Record with_functions = FitProblem(read(sensor + run)).ideal_record(0);
  folder_.write("scene.toml",
                crane("", "time = { ramp = { from = 0.2, to = 2, start = 0.3, end = 0.9 } }", "start = 0"));
  const Record without = FitProblem(read(sensor + run)).ideal_record(0);
  for (std::size_t i = 0; i < without.sensors[0].value.size(); ++i) {
    EXPECT_NEAR(with_functions.sensors[0].value[i], without.sensors[0].value[i], 1e-11) << i;
  }
  folder_.write("scene.toml", sines);
  EXPECT_EQ(
      error(sensor + unknowns({"load.motor.time.phase"}) + run),
      "experiment.toml:7: unknown \"load.motor.time.phase\".path: expected a number that no input takes the place "
      "of, run \"run 1\" has \"load.motor\" as an input in line 12; take one of the two out, or let the input "
      "multiply it with multiplies = true");
  const std::string multiplied = R"([[run]]
duration = 2
rate = 50
inputs = { "load.motor" = { column = "tau", file = "inputs.csv", multiplies = true } }
)";
  std::string followed = sines + named;
  followed.replace(followed.find("to = 0.4"), 8, "to = \"p\"");
  folder_.write("scene.toml", followed);
  EXPECT_NE(test::message_of([&] {
              FitProblem problem(read(sensor + run));
            }).find("expected numbers in drive \"belt\", whose place the input takes"),
            std::string::npos);
  folder_.write("scene.toml", sines);
  EXPECT_NE(error(sensor + multiplied).find("expected multiplies of a load without a function of time"),
            std::string::npos)
      << error(sensor + multiplied);
}

}  // namespace
}  // namespace poise::functions_of_time_test
