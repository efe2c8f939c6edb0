// Drives of measures that are no coordinates: lengths, places, relative angles, components.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "model/input_error.hpp"
#include "model/named_measures.hpp"
#include "motion/forces_along.hpp"
#include "motion/kinematics.hpp"
#include "motion/simulate.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/paths/path.hpp"
#include "tests/support/every_measure.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/random_linkages.hpp"
#include "tests/support/seed.hpp"

namespace poise::driven_measures_test {
namespace {

using std::numbers::pi;
using test::dataset;

// A swing arm about O, and a damper from its point A, r from O, to B, b along x from O. A mass at its tip.
constexpr double r = 0.3, b = 0.5, tip = 0.45, mass = 12.0, inertia = 0.2, resistance = 150.0, g = 9.81;

Scene swing_arm() {
  return parse_scene(R"(
title = "swing arm"
source = "ours"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0], B = [0.5, 0] }
[body.arm]
points = { O = [0, 0], A = [0.3, 0] }
mass = 12
inertia = 0.2
center = [0.45, 0]
[[pin]]
name = "O"
points = ["ground.O", "arm.O"]
[[damper]]
name = "shock"
points = ["ground.B", "arm.A"]
coefficient = 150
[start]
arm = 1.2
)",
                     "swing_arm.toml");
}

double angle_at(double length) { return std::acos((r * r + b * b - length * length) / (2 * r * b)); }

std::string refusal(const Scene& scene, const std::vector<DriveRange>& drives) {
  try {
    sweep(scene, drives);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Law of cosines: L^2 = r^2 + b^2 - 2 r b cos q, and its derivatives.
TEST(DrivenMeasures, ALengthDrivesAnArmByTheLawOfCosines) {
  SweepOptions options;
  options.steps = 20;
  options.rate = 0.4;
  const KinematicsResult found = sweep(swing_arm(), {{"length.shock", 0.35, 0.7}}, options);
  ASSERT_TRUE(found.complete) << found.why;
  ASSERT_EQ(found.samples.size(), 21U);
  for (const KinematicSample& at : found.samples) {
    const double L = at.drive[0], q = angle_at(L);
    const double slope = r * b * std::sin(q) / L;  // dL/dq
    const double bend = r * b * std::cos(q) / L - std::pow(r * b * std::sin(q), 2) / std::pow(L, 3);
    const double rate = 0.4 / slope;
    EXPECT_NEAR(at.drive_rate[0], 0.4, 1e-14);
    EXPECT_NEAR(at.bodies[1].pose.angle, q, 1e-12);
    EXPECT_NEAR(at.bodies[1].rate, rate, 1e-11);
    EXPECT_NEAR(at.bodies[1].angular_acceleration, -bend * rate * rate / slope, 1e-9);
  }
}

// F dL/dq = (I + m t^2) q'' + m g t cos q + c L' dL/dq, and standing still the second term alone.
TEST(DrivenMeasures, TheEffortOfALengthDoesTheWorkOfTheArm) {
  Scene scene = swing_arm();
  scene.drives = {find_drive(scene, "length.shock")};
  const MotionModel model(scene);
  for (const bool moving : {false, true}) {
    SweepOptions options;
    options.steps = 10;
    options.rate = 0.4;
    const ForcesAlong found = forces_over(model, {{"length.shock", 0.4, 0.7}}, options, moving);
    ASSERT_TRUE(found.complete) << found.why;
    EXPECT_TRUE(found.balanced());
    EXPECT_EQ(found.along, "length.shock");
    for (std::size_t k = 0; k < found.at.size(); ++k) {
      const double L = found.at[k], q = angle_at(L), slope = r * b * std::sin(q) / L;
      const double bend = r * b * std::cos(q) / L - std::pow(r * b * std::sin(q), 2) / std::pow(L, 3);
      const double rate = moving ? 0.4 / slope : 0.0, acceleration = -bend * rate * rate / slope;
      const double force = ((inertia + mass * tip * tip) * acceleration + mass * g * tip * std::cos(q)) / slope +
                           resistance * (moving ? 0.4 : 0.0);
      const DriveEffort& effort = found.poses[k].drives[0];
      EXPECT_FALSE(effort.is_angle);
      EXPECT_NEAR(effort.value, force, 1e-8 * (1 + std::abs(force))) << L;
      EXPECT_LE(found.poses[k].power.error, 1e-9);
    }
  }
  const std::vector<ParallelElement> parallel = parallel_elements(model, scene.drives);
  ASSERT_EQ(parallel.size(), 1U) << "the damper acts on what is driven";
}

// The same by a [[drive]] in a motion: at every node the arm is where the length puts it, by the force that this takes.
TEST(DrivenMeasures, ALengthMovesAnArmInTime) {
  Scene scene = swing_arm();
  Drive drive = find_drive(scene, "length.shock");
  drive.start = 0.4;
  drive.rate = 0.4;
  scene.drives = {drive};
  const MotionModel model(scene);
  MotionOptions options;
  options.duration = 0.6;
  const Motion motion = simulate(model, start_motion(model, {}), options);
  ASSERT_TRUE(motion.completed()) << motion.why;
  EXPECT_LE(motion.energy_error, 1e-9);
  for (std::size_t node = 0; node < motion.trajectory.nodes(); ++node) {
    const double L = 0.4 + 0.4 * motion.trajectory.t[node], q = angle_at(L), slope = r * b * std::sin(q) / L;
    const double bend = r * b * std::cos(q) / L - std::pow(r * b * std::sin(q), 2) / std::pow(L, 3);
    const double rate = 0.4 / slope, acceleration = -bend * rate * rate / slope;
    const double force =
        ((inertia + mass * tip * tip) * acceleration + mass * g * tip * std::cos(q)) / slope + resistance * 0.4;
    EXPECT_NEAR(motion.trajectory.q[node], q, 1e-9);
    EXPECT_NEAR(motion.trajectory.v[node], rate, 1e-8);
    EXPECT_NEAR(motion.drive_force[0][node], force, 1e-7 * (1 + std::abs(force)));
  }
}

// Arm and damper are in line where its length is r + b, beyond which nothing drives it.
TEST(DrivenMeasures, ALengthHasItsDeadCentreWhereTheArmIsInLine) {
  const KinematicsResult found = sweep(swing_arm(), {{"length.shock", 0.6, 0.9}});
  EXPECT_FALSE(found.complete);
  ASSERT_EQ(found.singular.size(), 1U);
  EXPECT_EQ(found.singular[0].kind, SingularPose::Kind::dead_centre);
  EXPECT_NEAR(found.singular[0].drive[0], r + b, 1e-10);
  EXPECT_EQ(found.singular[0].text, "dead centre of \"length.shock\": arm can move while the drives are fixed");
  Scene scene = swing_arm();
  scene.drives = {find_drive(scene, "length.shock")};
  const ForcesAlong forces = forces_over(MotionModel(scene), {{"length.shock", 0.6, 0.9}}, {}, false);
  ASSERT_EQ(forces.dead_points.size(), 1U);
  EXPECT_NEAR(forces.dead_points[0][0], r + b, 1e-10);
}

constexpr double crank = 0.1, rod = 0.25;

Scene slider_crank() {
  return parse_scene(R"(
title = "slider-crank"
source = "ours"
[ground]
points = { O = [0, 0] }
[body.crank]
points = { O = [0, 0], B = [0.1, 0] }
[body.rod]
points = { B = [0, 0], C = [0.25, 0] }
[body.ram]
points = { C = [0, 0] }
[[pin]]
points = ["ground.O", "crank.O"]
[[pin]]
points = ["crank.B", "rod.B"]
[[pin]]
name = "C"
points = ["rod.C", "ram.C"]
[[slide]]
name = "rail"
points = ["ground.O", "ram.C"]
axis = [1, 0]
[[force]]
name = "P"
at = "ram.C"
vector = [-40, 7]
[start]
crank = 1.05
rod = -0.35
rail = 0.28
)",
                     "slider_crank.toml");
}

TEST(DrivenMeasures, APlaceDrivesASliderCrank) {
  const KinematicsResult found = sweep(slider_crank(), {{"x.ram.C", 0.2, 0.34}}, {.steps = 14});
  ASSERT_TRUE(found.complete) << found.why;
  for (const KinematicSample& at : found.samples) {
    const double x = at.drive[0];
    EXPECT_NEAR(at.bodies[1].pose.angle, std::acos((x * x + crank * crank - rod * rod) / (2 * x * crank)), 1e-11);
  }
  // The same as its travel, and as the component along x.
  const KinematicsResult travel = sweep(slider_crank(), {{"rail", 0.2, 0.34}}, {.steps = 14});
  const KinematicsResult along = sweep(slider_crank(), {{"along.ram.C.0", 0.2, 0.34}}, {.steps = 14});
  for (std::size_t k = 0; k < found.samples.size(); ++k) {
    for (std::size_t i = 0; i < found.coordinates.size(); ++i) {
      EXPECT_NEAR(found.samples[k].q[i], travel.samples[k].q[i], 1e-11);
      EXPECT_NEAR(found.samples[k].rate[i], travel.samples[k].rate[i], 1e-9);
      EXPECT_NEAR(found.samples[k].acceleration[i], travel.samples[k].acceleration[i], 1e-7);
      EXPECT_NEAR(along.samples[k].q[i], travel.samples[k].q[i], 1e-11);
    }
  }
  Scene scene = slider_crank();
  scene.drives = {find_drive(scene, "x.ram.C")};
  const ForcesAlong forces = forces_over(MotionModel(scene), {{"x.ram.C", 0.2, 0.34}}, {.steps = 7}, false);
  for (const Forces& one : forces.poses) EXPECT_NEAR(one.drives[0].value, 40.0, 1e-10);
  const KinematicsResult beyond = sweep(slider_crank(), {{"x.ram.C", 0.3, 0.4}});
  ASSERT_EQ(beyond.singular.size(), 1U);
  EXPECT_NEAR(beyond.singular[0].drive[0], crank + rod, 1e-10);
}

Scene two_links() {
  return parse_scene(R"(
title = "two links"
source = "ours"
gravity = [0, -10]
[ground]
points = { O = [0, 0] }
[body.upper]
points = { O = [0, 0], A = [0.4, 0] }
[body.lower]
points = { A = [0, 0], T = [0.3, 0] }
mass = 2
center = [0.3, 0]
[[pin]]
points = ["ground.O", "upper.O"]
[[pin]]
points = ["upper.A", "lower.A"]
[start]
upper = 0.35
lower = 0.87
)",
                     "two_links.toml");
}

TEST(DrivenMeasures, ARelativeAngleIsNotTheAbsoluteOne) {
  const double degree = pi / 180;
  SweepOptions options;
  options.steps = 6;
  const std::vector<DriveRange> ranges{{"upper", 20 * degree, 80 * degree},
                                       {"angle.lower.upper", 30 * degree, 60 * degree}};
  const KinematicsResult found = sweep(two_links(), ranges, options);
  ASSERT_TRUE(found.complete) << found.why;
  for (std::size_t k = 0; k < found.samples.size(); ++k) {
    const KinematicSample& at = found.samples[k];
    const double part = static_cast<double>(k) / 6, upper = (20 + 60 * part) * degree;
    EXPECT_NEAR(at.bodies[1].pose.angle, upper, 1e-12);
    EXPECT_NEAR(at.bodies[2].pose.angle, upper + (30 + 30 * part) * degree, 1e-12);
    EXPECT_NEAR(at.bodies[2].rate, 1.5, 1e-12) << "the first drive turns at 1 rad/s";
  }
  EXPECT_EQ(drive_in_words(two_links(), "lower"), "angle of lower in the world");
  EXPECT_EQ(drive_in_words(two_links(), "angle.lower.upper"), "angle of lower relative to upper");
  // A torque between the links pushes the upper one back; one from the ground does not.
  for (const bool relative : {false, true}) {
    Scene scene = two_links();
    scene.drives = {find_drive(scene, "upper"), find_drive(scene, relative ? "angle.lower.upper" : "lower")};
    const MotionModel model(scene);
    const Forces forces = forces_of(model, model.from_si({20 * degree, 50 * degree}), {0, 0}, {0, 0}, scene.drives);
    const double of_lower = 20 * 0.3 * std::cos(50 * degree), of_upper = 20 * 0.4 * std::cos(20 * degree);
    EXPECT_NEAR(forces.drives[1].value, of_lower, 1e-12);
    EXPECT_NEAR(forces.drives[0].value, relative ? of_upper + of_lower : of_upper, 1e-12);
  }
}

TEST(DrivenMeasures, AreRefusedWhereTheyDoNotFit) {
  const Scene arm = swing_arm();
  EXPECT_NE(refusal(arm, {{"length.shok", 0.3, 0.4}}).find("did you mean \"shock\"?"), std::string::npos);
  EXPECT_NE(refusal(arm, {{"length.shock", -0.3, 0.4}}).find("expected a finite number >= 0, found -0.3"),
            std::string::npos);
  EXPECT_NE(refusal(arm, {{"x.arm.O", 0, 0.4}}).find("the same in every position"), std::string::npos);
  EXPECT_NE(refusal(slider_crank(), {{"y.ram.C", 0, 0.1}}).find("stays the same, or follows from other drives"),
            std::string::npos);
  EXPECT_NE(refusal(two_links(), {{"angle.lower.upper", 0, 1}, {"angle.upper.lower", 0, 1}}).find("other drives"),
            std::string::npos);
  Scene in_line = slider_crank();
  in_line.start.angle[1] = in_line.start.angle[2] = 0.0;
  in_line.start.travel[3] = crank + rod;
  EXPECT_NE(refusal(in_line, {{"x.ram.C", 0.3, 0.34}}).find("the start is a singular position"), std::string::npos);
  EXPECT_NE(refusal(arm, {{"length.shock", 0.4, 0.5}, {"arm", 1, 2}}).find("expected 1 of them"), std::string::npos);
  EXPECT_NE(refusal(two_links(), {{"angle.lower.upper", 0, 1}}).find("1 degree of freedom is undriven"),
            std::string::npos);
}

// The negative of a body's angle has a row of its own, and moves the mechanism as the angle does, which is a
// coordinate.
TEST(DrivenMeasures, ARowDrivesAsACoordinateDoes) {
  int compared = 0;
  for (const std::string& name : test::scene_names()) {
    const Scene scene = read_scene(dataset(name));
    if (scene.bodies.size() > 12) continue;
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      const std::string body = scene.bodies[i].name, opposite = "angle." + scene.bodies[0].name + "." + body;
      const double from = scene.start.angle[i].value_or(0.0);
      if (!refusal(scene, {{body, from, from}}).empty()) continue;  // several freedoms, or none
      SweepOptions options;
      options.steps = 5;
      const KinematicsResult own = sweep(scene, {{body, from, from + 0.2}}, options);
      const KinematicsResult row = sweep(scene, {{opposite, -from, -from - 0.2}}, options);
      ASSERT_EQ(own.complete, row.complete) << name << " " << body << ": " << own.why << "; " << row.why;
      ASSERT_EQ(own.samples.size(), row.samples.size()) << name << " " << body;
      for (std::size_t k = 0; k < own.samples.size(); ++k) {
        const KinematicSample &a = own.samples[k], &c = row.samples[k];
        if (std::min(a.closeness_to_singular, c.closeness_to_singular) < 1e-3) continue;
        ++compared;
        for (std::size_t q = 0; q < a.q.size(); ++q) {
          EXPECT_NEAR(a.q[q], c.q[q], 1e-9 * (1 + std::abs(a.q[q]))) << name << " " << body;
          EXPECT_NEAR(a.rate[q], c.rate[q], 1e-7 * (1 + std::abs(a.rate[q]))) << name << " " << body;
          EXPECT_NEAR(a.acceleration[q], c.acceleration[q], 1e-5 * (1 + std::abs(a.acceleration[q])))
              << name << " " << body;
        }
      }
    }
  }
  EXPECT_GT(compared, 50);
}

// Kinematics drives the measures of random linkages through the poses in which a path holds them.
TEST(DrivenMeasures, HaveThePosesOfThePathOnWhichTheyVary) {
  int compared = 0;
  for (std::uint64_t seed = test::seed(1); seed < test::seed(4); ++seed) {
    for (const std::string& kind : test::linkage_kinds()) {
      const Scene scene = test::random_linkage(kind, seed, {});
      const double angle = scene.start.angle[1].value_or(0.0);
      const KinematicsResult here = sweep(scene, {{scene.bodies[1].name, angle, angle}});
      if (here.samples.empty()) continue;
      const std::vector<BodyPose<double>> poses = poses_of(here.samples[0].bodies);
      for (const NamedMeasure& measure : named_measures(scene)) {
        const double value = value_of(scene, measure.on, poses),
                     rate = rate_of(scene, here.samples[0].bodies, measure.on);
        if (std::abs(rate) < 0.1) continue;  // near its dead centre
        const double to = value + 0.03 * rate, unit = measure.on.dimension().unit(scene.units);
        const KinematicsResult driven = sweep(scene, {{measure.name, value, to}}, {.steps = 2});
        if (!driven.complete) continue;
        const VariedScene varied(scene, measure.name, value / unit, to / unit);
        PathOptions options;
        options.from = PathOptions::From::equilibrium;
        options.at = {driven.samples[1].drive[0]};
        const Path found = path(varied, options);
        ASSERT_EQ(found.wanted.size(), 1U) << kind << seed << measure.name;
        ASSERT_FALSE(found.wanted[0].empty()) << kind << seed << measure.name;
        const PathPoint& point = found.wanted[0][0];
        const std::vector<BodyPose<double>> held = varied.model_at(point.parameter)->poses(point.x);
        ++compared;
        for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
          EXPECT_NEAR(driven.samples[1].bodies[i].pose.angle, held[i].angle, 1e-9) << kind << seed << measure.name;
        }
      }
    }
  }
  EXPECT_GT(compared, 40);
}

// A [[drive]] on each kind of measure, sums, components, ropes and profiles too: it keeps its course in a motion, by
// the effort that free bodies need with the inertia of that motion.
TEST(DrivenMeasures, OfEveryKindMoveMechanismsInTime) {
  int compared = 0;
  for (std::uint64_t seed = test::seed(1); seed < test::seed(16); ++seed) {
    Scene scene = test::random_linkage("four_bar", seed, {});
    test::Random random(seed);
    auto measures = test::measures_of(scene, random, true);
    for (auto& one : measures) {
      // A random rope may come off its pulleys on the way.
      for (RopeContact& contact : one.measure.contacts) contact.radius = 0.0;
    }
    const double angle = scene.start.angle[1].value_or(0.0);
    const KinematicsResult here = sweep(scene, {{scene.bodies[1].name, angle, angle}});
    const KinematicsResult around = sweep(scene, {{scene.bodies[1].name, angle - 0.02, angle + 0.02}}, {.steps = 8});
    if (here.samples.empty() || !around.complete) continue;
    const std::vector<BodyPose<double>> poses = poses_of(here.samples[0].bodies);
    for (const auto& [name, on] : measures) {
      const auto has_profile = [](const Measure::Term& term) { return term.profile != nullptr; };
      if (std::any_of(on.terms.begin(), on.terms.end(), has_profile)) continue;
      const double value = value_of(scene, on, poses), rate = rate_of(scene, here.samples[0].bodies, on);
      // Away from its dead centres, where nothing drives it on.
      const auto is_steady = [&, &of = on](const KinematicSample& sample) {
        return rate_of(scene, sample.bodies, of) / rate > 0.7;
      };
      const bool moves = std::all_of(around.samples.begin(), around.samples.end(), is_steady);
      if (!(std::abs(rate) > 0.2) || !std::isfinite(value) || !moves) continue;
      Scene driven = scene;
      Drive drive;
      drive.name = "motor";
      drive.on = on;
      drive.rate = 0.05 * rate;
      driven.drives = {drive};
      const MotionModel model(driven);
      MotionOptions options;
      options.duration = 0.05;
      const Motion motion = simulate(model, start_motion(model, {}), options);
      ASSERT_TRUE(motion.completed()) << name << seed << motion.why;
      ++compared;
      for (std::size_t node = 0; node < motion.trajectory.nodes(); ++node) {
        const auto n = static_cast<std::ptrdiff_t>(motion.trajectory.coordinates);
        const auto a = motion.trajectory.a.begin() + static_cast<std::ptrdiff_t>(node) * n;
        const std::vector<double> q = model.from_si(test::q_at(motion, node));
        EXPECT_NEAR(value_of(driven, on, model.poses(q)), value + drive.rate * motion.trajectory.t[node], 1e-8) << name;
        const Forces forces =
            forces_of(model, q, model.from_si(test::v_at(motion, node)), model.from_si({a, a + n}), driven.drives);
        EXPECT_NEAR(motion.drive_force[0][node], forces.drives[0].value, 1e-8 * (1 + forces.largest_force)) << name;
      }
    }
  }
  EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace poise::driven_measures_test
