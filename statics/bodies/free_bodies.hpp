#pragma once

#include <string>
#include <vector>

#include "model/layout.hpp"
#include "model/mechanism.hpp"
#include "statics/bodies/reaction.hpp"

namespace poise {

/// A load on a body in addition to those of the scene: force, N, at a point `at`, m, and moment, N m.
struct BodyLoad {
  int body = 0;
  Vec2 at{};
  Vec2 force{};
  double moment = 0.0;
};

/// Loads and drives in addition to those of a scene.
struct Additions {
  std::vector<BodyLoad> loads;
  /// Drives whose force along a travel, or torque between two bodies, is to be found with the reactions. They come as
  /// reactions of the kind "drive", after all others.
  std::vector<Drive> drives;
  /// Blades of the scene take forces across their edges: reactions of the kind "blade", after joints and stops and
  /// before drives.
  bool blades = false;
  /// Teeth that carry a force push their wheels apart; false leaves that out, for what is linear in the loads.
  bool teeth_separate = true;
};

/// Vector statics of a scene with its bodies at given poses: every body cut free. Shares nothing with the phasor model
/// but the poses.
struct FreeBodies {
  double imbalance = 0.0;  ///< N: largest residual force, or moment / size, of a body
  int worst_body = 0;
  bool is_moment = false;        ///< the worst residual is a moment
  double largest_force = 0.0;    ///< N
  double largest_load = 0.0;     ///< N: without reactions
  double largest_applied = 0.0;  ///< N: weights, forces, torques and additions only
  /// Static force T of every element of the scene, N or N m: positive if it tends to reduce its measure.
  std::vector<double> element_force;
  std::vector<Reaction> reactions;
  std::vector<int> pressing;  ///< active stops, indices into Scene::stops
  /// Where the bodies could balance only if some stops pulled that can only push: such stops, of which none can be left
  /// out. The reactions are then those of non-negative least squares, which do not balance.
  std::vector<int> pulling;
  int redundancy = 0;
};

/// Finds the reactions and the imbalance. Poses may be measured from any point of the world, and additions are measured
/// from there too; points of reactions are in the world. `touching`: stops whose reaction may act, one entry (+1 at
/// max, -1 at min, 2 at both, 0 not touching) per stop. Of the sets of reactions that balance the bodies and in which
/// stops at one side push, the one of least norm is reported, if there is any; a stop at both sides may push either
/// way, and so may a distance that is at most zero, which is a pin. Other stops on a distance of zero have no direction
/// and carry nothing.
FreeBodies balance(const Scene& scene, const std::vector<BodyPose<double>>& poses, const std::vector<int>& touching,
                   double size, const Additions& additions = {});

/// The reaction of a stop that carries nothing in a solution in which it shares a load with others: its place and
/// bodies without a force, undetermined.
Reaction idle_reaction(const Scene& scene, const std::vector<BodyPose<double>>& poses, int stop);

}  // namespace poise
