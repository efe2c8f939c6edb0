#include "model/scene.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace poise::scene_test {
namespace {

TEST(Scene, BeginsWithTheGroundAlone) {
  const Scene scene;
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].name, "ground");
  EXPECT_EQ(scene.start.angle.size(), 1u);
  EXPECT_EQ(scene.start.position.size(), 1u);
  EXPECT_TRUE(scene.start.travel.empty());
}

TEST(Scene, GrowsWithItsStart) {
  Scene scene;
  const PointRef o = scene.add_point(0, "O", {1.0, 2.0});
  const int crank = scene.add_body("crank");
  EXPECT_EQ(crank, 1);
  scene.add_point(crank, "O", {});
  const PointRef b = scene.add_point(crank, "B", {0.5, 0.0});
  EXPECT_EQ(scene.name_of(b), "crank.B");
  EXPECT_EQ(scene.local(b), (Vec2{0.5, 0.0}));
  Joint pin;
  pin.a = o;
  pin.b = b;
  EXPECT_EQ(scene.add_joint(pin), 0);
  EXPECT_EQ(scene.joints[0].name, "ground.O-crank.B");
  EXPECT_EQ(scene.start.angle.size(), 2u);
  EXPECT_EQ(scene.start.position.size(), 2u);
  EXPECT_EQ(scene.start.travel.size(), 1u);
}

class SlideOnAxis : public testing::Test {
 protected:
  Vec2 direction_of(Vec2 axis) {
    Scene scene;
    Joint slide;
    slide.kind = Joint::Kind::slide;
    slide.a = scene.add_point(0, "O", {});
    slide.b = scene.add_point(scene.add_body("block"), "C", {});
    slide.axis = axis;
    scene.add_joint(slide);
    return scene.joints[0].direction();
  }
};

TEST_F(SlideOnAxis, IsAUnitVectorWithoutOverflow) {
  EXPECT_EQ(direction_of({0.0, -2.0}), (Vec2{0.0, -1.0}));
  for (const double size : {1e-320, 1e-200, 1.0, 1e200}) {
    const Vec2 axis = direction_of({3.0 * size, 4.0 * size});
    // A denormal keeps only part of its digits, so its direction is known less well.
    const double tolerance = size < 1e-300 ? 1e-3 : 1e-15;
    EXPECT_NEAR(axis.x, 0.6, tolerance) << size;
    EXPECT_NEAR(axis.y, 0.8, tolerance) << size;
    EXPECT_NEAR(norm(axis), 1.0, 1e-15) << size;
  }
}

TEST_F(SlideOnAxis, MustHaveADirection) {
  EXPECT_THROW(direction_of({0.0, 0.0}), InputError);
  EXPECT_THROW(direction_of({1.0, std::numeric_limits<double>::infinity()}), InputError);
  EXPECT_THROW(direction_of({std::numeric_limits<double>::quiet_NaN(), 1.0}), InputError);
  EXPECT_THROW(direction_of({1.0, std::numeric_limits<double>::quiet_NaN()}), InputError);
}

TEST(Scene, RejectsInvalidIndices) {
  Scene scene;
  EXPECT_THROW(scene.add_point(1, "O", {}), std::out_of_range);
  EXPECT_THROW(scene.name_of({0, 0}), std::out_of_range);
}

}  // namespace
}  // namespace poise::scene_test
