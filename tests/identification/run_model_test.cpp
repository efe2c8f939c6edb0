// Predictions of runs and their Jacobians, their equilibrium poses, and their small oscillations.

#include "identification/prediction/run_model.hpp"

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/run_poise.hpp"
#include "tests/app/wheel_experiment.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/moving_scenes.hpp"

namespace poise::run_model_test {
namespace {

constexpr double fine = 1e-13;  // accuracy of the motions that differences are taken of

Prediction predict(const RunModel& run, const std::vector<double>& unknowns, const std::vector<double>& nuisances,
                   double accuracy, bool jacobian) {
  Prediction out;
  run.predict(unknowns.data(), nuisances.data(), INFINITY, accuracy, jacobian, out);
  EXPECT_TRUE(out.ok) << out.why;
  return out;
}

// Every column of predict()'s Jacobian against differences of predict(). `steps` are for unknowns, relative to their
// size, and for nuisances.
void expect_jacobian(const RunModel& run, double unknown_step, double nuisance_step, double tolerance) {
  const std::vector<double> unknowns = run.scene_values();
  const std::vector<double> nuisances = run.released();
  ASSERT_EQ(static_cast<int>(nuisances.size()), run.nuisances());
  const Prediction analytic = predict(run, unknowns, nuisances, 1e-11, true);
  const auto width = static_cast<std::size_t>(run.columns());
  const auto sensors = static_cast<std::size_t>(run.sensors());
  ASSERT_EQ(analytic.jacobian.size(), analytic.reading.size() * width);
  for (std::size_t c = 0; c < width; ++c) {
    const bool is_unknown = c < unknowns.size();
    SCOPED_TRACE(is_unknown ? run.numbers()[c].path() : run.nuisance_names()[c - unknowns.size()]);
    const double size = is_unknown && unknowns[c] != 0 ? std::abs(unknowns[c]) : 0.1;
    const auto at = [&](double by) {
      std::vector<double> p = unknowns, n = nuisances;
      (is_unknown ? p[c] : n[c - p.size()]) += by;
      return predict(run, p, n, fine, false).reading;
    };
    const std::vector<double> expected = test::derivative(at, is_unknown ? unknown_step * size : nuisance_step);
    for (std::size_t k = 0; k < sensors; ++k) {
      double largest = 0.0, apart = 0.0;
      for (std::size_t s = 0; s < run.times()[k].size(); ++s) {
        const std::size_t i = k * run.times()[0].size() + s;
        largest = std::max(largest, std::abs(expected[i]));
        apart = std::max(apart, std::abs(expected[i] - analytic.jacobian[i * width + c]));
      }
      EXPECT_LT(apart, tolerance * largest + 1e-9) << "sensor " << k;
    }
  }
}

Sensor of(Measure on, bool rate) {
  Sensor sensor;
  sensor.on = std::move(on);
  sensor.by_time = rate ? 1 : 0;
  sensor.noise = 1e-3;
  return sensor;
}

Sensor force_of_spring(const Scene& scene) {
  Sensor sensor = of(test::element(scene, "spring").on, false);
  sensor.element = static_cast<int>(test::index_of(scene, "spring"));
  return sensor;
}

// A four-bar with one of everything, read by one of every sensor it can have.
Experiment everything() {
  Experiment e;
  e.scene = test::four_bar_with_everything();
  const Scene& s = e.scene;
  for (const bool rate : {false, true}) {
    e.sensors.push_back(of(Measure::angle_between(1, 3), rate));
    e.sensors.push_back(of(Measure::distance_between(test::point(s, "ground.S"), test::point(s, "coupler.P")), rate));
    e.sensors.push_back(of(Measure::y_of(test::point(s, "coupler.P")), rate));
  }
  e.sensors.push_back(force_of_spring(s));
  for (const char* path : {"body.coupler.mass", "body.rocker.inertia", "body.crank.center.x", "body.coupler.center.y",
                           "load.F", "load.T"}) {
    e.unknowns.push_back(test::unknown(path));
  }
  const auto path = [&](const std::string& table) { return table + "." + test::element(s, table).name; };
  const std::string spring = path("spring"), coil = path("torsion_spring");
  for (const std::string& number :
       {spring + ".stiffness", spring + ".free_length", coil + ".stiffness", coil + ".free_angle",
        path("damper") + ".coefficient", path("torsion_damper") + ".coefficient", path("friction") + ".torque",
        path("friction") + ".width"}) {
    e.unknowns.push_back(test::unknown(number));
  }
  Release turn;
  turn.body = 1;
  turn.rate = true;
  turn.value = 3.0;
  e.runs.push_back(test::simulated(40, 41, {turn}));
  return e;
}

// Sensors that are read at times of their own, some of them shared, predict what they would if all were read at all
// times; one without readings has no rows.
TEST(RunModel, PredictsEverySensorAtItsOwnTimes) {
  Experiment all = everything();
  all.runs[0].data = {"measured.csv"};
  const std::vector<double> grid = {0.0, 0.1, 0.15, 0.3, 0.45, 0.5, 0.8};
  const std::vector<std::vector<std::size_t>> read = {{0, 1, 3, 6}, {}, {2, 3, 4}};
  Experiment some = all;
  all.records.resize(1);
  some.records.resize(1);
  for (std::size_t k = 0; k < all.sensors.size(); ++k) {
    all.records[0].sensors.push_back({grid, std::vector<double>(grid.size(), 0.0)});
    Series& series = some.records[0].sensors.emplace_back();
    for (const std::size_t i : read[k % read.size()]) series.time.push_back(grid[i]);
    series.value.assign(series.time.size(), 0.0);
  }
  const FitProblem of_all(all), of_some(some);
  const RunModel& run = of_some.run(0);
  const Prediction everywhere =
      predict(of_all.run(0), of_all.run(0).scene_values(), of_all.run(0).released(), 1e-12, true);
  const Prediction there = predict(run, run.scene_values(), run.released(), 1e-12, true);
  EXPECT_EQ(there.reading.size(), some.records[0].count());
  EXPECT_EQ(run.span(), 0.8);
  for (std::size_t k = 0; k < some.sensors.size(); ++k) {
    EXPECT_EQ(run.counts(0.3)[k], (std::array{3U, 0U, 2U}[k % 3])) << k;
  }
  const auto width = static_cast<std::size_t>(run.columns());
  std::size_t row = 0;
  for (std::size_t k = 0; k < some.sensors.size(); ++k) {
    for (const std::size_t i : read[k % read.size()]) {
      const std::size_t whole = k * grid.size() + i;
      EXPECT_NEAR(there.reading[row], everywhere.reading[whole], 1e-10);
      for (std::size_t c = 0; c < width; ++c) {
        const double expected = everywhere.jacobian[whole * width + c];
        EXPECT_NEAR(there.jacobian[row * width + c], expected, 1e-8 * (1 + std::abs(expected)));
      }
      ++row;
    }
  }
  Prediction part;
  run.predict(run.scene_values().data(), run.released().data(), 0.3, 1e-12, false, part);
  EXPECT_EQ(part.reading.size(), run.readings(0.3));
}

TEST(RunModel, JacobianByEveryKindOfNumberAndTheStart) {
  const Experiment e = everything();
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  EXPECT_EQ(run.unknowns(), 14);
  EXPECT_EQ(run.nuisances(), 2);
  expect_jacobian(run, 1e-4, 1e-4, 1e-7);
}

// A free length follows from the equilibrium pose: its derivatives by every unknown and by the pose enter, too.
TEST(RunModel, JacobianOfARunInEquilibrium) {
  Experiment e = test::experiment("lift_experiment");
  e.unknowns.push_back(test::unknown("body.platform.center.y"));
  e.sensors.push_back(force_of_spring(e.scene));
  e.sensors.push_back(of(Measure::angle_between(0, 1), true));
  e.sensors.push_back(of(Measure::y_of(test::point(e.scene, "platform.Q")), false));
  for (poise::Run& run : e.runs) run.sample_rate = 100;
  const FitProblem problem(e);
  for (const std::size_t r : {0U, 3U}) {
    SCOPED_TRACE(e.runs[r].name);
    EXPECT_EQ(problem.run(r).nuisances(), 3);
    expect_jacobian(problem.run(r), 1e-3, 1e-4, 2e-6);
  }
}

// A known equilibrium and a known start leave no nuisances; the free length still depends on the unknowns.
TEST(RunModel, JacobianWhereEquilibriumAndStartAreKnown) {
  Experiment e = test::experiment("lift_experiment");
  e.runs.resize(1);
  e.runs[0].sample_rate = 100;
  e.runs[0].equilibrium->unknown = false;
  e.runs[0].unknown_start = false;
  const FitProblem problem(e);
  EXPECT_EQ(problem.run(0).nuisances(), 0);
  expect_jacobian(problem.run(0), 1e-3, 1e-4, 2e-6);
}

TEST(RunModel, JacobianOfADoublePendulumWithDryFriction) {
  Experiment e;
  e.scene = read_scene(test::dataset("double_pendulum.toml"));
  set_value(e.scene, "friction.shoulder dry.torque", 2e-4);
  set_value(e.scene, "friction.elbow dry.torque", 1e-4);
  e.sensors = {test::angle_of(e.scene, "arm1", 1e-3), test::angle_of(e.scene, "arm2", 1e-3)};
  for (const char* path :
       {"body.arm1.inertia", "body.arm2.mass", "body.arm2.inertia", "body.arm2.center.x", "body.arm2.center.y",
        "torsion_damper.shoulder.coefficient", "torsion_damper.elbow.coefficient", "friction.shoulder dry.torque",
        "friction.elbow dry.torque"}) {
    e.unknowns.push_back(test::unknown(path));
  }
  Release lift;
  lift.body = 1;
  lift.value = 0.4;
  Release turn = lift;
  turn.body = 2;
  turn.rate = true;
  turn.value = -3.0;
  e.runs.push_back(test::simulated(50, 100, {lift, turn}));
  const FitProblem problem(e);
  EXPECT_EQ(problem.run(0).freedoms(), 2);
  EXPECT_EQ(problem.run(0).nuisances(), 4);
  expect_jacobian(problem.run(0), 6e-4, 3e-5, 4e-6);
}

// Released in equilibrium the lift stays there, for all values of the unknowns.
TEST(RunModel, IsInEquilibriumWhereStated) {
  Experiment e = test::experiment("lift_experiment");
  for (poise::Run& run : e.runs) run.release.clear();
  const FitProblem problem(e);
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    std::vector<double> unknowns = run.scene_values();
    unknowns[0] += 13.0;
    unknowns[2] *= 0.7;
    const double equilibrium = e.runs[r].equilibrium->at + 0.01;
    const Prediction there = predict(run, unknowns, {equilibrium, equilibrium, 0.0}, 1e-10, false);
    for (const double reading : there.reading) ASSERT_NEAR(reading, equilibrium, 1e-9) << e.runs[r].name;
  }
}

// A search may try a pose in which the loops cannot close: reported as a failed run, without an exception.
TEST(RunModel, NamesAnImpossibleEquilibrium) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  const std::vector<double> unknowns = run.scene_values(), nuisances{-2.0, -2.0, 0.0};
  for (const bool jacobian : {false, true}) {
    Prediction out;
    run.predict(unknowns.data(), nuisances.data(), INFINITY, 1e-8, jacobian, out);
    EXPECT_FALSE(out.ok);
    EXPECT_NE(out.why.find("equilibrium position"), std::string::npos) << out.why;
  }
  EXPECT_FALSE(run.move(unknowns.data(), nuisances.data(), 1.0, 1e-8, false).completed());
  EXPECT_EQ(run.oscillator(unknowns.data(), -2.0).mass, 0.0);
}

// Inertia, stiffness and damping of small oscillations per square of obd's angle, against figures computed apart from
// Poise.
TEST(RunModel, OscillatorOfTheLift) {
  const nlohmann::json facts = test::read_json(test::dataset("lift_dynamics.json"));
  int compared = 0;
  for (const nlohmann::json& entry : facts.at("entries")) {
    Experiment e = test::experiment("lift_experiment");
    e.runs.resize(1);
    e.runs[0].changes[0].value = entry.at("payload");
    e.runs[0].equilibrium->at = entry.at("q");
    const FitProblem problem(e);
    const RunModel& run = problem.run(0);
    const RunModel::Oscillator o = run.oscillator(run.scene_values().data(), run.equilibrium_at());
    ASSERT_NE(o.equilibrium_by_z, 0.0);
    const double square = o.equilibrium_by_z * o.equilibrium_by_z;
    const double M = entry.at("M"), stiffness = entry.at("V2"), l_q = entry.at("dl_dq");
    EXPECT_NEAR(o.mass / square / M, 1.0, 1e-10);
    EXPECT_NEAR(o.stiffness / square / stiffness, 1.0, 1e-6);
    EXPECT_NEAR(o.damping / square / (4000 * l_q * l_q), 1.0, 1e-10);
    EXPECT_NEAR(o.reading, e.runs[0].equilibrium->at, 1e-12);
    EXPECT_NEAR(o.reading_by_z, o.equilibrium_by_z, 1e-12);
    ++compared;
  }
  EXPECT_EQ(compared, 15);
}

// The start from the first readings: value and slope of a parabola through 15 ms of the motion.
TEST(RunModel, StartsFromReadings) {
  Experiment e;
  e.scene = read_scene(test::dataset("double_pendulum.toml"));
  e.sensors = {test::angle_of(e.scene, "arm1", 1e-6), test::angle_of(e.scene, "arm2", 1e-6)};
  Release turn;
  turn.body = 1;
  turn.rate = true;
  turn.value = 2.0;
  e.runs.push_back(test::simulated(1000, 200, {turn}));
  const FitProblem problem(e);
  const std::vector<double> truth = problem.run(0).released();
  const std::vector<double> found =
      problem.run(0).start_from_readings(problem.truths().data(), problem.ideal_record(0));
  ASSERT_EQ(found.size(), truth.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], truth[i], i < 2 ? 2e-5 : 1e-2);
}

// Start of a measured run that is known: what `keys` and the first readings give; or what is said about it.
std::string known_start(const std::string& sensors, const std::string& keys, std::vector<double>& start) {
  const app_tests::TempFolder folder;
  folder.write("wheel.csv", "time,turn,speed\n0,20,-3\n1,19,-4\n2,18,-5\n3,17,-6\n");
  const Experiment e =
      read_experiment(app_tests::experiment(folder, std::string(app_tests::wheel_unknowns) + sensors +
                                                        "[[run]]\ndata = \"wheel.csv\"\nstart_known = true\n" + keys));
  try {
    start = FitProblem(e).run(0).start_of_run({});
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("run \""));
  }
  return "";
}

TEST(RunModel, AKnownStartNeedsRates) {
  const std::string speed = "[[sensor]]\nname = \"speed\"\nangle = \"wheel\"\nrate = true\nnoise = 1\n";
  const double degree = M_PI / 180;
  std::vector<double> start;
  EXPECT_EQ(
      known_start("", "", start),
      "run \"run 1\".start_known: expected the rate of \"wheel\" at the start; add release_rate = { \"wheel\" = "
      "NUMBER } (0 where it is released without speed) or a sensor with rate = true, without delay and with exact "
      "numbers");
  EXPECT_EQ(known_start("", "release = { wheel = 25 }\n", start).find("run \"run 1\".start_known: expected the rate"),
            0U);
  EXPECT_EQ(known_start("", "release_rate = { wheel = 0 }\n", start), "");
  ASSERT_EQ(start.size(), 1U);
  EXPECT_NEAR(start[0], 20 * degree, 1e-12) << "the first reading";
  EXPECT_EQ(known_start(speed, "release = { wheel = 25 }\n", start), "");
  EXPECT_NEAR(start[0], 25 * degree, 1e-12);
}

}  // namespace
}  // namespace poise::run_model_test
