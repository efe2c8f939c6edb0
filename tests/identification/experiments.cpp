#include "tests/identification/experiments.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::test {

Experiment experiment(const std::string& name, const std::vector<std::string>& settings) {
  return read_experiment(dataset(name + ".toml"), {{}, settings});
}

Sensor angle_of(const Scene& scene, const std::string& body, double noise) {
  Sensor sensor;
  sensor.name = sensor.column = body;
  sensor.noise = noise;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    if (scene.bodies[i].name == body) sensor.on = Measure::angle_between(0, static_cast<int>(i));
  }
  return sensor;
}

Unknown unknown(const std::string& path) {
  Unknown unknown;
  unknown.path = unknown.name = path;
  return unknown;
}

Run simulated(double rate, int count, std::vector<poise::Release> release) {
  Run run;
  run.name = "run";
  run.sample_rate = rate;
  run.duration = count / rate;
  run.release = std::move(release);
  run.seed = 1;
  return run;
}

Experiment oscillator() {
  Experiment e;
  e.scene = parse_scene(R"(
[ground]
points = { O = [0, 0], S = [-1, 0] }
[body.block]
points = { c = [0, 0] }
mass = 2
[[slide]]
name = "rail"
points = ["ground.O", "block.c"]
axis = [1, 0]
[[spring]]
name = "coil"
points = ["ground.S", "block.c"]
stiffness = 80
free_length = 1
[[damper]]
name = "pot"
points = ["ground.S", "block.c"]
coefficient = 0.6
[start]
rail = 0.02
)",
                        "oscillator");
  Sensor travel;
  travel.name = "x";
  travel.on = Measure::travel_of(0);
  travel.noise = 1e-5;
  e.sensors = {travel};
  e.unknowns = {unknown("body.block.mass"), unknown("spring.coil.stiffness"), unknown("damper.pot.coefficient")};
  poise::Release pull;
  pull.joint = 0;
  pull.value = 0.02;
  e.runs = {simulated(100, 300, {pull})};
  return e;
}

std::size_t parameter(const FitProblem& problem, const std::string& name) {
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    if (problem.parameters()[i].name == name) return i;
  }
  throw std::out_of_range("no parameter is called \"" + name + "\"");
}

std::vector<std::vector<double>> released(const FitProblem& problem) {
  std::vector<std::vector<double>> nuisances;
  for (std::size_t r = 0; r < problem.runs(); ++r) nuisances.push_back(problem.run(r).released());
  return nuisances;
}

Eigen::MatrixXd whole_jacobian(const FitProblem& problem) {
  const auto parameters = static_cast<Eigen::Index>(problem.parameters().size());
  Eigen::Index rows = 0;
  Eigen::Index columns = parameters;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    rows += static_cast<Eigen::Index>(problem.run(r).readings(INFINITY));
    columns += problem.run(r).nuisances();
  }
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::Index row = 0;
  Eigen::Index column = parameters;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    Prediction prediction;
    run.predict(run.scene_values().data(), run.released().data(), INFINITY, 1e-11, true, prediction);
    if (!prediction.ok) throw std::runtime_error(prediction.why);
    const auto width = static_cast<std::size_t>(run.columns());
    std::size_t i = 0;
    for (std::size_t k = 0; k < run.times().size(); ++k) {
      const double noise = problem.experiment().sensors[k].noise;
      for (std::size_t s = 0; s < run.times()[k].size(); ++s, ++i, ++row) {
        for (std::size_t c = 0; c < width; ++c) {
          const auto u = static_cast<int>(c);
          const Eigen::Index to = u < run.unknowns() ? problem.parameters_of(r)[c] : column + u - run.unknowns();
          J(row, to) = prediction.jacobian[i * width + c] / noise;
        }
      }
    }
    column += run.nuisances();
  }
  return J;
}

std::vector<double> derivative(const std::function<std::vector<double>(double)>& f, double h) {
  const std::vector<double> far_down = f(-2 * h), down = f(-h), up = f(h), far_up = f(2 * h);
  std::vector<double> out(up.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = (8 * (up[i] - down[i]) - (far_up[i] - far_down[i])) / (12 * h);
  }
  return out;
}

void expect_found(const Experiment& e, double most) {
  const FitProblem problem(e);
  const Fit fitted = fit(problem, problem.records());
  ASSERT_EQ(fitted.status, FitStatus::converged) << fitted.why;
  for (const Estimate& estimate : fitted.estimates) {
    EXPECT_FALSE(estimate.withheld) << estimate.name;
    EXPECT_GT(estimate.standard_error, 0.0) << estimate.name;
    EXPECT_NEAR(estimate.value, estimate.truth, 5 * estimate.standard_error) << estimate.name;
    EXPECT_LT(estimate.standard_error, most) << estimate.name;
  }
}

void expect_derivatives(const Experiment& e, const std::vector<double>& nuisances) {
  const FitProblem problem(e);
  const RunModel& run = problem.run(0);
  const std::vector<double> numbers = run.scene_values();
  ASSERT_EQ(run.columns(), static_cast<int>(numbers.size() + nuisances.size()));
  Prediction whole;
  run.predict(numbers.data(), nuisances.data(), INFINITY, 1e-11, true, whole);
  ASSERT_TRUE(whole.ok) << whole.why;
  const auto columns = static_cast<std::size_t>(run.columns());
  for (std::size_t c = 0; c < columns; ++c) {
    std::vector<double> p = numbers, n = nuisances;
    double& moved = c < numbers.size() ? p[c] : n[c - numbers.size()];
    const double at = moved;
    const auto difference = [&](double step) {
      return derivative(
          [&](double h) {
            moved = at + h;
            Prediction there;
            run.predict(p.data(), n.data(), INFINITY, 1e-11, false, there);
            return there.reading;
          },
          step * std::max(std::abs(at), 1e-2));
    };
    const std::vector<double> fine = difference(1e-5), coarse = difference(1e-4);
    double largest = 0.0;
    for (const double x : fine) largest = std::max(largest, std::abs(x));
    EXPECT_GT(largest, 0) << c;
    ASSERT_EQ(fine.size(), whole.reading.size());
    for (std::size_t i = 0; i < fine.size(); ++i) {
      const double exact = whole.jacobian[i * columns + c];
      ASSERT_LT(std::min(std::abs(exact - fine[i]), std::abs(exact - coarse[i])), 4e-6 * largest)
          << exact << " where differences are " << fine[i] << " and " << coarse[i] << ", column " << c << " "
          << (c < numbers.size() ? e.unknowns[c].path : "start") << ", reading " << i;
    }
  }
}

}  // namespace poise::test
