#include "app/draw/stage.hpp"

#include <algorithm>
#include <cmath>

#include "app/draw/symbols.hpp"
#include "app/shown_values.hpp"

namespace poise::app {
namespace {

// Room for the mechanism itself; arrows and labels come on top.
constexpr double page_width = 720.0;
constexpr double page_height = 500.0;

std::optional<Readings> read_start(const StaticModel& model, const std::vector<double>& start) {
  if (start.empty()) return std::nullopt;
  return read_off(model, start);
}

}  // namespace

Stage::Stage(const StaticModel& the_model, const Equilibrium& the_rest, const std::vector<double>& start)
    : model(the_model),
      scene(the_model.scene()),
      rest(the_rest),
      now(read_off(the_model, the_rest.x)),
      before(read_start(the_model, start)) {
  choose_detail();
  choose_scale();
  for (const Force& force : scene.forces) largest_force = std::max(largest_force, norm(force.vector));
  for (const Reaction& r : rest.check.reactions) largest_force = std::max(largest_force, norm(r.force));
}

void Stage::choose_detail() {
  const std::size_t parts = std::max(scene.bodies.size(), scene.joints.size());
  detail = parts <= 24 ? Detail::full : parts <= 120 ? Detail::reduced : Detail::sketch;
  const auto at_ground = [](const Joint& joint) { return joint.a.body == 0 || joint.b.body == 0; };
  shows_ground = detail != Detail::sketch || std::count_if(scene.joints.begin(), scene.joints.end(), at_ground) <= 12;
}

void Stage::choose_scale() {
  Box extent;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (const NamedPoint& p : scene.bodies[i].points) {
      extent.include(now.poses[i].world(p.at));
      if (before) extent.include(before->poses[i].world(p.at));
    }
  }
  const auto include = [&](PointRef p) { extent.include(world(scene, now, p)); };
  for (const Joint& joint : scene.joints) {
    if (!joint.has_travel() || joint.a.body != 0) include(joint.a);
    include(joint.b);
  }
  for (const Strung& s : strung()) {
    include(s.a);
    include(s.b);
  }
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.mass > 0 && !(scene.gravity == Vec2{})) extent.include(now.poses[i].world(body.center));
  }
  if (extent.empty()) extent.include({0, 0}, model.scales().length);
  const double size = std::max({extent.width(), extent.height(), 1e-6 * model.scales().length});
  scale =
      std::min(page_width / std::max(extent.width(), 0.2 * size), page_height / std::max(extent.height(), 0.2 * size));

  std::vector<double> lengths;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    Box reach;
    for (const NamedPoint& p : scene.bodies[i].points) reach.include(p.at);
    const double length = scale * std::hypot(reach.width(), reach.height());
    if (length > 0) lengths.push_back(length);
  }
  if (!lengths.empty()) {
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    bar_width = std::clamp(0.12 * *middle, 2.5, 9.0);
  }
  pin_radius = std::clamp(0.55 * bar_width, 1.6, 4.5);
}

std::vector<Strung> Stage::strung() const {
  std::vector<Strung> found;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    if (!stores_energy(element.law) && !std::holds_alternative<Damper>(element.law)) continue;
    const Measure& on = element.on;
    if (on.kind == Measure::Kind::distance) found.push_back({i, on.a, on.b});
    if (on.kind == Measure::Kind::travel) found.push_back({i, scene.joints[on.joint].a, scene.joints[on.joint].b});
  }
  return found;
}

std::vector<Vec2> Stage::points_of(int body, const Readings& readings) const {
  std::vector<Vec2> points;
  for (const NamedPoint& p : scene.bodies[body].points) points.push_back(page(readings.poses[body].world(p.at)));
  return points;
}

std::vector<Vec2> Stage::members_at(Vec2 place) const {
  constexpr double same = 1.0;
  std::vector<Vec2> members;
  const auto add = [&](Vec2 from, Vec2 to) {
    const double length = norm(to - from);
    if (norm(from - place) < same && length > same) members.push_back((1 / length) * (to - from));
  };
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const std::vector<Vec2> points = points_of(static_cast<int>(i), now);
    for (const Vec2& from : points) {
      for (const Vec2& to : points) add(from, to);
    }
  }
  const auto add_both = [&](PointRef a, PointRef b) {
    add(page(a), page(b));
    add(page(b), page(a));
  };
  for (const Strung& s : strung()) add_both(s.a, s.b);
  for (const Joint& joint : scene.joints) {
    if (joint.keeps_length()) add_both(joint.a, joint.b);
  }
  return members;
}

std::string Stage::short_name(const Joint& joint) const {
  const std::string given_to_unnamed = scene.name_of(joint.a) + "-" + scene.name_of(joint.b);
  if (!joint.name.starts_with(given_to_unnamed)) return joint.name;
  if (joint.keeps_length()) return "";
  return scene.bodies[joint.a.body].points[joint.a.point].name;
}

Vec2 Stage::pivot(int a, int b) const {
  for (const Joint& joint : scene.joints) {
    const bool joins = (joint.a.body == a && joint.b.body == b) || (joint.a.body == b && joint.b.body == a);
    if (joins && !joint.keeps_length()) return page(joint.b);
  }
  return page(now.poses[b].origin);
}

double Stage::arrow_length(double force) const {
  if (largest_force <= 0) return 0.0;
  return 22.0 + 62.0 * std::sqrt(force / largest_force);
}

std::string Stage::value(double si, Quantity quantity, int digits) const {
  const double shown = in_units(model, quantity, {si}).front();
  const std::string size = significant(std::abs(shown), digits);
  return (shown < 0 && size != "0" ? "\u2212" : "") + size + " " + unit_name(quantity, scene.units);
}

void Stage::label(std::string text, Vec2 anchor, Vec2 toward, double gap, const std::string& colour, double size,
                  bool italic) {
  Label label{.text = std::move(text), .anchor = anchor, .gap = gap, .toward = toward};
  label.style.colour = colour;
  label.style.size = size;
  label.style.italic = italic;
  labels.push_back(std::move(label));
}

}  // namespace poise::app
