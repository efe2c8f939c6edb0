#include <algorithm>
#include <utility>
#include <vector>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

/// How many springs, bars and earlier dampers have their ends where a damper has its own.
int count_parallel(const Stage& stage, const Strung& damper) {
  constexpr double same = 1.0;
  std::vector<std::pair<PointRef, PointRef>> others;
  for (const Strung& s : stage.strung()) {
    if (s.element < damper.element || stores_energy(stage.scene.elements[s.element].law)) others.emplace_back(s.a, s.b);
  }
  for (const Joint& joint : stage.scene.joints) {
    if (joint.keeps_length()) others.emplace_back(joint.a, joint.b);
  }
  const Vec2 a = stage.page(damper.a);
  const Vec2 b = stage.page(damper.b);
  const auto near = [](Vec2 p, Vec2 q) { return norm(q - p) < same; };
  return static_cast<int>(std::count_if(others.begin(), others.end(), [&](const auto& ends) {
    const Vec2 c = stage.page(ends.first);
    const Vec2 d = stage.page(ends.second);
    return (near(a, c) && near(b, d)) || (near(a, d) && near(b, c));
  }));
}

void draw_damper(Stage& stage, const Strung& damper) {
  const bool full = stage.detail == Detail::full;
  const Vec2 a = stage.page(damper.a);
  const Vec2 b = stage.page(damper.b);
  // To the side where springs do not have their labels.
  Vec2 side = quarter_turn(b - a);
  if (norm(side) > 0) side = (1 / norm(side)) * side;
  if (side.y < 0) side = -side;
  const Vec2 shift = ((full ? 20.0 : 10.0) * count_parallel(stage, damper)) * side;
  draw_dashpot(stage.canvas, a, b, shift, {.stroke = ink::damper, .width = full ? 1.6 : 0.9});
  stage.signs.insert(Sign::damper);
  if (!full) return;
  stage.setter.avoid(a + shift, b + shift, 14.0);
  stage.label(stage.scene.elements[damper.element].name, 0.5 * (a + b) + shift, side, 10, ink::damper);
}

}  // namespace

void draw_dampers(Stage& stage) {
  stage.canvas.open("dampers");
  for (const Strung& strung : stage.strung()) {
    if (!stores_energy(stage.scene.elements[strung.element].law)) draw_damper(stage, strung);
  }
  stage.canvas.close();
}

}  // namespace poise::app
