#include <cmath>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

void draw_line_spring(Stage& stage, const Strung& spring) {
  const ElementReading& reading = stage.now.elements[spring.element];
  const Vec2 a = stage.page(spring.a);
  const Vec2 b = stage.page(spring.b);
  const double width = stage.detail == Detail::full ? 1.7 : 1.0;
  if (reading.slack)
    draw_spring(stage.canvas, a, b, {.stroke = ink::slack, .width = 0.8 * width, .dash = "3 3"});
  else
    draw_spring(stage.canvas, a, b, {.stroke = ink::spring, .width = width});
  stage.signs.insert(reading.slack ? Sign::slack_spring : Sign::spring);
  if (stage.detail != Detail::full) return;
  stage.setter.avoid(a, b, 12.0);
  Vec2 toward = quarter_turn(b - a);
  if (toward.y > 0) toward = -toward;
  const std::string says = reading.slack ? ": slack" : " = " + stage.value(reading.force, Quantity::force);
  stage.label(stage.scene.elements[spring.element].name + says, 0.5 * (a + b), toward, 9,
              reading.slack ? ink::faint : ink::spring);
}

void draw_torsion_spring(Stage& stage, std::size_t i) {
  const Element& spring = stage.scene.elements[i];
  const Vec2 at = stage.pivot(spring.on.body_a, spring.on.body_b);
  const int turning = spring.on.body_b != 0 ? spring.on.body_b : spring.on.body_a;
  Vec2 end = stage.page_direction(unit(stage.now.poses[turning].angle));
  const double radius = stage.detail == Detail::full ? 15.0 : 7.0;
  draw_spiral(stage.canvas, at, end, radius,
              {.stroke = ink::spring, .width = stage.detail == Detail::full ? 1.4 : 0.8});
  stage.signs.insert(Sign::torsion_spring);
  if (stage.detail != Detail::full) return;
  stage.setter.avoid(at, radius);
  stage.label(spring.name + " = " + stage.value(-stage.now.elements[i].force, Quantity::moment), at, {0.7, -0.7},
              radius + 4, ink::spring);
}

}  // namespace

void draw_springs(Stage& stage) {
  stage.canvas.open("springs");
  const std::vector<Element>& elements = stage.scene.elements;
  for (const Strung& strung : stage.strung()) {
    if (stores_energy(elements[strung.element].law)) draw_line_spring(stage, strung);
  }
  for (std::size_t i = 0; i < elements.size() && stage.detail != Detail::sketch; ++i) {
    if (stores_energy(elements[i].law) && elements[i].on.kind == Measure::Kind::angle) draw_torsion_spring(stage, i);
  }
  stage.canvas.close();
}

}  // namespace poise::app
