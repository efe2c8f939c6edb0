// Pins in curved slots and wheels that roll on a line, against closed forms.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "model/parameters.hpp"
#include "model/profile.hpp"
#include "model/text_file.hpp"
#include "motion/equilibrium_pose.hpp"
#include "motion/kinematics.hpp"
#include "motion/modes.hpp"
#include "motion/motion_model.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "statics/sensitivity/sensitivity.hpp"
#include "tests/support/contacts.hpp"
#include "tests/support/elements.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"

namespace poise::curved_tracks_test {
namespace {

using std::numbers::pi;
using test::expect_sensitivities;
using test::found_both_ways;
using test::frequency_of;
using test::tolerance;

double size_of(const Check& check, const std::string& name) { return norm(test::reaction_of(check, name).force); }

std::string message_of(const std::string& text) {
  return test::message_of([&] { parse_scene(text, "scene.toml"); });
}

// --- circles --------------------------------------------------------------------------------------------------------

// A bead of weight W on an upright ring, at the angle a from its lowest point, and a spring from the top, which is
// 2 R cos(a / 2) long: 2 W cos(a / 2) = k (2 R cos(a / 2) - L).
TEST(CurvedSlots, ABeadOnARingHangsOnItsSpring) {
  const double R = 0.3, W = 20.0, k = 200.0, L = 0.3;
  const StaticModel model(parse_scene(fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ C = [0.1, 0], top = [0.1, {0}] }}
    [body.bead]
    points = {{ P = [0, 0] }}
    mass = {1}
    [[circular_slot]]
    name = "ring"
    pin = "bead.P"
    center = "ground.C"
    radius = {0}
    [[spring]]
    points = ["ground.top", "bead.P"]
    stiffness = {2}
    free_length = {3}
    [start.position]
    bead = [0.35, -0.1]
  )",
                                                  R, W / 10, k, L),
                                      "ring.toml"));
  EXPECT_EQ(analyse_mobility(model).freedoms, 1);
  const double half = std::acos(k * L / (2 * (k * R - W)));
  for (const Equilibrium& found : found_both_ways(model)) {
    const Vec2 at = test::place_of(model, found.x, "bead.P");
    EXPECT_NEAR(at.x, 0.1 + R * std::sin(2 * half), tolerance(found.method));
    EXPECT_NEAR(at.y, -R * std::cos(2 * half), tolerance(found.method));
    // The ring presses along its radius: W cos(a) less the spring's share.
    const double spring = k * (2 * R * std::cos(half) - L);
    EXPECT_NEAR(size_of(found.check, "ring"), std::abs(W * std::cos(2 * half) - spring * std::cos(half)), 1e-5);
  }
}

// A bead of 20 N in an arc of radius R of a plate that is turned by `tilt`; its ends are at angles in the plate.
std::string arc(double from, double to, double tilt, const std::string& more = "") {
  return fmt::format(R"(
    gravity = [0, -10]
    [units]
    angle = "deg"
    [ground]
    points = {{ C = [0.1, 0.2] }}
    [body.plate]
    points = {{ C = [0.05, 0] }}
    [body.bead]
    points = {{ P = [0, 0] }}
    mass = 2
    [[weld]]
    points = ["ground.C", "plate.C"]
    angle = {2}
    [[circular_slot]]
    name = "arc"
    pin = "bead.P"
    center = "plate.C"
    radius = 0.3
    from = {0}
    to = {1}
    {3}
  )",
                     from, to, tilt, more);
}

// At the end at a the arc carries the weight along its radius, its end along its tangent.
TEST(CurvedSlots, ABeadRestsAtTheEndOfItsArc) {
  for (const auto& [from, to, tilt, rest] : std::vector<std::array<double, 4>>{
           {-60, 30, 0, -60}, {200, 260, 0, 260}, {-90, 0, 40, -50}, {80, 150, 110, 260}}) {
    const Scene scene = parse_scene(arc(from, to, tilt), "arc.toml");
    const StaticModel model(scene);
    EXPECT_EQ(analyse_mobility(model).freedoms, 1);
    const double a = rest * pi / 180;
    const Vec2 radial = unit(a), tangent = quarter_turn(radial), weight{0, -20};
    for (const Equilibrium& found : found_both_ways(model)) {
      const Vec2 at = test::place_of(model, found.x, "bead.P");
      EXPECT_NEAR(at.x, 0.1 + 0.3 * radial.x, tolerance(found.method));
      EXPECT_NEAR(at.y, 0.2 + 0.3 * radial.y, tolerance(found.method));
      const Vec2 slot = test::reaction_of(found.check, "arc").force;
      const Vec2 end = test::reaction_of(found.check, "arc line").force;
      EXPECT_NEAR(norm(slot + dot(weight, radial) * radial), 0.0, 1e-5);
      EXPECT_NEAR(norm(end + dot(weight, tangent) * tangent), 0.0, 1e-5);
      EXPECT_NEAR(std::abs(test::reaction_of(found.check, "arc ends").moment), 0.3 * norm(end), 1e-5);
      EXPECT_EQ(test::reaction_of(found.check, "arc ends").kind, "circular_slot_ends");
    }
  }
}

TEST(CurvedSlots, ABeadSwingsInItsArc) {
  const Scene scene = parse_scene(arc(-150, -30, 0), "arc.toml");
  EXPECT_NEAR(frequency_of(scene), std::sqrt(10 / 0.3), 1e-9);
  const StaticModel model(scene);
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::angle_of(model, found.x, "arc"), -pi / 2, tolerance(found.method));
    EXPECT_NEAR(size_of(found.check, "arc"), 20.0, 1e-6);
  }
  // Driven by its angle it comes to the end.
  const KinematicsResult swept = sweep(scene, {{.name = "arc", .from = -2.0, .to = 0.0}}, {.steps = 4});
  ASSERT_TRUE(swept.stop) << swept.why;
  EXPECT_EQ(scene.stops[swept.stop->stop].name, "arc ends");
  EXPECT_NEAR(swept.samples.back().drive[0], -pi / 6, 1e-9);
}

TEST(CurvedSlots, AnArcHasNumbersOfItsEnds) {
  Scene scene = parse_scene(arc(-60, 30, 0), "arc.toml");
  EXPECT_NEAR(get_value(scene, "circular_slot.arc.from"), -60, 1e-12);
  set_value(scene, "circular_slot.arc.from", -45);
  set_value(scene, "circular_slot.arc.radius", 0.4);
  EXPECT_NEAR(get_value(scene, "circular_slot.arc.from"), -45, 1e-12);
  EXPECT_THROW(set_value(scene, "circular_slot.arc.to", -50), InputError);
  EXPECT_THROW(set_value(scene, "circular_slot.arc.to", 320), InputError);
  const StaticModel model(scene);
  const Sensitivities found =
      sensitivities(model, {find_quantity(scene, "angle.arc"), find_quantity(scene, "bead.P.x")});
  ASSERT_EQ(found.of.size(), 2U) << found.why;
  const auto by = [&](std::size_t k, const std::string& number) {
    for (const Sensitivity& one : found.of[k].by) {
      if (one.number == number) return one.derivative;
    }
    return std::nan("");
  };
  EXPECT_NEAR(by(0, "circular_slot.arc.from"), 1.0, 1e-10);
  EXPECT_NEAR(by(0, "circular_slot.arc.to"), 0.0, 1e-10);
  EXPECT_NEAR(by(1, "circular_slot.arc.from"), 0.4 * std::sin(pi / 4), 1e-10);
  EXPECT_NEAR(by(1, "circular_slot.arc.radius"), std::cos(pi / 4), 1e-10);
  // A full circle has no ends.
  std::string ring = arc(-60, 30, 0);
  ring.replace(ring.find("from = -60"), 10, "");
  EXPECT_NE(message_of(ring).find("from"), std::string::npos);
  ring.replace(ring.find("to = 30"), 7, "");
  EXPECT_THROW(get_value(parse_scene(ring, "ring.toml"), "circular_slot.arc.from"), InputError);
  EXPECT_NE(message_of(arc(30, -60, 0)).find("smaller angle to a larger one"), std::string::npos);
  EXPECT_NE(message_of(arc(0, 360, 0)).find("less than a full turn"), std::string::npos);
}

// A full cylinder in a cylindrical trough: omega^2 = 2 g / (3 (R - r)); once rolling on its own, once as a wheel on an
// arm whose gear meshes with the circle.
std::string trough(double r, const std::string& more) {
  return fmt::format(R"(
    gravity = [0, -9.81]
    [ground]
    points = {{ O = [0, 0] }}
    [body.cylinder]
    points = {{ C = [0, 0] }}
    mass = 3
    inertia = {}
    {}
  )",
                     0.5 * 3 * r * r, more);
}

std::string rolls_inside(double R, double r, double angle = -1.4) {
  return fmt::format(R"(
    [[rolling_on_circle]]
    name = "contact"
    wheel = "cylinder.C"
    center = "ground.O"
    radius = {}
    circle_radius = {}
    inside = true
    [start]
    contact = {}
    position = {{ cylinder = [{}, {}] }}
  )",
                     r, R, angle, (R - r) * std::cos(angle), (R - r) * std::sin(angle));
}

TEST(Rolling, ACylinderSwingsInATrough) {
  const double R = 0.5, r = 0.12, omega = std::sqrt(2 * 9.81 / (3 * (R - r)));
  const Scene rolling = parse_scene(trough(r, rolls_inside(R, r)), "trough.toml");
  const StaticModel model(rolling);
  EXPECT_EQ(analyse_mobility(model).freedoms, 1);
  EXPECT_EQ(analyse_mobility(model).gruebler, 1);
  EXPECT_NEAR(frequency_of(rolling), omega, 1e-9);
  const std::string arm = fmt::format(R"(
    [body.arm]
    points = {{ O = [0, 0], C = [{}, 0] }}
    [[pin]]
    points = ["ground.O", "arm.O"]
    [[pin]]
    points = ["arm.C", "cylinder.C"]
    [[gear]]
    bodies = ["ground", "cylinder"]
    carrier = "arm"
    internal = true
    ratio = {}
    [start]
    arm = -1.4
  )",
                                      R - r, R / r);
  EXPECT_NEAR(frequency_of(parse_scene(trough(r, arm), "trough.toml")), omega, 1e-9);
}

// Pushed sideways by half its weight the cylinder rests where the slope of the trough is 1/2, with a normal force of
// sqrt(5) / 2 of its weight and without friction. Above the centre of the trough it would have to be pulled.
TEST(Rolling, ACylinderRestsInATroughAndFallsOffItsTop) {
  const double R = 0.5, r = 0.12, W = 3 * 9.81;
  const std::string push = fmt::format("\n[[force]]\nat = \"cylinder.C\"\nvector = [{}, 0]\n", W / 2);
  const StaticModel model(parse_scene(trough(r, rolls_inside(R, r)) + push, "trough.toml"));
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::angle_of(model, found.x, "contact"), std::atan2(-2.0, 1.0), tolerance(found.method));
    EXPECT_NEAR(size_of(found.check, "contact"), W * std::sqrt(5.0) / 2, 1e-5);
    EXPECT_NEAR(test::reaction_of(found.check, "contact").axial, W * std::sqrt(5.0) / 2, 1e-5);
    EXPECT_LT(size_of(found.check, "contact friction"), 1e-5);
  }
  Scene larger = parse_scene(trough(r, rolls_inside(R, r)), "trough.toml");
  set_value(larger, "rolling_on_circle.contact.radius", 0.6);
  EXPECT_NE(solve(StaticModel(larger), test::by(Method::virtual_work, Seek::any)).status, Status::confirmed);
  const StaticModel top(parse_scene(trough(r, rolls_inside(R, r, pi / 2)), "trough.toml"));
  const Check fallen = check(top, assemble(top));
  EXPECT_FALSE(fallen.is_equilibrium());
  EXPECT_NE(fallen.objection.find("lifts off"), std::string::npos) << fallen.objection;
}

// --- splines --------------------------------------------------------------------------------------------------------

/// A bead of 1 kg in a slot through so many points (x(t), y(t)) of a curve, t from -1 to 1, pushed sideways.
template <class Curve>
std::string bead_on(Curve curve, int points, double push, double start) {
  std::string list;
  for (int k = 0; k < points; ++k) {
    const Vec2 at = curve(-1.0 + 2.0 * k / (points - 1));
    list += fmt::format("[{:.17g}, {:.17g}], ", at.x, at.y);
  }
  double along = 0.0;
  for (double t = -1.0; t < start; t += 1e-3) along += norm(curve(t + 1e-3) - curve(t));
  const Vec2 at = curve(start);
  return fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ O = [0, 0] }}
    [body.bead]
    points = {{ P = [0, 0] }}
    mass = 1
    [[curved_slot]]
    name = "slot"
    pin = "bead.P"
    at = "ground.O"
    curve = [{}]
    [[force]]
    at = "bead.P"
    vector = [{}, 0]
    [start]
    slot = {}
    position = {{ bead = [{}, {}] }}
  )",
                     list, push, along, at.x, at.y);
}

Vec2 parabola(double t) { return {t, 0.4 * t * t}; }

// Where the slope 0.8 x is that of the push against the weight. The spline's place is of the order h^4, its slope h^3.
TEST(CurvedSlots, ABeadOnAParabolaRestsWhereItsSlopeIsThatOfTheForce) {
  std::vector<double> off_curve, off_place;
  for (const int points : {21, 41, 81}) {
    double place = 0.0, curve = 0.0;
    for (const double push : {-3.1, -1.37, 0.23, 0.91, 2.3}) {
      const double x = push / 8.0;
      const StaticModel model(parse_scene(bead_on(parabola, points, push, x + 0.1), "parabola.toml"));
      EXPECT_EQ(analyse_mobility(model).freedoms, 1);
      EXPECT_EQ(analyse_mobility(model).gruebler, 2);  // the bead turns as it likes
      for (const Equilibrium& found : found_both_ways(model)) {
        const Vec2 at = test::place_of(model, found.x, "bead.P");
        place = std::max(place, std::abs(at.x - x));
        curve = std::max(curve, std::abs(at.y - 0.4 * at.x * at.x));
        const Vec2 normal =
            test::reaction_of(found.check, "slot x").force + test::reaction_of(found.check, "slot y").force;
        EXPECT_NEAR(normal.x, -push, 1e-6);
        EXPECT_NEAR(normal.y, 10.0, 1e-6);
      }
    }
    off_curve.push_back(curve);
    off_place.push_back(place);
  }
  for (std::size_t k = 1; k < off_curve.size(); ++k) {
    EXPECT_LT(off_curve[k], off_curve[k - 1] / 10) << off_curve[k];
    EXPECT_LT(off_place[k], off_place[k - 1] / 6) << off_place[k];
  }
  EXPECT_LT(off_curve.back(), 1e-7);
  EXPECT_LT(off_place.back(), 1e-5);
}

// Huygens' cycloid with its cusps up: omega^2 = g / (4 a). The curvature of the spline is of the order h^2.
TEST(CurvedSlots, ABeadOnACycloidSwingsAsHuygensSays) {
  const double a = 0.25;
  const auto cycloid = [&](double t) { return Vec2{a * (2 * t + std::sin(2 * t)), a * (1 - std::cos(2 * t))}; };
  std::vector<double> off;
  for (const int points : {20, 40, 80}) {
    const double omega = frequency_of(parse_scene(bead_on(cycloid, points, 0.0, 0.1), "cycloid.toml"));
    off.push_back(std::abs(omega - std::sqrt(10 / (4 * a))));
  }
  EXPECT_LT(off[1], off[0] / 3.5);
  EXPECT_LT(off[2], off[1] / 3.5);
  EXPECT_LT(off[2], 1e-3);
}

// The spiral raises its pin evenly with the angle, through all pieces of the spline.
TEST(CurvedSlots, ASpiralLiftsEvenly) {
  const Scene scene = read_scene(test::dataset("curved_slot.toml"));
  const KinematicsResult swept = sweep(scene, {{.name = "lever", .from = -0.5, .to = 1.4}}, {.steps = 19});
  EXPECT_TRUE(swept.complete) << swept.why;
  ASSERT_EQ(swept.samples.size(), 20U);
  for (const KinematicSample& sample : swept.samples) {
    const double lift = 0.1 + 0.08 * (1.0 - sample.drive[0] / (pi / 2));
    EXPECT_NEAR(sample.bodies[2].pose.origin.y, lift, 1e-4) << sample.drive[0];
  }
}

// The end of an open track holds the pin.
TEST(CurvedSlots, ABeadIsHeldByTheEndOfItsTrack) {
  const StaticModel model(parse_scene(bead_on(parabola, 21, 30.0, 0.8), "end.toml"));
  const Equilibrium found = solve(model, test::by(Method::energy, Seek::stable));
  ASSERT_EQ(found.status, Status::confirmed) << found.why;
  const Vec2 at = test::place_of(model, found.x, "bead.P");
  EXPECT_NEAR(at.x, 1.0, 1e-7);
  EXPECT_NEAR(at.y, 0.4, 1e-7);
  // Along the tangent there: 30 N less the weight.
  const double slope = std::atan(0.8);
  const auto& reactions = found.check.reactions;
  const auto end = std::find_if(reactions.begin(), reactions.end(),
                                [](const Reaction& r) { return r.of_stop() && r.name == "slot"; });
  ASSERT_NE(end, reactions.end());
  EXPECT_NEAR(norm(end->force), 30 * std::cos(slope) - 10 * std::sin(slope), 0.5);
}

// --- wheels ---------------------------------------------------------------------------------------------------------

// A wheel on a slope of tan(alpha) = 0.2 with its centre of mass e from its centre, which is above the contact:
// e cos(angle) = r sin(alpha).
std::string eccentric_wheel(const std::string& more = "") {
  return R"(
    gravity = [0, -10]
    [ground]
    points = { A = [0, 0] }
    [body.wheel]
    points = { C = [0, 0] }
    mass = 5
    center = [0.06, 0]
    inertia = 0.05
    [[rolling]]
    name = "tyre"
    wheel = "wheel.C"
    line = "ground.A"
    axis = [1, 0.2]
    radius = 0.2
    offset = 0.3
    [start]
    wheel = -1.0
    position = { wheel = [0.5, 0.3] }
  )" + more;
}

TEST(Rolling, AnEccentricWheelStandsOnASlope) {
  const StaticModel model(parse_scene(eccentric_wheel(), "wheel.toml"));
  EXPECT_EQ(analyse_mobility(model).freedoms, 1);
  EXPECT_EQ(analyse_mobility(model).gruebler, 1);
  const double alpha = std::atan(0.2), r = 0.2, angle = -std::acos(r * std::sin(alpha) / 0.06);
  for (const Equilibrium& found : found_both_ways(model)) {
    EXPECT_NEAR(test::angle_of(model, found.x, "wheel"), angle, tolerance(found.method));
    const Vec2 at = test::place_of(model, found.x, "wheel.C");
    EXPECT_NEAR(at.x * std::cos(alpha) + at.y * std::sin(alpha), 0.3 - r * angle, tolerance(found.method));
    EXPECT_NEAR(-at.x * std::sin(alpha) + at.y * std::cos(alpha), r, tolerance(found.method));
    // The normal force and the friction of a weight of 50 N, up the slope.
    EXPECT_NEAR(-test::reaction_of(found.check, "tyre").axial, 50 * std::cos(alpha), 1e-5);
    EXPECT_NEAR(-test::reaction_of(found.check, "tyre friction").axial, 50 * std::sin(alpha), 1e-5);
  }
}

// The radius acts across the line and along it.
TEST(Rolling, ARadiusActsInBothRows) {
  Scene scene = parse_scene(eccentric_wheel(), "wheel.toml");
  set_value(scene, "rolling.tyre.radius", 0.15);
  set_value(scene, "rolling.tyre.offset", 0.1);
  EXPECT_EQ(get_value(scene, "rolling.tyre.radius"), 0.15);
  const StaticModel model(scene);
  const double alpha = std::atan(0.2), angle = -std::acos(0.15 * std::sin(alpha) / 0.06);
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(found.found()) << found.why;
  const Vec2 at = test::place_of(model, found.x, "wheel.C");
  EXPECT_NEAR(test::angle_of(model, found.x, "wheel"), angle, 1e-11);
  EXPECT_NEAR(-at.x * std::sin(alpha) + at.y * std::cos(alpha), 0.15, 1e-11);
  EXPECT_NEAR(at.x * std::cos(alpha) + at.y * std::sin(alpha), 0.1 - 0.15 * angle, 1e-11);
  const Scene other = scaled(scene, {.length = 0.25, .force = 8.0});
  EXPECT_EQ(other.stops[0].min, 0.6);
  EXPECT_EQ(other.stops[1].min, 0.4);
  EXPECT_EQ(other.stops[1].on.terms[1].factor, 0.6);
}

TEST(Rolling, NumbersHaveTheirExactSensitivities) {
  const std::string held = R"(
    [[torsion_spring]]
    bodies = ["ground", "wheel"]
    stiffness = 3
    [[spring]]
    points = ["ground.A", "wheel.C"]
    stiffness = 40
    free_length = 0.1
  )";
  expect_sensitivities(eccentric_wheel(held), "angle.wheel",
                       {"rolling.tyre.radius", "rolling.tyre.offset", "point.ground.A.x", "body.wheel.center.x"});
}

TEST(Rolling, NumbersOnACircleHaveTheirExactSensitivities) {
  const std::string held = R"(
    [[torsion_spring]]
    bodies = ["ground", "cylinder"]
    stiffness = 2
    free_angle = 0.5
  )";
  expect_sensitivities(trough(0.12, rolls_inside(0.5, 0.12)) + held, "angle.cylinder",
                       {"rolling_on_circle.contact.radius", "rolling_on_circle.contact.circle_radius",
                        "rolling_on_circle.contact.offset", "body.cylinder.mass"});
}

TEST(CurvedSlots, NumbersHaveTheirExactSensitivities) {
  std::string text = read_text_file(test::dataset("curved_slot.toml"));
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("points = { O = [0, 0], H", "points = { O = [0, 0], Q = [0.01, 0.02], H");
  replace("at = \"lever.O\"", "at = \"lever.Q\"");
  expect_sensitivities(text, "angle.lever", {"point.lever.Q.x", "point.lever.Q.y", "body.lift.mass", "point.lift.P.x"});
}

TEST(Rolling, AWheelThatIsLiftedIsNotInEquilibrium) {
  const std::string pulled = eccentric_wheel(R"(
    [[force]]
    at = "wheel.C"
    vector = [0, 60]
  )");
  const StaticModel model(parse_scene(pulled, "wheel.toml"));
  for (const Method method : {Method::virtual_work, Method::energy}) {
    const Equilibrium found = solve(model, test::by(method, Seek::any));
    EXPECT_NE(found.status, Status::confirmed);
    EXPECT_NE(found.why.find("lifts off"), std::string::npos) << found.why;
  }
  const std::string message = test::message_of([&] { all_equilibria(model); });
  EXPECT_NE(message.find("may lift off"), std::string::npos) << message;
}

// A full cylinder on a level line at a spring: omega^2 = k / (3/2 m).
TEST(Rolling, ACylinderSwingsOnItsLine) {
  const Scene scene = parse_scene(R"(
    gravity = [0, -10]
    [ground]
    points = { A = [0, 0], S = [-1, 0.2] }
    [body.wheel]
    points = { C = [0, 0] }
    mass = 4
    inertia = 0.08
    [[rolling]]
    wheel = "wheel.C"
    line = "ground.A"
    axis = [1, 0]
    radius = 0.2
    [[spring]]
    points = ["ground.S", "wheel.C"]
    stiffness = 90
    free_length = 1.1
    [start]
    wheel = -0.4
    position = { wheel = [0.15, 0.2] }
  )",
                                  "wheel.toml");
  EXPECT_NEAR(frequency_of(scene), std::sqrt(90 / 6.0), 1e-9);
}

// --- many scenes ----------------------------------------------------------------------------------------------------

/// A plate on a pivot, and on it a bead in a slot or a wheel on a line, in a pose that loads hold in equilibrium: they
/// balance a contact force that is chosen; springs that are relaxed there make it stable.
struct Planted {
  std::string text;
  std::vector<std::pair<std::string, double>> angles;
  Vec2 place;                 ///< of the bead or the wheel's centre
  Vec2 contact;               ///< force of the plate on it
  std::string first, second;  ///< the rows that carry it; the second may be empty
};

std::string plate(double angle, double moment, double stiffness) {
  return fmt::format(R"(
    [ground]
    points = {{ O = [0, 0], F = [3, -2] }}
    [body.plate]
    points = {{ O = [0, 0], A = [0.2, -0.1], B = [1, 0] }}
    [[pin]]
    points = ["ground.O", "plate.O"]
    [[torque]]
    on = "plate"
    value = {:.17g}
    [[torsion_spring]]
    name = "of the plate"
    bodies = ["ground", "plate"]
    stiffness = {}
    free_angle = {:.17g}
  )",
                     moment, stiffness, angle);
}

Planted planted_bead(comparison::Random& random, bool is_circle) {
  const double angle = random.uniform(-3.0, 3.0);
  const Vec2 turned = unit(angle), at{0.2, -0.1};
  Vec2 local{}, tangent{};
  std::string slot;
  double guess = 0.0;
  if (is_circle) {
    const double radius = random.uniform(0.2, 1.5);
    const Vec2 out = unit(random.uniform(-3.0, 3.0));
    local = at + radius * out;
    tangent = quarter_turn(out);
    slot = fmt::format("[[circular_slot]]\nname = \"slot\"\npin = \"bead.P\"\ncenter = \"plate.A\"\nradius = {:.17g}\n",
                       radius);
  } else {
    const bool is_closed = random.index(2) == 0;
    const int count = 4 + random.index(6);
    std::vector<Vec2> points;
    std::string list;
    for (int k = 0; k < count; ++k) {
      const double turn = (is_closed ? 2 * pi : 4.0) * k / count;
      points.push_back(random.uniform(0.6, 1.2) * unit(turn));
      list += fmt::format("[{:.17g}, {:.17g}], ", points.back().x, points.back().y);
    }
    if (is_closed) points.push_back(points.front());
    std::vector<double> u{0.0}, x{points[0].x}, y{points[0].y};
    for (std::size_t k = 1; k < points.size(); ++k) {
      u.push_back(u.back() + norm(points[k] - points[k - 1]));
      x.push_back(points[k].x);
      y.push_back(points[k].y);
    }
    const double length = u.back();
    for (double& one : u) one /= length;
    const double s = random.uniform(0.1, 0.9);
    const auto X = Profile::spline(u, x, is_closed).at(s), Y = Profile::spline(u, y, is_closed).at(s);
    local = at + Vec2{X.value, Y.value};
    tangent = direction<double>(Vec2{X.first, Y.first});
    guess = s * length;
    slot =
        fmt::format("[[curved_slot]]\nname = \"slot\"\npin = \"bead.P\"\nat = \"plate.A\"\ncurve = [{}]\nclosed = {}\n",
                    list, is_closed);
  }
  Planted out;
  out.place = local * turned;
  const Vec2 normal = quarter_turn(tangent) * turned;
  out.contact = random.uniform(-20.0, 20.0) * normal;
  out.first = is_circle ? "slot" : "slot x";
  out.second = is_circle ? "" : "slot y";
  out.angles = {{"plate", angle}};
  const Vec2 to_anchor = out.place - Vec2{3, -2};
  const auto near = [&](double value) { return value + random.uniform(-0.02, 0.02); };
  const double start_y = near(out.place.y), start_x = near(out.place.x), start_angle = near(angle);
  out.text = plate(angle, cross(out.place, out.contact), 2000) + R"(
    [body.bead]
    points = { P = [0, 0] }
  )" + slot +
             fmt::format(R"(
    [[force]]
    at = "bead.P"
    vector = [{:.17g}, {:.17g}]
    [[spring]]
    x = "bead.P"
    stiffness = 2000
    free_length = {:.17g}
    [[spring]]
    y = "bead.P"
    stiffness = 2000
    free_length = {:.17g}
    [start]
    plate = {:.17g}
    position = {{ bead = [{:.17g}, {:.17g}] }}
  )",
                         -out.contact.x, -out.contact.y, out.place.x, out.place.y, start_angle, start_x, start_y);
  if (!is_circle) out.text += fmt::format("slot = {:.17g}\n", near(guess));
  EXPECT_GT(norm(to_anchor), 0.0);
  return out;
}

Planted planted_wheel(comparison::Random& random) {
  const double angle = random.uniform(-3.0, 3.0), r = random.uniform(0.1, 0.8), s = random.uniform(-1.5, 1.5);
  const double offset = random.uniform(-1.0, 1.0);
  const Vec2 axis = unit(random.uniform(-3.0, 3.0)), at{0.2, -0.1};
  const double wheel = angle + (offset - s) / r;
  const Vec2 turned = unit(angle);
  const Vec2 along = axis * turned, across = quarter_turn(along);
  const double N = random.uniform(1.0, 20.0), T = random.uniform(-10.0, 10.0);
  Planted out;
  out.contact = N * across + T * along;
  out.place = (at + s * axis + r * quarter_turn(axis)) * turned;
  out.first = "tyre";
  out.second = "tyre friction";
  out.angles = {{"plate", angle}, {"wheel", wheel}};
  const Vec2 touch = out.place - r * across;
  out.text = plate(angle, cross(touch, out.contact), 2000) +
             fmt::format(R"(
    [body.wheel]
    points = {{ C = [0, 0] }}
    [[rolling]]
    name = "tyre"
    wheel = "wheel.C"
    line = "plate.A"
    axis = [{:.17g}, {:.17g}]
    radius = {:.17g}
    offset = {:.17g}
    [[force]]
    at = "wheel.C"
    vector = [{:.17g}, {:.17g}]
    [[torque]]
    on = "wheel"
    value = {:.17g}
    [[torsion_spring]]
    name = "of the wheel"
    bodies = ["ground", "wheel"]
    stiffness = 2000
    free_angle = {:.17g}
    [start]
    plate = {:.17g}
    wheel = {:.17g}
    position = {{ wheel = [{:.17g}, {:.17g}] }}
  )",
                         axis.x, axis.y, r, offset, -out.contact.x, -out.contact.y, -T * r, wheel,
                         angle + random.uniform(-0.02, 0.02), wheel, out.place.x, out.place.y);
  return out;
}

Planted planted_on_circle(comparison::Random& random) {
  const bool is_inside = random.index(2) == 0;
  const double angle = random.uniform(-3.0, 3.0), r = random.uniform(0.1, 0.5), phi = random.uniform(-3.0, 3.0);
  const double R = is_inside ? r + random.uniform(0.2, 1.0) : random.uniform(0.2, 1.0);
  const double side = is_inside ? -1.0 : 1.0, offset = random.uniform(-1.0, 1.0);
  // The arcs on the wheel and on the circle are equal, but for the offset.
  const double wheel = phi + (offset + side * R * (phi - angle)) / r;
  const Vec2 out_of_circle = unit(phi), at = Vec2{0.2, -0.1} * unit(angle);
  const double N = random.uniform(1.0, 20.0), T = random.uniform(-10.0, 10.0);
  Planted out;
  out.contact = side * N * out_of_circle + T * quarter_turn(out_of_circle);
  out.place = at + (R + side * r) * out_of_circle;
  out.first = "tyre";
  out.second = "tyre friction";
  out.angles = {{"plate", angle}, {"wheel", wheel}, {"tyre", phi}};
  const Vec2 touch = at + R * out_of_circle;
  out.text =
      plate(angle, cross(touch, out.contact), 2000) +
      fmt::format(R"(
    [body.wheel]
    points = {{ C = [0, 0] }}
    [[rolling_on_circle]]
    name = "tyre"
    wheel = "wheel.C"
    center = "plate.A"
    radius = {:.17g}
    circle_radius = {:.17g}
    inside = {}
    offset = {:.17g}
    [[force]]
    at = "wheel.C"
    vector = [{:.17g}, {:.17g}]
    [[torque]]
    on = "wheel"
    value = {:.17g}
    [[torsion_spring]]
    name = "of the wheel"
    bodies = ["ground", "wheel"]
    stiffness = 2000
    free_angle = {:.17g}
    [start]
    plate = {:.17g}
    wheel = {:.17g}
    tyre = {:.17g}
    position = {{ wheel = [{:.17g}, {:.17g}] }}
  )",
                  r, R, is_inside, offset, -out.contact.x, -out.contact.y, -cross(touch - out.place, out.contact),
                  wheel, angle + random.uniform(-0.02, 0.02), wheel, phi, out.place.x, out.place.y);
  return out;
}

TEST(CurvedTracks, PlantedEquilibriaAreFoundInAllWays) {
  comparison::Random random(20261125);
  constexpr int scenes = 480;
  for (int k = 0; k < scenes; ++k) {
    const bool is_bead = k % 4 < 2;
    const Planted planted = is_bead      ? planted_bead(random, k % 4 == 0)
                            : k % 4 == 2 ? planted_wheel(random)
                                         : planted_on_circle(random);
    SCOPED_TRACE(planted.text);
    const StaticModel model(parse_scene(planted.text, "planted.toml"));
    ASSERT_EQ(analyse_mobility(model).freedoms, 2);
    for (const Method method : {Method::virtual_work, Method::energy}) {
      const Equilibrium found = solve(model, test::by(method, Seek::stable));
      ASSERT_EQ(found.status, Status::confirmed) << to_string(method) << ": " << found.why;
      EXPECT_TRUE(found.check.is_equilibrium()) << found.check.objection;
      const double near = method == Method::virtual_work ? 1e-9 : 1e-6;
      for (const auto& [body, angle] : planted.angles) {
        EXPECT_NEAR(test::angle_of(model, found.x, body), angle, near) << body;
      }
      const std::string point = is_bead ? "bead.P" : "wheel.C";
      EXPECT_LT(norm(test::place_of(model, found.x, point) - planted.place), near);
      Vec2 contact = test::reaction_of(found.check, planted.first).force;
      if (!planted.second.empty()) contact += test::reaction_of(found.check, planted.second).force;
      EXPECT_LT(norm(contact - planted.contact), 1e4 * near);
    }
  }
}

// --- input ----------------------------------------------------------------------------------------------------------

TEST(CurvedSlots, NameWhatIsWrong) {
  const std::string head = R"(
    [ground]
    points = { O = [0, 0] }
    [body.bead]
    points = { P = [0, 0], Q = [1, 0] }
  )";
  const auto has = [&](const std::string& text, const std::string& words) {
    const std::string message = message_of(head + text);
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  const std::string slot = "[[curved_slot]]\npin = \"bead.P\"\nat = \"ground.O\"\n";
  has(slot, "curve");
  has(slot + "curve = [[0, 0], [1, 0]]\n", "three points");
  has(slot + "curve = [[0, 0], [1, 0], [1, 0], [2, 1]]\n", "another point than the one before");
  has(slot + "closed = true\ncurve = [[0, 0], [1, 0], [1, 1], [0, 0]]\n", "returns anyway");
  has(slot + "curve = [[0, 0], [1, 0], [2, 0]]\nto = 0.5\nfrom = 0.7\n", "behind");
  has(slot + "curve = [[0, 0], [1], [2, 0]]\n", "curve");
  has("[[curved_slot]]\npin = \"bead.P\"\nat = \"bead.Q\"\ncurve = [[0, 0], [1, 0], [2, 0]]\n", "another body");
  has("[[circular_slot]]\npin = \"bead.P\"\ncenter = \"ground.O\"\n", "radius");
  has("[[circular_slot]]\npin = \"bead.P\"\ncenter = \"ground.O\"\nradius = 0\n", "> 0");
  has("[[circular_slot]]\npin = \"bead.P\"\ncenter = \"ground.X\"\nradius = 1\n", "ground.O");
  has("[[rolling]]\nwheel = \"bead.P\"\nline = \"ground.O\"\naxis = [0, 0]\nradius = 1\n", "direction");
  has("[[rolling]]\nwheel = \"bead.P\"\nline = \"ground.O\"\naxis = [1, 0]\nradius = -1\n", "> 0");
  const std::string circle = "[[rolling_on_circle]]\nwheel = \"bead.P\"\ncenter = \"ground.O\"\nradius = 1\n";
  has(circle, "circle_radius");
  has(circle + "circle_radius = 0.5\ninside = true\n", "smaller wheel");
  has("[[rolling]]\nwheel = \"bead.P\"\nline = \"bead.Q\"\naxis = [1, 0]\nradius = 1\n", "another body");
}

}  // namespace
}  // namespace poise::curved_tracks_test
