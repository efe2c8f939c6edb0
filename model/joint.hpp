#pragma once

#include <array>
#include <cmath>
#include <optional>
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

/// Coulomb friction of a joint. With mu the coefficient it resists its motion with at most
///
///   pin          moment  r mu / sqrt(1 + mu^2) |R| + torque,  R the force in the pin: the friction circle
///                (R. L. Norton, "Design of Machinery", 5th ed., section 11.14; F. Beer, E. Johnston, "Statics",
///                section 8.3)
///   slide        force   mu (|N1| + |N2|) + force = mu max(|N|, 2 |C| / length) + force,  N the normal force and C the
///                couple about b: contact at both ends of a carriage of that length about b, N1 + N2 = N,
///                (N2 - N1) length / 2 = C; of length 0 mu |N| + force, the couple is carried without friction
///   pin_in_slot  force   mu |N| + force
///
/// In motion it resists (model/joint_friction.hpp; where the motion is given motion/sliding_friction.hpp); in statics
/// it holds poses (statics/friction/held.hpp), and equilibria are those without it.
struct JointFriction {
  double coefficient = 0.0;  ///< mu
  double radius = 0.0;       ///< r of a pin, m
  double torque = 0.0;       ///< of a pin, whatever it carries: of seals and preload, N m
  double length = 0.0;       ///< of the carriage of a slide, m
  double force = 0.0;        ///< of a slide or pin in a slot, whatever it carries, N

  /// Radius of the friction circle of a pin, m.
  double circle() const { return radius * coefficient / std::sqrt(1.0 + coefficient * coefficient); }
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
  std::optional<JointFriction> friction{};  ///< of a pin, a slide or a pin in a slot

  const JointTraits& traits() const { return kinds[static_cast<std::size_t>(kind)]; }
  bool has_travel() const { return traits().has_travel; }
  bool keeps_angle() const { return traits().keeps_angle; }
  bool keeps_length() const { return traits().keeps_length; }
  /// It resists its own motion, by which a table `friction` of the scene file says how much.
  bool can_rub() const { return !keeps_length() && (has_travel() || !keeps_angle()); }
  /// The axis as a unit vector.
  Vec2 direction() const { return poise::direction<double>(axis); }

  /// The numbers of this kind of joint; those of its friction, "friction.KEY", where it has some.
  std::span<const Number> numbers() const;
  /// Those of its friction alone.
  std::span<const Number> friction_numbers() const;

 private:
  static const std::array<Number, 1> length_numbers, angle_numbers;
  static const std::array<Number, 3> pin_friction;
  static const std::array<Number, 2> slot_friction;
  static const std::array<Number, 4> angle_and_friction;
};

/// A number of Joint::friction, at least 0.
template <auto Member>
constexpr Number friction_number(std::string_view key, Dimension dimension) {
  Number number{key, dimension, Range::not_negative};
  number.get = [](const void* item) -> std::optional<double> {
    const auto& friction = static_cast<const Joint*>(item)->friction;
    return friction ? std::optional<double>((*friction).*Member) : std::nullopt;
  };
  number.set = [](void* item, double value) {
    auto& friction = static_cast<Joint*>(item)->friction;
    if (!friction) friction.emplace();
    (*friction).*Member = value;
  };
  number.scale = [](void* item, double factor) {
    auto& friction = static_cast<Joint*>(item)->friction;
    if (friction) (*friction).*Member *= factor;
  };
  return number;
}

inline constexpr std::array<Number, 1> Joint::length_numbers{[] {
  Number number = plain_number<&Joint::length>("length", dimension::length, Range::positive);
  number.needed = Number::Needed::always;
  return number;
}()};

inline constexpr std::array<Number, 1> Joint::angle_numbers{plain_number<&Joint::angle>("angle", dimension::angle)};

inline constexpr std::array<Number, 3> Joint::pin_friction{
    friction_number<&JointFriction::coefficient>("friction.coefficient", dimension::none),
    friction_number<&JointFriction::radius>("friction.radius", dimension::length),
    friction_number<&JointFriction::torque>("friction.torque", dimension::torque)};

inline constexpr std::array<Number, 2> Joint::slot_friction{
    friction_number<&JointFriction::coefficient>("friction.coefficient", dimension::none),
    friction_number<&JointFriction::force>("friction.force", dimension::force)};

inline constexpr std::array<Number, 4> Joint::angle_and_friction{
    Joint::angle_numbers[0], friction_number<&JointFriction::coefficient>("friction.coefficient", dimension::none),
    friction_number<&JointFriction::length>("friction.length", dimension::length),
    friction_number<&JointFriction::force>("friction.force", dimension::force)};

inline std::span<const Number> Joint::friction_numbers() const {
  if (!friction || !can_rub()) return {};
  if (!has_travel()) return pin_friction;
  return keeps_angle() ? std::span<const Number>(angle_and_friction).subspan<1>() : slot_friction;
}

inline std::span<const Number> Joint::numbers() const {
  if (keeps_length()) return length_numbers;
  if (!keeps_angle()) return friction_numbers();
  return friction && can_rub() ? std::span<const Number>(angle_and_friction) : angle_numbers;
}

}  // namespace poise
