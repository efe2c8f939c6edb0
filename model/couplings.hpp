#pragma once

// Tables of a scene file that bind measures to one another: each makes one stop on a sum of measures
// (model/laws/stop.hpp).

#include <array>
#include <span>
#include <string_view>

#include "model/laws/stop.hpp"

namespace poise {

/// What a number of a coupling is in its stop: the value that the measure is held at (or the limit that it has), the
/// factor of a term of the sum, or the shift of a term's profile. Of a factor the number is `Stop::sense` times it.
struct CouplingPart {
  enum class Of { value, factor, shift };
  Of of = Of::value;
  int term = 0;
};

/// A kind of coupling: its table, its numbers, and what each of these is.
struct CouplingKind {
  std::string_view table;
  std::span<const Number> numbers;
  std::span<const CouplingPart> parts;
};

/// All kinds:
///
///   gear      angle of wheel b = phase -+ ratio angle of wheel a, both from their carrier; - of wheels that mesh
///             outside, + of one inside the other (R. Willis, "Principles of Mechanism", 1841: planetary gears)
///   belt      the same with the signs exchanged: + of an open belt, - of a crossed one
///   rack      travel of the rack = offset + radius times the angle of the pinion from its carrier
///   cam       follower >= base + lift P((angle - phase) / turn); = where it is guided on both sides
///   coupling  sum of factor times measure = value
///   rope      length of a rope over points and pulleys <= length
std::span<const CouplingKind> coupling_kinds();

/// The kind of a stop; null of a plain one.
const CouplingKind* coupling_kind(const Stop& stop);

}  // namespace poise
