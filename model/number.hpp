#pragma once

#include <optional>
#include <string_view>

#include "model/dimension.hpp"
#include "model/measure.hpp"
#include "model/value_range.hpp"

namespace poise {

/// One number of an item of a scene (a body, a law, a stop, ...), declared once beside the item. Reading a scene file,
/// set_value, get_value, scaling, the unknowns of identification and the tables of the docs all follow from it.
///
/// The accessors take the address of the item whose `numbers` it is among; values are SI.
struct Number {
  std::string_view key;         ///< in the scene file, and last part of the path
  Dimension dimension;          ///< times measure^measure_power effort^effort_power if the item acts on a measure
  Range range = Range::finite;  ///< values it may take
  std::optional<double> (*get)(const void* item) = nullptr;  ///< empty if the scene gives none
  /// Throws InputError if the value contradicts the item's other numbers.
  void (*set)(void* item, double value) = nullptr;
  void (*scale)(void* item, double factor) = nullptr;  ///< multiplies it; exact for a power of two

  int measure_power = 0;          ///< exponent of the dimension of the item's measure
  int effort_power = 0;           ///< exponent of the dimension of the force (torque) that acts on it
  bool range_of_measure = false;  ///< its range is that of the measure instead of `range`
  std::string_view angle_key{};   ///< key if the measure is an angle and the key differs
  enum class Needed { always, as_length, no };
  Needed needed = Needed::no;  ///< whether a scene file must give it: always, or if the measure is a length

  std::string_view key_on(const Measure* on) const {
    return on != nullptr && on->is_angle() && !angle_key.empty() ? angle_key : key;
  }
  Dimension dimension_on(const Measure* on) const {
    if (on == nullptr) return dimension;
    return dimension * on->dimension().power(measure_power) * on->effort_dimension().power(effort_power);
  }
  Range range_on(const Measure* on) const { return range_of_measure && on != nullptr ? on->range() : range; }
  bool needed_on(const Measure* on) const {
    return needed == Needed::always || (needed == Needed::as_length && on != nullptr && !on->is_angle());
  }
};

template <class Item, class Value>
Item item_of_member(Value Item::*);

/// A plain number: the member itself.
template <auto Member>
constexpr Number plain_number(std::string_view key, Dimension dimension, Range range = Range::finite) {
  using Item = decltype(item_of_member(Member));
  Number number{key, dimension, range};
  number.get = [](const void* item) { return std::optional<double>(static_cast<const Item*>(item)->*Member); };
  number.set = [](void* item, double value) { static_cast<Item*>(item)->*Member = value; };
  number.scale = [](void* item, double factor) { static_cast<Item*>(item)->*Member *= factor; };
  return number;
}

/// A component, 0 for x or 1 for y, of a vector member.
template <auto Member, int Component>
constexpr Number component_number(std::string_view key, Dimension dimension) {
  using Item = decltype(item_of_member(Member));
  Number number{key, dimension, Range::finite};
  number.get = [](const void* item) {
    const auto& v = static_cast<const Item*>(item)->*Member;
    return std::optional<double>(Component == 0 ? v.x : v.y);
  };
  number.set = [](void* item, double value) {
    auto& v = static_cast<Item*>(item)->*Member;
    (Component == 0 ? v.x : v.y) = value;
  };
  number.scale = [](void* item, double factor) {
    auto& v = static_cast<Item*>(item)->*Member;
    (Component == 0 ? v.x : v.y) *= factor;
  };
  return number;
}

/// A number that may be absent.
template <auto Member>
constexpr Number optional_number(std::string_view key, Dimension dimension, Range range = Range::finite) {
  using Item = decltype(item_of_member(Member));
  Number number{key, dimension, range};
  number.get = [](const void* item) { return static_cast<const Item*>(item)->*Member; };
  number.set = [](void* item, double value) { static_cast<Item*>(item)->*Member = value; };
  number.scale = [](void* item, double factor) {
    auto& value = static_cast<Item*>(item)->*Member;
    if (value) *value *= factor;
  };
  return number;
}

}  // namespace poise
