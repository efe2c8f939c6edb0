// Mechanisms whose equations repeat each other at the start and contradict each other beyond: driven twice, driven
// though rigid, shaky. The judge looks at the places of bodies alone.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "comparison/random.hpp"
#include "comparison/redundant_scenes.hpp"
#include "motion/confirmed_motion.hpp"
#include "tests/support/motions.hpp"
#include "tests/support/parallel_links.hpp"
#include "tests/support/seed.hpp"

namespace poise::torn_motions_test {
namespace {

using comparison::Random;

/// The largest distance of the two points of a pin, of a point from its slot, and of a driven angle from its law, at
/// any node.
double gap_of(const MotionModel& model, const Motion& motion) {
  const Scene& scene = model.scene();
  const Trajectory& path = motion.trajectory;
  const auto n = static_cast<std::size_t>(path.coordinates);
  double worst = 0.0;
  std::vector<double> angles;
  for (std::size_t node = 0; node < path.nodes(); ++node) {
    const auto first = path.q.begin() + static_cast<std::ptrdiff_t>(node * n);
    const std::vector<BodyPose<double>> poses =
        model.poses(model.from_si({first, first + static_cast<std::ptrdiff_t>(n)}));
    const auto world = [&](PointRef p) { return poses[static_cast<std::size_t>(p.body)].world(scene.local(p)); };
    for (const Joint& joint : scene.joints) {
      const Vec2 apart = world(joint.b) - world(joint.a);
      const Vec2 along = joint.direction() * poses[static_cast<std::size_t>(joint.a.body)].direction();
      worst = std::max(worst, joint.has_travel() ? std::abs(cross(along, apart)) : norm(apart));
    }
    for (std::size_t d = 0; d < scene.drives.size(); ++d) {
      const Drive& drive = scene.drives[d];
      const double angle = poses[static_cast<std::size_t>(drive.on.body_b)].angle;
      if (node == 0) angles.push_back(angle);
      worst = std::max(worst, std::abs(angle - angles[d] - drive.moved(path.t[node], 0)));
    }
  }
  return worst;
}

std::string body(const std::string& name, const std::string& points) {
  return fmt::format("[body.{}]\npoints = {{ {} }}\nmass = 1\ncenter = [0.3, 0.1]\ninertia = 0.5\n", name, points);
}

std::string pin(const std::string& name, const std::string& a, const std::string& b) {
  return fmt::format("[[pin]]\nname = \"{}\"\npoints = [\"{}\", \"{}\"]\n", name, a, b);
}

std::string drive(const std::string& name, const std::string& on, double rate, double acceleration = 0.0) {
  return fmt::format("[[drive]]\nname = \"{}\"\nbodies = [\"ground\", \"{}\"]\nrate = {}\nacceleration = {}\n", name,
                     on, rate, acceleration);
}

std::string four_bar(double crank, double coupler_length, double rocker_length, double angle, double elbow) {
  // The place of C from both circles.
  const double bx = crank * std::cos(angle), by = crank * std::sin(angle), dx = 3 - bx, dy = -by;
  const double d = std::hypot(dx, dy);
  const double along = (d * d + coupler_length * coupler_length - rocker_length * rocker_length) / (2 * d);
  const double across = elbow * std::sqrt(coupler_length * coupler_length - along * along);
  const double cx = bx + (along * dx - across * dy) / d, cy = by + (along * dy + across * dx) / d;
  return "gravity = [0, -9.81]\n[ground]\npoints = { A = [0, 0], D = [3, 0] }\n" +
         body("crank", fmt::format("A = [0, 0], B = [{}, 0]", crank)) +
         body("coupler", fmt::format("B = [0, 0], C = [{}, 0]", coupler_length)) +
         body("rocker", fmt::format("D = [0, 0], C = [{}, 0]", rocker_length)) + pin("A", "ground.A", "crank.A") +
         pin("B", "crank.B", "coupler.B") + pin("C", "coupler.C", "rocker.C") + pin("D", "ground.D", "rocker.D") +
         fmt::format("[start]\ncrank = {}\ncoupler = {}\nrocker = {}\n", angle, std::atan2(cy - by, cx - bx),
                     std::atan2(cy, cx - 3));
}

enum class End { refused, torn, confirmed, other };

End end_of(const std::string& text, double duration) {
  const MotionModel model(parse_scene(text, "scene.toml"));
  try {
    MotionOptions options;
    options.duration = duration;
    const ConfirmedMotion found = simulate_and_confirm(model, start_motion(model, {}), options);
    const double gap = gap_of(model, found.motion);
    // What it says of its gap is true, in sizes of the mechanism.
    EXPECT_LE(gap, (1 + 1e-6) * found.motion.gap * std::max(1.0, model.scales().length) + 1e-12);
    if (found.confirmed()) {
      EXPECT_LE(gap, *found.error * std::max(1.0, model.scales().length) + 1e-12);
      return End::confirmed;
    }
    if (found.motion.status != MotionStatus::torn) return End::other;
    // What is left of the motion is whole.
    EXPECT_LE(gap, 1e-8 * std::max(1.0, model.scales().length));
    EXPECT_GT(found.motion.gap * std::max(1.0, model.scales().length), gap);
    return End::torn;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("drive"), std::string::npos) << error.what();
    return End::refused;
  }
}

TEST(TornMotions, ADriveThatContradictsAnotherIsRefused) {
  const std::string scene = four_bar(1, 3, 2, 1, 1);
  EXPECT_EQ(end_of(scene + drive("motor", "crank", 1), 2), End::confirmed);
  EXPECT_EQ(end_of(scene + drive("motor", "crank", 1) + drive("brake", "rocker", 0), 2), End::refused);
  EXPECT_EQ(end_of(scene + drive("motor", "crank", 1) + drive("second", "crank", 2), 2), End::refused);
  // At rest both agree, and twice the same law is one.
  EXPECT_EQ(end_of(scene + drive("motor", "crank", 0) + drive("brake", "rocker", 0), 2), End::confirmed);
  EXPECT_EQ(end_of(scene + drive("motor", "crank", 1) + drive("second", "crank", 1), 2), End::confirmed);
}

TEST(TornMotions, DrivesThatPartLaterEndTheMotionThere) {
  const std::string scene = four_bar(1, 3, 2, 1, 1);
  EXPECT_EQ(end_of(scene + drive("motor", "crank", 1) + drive("second", "crank", 1, 0.5), 2), End::torn);
}

TEST(TornMotions, ADrivenTriangleIsRefused) {
  const std::string scene = "[ground]\npoints = { A = [0, 0], B = [2, 0] }\n" + body("a", "A = [0, 0], C = [1, 1]") +
                            body("b", "B = [0, 0], C = [-1, 1]") + pin("A", "ground.A", "a.A") +
                            pin("B", "ground.B", "b.B") + pin("C", "a.C", "b.C");
  EXPECT_EQ(end_of(scene + drive("motor", "a", 1), 1), End::refused);
  EXPECT_EQ(end_of(scene + drive("motor", "a", 0), 1), End::confirmed);
}

TEST(TornMotions, ShakyLinksDoNotFall) {
  EXPECT_EQ(end_of(test::three_links(0.01, -M_PI / 2, 3), 2), End::torn);
  EXPECT_EQ(end_of(test::three_links(0.0, -M_PI / 2, 3), 2), End::confirmed);
}

// No motion is confirmed whose joints open; what is redundant everywhere stays confirmed.
TEST(TornMotions, RandomOnesAreNeverConfirmed) {
  const int count = test::cases(40, 400);
  int at_rest = 0;
  for (int k = 0; k < count; ++k) {
    Random random(test::seed(7000) + static_cast<std::uint64_t>(k));
    SCOPED_TRACE(k);
    const double angle = random.uniform(0.3, 2.8);
    const int elbow = random.chance(0.5) ? 1 : -1;
    const double rocker = random.uniform(2, 2.6), coupler = random.uniform(2.6, 3.2), crank = random.uniform(0.5, 1.2);
    const std::string linkage = four_bar(crank, coupler, rocker, angle, elbow);
    const double rate = random.uniform(0.5, 2), other = rate + random.uniform(0.01, 1);
    EXPECT_EQ(end_of(linkage + drive("motor", "crank", rate) + drive("brake", "rocker", 0), 1), End::refused);
    EXPECT_EQ(end_of(linkage + drive("one", "coupler", rate) + drive("two", "coupler", other), 1), End::refused);
    EXPECT_EQ(end_of(linkage + drive("one", "crank", rate) + drive("two", "crank", rate, other), 1), End::torn);
    const double shorter = std::pow(10, random.uniform(-3, -0.7)), leaning = -random.uniform(0.4, 2.7);
    // Where gravity happens to point along the links they hardly move.
    const End shaky = end_of(test::three_links(shorter, leaning, random.uniform(-9, 9)), 1);
    EXPECT_TRUE(shaky == End::torn || shaky == End::confirmed);
    at_rest += shaky == End::confirmed ? 1 : 0;
    EXPECT_EQ(end_of(test::three_links(0, leaning, random.uniform(-9, 9)), 1), End::confirmed);
  }
  EXPECT_LE(at_rest, count / 100);
}

void expect_confirmed(std::uint64_t seed) {
  const MotionModel model(comparison::redundant_scene(seed));
  MotionOptions options;
  options.duration = 0.5;
  const ConfirmedMotion found = simulate_and_confirm(model, start_motion(model, {}), options);
  ASSERT_TRUE(found.confirmed()) << seed << ": " << found.motion.why << found.why_unknown;
  EXPECT_LE(gap_of(model, found.motion), *found.error * std::max(1.0, model.scales().length) + 1e-12) << seed;
}

TEST(TornMotions, WhatRepeatsEverywhereIsConfirmed) {
  const int count = test::cases(60, 500);
  for (int k = 0; k < count; ++k) expect_confirmed(test::seed(8000) + static_cast<std::uint64_t>(k));
}

// These pass places where the rows that are used do not depend on a coordinate any more, but those left out do: they
// were called torn, or steps became too short.
TEST(TornMotions, OtherRowsAreUsedWhereThoseUsedVanish) {
  for (const std::uint64_t seed : {101U, 126U, 335U, 403U, 492U}) expect_confirmed(seed);
}

}  // namespace
}  // namespace poise::torn_motions_test
