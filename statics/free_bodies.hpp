#pragma once

#include <string>
#include <vector>

#include "model/layout.hpp"
#include "model/mechanism.hpp"
#include "statics/check.hpp"

namespace poise {

/// Vector statics of a scene with its bodies at given places: every body cut free. Shares nothing with the phasor
/// model but the places themselves.
struct FreeBodies {
  double imbalance = 0.0;  ///< N: largest residual force, or moment / size, of a body
  int worst_body = 0;
  bool is_moment = false;        ///< the worst residual is a moment
  double largest_force = 0.0;    ///< N
  double largest_load = 0.0;     ///< N: without reactions
  double largest_applied = 0.0;  ///< N: weights, forces and torques only
  std::vector<Reaction> reactions;
  std::vector<int> pressing;  ///< stops that press, indices into Scene::stops
  int redundancy = 0;
};

/// `touching`: stops whose reaction may act, one entry (+1 at max, -1 at min, 2 at both, 0 not touching) per stop. A
/// stop that would have to pull is left out.
FreeBodies balance(const Scene& scene, const std::vector<BodyPose<double>>& poses, const std::vector<int>& touching,
                   double size);

}  // namespace poise
