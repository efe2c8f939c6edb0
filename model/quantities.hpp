#pragma once

// What the numbers of a scene are measured in, and which values they may take: shared by whatever sets them.

#include "model/scene.hpp"
#include "model/value_range.hpp"

namespace poise {

// SI values of the units that follow from the four a scene names. Time is always in seconds.

/// force / length, N/m.
inline double stiffness_unit(const Units& u) { return u.force / u.length; }

/// force length, N m.
inline double torque_unit(const Units& u) { return u.force * u.length; }

/// force length / angle, N m/rad.
inline double torsional_stiffness_unit(const Units& u) { return torque_unit(u) / u.angle; }

/// force time / length, N s/m.
inline double damping_unit(const Units& u) { return u.force / u.length; }

/// force length time / angle, N m s/rad.
inline double torsional_damping_unit(const Units& u) { return torque_unit(u) / u.angle; }

/// mass length^2, kg m^2.
inline double inertia_unit(const Units& u) { return u.mass * u.length * u.length; }

/// Unit of the limits of a stop: of angle or of length.
inline double stop_unit(Stop::Kind kind, const Units& u) { return kind == Stop::Kind::angle ? u.angle : u.length; }

/// Unit of what a drive prescribes: of angle or of length; of its rates, the same per s and per s^2.
inline double drive_unit(Drive::Kind kind, const Units& u) { return kind == Drive::Kind::angle ? u.angle : u.length; }

/// Limits of a distance are not negative.
inline Range stop_range(Stop::Kind kind) { return kind == Stop::Kind::distance ? Range::not_negative : Range::finite; }

}  // namespace poise
