#include "model/couplings.hpp"

#include <algorithm>
#include <cmath>

#include "model/one_line.hpp"

namespace poise {
namespace {

using Of = CouplingPart::Of;

// The limit that is given, or both.
constexpr Number value_number(std::string_view key) {
  Number number{key, {}, Range::finite};
  number.measure_power = 1;
  number.range_of_measure = true;
  number.get = [](const void* item) {
    const Stop& stop = *static_cast<const Stop*>(item);
    return std::optional<double>(std::isfinite(stop.min) ? stop.min : stop.max);
  };
  number.set = [](void* item, double value) {
    Stop& stop = *static_cast<Stop*>(item);
    // Not a number where it is not known yet.
    if (!std::isinf(stop.max)) stop.max = value;
    if (!std::isinf(stop.min)) stop.min = value;
  };
  number.scale = [](void* item, double factor) {
    Stop& stop = *static_cast<Stop*>(item);
    stop.min *= factor;
    stop.max *= factor;
  };
  return number;
}

// A scene file must give it.
constexpr Number needed(Number number) {
  number.needed = Number::Needed::always;
  return number;
}

// Factors and shifts are scaled with their measures (scale() of a scene).
constexpr Number with_measure(Number number) {
  number.scale = [](void*, double) {};
  return number;
}

template <int Term>
constexpr Number factor_number(std::string_view key, Dimension dimension, Range range) {
  Number number{key, dimension, range};
  number.get = [](const void* item) {
    const Stop& stop = *static_cast<const Stop*>(item);
    return std::optional<double>(stop.sense * stop.on.terms[Term].factor);
  };
  number.set = [](void* item, double value) {
    Stop& stop = *static_cast<Stop*>(item);
    stop.on.terms[Term].factor = stop.sense * value;
  };
  return with_measure(number);
}

template <int Term>
constexpr Number shift_number(std::string_view key, Dimension dimension) {
  Number number{key, dimension, Range::finite};
  number.get = [](const void* item) {
    return std::optional<double>(static_cast<const Stop*>(item)->on.terms[Term].shift);
  };
  number.set = [](void* item, double value) { static_cast<Stop*>(item)->on.terms[Term].shift = value; };
  return with_measure(number);
}

constexpr std::array<Number, 2> wheel_numbers{needed(factor_number<1>("ratio", dimension::none, Range::positive)),
                                              value_number("phase")};
constexpr std::array<Number, 2> rack_numbers{needed(factor_number<1>("radius", dimension::length, Range::finite)),
                                             value_number("offset")};
constexpr std::array<CouplingPart, 2> factor_and_value{CouplingPart{Of::factor, 1}, CouplingPart{Of::value}};

constexpr std::array<Number, 3> cam_numbers{[] {
                                              Number lift = needed(factor_number<1>("lift", {}, Range::finite));
                                              lift.measure_power = 1;
                                              return lift;
                                            }(),
                                            shift_number<1>("phase", dimension::angle), value_number("base")};
constexpr std::array<CouplingPart, 3> cam_parts{CouplingPart{Of::factor, 1}, CouplingPart{Of::shift, 1},
                                                CouplingPart{Of::value}};

constexpr std::array<Number, 1> coupling_numbers{value_number("value")};
constexpr std::array<Number, 1> rope_numbers{[] {
  Number length = needed(value_number("length"));
  length.range = Range::positive;
  length.range_of_measure = false;
  return length;
}()};
constexpr std::array<CouplingPart, 1> value_only{CouplingPart{Of::value}};

constexpr std::array<CouplingKind, 6> kinds{{{"gear", wheel_numbers, factor_and_value},
                                             {"belt", wheel_numbers, factor_and_value},
                                             {"rack", rack_numbers, factor_and_value},
                                             {"cam", cam_numbers, cam_parts},
                                             {"coupling", coupling_numbers, value_only},
                                             {"rope", rope_numbers, value_only}}};

}  // namespace

std::span<const CouplingKind> coupling_kinds() { return kinds; }

const CouplingKind* coupling_kind(const Stop& stop) {
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](const CouplingKind& kind) { return kind.table == stop.table; });
  return found == kinds.end() ? nullptr : &*found;
}

std::span<const Number> Stop::numbers() const {
  const CouplingKind* const kind = coupling_kind(*this);
  return kind != nullptr ? kind->numbers : std::span<const Number>(limits);
}

std::string Stop::family() const { return words_of_key(table); }

}  // namespace poise
