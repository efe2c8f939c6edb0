#pragma once

#include <cstdlib>
#include <optional>

#include <boost/multiprecision/cpp_int.hpp>

#include "statics/model/static_model.hpp"

namespace poise {

using Rational = boost::multiprecision::cpp_rational;

/// The shortest decimal that reads as x where it counts in a unit.
Rational shortest_decimal(double x, double unit);

/// Whether no number that statics needs is an expression: these are not known as rational numbers.
bool is_written_in_numbers(const Scene& scene);

/// Numbers of a scaled scene as they are written, for EnergyMerger.
class WrittenNumbers {
 public:
  explicit WrittenNumbers(const StaticModel& model)
      : layout_(model.layout()), scales_(model.scales()), units_(model.scene().units) {}

  Rational length(double x) const { return written(x, dimension::length); }
  Rational force(double x) const { return written(x, dimension::force); }
  Rational force_per_length(double x) const { return written(x, dimension::force * dimension::length.power(-1)); }
  Rational mass(double x) const { return written(x, dimension::mass); }
  Rational acceleration(double x) const { return written(x, dimension::acceleration); }
  static std::optional<Rational> share_at_points(const Scene& /*scene*/, const Force& on) {
    return on.to ? std::nullopt : std::optional<Rational>(1);
  }
  std::optional<Planar<Rational>> turned(int turn) const {
    if (!layout_.turns[static_cast<std::size_t>(turn)].angle.parts().empty()) return std::nullopt;
    return Planar<Rational>{1, 0};
  }
  std::optional<Planar<Rational>> direction(const Vec2& along) const {
    if (along.x != 0.0 && along.y != 0.0) return std::nullopt;
    const auto sign = [](double x) { return x > 0.0 ? 1 : x < 0.0 ? -1 : 0; };
    return Planar<Rational>{sign(along.x), sign(along.y)};
  }

 private:
  // In SI.
  Rational written(double x, const Dimension& of) const {
    const auto raised = [](const Rational& base, int exponent) {
      Rational out = 1;
      for (int k = 0; k < std::abs(exponent); ++k) out *= base;
      return exponent < 0 ? Rational(1 / out) : out;
    };
    const Rational unit = raised(shortest_decimal(units_.length, 1.0), of.length) *
                          raised(shortest_decimal(units_.force, 1.0), of.force) *
                          raised(shortest_decimal(units_.mass, 1.0), of.mass);
    return shortest_decimal(x / of.per_scale(scales_), of.unit(units_)) * unit;
  }

  const Layout& layout_;
  const Scales& scales_;
  const Units& units_;
};

}  // namespace poise
