// Runs of bodies on blades: derivatives of what is read against differences, and fits.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "identification/prediction/run_model.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::blade_unknowns_test {
namespace {

/// The sleigh of datasets/ with a blade that is not quite along its body, on a plane that falls along x.
Experiment sleigh(const std::vector<std::string>& unknowns) {
  Experiment e;
  e.scene = read_scene(test::dataset("machines/chaplygin_sleigh.toml"));
  e.scene.gravity = {0.7, 0.0};
  e.scene.blades[0].angle = 0.1;
  Sensor x, y;
  x.name = "x";
  x.on = Measure::x_of({1, 0});
  x.noise = 1e-4;
  y.name = "y";
  y.on = Measure::y_of({1, 0});
  y.noise = 1e-4;
  e.sensors = {test::angle_of(e.scene, e.scene.bodies[1].name, 1e-3), x, y};
  for (const std::string& path : unknowns) e.unknowns.push_back(test::unknown(path));
  // Its rates follow from that along x and from its turning.
  e.runs = {test::simulated(40, 80, {{.body = 1, .value = 0.2}, {.body = 1, .rate = true, .value = 2.0}})};
  e.runs[0].unknown_start = false;
  return e;
}

const std::vector<std::string> of_sleigh{"body.sleigh.center.x", "body.sleigh.inertia", "blade.edge.angle",
                                         "point.sleigh.P.x", "gravity.x"};

TEST(BladeUnknowns, HaveTheDerivativesOfPredictions) {
  const Experiment e = sleigh(of_sleigh);
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
      EXPECT_NEAR(exact.jacobian[i * static_cast<std::size_t>(run.columns()) + k], difference[i], 1e-7 * largest)
          << e.unknowns[k].path << ", reading " << i;
    }
  }
}

TEST(BladeUnknowns, AnUnknownStartIsRefused) {
  Experiment e = sleigh(of_sleigh);
  e.runs[0].unknown_start = true;
  const std::string message = test::message_of([&] { const RunModel run(e, 0, {}); });
  EXPECT_NE(message.find("start_known: expected true"), std::string::npos) << message;
  EXPECT_NE(message.find("\"edge\""), std::string::npos) << message;
}

// Half a turn of a blade changes nothing.
TEST(BladeUnknowns, AreRecovered) {
  Experiment e = sleigh(of_sleigh);
  e.unknowns[2].min = -1.0;
  e.unknowns[2].max = 1.0;
  test::expect_found(e, 0.02);
}

}  // namespace
}  // namespace poise::blade_unknowns_test
