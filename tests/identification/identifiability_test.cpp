#include "identification/identifiability/identifiability.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "identification/fit/fit.hpp"
#include "solvers/linear_algebra.hpp"
#include "tests/identification/experiments.hpp"
#include "tests/support/build_scene.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::identifiability_test {
namespace {

nlohmann::json answers() { return test::read_json(test::dataset("identification_answers.json")); }

Identifiability assess_at_truth(const FitProblem& problem) {
  return assess(problem, problem.truths(), test::released(problem));
}

// d(reading)/d(unknowns, nuisances) of run 0 at the truth, SI.
Eigen::MatrixXd jacobian(const RunModel& run) {
  Prediction p;
  run.predict(run.scene_values().data(), run.released().data(), INFINITY, 1e-12, true, p);
  EXPECT_TRUE(p.ok) << p.why;
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      p.jacobian.data(), static_cast<Eigen::Index>(p.reading.size()), run.columns());
}

// The table of ../shared/lift/README.md, computed apart from Poise: per cent of what is shown.
TEST(Identifiability, CramerRaoBoundsOfTheLift) {
  const nlohmann::json table = answers().at("lift_cramer_rao");
  int compared = 0;
  for (const auto& [name, row] : table.at("experiments").items()) {
    SCOPED_TRACE(name);
    const Experiment e = test::experiment(name);
    const FitProblem problem(e);
    const Identifiability found = assess_at_truth(problem);
    ASSERT_TRUE(found.ok) << found.why;
    EXPECT_EQ(found.rank, static_cast<int>(problem.parameters().size()));
    EXPECT_TRUE(found.null_directions.empty());
    for (const auto& [parameter, cell] : row.items()) {
      const std::size_t i = test::parameter(problem, parameter);
      const Parameter& p = problem.parameters()[i];
      const double shown = p.truth + e.unknowns[static_cast<std::size_t>(p.unknown)].includes;
      const double percent = cell.at("percent");
      EXPECT_NEAR(100 * found.standard_error[i] / shown, percent, cell.at("digit").get<double>() * 0.55) << parameter;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 14);
}

// Eliminating nuisances run by run is the same as inverting everything at once.
TEST(Identifiability, CovarianceIsTheInverseOfTheWholeInformation) {
  for (const char* name : {"lift_experiment_heights", "lift_experiment_four_runs"}) {
    const Experiment e = test::experiment(name);
    const FitProblem problem(e);
    const Identifiability found = assess_at_truth(problem);
    ASSERT_TRUE(found.ok);
    Eigen::MatrixXd J = test::whole_jacobian(problem);
    const Eigen::VectorXd size = J.colwise().norm();
    J *= size.cwiseInverse().asDiagonal();
    const Eigen::MatrixXd inverse = solvers::FullyPivotedLu(J.transpose() * J)
                                        .solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(J.cols(), J.cols())));
    const Eigen::MatrixXd covariance = size.cwiseInverse().asDiagonal() * inverse * size.cwiseInverse().asDiagonal();
    for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double standard_error = std::sqrt(covariance(at, at));
      EXPECT_NEAR(found.standard_error[i] / standard_error, 1.0, 1e-5) << problem.parameters()[i].name;
      for (Eigen::Index j = 0; j < at; ++j) {
        EXPECT_NEAR(found.correlation[i][static_cast<std::size_t>(j)].value(),
                    covariance(at, j) / (standard_error * std::sqrt(covariance(j, j))), 1e-5);
      }
    }
  }
}

TEST(Identifiability, APriorAddsItsInformation) {
  Experiment e = test::experiment("lift_experiment");
  const FitProblem plain(e);
  const double before = assess_at_truth(plain).standard_error[2];
  e.unknowns[2].prior = 2e6;
  e.unknowns[2].prior_deviation = before;
  const FitProblem known(e);
  EXPECT_NEAR(assess_at_truth(known).standard_error[2], before / std::sqrt(2.0), 1e-6 * before);
}

// Sampled pendulum theta'' = -a sin(theta): a torque a on the ground's side of a wheel of unit inertia.
Experiment pendulum() {
  Experiment e;
  e.scene = parse_scene(R"(
[ground]
points = { O = [0, 0] }
[body.arm]
points = { O = [0, 0], B = [1, 0] }
inertia = 1
[[pin]]
points = ["ground.O", "arm.O"]
[[force]]
name = "a"
at = "arm.B"
vector = [9.81, 0]
[start]
arm = 1
)",
                        "pendulum");
  e.sensors = {test::angle_of(e.scene, "arm", 0.01)};
  e.unknowns = {test::unknown("load.a")};
  Release lift;
  lift.body = 1;
  lift.value = 1.0;
  e.runs = {test::simulated(20, 201, {lift})};
  return e;
}

TEST(Identifiability, PendulumReachesItsReference) {
  const nlohmann::json reference = answers().at("pendulum_crb");
  Experiment e = pendulum();
  const FitProblem problem(e);
  EXPECT_NEAR(problem.ideal_record(0).sensors[0].value.back(), test::number(reference.at("theta_at_10")), 1e-9);
  // The reference starts with known zero velocity: of the start only the angle is unknown beside a.
  const Eigen::MatrixXd J = jacobian(problem.run(0)).leftCols(2) / 0.01;
  const Eigen::Matrix2d normal = J.transpose() * J;
  const Eigen::Matrix2d covariance = normal.inverse();
  const double of_a = std::sqrt(covariance(0, 0)), of_theta = std::sqrt(covariance(1, 1));
  EXPECT_NEAR(of_a / test::number(reference.at("crb_std_a_joint")), 1.0, 1e-8);
  EXPECT_NEAR(of_theta / test::number(reference.at("crb_std_theta0_joint")), 1.0, 1e-8);
  EXPECT_NEAR(covariance(0, 1) / (of_a * of_theta), test::number(reference.at("corr")), 1e-8);
  // With the start known.
  e.runs[0].unknown_start = false;
  const FitProblem known(e);
  const Identifiability found = assess_at_truth(known);
  ASSERT_TRUE(found.ok);
  EXPECT_NEAR(found.standard_error[0] / test::number(reference.at("crb_std_a_theta0_known")), 1.0, 1e-7);
}

// A free double pendulum of two uniform unit rods. Its motion depends on A = I1 + m1/4 + m2, B = I2 + m2/4, C = m2/2,
// D = m1/2 + m2 alone, and not on their common scale.
Experiment double_pendulum() {
  Experiment e;
  e.scene.gravity = {0, -9.81};
  e.scene.bodies[0].points.push_back({"O", {0, 0}});
  for (const char* name : {"one", "two"}) {
    const int link = test::add_link(e.scene, name, 1.0, 1.0);
    e.scene.bodies[static_cast<std::size_t>(link)].center = {0.5, 0};
    e.scene.bodies[static_cast<std::size_t>(link)].inertia = 1.0 / 12;
  }
  test::add_pin(e.scene, "ground.O", "one.a");
  test::add_pin(e.scene, "one.b", "two.a");
  e.sensors = {test::angle_of(e.scene, "one", 1e-3), test::angle_of(e.scene, "two", 1e-3)};
  Release first, second;
  first.body = 1;
  second.body = 2;
  first.value = 1.0 - M_PI / 2;  // the reference counts from hanging
  second.value = -0.5 - M_PI / 2;
  e.scene.start.angle[1] = first.value;
  e.scene.start.angle[2] = second.value;
  e.runs = {test::simulated(50, 251, {first, second})};
  e.runs[0].unknown_start = false;
  return e;
}

TEST(Identifiability, TheScaleOfAFreeDoublePendulumIsNotIdentifiable) {
  const nlohmann::json reference = answers().at("double_pendulum_free");
  Experiment e = double_pendulum();
  e.unknowns = {test::unknown("body.one.inertia"), test::unknown("body.two.inertia"), test::unknown("body.one.mass"),
                test::unknown("body.two.mass")};
  const FitProblem problem(e);
  const Record record = problem.ideal_record(0);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(record.sensors[k].value.back() + M_PI / 2, test::number(reference.at("state_T")[k]), 1e-9);
  }
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok);
  EXPECT_EQ(found.rank, 3);
  EXPECT_GT(found.gap, 1e6);
  ASSERT_EQ(found.null_directions.size(), 1U);
  EXPECT_TRUE(found.null_directions[0].exact);
  EXPECT_TRUE(found.null_directions[0].scale);
  EXPECT_NE(found.null_directions[0].words.find("overall scale"), std::string::npos) << found.null_directions[0].words;
  EXPECT_FALSE(found.null_directions[0].remedy.empty());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.null_directions[0].part[i], 1.0, 1e-6);
    EXPECT_FALSE(found.identifiable[i]);
    EXPECT_TRUE(std::isinf(found.standard_error[i]));
  }
  // In A, B, C, D, as the reference: the sensitivities by the four numbers above, times d(numbers)/d(A, B, C, D).
  Eigen::Matrix4d by_numbers;
  by_numbers << 1, 0, 0.25, 1,  //
      0, 1, 0, 0.25,            //
      0, 0, 0, 0.5,             //
      0, 0, 0.5, 1;
  const Eigen::Vector4d abcd = by_numbers * Eigen::Vector4d(1.0 / 12, 1.0 / 12, 1.0, 1.0);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(abcd[i], reference.at("params_ABCD")[static_cast<std::size_t>(i)], 1e-14);
  const Eigen::MatrixXd J = jacobian(problem.run(0)) * by_numbers.inverse() * abcd.asDiagonal();
  const solvers::SingularValues svd = solvers::singular_value_decomposition(J);
  const nlohmann::json& singular = reference.at("rel_singular_values");
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(svd.values[i] / test::number(singular[static_cast<std::size_t>(i)]), 1.0, 1e-8);
  }
  EXPECT_LT(svd.values[3], 1e-7);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(std::abs(svd.right(i, 3)), 0.5, 1e-7);
}

// With the masses and the first arm's centre known, D is; then inertia one, inertia two and the second centre are A, B
// and C but for constants:  dC = da2,  dB = dI2 + 2 a2 da2.
TEST(Identifiability, FreeDoublePendulumWithOneLumpKnown) {
  const nlohmann::json reference = answers().at("double_pendulum_free");
  Experiment e = double_pendulum();
  e.unknowns = {test::unknown("body.one.inertia"), test::unknown("body.two.inertia"),
                test::unknown("body.two.center.x")};
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok);
  ASSERT_EQ(found.rank, 3);
  const Eigen::Map<const Eigen::Vector3d> standard_error(found.standard_error.data());
  Eigen::Matrix3d correlation;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = found.correlation[i][j].value();
    }
  }
  const Eigen::Matrix3d covariance = standard_error.asDiagonal() * correlation * standard_error.asDiagonal();
  Eigen::Matrix3d lumps;
  lumps << 1, 0, 0,  //
      0, 1, 1,       //
      0, 0, 1;
  const Eigen::Matrix3d of_lumps = lumps * covariance * lumps.transpose();
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double size = reference.at("params_ABCD")[at];
    EXPECT_NEAR(std::sqrt(of_lumps(i, i)) / size / test::number(reference.at("rel_std_D_known")[at]), 1.0, 1e-6);
  }
}

TEST(Identifiability, TheScaleOfAnOscillatorIsNotIdentifiable) {
  const Experiment e = test::oscillator();
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.rank, 2);
  ASSERT_EQ(found.null_directions.size(), 1U);
  const auto& scale = found.null_directions[0];
  EXPECT_TRUE(scale.exact);
  EXPECT_TRUE(scale.scale);
  for (const double part : scale.part) EXPECT_NEAR(part, 1.0, 1e-5);
  for (const char* name : {"body.block.mass", "spring.coil.stiffness", "damper.pot.coefficient"}) {
    EXPECT_NE(scale.words.find(name), std::string::npos) << scale.words;
  }
  EXPECT_NE(scale.remedy.find("payload"), std::string::npos) << scale.remedy;
}

// A null is the reason, wherever the fit stopped along it.
TEST(Identifiability, ANullIsTheReasonAtABoundToo) {
  Experiment e = test::oscillator();
  e.unknowns[0].min = 2.0;
  e.unknowns[0].start = 2.0;
  const FitProblem problem(e);
  FitOptions options;
  options.use_starts = true;
  const Fit found = fit(problem, problem.records(), options);
  ASSERT_TRUE(found.usable()) << found.why;
  for (const Estimate& estimate : found.estimates) {
    EXPECT_TRUE(estimate.withheld) << estimate.name;
    EXPECT_FALSE(estimate.at_bound) << estimate.name;
    EXPECT_EQ(estimate.why, "not identifiable from these data") << estimate.name;
  }
}

// The remedy that is named works: another run with a payload that is known.
TEST(Identifiability, AKnownPayloadMakesTheScaleIdentifiable) {
  Experiment e = test::oscillator();
  const int payload = e.scene.add_body("payload");
  e.scene.add_point(payload, "c", {0, 0});
  Joint weld;
  weld.kind = Joint::Kind::weld;
  weld.name = "weld";
  weld.a = test::point(e.scene, "block.c");
  weld.b = test::point(e.scene, "payload.c");
  e.scene.add_joint(weld);
  e.runs.push_back(e.runs[0]);
  e.runs[1].name = "loaded";
  e.runs[1].changes.push_back({"body.payload.mass", 1.0, 0});
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.rank, 3);
  EXPECT_TRUE(found.null_directions.empty());
}

/// A link of 2 kg and 0.2 kg m2 on a level table, its centre 0.3 m from its pin, released on a torsion spring.
Experiment link_on_a_spring() {
  Experiment e;
  e.scene = test::chain(1, 1.0, 2.0);
  e.scene.gravity = {0, 0};
  e.scene.bodies[1].center = {0.3, 0};
  e.scene.bodies[1].inertia = 0.2;
  test::add_torsion_spring(e.scene, 0, 1, 5.0);
  test::element(e.scene, "torsion_spring").name = "coil";
  e.sensors = {test::angle_of(e.scene, "1", 1e-4)};
  Release turn;
  turn.body = 1;
  turn.value = 0.3;
  e.runs = {test::simulated(100, 300, {turn})};
  return e;
}

// On a level table mass and inertia of a link matter only as the inertia about its pin: dI = -a^2 dm.
TEST(Identifiability, MassAndInertiaOfOneLink) {
  Experiment e = link_on_a_spring();
  e.unknowns = {test::unknown("body.1.mass"), test::unknown("body.1.inertia")};
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.rank, 1);
  ASSERT_EQ(found.null_directions.size(), 1U);
  const auto& direction = found.null_directions[0];
  EXPECT_TRUE(direction.exact);
  EXPECT_FALSE(direction.scale);
  // Relative changes: dI / I over dm / m is -a^2 m / I.
  EXPECT_NEAR(direction.part[1] / direction.part[0], -0.09 * 2.0 / 0.2, 1e-6);
  EXPECT_NE(direction.words.find("body.1.mass"), std::string::npos) << direction.words;
  EXPECT_NE(direction.words.find("change no reading"), std::string::npos) << direction.words;
  EXPECT_FALSE(direction.remedy.empty());
}

// A pendulum (I + m c^2) a'' = m g c cos a: twice the inertia I = m c^2 and gravity half as strong again. That is said
// of a component of gravity that is negative as of one that is positive.
TEST(Identifiability, SaysWhetherANegativeNumberGrows) {
  for (const double down : {-1.0, 1.0}) {
    Experiment e;
    e.scene = test::chain(1, 1.0, 1.0);
    e.scene.gravity = {0, 9.81 * down};
    e.scene.bodies[1].center = {0.5, 0};
    e.scene.bodies[1].inertia = 0.25;
    e.sensors = {test::angle_of(e.scene, "1", 1e-3)};
    e.unknowns = {test::unknown("body.1.inertia"), test::unknown("gravity.y")};
    e.scene.start.angle[1] = 0.3;
    e.runs = {test::simulated(100, 200, {})};
    const FitProblem problem(e);
    const Identifiability found = assess_at_truth(problem);
    ASSERT_TRUE(found.ok) << found.why;
    ASSERT_EQ(found.null_directions.size(), 1U);
    EXPECT_NEAR(found.null_directions[0].part[1], 0.5 * down, 1e-9);
    const std::string words = found.null_directions[0].words;
    EXPECT_EQ(words.find(down < 0 ? "body.1.inertia +100 %, gravity.y +50 % in size together"
                                  : "body.1.inertia +100 %, gravity.y +50 % together"),
              0U)
        << words;
  }
}

// A wheel on a spring under a constant torque, with a known damper that is so weak that it hardly tells their scale:
// also where the torque is negative.
TEST(Identifiability, AWeakScaleIsOneOfNegativeTorquesToo) {
  for (const char* const torque : {"5", "-5"}) {
    Experiment e;
    e.scene = parse_scene(std::string(R"(
[ground]
points = { O = [0, 0] }
[body.wheel]
points = { O = [0, 0] }
inertia = 0.5
[[pin]]
points = ["ground.O", "wheel.O"]
[[torsion_spring]]
name = "coil"
bodies = ["ground", "wheel"]
stiffness = 20
[[torsion_damper]]
name = "known"
bodies = ["ground", "wheel"]
coefficient = 3e-4
[[torque]]
name = "twist"
on = "wheel"
value = )") + torque,
                          "wheel");
    e.sensors = {test::angle_of(e.scene, "wheel", 1e-3)};
    e.unknowns = {test::unknown("body.wheel.inertia"), test::unknown("torsion_spring.coil.stiffness"),
                  test::unknown("load.twist")};
    e.runs = {test::simulated(100, 200, {})};
    const FitProblem problem(e);
    const Identifiability found = assess_at_truth(problem);
    ASSERT_TRUE(found.ok) << found.why;
    ASSERT_EQ(found.null_directions.size(), 1U);
    const Identifiability::Direction& weak = found.null_directions[0];
    EXPECT_GT(weak.singular_value, 0);
    EXPECT_TRUE(weak.scale) << weak.words;
    EXPECT_EQ(weak.words.find("% in size together") != std::string::npos, torque[0] == '-') << weak.words;
  }
}

// With spring and damper unknown, too, the overall scale is a second null: one direction is the scale, the other one
// the first null without it.
TEST(Identifiability, TheScaleIsADirectionOfItsOwn) {
  Experiment e = link_on_a_spring();
  e.scene.elements.push_back(test::torsion_damper("pot", 0, 1, 0.1));
  e.unknowns = {test::unknown("body.1.mass"), test::unknown("body.1.inertia"),
                test::unknown("torsion_spring.coil.stiffness"), test::unknown("torsion_damper.pot.coefficient")};
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.rank, 2);
  ASSERT_EQ(found.null_directions.size(), 2U);
  const Identifiability::Direction& scale = found.null_directions[0];
  EXPECT_TRUE(scale.scale);
  for (const double part : scale.part) EXPECT_NEAR(part, 1.0, 1e-12);
  const Identifiability::Direction& other = found.null_directions[1];
  EXPECT_FALSE(other.scale);
  EXPECT_NEAR(other.part[1] / other.part[0], -0.09 * 2.0 / 0.2, 1e-6);
  EXPECT_EQ(other.part[2], 0.0);
  EXPECT_EQ(other.part[3], 0.0);
  EXPECT_EQ(other.words.find("coil"), std::string::npos) << other.words;
}

// A wheel with a torsion spring, turned by a force at its rim that follows it: I a'' + k a = F r, so F r / k shifts the
// angle about which it oscillates. The reading's derivative by F is (1 - cos(w t)) r / k.
TEST(Identifiability, AFollowerForceIsIdentifiableFromTheAngleOfEquilibrium) {
  Experiment e;
  e.scene = parse_scene(R"(
    [ground]
    points = { O = [0, 0] }
    [body.wheel]
    points = { O = [0, 0], rim = [0.2, 0] }
    inertia = 0.5
    [[pin]]
    points = ["ground.O", "wheel.O"]
    [[torsion_spring]]
    name = "coil"
    bodies = ["ground", "wheel"]
    stiffness = 20
    [[force]]
    name = "F"
    at = "wheel.rim"
    vector = [0, 7]
    follows = "wheel"
  )",
                        "wheel.toml");
  const double noise = 1e-4;
  e.sensors = {test::angle_of(e.scene, "wheel", noise)};
  e.unknowns = {test::unknown("load.F")};
  Release turn;
  turn.body = 1;
  turn.value = 0.3;
  e.runs = {test::simulated(100, 300, {turn})};
  e.runs[0].unknown_start = false;
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.rank, 1);
  EXPECT_TRUE(found.null_directions.empty());
  double information = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double slope = (1 - std::cos(std::sqrt(20 / 0.5) * 0.01 * i)) * 0.2 / 20;
    information += slope * slope / (noise * noise);
  }
  EXPECT_NEAR(found.standard_error[0] * std::sqrt(information), 1.0, 1e-6);
}

TEST(Identifiability, TheScaleOfTheLiftWithoutPayloadIsNotIdentifiable) {
  const Experiment e = test::experiment("lift_experiment_empty");
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  ASSERT_FALSE(found.null_directions.empty());
  EXPECT_TRUE(found.null_directions.back().scale) << found.null_directions.back().words;
  EXPECT_FALSE(found.null_directions.back().remedy.empty());
}

// An arm under gravity on a spring from above its pin, without free length: its moment is k a h sin, that of the weight
// m g x sin. Released far from equilibrium.
Experiment sprung_arm(double stiffness) {
  Experiment e;
  e.scene = parse_scene(R"(
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], S = [0, 0.4] }
[body.arm]
points = { O = [0, 0], B = [0.3, 0] }
mass = 2
center = [0.25, 0.04]
inertia = 0.05
[[pin]]
points = ["ground.O", "arm.O"]
[[spring]]
name = "s"
points = ["ground.S", "arm.B"]
stiffness = 100
free_length = 0
[[torsion_damper]]
name = "d"
bodies = ["ground", "arm"]
coefficient = 0.1
[start]
arm = -1
)",
                        "sprung_arm");
  set_value(e.scene, "spring.s.stiffness", stiffness);
  e.sensors = {test::angle_of(e.scene, "arm", 1e-4)};
  Release turn;
  turn.body = 1;
  turn.value = -0.2;
  e.runs = {test::simulated(100, 300, {turn})};
  return e;
}

void set_unknowns(Experiment& e, const std::vector<std::string>& paths) {
  e.unknowns.clear();
  for (const std::string& path : paths) e.unknowns.push_back(test::unknown(path));
}

// Along  d(m, x, y, J) = (1, -x/m, -y/m, x^2 + y^2) dm  the first moments and the inertia about the pin stay.
TEST(Identifiability, MassCentreAndInertiaOfAnArm) {
  Experiment e = sprung_arm(0);
  const double m = 2, x = 0.25, y = 0.04;
  set_unknowns(e, {"body.arm.mass", "body.arm.center.x", "body.arm.center.y", "body.arm.inertia"});
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.rank, 3);
  EXPECT_EQ(found.structural_nulls, 1);
  EXPECT_EQ(found.other_nulls, 0);
  EXPECT_GT(found.gap, 1e10);
  ASSERT_EQ(found.null_directions.size(), 1U);
  EXPECT_TRUE(found.null_directions[0].structural);
  const double truth[] = {m, x, y, 0.05};
  const double null[] = {1, -x / m, -y / m, x * x + y * y};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(found.identifiable[i]) << i;
    EXPECT_TRUE(std::isinf(found.standard_error[i])) << i;
    EXPECT_NEAR(found.null_directions[0].part[i] * truth[i] / found.null_directions[0].part[0] / truth[0], null[i],
                1e-9);
  }
  // The null curves: m x and J + m (x^2 + y^2) are constant along it, no sum of m, x, y and J is.
  EXPECT_TRUE(found.combinations.empty());
}

// With the centre known  J + m (x^2 + y^2)  is, and a stiffness beside the null is no part of it.
TEST(Identifiability, MassAndInertiaOfAnArmWithoutWeight) {
  Experiment e = sprung_arm(1e3);
  e.scene.gravity = {};
  const double x = 0.25, y = 0.04;
  set_unknowns(e, {"body.arm.mass", "body.arm.inertia", "torsion_damper.d.coefficient"});
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.identifiable, (std::vector<bool>{false, false, true}));
  ASSERT_EQ(found.combinations.size(), 1U);
  const Identifiability::Combination& sum = found.combinations[0];
  EXPECT_NEAR(sum.coefficient[1] / sum.coefficient[0] * (x * x + y * y), 1.0, 1e-9) << sum.words;
  EXPECT_EQ(sum.coefficient[2], 0.0);
  EXPECT_EQ(sum.over, -1);
  const double by = sum.coefficient[static_cast<std::size_t>(sum.unit_of)];
  EXPECT_EQ(by, 1.0);
  EXPECT_NEAR(sum.value, sum.coefficient[0] * 2 + sum.coefficient[1] * 0.05, 1e-12);
  // With the other number known it has the error of the combination.
  Experiment known = e;
  known.unknowns.erase(known.unknowns.begin() + (sum.unit_of == 0 ? 1 : 0));
  const FitProblem smaller(known);
  const Identifiability of_other = assess_at_truth(smaller);
  EXPECT_NEAR(sum.standard_error / of_other.standard_error[0], 1.0, 1e-6);
}

// The moments of spring and weight differ by a factor only. Where the spring is much the stronger, its part in the null
// is small, and it is as unknown as the others.
TEST(Identifiability, ASpringBesideTheMomentOfTheWeight) {
  Experiment e = sprung_arm(1e4);
  set_unknowns(e, {"body.arm.inertia", "body.arm.center.x", "spring.s.stiffness", "torsion_damper.d.coefficient"});
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.rank, 3);
  EXPECT_EQ(found.structural_nulls, 1);
  ASSERT_EQ(found.null_directions.size(), 1U);
  const std::vector<double>& part = found.null_directions[0].part;
  //  g m dx = a h dk,  dJ = -2 m x dx
  EXPECT_NEAR(part[2] * 1e4 / (part[1] * 0.25), 9.81 * 2 / (0.3 * 0.4), 1e-6);
  EXPECT_NEAR(part[0] * 0.05 / (part[1] * 0.25), -2 * 2 * 0.25, 1e-6);
  EXPECT_EQ(part[3], 0.0);
  EXPECT_LT(std::abs(part[2]), 0.03);
  EXPECT_EQ(found.identifiable, (std::vector<bool>{false, false, false, true}));
  EXPECT_NE(found.null_directions[0].words.find("spring.s.stiffness"), std::string::npos)
      << found.null_directions[0].words;
}

// 24 combinations can matter: 23 of the inertial numbers, stiffness and damping, less one, because the free length that
// every equilibrium sets makes a stiffness of the weights.
TEST(Identifiability, AllInertiasOfTheLift) {
  Experiment e = test::experiment("lift_experiment");
  e.unknowns.clear();
  for (const char* body : {"obd", "def", "fa", "cylinder", "rod", "bpc", "ecg", "gl", "platform"}) {
    for (const char* number : {"mass", "inertia", "center.x", "center.y"}) {
      e.unknowns.push_back(test::unknown(std::string("body.") + body + "." + number));
    }
  }
  e.unknowns.push_back(test::unknown("spring.oil.stiffness"));
  e.unknowns.push_back(test::unknown("damper.oil film.coefficient"));
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.structural_nulls, 14);
  EXPECT_EQ(found.other_nulls, 0);
  EXPECT_EQ(found.rank, 24);
  EXPECT_GT(found.gap, 1e6);
  for (std::size_t i = 0; i < 36; ++i) EXPECT_FALSE(found.identifiable[i]) << problem.parameters()[i].name;
}

TEST(Identifiability, ACommonFactorLeavesRatios) {
  const Experiment e = test::oscillator();
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  ASSERT_EQ(found.combinations.size(), 2U);
  const double truth[] = {2, 80, 0.6};
  for (const Identifiability::Combination& combination : found.combinations) {
    ASSERT_GE(combination.over, 0);
    const auto over = static_cast<std::size_t>(combination.over);
    const auto of = static_cast<std::size_t>(combination.unit_of);
    EXPECT_NEAR(combination.value / (truth[of] / truth[over]), 1.0, 1e-9);
    EXPECT_EQ(combination.words, problem.parameters()[of].name + " / " + problem.parameters()[over].name);
    EXPECT_GT(combination.standard_error, 0.0);
    EXPECT_LT(combination.standard_error, 0.1 * combination.value);
  }
}

// A number that is zero has a standard error, and no relative one that it could be judged by.
TEST(Identifiability, ANumberThatIsZero) {
  Experiment e = sprung_arm(100);
  e.sensors[0].noise = 300;
  set_value(e.scene, "torsion_damper.d.coefficient", 0);
  set_unknowns(e, {"torsion_damper.d.coefficient"});
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_GT(found.standard_error[0], 1.0) << "N m s/rad";
  EXPECT_TRUE(std::isfinite(found.standard_error[0]));
  EXPECT_TRUE(found.identifiable[0]);
  EXPECT_FALSE(found.poorly_determined[0]);
  EXPECT_TRUE(found.null_directions.empty());
  for (const double scale : {found.standard_error[0] * 2, found.standard_error[0] * 4}) {
    e.unknowns[0].scale = scale;
    const FitProblem judged(e);
    const Identifiability with_scale = assess_at_truth(judged);
    EXPECT_TRUE(with_scale.identifiable[0]);
    EXPECT_EQ(with_scale.poorly_determined[0], scale < 3 * found.standard_error[0]) << scale;
    EXPECT_EQ(with_scale.null_directions.size(), with_scale.poorly_determined[0] ? 1U : 0U);
  }
}

// Fitted, it is printed with that error, and not told from zero.
TEST(Identifiability, ANumberThatMayBeZero) {
  Experiment e = sprung_arm(100);
  set_value(e.scene, "torsion_damper.d.coefficient", 0);
  set_unknowns(e, {"torsion_damper.d.coefficient", "body.arm.inertia"});
  const FitProblem problem(e);
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable()) << found.why;
  EXPECT_FALSE(found.estimates[0].withheld) << found.estimates[0].why;
  EXPECT_TRUE(found.estimates[0].may_be_zero());
  EXPECT_FALSE(found.estimates[1].may_be_zero());
}

// A damper that the runs never move: a null of these runs, not of the mechanism.
TEST(Identifiability, NullsOfTheRunsAlone) {
  Experiment e;
  e.scene = test::chain(1, 1.0, 2.0);
  test::add_link(e.scene, "other", 1.0, 2.0);
  test::add_pin(e.scene, "ground.O", "other.a");
  for (int i : {1, 2}) {
    e.scene.bodies[static_cast<std::size_t>(i)].inertia = 0.2;
    e.scene.elements.push_back(test::torsion_damper("d" + std::to_string(i), 0, i, 0.3));
    test::add_torsion_spring(e.scene, 0, i, 50.0);
  }
  e.scene.gravity = {};
  e.sensors = {test::angle_of(e.scene, "1", 1e-4)};
  set_unknowns(e, {"torsion_damper.d1.coefficient", "torsion_damper.d2.coefficient"});
  Release turn;
  turn.body = 1;
  turn.value = 0.3;
  e.runs = {test::simulated(100, 300, {turn})};
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  ASSERT_TRUE(found.ok) << found.why;
  EXPECT_EQ(found.structural_nulls, 0);
  EXPECT_EQ(found.other_nulls, 1);
  EXPECT_EQ(found.rank, 1);
  EXPECT_EQ(found.identifiable, (std::vector<bool>{true, false}));
  ASSERT_EQ(found.null_directions.size(), 1U);
  EXPECT_FALSE(found.null_directions[0].structural);
  EXPECT_NE(found.null_directions[0].words.find("changes no reading of these runs"), std::string::npos)
      << found.null_directions[0].words;
}

TEST(Identifiability, APriorEndsANull) {
  Experiment e = sprung_arm(100);
  e.scene.gravity = {};
  set_unknowns(e, {"body.arm.mass", "body.arm.inertia"});
  {
    const FitProblem problem(e);
    EXPECT_EQ(assess_at_truth(problem).rank, 1);
  }
  e.unknowns[0].prior = 2.0;
  e.unknowns[0].prior_deviation = 0.01;
  const FitProblem problem(e);
  const Identifiability found = assess_at_truth(problem);
  EXPECT_EQ(found.rank, 2);
  EXPECT_NEAR(found.standard_error[0] / 0.01, 1.0, 1e-6);
  EXPECT_EQ(found.identifiable, (std::vector<bool>{true, true}));
}

TEST(Identifiability, NamesTheRunThatCannotBeComputed) {
  Experiment e = pendulum();
  const FitProblem problem(e);
  const Identifiability found = assess(problem, {std::nan("")}, test::released(problem));
  EXPECT_FALSE(found.ok);
  EXPECT_NE(found.why.find("run \"run\""), std::string::npos) << found.why;
}

// A point that nothing refers to, or that is the only unknown, acts on nothing: a null of its own.
TEST(Identifiability, AnUnknownThatActsOnNothing) {
  Experiment e;
  e.scene = parse_scene(R"(
    gravity = [0, -9.81]
    [ground]
    points = { O = [0, 0] }
    [body.arm]
    points = { O = [0, 0], E = [0.4, 0] }
    mass = 1.5
    center = [0.2, 0]
    inertia = 0.02
    [[pin]]
    points = ["ground.O", "arm.O"]
  )",
                        "arm.toml");
  e.sensors = {test::angle_of(e.scene, "arm", 1e-3)};
  e.unknowns = {test::unknown("point.arm.E.x")};
  Release lift;
  lift.body = 1;
  lift.value = -1.0;
  e.runs = {test::simulated(100, 200, {lift})};
  const FitProblem problem(e);
  const Identifiability known = assess(problem, problem.truths(), test::released(problem));
  ASSERT_TRUE(known.ok) << known.why;
  EXPECT_EQ(known.rank, 0);
  EXPECT_FALSE(known.identifiable[0]);
  EXPECT_TRUE(std::isinf(known.standard_error[0]));
  const Fit found = fit(problem, problem.records());
  ASSERT_EQ(found.estimates.size(), 1U);
  EXPECT_TRUE(found.estimates[0].withheld);
}

// A dimension of a loop that the sensor's own coordinate does not depend on: the readings change by it through the
// motion alone, and what rounding leaves of the rest is no effect beside which that would count as an error.
TEST(Identifiability, ADimensionThatReadingsDependOnThroughTheMotionAlone) {
  for (const std::string path : {"point.def.D.y", "point.def.F.y"}) {
    const Experiment e = parse_experiment(
        "scene = \"lift.toml\"\n[[sensor]]\nname = \"s\"\nangle = \"fa\"\nnoise = 1e-4\n"
        "[[unknown]]\npath = \"" +
            path + "\"\n[[run]]\nrelease = { fa = 0.005 }\nduration = 0.2\nrate = 100\n",
        test::dataset("lift_dimension.toml"));
    const FitProblem problem(e);
    const Identifiability found = assess_at_truth(problem);
    ASSERT_TRUE(found.ok) << found.why;
    EXPECT_EQ(found.rank, 1) << path;
    EXPECT_LT(found.standard_error[0], 1e-3) << path;
  }
}

}  // namespace
}  // namespace poise::identifiability_test
