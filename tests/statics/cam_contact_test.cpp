// Pressure angles and contact forces of cams, against closed forms and against the pitch curve itself.

#include "statics/model/cam_contact.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "motion/forces_along.hpp"
#include "motion/kinematics.hpp"
#include "motion/motion_model.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::cam_contact_test {
namespace {

using std::numbers::pi;

// A cam on the ground at O, a weight of 20 N on a slide through (offset, 0) upwards; `more` in the table of the cam.
std::string sliding(double offset, const std::string& law, const std::string& more = "guided = true") {
  return fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ O = [0, 0], S = [{}, 0] }}
    [body.cam]
    points = {{ O = [0, 0] }}
    [body.follower]
    points = {{ R = [0, 0], T = [0.03, 0.2] }}
    mass = 2
    [[pin]]
    points = ["ground.O", "cam.O"]
    [[slide]]
    name = "guide"
    points = ["ground.S", "follower.R"]
    axis = [0, 1]
    [[cam]]
    name = "lobe"
    bodies = ["ground", "cam"]
    follower = {{ slide = "guide" }}
    {}
    {}
    [start]
    guide = 0.06
  )",
                     offset, law, more);
}

const std::string harmonic = R"(law = [{ to = 3.141592653589793, lift = 1, law = "harmonic" },
      { to = 6.283185307179586, lift = 0, law = "harmonic" }]
    lift = 0.02
    base = 0.05)";

/// The contact of the one cam in a guided sample, without forces.
CamContact contact_in(const Scene& scene, const KinematicSample& sample) {
  const std::vector<CamReading> cams = cam_readings(scene, poses_of(sample.bodies), {});
  return cams.at(0).contact.value();
}

// s = 0.06 - 0.01 cos(phi), exact: tan = (0.01 sin(phi) - e) / s. The effort of the cam's drive is the slope times the
// weight; by the contact force, its moment about the axis.
TEST(CamContact, AHarmonicCamHasItsPressureAngle) {
  for (const double e : {0.0, 0.008, -0.015}) {
    const Scene scene = parse_scene(sliding(e, harmonic), "cam.toml");
    const KinematicsResult swept = sweep(scene, {{.name = "cam", .from = 0.1, .to = 6.0}}, {.steps = 11});
    ASSERT_TRUE(swept.complete) << swept.why;
    for (const KinematicSample& sample : swept.samples) {
      const double phi = sample.drive[0];
      EXPECT_NEAR(std::tan(contact_in(scene, sample).pressure_angle),
                  (0.01 * std::sin(phi) - e) / (0.06 - 0.01 * std::cos(phi)), 1e-12);
    }
    Scene driven = scene;
    driven.drives.push_back(find_drive(scene, "cam"));
    driven.drives.back().name = "cam";
    const MotionModel model(driven);
    const ForcesAlong found = forces_over(model, {{.name = "cam", .from = 0.1, .to = 6.0}}, {.steps = 11}, false);
    ASSERT_EQ(found.poses.size(), 12U);
    for (std::size_t i = 0; i < found.poses.size(); ++i) {
      const Forces& forces = found.poses[i];
      const CamContact contact = cam_readings(driven, poses_of(forces.motions), forces.reactions).at(0).contact.value();
      EXPECT_NEAR(contact.normal * std::cos(contact.pressure_angle), 20.0, 1e-9);
      // On the follower, at (e, s) from the axis; upwards 20 N, to the left `side`.
      const double s = 0.06 - 0.01 * std::cos(found.at[i]);
      EXPECT_NEAR(forces.drives[0].value, e * 20.0 + s * contact.side, 1e-9);
    }
  }
}

// A round cam of radius R of the pitch circle whose centre is c from the axis: the normal passes through that centre.
TEST(CamContact, AnEccentricCircleHasItsNormalThroughItsCentre) {
  const double R = 0.05, c = 0.015, e = 0.01;
  std::string curve;
  constexpr int parts = 360;
  // The centre is at the angle phi from the x axis: s = c sin(phi) + sqrt(R^2 - (e - c cos(phi))^2).
  for (int k = 0; k <= parts; ++k) {
    const double phi = 2 * pi * (k % parts) / parts;
    const double across = e - c * std::cos(phi);
    curve +=
        fmt::format("[{:.17g}, {:.17g}],", 2 * pi * k / parts, c * std::sin(phi) + std::sqrt(R * R - across * across));
  }
  const Scene scene = parse_scene(sliding(e, "curve = [" + curve + "]\nlift = 1\nbase = 0"), "circle.toml");
  const KinematicsResult swept = sweep(scene, {{.name = "cam", .from = 0.3, .to = 6.0}}, {.steps = 13});
  ASSERT_TRUE(swept.complete) << swept.why;
  for (const KinematicSample& sample : swept.samples) {
    const double phi = sample.drive[0];
    EXPECT_NEAR(std::sin(contact_in(scene, sample).pressure_angle), -(e - c * std::cos(phi)) / R, 1e-5);
  }
}

// The pitch curve itself: the roller seen from the cam at angles of it close by.
void expect_normal_of_pitch_curve(const std::string& text, const std::string& driven, PointRef roller, int cam,
                                  const std::string& base) {
  const Scene scene = parse_scene(text, "pitch.toml");
  const double h = 1e-4;
  for (const double at : {0.6, 1.3, 2.3, 4.4}) {
    const KinematicsResult swept = sweep(scene, {{.name = driven, .from = at - h, .to = at + h}}, {.steps = 2});
    ASSERT_TRUE(swept.complete) << swept.why;
    const auto seen = [&](const KinematicSample& sample, int from) {
      const auto poses = poses_of(sample.bodies);
      const BodyPose<double>& pose = poses[static_cast<std::size_t>(from)];
      const Vec2 world = poses[static_cast<std::size_t>(roller.body)].world(scene.local(roller));
      return (world - pose.origin) * conj(pose.direction());
    };
    int on = 0;
    while (scene.bodies[static_cast<std::size_t>(on)].name != base) ++on;
    const auto poses = poses_of(swept.samples[1].bodies);
    const Vec2 curve =
        (seen(swept.samples[2], cam) - seen(swept.samples[0], cam)) * poses[static_cast<std::size_t>(cam)].direction();
    const Vec2 travel =
        (seen(swept.samples[2], on) - seen(swept.samples[0], on)) * poses[static_cast<std::size_t>(on)].direction();
    // The angle between two lines, from that of their tangents.
    const double angle = std::atan(cross(travel, quarter_turn(curve)) / dot(travel, quarter_turn(curve)));
    EXPECT_NEAR(contact_in(scene, swept.samples[1]).pressure_angle, angle, 1e-6) << at;
  }
}

// An arm about a pivot that carries a roller, on a frame that stands or turns; the measures either way round.
std::string turning(const std::string& base, const std::string& cam, const std::string& arm, double lift) {
  return fmt::format(R"(
    [ground]
    points = {{ O = [0, 0], P = [0.1, 0.02], F = [0, 0] }}
    [body.frame]
    points = {{ F = [0, 0], O = [0, 0], P = [0.1, 0.02] }}
    [body.cam]
    points = {{ O = [0, 0] }}
    [body.arm]
    points = {{ P = [0, 0], R = [-0.09, 0.06] }}
    [[weld]]
    points = ["ground.F", "frame.F"]
    angle = 0.3
    [[pin]]
    points = ["{0}.O", "cam.O"]
    [[pin]]
    points = ["arm.P", "{0}.P"]
    [[cam]]
    name = "lobe"
    bodies = {1}
    follower = {{ bodies = {2} }}
    roller = "arm.R"
    law = [{{ to = 2.5, lift = 1, law = "cycloidal" }}, {{ to = 3, law = "dwell" }},
      {{ to = 6.283185307179586, lift = 0, law = "polynomial_345" }}]
    lift = {3}
    base = 0.1
    phase = 0.2
    guided = true
  )",
                     base, cam, arm, lift);
}

TEST(CamContact, IsNormalToThePitchCurve) {
  expect_normal_of_pitch_curve(sliding(0.008, harmonic), "cam", {2, 0}, 1, "ground");
  expect_normal_of_pitch_curve(sliding(0.008, harmonic, "guided = true\nroller = \"follower.T\""), "cam", {2, 1}, 1,
                               "ground");
  for (const std::string base : {"ground", "frame"}) {
    const auto pair = [](const std::string& a, const std::string& b) { return "[\"" + a + "\", \"" + b + "\"]"; };
    expect_normal_of_pitch_curve(turning(base, pair(base, "cam"), pair(base, "arm"), 0.4), "cam", {3, 1}, 2, base);
    expect_normal_of_pitch_curve(turning(base, pair("cam", base), pair(base, "arm"), 0.4), "cam", {3, 1}, 2, base);
    expect_normal_of_pitch_curve(turning(base, pair(base, "cam"), pair("arm", base), 0.4), "cam", {3, 1}, 2, base);
  }
}

// The moment that a spring of the arm gives it, carried by the cam: on the arm the contact force has that moment about
// the pivot, on the cam the one that its holder gives it.
TEST(CamContact, OfAnArmBalancesItsMoment) {
  const std::string text = turning("ground", "[\"ground\", \"cam\"]", "[\"ground\", \"arm\"]", 0.4) + R"(
    [[torque]]
    on = "arm"
    value = -3
    [[torsion_spring]]
    name = "holder"
    bodies = ["ground", "cam"]
    stiffness = 40
    free_angle = 1.5
    [start]
    cam = 1.5
  )";
  const StaticModel model(parse_scene(text, "arm.toml"));
  const Equilibrium found = solve(model, test::by(Method::virtual_work));
  ASSERT_EQ(found.status, Status::confirmed) << found.why;
  const Scene& scene = model.scene();
  const std::vector<BodyPose<double>> poses = model.poses(found.x);
  const CamContact contact = cam_readings(scene, poses, found.check.reactions).at(0).contact.value();
  const Vec2 roller = poses[3].world(scene.local({3, 1})), pivot = poses[3].origin;
  const Vec2 along = direction<double>(quarter_turn(roller - pivot));
  const Vec2 force = contact.normal * (along * unit(contact.pressure_angle));
  EXPECT_NEAR(cross(roller - pivot, force), 3.0, 1e-9);
  EXPECT_NEAR(dot(force, quarter_turn(along)), contact.side, 1e-9);
  EXPECT_NEAR(cross(roller, force), -40 * (poses[2].angle - 1.5), 1e-8);
}

TEST(CamContact, IsNoneOfAFollowerThatHasLiftedOff) {
  const StaticModel model(parse_scene(sliding(0.0, harmonic, R"(
    [[force]]
    at = "follower.T"
    vector = [0, 50]
    [[stop]]
    name = "above"
    slide = "guide"
    max = 0.1
    [[torsion_spring]]
    bodies = ["ground", "cam"]
    stiffness = 1)"),
                                      "cam.toml"));
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_EQ(found.status, Status::confirmed) << found.why;
  const std::vector<CamReading> cams = cam_readings(model.scene(), model.poses(found.x), found.check.reactions);
  ASSERT_EQ(cams.size(), 1U);
  EXPECT_FALSE(cams[0].contact);
}

TEST(CamContact, IsNotMadeUp) {
  const auto count = [](std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return cam_readings(parse_scene(text, "cam.toml"), {}, {}).size();
  };
  // A length in place of a travel, and an arm whose roller is not named.
  EXPECT_EQ(count(sliding(0, harmonic, ""), "{ slide = \"guide\" }", "{ y = \"follower.R\" }"), 0U);
  const std::string arm = turning("ground", "[\"ground\", \"cam\"]", "[\"ground\", \"arm\"]", 0.4);
  EXPECT_EQ(count(arm, "roller = \"arm.R\"", ""), 0U);
  const auto message = [&](const std::string& roller) {
    std::string text = arm;
    text.replace(text.find("arm.R"), 5, roller);
    return test::message_of([&] { parse_scene(text, "cam.toml"); });
  };
  EXPECT_NE(message("cam.O").find("centre of the roller on a follower"), std::string::npos);
  EXPECT_NE(message("ground.O").find("centre of the roller on a follower"), std::string::npos);
  EXPECT_NE(message("arm.Q").find("did you mean"), std::string::npos);
}

}  // namespace
}  // namespace poise::cam_contact_test
