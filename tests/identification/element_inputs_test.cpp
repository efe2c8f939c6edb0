// Runs in which numbers of force elements follow measured columns.

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/identification/crane.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/identification/written_experiment.hpp"

namespace poise::element_inputs_test {
namespace {

/// A motor between carriage and arm, of which the crane has one from the ground too, and a spring.
const std::string scene = test::crane("value = 0", "", "start = 0", "-1.5") + R"(
[[constant_force]]
name = "elbow"
bodies = ["arm", "cart"]
torque = 0.4
[[spring]]
name = "rope"
x = "arm.T"
stiffness = 30
free_length = 0.2
[[torsion_spring]]
name = "band"
bodies = ["cart", "arm"]
stiffness = 2
free_angle = -1
)";

const std::string sensors = R"(
scene = "scene.toml"
[[sensor]]
name = "angle"
angle = ["cart", "arm"]
noise = 1e-4
)";

class ElementInputs : public test::WrittenExperiment {
 protected:
  ElementInputs() : WrittenExperiment(scene) {
    std::string text = "time,tau,at,two\n";
    for (int i = 0; i <= 200; ++i) {
      const double t = 0.01 * i;
      text += fmt::format("{:.17g},{:.17g},{:.17g},2\n", t, 0.9 * std::sin(5.1 * t), -1 + 0.3 * std::cos(3 * t));
    }
    folder_.write("inputs.csv", text);
  }

  static std::string run(const std::string& inputs, const std::string& more = "") {
    return sensors + more + "[[run]]\nduration = 2\nrate = 50\ninputs = { " + inputs + " }\n";
  }
  Record record_of(const std::string& inputs, const std::string& set = "") const {
    const Experiment e = read(set + run(inputs));
    return FitProblem(e).ideal_record(0);
  }
  void expect_same(const Record& a, const Record& b) const {
    ASSERT_EQ(a.sensors[0].value.size(), b.sensors[0].value.size());
    for (std::size_t i = 0; i < a.sensors[0].value.size(); ++i) {
      EXPECT_NEAR(a.sensors[0].value[i], b.sensors[0].value[i], 1e-8) << i;
    }
  }
};

// The carriage does not turn, so that a torque from it is one from the ground.
TEST_F(ElementInputs, AMotorBetweenLinksIsATorqueOnBoth) {
  const std::string column = R"({ column = "tau", file = "inputs.csv" })";
  expect_same(record_of("\"constant_force.elbow.torque\" = " + column),
              record_of("\"load.motor\" = " + column, "set = { \"constant_force.elbow.torque\" = 0 }\n"));
}

TEST_F(ElementInputs, MultiplyTheNumbersOfTheScene) {
  const std::string twice = R"({ column = "two", file = "inputs.csv", multiplies = true })";
  const std::string none = R"("load.motor" = { column = "tau", file = "inputs.csv" })";
  expect_same(record_of(none + ", \"spring.rope.stiffness\" = " + twice),
              record_of(none, "set = { \"spring.rope.stiffness\" = 60 }\n"));
}

// A free angle of -1 + 0.3 cos 3t, by straight lines 0.01 s long, is a moment of 2 (0.3 cos 3t) beside that of -1.
TEST_F(ElementInputs, TakeThePlaceOfTheNumbersOfTheScene) {
  std::string text = "time,moment\n";
  for (int i = 0; i <= 200; ++i) text += fmt::format("{:.17g},{:.17g}\n", 0.01 * i, 0.6 * std::cos(0.03 * i));
  folder_.write("moment.csv", text);
  expect_same(record_of(R"("torsion_spring.band.free_angle" = { column = "at", file = "inputs.csv" })"),
              record_of(R"("load.motor" = { column = "moment", file = "moment.csv" })"));
}

TEST_F(ElementInputs, HaveExactJacobians) {
  const std::string unknowns = R"(
[[unknown]]
path = "constant_force.elbow.torque"
[[unknown]]
path = "spring.rope.stiffness"
[[unknown]]
path = "torsion_spring.band.stiffness"
[[unknown]]
path = "body.arm.inertia"
)";
  const std::string inputs =
      "\"torsion_spring.band.free_angle\" = { column = \"at\", file = \"inputs.csv\" }, "
      "\"constant_force.elbow.torque\" = { column = \"tau\", file = \"inputs.csv\", multiplies = true }";
  const Experiment e = read(run(inputs, unknowns));
  test::expect_derivatives(e, test::released(FitProblem(e))[0]);
}

TEST_F(ElementInputs, AreRefusedByNameWhereTheyCannotBe) {
  const std::string wrong = error(run(R"("constant_force.elbo.torque" = { column = "tau", file = "inputs.csv" })"));
  EXPECT_NE(wrong.find("constant_force.elbow.torque"), std::string::npos) << wrong;
  const std::string taken = error(run(R"("spring.rope.stiffness" = { column = "two", file = "inputs.csv" })", R"(
[[unknown]]
path = "spring.rope.stiffness"
)"));
  EXPECT_NE(taken.find("multiplies = true"), std::string::npos) << taken;
  const std::string read_too = error(run(R"("spring.rope.stiffness" = { column = "two", file = "inputs.csv" })", R"(
[[sensor]]
name = "pull"
force = "rope"
noise = 1
)"));
  EXPECT_NE(read_too.find("constant numbers"), std::string::npos) << read_too;
}

}  // namespace
}  // namespace poise::element_inputs_test
