#pragma once

#include <optional>
#include <vector>

#include "model/cam_geometry.hpp"
#include "model/scene.hpp"

namespace poise {

/// All points that pins and welds keep where p is, p first.
std::vector<PointRef> coincident_points(const Scene& scene, PointRef p);

/// Where the teeth of a gear or of a rack mesh: the axes of the wheels are points of their carrier.
///
///   gear  wheel b turns about `axis_b`, wheel a about `axis_a`; the pitch point divides the line of centres in the
///   ratio
///         of the pitch radii, r_a / r_b = ratio, between the axes or, of wheels one inside the other, beyond them
///   rack  the pinion turns about `axis_a`; the slide's other body than the carrier is the rack
struct Meshing {
  PointRef axis_a, axis_b;      ///< points of the carrier; b is not used of a rack
  int body_a = 0;               ///< wheel a, or the pinion
  int body_b = 0;               ///< wheel b, or the rack
  int slide = -1;               ///< joint of a rack
  bool rack_is_second = false;  ///< of its points the second is the rack's
};

/// Of a gear or rack of the scene; nothing where a wheel does not turn about a pin on its carrier, where both axes are
/// one, where the wheels of an internal gear are equal, and of a rack whose slide does not join it with the carrier.
std::optional<Meshing> meshing(const Scene& scene, const Stop& stop);

/// Its contact force acts where the teeth mesh, or at the roller of a cam, and so loads bearings and guides: the scene
/// gives a pressure angle, or the roller. That of other couplings acts on their measures alone.
bool loads_bearings(const Stop& stop);

/// The parts of a scene between which the contact force of a coupling acts that loads bearings.
struct ContactPlace {
  std::optional<Meshing> mesh;     ///< of teeth
  std::optional<CamGeometry> cam;  ///< of a roller
};

/// Throws InputError where the numbers of a changed scene leave no place for the contact.
ContactPlace contact_place(const Scene& scene, const Stop& stop);

/// Indices of the joints whose forces differ from those that it would have if it acted on its measures alone: pins and
/// welds at the axes, and the slide of a rack or of a follower.
std::vector<int> loaded_joints(const Scene& scene, const Stop& stop);

/// Its teeth push their wheels apart, however the torque acts.
bool separates(const Stop& stop);

/// The first cam that may lift off its follower, and so acts in statics alone; null if there is none.
const Stop* cam_that_may_lift(const Scene& scene);

/// A coupling whose force acts between parts by contact: gear, belt, rack, Geneva drive, cam, coupling of measures.
bool transmits(const Stop& stop);

}  // namespace poise
