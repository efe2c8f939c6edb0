#pragma once

// Items of a scene's document as they read where they are moved in the plane: under other names, turned and mirrored.
// Private to model/.
//
// Where y becomes -y it does so in the frames of all bodies that are moved, so that their angles are the opposite ones.
// A measure of angles keeps its value there by an exchange of its two bodies.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "model/toml_reader.hpp"

namespace poise {
namespace moved {

inline std::string* text_in(toml::table& table, std::string_view key) {
  toml::value<std::string>* const value = table.get_as<std::string>(key);
  return value != nullptr ? &value->get() : nullptr;
}

inline toml::array* list_in(toml::table& table, std::string_view key) { return table.get_as<toml::array>(key); }

inline toml::table* table_in(toml::table& table, std::string_view key) { return table.get_as<toml::table>(key); }

/// The tables of [[key]].
inline std::vector<toml::table*> tables_in(toml::table& document, std::string_view key) {
  std::vector<toml::table*> out;
  toml::array* const list = list_in(document, key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    if (toml::table* const table = list->get_as<toml::table>(i)) out.push_back(table);
  }
  return out;
}

/// A number, or an expression of one.
struct Amount {
  double value = 0.0;
  std::string text{};  ///< empty of a number

  static Amount of(const toml::node* node) {
    if (node == nullptr) return {};
    if (const auto* text = node->as_string()) return {0.0, text->get()};
    return {node->value<double>().value_or(0.0)};
  }
  static Amount component(const toml::node* list, std::size_t at) {
    const toml::array* const all = list != nullptr ? list->as_array() : nullptr;
    return all != nullptr ? of(all->get(at)) : Amount{};
  }
  bool is_number() const { return text.empty(); }
  bool is(double number) const { return is_number() && value == number; }
  std::string factor() const {
    const bool is_name = std::all_of(text.begin(), text.end(),
                                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.'; });
    return is_name && value >= 0.0 ? whole() : "(" + whole() + ")";
  }
  std::string whole() const { return is_number() ? fmt::format("{}", value) : text; }
  template <class Add>
  void put(Add add) const {
    if (is_number())
      add(value);
    else
      add(text);
  }
};

inline Amount operator+(const Amount& a, const Amount& b) {
  if (a.is_number() && b.is_number()) return {a.value + b.value};
  if (a.is(0.0)) return b;
  if (b.is(0.0)) return a;
  return {0.0, a.whole() + " + " + b.factor()};
}

inline Amount operator*(const Amount& a, const Amount& b) {
  if (a.is_number() && b.is_number()) return {a.value * b.value};
  if (a.is(0.0) || b.is(0.0)) return {};
  if (a.is(1.0)) return b;
  if (b.is(1.0)) return a;
  if (a.is(-1.0)) return {0.0, "-" + b.factor()};
  return {0.0, a.factor() + "*" + b.factor()};
}

struct Place {
  Amount x, y;
};

/// A direction in the plane, at an angle in rad per unit.
struct Direction {
  Amount cos{1.0}, sin{};

  static Direction at(const Amount& angle, double unit) {
    if (angle.is_number()) return {{std::cos(angle.value * unit)}, {std::sin(angle.value * unit)}};
    const std::string radians = unit == 1.0 ? angle.text : fmt::format("{}*({})", unit, angle.text);
    return {{0.0, "cos(" + radians + ")"}, {0.0, "sin(" + radians + ")"}};
  }
  Place turned(const Place& p) const { return {cos * p.x + Amount{-1.0} * (sin * p.y), sin * p.x + cos * p.y}; }
};

inline toml::array array_of(const Place& place) {
  toml::array out;
  place.x.put([&](const auto& x) { out.push_back(x); });
  place.y.put([&](const auto& y) { out.push_back(y); });
  return out;
}

}  // namespace moved

/// Changes tables of a document so that they read where they are moved. What the names become, and which body stands
/// for the ground, is up to the classes below.
class MovedItems {
 public:
  MovedItems() = default;
  virtual ~MovedItems() = default;
  MovedItems(const MovedItems&) = delete;
  MovedItems& operator=(const MovedItems&) = delete;

 protected:
  using NodeName = void (MovedItems::*)(std::string&);

  /// Gives what is named its name behind the motion.
  virtual void name_body(std::string& name) = 0;
  virtual void name_point(std::string& name) = 0;
  virtual void name_joint(std::string& name) = 0;
  virtual void name_element(std::string& name) = 0;
  /// "BODY.POINT" where the origin of the frame is from which places of the moved items count.
  virtual std::string origin_of_places() = 0;
  /// The body on which gears without a carrier turn; empty where that stays the ground.
  virtual std::string carrier_of_gears() { return ""; }
  virtual void note_negated(const toml::node&) {}
  /// Moves a value to another table; `before` is its key there where that differs.
  virtual void take_value(toml::node& from, toml::table& to, const toml::key& key, std::string_view before);

  /// An item of [[key]], but its own name; `place` is its table.
  void transform(std::string_view key, toml::table& table, const TomlTable& place);
  void transform_body(toml::table& body, const TomlTable& place);
  /// The points of a body or of the ground.
  void transform_points(toml::table& owner);
  void mirror(toml::node* vector, std::size_t component = 1);
  static toml::source_region key_source(const toml::table& table, std::string_view key);

  bool mirrored_ = false;  ///< y to -y, before it is turned
  moved::Amount angle_{};  ///< by which it is turned then
  moved::Direction direction_{};

 private:
  void name_in(toml::table& table, std::string_view key, NodeName give);
  void name_in_sets(toml::table& controller, const TomlTable& place);
  void name_list(toml::table& table, std::string_view key, NodeName give);
  void negate(toml::node* node);
  void mirror_number(toml::table& table, std::string_view key);
  void mirror_curve(toml::table& table);
  void exchange(toml::table& table, std::string_view key) const;
  void mirror_turn(toml::table& table) const;
  void transform_measure(toml::table& table);
  void transform_rope(toml::table& table, std::string_view key);
  void turn_load(toml::table& table);
  void transform_contact(toml::table& table);
  void transform_track(std::string_view key, toml::table& table, const TomlTable& place);
  void exchange_ends(toml::table& table);
};

}  // namespace poise
