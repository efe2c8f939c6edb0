#include "statics/model/pose_values.hpp"

#include <gtest/gtest.h>

#include "tests/support/build_scene.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::pose_values_test {
namespace {

TEST(Readings, AreTheSameFromAModelAndFromItsPoses) {
  const StaticModel model(read_scene(test::dataset("toggle_clamp.toml")));
  const std::vector<double> x = model.start();
  const Readings of_model = read_off(model, x), of_poses = readings_of(model.scene(), model.poses(x));
  ASSERT_EQ(of_model.poses.size(), model.scene().bodies.size());
  ASSERT_EQ(of_model.elements.size(), model.scene().elements.size());
  EXPECT_EQ(of_model.travel, of_poses.travel);
  EXPECT_EQ(of_model.stops, of_poses.stops);
  for (std::size_t i = 0; i < of_model.elements.size(); ++i) {
    EXPECT_EQ(of_model.elements[i].value, of_poses.elements[i].value);
    EXPECT_EQ(of_model.elements[i].force, of_poses.elements[i].force);
  }
}

TEST(Readings, NameTheNearerLimitOfAStop) {
  Stop stop;
  stop.min = -1.0;
  stop.max = 2.0;
  EXPECT_STREQ(pressed_limit(stop, -0.9).name, "min");
  EXPECT_EQ(pressed_limit(stop, -0.9).value, -1.0);
  EXPECT_STREQ(pressed_limit(stop, 2.1).name, "max");
  EXPECT_EQ(pressed_limit(stop, 2.1).value, 2.0);
}

TEST(PoseValues, NameAnglesTravelsAndThePlacesOfBodiesWithoutAWayToTheGround) {
  Scene scene = test::chain(2, 1.0, 1.0);
  test::add_link(scene, "block", 0.5, 1.0);
  scene.start.angle.resize(scene.bodies.size());
  scene.start.position.resize(scene.bodies.size());
  scene.start.position.back() = Vec2{3.0, 4.0};
  const StaticModel model(scene);
  const Readings readings = read_off(model, model.start());
  std::vector<std::string> names;
  for (const NamedValue& angle : angles_of(model, readings)) names.push_back(angle.name);
  EXPECT_EQ(names, (std::vector<std::string>{"1", "2", "block"}));
  EXPECT_TRUE(travels_of(model, readings).empty());
  EXPECT_EQ(free_bodies(model.layout()), std::vector<std::size_t>{3});
  const std::vector<NamedValue> places = places_of(model, readings);
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[0].name, "block.x");
  EXPECT_NEAR(places[0].value, 3.0, 1e-12);
  EXPECT_EQ(places[1].name, "block.y");
  EXPECT_NEAR(places[1].value, 4.0, 1e-12);
}

TEST(PoseValues, WeldedBodiesAreOneGroupInWhateverOrderTheyAreJoined) {
  Scene scene = test::chain(6, 1.0, 1.0);
  EXPECT_EQ(rigid_groups(scene), (std::vector<int>{0, 1, 2, 3, 4, 5, 6})) << "pins join nothing rigidly";
  const auto weld = [&scene](std::size_t joint) { scene.joints.at(joint).kind = Joint::Kind::weld; };
  weld(5);  // 5-6
  weld(3);  // 3-4
  weld(4);  // 4-5
  EXPECT_EQ(rigid_groups(scene), (std::vector<int>{0, 1, 2, 3, 3, 3, 3}));
  weld(0);  // ground-1
  EXPECT_EQ(rigid_groups(scene), (std::vector<int>{0, 0, 2, 3, 3, 3, 3}));
  scene.joints.at(2).kind = Joint::Kind::slide;
  EXPECT_EQ(rigid_groups(scene)[3], 3) << "a slide keeps the angle but not the place";
}

}  // namespace
}  // namespace poise::pose_values_test
