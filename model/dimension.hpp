#pragma once

#include <string>

#include "model/scales.hpp"
#include "model/units.hpp"

namespace poise {

/// Physical dimension of a number, as exponents of the four units that a scene names and of time. Time is in seconds in
/// every system of units here, so its exponent appears in the unit's name only.
struct Dimension {
  int mass = 0;
  int force = 0;
  int length = 0;
  int angle = 0;
  int time = 0;

  /// SI value of one unit:  mass^m force^f length^l angle^a.
  double unit(const Units& u) const {
    return raised(raised(raised(raised(1.0, u.mass, mass), u.force, force), u.length, length), u.angle, angle);
  }

  /// "N m s/deg", "kg m²": the name of that unit, empty for a pure number.
  std::string unit_name(const Units& u) const;

  /// Factor that turns an SI value into one measured in `scales`. A mass is force / acceleration, so it is measured in
  /// scales.force s^2 / scales.length; angles are not scaled. A power of two.
  double per_scale(const Scales& scales) const {
    return raised(raised(1.0, scales.force, -(force + mass)), scales.length, mass - length);
  }

  friend constexpr Dimension operator*(const Dimension& a, const Dimension& b) {
    return {a.mass + b.mass, a.force + b.force, a.length + b.length, a.angle + b.angle, a.time + b.time};
  }
  friend constexpr bool operator==(const Dimension&, const Dimension&) = default;
  constexpr Dimension power(int n) const { return {n * mass, n * force, n * length, n * angle, n * time}; }

 private:
  static double raised(double product, double base, int exponent) {
    for (; exponent > 0; --exponent) product *= base;
    for (; exponent < 0; ++exponent) product /= base;
    return product;
  }
};

namespace dimension {
inline constexpr Dimension none{};
inline constexpr Dimension angle{0, 0, 0, 1};
inline constexpr Dimension length{0, 0, 1, 0};
inline constexpr Dimension time{0, 0, 0, 0, 1};
inline constexpr Dimension acceleration = length * time.power(-2);
inline constexpr Dimension force{0, 1, 0, 0};
inline constexpr Dimension torque{0, 1, 1, 0};
inline constexpr Dimension mass{1, 0, 0, 0};
inline constexpr Dimension inertia{1, 0, 2, 0};  ///< mass length^2
}  // namespace dimension

}  // namespace poise
