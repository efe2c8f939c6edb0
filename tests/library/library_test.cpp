// <poise/poise.hpp> alone reaches every kind of analysis: one small scene with a known answer for each.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <poise/poise.hpp>

namespace {

using namespace poise;
using std::numbers::pi;

constexpr double mass = 2.0, gravity = 10.0, center = 0.5, length = 1.0;
constexpr double moment_of_weight = mass * gravity * center;  // of the arm lying level, N m

// An arm that hangs from a pin, with a level force at its end.
Scene hanging_arm(double force) {
  SceneBuilder builder("arm");
  builder.gravity({0, -gravity})
      .ground_point("O", {0, 0})
      .body("arm", {.points = {{"O", {0, 0}}, {"E", {length, 0}}}, .mass = mass, .center = {center, 0}})
      .pin("ground.O", "arm.O", "O")
      .force("P", "arm.E", {force, 0})
      .start("arm", -1.2);
  return builder.build();
}

// Its angle in equilibrium.
double angle_under(double force) { return -pi / 2 + std::atan(force * length / moment_of_weight); }

// A block on a rail between two springs of 50 N/m, which oscillates as cos(5 t).
Scene sprung_block() {
  SceneBuilder builder("block");
  builder.ground_point("O", {0, 0})
      .ground_point("A", {-5, 0})
      .body("block", {.points = {{"C", {0, 0}}}, .mass = mass})
      .slide("ground.O", "block.C", {1, 0}, "rail")
      .element("spring", "k", measures::distance("ground.A", "block.C"), {{"stiffness", 50}, {"free_length", 5}});
  return builder.build();
}

// A wheel that a motor turns.
Scene driven_wheel() {
  SceneBuilder builder("wheel");
  builder.gravity({0, -gravity})
      .ground_point("O", {0, 0})
      .body("wheel",
            {.points = {{"O", {0, 0}}, {"E", {length, 0}}}, .mass = mass, .center = {center, 0}, .inertia = 0.5})
      .pin("ground.O", "wheel.O", "O")
      .drive("motor", measures::angle("ground", "wheel"), {{"rate", 3}});
  return builder.build();
}

// A block on a vertical rail, held up by a spring beside it of the length sqrt(1 + y^2): it snaps through under
// k (L^(2/3) - 1)^(3/2) with the free length L.
Scene snapping_block() {
  SceneBuilder builder("truss");
  builder.ground_point("O", {0, 0})
      .ground_point("A", {1, 0})
      .body("block", {.points = {{"C", {0, 0}}}})
      .slide("ground.O", "block.C", {0, 1}, "rail")
      .element("spring", "k", measures::distance("ground.A", "block.C"), {{"stiffness", 100}, {"free_length", 1.2}})
      .force("P", "block.C", {0, -1})
      .start("rail", 0.6);
  return builder.build();
}

double snap_load(double free_length) { return 100 * std::pow(std::pow(free_length, 2.0 / 3) - 1, 1.5); }

TEST(Library, SolvesAndCertifies) {
  const NamedEquilibrium found = solve(hanging_arm(10));
  ASSERT_TRUE(found.found());
  EXPECT_EQ(found.result().certificate.stability, Stability::stable);
  EXPECT_NEAR(found.angle("arm"), angle_under(10), 1e-12);
  EXPECT_NEAR(found.reaction("O").force.x, -10, 1e-12);
  EXPECT_NEAR(found.reaction("O").force.y, mass * gravity, 1e-12);
  const StaticModel model(hanging_arm(10));
  EXPECT_TRUE(certify(model, model.from_si({angle_under(10)})).confirmed());
}

TEST(Library, SettlesOnItsWay) {
  const StaticModel model(hanging_arm(0));
  const Settling settling = settle(model, model.start());
  EXPECT_EQ(settling.end, Settling::End::settled);
  EXPECT_NEAR(settling.x.front(), -pi / 2, 1e-9);
}

TEST(Library, FindsAllEquilibria) {
  const EquilibriumSet all = all_equilibria(StaticModel(hanging_arm(0)));
  EXPECT_EQ(all.claim, Claim::complete);
  ASSERT_EQ(all.equilibria.size(), 2U);
}

TEST(Library, FollowsAPathAndReadsIt) {
  const VariedScene varied(hanging_arm(1), "load.P", 1, 20);
  const Path found = path(varied);
  ASSERT_EQ(found.status, Path::Status::traced);
  PathReader reader(varied);
  const SoughtQuantity angle = find_quantity(varied.scene(), "arm");
  for (const PathPoint& point : found.branches.front().points) {
    EXPECT_NEAR(reader.value(angle, point), angle_under(point.parameter), 1e-12);
  }
  const OverPathValue most = over_path(varied, found.branches.front(), find_quantity(varied.scene(), "max(angle.arm)"));
  EXPECT_NEAR(most.value, angle_under(20), 1e-9);
}

TEST(Library, FollowsFolds) {
  const VariedPair pair(snapping_block(), {"load.P", 0.5, 6}, {"spring.k.free_length", 1.1, 1.2});
  const FoldCurve folds = fold_curve(pair);
  ASSERT_EQ(folds.status, FoldCurve::Status::traced) << folds.why;
  ASSERT_FALSE(folds.curves.empty());
  for (const FoldPoint& point : folds.curves.front().points) {
    EXPECT_NEAR(point.first, snap_load(point.second), 1e-9);
  }
}

TEST(Library, FindsWhatFrictionHolds) {
  SceneBuilder builder("rough");
  builder.gravity({0, -gravity})
      .ground_point("O", {0, 0})
      .body("block", {.points = {{"C", {0, 0}}}, .mass = mass})
      .slide("ground.O", "block.C", {1, 0}, "rail")
      .friction({{"coefficient", 0.3}})
      .force("P", "block.C", {1, 0});
  const StaticModel model(builder.build());
  const std::vector<double> x = assemble(model);
  EXPECT_EQ(held_pose(model, x).verdict, Holding::held);
  const HeldRange range = held_range(model, x, "load.P");
  EXPECT_EQ(range.lower.value, 0.0);  // the size of a force
  EXPECT_NEAR(range.upper.value, 6, 1e-9);
}

TEST(Library, DerivesByNumbersAndStudiesTolerances) {
  const StaticModel model(hanging_arm(10));
  const SoughtQuantity angle = find_quantity(model.scene(), "angle.arm");
  const Sensitivities found = sensitivities(model, {angle});
  const double slope = length * moment_of_weight / (std::pow(moment_of_weight, 2) + std::pow(10 * length, 2));
  bool is_known = false;
  for (const Sensitivity& by : found.of.front().by) {
    if (by.number != "load.P") continue;
    is_known = true;
    EXPECT_NEAR(by.derivative, slope, 1e-12);
  }
  EXPECT_TRUE(is_known);
  const std::vector<Tolerance> tolerances = parse_tolerances("[tolerances]\n\"load.P\" = 0.2\n", "t", model.scene());
  const ToleranceStudy study = tolerance_study(model, tolerances, {angle}, {.samples = 500, .jobs = 1});
  EXPECT_NEAR(study.of.front().sigma, slope * 0.2 / std::sqrt(3.0), 1e-9);
}

TEST(Library, TracksAnEquilibrium) {
  TrackedEquilibrium tracked(hanging_arm(5));
  EXPECT_EQ(tracked.change(hanging_arm(8)).kind, Transition::Kind::followed);
  EXPECT_NEAR(tracked.model().to_si(tracked.equilibrium().x).front(), angle_under(8), 1e-12);
}

TEST(Library, FindsForcesInLinks) {
  SceneBuilder builder("beam");
  builder.ground_point("A", {0, 0})
      .ground_point("B", {2, 0})
      .body("beam", {.points = {{"A", {0, 0}}, {"M", {1, 0}}, {"B", {2, 0}}}})
      .section("beam", {{"profile", "rectangle 0.05x0.1"}, {"modulus", 210e9}}, {"A", "M", "B"})
      .pin("ground.A", "beam.A")
      .pin_in_slot("ground.B", "beam.B", {1, 0})
      .force("P", "beam.M", {0, -1000});
  const StaticModel model(builder.build());
  const Equilibrium found = solve_or_hold(model);
  const std::vector<LinkLoads> loads = link_loads(model.scene(), model.poses(found.x), found.check);
  ASSERT_EQ(loads.size(), 1U);
  EXPECT_EQ(loads.front().why, "");
  EXPECT_NEAR(std::abs(loads.front().moment.value), 1000 * 2.0 / 4, 1e-9);
}

TEST(Library, CountsFreedoms) { EXPECT_EQ(analyse_mobility(StaticModel(hanging_arm(1))).freedoms, 1); }

TEST(Library, DrivesKinematics) {
  const Scene scene = driven_wheel();
  const KinematicsResult found = sweep(scene, {{"wheel", 0, 2}}, {.steps = 4});
  ASSERT_TRUE(found.complete);
  ASSERT_EQ(found.samples.size(), 5U);
  const NamedPose last(scene, poses_of(found.samples.back().bodies));
  EXPECT_NEAR(last.point("wheel.E").x, std::cos(2.0), 1e-12);
  EXPECT_NEAR(last.point("wheel.E").y, std::sin(2.0), 1e-12);
}

TEST(Library, SimulatesAndKnowsItsModes) {
  const MotionModel model(sprung_block());
  const double frequency = std::sqrt(50 / mass);
  const Modes modes = modes_of(model, model.start());
  ASSERT_EQ(modes.vibrations.size(), 1U);
  EXPECT_NEAR(modes.vibrations.front().frequency, frequency / (2 * pi), 1e-12);
  const MotionState start = start_motion(model, {{0, false, 0.1}});
  const Motion motion = simulate(model, start, {.duration = 3.0});
  ASSERT_TRUE(motion.completed()) << motion.why;
  EXPECT_NEAR(motion.trajectory.q.back(), 0.1 * std::cos(3 * frequency), 1e-9);
  QuantitiesAlong along(model.scene(), model, motion);
  const SoughtQuantity kinetic = find_quantity(model.scene(), "energy.kinetic", AskedOf::motion);
  EXPECT_NEAR(along.value(kinetic, 1.0), 50 * std::pow(0.1 * std::sin(frequency), 2) / 2, 1e-9);
}

TEST(Library, FindsForcesInMotion) {
  const MotionModel model(driven_wheel());
  EXPECT_NEAR(forces_in_place(model).poses.front().drives.front().value, moment_of_weight, 1e-9);
  const ForcesAlong over = forces_over(model, {{"wheel", 0, pi / 3}}, {.steps = 2}, true);
  EXPECT_NEAR(over.poses.back().drives.front().value, moment_of_weight * std::cos(pi / 3), 1e-9);
  EXPECT_NEAR(fluctuation_over(model, {"wheel", 0, 2 * pi}, {.rate = 5.0}).swing, 2 * moment_of_weight, 1e-8);
  const SoughtQuantity torque = find_quantity(model.scene(), "force.drive");
  EXPECT_NEAR(driven_quantities(model.scene(), over.poses.back(), {torque}).front().value,
              moment_of_weight * std::cos(pi / 3), 1e-9);
  // a = t^2, so that the motor accelerates an inertia of 0.5 + 2 0.5^2 by 2 rad/s^2 too.
  std::vector<double> time;
  SampledCoordinate angle;
  for (int k = 0; k <= 10; ++k) {
    time.push_back(0.1 * k);
    angle.value.push_back(time.back() * time.back());
  }
  const ForcesAlong along = forces_along(model, time, complete_motion(model, time, {angle}));
  ASSERT_EQ(along.poses.size(), time.size());
  EXPECT_NEAR(along.poses[5].drives.front().value, moment_of_weight * std::cos(0.25) + 2.0, 1e-8);
  const std::vector<ForceCourse> courses = force_courses(model.scene(), along);
  EXPECT_EQ(courses.front().name, "effort.motor");
}

TEST(Library, FindsDimensions) {
  const DesignProblem problem = read_design(POISE_SOURCE_DIR "/datasets/lift_design.toml");
  const DesignResult found = design(problem);
  EXPECT_TRUE(found.met);
  EXPECT_TRUE(check_design(problem, found).met);
}

TEST(Library, FindsNumbersForGoals) {
  const char* const file = POISE_SOURCE_DIR "/datasets/wall_bed_design.toml";
  ASSERT_EQ(kind_of_design(file), DesignKind::goals);
  const GoalProblem problem = read_goals(file);
  EXPECT_FALSE(check_goals(problem, problem.scene, {}).met);
  const GoalDesign found = design_for_goals(problem);
  ASSERT_EQ(found.status, GoalDesign::Status::met) << found.why;
  EXPECT_TRUE(check_goals(problem, *found.scene, found.point.rows).met);
}

// A wheel on a torsion spring of 20 N m/rad.
class LibraryExperiment : public testing::Test {
 protected:
  // A folder for each test, since tests run side by side.
  LibraryExperiment()
      : folder_(std::filesystem::path(testing::TempDir()) /
                (std::string("poise_library_test_") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
    write("scene.toml", R"(
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
      name = "air"
      bodies = ["ground", "wheel"]
      coefficient = 0
    )");
  }
  ~LibraryExperiment() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  Experiment experiment(const std::string& more = "") const {
    return read_experiment(write("experiment.toml", R"(
      scene = "scene.toml"
      [[sensor]]
      name = "angle"
      angle = "wheel"
      noise = 1e-4
      [[unknown]]
      path = "torsion_spring.coil.stiffness"
      name = "k"
      [[run]]
      release = { wheel = 0.3 }
      duration = 0.5
      rate = 100
      seed = 1
    )" + more));
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(LibraryExperiment, IdentifiesAndChecksItself) {
  const Identification found = identify(experiment(), {.profiles = {"k"}, .bootstrap = 20});
  ASSERT_EQ(found.fit.status, FitStatus::converged) << found.fit.why;
  const Estimate& k = found.estimate("k");
  EXPECT_GT(k.standard_error, 0.0);
  EXPECT_LT(std::abs(k.value - 20), 5 * k.standard_error);
  EXPECT_EQ(found.profiles.size(), 1U);
  EXPECT_TRUE(found.bootstrap.has_value());
  const Experiment own = experiment();
  const FitProblem problem(own);
  const MonteCarlo trials = monte_carlo(problem, {.trials = 5});
  EXPECT_EQ(trials.converged, 5);
}

TEST_F(LibraryExperiment, ComparesModels) {
  const Experiment plain = experiment();
  const Experiment damped = experiment("[[unknown]]\npath = \"torsion_damper.air.coefficient\"\n");
  const FitProblem simple(plain), full(damped);
  const ModelComparison found = compare_models({&simple, &full});
  ASSERT_EQ(found.tests.size(), 1U);
  EXPECT_EQ(found.tests.front().added, 1);
  EXPECT_GT(found.tests.front().p, 1e-3) << "there is no damping";
}

// The longest run is the best.
TEST_F(LibraryExperiment, PlansRuns) {
  const Experiment own = experiment("[plan]\nruns = 1\n[[plan.vary]]\nwhat = \"duration\"\nmin = 0.5\nmax = 1.5\n");
  const FitProblem problem(own);
  const ExperimentText text(own, {});
  const Plan plan = plan_runs(problem, text);
  ASSERT_EQ(plan.runs.size(), 1U) << plan.why;
  EXPECT_NEAR(text.duration(plan.runs.front()), 1.5, 1e-6);
  EXPECT_LT(plan.steps.back().worst, plan.own.worst);
}

}  // namespace
