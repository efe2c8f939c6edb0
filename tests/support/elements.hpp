#pragma once

// Force elements of a scene built in code, and where to find those of a scene file.

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "model/scene.hpp"

namespace poise::test {

/// A law upon a measure, as in the table [[table]] of a scene file.
inline Element make_element(std::string table, std::string name, Measure on, const Law& law) {
  Element element;
  element.table = std::move(table);
  element.name = std::move(name);
  element.on = std::move(on);
  element.law = law;
  return element;
}

inline Element line_spring(std::string name, PointRef a, PointRef b, double stiffness, double free_length,
                           LinearSpring::Acts acts = LinearSpring::Acts::both) {
  return make_element("spring", std::move(name), Measure::distance_between(a, b),
                      LinearSpring{stiffness, free_length, acts});
}

inline Element torsion_spring(std::string name, int body_a, int body_b, double stiffness, double free_angle = 0.0) {
  return make_element("torsion_spring", std::move(name), Measure::angle_between(body_a, body_b),
                      LinearSpring{stiffness, free_angle, LinearSpring::Acts::both});
}

inline Element line_damper(std::string name, PointRef a, PointRef b, double coefficient) {
  return make_element("damper", std::move(name), Measure::distance_between(a, b), Damper{coefficient});
}

inline Element torsion_damper(std::string name, int body_a, int body_b, double coefficient) {
  return make_element("torsion_damper", std::move(name), Measure::angle_between(body_a, body_b), Damper{coefficient});
}

/// Dry friction against a relative turn.
inline Element friction(std::string name, int body_a, int body_b, double torque, double width = 0.01) {
  return make_element("friction", std::move(name), Measure::angle_between(body_a, body_b), DryFriction{torque, width});
}

/// Elements of the table.
inline int count_of(const Scene& scene, std::string_view table) {
  return static_cast<int>(std::count_if(scene.elements.begin(), scene.elements.end(),
                                        [&](const Element& element) { return element.table == table; }));
}

/// Index into Scene::elements of the n-th element of the table, from 0. Throws std::out_of_range where there is none.
inline std::size_t index_of(const Scene& scene, std::string_view table, int n = 0) {
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    if (scene.elements[i].table == table && n-- == 0) return i;
  }
  throw std::out_of_range("the scene has too few [[" + std::string(table) + "]]");
}

/// The n-th element of the table.
inline Element& element(Scene& scene, std::string_view table, int n = 0) {
  return scene.elements[index_of(scene, table, n)];
}
inline const Element& element(const Scene& scene, std::string_view table, int n = 0) {
  return scene.elements[index_of(scene, table, n)];
}

/// Its law.
template <class L>
L& law(Scene& scene, std::string_view table, int n = 0) {
  return std::get<L>(element(scene, table, n).law);
}
template <class L>
const L& law(const Scene& scene, std::string_view table, int n = 0) {
  return std::get<L>(element(scene, table, n).law);
}

inline void erase_elements(Scene& scene, std::string_view table) {
  std::erase_if(scene.elements, [&](const Element& element) { return element.table == table; });
}

}  // namespace poise::test
