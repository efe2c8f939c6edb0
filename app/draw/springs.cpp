#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

/// What takes up a line of the page, to half its width `reach` on both sides.
struct Occupied {
  Vec2 a, b;
  double reach;
};

/// Whether two lines lie on each other over a good part of the shorter.
bool lie_on_each_other(const Occupied& p, const Occupied& q) {
  constexpr double shared = 0.3;
  const double length = norm(p.b - p.a);
  const double other = norm(q.b - q.a);
  if (length < 1.0 || other < 1.0) return false;
  const Vec2 u = (1 / length) * (p.b - p.a);
  const double first = dot(u, q.a - p.a);
  const double last = dot(u, q.b - p.a);
  const double begin = std::max(0.0, std::min(first, last));
  const double end = std::min(length, std::max(first, last));
  if (end - begin < shared * std::min(length, other)) return false;
  const auto aside = [&](double at) {
    return std::abs(cross(u, q.a - p.a) + (at - first) / (last - first) * cross(u, q.b - q.a));
  };
  return std::max(aside(begin), aside(end)) < p.reach + q.reach;
}

std::vector<Occupied> occupied_by_bodies(const Stage& stage) {
  std::vector<Occupied> lines;
  const double reach = 0.5 * stage.bar_width;
  for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) {
    const std::vector<Vec2> shape = stage.outline(static_cast<int>(i), stage.now);
    for (std::size_t k = 0; k + 1 < shape.size() + (shape.size() > 2 ? 1 : 0); ++k) {
      lines.push_back({shape[k], shape[(k + 1) % shape.size()], reach});
    }
  }
  for (const Joint& joint : stage.scene.joints) {
    if (joint.keeps_length()) lines.push_back({stage.page(joint.a), stage.page(joint.b), reach});
  }
  for (const Cylinder& c : stage.cylinders) lines.push_back({c.foot, c.eye, stage.bar_width});
  return lines;
}

/// How far a line from a to b has to move aside to lie on nothing that is drawn, and what it takes up there.
Vec2 shift_aside(const Stage& stage, const std::string& name, std::vector<Occupied>& occupied, Vec2 a, Vec2 b,
                 double reach) {
  constexpr std::array<double, 9> places = {0, 1, -1, 2, -2, 3, -3, 4, -4};
  const double pitch = 2.6 * reach;
  Vec2 side = quarter_turn(b - a);
  if (norm(side) > 0) side = (1 / norm(side)) * side;
  if (side.y < 0 || (side.y == 0 && side.x < 0)) side = -side;
  const auto is_free = [&](double place) {
    const Vec2 shift = place * pitch * side;
    const Occupied line{a + shift, b + shift, reach};
    return std::none_of(occupied.begin(), occupied.end(),
                        [&](const Occupied& o) { return lie_on_each_other(o, line); });
  };
  auto place = std::find_if(places.begin(), places.end(), is_free);
  if (place == places.end()) --place;
  const std::size_t kept = stage.first_free(name, static_cast<std::size_t>(place - places.begin()),
                                            [&](std::size_t i) { return is_free(places[i]); });
  const Vec2 shift = places[kept] * pitch * side;
  occupied.push_back({a + shift, b + shift, reach});
  return shift;
}

/// "150.35 mm, 251.8 N, in tension".
std::string state_of(const Stage& stage, const Element& element, const ElementReading& reading) {
  std::string state = stage.reading(reading.value, quantity_of(element.on));
  const auto is_of_it = [&](const TimeFunction& one) {
    return one.of == TimeFunction::Of::element && &stage.scene.elements[static_cast<std::size_t>(one.item)] == &element;
  };
  const std::vector<TimeFunction>& functions = stage.scene.time_functions;
  if (std::any_of(functions.begin(), functions.end(), is_of_it)) state += ", varies in time";
  if (!stores_energy(element.law)) return state;
  if (reading.slack) return state + ", slack";
  if (!stage.picture.reactions) return state;
  if (element.on.is_angle()) return state + ", " + stage.value(-reading.force, Quantity::moment, reading.radius);
  state += ", " + stage.value(std::abs(reading.force), Quantity::force, reading.radius);
  if (std::isfinite(reading.radius) && std::abs(reading.force) <= reading.radius) return state;
  return state + (reading.force < 0 ? ", in compression" : ", in tension");
}

void draw_strung(Stage& stage, const Strung& strung, Vec2 shift) {
  const Element& element = stage.scene.elements[strung.element];
  const ElementReading& reading = stage.now.elements[strung.element];
  const bool full = stage.detail == Detail::full;
  const bool spring = stores_energy(element.law);
  const bool gas = std::holds_alternative<GasStrut>(element.law);
  const Vec2 a = stage.page(strung.a);
  const Vec2 b = stage.page(strung.b);
  const double width = full ? 1.7 : 1.0;
  stage.canvas.item(element.family() + " " + element.name, state_of(stage, element, reading));
  if (!spring)
    draw_dashpot(stage.canvas, a, b, shift, {.stroke = ink::damper, .width = 0.95 * width});
  else if (gas)
    draw_gas_strut(stage.canvas, a, b, shift, {.stroke = ink::spring, .width = width});
  else if (reading.slack)
    draw_spring(stage.canvas, a, b, shift, {.stroke = ink::slack, .width = 0.8 * width, .dash = "3 3"});
  else
    draw_spring(stage.canvas, a, b, shift, {.stroke = ink::spring, .width = width});
  stage.signs.insert(!spring         ? Sign::damper
                     : gas           ? Sign::gas_strut
                     : reading.slack ? Sign::slack_spring
                                     : Sign::spring);
  if (!full) return;
  stage.setter.avoid(a + shift, b + shift, 14.0);
  Vec2 toward = quarter_turn(b - a);
  if (norm(shift) > 0 ? dot(toward, shift) < 0 : toward.y > 0) toward = -toward;
  std::string text = element.name;
  if (spring && reading.slack) text += ": slack";
  if (spring && !reading.slack && stage.picture.reactions) {
    text += " = " + stage.value(reading.force, Quantity::force, reading.radius);
  }
  stage.label(text, 0.5 * (a + b) + shift, toward, 9, !spring ? ink::damper : reading.slack ? ink::faint : ink::spring);
}

/// A spiral; the next one at the same pivot lies round it.
void draw_torsion_spring(Stage& stage, std::size_t i, std::vector<Vec2>& pivots) {
  const Element& spring = stage.scene.elements[i];
  const ElementReading& reading = stage.now.elements[i];
  const Vec2 at = stage.pivot(spring.on.body_a, spring.on.body_b);
  const auto around = std::count_if(pivots.begin(), pivots.end(), [&](Vec2 p) { return norm(p - at) < 1.0; });
  pivots.push_back(at);
  const int turning = spring.on.body_b != 0 ? spring.on.body_b : spring.on.body_a;
  const Vec2 end = stage.page_direction(unit(stage.now.poses[turning].angle));
  const bool full = stage.detail == Detail::full;
  stage.canvas.item(spring.family() + " " + spring.name, state_of(stage, spring, reading));
  const double radius = (full ? 15.0 : 7.0) * (1.0 + static_cast<double>(around));
  draw_spiral(stage.canvas, at, end, radius, {.stroke = ink::spring, .width = full ? 1.4 : 0.8});
  stage.signs.insert(Sign::torsion_spring);
  if (!full) return;
  stage.setter.avoid(at, radius);
  std::string text = spring.name;
  if (stage.picture.reactions) text += " = " + stage.value(-reading.force, Quantity::moment, reading.radius);
  stage.label(text, at, {0.7, -0.7}, radius + 4, ink::spring);
}

/// A motor stands at its pivot.
void draw_motor_of(Stage& stage, std::size_t i) {
  const Element& motor = stage.scene.elements[i];
  const Vec2 at = stage.pivot(motor.on.body_a, motor.on.body_b);
  const bool full = stage.detail == Detail::full;
  const double radius = full ? 13.0 : 6.0;
  stage.canvas.item(motor.family() + " " + motor.name, state_of(stage, motor, stage.now.elements[i]));
  draw_motor(stage.canvas, at, radius, {.stroke = ink::drive, .width = full ? 1.6 : 0.9});
  stage.signs.insert(Sign::motor);
  if (!full) return;
  stage.setter.avoid(at, radius);
  stage.label(motor.name, at, {-0.7, -0.7}, radius + 4, ink::drive);
}

/// A controller stands where it acts, or at the element of which it sets a number, and one without either where it
/// reads, if it reads a measure.
void draw_controller_of(Stage& stage, std::size_t i) {
  const Element& controller = stage.scene.elements[i];
  const Feedback& feedback = *controller.feedback;
  const bool sets_element = feedback.sets && feedback.sets->of == TimeFunction::Of::element;
  const Measure& acts_on =
      sets_element ? stage.scene.elements[static_cast<std::size_t>(feedback.sets->item)].on : controller.on;
  const bool is_at_reading = (!feedback.acts && !sets_element) || acts_on.kind == Measure::Kind::sum;
  if (is_at_reading && feedback.source != Feedback::Source::measure) return;
  const Measure& on = is_at_reading ? feedback.reads : acts_on;
  const auto place = [&]() -> Vec2 {
    switch (on.kind) {
      case Measure::Kind::angle:
        return stage.pivot(on.body_a, on.body_b);
      case Measure::Kind::travel:
        return stage.page(stage.scene.joints[static_cast<std::size_t>(on.joint)].b);
      case Measure::Kind::rope:
        return stage.page(on.contacts.front().at);
      case Measure::Kind::distance:
        return 0.5 * (stage.page(on.a) + stage.page(on.b));
      default:
        return stage.page(on.b);
    }
  };
  const Vec2 at = place();
  const bool full = stage.detail == Detail::full;
  const double radius = full ? 13.0 : 6.0;
  stage.canvas.item(controller.family() + " " + controller.name, state_of(stage, controller, stage.now.elements[i]));
  draw_controller(stage.canvas, at, radius, {.stroke = ink::drive, .width = full ? 1.6 : 0.9});
  stage.signs.insert(Sign::controller);
  if (!full) return;
  stage.setter.avoid(at, radius);
  stage.label(controller.name, at, {0.7, -0.7}, radius + 4, ink::drive);
}

}  // namespace

void draw_springs_and_dampers(Stage& stage) {
  stage.canvas.open("springs-and-dampers");
  std::vector<Occupied> occupied;
  const bool sketch = stage.detail == Detail::sketch;
  if (!sketch) occupied = occupied_by_bodies(stage);
  const double reach = stage.detail == Detail::full ? 7.5 : 4.0;
  for (const Strung& strung : stage.strung()) {
    const Vec2 shift = sketch ? Vec2{}
                              : shift_aside(stage, stage.scene.elements[strung.element].name, occupied,
                                            stage.page(strung.a), stage.page(strung.b), reach);
    draw_strung(stage, strung, shift);
  }
  const std::vector<Element>& elements = stage.scene.elements;
  for (std::size_t i = 0; i < elements.size() && !sketch; ++i) {
    if (elements[i].on.kind != Measure::Kind::rope || !stores_energy(elements[i].law)) continue;
    const ElementReading& reading = stage.now.elements[i];
    stage.canvas.item(elements[i].family() + " " + elements[i].name, state_of(stage, elements[i], reading));
    draw_rope_line(
        stage, elements[i].on,
        {.stroke = reading.slack ? ink::slack : ink::spring, .width = 1.6, .dash = reading.slack ? "3 3" : ""});
    stage.signs.insert(Sign::rope);
  }
  std::vector<Vec2> pivots;
  for (std::size_t i = 0; i < elements.size() && !sketch; ++i) {
    const bool torsion = stores_energy(elements[i].law) && elements[i].on.kind == Measure::Kind::angle;
    if (torsion && !std::holds_alternative<CompliantStop>(elements[i].law)) draw_torsion_spring(stage, i, pivots);
    if (is_motor(elements[i].law)) draw_motor_of(stage, i);
    if (elements[i].feedback) draw_controller_of(stage, i);
  }
  stage.canvas.close();
}

}  // namespace poise::app
