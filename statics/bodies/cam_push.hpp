#pragma once

// How cams drive their followers, for bodies cut free.

#include <cmath>
#include <optional>
#include <type_traits>

#include "model/cam_geometry.hpp"
#include "model/length_of.hpp"

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

/// Of the cam that is a stop of this index, in bodies as BodyForces has them, in a pose in which the roller is on the
/// pitch curve. Nothing where that curve has no direction at the roller, or where the roller moves along it, so that no
/// finite force drives it; in balls these are balls without end, in lanes numbers that are not finite.
template <class Bodies, class T = typename Bodies::T>
std::optional<CamPush<T>> cam_push(const Bodies& bodies, int stop, const CamGeometry& cam) {
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
    out.lever = length_of(arm);
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

}  // namespace poise
