#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "model/number.hpp"
#include "model/planar.hpp"
#include "model/point_ref.hpp"

namespace poise {

/// Constraints of a kind of joint between its points a and b and their bodies. Reading, compiling, counting, checking
/// and free-body statics of joints follow from these.
struct JointTraits {
  std::string_view key;      ///< table in the scene file, and first part of paths
  bool has_travel = false;   ///< b slides on the line through a along an axis of a's body; otherwise b coincides with a
  bool keeps_angle = false;  ///< angle(b) - angle(a) is constant; otherwise the bodies turn freely
  bool keeps_length = false;  ///< a massless rod of constant length connects a and b

  /// Number of degrees of freedom that it removes from its two bodies.
  int constraints() const { return keeps_length ? 1 : (has_travel ? 1 : 2) + (keeps_angle ? 1 : 0); }
};

/// A joint between points a and b.
///
/// pin          b coincides with a, the bodies turn freely
/// slide        b slides on the line through a along `axis` (fixed in a's body); angle(b) - angle(a) = `angle`
/// pin_in_slot  b slides on that line and turns freely
/// weld         b coincides with a; angle(b) - angle(a) = `angle`
/// bar          massless rod, keeps |b - a| = length
///
/// The travel of a slide or pin in a slot is the signed distance from a to b along the axis, m.
struct Joint {
  enum class Kind { pin, slide, pin_in_slot, weld, bar };
  /// Traits by kind.
  static constexpr std::array<JointTraits, 5> kinds{{{.key = "pin"},
                                                     {.key = "slide", .has_travel = true, .keeps_angle = true},
                                                     {.key = "pin_in_slot", .has_travel = true},
                                                     {.key = "weld", .keeps_angle = true},
                                                     {.key = "bar", .keeps_length = true}}};

  Kind kind = Kind::pin;
  std::string name{};  ///< as given, or "ground.O-crank.O"
  PointRef a, b;
  Vec2 axis{1.0, 0.0};  ///< of any length: only its direction matters
  double angle = 0.0;   ///< rad
  double length = 0.0;  ///< m
  int line = 0;

  const JointTraits& traits() const { return kinds[static_cast<std::size_t>(kind)]; }
  bool has_travel() const { return traits().has_travel; }
  bool keeps_angle() const { return traits().keeps_angle; }
  bool keeps_length() const { return traits().keeps_length; }
  /// The axis as a unit vector.
  Vec2 direction() const { return poise::direction<double>(axis); }

  /// The numbers of this kind of joint.
  std::span<const Number> numbers() const;

 private:
  static const std::array<Number, 1> length_numbers, angle_numbers;
};

inline constexpr std::array<Number, 1> Joint::length_numbers{[] {
  Number number = plain_number<&Joint::length>("length", dimension::length, Range::positive);
  number.needed = Number::Needed::always;
  return number;
}()};

inline constexpr std::array<Number, 1> Joint::angle_numbers{plain_number<&Joint::angle>("angle", dimension::angle)};

inline std::span<const Number> Joint::numbers() const {
  if (keeps_length()) return length_numbers;
  if (keeps_angle()) return angle_numbers;
  return {};
}

}  // namespace poise
