// Contacts of curves, against distances of curves found by themselves.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/rolling_profile.hpp"
#include "motion/simulate.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/static_model.hpp"
#include "tests/support/known_answers.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/motions.hpp"

namespace poise::curve_contacts_test {
namespace {

Scene oval_cam() { return read_scene(test::dataset("machines/oval_cam.toml")); }

/// The same with its bodies elsewhere, deg and mm.
Scene oval_cam_at(double cam, double guide) {
  std::ifstream file(test::dataset("machines/oval_cam.toml"));
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text.resize(text.find("[start]"));
  return parse_scene(text + fmt::format("[start]\ncam = {}\nguide = {}\n", cam, guide), "oval_cam.toml");
}

/// Places of a spline through points in the frame of its body, m.
class Shape {
 public:
  explicit Shape(const std::vector<Vec2>& points) : curve_(points, true), of_(curve_.components()) {}
  Vec2 at(double u) const {
    const double in_turn = u - std::floor(u);
    return {of_.first.at(in_turn).value, of_.second.at(in_turn).value};
  }

 private:
  RollingCurve<double> curve_;
  std::pair<Profile, Profile> of_;
};

/// The largest value of f on the circle of `turn`: of a grid, then by golden sections.
template <class F>
double largest(F f, double turn, int grid) {
  const double step = turn / grid;
  double best = f(0.0), at = 0.0;
  for (int k = 1; k < grid; ++k) {
    if (const double here = f(k * step); here > best) best = here, at = k * step;
  }
  const double part = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = at - step, high = at + step;
  double a = high - part * (high - low), b = low + part * (high - low), of_a = f(a), of_b = f(b);
  for (int k = 0; k < 45; ++k) {
    if (of_a > of_b) {
      high = b, b = a, of_b = of_a;
      a = high - part * (high - low), of_a = f(a);
    } else {
      low = a, a = b, of_a = of_b;
      b = low + part * (high - low), of_b = f(b);
    }
  }
  return std::max({best, of_a, of_b});
}

/// How far a shape reaches in a direction of its body.
double reach(const Shape& shape, Vec2 direction) {
  return largest([&](double u) { return dot(direction, shape.at(u)); }, 1.0, 120);
}

/// The distance of two convex shapes in these places: the largest gap between parallel lines that part them; where they
/// overlap, less than zero by the shortest way apart.
double distance(const Shape& a, const BodyPose<double>& at_a, const Shape& b, const BodyPose<double>& at_b) {
  return largest(
      [&](double angle) {
        return dot(unit(angle), at_b.origin - at_a.origin) - reach(a, unit(angle - at_a.angle)) -
               reach(b, unit(angle + M_PI - at_b.angle));
      },
      2 * M_PI, 60);
}

struct Shapes {
  Shape first, second;
};
Shapes shapes_of(const Scene& scene) {
  const auto touch = std::find_if(scene.stops.begin(), scene.stops.end(),
                                  [](const Stop& stop) { return stop.table == "curve_contact"; });
  return {Shape(touch->curve), Shape((touch + 1)->curve)};
}

/// The value of the first stop of the contact of a scene in a pose.
double gap_of(const Scene& scene, const std::vector<BodyPose<double>>& poses) {
  const auto touch = std::find_if(scene.stops.begin(), scene.stops.end(),
                                  [](const Stop& stop) { return stop.table == "curve_contact"; });
  return value_of(scene, touch->on, poses);
}

/// Where a distance that grows with the height is zero, near a height: by secants.
template <class Distance>
double touching_height(Distance at, double near) {
  double a = near, b = near + 1e-3, of_a = at(a), of_b = at(b);
  for (int k = 0; k < 12 && std::abs(of_b) > 1e-14 && of_a != of_b; ++k) {
    const double next = b - of_b * (b - a) / (of_b - of_a);
    a = b, of_a = of_b;
    b = next, of_b = at(b);
  }
  return b;
}

// The cam turned by any angle below a shoe that is held above it: the distance that the scene has is that of the
// curves.
TEST(CurveContacts, HaveTheDistanceOfTheirCurves) {
  for (const double turn : {-170.0, -90.0, -31.0, 0.0, 12.0, 77.0, 140.0, 180.0}) {
    for (const double up : {0.0, 15.0}) {
      const Scene scene = oval_cam_at(turn, up);
      const MotionModel model(scene);
      const MotionState start = start_motion(model, {});
      const std::vector<BodyPose<double>> poses = model.poses(model.from_si(start.q));
      EXPECT_NEAR(poses[1].angle, turn * M_PI / 180, 1e-12) << "the guesses of the bodies stay";
      EXPECT_NEAR(poses[2].origin.y, 60e-3 + up * 1e-3, 1e-12);
      const Shapes shapes = shapes_of(scene);
      EXPECT_NEAR(gap_of(scene, poses), distance(shapes.first, poses[1], shapes.second, poses[2]), 1e-10)
          << turn << ", " << up;
    }
  }
}

// At rest they touch, and the energy of weight and springs has no slope along the positions in which they do.
TEST(CurveContacts, RestWhereTheEnergyOfTouchingPositionsIsLeast) {
  const Scene scene = oval_cam();
  const StaticModel model(scene);
  const Equilibrium found = solve(model);
  ASSERT_TRUE(found.found()) << found.why;
  const std::vector<BodyPose<double>> poses = model.poses(found.x);
  EXPECT_NEAR(gap_of(scene, poses), 0.0, 1e-12);
  const Shapes shapes = shapes_of(scene);
  // The height of the shoe that touches the cam at an angle, where the distance is zero.
  const auto height = [&](double angle) {
    return touching_height(
        [&](double y) {
          return distance(shapes.first, {{0.0, 0.0}, angle}, shapes.second, {{poses[2].origin.x, y}, 0.0});
        },
        poses[2].origin.y);
  };
  const auto energy = [&](double angle) {
    const double y = height(angle), travel = y - 60e-3;
    return 0.5 * 9.81 * y + 0.8 * 9.81 * 6e-3 * std::sin(angle) +
           0.5 * 0.016 * 180 / M_PI * std::pow(angle - 40 * M_PI / 180, 2) + 0.5 * 600 * std::pow(travel + 60e-3, 2);
  };
  const double at = poses[1].angle;
  EXPECT_NEAR(height(at), poses[2].origin.y, 1e-9);
  constexpr double h = 1e-3;
  const double slope = (8 * (energy(at + h) - energy(at - h)) - (energy(at + 2 * h) - energy(at - 2 * h))) / (12 * h);
  EXPECT_NEAR(slope, 0.0, 2e-6) << "N m, of moments of about 0.1";
  EXPECT_GT(energy(at + 0.1), energy(at));
  EXPECT_GT(energy(at - 0.1), energy(at));
}

// A shoe that falls hits the cam, which is held, as a ball does: after sqrt(2 h / g), and leaves with e times its
// speed.
TEST(CurveContacts, AreHitAsTheirDistanceSays) {
  const Scene scene = parse_scene(R"(
gravity = [0, -10]
[ground]
points = { O = [0, 0], G = [0.02, 0.2] }
[body.shoe]
points = { C = [0, 0] }
mass = 2
[[slide]]
name = "guide"
points = ["ground.G", "shoe.C"]
axis = [0, 1]
[[curve_contact]]
name = "touch"
at = "ground.O"
curve = [[0.06, 0], [0, 0.04], [-0.06, 0], [0, -0.04]]
against = "shoe.C"
against_curve = [[0.03, 0], [0, 0.05], [-0.03, 0], [0, -0.05]]
restitution = 0.5
[start]
guide = 0
)",
                                  "drop.toml");
  const MotionModel model(scene);
  const MotionState start = start_motion(model, {});
  const Shapes shapes = shapes_of(scene);
  const auto at_height = [&](double y) {
    return distance(shapes.first, {{0.0, 0.0}, 0.0}, shapes.second, {{0.02, y}, 0.0});
  };
  const double touching = touching_height(at_height, 0.09);
  const double fall = 0.2 - touching, when = std::sqrt(2 * fall / 10);
  const Motion motion = test::moved(model, start, 1.9 * when, 1e-10);
  ASSERT_GE(motion.events.size(), 1U);
  EXPECT_EQ(motion.events[0].kind, ContactEvent::Kind::impact);
  EXPECT_NEAR(motion.events[0].t, when, 1e-8);
  EXPECT_NEAR(motion.energy_error, 0.0, 1e-10);
  const std::vector<double> q = test::read_at(motion, {1.9 * when})[0].q;
  const double y = model.poses(model.from_si(q))[1].origin.y, later = 0.9 * when;
  EXPECT_NEAR(y, touching + 0.5 * 10 * when * later - 5 * later * later, 1e-8);
}

// An oscillation of the cam with the shoe on it keeps the energy while they touch, and they never overlap.
TEST(CurveContacts, MoveWithoutOverlap) {
  const Scene scene = oval_cam();
  const MotionModel model(scene);
  std::vector<StartValue> wanted{{test::coordinate_of(model, "cam"), true, 12.0}};
  const Motion motion = test::moved(model, start_motion(model, wanted), 0.6, 1e-9);
  EXPECT_LT(motion.energy_error, 1e-8);
  const Shapes shapes = shapes_of(scene);
  for (int k = 0; k <= 12; ++k) {
    const std::vector<double> q = test::read_at(motion, {0.05 * k})[0].q;
    const std::vector<BodyPose<double>> poses = model.poses(model.from_si(q));
    const double apart = distance(shapes.first, poses[1], shapes.second, poses[2]);
    EXPECT_NEAR(gap_of(scene, poses), apart, 1e-8) << k;
  }
}

TEST(CurveContacts, RefuseCurvesThatAreNotConvex) {
  const auto with = [](const std::string& curve) {
    return test::message_of([&] {
      return parse_scene(fmt::format(R"(
[ground]
points = {{ O = [0, 0] }}
[body.shoe]
points = {{ C = [0, 0] }}
mass = 2
[[curve_contact]]
at = "ground.O"
curve = [[0.06, 0], [0, 0.04], [-0.06, 0], [0, -0.04]]
against = "shoe.C"
against_curve = {}
)",
                                     curve),
                         "shoe.toml");
    });
  };
  EXPECT_NE(with("[[0.03, 0], [0, -0.05], [-0.03, 0], [0, 0.05]]").find("counter-clockwise"), std::string::npos);
  EXPECT_NE(with("[[0.05, 0], [0.01, 0.01], [0, 0.05], [-0.05, 0], [0, -0.05]]").find("convex"), std::string::npos);
  EXPECT_NE(with("[[0.05, 0], [0, 0.05]]").find("three points"), std::string::npos);
}

}  // namespace
}  // namespace poise::curve_contacts_test
