#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/mechanism.hpp"
#include "model/scene.hpp"
#include "statics/bodies/reaction.hpp"

namespace poise {

/// What acts on one body: a weight, force, torque or spring, a joint, stop or drive, or its inertia.
struct SourcedForce {
  std::string
      kind;  ///< "weight", "force", "torque", the table of an element, the kind of a Reaction, "drive", "inertia"
  std::string name;  ///< of a weight and of inertia that of the body
  BodyForce on;
};

/// Adds what acts on a body at a point: to what does so there already, or behind it.
void add_at_place(const BodyForce& on, std::vector<BodyForce>& parts);

/// Adds the force and moment on both bodies, or on all, of an effort on a measure: positive where it tends to increase
/// the measure. Entries on one body at one point are one.
void add_effort(const Scene& scene, const std::vector<BodyPose<double>>& poses, const Measure& on, double effort,
                std::string_view kind, const std::string& name, std::vector<SourcedForce>& out);

/// Everything that acts on the bodies of a scene at rest, the ground too: loads, elements with their forces T (positive
/// where they tend to reduce their measures, N or N m) and reactions. On each body but the ground the forces, and the
/// moments about any point, sum to zero where it is in balance. Poses are in the world.
std::vector<SourcedForce> forces_on_bodies(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                           const std::vector<double>& element_forces,
                                           const std::vector<Reaction>& reactions);

}  // namespace poise
