#pragma once

#include <array>
#include <string>

#include "model/measure.hpp"
#include "model/number.hpp"
#include "model/point_ref.hpp"

namespace poise {

/// A blade under a point P of a body: a knife edge, a skate, a runner, or the tread of a thin wheel without mass. Along
/// its edge P moves freely, across it not at all. With the place (x, y) of P in the frame of the body `on` and the
/// angle phi of the edge there,
///   phi = angle(body) - angle(on) + angle,   -sin(phi) dx/dt + cos(phi) dy/dt = 0.
/// This is a condition of rates that no condition of positions implies (non-holonomic): it keeps no position from being
/// reached. The force that it takes acts on P across the edge, from `on`; it does no work.
/// Source: S. A. Chaplygin, On the theory of motion of nonholonomic systems, Matematicheskii Sbornik 28, 1911.
struct Blade {
  std::string name;
  PointRef at;         ///< P, of a body that can move
  double angle = 0.0;  ///< of the edge, counter-clockwise from the x axis of the body's frame, rad
  int on = 0;          ///< body on which it stands
  int line = 0;

  /// phi - angle, x and y.
  Measure turn() const { return Measure::angle_between(on, at.body); }
  Measure x() const { return on == 0 ? Measure::x_of(at) : Measure::component_along({on, 0}, at, {1.0, 0.0}); }
  Measure y() const { return on == 0 ? Measure::y_of(at) : Measure::component_along({on, 0}, at, {0.0, 1.0}); }

  static const std::array<Number, 1> numbers;
};

inline constexpr std::array<Number, 1> Blade::numbers{plain_number<&Blade::angle>("angle", dimension::angle)};

}  // namespace poise
