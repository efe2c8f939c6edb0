// Impacts in identification: derivatives of readings across them, with friction and several sides at once, and the
// times of impacts as readings.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "model/read_scene.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::impacts_test {
namespace {

Experiment with(const std::string& scene, const std::vector<Sensor>& sensors, const std::vector<const char*>& paths) {
  Experiment e;
  e.scene = parse_scene(scene, "scene.toml");
  e.sensors = sensors;
  for (const char* const path : paths) e.unknowns.push_back(test::unknown(path));
  return e;
}

Sensor sensor_of(const std::string& name, const Measure& on) {
  Sensor out;
  out.name = name;
  out.on = on;
  out.noise = 1e-4;
  return out;
}

Sensor impacts_at(const Scene& scene, const std::string& stop) {
  Sensor out;
  out.name = stop + " hits";
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (scene.stops[s].name == stop) out.stops.push_back(static_cast<int>(s));
  }
  out.on = scene.stops[static_cast<std::size_t>(out.stops.front())].on;
  out.noise = 1e-4;
  return out;
}

// A rod that is thrown onto a rough floor hits it with one end and the other, and slides.
std::string thrown_rod(double friction, const std::string& law) {
  return fmt::format(R"(
gravity = [0, -9.81]
[ground]
points = {{ O = [0, 0] }}
[body.rod]
points = {{ A = [-0.5, 0], B = [0.5, 0.02] }}
mass = 1
center = [0.03, 0.01]
inertia = 0.1
[[stop]]
name = "floor A"
y = "rod.A"
min = 0
friction = {0}
restitution = 0.6
law = "{1}"
[[stop]]
name = "floor B"
y = "rod.B"
min = 0.01
friction = {0}
restitution = 0.4
law = "{1}"
[start]
position = {{ rod = [0, 0.9] }}
rod = 0.5
)",
                     friction, law);
}

TEST(Impacts, DerivativesCrossThemWithFriction) {
  for (const auto& [friction, law] :
       {std::pair{0.15, "energetic"}, {0.6, "energetic"}, {0.3, "newton"}, {0.3, "poisson"}}) {
    SCOPED_TRACE(fmt::format("{} {}", friction, law));
    const Scene scene = parse_scene(thrown_rod(friction, law), "scene.toml");
    const PointRef end{1, 0};
    Experiment e = with(thrown_rod(friction, law),
                        {test::angle_of(scene, "rod", 1e-4), sensor_of("x", Measure::x_of(end)),
                         sensor_of("y", Measure::y_of(end)), impacts_at(scene, "floor A")},
                        {"body.rod.mass", "body.rod.inertia", "body.rod.center.x", "point.rod.A.x", "point.rod.B.y",
                         "gravity.y", "stop.floor A.min", "stop.floor A.friction", "stop.floor B.friction",
                         "stop.floor A.restitution", "stop.floor B.restitution"});
    poise::Run run = test::simulated(50, 50, {});
    run.release.push_back({.body = 1, .rate = true, .value = 0.7});
    e.runs = {run};
    const FitProblem problem(e);
    ASSERT_GE(problem.run(0).times()[3].size(), 2U);
    test::expect_derivatives(e, problem.run(0).released());
  }
}

// A cart that rests at a wall, pressed by a spring, is hit by another: both give back at once.
TEST(Impacts, DerivativesCrossSeveralAtOnce) {
  const std::string scene = R"(
[ground]
points = { O = [0, 0], W = [-1, 0] }
[body.a]
points = { C = [0, 0] }
mass = 1.5
[body.b]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "A"
points = ["ground.O", "a.C"]
axis = [1, 0]
[[slide]]
name = "B"
points = ["ground.O", "b.C"]
axis = [1, 0]
[[stop]]
name = "buffer"
points = ["b.C", "a.C"]
min = 0.1
restitution = 0.5
[[stop]]
name = "wall"
slide = "B"
min = 0
restitution = 0.8
[[spring]]
name = "S"
points = ["ground.W", "a.C"]
stiffness = 3
free_length = 0.5
[[spring]]
name = "R"
points = ["ground.W", "b.C"]
stiffness = 1
free_length = 0.2
[start]
A = 1
B = 0
)";
  const Scene parsed = parse_scene(scene, "scene.toml");
  Experiment e = with(
      scene, {sensor_of("a", Measure::travel_of(0)), sensor_of("b", Measure::travel_of(1)), impacts_at(parsed, "wall")},
      {"body.a.mass", "body.b.mass", "stop.buffer.min", "stop.buffer.restitution", "stop.wall.restitution",
       "spring.S.stiffness", "spring.S.free_length", "spring.R.stiffness"});
  poise::Run run = test::simulated(40, 100, {});
  run.unknown_start = false;
  e.runs = {run};
  const FitProblem problem(e);
  ASSERT_GE(problem.run(0).times()[2].size(), 1U);
  test::expect_derivatives(e, {});
}

constexpr double g = 9.81;

const char* const ball = R"(gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.ball]
points = { C = [0, 0] }
mass = 1
[[slide]]
name = "y"
points = ["ground.O", "ball.C"]
axis = [0, 1]
[[stop]]
name = "floor"
y = "ball.C"
min = 0
restitution = 0.7
[start]
y = 0.9
)";

class TimesOfImpacts : public test::WrittenExperiment {
 protected:
  TimesOfImpacts() : WrittenExperiment(ball) {}

  static std::string experiment(const std::string& keys, const std::string& further = "") {
    return "scene = \"scene.toml\"\n[[sensor]]\nname = \"click\"\nimpacts = \"floor\"\n" + keys +
           "[[unknown]]\npath = \"stop.floor.restitution\"\n" + further +
           "[[run]]\nstart_known = true\nrelease = { y = 0.9 }\nrelease_rate = { y = 0 }\ndata = \"clicks.csv\"\n";
  }
};

// The times of five bounces of a ball, which a microphone hears, tell what they give back:
//   t_1 = sqrt(2 h / g),  then  t_k+1 = t_k + 2 e^k sqrt(2 g h) / g.
TEST_F(TimesOfImpacts, TellWhatABounceGivesBack) {
  constexpr double e = 0.82, h = 0.9;
  std::string rows = "time,click\n";
  double t = std::sqrt(2 * h / g);
  for (int k = 1; k <= 5; ++k) {
    rows += fmt::format("{:.15g},1\n", t + 0.02);
    t += 2 * std::pow(e, k) * std::sqrt(2 * h / g);
  }
  folder_.write("clicks.csv", rows);
  const Experiment read =
      this->read(experiment("noise = 1e-4\n", "[[unknown]]\npath = \"sensor.click.zero\"\nmin = -0.1\nmax = 0.1\n"));
  const FitProblem problem(read);
  const Fit fitted = fit(problem, problem.records());
  ASSERT_TRUE(fitted.usable());
  EXPECT_NEAR(fitted.parameters[0], e, 1e-9);
  // quantity = zero + column
  EXPECT_NEAR(fitted.parameters[1], -0.02, 1e-9);
}

// A ball that has come to rest has bounced more often than is followed, more so at other values and accuracies.
TEST(Impacts, BouncesUpToRestAreFitted) {
  Experiment e = with(ball, {impacts_at(parse_scene(ball, "scene.toml"), "floor")}, {"stop.floor.restitution"});
  e.unknowns[0].start = 0.5;
  poise::Run run = test::simulated(20, 100, {});
  run.unknown_start = false;
  e.runs = {run};
  const FitProblem problem(e);
  EXPECT_GE(problem.run(0).times()[0].size(), 35U);
  const Fit fitted = fit(problem, problem.records());
  ASSERT_TRUE(fitted.usable());
  EXPECT_NEAR(fitted.parameters[0], 0.7, 5e-4);
}

TEST_F(TimesOfImpacts, RefuseWhatTheyCannotHave) {
  folder_.write("clicks.csv", "time,click\n0.4,1\n0.9,1\n1.3,1\n");
  EXPECT_EQ(error(experiment("noise = 1e-4\n")), "");
  EXPECT_EQ(error(experiment("")),
            "experiment.toml:2: sensor \"click\": expected the deviation of its times, s; add noise = NUMBER");
  EXPECT_EQ(error(experiment("noise = 1e-4\ndelay = 0.1\n")),
            "experiment.toml:6: sensor \"click\".delay: expected no such key of a sensor of impacts; leave it out");
  EXPECT_EQ(
      error(experiment("noise = 1e-4\n", "[[unknown]]\npath = \"sensor.click.factor\"\n")),
      "experiment.toml:9: unknown 2.path: expected sensor.click.zero, the only number of a sensor of impacts that "
      "can be unknown");
  std::string other = experiment("noise = 1e-4\n");
  other.replace(other.find("\"floor\""), 7, "\"flor\"");
  EXPECT_EQ(error(other),
            "experiment.toml:4: sensor \"click\".impacts: expected the name of a stop, contact, rope or cam that may "
            "be hit, found "
            "\"flor\"; did you mean \"floor\"?");
}

// A step of a search may begin where the mechanism cannot be: it costs too much, and the search goes on.
TEST(Impacts, AStartBeyondAStopIsRejected) {
  const std::string scene = R"(
[ground]
points = { O = [0, 0] }
[body.cart]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "rail"
points = ["ground.O", "cart.C"]
axis = [1, 0]
[[stop]]
name = "wall"
slide = "rail"
max = 1
[[spring]]
name = "coil"
slide = "rail"
stiffness = 20
free_length = 0
)";
  Experiment e = with(scene, {sensor_of("x", Measure::travel_of(0))}, {"spring.coil.stiffness"});
  e.runs = {test::simulated(50, 50, {{.joint = 0, .value = 0.5}})};
  const FitProblem problem(e);
  std::vector<std::vector<double>> starts = test::released(problem);
  EXPECT_TRUE(std::isfinite(problem.cost(problem.starts(), starts, problem.records(), problem.weighting(), 1)));
  starts[0][0] = 2.0;
  EXPECT_TRUE(std::isinf(problem.cost(problem.starts(), starts, problem.records(), problem.weighting(), 1)));
}

}  // namespace
}  // namespace poise::impacts_test
