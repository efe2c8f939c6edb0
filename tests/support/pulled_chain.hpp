#pragma once

#include <string>

#include "tests/support/build_scene.hpp"

namespace poise::test {

/// Links of 1 m and 1 kg on ground.O under gravity 10 m/s^2, with a level force of 1 N at the tip.
inline Scene pulled_chain(int count) {
  Scene scene = chain(count, 1.0, 1.0);
  scene.gravity = {0.0, -10.0};
  add_force(scene, std::to_string(count) + ".b", {1.0, 0.0}, "F");
  return scene;
}

}  // namespace poise::test
