#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/input_error.hpp"
#include "model/measure.hpp"
#include "model/number.hpp"

namespace poise {

/// What an impact gives back of a motion: a coefficient of energy (W. J. Stronge), of rates (I. Newton) or of impulses
/// (S. D. Poisson). They agree at a single place without friction; see motion/impact.hpp.
enum class ImpactLaw { energetic, newton, poisson };

/// A stop keeps min <= g <= max of the measure g: rad or m. An absent limit is infinite. One whose limits are equal
/// holds its measure: gears, belts, racks and other couplings are such stops on sums of measures, a cam is one on the
/// lift of its follower less its profile, and a rope that does not stretch one on its length
/// (model/couplings.hpp).
struct Stop {
  std::string table = "stop";  ///< its table in the scene file
  std::string name{};
  Measure on{};
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  double sense = 1.0;  ///< 1 or -1: the sign with which a coupling's factor is its number
  int line = 0;
  /// Points of its curve where the scene file gives them: of a cam (part of a turn, share of the lift), the last one a
  /// full turn behind the first; of a curved slot or a profile that rolls in the first of its stops (X, Y), m. Profiles
  /// follow by follow_curve().
  std::vector<Vec2> curve{};
  bool closed = false;  ///< such a curve returns to its first point
  bool to_end = false;  ///< the upper limit, of a slot or the ends of a profile, is the end of its curve
  /// Of a cam whose scene names it: the centre of the roller, a point of the follower.
  std::optional<PointRef> roller{};
  /// Of a gear or rack whose scene gives a pressure angle: the tangent of that.
  std::optional<double> pressure_tangent{};
  /// Coefficient of restitution of impacts at its limits, 0 where the scene gives none.
  std::optional<double> restitution{};
  std::optional<ImpactLaw> impact_law{};  ///< where the scene gives one
  /// Coefficient of the Coulomb friction across the measure, where that is x or y of a point or the clearance of a
  /// contact; motion alone has it.
  std::optional<double> friction{};

  /// The first of the stops of a contact has here of how many convex parts its outline is made
  /// (model/outline_parts.hpp).
  int parts = 1;

  /// It holds its measure at one value.
  bool holds() const { return min == max; }
  /// How impacts at one of its limits end: the rate with which the measure leaves over that with which it came.
  double rebound() const { return restitution.value_or(0.0); }
  /// It is a coupling that holds: a part of the mechanism, which takes a degree of freedom from it.
  bool couples() const { return holds() && table != "stop"; }
  /// "stop", "gear", for messages.
  std::string family() const;
  /// stop "end", for messages.
  std::string title() const;
  /// Its numbers, which depend on its table; those of a plain stop are its limits.
  std::span<const Number> numbers() const;

  /// The measure along which what touches a limit slides, so that its rate is that of slip: y of a point whose x is
  /// limited, and x where y is, and the way along the outline of a contact. None of others.
  std::optional<Measure> tangent() const;
  /// min, max, restitution and friction.
  static const std::array<Number, 4> limits;
  /// The third of these, for couplings that act on one side.
  static constexpr Number restitution_number() {
    Number number{"restitution", {}, Range::not_negative};
    number.get = [](const void* item) { return static_cast<const Stop*>(item)->restitution; };
    number.set = [](void* item, double value) {
      if (!(value <= 1.0)) throw InputError("expected a coefficient of restitution from 0 to 1; 1 loses no energy");
      static_cast<Stop*>(item)->restitution = value;
    };
    number.scale = [](void*, double) {};
    return number;
  }

  /// The last of these, for contacts and cams.
  static constexpr Number friction_number();

 private:
  template <bool is_max>
  static constexpr Number limit(std::string_view key) {
    Number number{key, {}, Range::finite};
    number.measure_power = 1;
    number.range_of_measure = true;
    number.get = [](const void* item) {
      const Stop& stop = *static_cast<const Stop*>(item);
      return std::optional<double>(is_max ? stop.max : stop.min);
    };
    number.set = [](void* item, double value) {
      Stop& stop = *static_cast<Stop*>(item);
      const double lower = is_max ? stop.min : value;
      const double upper = is_max ? value : stop.max;
      if (!(lower <= upper)) throw InputError("expected min <= max; set the other limit first");
      stop.min = lower;
      stop.max = upper;
    };
    number.scale = [](void* item, double factor) {
      Stop& stop = *static_cast<Stop*>(item);
      (is_max ? stop.max : stop.min) *= factor;
    };
    return number;
  }
};

constexpr Number Stop::friction_number() {
  Number number = optional_number<&Stop::friction>("friction", {}, Range::not_negative);
  number.scale = [](void*, double) {};
  return number;
}

inline constexpr std::array<Number, 4> Stop::limits{limit<false>("min"), limit<true>("max"), restitution_number(),
                                                    friction_number()};

}  // namespace poise
