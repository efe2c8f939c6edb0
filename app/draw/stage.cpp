#include "app/draw/stage.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "app/draw/symbols.hpp"
#include "model/couplings.hpp"
#include "model/curved_slots.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

// What follows from the position of a picture, with the radii that it has.
Readings readings_of_picture(const Scene& scene, const MechanismPicture& picture) {
  Readings out = readings_of(scene, picture.poses);
  for (std::size_t e = 0; e < picture.element_radii.size(); ++e) out.elements[e].radius = picture.element_radii[e];
  return out;
}

std::vector<Readings> read_others(const Scene& scene, const std::vector<OtherPose>& others) {
  std::vector<Readings> readings;
  for (const OtherPose& other : others) readings.push_back(readings_of(scene, other.poses));
  return readings;
}

}  // namespace

std::vector<Strung> strung_of(const Scene& scene) {
  std::vector<Strung> found;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    if (std::holds_alternative<DryFriction>(element.law) || std::holds_alternative<CompliantStop>(element.law))
      continue;
    const Measure& on = element.on;
    if (on.kind == Measure::Kind::distance) found.push_back({i, on.a, on.b});
    if (on.kind == Measure::Kind::travel) found.push_back({i, scene.joints[on.joint].a, scene.joints[on.joint].b});
  }
  return found;
}

namespace {

using Edge = std::pair<PointRef, PointRef>;

std::vector<Edge> edges_of(const Outline& outline) {
  std::vector<Edge> out;
  const std::vector<PointRef>& points = outline.points;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) out.emplace_back(points[k], points[k + 1]);
  if (!outline.backed && points.size() > 2) out.emplace_back(points.back(), points.front());
  return out;
}

/// The points along edges that go on from each other, the first once more where they close; none where not all do.
std::vector<PointRef> way_along(const std::vector<Edge>& edges) {
  if (edges.empty()) return {};
  const auto begins = [&](const Edge& edge) {
    return std::none_of(edges.begin(), edges.end(), [&](const Edge& other) { return other.second == edge.first; });
  };
  auto edge = std::find_if(edges.begin(), edges.end(), begins);
  if (edge == edges.end()) edge = edges.begin();
  std::vector<PointRef> out{edge->first};
  while (edge != edges.end() && out.size() <= edges.size()) {
    out.push_back(edge->second);
    edge = std::find_if(edges.begin(), edges.end(), [&](const Edge& next) { return next.first == out.back(); });
  }
  if (out.size() != edges.size() + 1) out.clear();
  return out;
}

/// The shape of a body with this way of a contact around it or on one side of it, in its frame. Empty where the way is
/// that of a hole, or where the body has points outside.
std::vector<Vec2> shape_with(const Scene& scene, int body, const std::vector<PointRef>& way) {
  constexpr double rounding = 1e-9;
  std::vector<Vec2> shape, all;
  for (const PointRef& point : way) shape.push_back(scene.local(point));
  for (const NamedPoint& point : scene.bodies[static_cast<std::size_t>(body)].points) all.push_back(point.at);
  if (shape.size() < 3) return {};
  const bool closed = way.front() == way.back();
  if (closed) shape.pop_back();
  double area = 0.0;  // twice that, counter-clockwise
  for (std::size_t k = 0; k < shape.size(); ++k) area += cross(shape[k], shape[(k + 1) % shape.size()]);
  if (closed && area >= 0.0) return {};
  const Vec2 chord = shape.back() - shape.front(), middle = 0.5 * (shape.front() + shape.back());
  std::vector<Vec2> behind;
  for (const Vec2& corner : convex_hull(all)) {
    const bool is_behind = !closed && cross(chord, corner - middle) < -rounding * dot(chord, chord);
    if (is_behind)
      behind.push_back(corner);
    else if (std::find(shape.begin(), shape.end(), corner) == shape.end())
      return {};
  }
  // From the last point of the way clockwise to its first, past corners of the way once more.
  const auto turned = [&](Vec2 corner) {
    return std::atan2(cross(corner - middle, chord), dot(corner - middle, chord));
  };
  std::sort(behind.begin(), behind.end(), [&](Vec2 a, Vec2 b) { return turned(a) < turned(b); });
  shape.insert(shape.end(), behind.begin(), behind.end());
  return shape;
}

std::vector<std::vector<Vec2>> shapes_by_contacts(const Scene& scene) {
  std::vector<std::vector<Vec2>> out(scene.bodies.size());
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    if (stop.table != "contact" || stop.on.outline.form != Outline::Form::polygon) continue;
    // Where two outlines touch, each of the two bodies has its own, which all corners of the other may touch.
    std::map<int, std::vector<Edge>> edges;
    for (std::size_t part = s; part < s + static_cast<std::size_t>(stop.parts); ++part) {
      std::vector<Edge>& of_body = edges[scene.stops[part].on.outline.points.front().body];
      for (const Edge& edge : edges_of_contact(scene, part)) {
        if (std::find(of_body.begin(), of_body.end(), edge) == of_body.end()) of_body.push_back(edge);
      }
    }
    for (const auto& [body, of_body] : edges) {
      std::vector<Vec2>& shape = out[static_cast<std::size_t>(body)];
      if (body > 0 && shape.empty()) shape = shape_with(scene, body, way_along(of_body));
    }
  }
  return out;
}

}  // namespace

std::vector<Edge> edges_of_contact(const Scene& scene, std::size_t stop) {
  std::size_t first = stop;
  while (first > 0 && scene.stops[first].table.starts_with("contact_part")) --first;
  std::vector<Edge> out;
  for (const Edge& edge : edges_of(scene.stops[stop].on.outline)) {
    const Edge back{edge.second, edge.first};
    bool is_inner = false;
    for (std::size_t part = first; part < first + static_cast<std::size_t>(scene.stops[first].parts); ++part) {
      const std::vector<Edge> others = edges_of(scene.stops[part].on.outline);
      is_inner = is_inner || (part != stop && std::find(others.begin(), others.end(), back) != others.end());
    }
    if (!is_inner) out.push_back(edge);
  }
  return out;
}

Box extent_of(const Scene& scene, const Readings& readings) {
  Box box;
  const auto include = [&](PointRef p) { box.include(world(scene, readings, p)); };
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (is_of_track(scene, static_cast<int>(i))) continue;
    for (const NamedPoint& p : body.points) box.include(readings.poses[i].world(p.at));
    if (body.mass > 0 && !(scene.gravity == Vec2{})) box.include(readings.poses[i].world(body.center));
  }
  for (const Joint& joint : scene.joints) {
    if (is_of_track(scene, joint)) continue;
    if (!joint.has_travel() || joint.a.body != 0) include(joint.a);
    include(joint.b);
  }
  for (const Strung& s : strung_of(scene)) {
    include(s.a);
    include(s.b);
  }
  const auto include_rope = [&](const Measure& on) {
    for (const RopeContact& contact : on.contacts) box.include(world(scene, readings, contact.at), contact.radius);
  };
  for (const Element& element : scene.elements) include_rope(element.on);
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    include_rope(stop.on);
    if (has_track(stop)) {
      include_track(scene, readings, s, box);
    } else if (stop.table == "gear" || stop.table == "belt") {
      const PitchCircles wheels = pitch_circles(scene, readings, stop);
      // The circles of wheels one inside the other that are nearly alike would leave no room for the mechanism.
      const double most = 4.0 * norm(wheels.centre_b - wheels.centre_a);
      box.include(wheels.centre_a, std::min(wheels.radius_a, most));
      box.include(wheels.centre_b, std::min(wheels.radius_b, most));
    } else if (stop.table == "rack") {
      const Measure::Term& pinion = stop.on.terms[1];
      constexpr double with_rack = 1.8;  // radii
      box.include(pivot_of(scene, readings, pinion.measure.body_a, pinion.measure.body_b),
                  with_rack * std::abs(pinion.factor));
    } else if (stop.table == "geneva") {
      const PitchCircles axes = pitch_circles(scene, readings, stop);
      const double apart = norm(axes.centre_b - axes.centre_a), half = M_PI / slots_of(stop);
      constexpr double with_pin = 1.15;  // lengths of the crank
      box.include(axes.centre_a, with_pin * std::sin(half) * apart);
      box.include(axes.centre_b, std::cos(half) * apart);
    } else if (stop.table == "cam") {
      for (const Vec2& point : pitch_curve(scene, readings, stop)) box.include(point);
    }
  }
  return box;
}

Box world_of(const Scene& scene, const MechanismPicture& picture) {
  if (picture.frame) return *picture.frame;
  Box box = extent_of(scene, readings_of(scene, picture.poses));
  for (const OtherPose& other : picture.others) {
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
      for (const NamedPoint& p : scene.bodies[i].points) box.include(other.poses[i].world(p.at));
    }
  }
  for (const PointPath& path : picture.paths) {
    for (const Vec2& p : path.points) box.include(p);
  }
  return box;
}

namespace {

constexpr double shortest_arrow = 22.0, growth_of_arrow = 62.0;  // px

}  // namespace

double length_of_arrow(double force, double largest) {
  return largest > 0.0 ? shortest_arrow + growth_of_arrow * std::sqrt(force / largest) : 0.0;
}

double force_of_arrow(double length, double largest) {
  const double root = std::max(0.0, length - shortest_arrow) / growth_of_arrow;
  return largest * root * root;
}

double largest_force_of(const Scene& scene, const MechanismPicture& picture) {
  double largest = 0.0;
  if (picture.loads) {
    for (const Force& force : scene.forces) largest = std::max(largest, scene.size_of(force));
  }
  if (picture.reactions) {
    for (const Reaction& r : *picture.reactions) largest = std::max(largest, norm(r.force));
  }
  for (const TouchingForce& one : picture.touching) largest = std::max(largest, norm(one.force));
  for (const DriveEffort& drive : picture.drives) {
    if (!drive.is_angle) largest = std::max(largest, std::abs(drive.value));
  }
  return largest;
}

Sizes sizes_for(const Scene& scene, const Box& world, Vec2 room) {
  Sizes sizes;
  const std::size_t parts = std::max(scene.bodies.size(), scene.joints.size());
  sizes.detail = parts <= 24 ? Detail::full : parts <= 120 ? Detail::reduced : Detail::sketch;
  const auto at_ground = [](const Joint& joint) { return joint.a.body == 0 || joint.b.body == 0; };
  sizes.shows_ground =
      sizes.detail != Detail::sketch || std::count_if(scene.joints.begin(), scene.joints.end(), at_ground) <= 12;

  if (!world.empty()) sizes.centre = world.middle();
  sizes.extent = std::max(world.width(), world.height());
  if (sizes.extent <= 0.0) sizes.extent = scene.units.length;
  sizes.scale = std::min(room.x / std::max(world.width(), 0.2 * sizes.extent),
                         room.y / std::max(world.height(), 0.2 * sizes.extent));

  std::vector<double> lengths;
  const auto add_length = [&](double length) {
    if (length > 0) lengths.push_back(sizes.scale * length);
  };
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    Box reach;
    for (const NamedPoint& p : scene.bodies[i].points) reach.include(p.at);
    add_length(std::hypot(reach.width(), reach.height()));
  }
  for (const Joint& joint : scene.joints) {
    if (joint.keeps_length()) add_length(joint.length);
  }
  if (!lengths.empty()) {
    constexpr double room_for_names = 45.0;
    constexpr std::size_t few = 8;
    const auto median = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), median, lengths.end());
    sizes.bar_width = std::clamp(0.12 * *median, 2.5, 9.0);
    if (sizes.detail == Detail::full && lengths.size() > few && *median < room_for_names)
      sizes.detail = Detail::reduced;
  }
  sizes.pin_radius = std::clamp(0.55 * sizes.bar_width, 1.6, 4.5);
  return sizes;
}

Stage::Stage(const Scene& the_scene, const MechanismPicture& the_picture, Vec2 room)
    : Stage(the_scene, the_picture, sizes_for(the_scene, world_of(the_scene, the_picture), room), nullptr) {}

Stage::Stage(const Scene& the_scene, const MechanismPicture& the_picture, const Sizes& sizes, Choices* before)
    : Sizes(sizes),
      scene(the_scene),
      picture(the_picture),
      now(readings_of_picture(the_scene, the_picture)),
      others(read_others(the_scene, the_picture.others)),
      largest_force(the_picture.largest_force ? *the_picture.largest_force : largest_force_of(the_scene, the_picture)),
      strung_(strung_of(the_scene)),
      points_(scene.bodies.size()),
      shapes_(shapes_by_contacts(the_scene)),
      before_(before) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (is_of_track(scene, static_cast<int>(i))) continue;
    for (const NamedPoint& p : scene.bodies[i].points) points_[i].push_back(page(now.poses[i].world(p.at)));
  }
  if (detail != Detail::sketch) find_cylinders();
}

void Stage::find_cylinders() {
  constexpr double on_line = 1.0;  // px
  constexpr double shortest = 24.0;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& slide = scene.joints[j];
    if (slide.kind != Joint::Kind::slide || slide.a.body == 0 || slide.b.body == 0) continue;
    const Vec2 line = page_axis(slide);
    const Vec2 origin = page(slide.a);
    const auto straight = [&](int body) {
      const std::vector<Vec2>& points = points_of(body);
      return std::all_of(points.begin(), points.end(),
                         [&](Vec2 p) { return std::abs(cross(line, p - origin)) < on_line; });
    };
    if (!straight(slide.a.body) || !straight(slide.b.body)) continue;
    // The pins farthest from each other.
    Cylinder found{.joint = j, .barrel = slide.a.body, .rod = slide.b.body};
    double length = 0.0;
    const auto pins_of = [&](int body) {
      std::vector<Vec2> pins;
      for (const Joint& joint : scene.joints) {
        if (joint.kind != Joint::Kind::pin) continue;
        if (joint.a.body == body) pins.push_back(page(joint.a));
        if (joint.b.body == body) pins.push_back(page(joint.b));
      }
      return pins;
    };
    for (const Vec2& foot : pins_of(found.barrel)) {
      for (const Vec2& eye : pins_of(found.rod)) {
        if (norm(eye - foot) <= length) continue;
        length = norm(eye - foot);
        found.foot = foot;
        found.eye = eye;
      }
    }
    if (length < shortest) continue;
    const Vec2 along = (1 / length) * (found.eye - found.foot);
    double mouth = 0.0;
    double piston = length;
    for (const Vec2& p : points_of(found.barrel)) mouth = std::max(mouth, dot(along, p - found.foot));
    for (const Vec2& p : points_of(found.rod)) piston = std::min(piston, dot(along, p - found.foot));
    // Ends that the scene does not give.
    if (mouth < 0.3 * length) mouth = 0.6 * length;
    mouth = std::min(mouth, 0.9 * length);
    if (piston > 0.9 * mouth) piston = 0.5 * mouth;
    found.mouth = found.foot + mouth * along;
    found.piston = found.foot + std::max(piston, 0.12 * length) * along;
    cylinders.push_back(found);
  }
}

const Cylinder* Stage::cylinder_of_body(int body) const {
  const auto found = std::find_if(cylinders.begin(), cylinders.end(),
                                  [&](const Cylinder& c) { return c.barrel == body || c.rod == body; });
  return found == cylinders.end() ? nullptr : &*found;
}

const Cylinder* Stage::cylinder_of_joint(std::size_t joint) const {
  const auto found =
      std::find_if(cylinders.begin(), cylinders.end(), [&](const Cylinder& c) { return c.joint == joint; });
  return found == cylinders.end() ? nullptr : &*found;
}

std::vector<Vec2> Stage::outline(int body, const Readings& readings) const {
  if (is_of_track(scene, body)) return {};
  if (const std::vector<Vec2>& shape = shapes_[static_cast<std::size_t>(body)]; !shape.empty()) {
    std::vector<Vec2> out;
    for (const Vec2& corner : shape) out.push_back(page(readings.poses[static_cast<std::size_t>(body)].world(corner)));
    return out;
  }
  if (&readings == &now) return convex_hull(points_of(body));
  std::vector<Vec2> points;
  for (const NamedPoint& p : scene.bodies[body].points) points.push_back(page(readings.poses[body].world(p.at)));
  return convex_hull(std::move(points));
}

std::vector<Vec2> Stage::members_at(Vec2 place) const {
  constexpr double same = 1.0;
  std::vector<Vec2> members;
  const auto add = [&](Vec2 from, Vec2 to) {
    const double length = norm(to - from);
    if (length > same) members.push_back((1 / length) * (to - from));
  };
  for (std::size_t i = 1; i < points_.size(); ++i) {
    for (const Vec2& from : points_[i]) {
      if (norm(from - place) >= same) continue;
      for (const Vec2& to : points_[i]) add(from, to);
    }
  }
  const auto add_both = [&](PointRef a, PointRef b) {
    const Vec2 from = page(a);
    const Vec2 to = page(b);
    if (norm(from - place) < same) add(from, to);
    if (norm(to - place) < same) add(to, from);
  };
  for (const Strung& s : strung()) add_both(s.a, s.b);
  for (const Joint& joint : scene.joints) {
    if (joint.keeps_length()) add_both(joint.a, joint.b);
  }
  return members;
}

std::string Stage::item_of(const Joint& joint) { return words_of_key(joint.traits().key) + " " + joint.name; }

std::string Stage::short_name(const Joint& joint) const {
  const std::string given_to_unnamed = scene.name_of(joint.a) + "-" + scene.name_of(joint.b);
  if (!joint.name.starts_with(given_to_unnamed)) return joint.name;
  if (joint.keeps_length()) return "";
  return scene.bodies[joint.a.body].points[joint.a.point].name;
}

Vec2 pivot_of(const Scene& scene, const Readings& readings, int a, int b) {
  for (const Joint& joint : scene.joints) {
    const bool joins = (joint.a.body == a && joint.b.body == b) || (joint.a.body == b && joint.b.body == a);
    if (joins && !joint.keeps_length()) return world(scene, readings, joint.b);
  }
  return readings.poses[static_cast<std::size_t>(b)].origin;
}

Vec2 Stage::pivot(int a, int b) const { return page(pivot_of(scene, now, a, b)); }

double Stage::arrow_length(double force) const { return length_of_arrow(force, largest_force); }

std::string Stage::value(double si, Quantity quantity, double radius) const {
  constexpr double rounding = 1e-13;
  const double scale_of_all = largest_force * (quantity == Quantity::moment ? extent : 1.0);
  if (std::abs(si) < rounding * scale_of_all) si = 0.0;
  const double shown = std::abs(in_unit(si, quantity, scene.units));
  const double known_to = in_unit(radius, quantity, scene.units);
  const ReadableUnit unit = readable_unit(shown, unit_name(quantity, scene.units), known_to);
  const std::string text = significant(unit.factor * shown, 4, unit.factor * known_to);
  return (si < 0 && text != "0" ? "\u2212" : "") + text + " " + unit.unit;
}

std::string Stage::reading(double si, Quantity quantity) const {
  constexpr double rounding = 1e-10;
  if (std::abs(si) < rounding * (quantity == Quantity::angle ? 1.0 : extent)) si = 0.0;
  const double radius = quantity == Quantity::angle ? picture.angle_radius : picture.length_radius;
  return significant(in_unit(si, quantity, scene.units), 5, in_unit(radius, quantity, scene.units)) + " " +
         unit_name(quantity, scene.units);
}

std::size_t Stage::least(const std::string& item, std::initializer_list<double> costs, double margin) const {
  const auto best = static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  if (before_ == nullptr) return best;
  const auto [taken, is_new] = before_->taken.try_emplace(item, best);
  if (!is_new && costs.begin()[best] < costs.begin()[taken->second] - margin) taken->second = best;
  return taken->second;
}

std::size_t Stage::first_choice(const std::string& item, std::size_t choice) const {
  return before_ == nullptr ? choice : before_->taken.try_emplace(item, choice).first->second;
}

void Stage::label(std::string text, Vec2 anchor, Vec2 toward, double gap, Colour colour, double size, bool italic) {
  Label label{.text = std::move(text), .item = canvas.current(), .anchor = anchor, .gap = gap, .toward = toward};
  label.style.colour = colour;
  label.style.size = size;
  label.style.italic = italic;
  label.layer = label_layer;
  labels.push_back(std::move(label));
}

void Stage::set_labels() {
  if (before_ != nullptr) setter.remember(before_->labels);
  canvas.open("labels");
  // From the last to the first: those of reactions and loads get the best places.
  for (auto label = labels.rbegin(); label != labels.rend(); ++label) {
    const bool has_layer = !label->layer.empty();
    if (has_layer) canvas.open(label->layer);
    setter.set(canvas, std::move(*label));
    if (has_layer) canvas.close();
  }
  canvas.close();
}

}  // namespace poise::app
