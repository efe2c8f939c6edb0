#include <cmath>

#include "app/picture/stage.hpp"
#include "app/picture/symbols.hpp"

namespace poise::app {
namespace {

void draw_line_spring(Stage& stage, std::size_t i) {
  const Spring& spring = stage.scene.springs[i];
  const SpringReading& reading = stage.now.springs[i];
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
  stage.label(spring.name + says, 0.5 * (a + b), toward, 9, reading.slack ? ink::faint : ink::spring);
}

void draw_torsion_spring(Stage& stage, std::size_t i) {
  const TorsionSpring& spring = stage.scene.torsion_springs[i];
  const Vec2 at = stage.pivot(spring.a, spring.b);
  const int turning = spring.b != 0 ? spring.b : spring.a;
  Vec2 end = stage.page_direction(unit(stage.now.poses[turning].angle));
  const double radius = stage.detail == Detail::full ? 15.0 : 7.0;
  draw_spiral(stage.canvas, at, end, radius,
              {.stroke = ink::spring, .width = stage.detail == Detail::full ? 1.4 : 0.8});
  stage.signs.insert(Sign::torsion_spring);
  if (stage.detail != Detail::full) return;
  stage.setter.avoid(at, radius);
  stage.label(spring.name + " = " + stage.value(stage.now.torsion_moments[i], Quantity::moment), at, {0.7, -0.7},
              radius + 4, ink::spring);
}

}  // namespace

void draw_springs(Stage& stage) {
  stage.canvas.open("springs");
  for (std::size_t i = 0; i < stage.scene.springs.size(); ++i) draw_line_spring(stage, i);
  if (stage.detail != Detail::sketch) {
    for (std::size_t i = 0; i < stage.scene.torsion_springs.size(); ++i) draw_torsion_spring(stage, i);
  }
  stage.canvas.close();
}

}  // namespace poise::app
