#include <algorithm>
#include <cmath>

#include "app/draw/stage.hpp"

namespace poise::app {
namespace {

constexpr double largest_ordinate = 52.0;  // px
constexpr double negligible_load = 1e-9;

void draw_diagram(Stage& stage, const Diagram& diagram, double largest) {
  std::vector<Vec2> line, area;
  std::size_t top = 0;
  for (std::size_t k = 0; k < diagram.value.size(); ++k) {
    line.push_back(stage.page(diagram.at[k]));
    area.push_back(line.back() +
                   (largest_ordinate * diagram.value[k] / largest) * Stage::page_direction(diagram.toward[k]));
    if (std::abs(diagram.value[k]) > std::abs(diagram.value[top])) top = k;
  }
  if (std::abs(diagram.value[top]) <= negligible_load * largest) return;
  const std::string text = stage.value(diagram.value[top], diagram.quantity);
  // Each part is an item, so that a reader who points at it is told its value. Of many positions the values stand in
  // charts: parts keep their names there.
  const bool moves = stage.picture.largest_diagram.has_value();
  for (std::size_t k = 1; k < area.size(); ++k) {
    const std::string here = stage.value(0.5 * (diagram.value[k - 1] + diagram.value[k]), diagram.quantity);
    stage.canvas.item(moves ? diagram.name : diagram.name + ": " + here);
    stage.canvas.polygon({area[k - 1], area[k], line[k], line[k - 1]}, {.fill = diagram.colour, .opacity = 0.25});
  }
  stage.canvas.item(diagram.name, text);
  stage.canvas.line(line.front(), area.front(), {.stroke = diagram.colour, .width = 1.0});
  stage.canvas.polyline(area, {.stroke = diagram.colour, .width = 1.6});
  stage.canvas.line(area.back(), line.back(), {.stroke = diagram.colour, .width = 1.0});
  for (std::size_t k = 1; k < area.size(); ++k) stage.setter.avoid(area[k - 1], area[k], 2.0);
  const Vec2 away = area[top] - line[top];
  if (diagram.labelled) stage.label(text, area[top], (1 / norm(away)) * away, 4, ink::dark);
  stage.signs.insert(Sign::diagram);
}

}  // namespace

double largest_of(const std::vector<Diagram>& diagrams) {
  double largest = 0.0;
  for (const Diagram& diagram : diagrams) {
    for (const double value : diagram.value) largest = std::max(largest, std::abs(value));
  }
  return largest;
}

void draw_diagrams(Stage& stage) {
  const double largest = stage.picture.largest_diagram.value_or(largest_of(stage.picture.diagrams));
  if (largest == 0.0) return;
  stage.canvas.open("diagrams");
  for (const Diagram& diagram : stage.picture.diagrams) draw_diagram(stage, diagram, largest);
  stage.canvas.close();
}

}  // namespace poise::app
