#pragma once

// Places and angles of parts: numbers, or expressions of numbers. Private to model/.

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace poise::parts {

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
  std::string factor() const { return is_number() && value >= 0.0 ? fmt::format("{}", value) : "(" + whole() + ")"; }
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

}  // namespace poise::parts
