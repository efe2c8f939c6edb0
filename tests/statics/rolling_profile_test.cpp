// Profiles that roll on a line or a circle, against closed forms of ellipses and circles.

#include "model/rolling_profile.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "model/parameters.hpp"
#include "model/rewritten_scene.hpp"
#include "motion/kinematics.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/model/mobility.hpp"
#include "tests/support/contacts.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::statics_rolling_profile_test {
namespace {

using std::numbers::pi;
using test::found_both_ways;
using test::frequency_of;
using test::tolerance;

constexpr double g = 10.0;

std::string list_of(const std::vector<Vec2>& points) {
  std::string out;
  for (const Vec2& at : points) out += fmt::format("[{:.17g}, {:.17g}], ", at.x, at.y);
  return out;
}

/// An ellipse from its vertex on the right, counter-clockwise.
std::vector<Vec2> ellipse(double a, double b, int points) {
  std::vector<Vec2> out;
  for (int k = 0; k < points; ++k) {
    const Vec2 at = unit(2 * pi * k / points);
    out.push_back({a * at.x, b * at.y});
  }
  return out;
}

/// An elliptic rocker of 3 kg whose centre of mass W is c below its centre C, on a level line or another contact.
struct Rocker {
  double a = 0.3, b = 0.2, c = 0.05, inertia = 0.07;
  int points = 80;
  double angle = 0.1;  ///< at the start
  std::string contact = "[[rolling_profile]]\nline = \"ground.A\"\naxis = [1, 0]\n";
  std::string start = "position = { rocker = [0.1, 0.2] }\n";
  std::string more{};

  std::string text() const {
    return fmt::format(R"(
      gravity = [0, -{}]
      [ground]
      points = {{ A = [0, 0] }}
      [body.rocker]
      points = {{ C = [0, 0], W = [0, {}] }}
      mass = 3
      center = [0, {}]
      inertia = {}
      {}
      name = "foot"
      at = "rocker.C"
      curve = [{}]
      closed = true
      {}
      [start]
      rocker = {}
      {}
    )",
                       g, -c, -c, inertia, contact, list_of(ellipse(a, b, points)), more, angle, start);
  }
  Scene scene() const { return parse_scene(text(), "rocker.toml"); }
  /// Height of C over the line, and its derivative by the angle.
  double height(double phi) const { return std::hypot(b * std::cos(phi), a * std::sin(phi)); }
  double slope(double phi) const { return (a * a - b * b) * std::sin(phi) * std::cos(phi) / height(phi); }
  /// Parameter t of the point (a cos t, b sin t) that touches.
  double touching(double phi) const { return std::atan2(-b * std::cos(phi), -a * std::sin(phi)); }
};

double bisect(const std::function<double(double)>& f, double low, double high) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Of a row of the contact; the travel along the curve has the name of the first.
const Reaction& row_of(const Equilibrium& found, const std::string& row) {
  const auto& all = found.check.reactions;
  const auto is_it = [&](const Reaction& one) { return one.of_stop() && one.name == row; };
  return *std::find_if(all.begin(), all.end(), is_it);
}

Vec2 force_of(const Equilibrium& found, const std::string& row) { return row_of(found, row).force; }

// --- a line ---------------------------------------------------------------------------------------------------------

// It stands where its radius of curvature a^2 / b is more than the height b - c of its centre of mass, and swings with
// omega^2 = g (a^2 / b - h) / (k^2 + h^2) (S. Timoshenko, D. Young, "Advanced Dynamics", 1948: rocking bodies).
TEST(RollingProfile, AnEllipseStandsAndRocks) {
  std::vector<double> off;
  for (const int points : {40, 80, 160}) {
    Rocker rocker;
    rocker.points = points;
    const StaticModel model(rocker.scene());
    EXPECT_EQ(analyse_mobility(model).freedoms, 1);
    EXPECT_EQ(analyse_mobility(model).gruebler, 1);
    for (const Equilibrium& found : found_both_ways(model)) {
      EXPECT_NEAR(test::angle_of(model, found.x, "rocker"), 0.0, tolerance(found.method));
      EXPECT_NEAR(test::place_of(model, found.x, "rocker.C").y, rocker.b, 1e-12);
      EXPECT_NEAR(force_of(found, "foot").y, 3 * g, 1e-6);
      EXPECT_NEAR(-row_of(found, "foot").axial, 3 * g, 1e-6);
      EXPECT_LT(norm(force_of(found, "foot friction")), 1e-5);
    }
    const double h = rocker.b - rocker.c, radius = rocker.a * rocker.a / rocker.b;
    const double omega = std::sqrt(g * (radius - h) / (rocker.inertia / 3 + h * h));
    off.push_back(std::abs(frequency_of(rocker.scene()) - omega));
  }
  // The curvature of the spline is of the order h^2.
  EXPECT_LT(off[1], off[0] / 3.5);
  EXPECT_LT(off[2], off[1] / 3.5);
  EXPECT_LT(off[2], 1e-2);
}

TEST(RollingProfile, AHeavyTopTipsOver) {
  // Heights of the centre of mass around the radius of curvature, 0.45 m.
  for (const auto& [c, is_stable] : {std::pair(-0.24, true), std::pair(-0.26, false)}) {
    Rocker rocker;
    rocker.c = c;
    rocker.points = 160;
    rocker.angle = 0.0;
    rocker.more = fmt::format("offset = {:.17g}\n", 0.25 * rocker.scene().stops[1].on.terms[2].profile->at(1.0).value);
    rocker.start = "position = { rocker = [0, 0.2] }\n";
    const StaticModel model(rocker.scene());
    const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::any));
    ASSERT_EQ(found.status, Status::confirmed) << found.why;
    EXPECT_NEAR(test::angle_of(model, found.x, "rocker"), 0.0, 1e-10);
    EXPECT_EQ(found.certificate.stability, is_stable ? Stability::stable : Stability::unstable);
  }
}

// Pushed sideways by F at W it leans:  F (H - c cos) + m g (H' + c sin) = 0.  The line carries its weight and F by
// friction; the arc from the first point to the contact is the way of the contact from `offset`.
TEST(RollingProfile, APushedEllipseLeansAsMuchAsItsClosedFormSays) {
  std::vector<double> off, way;
  for (const int points : {40, 80, 160}) {
    double worst = 0.0, worst_way = 0.0;
    for (const double F : {-9.0, -4.0, 1.3, 3.7, 6.0, 8.1}) {
      Rocker rocker;
      rocker.points = points;
      rocker.more = fmt::format("offset = 0.4\n[[force]]\nat = \"rocker.W\"\nvector = [{}, 0]\n", F);
      const double phi = bisect(
          [&](double at) {
            return -(F * (rocker.height(at) - rocker.c * std::cos(at)) +
                     3 * g * (rocker.slope(at) + rocker.c * std::sin(at)));
          },
          -1.0, 1.0);
      const StaticModel model(rocker.scene());
      for (const Equilibrium& found : found_both_ways(model)) {
        worst = std::max(worst, std::abs(test::angle_of(model, found.x, "rocker") - phi));
        const Vec2 normal = force_of(found, "foot"), friction = force_of(found, "foot friction");
        EXPECT_NEAR(norm(normal - Vec2{0, 3 * g}), 0.0, 1e-5);
        EXPECT_NEAR(norm(friction - Vec2{-F, 0}), 0.0, 1e-5);
        EXPECT_NEAR(-row_of(found, "foot friction").axial, -F, 1e-5);
        // By Simpson's rule.
        const double t = rocker.touching(phi);
        double arc = 0.0;
        constexpr int steps = 2000;
        for (int k = 0; k < steps; ++k) {
          const auto speed = [&](double at) {
            return std::hypot(rocker.a * std::sin(t * at / steps), rocker.b * std::cos(t * at / steps));
          };
          arc += t / steps * (speed(k) + 4 * speed(k + 0.5) + speed(k + 1)) / 6;
        }
        const Vec2 contact = Vec2{rocker.a * std::cos(t), rocker.b * std::sin(t)} * unit(phi);
        worst_way = std::max(worst_way, std::abs(test::place_of(model, found.x, "rocker.C").x + contact.x - 0.4 - arc));
      }
    }
    off.push_back(worst);
    way.push_back(worst_way);
  }
  EXPECT_LT(off[1], off[0] / 5) << off[0] << " " << off[1] << " " << off[2];
  EXPECT_LT(off[2], off[1] / 5);
  EXPECT_LT(off[2], 1e-5);
  EXPECT_LT(way.back(), 1e-5);
}

// A circle of points rolls as the wheel of its radius, but for the place from which its arc counts.
TEST(RollingProfile, ACircleRollsAsAWheel) {
  const double r = 0.2, alpha = std::atan(0.2);
  const auto text = [&](const std::string& contact) {
    return R"(
      gravity = [0, -10]
      [ground]
      points = { A = [0, 0] }
      [body.wheel]
      points = { C = [0, 0] }
      mass = 5
      center = [0.06, 0]
      inertia = 0.05
      )" + contact +
           R"(
      name = "tyre"
      line = "ground.A"
      axis = [1, 0.2]
      [start]
      wheel = -1.0
      position = { wheel = [0.5, 0.3] }
    )";
  };
  const StaticModel wheel(parse_scene(text("[[rolling]]\nwheel = \"wheel.C\"\nradius = 0.2\noffset = 0.3\n"), "wheel"));
  const Equilibrium as_wheel = solve(wheel, test::by(Method::virtual_work, Seek::stable));
  ASSERT_TRUE(as_wheel.found());
  std::vector<double> off;
  for (const int points : {10, 20, 40, 80}) {
    const StaticModel model(parse_scene(
        text(fmt::format("[[rolling_profile]]\nat = \"wheel.C\"\ncurve = [{}]\nclosed = true\noffset = {:.17g}\n",
                         list_of(ellipse(r, r, points)), 0.3 + r * (pi / 2 - alpha))),
        "wheel"));
    double worst = 0.0;
    for (const Equilibrium& found : found_both_ways(model)) {
      worst = std::max(worst,
                       norm(test::place_of(model, found.x, "wheel.C") - test::place_of(wheel, as_wheel.x, "wheel.C")));
      for (const std::string row : {"tyre", "tyre friction"}) {
        EXPECT_LT(norm(force_of(found, row) - force_of(as_wheel, row)), 1e-5) << row;
      }
    }
    off.push_back(worst);
  }
  // Of the order h^3, and more or less where on a piece of the spline it touches.
  EXPECT_LT(off[3], off[1] / 50);
  EXPECT_LT(off[3], 2e-6);
}

// The tilted rocker swings: energy is kept, the point that touches stands still, and the rate is that of its energy,
// (I + m |W - contact|^2) w^2 / 2 = m g (height of W at the start - height).
TEST(RollingProfile, RollsWithoutSlippingAndKeepsItsEnergy) {
  Rocker rocker;
  rocker.points = 120;
  rocker.angle = 0.6;
  const Scene scene = rocker.scene();
  const MotionModel model(scene);
  const auto energy_height = [&](double phi) { return rocker.height(phi) - rocker.c * std::cos(phi); };
  for (const double time : {0.13, 0.31, 0.52, 1.1}) {
    SCOPED_TRACE(time);
    const Motion motion = test::moved(model, test::released(model, {{{"rocker", 0.6}}, {}}), time);
    EXPECT_LT(motion.energy_error, 1e-9);
    const std::vector<double> q = test::q_at(motion, motion.trajectory.nodes() - 1);
    const std::vector<double> v = test::v_at(motion, motion.trajectory.nodes() - 1);
    const auto angle = static_cast<std::size_t>(test::coordinate_of(model, "rocker"));
    const auto along = static_cast<std::size_t>(test::coordinate_of(model, "foot"));
    const double phi = q[angle], w = v[angle];
    const double u = q[along] / scene.stops[0].on.terms[1].span;
    const Vec2 arm = point_of_profile(scene.stops.data(), u) * unit(phi);
    const test::PointState centre = test::end_of(model, motion, "rocker.C");
    EXPECT_LT(norm(centre.velocity + w * quarter_turn(arm)), 1e-8);
    EXPECT_NEAR(centre.place.y + arm.y, 0.0, 1e-9);
    const double t = rocker.touching(phi);
    const Vec2 contact{rocker.a * std::cos(t), rocker.b * std::sin(t)};
    EXPECT_LT(norm(arm - contact * unit(phi)), 1e-5);
    const Vec2 reach = Vec2{0, -rocker.c} - contact;
    const double kinetic = 0.5 * (rocker.inertia + 3 * dot(reach, reach)) * w * w;
    EXPECT_NEAR(kinetic, 3 * g * (energy_height(0.6) - energy_height(phi)), 1e-5);
  }
}

// Driven once round and more, the contact goes round the curve once and on.
TEST(RollingProfile, RollsRoundMoreThanOnce) {
  Rocker rocker;
  const Scene scene = rocker.scene();
  const KinematicsResult swept = sweep(scene, {{.name = "rocker", .from = 0.0, .to = -9.0}}, {.steps = 40});
  ASSERT_TRUE(swept.complete) << swept.why;
  const double perimeter = scene.stops[1].on.terms[2].profile->at(1.0).value;
  for (const KinematicSample& sample : swept.samples) {
    const double phi = sample.drive[0];
    const auto& pose = sample.bodies[1].pose;
    EXPECT_NEAR(pose.origin.y, rocker.height(phi), 1e-6);
    const double t = rocker.touching(phi);
    const Vec2 contact = Vec2{rocker.a * std::cos(t), rocker.b * std::sin(t)} * unit(phi);
    // After full turns the contact is as many perimeters further on.
    if (std::abs(std::remainder(phi, 2 * pi)) < 1e-9) {
      EXPECT_NEAR(pose.origin.x + contact.x, perimeter * (-phi / (2 * pi) - 0.25), 1e-6);
    }
  }
}

// --- circles --------------------------------------------------------------------------------------------------------

// On a circle of radius R: omega^2 = g (r R / (r + R) - h) / (k^2 + h^2), inside of it with - R.
TEST(RollingProfile, ARockerOnACircleSwingsAsARockingStone) {
  for (const double R : {0.9, -1.1}) {
    const bool is_inside = R < 0.0;
    Rocker rocker;
    rocker.points = 160;
    rocker.angle = 0.01;
    rocker.contact =
        fmt::format("[[rolling_profile_on_circle]]\ncenter = \"ground.A\"\ncircle_radius = {}\ninside = {}\n",
                    std::abs(R), is_inside);
    const double y = R + rocker.b;
    rocker.start =
        fmt::format("\"foot radius\" = {}\nposition = {{ rocker = [0.01, {}] }}\n", is_inside ? -pi / 2 : pi / 2, y);
    const Scene scene = rocker.scene();
    const StaticModel model(scene);
    EXPECT_EQ(analyse_mobility(model).freedoms, 1);
    EXPECT_EQ(analyse_mobility(model).gruebler, 1);
    // It rests where its lowest vertex touches; where that is on the circle depends on the first point's place.
    const double r = rocker.a * rocker.a / rocker.b, h = rocker.b - rocker.c;
    Rocker level = rocker;
    const double perimeter = scene.stops[1].on.terms[2].profile->at(1.0).value;
    // The first point touches with the body at half a turn outside, without a turn inside.
    level.more = fmt::format("offset = {:.17g}\n", (is_inside ? 0.25 : -0.75) * perimeter - std::abs(R) * pi / 2);
    const StaticModel upright(level.scene());
    for (const Equilibrium& found : found_both_ways(upright)) {
      EXPECT_NEAR(test::angle_of(upright, found.x, "rocker"), 0.0, 1e-6);
      EXPECT_NEAR(test::place_of(upright, found.x, "rocker.C").y, y, 1e-6);
      EXPECT_NEAR(force_of(found, "foot").y, 3 * g, 1e-5);
      EXPECT_LT(norm(force_of(found, "foot friction")), 1e-4);
    }
    const double omega = std::sqrt(g * (r * R / (r + R) - h) / (rocker.inertia / 3 + h * h));
    EXPECT_NEAR(frequency_of(level.scene()), omega, 2e-3 * omega);
  }
}

// --- many scenes ----------------------------------------------------------------------------------------------------

/// A plate on a pivot and on it a body that rolls with a random convex curve, in a pose in which loads balance a
/// contact force that is chosen; springs that are relaxed there make it stable.
struct Planted {
  std::string text;
  double plate = 0.0, body = 0.0;
  Vec2 place, contact;
};

Planted planted(comparison::Random& random, bool on_circle) {
  const double big = random.uniform(0.2, 0.6), sense = random.index(2) == 0 ? 1.0 : -1.0;
  const int count = 24 + random.index(40);
  const double turn_2 = random.uniform(0.0, 6.0), turn_3 = random.uniform(0.0, 6.0);
  std::vector<Vec2> points;
  for (int k = 0; k < count; ++k) {
    const double t = 2 * pi * k / count;
    points.push_back(big * (1 + 0.08 * std::cos(2 * t + turn_2) + 0.03 * std::cos(3 * t + turn_3)) * unit(t));
  }
  const RollingProfile curve = rolling_profile(points, true).value();
  const double u = random.uniform(-0.9, 1.9);
  const double turned = curve.angle->at(u).value, arc = curve.length->at(u).value;
  const Vec2 of_curve = Vec2{curve.along->at(u).value, curve.across->at(u).value} * unit(turned);
  const double first = curve.angle->at(0.0).value;
  const double offset = random.uniform(-1.0, 1.0), N = random.uniform(1.0, 20.0), T = random.uniform(-10.0, 10.0);
  Planted out;
  out.plate = random.uniform(-3.0, 3.0);
  const Vec2 at = Vec2{0.2, -0.1} * unit(out.plate);
  Vec2 touch, along;
  std::string contact, start;
  if (on_circle) {
    const double R = sense > 0.0 ? random.uniform(0.3, 1.0) : 3 * big;
    const double radius = out.plate - sense * (offset + arc) / R;
    touch = at + R * unit(radius);
    along = -sense * quarter_turn(unit(radius));
    out.body = radius + first + std::remainder(-sense * pi / 2 - first, 2 * pi) - turned;
    contact = fmt::format("[[rolling_profile_on_circle]]\ncenter = \"plate.A\"\ncircle_radius = {:.17g}\ninside = {}\n",
                          R, sense < 0.0);
    start = fmt::format("\"tyre radius\" = {:.17g}\n", radius);
  } else {
    const double axis = random.uniform(-3.0, 3.0);
    along = unit(out.plate + axis);
    touch = at + (offset + arc) * along;
    out.body = out.plate + first + std::remainder(axis - first, 2 * pi) - turned;
    contact = fmt::format("[[rolling_profile]]\nline = \"plate.A\"\naxis = [{:.17g}, {:.17g}]\n", std::cos(axis),
                          std::sin(axis));
  }
  out.place = touch - of_curve * unit(out.body);
  out.contact = N * quarter_turn(along) + T * along;
  const auto near = [&](double value) { return value + random.uniform(-0.02, 0.02); };
  const double start_y = near(out.place.y), start_x = near(out.place.x);
  const double start_body = near(out.body), start_plate = near(out.plate);
  out.text = fmt::format(R"(
    [ground]
    points = {{ O = [0, 0] }}
    [body.plate]
    points = {{ O = [0, 0], A = [0.2, -0.1] }}
    [body.wheel]
    points = {{ C = [0, 0] }}
    [[pin]]
    points = ["ground.O", "plate.O"]
    [[torque]]
    on = "plate"
    value = {:.17g}
    [[torsion_spring]]
    bodies = ["ground", "plate"]
    stiffness = 2000
    free_angle = {:.17g}
    {}
    name = "tyre"
    at = "wheel.C"
    curve = [{}]
    closed = true
    offset = {:.17g}
    [[force]]
    at = "wheel.C"
    vector = [{:.17g}, {:.17g}]
    [[torque]]
    on = "wheel"
    value = {:.17g}
    [[torsion_spring]]
    bodies = ["ground", "wheel"]
    stiffness = 2000
    free_angle = {:.17g}
    [start]
    {}
    plate = {:.17g}
    wheel = {:.17g}
    position = {{ wheel = [{:.17g}, {:.17g}] }}
  )",
                         cross(touch, out.contact), out.plate, contact, list_of(points), offset, -out.contact.x,
                         -out.contact.y, -cross(touch - out.place, out.contact), out.body, start, start_plate,
                         start_body, start_x, start_y);
  return out;
}

TEST(RollingProfile, PlantedEquilibriaAreFoundInBothWays) {
  comparison::Random random(20261125);
  constexpr int scenes = 120;
  for (int k = 0; k < scenes; ++k) {
    const Planted known = planted(random, k % 2 == 1);
    SCOPED_TRACE(known.text);
    const StaticModel model(parse_scene(known.text, "planted.toml"));
    ASSERT_EQ(analyse_mobility(model).freedoms, 2);
    for (const Equilibrium& found : found_both_ways(model)) {
      ASSERT_EQ(found.status, Status::confirmed);
      const double near = found.method == Method::virtual_work ? 1e-9 : 1e-6;
      EXPECT_NEAR(test::angle_of(model, found.x, "plate"), known.plate, near);
      EXPECT_NEAR(test::angle_of(model, found.x, "wheel"), known.body, near);
      EXPECT_LT(norm(test::place_of(model, found.x, "wheel.C") - known.place), near);
      EXPECT_LT(norm(force_of(found, "tyre") + force_of(found, "tyre friction") - known.contact), 1e4 * near);
    }
  }
}

// --- numbers --------------------------------------------------------------------------------------------------------

const std::string arc_points =
    "[[-0.3, 0.05], [-0.2, 0.0], [-0.1, -0.03], [0, -0.04], [0.1, -0.03], [0.2, 0.0], [0.3, "
    "0.05]]";

/// A rocker on an arc, as a rocking chair has it.
std::string chair(const std::string& keys, const std::string& more = "", double angle = 0.05) {
  return fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ A = [0, 0] }}
    [body.chair]
    points = {{ O = [0, 0], S = [0.05, 0.3] }}
    mass = 6
    center = [0.03, 0.25]
    inertia = 0.4
    [[rolling_profile]]
    name = "runner"
    at = "chair.O"
    curve = {}
    line = "ground.A"
    axis = [1, 0]
    {}
    {}
    [start]
    chair = {}
    position = {{ chair = [0, 0.04] }}
  )",
                     arc_points, keys, more, angle);
}

TEST(RollingProfile, HasNumbersOfItsEndsAndItsOffset) {
  Scene scene = parse_scene(chair("from = 0.05"), "chair.toml");
  EXPECT_EQ(get_value(scene, "rolling_profile.runner.from"), 0.05);
  EXPECT_NEAR(get_value(scene, "rolling_profile.runner.to"), 0.64, 0.01);
  set_value(scene, "rolling_profile.runner.to", 0.6);
  set_value(scene, "rolling_profile.runner.offset", 0.3);
  EXPECT_EQ(scene.stops[1].max, 0.3);
  EXPECT_EQ(scene.stops[3].max, 0.6);
  EXPECT_THROW(set_value(scene, "rolling_profile.runner.to", 0.7), InputError);
  EXPECT_THROW(set_value(scene, "rolling_profile.runner.to", 0.04), InputError);
  EXPECT_THROW(set_value(scene, "rolling_profile.runner.from", -0.01), InputError);
  const Scene other = scaled(scene, {.length = 0.25, .force = 8.0});
  EXPECT_EQ(other.stops[1].max, 4 * scene.stops[1].max);
  EXPECT_EQ(other.stops[3].max, 4 * scene.stops[3].max);
  EXPECT_EQ(other.stops[0].on.terms[1].span, 4 * scene.stops[0].on.terms[1].span);
  EXPECT_EQ(other.stops[2].on.terms[1].factor, 1.0);
  Scene closed = Rocker{}.scene();
  EXPECT_THROW(get_value(closed, "rolling_profile.foot.from"), InputError);
}

TEST(RollingProfile, NumbersHaveTheirExactSensitivities) {
  const std::string held = R"(
    [[spring]]
    points = ["ground.A", "chair.S"]
    stiffness = 40
    free_length = 0.1
  )";
  test::expect_sensitivities(chair("offset = 0.1", held), "angle.chair",
                             {"rolling_profile.runner.offset", "point.chair.O.x", "point.chair.O.y", "point.chair.S.x",
                              "point.ground.A.x", "body.chair.center.x"});
  Rocker rocker;
  rocker.contact = "[[rolling_profile_on_circle]]\ncenter = \"ground.A\"\ncircle_radius = 0.9\n";
  rocker.start = "\"foot radius\" = 1.57\nposition = { rocker = [0.01, 1.1] }\n";
  rocker.more = "offset = -1\n[[torsion_spring]]\nbodies = [\"ground\", \"rocker\"]\nstiffness = 12\n";
  test::expect_sensitivities(rocker.text(), "angle.rocker",
                             {"rolling_profile_on_circle.foot.offset", "rolling_profile_on_circle.foot.circle_radius",
                              "body.rocker.center.y", "point.rocker.C.x"});
}

/// Both kinds, open and closed: a chair, and an egg of a few points that a spring holds on a drum or in a ring.
std::string held_chair(const std::string& keys) {
  return chair(keys, "[[spring]]\npoints = [\"ground.A\", \"chair.S\"]\nstiffness = 40\nfree_length = 0.1\n");
}

std::string held_egg(const std::string& contact, const std::string& curve, double place, double angle) {
  return fmt::format(R"(
    gravity = [0, -10]
    [numbers]
    r = 0.3
    [ground]
    points = {{ A = [0, 0] }}
    [body.egg]
    points = {{ C = [0, 0] }}
    mass = 3
    center = [0.01, -0.04]
    inertia = 0.07
    [[rolling_profile_on_circle]]
    name = "shell"
    at = "egg.C"
    center = "ground.A"
    curve = {}
    {}
    [[torsion_spring]]
    bodies = ["ground", "egg"]
    stiffness = 14
    free_angle = {}
    [start]
    egg = {}
    "shell radius" = {}
    position = {{ egg = [0, {}] }}
  )",
                     curve, contact, angle, angle, place > 0.0 ? 1.57 : -1.57, place);
}

const std::string oval =
    "[[0, -0.2], [0.2, -0.13], [\"r\", 0], [0.22, 0.13], [0.01, 0.2], [-0.2, 0.14], [\"-r\", 0.01], [-0.21, -0.14]]";
const std::string on_drum = "closed = true\ncircle_radius = 0.9\noffset = -1.4\n";
const std::string in_ring = "closed = true\ninside = true\ncircle_radius = 0.9\noffset = -1.43\n";
const std::string bow = "[[-0.3, -0.05], [-0.15, -0.18], [0, -0.2], [0.16, -0.17], [0.31, -0.04]]";

std::vector<std::string> points_of(const std::string& path, int count) {
  std::vector<std::string> out;
  for (int k = 1; k <= count; ++k) {
    for (const char* axis : {"x", "y"}) out.push_back(fmt::format("{}.curve.{}.{}", path, k, axis));
  }
  return out;
}

TEST(RollingProfile, PointsHaveTheirExactSensitivities) {
  std::vector<std::string> numbers = points_of("rolling_profile.runner", 7);
  test::expect_sensitivities(held_chair("offset = 0.1"), "angle.chair", numbers);
  const std::string egg = "rolling_profile_on_circle.shell";
  std::string plain = oval;
  for (const char* name : {"\"r\"", "\"-r\""})
    plain.replace(plain.find(name), std::string(name).size(), name[1] == '-' ? "-0.3" : "0.3");
  numbers = points_of(egg, 8);
  numbers.push_back(egg + ".circle_radius");
  test::expect_sensitivities(held_egg(on_drum, plain, 1.1, 0.03), "angle.egg", numbers);
  test::expect_sensitivities(held_egg(in_ring, plain, -0.7, 0.05), "angle.egg", numbers);
  numbers = points_of(egg, 5);
  numbers.push_back(egg + ".offset");
  test::expect_sensitivities(held_egg("circle_radius = 0.9\noffset = -1.77", bow, 1.1, 0.05), "angle.egg", numbers);
  test::expect_sensitivities(held_egg(on_drum, oval, 1.1, 0.03), "angle.egg", {"numbers.r"});
}

/// Profiles, limits and held values of two scenes.
void expect_same_curves(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.stops.size(), b.stops.size());
  for (std::size_t s = 0; s < a.stops.size(); ++s) {
    EXPECT_NEAR(a.stops[s].min, b.stops[s].min, 1e-15);
    EXPECT_NEAR(a.stops[s].max, b.stops[s].max, 1e-15);
    for (std::size_t t = 0; t < a.stops[s].on.terms.size(); ++t) {
      const Measure::Term &one = a.stops[s].on.terms[t], &other = b.stops[s].on.terms[t];
      if (!one.profile) continue;
      EXPECT_NEAR(one.span, other.span, 1e-15);
      for (const double u : {-0.2, 0.1, 0.55, 0.97, 1.3}) {
        EXPECT_NEAR(one.factor * one.profile->at(u).value, other.factor * other.profile->at(u).value, 1e-14);
      }
    }
  }
}

TEST(RollingProfile, PointsAreThoseOfTheFile) {
  for (const std::string& text : {held_chair("from = 0.05"), held_chair("to = 0.5")}) {
    Scene scene = parse_scene(text, "chair.toml");
    const bool to_end = text.find("to = ") == std::string::npos;
    const double end = get_value(scene, "rolling_profile.runner.to");
    set_value(scene, "rolling_profile.runner.curve.7.x", 0.33);
    set_value(scene, "rolling_profile.runner.curve.4.y", -0.05);
    EXPECT_EQ(get_value(scene, "rolling_profile.runner.to") > end, to_end) << "an end that is given stays";
    const std::string written = rewritten_scene(text, "chair.toml", scene);
    EXPECT_NE(written.find("[0, -0.05], [0.1, -0.03], [0.2, 0.0], [0.33, 0.05]]"), std::string::npos) << written;
    EXPECT_EQ(written.find("to = ") == std::string::npos, to_end);
    expect_same_curves(parse_scene(written, "chair.toml"), scene);
    const Scales scales{.length = 0.25, .force = 8.0};
    Scene small = scaled(parse_scene(text, "chair.toml"), scales);
    set_value_at(small, parameter(scene, "rolling_profile.runner.curve.7.x").place, 4 * 0.33);
    set_value_at(small, parameter(scene, "rolling_profile.runner.curve.4.y").place, 4 * -0.05);
    expect_same_curves(scaled(small, {.length = 4.0, .force = 0.125}), scene);
  }
  for (const auto& [contact, place] : {std::pair(on_drum, 1.1), std::pair(in_ring, -0.7)}) {
    const std::string text = held_egg(contact, oval, place, 0.03);
    Scene scene = parse_scene(text, "egg.toml");
    set_value(scene, "numbers.r", 0.32);
    set_value(scene, "rolling_profile_on_circle.shell.curve.2.y", 0.135);
    expect_same_curves(parse_scene(rewritten_scene(text, "egg.toml", scene), "egg.toml"), scene);
  }
}

// More points than there are numbers for.
TEST(RollingProfile, LongCurvesHaveNoNumbersOfPoints) {
  Rocker rocker;
  EXPECT_FALSE(find_parameter(rocker.scene(), "rolling_profile.foot.curve.1.x").has_value());
  rocker.points = 64;
  EXPECT_TRUE(find_parameter(rocker.scene(), "rolling_profile.foot.curve.64.y").has_value());
}

TEST(RollingProfile, PointsThatDoNotRollAreRefused) {
  Scene scene = parse_scene(held_chair("to = 0.6"), "chair.toml");
  const auto refused = [&](const std::string& path, double value) {
    return test::message_of([&] { set_value(scene, path, value); });
  };
  const std::string runner = "rolling_profile.runner.curve.";
  const double span = scene.stops[0].on.terms[1].span;
  EXPECT_EQ(refused(runner + "7.x", 0.2), runner + "7.x: expected a place on the curve");
  set_value(scene, runner + "2.y", 0.05);
  EXPECT_EQ(
      refused(runner + "2.x", -0.3),
      runner + "2.x: expected points that differ from those before, found points 1 and 2 of the curve in one place");
  set_value(scene, runner + "2.y", 0.0);
  EXPECT_EQ(scene.stops[0].on.terms[1].span, span);
  EXPECT_EQ(get_value(scene, runner + "2.x"), -0.2) << "nothing has changed";
  Scene egg = parse_scene(held_egg(on_drum, oval, 1.1, 0.03), "egg.toml");
  const std::string shell = "rolling_profile_on_circle.shell.curve.";
  const auto found = [&](const std::string& path, double value) {
    return test::message_of([&] { set_value(egg, path, value); });
  };
  EXPECT_NE(found(shell + "1.y", 1.0).find("expected a curve that goes round once"), std::string::npos)
      << found(shell + "1.y", 1.0);
  EXPECT_NE(found(shell + "3.x", 0.5).find("change numbers.r"), std::string::npos);
}

// A closed curve that begins on top: files count the turns of its body from where that point touches, which half a turn
// further is one turn less.
TEST(RollingProfile, TurnsGoOnWhereItsFirstPointTurnsOver) {
  const std::string curve =
      "[[0, 0.2], [-0.2, 0.14], [-0.3, 0.01], [-0.21, -0.14], [0, -0.2], [0.2, -0.13], [0.3, 0], [0.22, 0.13]]";
  const std::string text = fmt::format(R"(
    [ground]
    points = {{ A = [0, 0] }}
    [body.egg]
    points = {{ C = [0, 0] }}
    mass = 3
    [[rolling_profile]]
    name = "shell"
    at = "egg.C"
    line = "ground.A"
    axis = [1, 0]
    curve = {}
    closed = true
    [start]
    position = {{ egg = [0, 0.2] }}
  )",
                                       curve);
  const Scene scene = parse_scene(text, "egg.toml");
  int refused = 0;
  for (const double by : {-0.01, 0.01}) {
    Scene turned = scene;
    set_value(turned, "rolling_profile.shell.curve.8.y", 0.13 + by);
    EXPECT_EQ(turned.stops[2].min, scene.stops[2].min);
    EXPECT_NEAR(turned.stops[2].on.terms[1].profile->at(0.0).value, scene.stops[2].on.terms[1].profile->at(0.0).value,
                0.1);
    const std::string message = test::message_of([&] { rewritten_scene(text, "egg.toml", turned); });
    if (message.empty()) continue;
    ++refused;
    EXPECT_EQ(
        message,
        "egg.toml: rolling_profile \"shell\".curve: expected a first point that touches within half a turn of the "
        "body, from which files count its turns; begin the curve at another point");
  }
  EXPECT_LE(refused, 1);
}

// In a scene that was built in code all stops are of line 0.
TEST(RollingProfile, KnowsItsOwnEnds) {
  std::string text = Rocker{}.text();
  text.insert(text.find("[start]"), fmt::format(R"(
    [body.chair]
    points = {{ O = [0, 0] }}
    [[rolling_profile]]
    at = "chair.O"
    curve = {}
    to = 0.5
    line = "ground.A"
    axis = [1, 0]
  )",
                                                arc_points));
  Scene scene = parse_scene(text, "two.toml");
  for (Stop& stop : scene.stops) stop.line = 0;
  ASSERT_EQ(scene.stops[3].table, "rolling_profile");
  EXPECT_EQ(range_of_profile(scene, 0), std::pair(0.0, 1.0));
  EXPECT_EQ(range_of_profile(scene, 3), std::pair(0.0, 0.5 / scene.stops[3].on.terms[1].span));
}

// --- limits ---------------------------------------------------------------------------------------------------------

std::string why_not(const std::string& text) {
  const StaticModel model(parse_scene(text, "scene.toml"));
  const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::any));
  EXPECT_NE(found.status, Status::confirmed);
  return found.why;
}

TEST(RollingProfile, IsNoEquilibriumWhereItDoesNotTouch) {
  Rocker lifted;
  lifted.more = "[[force]]\nat = \"rocker.W\"\nvector = [0, 40]\n";
  const std::string lifts = why_not(lifted.text());
  EXPECT_NE(lifts.find("lifts off, its profile"), std::string::npos) << lifts;
  // Pushed over the end of its runner.
  const std::string end = why_not(chair("", "[[force]]\nat = \"chair.S\"\nvector = [200, 0]\n", -0.4));
  EXPECT_NE(end.find("end of its curve"), std::string::npos) << end;
  // In its waist, a quarter of the curve before its first point, it would cut into the line.
  std::vector<Vec2> waisted;
  for (int k = 0; k < 60; ++k) {
    const double t = 2 * pi * k / 60;
    waisted.push_back((0.3 + 0.12 * std::cos(2 * t)) * unit(t));
  }
  Scene bone = parse_scene(fmt::format(R"(
    gravity = [0, -10]
    [ground]
    points = {{ A = [0, 0] }}
    [body.bone]
    points = {{ C = [0, 0] }}
    mass = 1
    [[rolling_profile]]
    at = "bone.C"
    curve = [{}]
    closed = true
    line = "ground.A"
    axis = [1, 0]
    [start]
    position = {{ bone = [0, 0.18] }}
  )",
                                       list_of(waisted)),
                           "bone.toml");
  const int curve = bone.stops[0].on.terms[1].measure.joint;
  bone.start.travel[static_cast<std::size_t>(curve)] = -0.25 * bone.stops[0].on.terms[1].span;
  const StaticModel model(bone);
  const Check cut = check(model, assemble(model));
  EXPECT_FALSE(cut.is_equilibrium());
  EXPECT_NE(cut.objection.find("cuts with its profile"), std::string::npos) << cut.objection;
}

TEST(RollingProfile, IsRefusedWhereItMayLiftOff) {
  const StaticModel model(Rocker{}.scene());
  const std::string message = test::message_of([&] { all_equilibria(model); });
  EXPECT_NE(message.find("may lift off"), std::string::npos) << message;
}

// The angle of an open one begins with the turns of its start.
TEST(RollingProfile, CountsTurnsOfItsBody) {
  for (const double turns : {-1.0, 0.0, 2.0}) {
    const StaticModel model(parse_scene(chair("", "", 0.05 + 2 * pi * turns), "chair.toml"));
    const StaticModel plain(parse_scene(chair(""), "chair.toml"));
    const Equilibrium found = solve(model, test::by(Method::virtual_work, Seek::any));
    const Equilibrium once = solve(plain, test::by(Method::virtual_work, Seek::any));
    ASSERT_TRUE(found.found()) << found.why;
    EXPECT_NEAR(test::angle_of(model, found.x, "chair"), test::angle_of(plain, once.x, "chair") + 2 * pi * turns, 1e-9);
  }
}

TEST(RollingProfile, NamesWhatIsWrong) {
  const std::string head = R"(
    [ground]
    points = { O = [0, 0] }
    [body.egg]
    points = { P = [0, 0], Q = [1, 0] }
  )";
  const auto has = [&](const std::string& text, const std::string& words) {
    const std::string message = test::message_of([&] { parse_scene(head + text, "scene.toml"); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  const std::string table = "[[rolling_profile]]\nat = \"egg.P\"\n", line = "line = \"ground.O\"\naxis = [1, 0]\n";
  const std::string round = "curve = [[1, 0], [0, 1], [-1, 0], [0, -1]]\nclosed = true\n";
  has(table + line, "curve");
  has(table + round + "axis = [1, 0]\n", "line");
  has(table + round + "line = \"ground.O\"\n", "axis");
  has(table + round + "line = \"ground.O\"\naxis = [0, 0]\n", "direction");
  has(table + round + "line = \"egg.Q\"\naxis = [1, 0]\n", "another body");
  has(table + round + "line = \"ground.X\"\naxis = [1, 0]\n", "ground.O");
  has(table + line + round + "from = 0\n", "expected one of the keys");
  has(table + line + round + "radius = 1\n", "expected one of the keys");
  has(table + line + "curve = [[1, 0], [0, 1]]\n", "three points");
  has(table + line + "curve = [[1, 0], [1, 0], [0, 1]]\n", "another point than the one before");
  has(table + line + "closed = true\ncurve = [[1, 0], [0, 1], [-1, 0], [1, 0]]\n", "returns anyway");
  has(table + line + "closed = true\ncurve = [[1, 0], [0, -1], [-1, 0], [0, 1]]\n", "counter-clockwise");
  has(table + line + "closed = true\ncurve = [[1, 1], [-1, -1], [-1, 1], [1, -1]]\n", "crosses itself");
  has(table + line + "curve = [[0, 0], [1, 0], [2, 0], [1, 0], [0, 0]]\n", "cusp");
  has(table + line + "curve = [[-1, 0], [0, 1], [1, 0]]\n", "bends away");
  has(table + line + "curve = [[-1, 1], [0, 0], [1, 1]]\nfrom = 2\nto = 1\n", "behind");
  has(table + line + "curve = [[-1, 1], [0, 0], [1, 1]]\nto = 4\n", "place on the curve");
  has(table + line + "curve = [[-1, 1], [0, 0], [1, 1]]\nfrom = -1\n", "place on the curve");
  const std::string circle = "[[rolling_profile_on_circle]]\nat = \"egg.P\"\ncenter = \"ground.O\"\n" + round;
  has(circle, "circle_radius");
  has(circle + "circle_radius = -1\n", "> 0");
  has(circle + "circle_radius = 0.5\ninside = true\n", "bends away");
  has("[body.\"e radius\"]\npoints = { P = [0, 0] }\n" + circle + "name = \"e\"\ncircle_radius = 1\n", "e radius");
}

}  // namespace
}  // namespace poise::statics_rolling_profile_test
