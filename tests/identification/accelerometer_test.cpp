// Accelerometers and accelerations as readings: closed forms, derivatives, fits, and what no reading tells.

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::accelerometer_test {
namespace {

// A pendulum with m = 2, d = 0.3, J = 0.25 about its pin: l = J / (m d) = 5/12 to the centre of oscillation P.
const std::string scene = R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], W = [0.6, -0.2] }
[body.rod]
points = { O = [0, 0], P = [0.4166666666666667, 0], Q = [0.5, 0.1] }
mass = 2
center = [0.3, 0]
inertia = 0.07
[[pin]]
points = ["ground.O", "rod.O"]
[[torsion_damper]]
name = "oil"
bodies = ["ground", "rod"]
coefficient = 0
[[spring]]
name = "coil"
points = ["ground.W", "rod.Q"]
stiffness = 0
free_length = 0.2
[start]
rod = -1.5707963267948966
)";

const std::string swing = R"(
[[run]]
duration = 3
rate = 100
release = { rod = -0.4 }
)";

std::string accelerometer(const std::string& name, const std::string& point, double direction,
                          const std::string& more = "") {
  return fmt::format("[[sensor]]\nname = \"{}\"\naccelerometer = \"{}\"\ndirection = {}\nnoise = 0.02\n{}\n", name,
                     point, direction, more);
}

std::string unknown(const std::string& path, const std::string& more = "") {
  return "[[unknown]]\npath = \"" + path + "\"\n" + more + "\n";
}

constexpr double quarter = 1.5707963267948966;

class Accelerometers : public test::WrittenExperiment {
 protected:
  Accelerometers() : WrittenExperiment(scene) {}

  static std::vector<double> predicted(const Experiment& e) {
    const FitProblem problem(e);
    const RunModel& run = problem.run(0);
    Prediction out;
    run.predict(run.scene_values().data(), run.released().data(), INFINITY, 1e-11, false, out);
    EXPECT_TRUE(out.ok) << out.why;
    return out.reading;
  }
};

// The centre of oscillation of a free pendulum feels nothing across the rod. Along it the pin is felt, from the energy
//   J w^2 / 2 = m g d (sin a0 - sin a):  e . (a - g) = -l w^2 + g sin a.
TEST_F(Accelerometers, FeelWhatAPendulumDoes) {
  const std::vector<double> read = predicted(
      this->read("scene = \"scene.toml\"\n" + accelerometer("across", "rod.P", quarter) +
                 accelerometer("along", "rod.P", 0) + "[[sensor]]\nname = \"angle\"\nangle = \"rod\"\nnoise = 1e-3\n" +
                 "[[sensor]]\nname = \"turn\"\nread = \"d(d(angle.rod)/dt)/dt\"\nnoise = 1e-3\n" + swing));
  const std::size_t n = read.size() / 4;
  ASSERT_EQ(n, 300U);
  const double l = 0.25 / (2 * 0.3), g = 9.81;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = read[2 * n + i];
    EXPECT_NEAR(read[i], 0.0, 1e-8);
    EXPECT_NEAR(read[n + i], -l * (2 * g / l) * (std::sin(-0.4) - std::sin(a)) + g * std::sin(a), 1e-8);
    EXPECT_NEAR(read[3 * n + i], -g / l * std::cos(a), 1e-8);
  }
}

// While it is held it feels its weight alone, and so does one that turns about the pin, where nothing accelerates.
TEST_F(Accelerometers, FeelWeightWhereTheyAreHeld) {
  const std::vector<double> read = predicted(this->read(
      "scene = \"scene.toml\"\n" + accelerometer("late", "rod.P", 0.1, "delay = 2.505") +
      accelerometer("at the pin", "rod.O", 0.2) + swing + "start_known = true\nrelease_rate = { rod = 0 }\n"));
  const std::size_t n = read.size() / 2;
  for (std::size_t i = 0; i <= 250; ++i) EXPECT_NEAR(read[i], 9.81 * std::sin(-0.4 + 0.1), 1e-12);
  EXPECT_GT(std::abs(read[251] - read[250]), 0.5);  // let go, it falls
  EXPECT_NEAR(read[n], 9.81 * std::sin(-0.4 + 0.2), 1e-10);
}

TEST_F(Accelerometers, HaveExactDerivatives) {
  std::string text =
      "scene = \"scene.toml\"\nset = { \"spring.coil.stiffness\" = 40, \"torsion_damper.oil.coefficient\" "
      "= 0.05 }\n" +
      accelerometer("a", "rod.Q", 0.3, "factor = 1.1\nzero = 0.2\ndelay = 0.004") +
      "[[sensor]]\nname = \"b\"\nread = \"d(d(length.coil)/dt)/dt\"\nnoise = 0.1\n";
  for (const char* const path :
       {"body.rod.mass", "body.rod.inertia", "body.rod.center.x", "point.rod.Q.x", "point.rod.Q.y", "point.ground.W.x",
        "gravity.y", "spring.coil.stiffness", "spring.coil.free_length", "torsion_damper.oil.coefficient",
        "sensor.a.zero", "sensor.a.factor"}) {
    text += unknown(path);
  }
  const Experiment e = read(text + unknown("sensor.a.delay", "min = 0\nmax = 0.01") + swing);
  // Numbers of sensors stand behind those of the scene.
  test::expect_derivatives(e, FitProblem(e).run(0).released());
}

// An accelerometer and a gyro whose zeros are not known, as they are glued to a link.
TEST_F(Accelerometers, IdentifyAPendulum) {
  test::expect_found(
      read("scene = \"scene.toml\"\nset = { \"spring.coil.stiffness\" = 40, \"torsion_damper.oil.coefficient\" = 0.05 "
           "}\n" +
           accelerometer("x", "rod.Q", 0) + accelerometer("y", "rod.Q", quarter) +
           "[[sensor]]\nname = \"gyro\"\nread = \"d(angle.rod)/dt\"\nnoise = 0.01\n" + unknown("body.rod.inertia") +
           unknown("torsion_damper.oil.coefficient") + unknown("spring.coil.stiffness") + unknown("point.rod.Q.x") +
           unknown("sensor.gyro.zero") + unknown("sensor.x.zero") +
           unknown("sensor.y.delay", "min = -0.01\nmax = 0.01") + swing),
      5.0);
}

// Where the start is not known either, one clock alone tells no delay; a second sensor does.
TEST_F(Accelerometers, OneAloneTellsNoDelay) {
  const std::string one = "scene = \"scene.toml\"\n" + accelerometer("a", "rod.Q", 0.3);
  const std::string delay = unknown("sensor.a.delay", "min = 0\nmax = 0.01") + unknown("body.rod.inertia");
  const std::string gyro = "[[sensor]]\nname = \"gyro\"\nread = \"d(angle.rod)/dt\"\nnoise = 0.01\n";
  for (const bool two : {false, true}) {
    const Experiment e = read(one + (two ? gyro : "") + delay + swing);
    const FitProblem problem(e);
    const Identifiability found = assess(problem, problem.truths(), test::released(problem));
    ASSERT_TRUE(found.ok);
    EXPECT_EQ(std::isinf(found.standard_error[0]), !two);
    EXPECT_LT(found.standard_error[1], 0.1);
  }
}

TEST_F(Accelerometers, SayWhatIsWrong) {
  const auto says = [&](const std::string& sensor) {
    return error("scene = \"scene.toml\"\n[[sensor]]\nname = \"a\"\n" + sensor + "\n" + swing);
  };
  EXPECT_EQ(says("noise = 1\naccelerometer = \"ground.O\""),
            "experiment.toml:5: sensor \"a\".accelerometer: expected a point of a body that can move, found one of the "
            "ground");
  EXPECT_EQ(says("noise = 1\naccelerometer = \"rod.P\"\nrate = true"),
            "experiment.toml:6: sensor \"a\".rate: expected the rate of a position or angle; the rate of an "
            "acceleration is not available");
  EXPECT_EQ(says("noise = 1\nangle = \"rod\"\ndirection = 1"),
            "experiment.toml:6: sensor \"a\".direction: expected a direction of an accelerometer only; leave it out");
  EXPECT_EQ(says("noise = 1\nread = \"d(d(angle.rod)/dt)/dt\"\nrate = true"),
            "experiment.toml:6: sensor \"a\".rate: d(A)/dt is a rate already; leave it out");
  EXPECT_NE(says("noise = 1\nread = \"d(d(d(angle.rod)/dt)/dt)/dt\"").find("their d(A)/dt and d(d(A)/dt)/dt, other"),
            std::string::npos);
  folder_.write("scene.toml", scene + "[frame]\nx = { sine = { amplitude = 0.01, frequency = 3 } }\n");
  EXPECT_EQ(
      says("noise = 1\naccelerometer = \"rod.P\""),
      "experiment.toml:5: sensor \"a\".accelerometer: accelerometers of a scene with a [frame] that moves are not "
      "available; read positions");
}

}  // namespace
}  // namespace poise::accelerometer_test
