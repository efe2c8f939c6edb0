#pragma once

// Where the forces of gears, racks and cams act, for bodies cut free.

#include <optional>

#include "model/meshing.hpp"
#include "statics/bodies/body_forces.hpp"
#include "statics/bodies/cam_push.hpp"
#include "statics/bodies/reaction.hpp"

namespace poise {

/// The force of a coupling where it acts, on `body_b` at the point `at`, measured as the poses, the opposite on
/// `body_a`: Q force + |Q| separating, with Q the effort on the coupling's measure.
template <class T>
struct ContactLoad {
  int body_a = 0, body_b = 0;
  Planar<T> at{};
  Planar<T> force{};
  Planar<T> separating{};
};

/// Of a coupling that loads bearings (model/meshing.hpp); nothing of others, whose efforts act as unit_efforts() says,
/// and of a cam where no finite force drives its follower. It differs from unit_efforts() by forces along the rows of
/// pins and guides only, so that no motion and no other force depends on which of both acts: with d from axis a to axis
/// b, the pitch radii r_a and r_b = |d| / (1 + s ratio), s = 1 of wheels that mesh outside, -1 of one inside the other,
///
///   gear  at the pitch point; force across d of the moment Q about b and s ratio Q about a; separating along d by the
///         tangent of the pressure angle times that force, which pushes wheels apart, and of an internal gear both ways
///         from the pitch point, the inner one towards its centre
///   rack  at the point of the pinion's circle that moves with the rack; force along the slide, separating across it,
///         from the pinion to the rack
///   cam   at the centre of the roller, normal to the pitch curve, on the follower; its part along the roller's motion
///         does the work of Q
///
/// (J. Shigley, C. Mischke, "Mechanical Engineering Design", section 13.14: spur gears; R. L. Norton, "Cam Design and
/// Manufacturing Handbook", 2009, chapter 7). Does not allocate, given the place.
template <class Pose, class NumbersOfScene, class T = ScalarOf<Pose>>
std::optional<ContactLoad<T>> contact_load(const BodyForces<Pose, NumbersOfScene>& bodies, int index,
                                           const ContactPlace& place) {
  const Stop& stop = bodies.scene().stops[static_cast<std::size_t>(index)];
  if (place.cam) {
    const CamGeometry& cam = *place.cam;
    const std::optional<CamPush<T>> push = cam_push(bodies, index, cam);
    if (!push) return std::nullopt;
    const Measure& angle = stop.on.terms[1].measure;
    const Planar<T> force = (T(1) / push->lever) * (push->along + push->tangent * quarter_turn(push->along));
    return ContactLoad<T>{
        cam.sense > 0 ? angle.body_b : angle.body_a, cam.roller.body, bodies.world(cam.roller), force, {}};
  }
  const std::optional<Meshing>& mesh = place.mesh;
  const T tangent = bodies.numbers().pressure_tangent(index), factor = bodies.numbers().term(stop.on, 1, index).factor;
  const double as_given = stop.on.terms[1].factor;
  ContactLoad<T> out{mesh->body_a, mesh->body_b, bodies.world(mesh->axis_a), {}, {}};
  if (mesh->slide >= 0) {
    out.force = T(mesh->rack_is_second ? 1 : -1) * bodies.axis(mesh->slide);
    out.at += factor * quarter_turn(out.force);
    out.separating = (T(as_given < 0 ? -1 : 1) * tangent) * quarter_turn(out.force);
    return out;
  }
  const Planar<T> apart = bodies.world(mesh->axis_b) - out.at;
  const T sum = T(1) + factor;  // of pitch radii, over r_b
  const T per_length = sum / dot(apart, apart);
  out.at += (factor / sum) * apart;
  out.force = -(per_length * quarter_turn(apart));
  out.separating = (T(1.0 + as_given < 0 ? -stop.sense : stop.sense) * per_length * tangent) * apart;
  return out;
}

/// The same of any stop. Throws as contact_place().
template <class Pose, class NumbersOfScene, class T = ScalarOf<Pose>>
std::optional<ContactLoad<T>> contact_load(const BodyForces<Pose, NumbersOfScene>& bodies, int index) {
  const Stop& stop = bodies.scene().stops[static_cast<std::size_t>(index)];
  if (!loads_bearings(stop)) return std::nullopt;
  return contact_load(bodies, index, contact_place(bodies.scene(), stop));
}

/// Q of a stop, from its reaction.
inline double effort_of(const Stop& stop, const Reaction& reaction) {
  return stop.on.is_angle() ? reaction.moment : -reaction.axial;
}

}  // namespace poise
