// Readings at rest: against closed forms of equilibria, linear regression, differences and Cramer-Rao bounds.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "identification/assessment/bootstrap.hpp"
#include "identification/assessment/monte_carlo.hpp"
#include "identification/assessment/plan.hpp"
#include "identification/assessment/validation.hpp"
#include "identification/experiment/experiment.hpp"
#include "identification/fit/fit.hpp"
#include "model/input_error.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/seed.hpp"

namespace poise::static_runs_test {
namespace {

constexpr double g = 9.81;

/// A block on a vertical guide hangs on a spring; a weight W pulls it down.
const std::string rig = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.block]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "guide"
points = ["ground.O", "block.C"]
axis = [0, -1]
[[spring]]
name = "coil"
points = ["ground.O", "block.C"]
stiffness = 300
free_length = 0.2
[[damper]]
name = "oil"
points = ["ground.O", "block.C"]
coefficient = 5
[[force]]
name = "W"
at = "block.C"
vector = [0, -10]
[[drive]]
name = "lift"
slide = "guide"
[start]
guide = 0.3
)";

const std::string free_rig = rig.substr(0, rig.find("[[drive]]")) + rig.substr(rig.find("[start]"));

/// An arm on a pin with a torsion spring; a weight W hangs at its tip.
const std::string lamp = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], T = [0.5, 0] }
mass = 0.8
inertia = 0.02
center = [0.2, 0]
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
[[torsion_spring]]
name = "wrap"
bodies = ["ground", "arm"]
stiffness = 6
free_angle = 0.7
[[force]]
name = "W"
at = "arm.T"
vector = [0, -1]
[start]
arm = 0.4
)";

Experiment read(const std::string& scene, const std::string& text) {
  ExperimentOptions options;
  options.scene = std::make_shared<const Scene>(parse_scene(scene, "/static/scene.toml"));
  return parse_experiment("scene = \"scene.toml\"\n" + text, "/static/experiment.toml", options);
}

/// On a scene of datasets/.
Experiment on(const std::string& scene, const std::string& text) {
  return parse_experiment("scene = \"" + scene + ".toml\"\n" + text, test::dataset("experiment.toml"));
}

std::string error_of(const std::string& text) {
  try {
    read(rig, text);
  } catch (const InputError& error) {
    return std::string(error.what()).substr(std::string("/static/").size());
  }
  return "";
}

const std::string x_sensor = "[[sensor]]\nname = \"x\"\ntravel = \"guide\"\nnoise = 1e-4\n";
const std::string k_and_length =
    "[[unknown]]\npath = \"spring.coil.stiffness\"\nname = \"k\"\nstart = 250\n"
    "[[unknown]]\npath = \"spring.coil.free_length\"\nname = \"L\"\n";
const std::string weights = "inputs = { \"load.W\" = [0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22] }\n";
const std::vector<double> read_at_weights = {0.26538, 0.27213, 0.27878, 0.28541, 0.29198, 0.29881,
                                             0.30537, 0.31197, 0.31885, 0.32531, 0.33211, 0.33872};

std::string list(const std::vector<double>& values) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "[" : ", ") + std::to_string(value);
  return out + "]";
}

const Estimate& estimate(const Fit& fitted, const std::string& name) {
  return *std::find_if(fitted.estimates.begin(), fitted.estimates.end(),
                       [&](const Estimate& e) { return e.name == name; });
}

Fit fit_own(const Experiment& experiment) {
  const FitProblem problem(experiment);
  return fit(problem, problem.records());
}

// x = L + (m g + W) / k is linear in L and 1/k.
TEST(StaticRuns, AStiffnessFromTwelveWeightsIsThatOfLinearRegression) {
  const Fit fitted = fit_own(read(
      rig, x_sensor + k_and_length + "[[static]]\n" + weights + "readings = { x = " + list(read_at_weights) + " }\n"));
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  Eigen::MatrixXd a(12, 2);
  Eigen::VectorXd b(12);
  for (int i = 0; i < 12; ++i) {
    a.row(i) << 1.0, 2 * g + 2.0 * i;
    b[i] = read_at_weights[static_cast<std::size_t>(i)];
  }
  const Eigen::Vector2d line = a.colPivHouseholderQr().solve(b);
  const Eigen::Matrix2d covariance = 1e-8 * (a.transpose() * a).inverse();
  const double k = 1 / line[1];
  EXPECT_NEAR(estimate(fitted, "k").value, k, 1e-9 * k);
  EXPECT_NEAR(estimate(fitted, "L").value, line[0], 1e-9 * line[0]);
  EXPECT_NEAR(fitted.errors.white[0], k * k * std::sqrt(covariance(1, 1)), 1e-9 * k * k * std::sqrt(covariance(1, 1)));
  EXPECT_NEAR(fitted.errors.white[1], std::sqrt(covariance(0, 0)), 1e-9 * std::sqrt(covariance(0, 0)));
  EXPECT_EQ(fitted.start, "as given");
}

// F = k (x - L) - m g where a drive holds x.
TEST(StaticRuns, ForcesAtPositionsThatADriveHolds) {
  const Experiment e = read(rig, R"(
[[sensor]]
name = "F"
read = "force.lift"
noise = 0.05
[[unknown]]
path = "spring.coil.stiffness"
[[unknown]]
path = "body.block.mass"
[[static]]
inputs = { "drive.lift" = [0.15, 0.2, 0.25, 0.3, 0.9], "load.W" = [0, 0, 1, 2, 3] }
)");
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  Prediction found;
  run.predict(run.scene_values().data(), nullptr, INFINITY, 1e-9, true, found);
  ASSERT_TRUE(found.ok) << found.why;
  const std::array<double, 5> x = {0.15, 0.2, 0.25, 0.3, 0.9}, w = {0, 0, 1, 2, 3};
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_NEAR(found.reading[i], 300 * (x[i] - 0.2) - 2 * g - w[i], 1e-10) << i;
    EXPECT_NEAR(found.jacobian[2 * i], x[i] - 0.2, 1e-12) << i;
    EXPECT_NEAR(found.jacobian[2 * i + 1], -g, 1e-11) << i;
  }
}

// k (phi - phi0) + (m g c + W l) cos phi = 0.
TEST(StaticRuns, ALampTellsItsTorsionSpringAndGravityMoment) {
  const Experiment e = read(lamp, R"(
[[sensor]]
name = "phi"
angle = "arm"
noise = 1e-3
[[unknown]]
path = "torsion_spring.wrap.stiffness"
name = "k"
[[unknown]]
path = "body.arm.center.x"
name = "c"
[[static]]
inputs = { "load.W" = [0, 1, 2, 3, 4, 5] }
seed = 4
)");
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  Prediction found;
  run.predict(run.scene_values().data(), nullptr, INFINITY, 1e-9, true, found);
  ASSERT_TRUE(found.ok) << found.why;
  ASSERT_EQ(found.reading.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const double phi = found.reading[i], moment = 0.8 * g * 0.2 + 0.5 * static_cast<double>(i);
    EXPECT_NEAR(6 * (phi - 0.7) + moment * std::cos(phi), 0, 1e-12) << i;
    const double slope = 6 - moment * std::sin(phi);
    EXPECT_NEAR(found.jacobian[2 * i], (0.7 - phi) / slope, 1e-12) << i;
    EXPECT_NEAR(found.jacobian[2 * i + 1], -0.8 * g * std::cos(phi) / slope, 1e-11) << i;
  }
  const Fit fitted = fit(problem, problem.records());
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  EXPECT_LT(std::abs(estimate(fitted, "k").value - 6), 4 * estimate(fitted, "k").standard_error);
  EXPECT_LT(std::abs(estimate(fitted, "c").value - 0.2), 4 * estimate(fitted, "c").standard_error);
}

/// A sledge on a level rail that rubs, pulled through its centre of mass; W presses it down.
const std::string sledge = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.sledge]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "rail"
points = ["ground.O", "sledge.C"]
axis = [1, 0]
friction = { coefficient = 0.3 }
[[force]]
name = "P"
at = "sledge.C"
vector = [1, 0]
[[force]]
name = "W"
at = "sledge.C"
vector = [0, -10]
[start]
rail = 0
)";

// It slips at  P = mu (m g + W): regression of P on W has the slope mu and the intercept mu m g.
TEST(StaticRuns, FrictionFromLoadsAtWhichItSlips) {
  const std::vector<double> slipped = {5.91, 7.42, 8.86, 10.4, 11.9, 13.35};
  const Fit fitted = fit_own(read(sledge, R"(
[[sensor]]
name = "pull"
slips = "load.P"
noise = 0.05
[[unknown]]
path = "slide.rail.friction.coefficient"
name = "mu"
start = 0.2
[[unknown]]
path = "body.sledge.mass"
name = "m"
[[static]]
inputs = { "load.W" = [0, 5, 10, 15, 20, 25] }
readings = { pull = )" + list(slipped) + " }\n"));
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  Eigen::MatrixXd a(6, 2);
  for (int i = 0; i < 6; ++i) a.row(i) << 1.0, 5.0 * i;
  const Eigen::Vector2d line = a.colPivHouseholderQr().solve(Eigen::Map<const Eigen::VectorXd>(slipped.data(), 6));
  const Eigen::Matrix2d covariance = 0.05 * 0.05 * (a.transpose() * a).inverse();
  EXPECT_NEAR(estimate(fitted, "mu").value, line[1], 1e-7);
  EXPECT_NEAR(estimate(fitted, "m").value, line[0] / (line[1] * g), 1e-5);
  EXPECT_NEAR(fitted.errors.white[0], std::sqrt(covariance(1, 1)), 1e-6);
}

// An arm at the angle phi with a constant torque of friction:  T = m g c cos phi +- T_f.
TEST(StaticRuns, ATorqueThatGrowsOrFallsUntilAPositionSlips) {
  const std::string arm = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0] }
mass = 1.5
center = [0.2, 0]
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
friction = { torque = 0.4 }
[[torque]]
name = "T"
on = "arm"
value = 2
[[drive]]
name = "place"
bodies = ["ground", "arm"]
[start]
arm = 0
)";
  const auto sensors = [](const std::string& up, const std::string& down) {
    return "[[sensor]]\nname = \"up\"\nslips = " + up + "\nnoise = 0.01\n[[sensor]]\nname = \"down\"\nslips = " + down +
           "\nnoise = 0.01\n";
  };
  const std::string rest = R"(
[[unknown]]
path = "pin.O.friction.torque"
[[unknown]]
path = "body.arm.mass"
[[unknown]]
path = "body.arm.center.x"
[[static]]
inputs = { "drive.place" = [-1.2, -0.5, 0, 0.4, 1.1, 2.0] }
)";
  const Experiment e = read(arm, sensors("\"load.T\"", "{ falling = \"load.T\" }") + rest);
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  Prediction found;
  run.predict(run.scene_values().data(), nullptr, INFINITY, 1e-9, true, found);
  ASSERT_TRUE(found.ok) << found.why;
  const std::array<double, 6> places = {-1.2, -0.5, 0, 0.4, 1.1, 2.0};
  for (std::size_t i = 0; i < 12; ++i) {
    const double part = g * std::cos(places[i % 6]), sign = i < 6 ? 1 : -1;
    EXPECT_NEAR(found.reading[i], 1.5 * 0.2 * part + sign * 0.4, 1e-10) << i;
    EXPECT_NEAR(found.jacobian[3 * i], sign, 1e-8) << i;
    EXPECT_NEAR(found.jacobian[3 * i + 1], 0.2 * part, 1e-8) << i;
    EXPECT_NEAR(found.jacobian[3 * i + 2], 1.5 * part, 1e-8) << i;
  }
  // m and c come as m c alone, and a torque that is negative in the scene grows in size.
  const Identifiability known = assess(problem, problem.truths(), test::released(problem));
  EXPECT_EQ(known.rank, 2);
  std::string pressed = arm;
  pressed.replace(pressed.find("value = 2"), 9, "value = -2");
  const Experiment other = read(pressed, sensors("{ growing = \"load.T\" }", "{ falling = \"load.T\" }") + rest);
  const FitProblem turned(other);
  Prediction again;
  turned.run(0).predict(turned.run(0).scene_values().data(), nullptr, INFINITY, 1e-9, false, again);
  ASSERT_TRUE(again.ok) << again.why;
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(again.reading[i], found.reading[i + 6], 1e-10);
    EXPECT_NEAR(again.reading[i + 6], found.reading[i], 1e-10);
  }
}

TEST(StaticRuns, WhatSlipsIsNamed) {
  const auto says = [](const std::string& scene, const std::string& slips,
                       const std::string& more = "") -> std::string {
    try {
      const Experiment e = read(scene, "[[sensor]]\nname = \"s\"\nslips = " + slips + "\nnoise = 0.1\n" + more +
                                           "[[static]]\ninputs = { \"load.W\" = [1, 2] }\n");
      const FitProblem problem(e);
      Prediction found;
      problem.run(0).predict(problem.run(0).scene_values().data(), nullptr, INFINITY, 1e-9, false, found);
      return found.why;
    } catch (const InputError& error) {
      const std::string words = error.what();
      return words.substr(words.rfind(": ", words.find("expected")) + 2);
    }
  };
  EXPECT_EQ(says(sledge, "\"load.Q\""),
            "expected the load of a force or torque at which it slips; did you mean \"load.P\"?");
  EXPECT_EQ(says(rig, "\"load.W\""), "expected a scene in which something rubs; add friction to a joint");
  EXPECT_EQ(says(sledge, "{ falling = \"load.P\", growing = \"load.P\" }"),
            "expected one of the keys growing, falling");
  EXPECT_EQ(says(sledge, "{ falling = \"load.P\" }"), "row 1: load.P: it slips at none as it falls");
}

// The snap load of a von Mises toggle is proportional to the stiffness of its two springs.
TEST(StaticRuns, AStiffnessFromSnapLoads) {
  const Experiment e = on("von_mises_toggle", R"(
[[sensor]]
name = "snap"
read = "fold.load.P"
noise = 0.2
[[unknown]]
path = "spring.left.stiffness"
name = "k"
start = 950
[[unknown]]
path = "spring.right.stiffness"
name = "other"
prior = [1000, 1]
[[static]]
readings = { snap = [42.71, 43.02, 43.11, 42.83, 42.94, 43.3] }
)");
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  Prediction found;
  run.predict(run.scene_values().data(), nullptr, INFINITY, 1e-9, true, found);
  ASSERT_TRUE(found.ok) << found.why;
  constexpr double limit = 42.9143257312246876869530451065;
  ASSERT_EQ(found.reading.size(), 6U);
  EXPECT_NEAR(found.reading[5], limit, 1e-9 * limit);
  EXPECT_NEAR(found.jacobian[0] + found.jacobian[1], limit / 1000, 1e-9 * limit / 1000);
  const Fit fitted = fit(problem, problem.records());
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  // Each of the springs on both sides has half of the load.
  const double mean = (42.71 + 43.02 + 43.11 + 42.83 + 42.94 + 43.3) / 6;
  EXPECT_NEAR(estimate(fitted, "k").value, 1000 + 2000 * (mean / limit - 1), 0.1);
  EXPECT_NEAR(fitted.identifiability.standard_error[0], std::hypot(2000 * 0.2 / std::sqrt(6.0) / limit, 1.0), 1e-4);
}

// Weights alone tell the spring, a swing alone k / m: both together the mass and the damping too.
TEST(StaticRuns, MixedWithAMotion) {
  const std::string unknowns = k_and_length +
                               "[[unknown]]\npath = \"body.block.mass\"\nname = \"m\"\nstart = 1.7\n"
                               "[[unknown]]\npath = \"damper.oil.coefficient\"\nname = \"c\"\n";
  const std::string at_rest = "[[static]]\nseed = 3\n" + weights;
  const std::string swing = "[[run]]\nname = \"swing\"\nrelease = { guide = 0.3 }\nduration = 3\nrate = 50\n";
  const Experiment own_swing = read(free_rig, x_sensor + unknowns + swing);
  const FitProblem moving(own_swing);
  const Experiment mixed = read(free_rig, x_sensor + unknowns + swing + at_rest);
  const FitProblem both(mixed);
  EXPECT_TRUE(both.any_at_rest());
  EXPECT_FALSE(both.all_at_rest());
  const Fit fitted = fit(both, both.records());
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  const std::array<double, 4> truths = {300, 0.2, 2, 5};
  for (std::size_t i = 0; i < 4; ++i) {
    const Estimate& one = fitted.estimates[i];
    EXPECT_FALSE(one.withheld) << one.name;
    EXPECT_LT(std::abs(one.value - truths[i]), 4 * one.standard_error) << one.name;
    EXPECT_LT(one.standard_error, 0.1 * truths[i]) << one.name;
  }
  EXPECT_TRUE(estimate(fit(moving, moving.records()), "k").withheld);
}

TEST(StaticRuns, NullsAreNamed) {
  const Experiment e = read(rig, x_sensor + k_and_length +
                                     "[[unknown]]\npath = \"damper.oil.coefficient\"\nname = \"c\"\n"
                                     "[[unknown]]\npath = \"body.block.mass\"\nname = \"m\"\n[[static]]\n" +
                                     weights);
  const Fit fitted = fit_own(e);
  ASSERT_TRUE(fitted.usable()) << fitted.why;
  EXPECT_FALSE(estimate(fitted, "k").withheld);
  for (const char* const name : {"L", "c", "m"}) EXPECT_TRUE(estimate(fitted, name).withheld) << name;
  const Identifiability& known = fitted.identifiability;
  EXPECT_EQ(known.structural_nulls, 2);
  EXPECT_EQ(known.other_nulls, 0);
  const auto& nulls = known.null_directions;
  const auto damping = std::find_if(nulls.begin(), nulls.end(), [](const auto& null) {
    return null.words == "c +100 % changes no reading at rest, whatever the inputs";
  });
  ASSERT_NE(damping, nulls.end()) << nulls.front().words;
  EXPECT_NE(damping->remedy.find("a run in motion"), std::string::npos);
}

// With one weight a stiffness and a length cannot be told from each other, which other weights would.
TEST(StaticRuns, NullsOfTheInputsAreNotStructural) {
  const Experiment e = read(rig, x_sensor + k_and_length + "[[static]]\ninputs = { \"load.W\" = [5, 5, 5, 5] }\n");
  const FitProblem problem(e);
  const Identifiability known = assess(problem, problem.truths(), {{}});
  ASSERT_TRUE(known.ok) << known.why;
  EXPECT_EQ(known.structural_nulls, 0);
  EXPECT_EQ(known.other_nulls, 1);
}

TEST(StaticRuns, SensorNumbersAndGeometryHaveExactDerivatives) {
  const std::string quantities = R"(
[[sensor]]
name = "handle"
angle = "handle"
noise = 0.01
[[sensor]]
name = "rubber"
read = "force.rubber"
noise = 1
[[sensor]]
name = "pin"
read = "reaction.B.x"
noise = 1
[[sensor]]
name = "heel"
read = "stop.over_centre"
noise = 1
)";
  std::string unknowns;
  for (const char* const path :
       {"spring.rubber.stiffness", "spring.rubber.free_length", "point.link.B.x", "point.ground.A.y", "gravity.y",
        "body.arm.mass", "stop.over_centre.min", "sensor.rubber.factor", "sensor.pin.zero"}) {
    unknowns += std::string("[[unknown]]\npath = \"") + path + "\"\n";
  }
  const Experiment e =
      on("toggle_clamp", quantities + unknowns + "[[static]]\ninputs = { \"load.P\" = [5, 20, 30] }\n");
  test::expect_derivatives(e, {});
}

TEST(StaticRuns, BootstrapValidationAndPlan) {
  const Experiment e = read(
      rig, x_sensor + k_and_length + "[[static]]\n" + weights + "readings = { x = " + list(read_at_weights) + " }\n");
  const FitProblem problem(e);
  const std::vector<Record> records = problem.records();
  const Fit fitted = fit(problem, records);
  ASSERT_EQ(fitted.status, FitStatus::converged);
  const Bootstrap found = bootstrap(problem, records, fitted, {.samples = 100});
  ASSERT_EQ(found.standard_error.size(), 2U);
  const double of_residuals = fitted.errors.white[0] * fitted.residual_over_noise;
  EXPECT_NEAR(found.standard_error[0], of_residuals, 0.3 * of_residuals);

  FittedModel model;
  model.covariance = fitted.errors.covariance;
  for (std::size_t i = 0; i < 2; ++i) {
    model.parameters.push_back({e.unknowns[i].name, e.unknowns[i].path, fitted.parameters[i], ""});
  }
  const Experiment later = read(rig, x_sensor + k_and_length + "[[static]]\nseed = 8\n" + weights);
  const FitProblem other(later);
  const Validation validation = validate(other, other.records(), model, Starts::fitted);
  EXPECT_EQ(validation.fit.parameters, fitted.parameters);
  EXPECT_GT(validation.from_parameters[0], 0.0);
  EXPECT_LT(validation.from_parameters[0], 1e-4);
}

// Of a straight line the D-optimal design has half of the readings at each end.
TEST(StaticRuns, APlanLoadsTheRigAtBothEnds) {
  const app_tests::TempFolder folder;
  folder.write("scene.toml", rig);
  const Experiment e =
      read_experiment(folder.write("experiment.toml", "scene = \"scene.toml\"\n" + x_sensor + k_and_length + R"(
[[static]]
inputs = { "load.W" = [0, 20] }
[plan]
runs = 6
criterion = "D"
[[plan.vary]]
what = "inputs.load.W"
values = [0, 4, 8, 12, 16, 20]
)"));
  const FitProblem problem(e);
  const ExperimentText text(e, {});
  const Plan plan = plan_runs(problem, text);
  ASSERT_EQ(plan.runs.size(), 6U) << plan.why;
  std::vector<double> loads;
  for (const PlannedRun& run : plan.runs) loads.push_back(run.values.front());
  std::sort(loads.begin(), loads.end());
  EXPECT_EQ(loads, (std::vector<double>{0, 0, 0, 20, 20, 20}));
  const Experiment planned = parse_experiment(text.with(plan.runs, true, folder.path("")), folder.path("planned.toml"));
  ASSERT_EQ(planned.runs.size(), 6U);
  EXPECT_EQ(planned.runs.front().rows, 1U);
  const FitProblem again(planned);
  const Identifiability known = assess(again, again.truths(), std::vector<std::vector<double>>(6));
  EXPECT_NEAR(known.standard_error[0], plan.steps.back().standard_error[0], 1e-9 * known.standard_error[0]);
}

TEST(StaticRuns, BadInputIsNamed) {
  const std::string head = x_sensor + k_and_length + "[[static]]\n";
  EXPECT_EQ(error_of(head + "inputs = { \"load.V\" = [1, 2] }\n").substr(0, 52),
            "experiment.toml:14: static 1.inputs.load.V: load.V: ");
  EXPECT_NE(error_of(head + "inputs = { \"damper.oil.coefficient\" = [1, 2] }\n").find("that equilibria depend on"),
            std::string::npos);
  EXPECT_NE(error_of(head + "inputs = { \"load.W\" = \"weight\" }\n").find("write [NUMBER, ...]"), std::string::npos);
  EXPECT_NE(error_of(head + weights + "readings = { x = [1, 2] }\n").find("expected 2 numbers, one for each row"),
            std::string::npos);
  EXPECT_NE(error_of(head + "readings = { y = [1, 2] }\n").find("expected the column of a sensor"), std::string::npos);
  EXPECT_NE(error_of(head + "data = \"none.csv\"\n").find("there is no"), std::string::npos);
  EXPECT_NE(error_of(head + "duration = 3\n").find("expected one of the keys"), std::string::npos);
  EXPECT_NE(error_of(head + "inputs = { \"spring.coil.stiffness\" = [1, 2] }\n").find("no input takes the place of"),
            std::string::npos);
  EXPECT_NE(error_of(head + "inputs = { \"body.block.mass\" = [1, -2] }\n").find("row 2"), std::string::npos);
  EXPECT_NE(error_of("[[sensor]]\nname = \"v\"\ntravel = \"guide\"\nrate = true\nnoise = 1\n" + head +
                     "sensors = [\"v\"]\n" + weights)
                .find("reads what only motions have"),
            std::string::npos);
  EXPECT_NE(error_of("[[sensor]]\nname = \"R\"\nread = \"fold.load.W\"\nnoise = 1\n" + head + weights +
                     "[[run]]\nsensors = [\"R\"]\nduration = 1\nrate = 10\n")
                .find("which a run at rest alone has"),
            std::string::npos);
}

/// An experiment at rest whose estimates reach their Cramer-Rao bounds.
struct Bounded {
  const char* name;
  Experiment (*read)();
};

const std::array bounded = {Bounded{"lift",
                                    [] {
                                      return on("lift", R"(
[[sensor]]
name = "angle"
angle = "obd"
noise = 1e-4
[[unknown]]
path = "spring.oil.stiffness"
name = "k"
[[unknown]]
path = "spring.oil.free_length"
name = "L"
[[static]]
inputs = { "body.payload.mass" = [0, 40, 80, 120, 160, 200] }
repeat = 3
)");
                                    }},
                            Bounded{"clamp", [] { return test::experiment("toggle_clamp_static_experiment"); }},
                            Bounded{"lamp", [] {
                                      return read(lamp, R"(
[[sensor]]
name = "phi"
angle = "arm"
noise = 1e-3
[[unknown]]
path = "torsion_spring.wrap.stiffness"
name = "k"
[[unknown]]
path = "body.arm.center.x"
name = "c"
[[static]]
inputs = { "load.W" = [0, 1, 2, 3, 4, 5] }
repeat = 2
)");
                                    }}};

class StaticBounds : public testing::TestWithParam<Bounded> {};

TEST_P(StaticBounds, AreReached) {
  const Experiment e = GetParam().read();
  const FitProblem problem(e);
  MonteCarloOptions options;
  options.trials = test::cases(20, 5000);
  options.seed = test::seed(5);
  options.start_error = 0.05;
  const MonteCarlo found = monte_carlo(problem, options);
  EXPECT_GE(found.converged, 0.99 * options.trials);
  const double within = std::max(0.04, 4 / std::sqrt(2.0 * found.converged));
  for (const TrialStatistics& s : found.parameters) {
    if (test::campaign_round() > 0) {
      std::printf("%s, %s: spread over bound %.4f, coverage %.4f, %d of %d\n", GetParam().name, s.name.c_str(),
                  s.rmse / s.bound, s.coverage, found.converged, found.trials);
    }
    EXPECT_NEAR(s.rmse / s.bound, 1.0, within) << s.name;
    EXPECT_LT(std::abs(s.bias), 4 * s.bound / std::sqrt(found.converged)) << s.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, StaticBounds, testing::ValuesIn(bounded),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace poise::static_runs_test
