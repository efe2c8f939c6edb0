#pragma once

// Where the forces of gears, racks and cams act, for bodies cut free.

#include <cmath>
#include <optional>
#include <type_traits>

#include "model/cam_geometry.hpp"
#include "model/meshing.hpp"
#include "statics/bodies/body_forces.hpp"
#include "statics/bodies/reaction.hpp"

namespace poise {

/// How a cam drives its follower in one pose: the centre of the roller moves along `along`, a unit vector, by `lever`
/// per unit of the follower's measure, and the normal of the pitch curve is turned from there by an angle of this
/// tangent, counter-clockwise (statics/model/cam_contact.hpp).
template <class T>
struct CamPush {
  Planar<T> along{};
  T lever{};
  T tangent{};
};

/// Of the cam that is a stop of this index, in a pose in which the roller is on the pitch curve. Nothing where that
/// curve has no direction at the roller, or where the roller moves along it, so that no finite force drives it; in
/// balls these are balls without end, in lanes numbers that are not finite.
template <class Pose, class NumbersOfScene, class T = ScalarOf<Pose>>
std::optional<CamPush<T>> cam_push(const BodyForces<Pose, NumbersOfScene>& bodies, int stop, const CamGeometry& cam) {
  const Measure& on = bodies.scene().stops[static_cast<std::size_t>(stop)].on;
  const auto term = bodies.numbers().term(on, 1, stop);
  const T slope = T(-cam.sense) * (term.factor * term.at(bodies.value(on.terms[1].measure)).first);
  const Planar<T> r = bodies.world(cam.roller) - bodies.world(cam.axis);
  CamPush<T> out;
  out.lever = T(1);
  if (cam.slide >= 0) {
    out.along = bodies.axis(cam.slide);
  } else {
    const Planar<T> arm = bodies.world(cam.roller) - bodies.world(cam.pivot);
    out.lever = body_forces::length_of(arm);
    if constexpr (std::is_same_v<T, double>) {
      if (out.lever == 0.0) return std::nullopt;
    }
    out.along = (T(cam.turn_sense) / out.lever) * quarter_turn(arm);
  }
  // For each radian by which the cam turns the roller moves against it by l g' t - quarter_turn(r).
  const T rise = out.lever * slope - cross(r, out.along), across = dot(r, out.along);
  if constexpr (std::is_same_v<T, double>) {
    constexpr double rounding = 1e-12;
    if (std::abs(across) <= rounding * (norm(r) + std::abs(out.lever * slope))) return std::nullopt;
  }
  out.tangent = rise / across;
  return out;
}

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
