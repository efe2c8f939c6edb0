#pragma once

#include <cstdint>
#include <vector>

#include "model/scene.hpp"

namespace poise::test {

/// A random mechanism and a closed pose of it, far from equilibrium, from which it is released.
struct ReleasedScene {
  Scene scene;
  std::vector<double> x;  ///< coordinates of the scaled StaticModel
  int freedoms = 0;
};

/// Mechanisms with one freedom: loops of every kind, springs that pull, press or both, loads, in one of five a load
/// that follows a body, in half of them stops. In one of three a torque is added with which the force almost vanishes,
/// or barely does, somewhere on the way: two equilibria as close as 1e-5, or a gap through which the motion just
/// passes.
ReleasedScene release_one_freedom(std::uint64_t seed);

/// Mechanisms with two to five freedoms: with loops, and chains on springs between stops. No follower loads.
ReleasedScene release_several_freedoms(std::uint64_t seed);

}  // namespace poise::test
