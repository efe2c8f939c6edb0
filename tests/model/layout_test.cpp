// The layout takes the scene's doubles as exact, in any scalar.

#include "model/layout.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "model/mechanism_impl.hpp"
#include "solvers/real50.hpp"
#include "tests/support/build_scene.hpp"

namespace poise::layout_test {
namespace {

const Link& link_of(const Layout& layout, const Scene& scene, const char* point) {
  return layout.links[static_cast<std::size_t>(test::point(scene, point).body)];
}

TEST(Layout, AddsArmsOfOneCoordinateWithoutRounding) {
  Scene scene;
  scene.add_point(0, "A", {0.1, 1e6});
  scene.add_point(0, "B", {1.7, 1e6 + 1});
  const int bar = scene.add_body("bar");
  scene.add_point(bar, "p", {0.1, 0.0});
  scene.add_point(bar, "r", {1.3, 0.0});
  test::add_pin(scene, "ground.A", "bar.p");
  const Layout layout = lay_out(scene, Purpose::statics);
  EXPECT_TRUE(layout.path(bar, {0.1, 0.0}, bar, {0.1, 0.0}).empty());
  const std::vector<Arm> there = layout.path(0, {1.7, 1e6 + 1}, bar, {1.3, 0.0});
  Real50 ground_x = 0, along = 0, ground_y = 0;
  for (const Arm& arm : there) {
    (arm.coordinate < 0 ? ground_x : along) += Real50(arm.arm.x);
    if (arm.coordinate < 0) ground_y += Real50(arm.arm.y);
  }
  EXPECT_EQ(ground_x, Real50(0.1) - Real50(1.7));
  EXPECT_EQ(ground_y, -1);
  EXPECT_EQ(along, Real50(1.3) - Real50(0.1));
  EXPECT_NE(Real50(1.3) - Real50(0.1), Real50(1.3 - 0.1));
  EXPECT_EQ(there.size(), 4u);  // two for each sum, as no double is equal to it
}

TEST(Layout, AddsAnglesOfWeldedBodiesWithoutRounding) {
  Scene scene;
  scene.add_point(0, "O", {0.0, 0.0});
  const double angles[] = {0.1, 0.2, -0.3};
  std::string previous = "ground.O";
  for (const double angle : angles) {
    const std::string name = "w" + std::to_string(scene.bodies.size());
    test::add_link(scene, name, 1.0);
    const int joint = test::add_pin(scene, previous, name + ".a");
    scene.joints[static_cast<std::size_t>(joint)].kind = Joint::Kind::weld;
    scene.joints[static_cast<std::size_t>(joint)].angle = angle;
    previous = name + ".b";
  }
  const Layout layout = lay_out(scene, Purpose::statics);
  EXPECT_EQ(layout.turns[static_cast<std::size_t>(link_of(layout, scene, "w1.a").turn)].to<double>(), 0.1);
  const Turn& last = layout.turns[static_cast<std::size_t>(link_of(layout, scene, "w3.a").turn)];
  EXPECT_EQ(last.to<double>(), std::ldexp(1.0, -55));
  const Mechanism<Real50> exact(scene);
  const Real50 none[] = {0};
  EXPECT_EQ(exact.poses(none)[3].angle, Real50(std::ldexp(1.0, -55)));
}

// 0.1 + 0.2 and 0.3 differ by 2^-54 (5.6e-17), half a turn either way by what is left of 2 pi beside twice its double.
TEST(Layout, KnowsByHowMuchRedundantAnglesDiffer) {
  const auto open_of = [](double first, double second, double both) {
    Scene scene;
    scene.add_point(0, "O", {0.0, 0.0});
    test::add_link(scene, "carriage", 1.0);
    test::add_link(scene, "platform", 1.0);
    const auto slide = [&](const std::string& a, const std::string& b, double angle) {
      test::add_slide(scene, a, b, {1.0, 0.0});
      scene.joints.back().angle = angle;
    };
    slide("ground.O", "carriage.a", first);
    slide("carriage.b", "platform.a", second);
    slide("ground.O", "platform.b", both);
    const Layout layout = lay_out(scene, Purpose::statics);
    EXPECT_EQ(layout.redundant_angle, std::vector<int>{2});
    EXPECT_EQ(layout.turns[0].open, 0.0);  // of the ground
    const double open = layout.turns[static_cast<std::size_t>(layout.links[1].turn)].open;
    EXPECT_EQ(layout.turns[static_cast<std::size_t>(layout.links[2].turn)].open, open);
    return open;
  };
  EXPECT_EQ(open_of(0.1, 0.2, 0.3), std::ldexp(1.0, -55));
  EXPECT_EQ(open_of(0.1, 0.2, 0.1 + 0.2), std::ldexp(1.0, -55));
  EXPECT_EQ(open_of(0.5, 0.25, 0.75), 0.0);
  EXPECT_NEAR(open_of(M_PI / 2, M_PI / 2, -M_PI), 2.4492935982947064e-16, 1e-30);
}

// A pendulum on the end of a crank that a bar ties to the ground. If the loop is open by so much, so may be the pin of
// the crank, which is at the origins of both bodies; what follows in the chain is known as before.
TEST(Layout, LoosensTheArmsOfALoop) {
  constexpr double open = 1e-9;
  Scene scene;
  scene.add_point(0, "O", {0.0, 0.0});
  scene.add_point(0, "A", {2.0, 0.0});
  test::add_link(scene, "crank", 1.0);
  test::add_link(scene, "pendulum", 0.5);
  test::add_pin(scene, "ground.O", "crank.a");
  test::add_pin(scene, "crank.b", "pendulum.a");
  test::add_bar(scene, "crank.b", "ground.A", 1.5);
  Layout layout = lay_out(scene, Purpose::statics);
  ASSERT_EQ(layout.closures.size(), 1u);
  const int crank = test::point(scene, "crank.a").body;
  const int pendulum = test::point(scene, "pendulum.a").body;
  EXPECT_TRUE(layout.path(0, {0.0, 0.0}, crank, {0.0, 0.0}).empty());
  layout.loosen({0.0});
  EXPECT_TRUE(layout.path(0, {0.0, 0.0}, crank, {0.0, 0.0}).empty());
  layout.loosen({open});
  for (const Arm& arm : layout.closures[0].arms) EXPECT_EQ(arm.open, (Vec2{open, open}));
  const std::vector<Arm> to_pin = layout.path(0, {0.0, 0.0}, crank, {0.0, 0.0});
  ASSERT_EQ(to_pin.size(), 1u);
  EXPECT_EQ(to_pin[0].arm, Vec2{});
  EXPECT_EQ(to_pin[0].open, (Vec2{open, open}));
  EXPECT_TRUE(layout.path(crank, {1.0, 0.0}, pendulum, {0.0, 0.0}).empty());
}

TEST(Layout, SharesEqualTurns) {
  const Scene scene = test::chain(5, 1.0, 1.0);
  EXPECT_EQ(lay_out(scene, Purpose::statics).turns.size(), 1u);
}

TEST(Layout, MeasuresFromTheFirstGroundPointThatSomethingUses) {
  Scene scene = test::chain(2, 1.5, 1.0);
  EXPECT_EQ(lay_out(scene, Purpose::statics).size, 3.0);
  scene.bodies[0].points[0].at = {1e6, 2e6};
  scene.add_point(0, "unused", {-1e9, 0.0});
  const Layout layout = lay_out(scene, Purpose::statics);
  EXPECT_EQ(layout.anchor, (Vec2{1e6, 2e6}));
  EXPECT_EQ(layout.size, 3.0);
  // A second ground point counts by its distance from the first once something uses it, here by a bar that
  // hangs on it.
  scene.add_point(0, "E", {1e6 + 30.0, 2e6 + 40.0});
  EXPECT_EQ(lay_out(scene, Purpose::statics).size, 3.0);
  test::add_bar(scene, "ground.E", "2.b", 48.0);
  EXPECT_EQ(lay_out(scene, Purpose::statics).size, 50.0 + 48.0);
  // A centre of mass counts as a point of its body.
  scene.bodies[2].center = {-60.0, 0.0};
  EXPECT_EQ(lay_out(scene, Purpose::statics).size, 50.0 + 48.0);
  scene.bodies[2].center = {-600.0, 0.0};
  EXPECT_EQ(lay_out(scene, Purpose::statics).size, 601.5);
  // Poses measured from the anchor keep what the world's coordinates lose.
  const Mechanism<double> mechanism(test::chain(2, 1.5, 1.0));
  const std::vector<double> q = {0.3, 0.4};
  const Vec2 from{1.0, 2.0};
  const auto world = mechanism.poses(q.data());
  const auto near = mechanism.poses(q.data(), from);
  EXPECT_EQ(near[0].origin, -from);
  for (std::size_t i = 1; i < world.size(); ++i) {
    EXPECT_NEAR(norm(world[i].origin - near[i].origin - from), 0.0, 1e-15);
    EXPECT_EQ(world[i].angle, near[i].angle);
  }
}

}  // namespace
}  // namespace poise::layout_test
