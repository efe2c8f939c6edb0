#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"
#include "model/curved_slots.hpp"

namespace poise::app {
namespace {

/// The side of a point on which the ground is drawn: the first, unless a member runs that way.
std::size_t free_side(const std::vector<Vec2>& members, std::span<const Vec2> sides) {
  constexpr double clear = 0.6;  // cosine of the angle to the nearest member
  std::size_t best = 0;
  double best_nearest = 2.0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    double nearest = -1.0;
    for (const Vec2& member : members) nearest = std::max(nearest, dot(sides[i], member));
    if (nearest < clear) return i;
    if (nearest < best_nearest) {
      best_nearest = nearest;
      best = i;
    }
  }
  return best;
}

constexpr std::array<Vec2, 4> upright_sides = {{{0, 1}, {0, -1}, {-1, 0}, {1, 0}}};

/// Of the upright directions the one farthest from the members at a point.
std::size_t far_side(const std::vector<Vec2>& members) {
  Vec2 pull{};
  for (const Vec2& member : members) pull += member;
  const auto far = std::min_element(upright_sides.begin(), upright_sides.end(),
                                    [&](Vec2 a, Vec2 b) { return dot(a, pull) < dot(b, pull); });
  return static_cast<std::size_t>(far - upright_sides.begin());
}

std::string name_on_ground(const Stage& stage, PointRef point) {
  return "ground " + stage.scene.bodies[0].points[point.point].name;
}

/// Part of the line that a joint's second point can be expected to run on: from its place to those in the other
/// positions, its stops, and, on a moving body, the point that the line goes through.
struct Track {
  Vec2 at;         ///< of the joint's second point
  Vec2 low, high;  ///< ends of the drawn line
  Vec2 along;
};

Track track_of(const Stage& stage, std::size_t j) {
  const Joint& joint = stage.scene.joints[j];
  const double s = stage.now.travel[j];
  double low = s;
  double high = s;
  const auto include = [&](double t) {
    low = std::min(low, t);
    high = std::max(high, t);
  };
  for (const Readings& other : stage.others) include(other.travel[j]);
  if (joint.a.body != 0) include(0.0);
  for (const Stop& stop : stage.scene.stops) {
    if (stop.on.kind != Measure::Kind::travel || stop.on.joint != static_cast<int>(j)) continue;
    if (std::isfinite(stop.min)) include(stop.min);
    if (std::isfinite(stop.max)) include(stop.max);
  }
  const Vec2 along = stage.page_axis(joint);
  const Vec2 origin = stage.page(joint.a);
  const double margin = stage.detail == Detail::sketch ? 6.0 : 34.0;
  return {origin + stage.scale * s * along, origin + (stage.scale * low - margin) * along,
          origin + (stage.scale * high + margin) * along, along};
}

void draw_guide(Stage& stage, std::size_t j) {
  const Joint& joint = stage.scene.joints[j];
  const Track track = track_of(stage, j);
  stage.canvas.item("line of " + Stage::item_of(joint));
  const double half_height = joint.kind == Joint::Kind::slide ? 9.0 : 0.75 * stage.bar_width + 1.5;
  if (stage.detail == Detail::sketch) {
    stage.canvas.line(track.low, track.high, {.stroke = ink::ground, .width = 0.8});
    return;
  }
  if (joint.a.body == 0) {
    Vec2 side = quarter_turn(track.along);
    if (side.y < 0 || (std::abs(side.y) < 1e-9 && side.x < 0)) side = -side;
    const std::array<Vec2, 2> sides = {side, -side};
    const Vec2 down = sides[stage.first_choice("line of " + joint.name, free_side(stage.members_at(track.at), sides))];
    draw_ground(stage.canvas, track.low + half_height * down, track.high + half_height * down, down);
    stage.setter.avoid(track.low + half_height * down, track.high + half_height * down, 8.0);
  }
  if (joint.kind == Joint::Kind::pin_in_slot) {
    const Colour fill = joint.a.body == 0 ? ink::support : body_colour(joint.a.body - 1);
    draw_slot(stage.canvas, track.low, track.high, 2 * half_height, {.fill = fill, .stroke = ink::dark, .width = 1.1});
    stage.setter.avoid(track.low, track.high, 2 * half_height);
  } else if (joint.a.body == 0) {
    stage.canvas.line(track.low, track.high, {.stroke = ink::ground, .width = 0.8, .dash = "8 3 2 3"});
  } else {
    // A rod of the guiding body that runs through the block.
    draw_bar(stage.canvas, track.low, track.high, 0.6 * stage.bar_width, body_colour(joint.a.body - 1));
    stage.setter.avoid(track.low, track.high, 0.6 * stage.bar_width);
  }
}

void draw_slide_block(Stage& stage, std::size_t j) {
  const Joint& joint = stage.scene.joints[j];
  const Track track = track_of(stage, j);
  const bool sketchy = stage.detail == Detail::sketch;
  stage.canvas.item(Stage::item_of(joint), stage.reading(stage.now.travel[j], Quantity::length));
  const Colour fill = joint.b.body == 0 ? ink::support : body_colour(joint.b.body - 1);
  draw_block(stage.canvas, track.at, track.along, sketchy ? 6 : 32, sketchy ? 4 : 18,
             {.fill = fill, .stroke = ink::dark, .width = sketchy ? 0.6 : 1.3});
  if (!sketchy) stage.setter.avoid(track.at - 16.0 * track.along, track.at + 16.0 * track.along, 18.0);
}

/// Friction of a pin: a ring round it; of what slides: short strokes on both sides of its line.
void draw_friction(Stage& stage, std::size_t j) {
  const Joint& joint = stage.scene.joints[j];
  const Paint paint{.stroke = ink::dark, .width = 0.9};
  if (!joint.has_travel()) {
    stage.canvas.circle(stage.page(joint.b), stage.pin_radius + 2.5, paint);
    return;
  }
  const Track track = track_of(stage, j);
  const Vec2 side = quarter_turn(track.along);
  for (const double sign : {1.0, -1.0}) {
    for (const double at : {-9.0, -3.0, 3.0, 9.0}) {
      const Vec2 foot = track.at + at * track.along + (sign * 9.0) * side;
      stage.canvas.line(foot, foot + 3.0 * track.along + (sign * 3.5) * side, paint);
    }
  }
}

void draw_weld(Stage& stage, Vec2 at) {
  const double side = 2 * stage.pin_radius;
  draw_block(stage.canvas, at, {1, 0}, side, side, {.fill = ink::dark});
}

/// Names of points and joints, each place once. A name that many places share is left out.
class PlaceNames {
 public:
  void add(Vec2 place, const std::string& name) {
    const bool known =
        std::any_of(names_.begin(), names_.end(), [&](const auto& other) { return norm(other.first - place) < 2.0; });
    if (known || name.empty()) return;
    names_.emplace_back(place, name);
    ++uses_[name];
  }
  template <class Visit>
  void visit(Visit visit) const {
    for (const auto& [place, name] : names_) {
      if (uses_.at(name) < 3) visit(place, name);
    }
  }

 private:
  std::vector<std::pair<Vec2, std::string>> names_;
  std::map<std::string, int> uses_;
};

/// Away from the members that meet at a point.
Vec2 outward(const std::vector<Vec2>& members) {
  Vec2 sum{};
  for (const Vec2& m : members) sum += m;
  const double length = norm(sum);
  return length > 0.1 ? (-1 / length) * sum : Vec2{0.7, -0.7};
}

void name_places(Stage& stage) {
  PlaceNames names;
  for (const Joint& joint : stage.scene.joints) {
    if (joint.keeps_length() || is_of_track(stage.scene, joint)) continue;
    names.add(stage.page(joint.b), stage.short_name(joint));
  }
  for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) {
    const std::vector<Vec2>& points = stage.points_of(static_cast<int>(i));
    for (std::size_t p = 0; p < points.size(); ++p) names.add(points[p], stage.scene.bodies[i].points[p].name);
  }
  for (const Strung& strung : stage.strung()) {
    for (const PointRef& end : {strung.a, strung.b}) {
      if (end.body == 0) names.add(stage.page(end), stage.scene.bodies[0].points[end.point].name);
    }
  }
  names.visit([&](Vec2 place, const std::string& name) {
    stage.canvas.item("point " + name);
    stage.label(name, place, outward(stage.members_at(place)), stage.pin_radius + 4, ink::dark, 11.5);
  });
}

}  // namespace

void draw_guides(Stage& stage) {
  stage.canvas.open("guides");
  for (std::size_t j = 0; j < stage.scene.joints.size(); ++j) {
    if (!stage.scene.joints[j].has_travel() || is_of_track(stage.scene, stage.scene.joints[j])) continue;
    if (stage.cylinder_of_joint(j) == nullptr) draw_guide(stage, j);
  }
  stage.canvas.close();
}

void draw_supports(Stage& stage) {
  stage.canvas.open("ground");
  std::set<int> supported;
  for (const Joint& joint : stage.scene.joints) {
    if (joint.has_travel() || is_of_track(stage.scene, joint)) continue;
    for (const PointRef& end : {joint.a, joint.b}) {
      if (end.body != 0 || !supported.insert(end.point).second) continue;
      const Vec2 at = stage.page(end);
      stage.canvas.item(name_on_ground(stage, end));
      if (!stage.shows_ground) {
        stage.canvas.circle(at, 2.0, {.fill = ink::dark});
        continue;
      }
      const Vec2 down =
          upright_sides[stage.first_choice(name_on_ground(stage, end), free_side(stage.members_at(at), upright_sides))];
      if (joint.kind == Joint::Kind::weld) {
        const Vec2 along = quarter_turn(down);
        draw_ground(stage.canvas, at - 17.0 * along, at + 17.0 * along, down);
      } else {
        draw_support(stage.canvas, at, down);
      }
      stage.setter.avoid(at, at + 24.0 * down, 26.0);
    }
  }
  for (const Strung& strung : stage.strung()) {
    for (const PointRef& end : {strung.a, strung.b}) {
      if (end.body != 0 || !stage.shows_ground || !supported.insert(end.point).second) continue;
      const Vec2 at = stage.page(end);
      const std::string name = name_on_ground(stage, end);
      const Vec2 down = upright_sides[stage.first_choice(name, far_side(stage.members_at(at)))];
      stage.canvas.item(name);
      const Vec2 along = quarter_turn(down);
      draw_ground(stage.canvas, at - 11.0 * along, at + 11.0 * along, down);
      stage.setter.avoid(at - 11.0 * along, at + 11.0 * along, 12.0);
    }
  }
  stage.canvas.close();
}

void draw_pins(Stage& stage) {
  stage.canvas.open("joints");
  for (std::size_t j = 0; j < stage.scene.joints.size(); ++j) {
    const bool block = stage.scene.joints[j].kind == Joint::Kind::slide && stage.cylinder_of_joint(j) == nullptr;
    if (block && !is_of_track(stage.scene, stage.scene.joints[j])) draw_slide_block(stage, j);
  }
  if (stage.detail != Detail::sketch) {
    // Points that are no joint are dots; joints come on top.
    for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) {
      const Body& body = stage.scene.bodies[i];
      const std::vector<Vec2>& points = stage.points_of(static_cast<int>(i));
      for (std::size_t p = 0; p < points.size(); ++p) {
        stage.canvas.item(body.name + "." + body.points[p].name);
        stage.canvas.circle(points[p], 0.5 * stage.pin_radius, {.fill = ink::dark});
      }
    }
    for (const Joint& joint : stage.scene.joints) {
      if (joint.kind != Joint::Kind::weld) continue;
      stage.canvas.item(Stage::item_of(joint));
      draw_weld(stage, stage.page(joint.b));
    }
    for (const Joint& joint : stage.scene.joints) {
      if (joint.kind == Joint::Kind::weld || joint.kind == Joint::Kind::slide || is_of_track(stage.scene, joint))
        continue;
      stage.canvas.item(Stage::item_of(joint));
      if (joint.keeps_length()) draw_pin(stage.canvas, stage.page(joint.a), stage.pin_radius);
      draw_pin(stage.canvas, stage.page(joint.b), stage.pin_radius);
      stage.setter.avoid(stage.page(joint.b), stage.pin_radius);
    }
  }
  for (std::size_t j = 0; j < stage.scene.joints.size() && stage.detail != Detail::sketch; ++j) {
    if (!stage.scene.joints[j].friction) continue;
    stage.canvas.item(Stage::item_of(stage.scene.joints[j]));
    draw_friction(stage, j);
  }
  if (stage.detail == Detail::full) name_places(stage);
  stage.canvas.close();
}

}  // namespace poise::app
