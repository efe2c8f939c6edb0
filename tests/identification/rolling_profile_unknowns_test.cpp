// Numbers of profiles that roll as unknowns of an experiment: Jacobians of predictions against differences, and a fit.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "model/parameters.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::rolling_profile_unknowns_test {
namespace {

/// The chair of datasets/, and an elliptic rocker on a drum.
Scene chair() { return read_scene(test::dataset("rocking_chair.toml")); }

Scene rocker_on_drum() {
  std::string points;
  for (int k = 0; k < 24; ++k) {
    const double t = 2 * M_PI * k / 24;
    points += fmt::format("[{:.17g}, {:.17g}], ", 0.3 * std::cos(t), 0.2 * std::sin(t));
  }
  return parse_scene(fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ A = [0, 0] }}
    [body.rocker]
    points = {{ C = [0, 0], H = [0, 0.1] }}
    mass = 3
    center = [0.01, -0.05]
    inertia = 0.07
    [[rolling_profile_on_circle]]
    name = "foot"
    at = "rocker.C"
    curve = [{}]
    closed = true
    center = "ground.A"
    circle_radius = 0.9
    offset = -3.135
    [start]
    rocker = 0.01
    "foot radius" = 1.57
    position = {{ rocker = [0, 1.1] }}
  )",
                                 points),
                     "drum.toml");
}

/// Its angle and the place of its point H are read while it rocks from 0.15 rad beside its equilibrium.
Experiment experiment(Scene scene, const std::vector<std::string>& unknowns) {
  Experiment e;
  e.scene = std::move(scene);
  Sensor place;
  place.name = "place";
  place.on = Measure::x_of({1, 1});
  place.noise = 1e-4;
  e.sensors = {place, test::angle_of(e.scene, e.scene.bodies[1].name, 1e-3)};
  for (const std::string& path : unknowns) e.unknowns.push_back(test::unknown(path));
  e.runs = {test::simulated(40, 40, {{.body = 1, .value = 0.15}})};
  return e;
}

std::vector<Experiment> experiments() {
  // Where nothing but the curve is of a higher degree in lengths.
  Experiment plain = experiment(chair(), {"rolling_profile.runner.curve.6.y", "rolling_profile.runner.curve.7.x"});
  plain.sensors.erase(plain.sensors.begin());
  plain.runs[0].unknown_start = true;
  // The drum's rocker topples, and leaves the drum after 0.556 s.
  Experiment toppling = experiment(
      rocker_on_drum(), {"rolling_profile_on_circle.foot.circle_radius", "rolling_profile_on_circle.foot.offset",
                         "point.rocker.C.x", "rolling_profile_on_circle.foot.curve.19.y",
                         "rolling_profile_on_circle.foot.curve.18.x", "rolling_profile_on_circle.foot.curve.20.y"});
  toppling.runs = {test::simulated(40, 22, {{.body = 1, .value = 0.15}})};
  return {
      experiment(chair(), {"rolling_profile.runner.offset", "body.chair.inertia", "rolling_profile.runner.curve.6.y",
                           "rolling_profile.runner.curve.5.x", "rolling_profile.runner.curve.7.y"}),
      toppling, plain};
}

// The slope of the curvature jumps where pieces of the spline meet, and with it the accelerations of the travel, at
// places that points move. Steps are as short as the motion needs: the sensitivities are less accurate, the worst
// to 1.4e-5, and with a hundredth of the motion's error to a tenth of that.
TEST(RollingProfileUnknowns, HaveTheDerivativesOfPredictions) {
  for (const Experiment& e : experiments()) {
    std::vector<SceneParameter> numbers;
    for (const Unknown& one : e.unknowns) numbers.push_back(*SceneParameter::find(e.scene, one.path));
    const RunModel run{e, 0, numbers};
    Prediction exact;
    run.predict(run.scene_values().data(), run.released().data(), run.span(), 1e-10, true, exact);
    ASSERT_TRUE(exact.ok) << exact.why;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const std::vector<double> difference = test::derivative(
          [&](double h) {
            std::vector<double> p = run.scene_values();
            p[k] += h;
            Prediction out;
            run.predict(p.data(), run.released().data(), run.span(), 1e-10, false, out);
            EXPECT_TRUE(out.ok) << out.why;
            return out.reading;
          },
          1e-4);
      double largest = 0.0;
      for (const double one : difference) largest = std::max(largest, std::abs(one));
      ASSERT_GT(largest, 0.001) << e.unknowns[k].path;
      for (std::size_t i = 0; i < exact.reading.size(); ++i) {
        EXPECT_NEAR(exact.jacobian[i * static_cast<std::size_t>(run.columns()) + k], difference[i], 2e-5 * largest)
            << e.unknowns[k].path << ", reading " << i;
      }
    }
  }
}

TEST(RollingProfileUnknowns, AreRecovered) {
  Experiment e = experiments().front();
  e.runs[0].unknown_start = true;
  for (Unknown& one : e.unknowns) one.start = get_value(e.scene, one.path) * 1.02;
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable());
  for (std::size_t k = 0; k < e.unknowns.size(); ++k) {
    EXPECT_NEAR(found.estimates[k].value, get_value(e.scene, e.unknowns[k].path), 6 * found.errors.error[k])
        << e.unknowns[k].path;
  }
}

}  // namespace
}  // namespace poise::rolling_profile_unknowns_test
