#pragma once

#include <array>
#include <optional>
#include <vector>

#include "model/input_error.hpp"
#include "model/number.hpp"

namespace poise {

/// The cross-section of a body that is a beam along a polyline of its points, its axis. It has no effect on the
/// equilibrium of the rigid body; statics/equilibrium/link_loads.hpp finds what is inside of the beam.
struct CrossSection {
  double area = 0.0;           ///< A, m^2
  double second_moment = 0.0;  ///< I for bending in the plane, about the axis, m^4
  double modulus = 0.0;        ///< E, N/m^2
  double height = 0.0;         ///< distance of the extreme fibres, m
  /// Distance of the axis from the extreme fibre on its left, seen in the direction of the line, m; half the height
  /// where the scene gives none. At most the height.
  std::optional<double> left{};
  std::vector<int> line;  ///< points of the body, two at least: the axis

  double to_left() const { return left.value_or(0.5 * height); }
  double to_right() const { return height - to_left(); }

  static const std::array<Number, 5> numbers;
};

inline constexpr std::array<Number, 5> CrossSection::numbers{
    plain_number<&CrossSection::area>("area", dimension::length.power(2), Range::positive),
    plain_number<&CrossSection::second_moment>("second_moment", dimension::length.power(4), Range::positive),
    plain_number<&CrossSection::modulus>("modulus", dimension::force* dimension::length.power(-2), Range::positive),
    [] {
      Number number = plain_number<&CrossSection::height>("height", dimension::length, Range::positive);
      number.set = [](void* item, double value) {
        auto& section = *static_cast<CrossSection*>(item);
        if (section.left && *section.left > value) throw InputError("expected height >= left; change left first");
        section.height = value;
      };
      return number;
    }(),
    [] {
      Number number = optional_number<&CrossSection::left>("left", dimension::length, Range::not_negative);
      number.set = [](void* item, double value) {
        auto& section = *static_cast<CrossSection*>(item);
        if (value > section.height) throw InputError("expected left <= height, the distance of the extreme fibres");
        section.left = value;
      };
      return number;
    }()};

}  // namespace poise
