#include "model/set_parameter.hpp"

#include <string>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "tests/identification/bench.hpp"

namespace poise::set_parameter_test {
namespace {

TEST(SetParameter, NamesTheError) {
  Scene scene = parse_scene(test::bench_scene, "scene.toml");
  set_parameter(scene, "body.block.mass=+12");
  EXPECT_DOUBLE_EQ(scene.bodies[3].mass, 0.012);
  const auto error_of = [&](const std::string& setting) {
    try {
      set_parameter(scene, setting);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(error_of("load.P"), "--set load.P: there is no \"=\"; expected PATH=NUMBER, say load.P=40");
  EXPECT_EQ(error_of("load.P=4x"), "--set load.P=4x: \"4x\" is not a number; expected PATH=NUMBER, say load.P=40");
  EXPECT_EQ(error_of("load.P="), "--set load.P=: \"\" is not a number; expected PATH=NUMBER, say load.P=40");
  EXPECT_EQ(error_of("load.P=-1"), "--set load.P: expected a finite number >= 0, found -1");
}

}  // namespace
}  // namespace poise::set_parameter_test
