#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

/// All bodies as lines whose pen is lifted only where bodies do not join; steps too short to be seen are left
/// out, so that a chain of a hundred thousand links stays a small file.
std::vector<std::vector<Vec2>> strokes_of(const Stage& stage, const Readings& readings) {
  constexpr double visible = 0.5;
  std::vector<std::vector<Vec2>> strokes;
  std::vector<Vec2> stroke;
  Vec2 pen{};
  const auto flush = [&] {
    if (stroke.size() > 1) strokes.push_back(stroke);
    stroke.clear();
  };
  for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) {
    std::vector<Vec2> shape = stage.outline(static_cast<int>(i), readings);
    if (shape.size() < 2) continue;
    if (shape.size() > 2) shape.push_back(shape.front());
    if (norm(shape.back() - pen) < norm(shape.front() - pen)) std::reverse(shape.begin(), shape.end());
    if (stroke.empty() || norm(shape.front() - pen) > visible) {
      flush();
      stroke.push_back(shape.front());
    }
    for (const Vec2& p : shape) {
      if (norm(p - stroke.back()) > visible) stroke.push_back(p);
    }
    pen = shape.back();
  }
  if (stroke.size() == 1 && norm(pen - stroke.back()) > 0) stroke.push_back(pen);
  flush();
  return strokes;
}

void sketch_bodies(Stage& stage) {
  constexpr double coarse = 12.0;  // enough to keep labels off
  for (const std::vector<Vec2>& stroke : strokes_of(stage, stage.now)) {
    stage.canvas.polyline(stroke, {.stroke = ink::dark, .width = 1.4});
    Vec2 last = stroke.front();
    for (const Vec2& p : stroke) {
      if (norm(p - last) < coarse) continue;
      stage.setter.avoid(last, p, 1.4);
      last = p;
    }
  }
}

void draw_shadow(Stage& stage, const std::vector<Vec2>& shape) {
  if (shape.size() == 1) {
    stage.canvas.circle(shape[0], 1.6 * stage.pin_radius, {.fill = ink::ghost});
  } else if (shape.size() == 2) {
    stage.canvas.line(shape[0], shape[1], {.stroke = ink::ghost, .width = 0.7 * stage.bar_width});
  } else if (shape.size() > 2) {
    stage.canvas.polygon(shape, {.fill = ink::shadow, .stroke = ink::ghost, .width = 0.5 * stage.bar_width});
  }
}

/// The axis of a beam with corners, all of whose points lie on it: such a body is no plate. Empty for others.
std::vector<Vec2> bent_axis(const Stage& stage, int index) {
  const Body& body = stage.scene.bodies[static_cast<std::size_t>(index)];
  std::vector<Vec2> out;
  if (!body.section || body.section->line.size() < 3 || body.section->line.size() != body.points.size()) return out;
  const BodyPose<double>& pose = stage.now.poses[static_cast<std::size_t>(index)];
  for (const int point : body.section->line) {
    out.push_back(stage.page(pose.world(body.points[static_cast<std::size_t>(point)].at)));
  }
  return out;
}

void draw_body(Stage& stage, int body) {
  const std::vector<Vec2> shape = stage.outline(body, stage.now);
  const std::vector<Vec2> axis = bent_axis(stage, body);
  const Colour colour = body_colour(body - 1);
  stage.canvas.item(stage.scene.bodies[body].name, "at " + stage.reading(stage.now.poses[body].angle, Quantity::angle));
  if (stage.cylinder_of_body(body) != nullptr) {
    // Barrel and rod are drawn together.
  } else if (!axis.empty()) {
    for (std::size_t i = 1; i < axis.size(); ++i) {
      draw_bar(stage.canvas, axis[i - 1], axis[i], stage.bar_width, colour);
      stage.setter.avoid(axis[i - 1], axis[i], stage.bar_width);
    }
  } else if (shape.size() == 2) {
    draw_bar(stage.canvas, shape[0], shape[1], stage.bar_width, colour);
    stage.setter.avoid(shape[0], shape[1], stage.bar_width);
  } else if (shape.size() > 2) {
    stage.canvas.polygon(shape, {.fill = colour, .opacity = 0.3});
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const Vec2 next = shape[(i + 1) % shape.size()];
      draw_bar(stage.canvas, shape[i], next, 0.7 * stage.bar_width, colour);
      stage.setter.avoid(shape[i], next, 0.7 * stage.bar_width);
    }
  }
  if (shape.empty() || stage.detail != Detail::full) return;
  // Names stand beside a bar's middle, and inside a plate.
  Vec2 middle{};
  for (const Vec2& p : shape) middle += (1.0 / static_cast<double>(shape.size())) * p;
  Vec2 toward{0, -1};
  if (shape.size() == 2) {
    toward = quarter_turn((1 / norm(shape[1] - shape[0])) * (shape[1] - shape[0]));
    if (toward.y > 0) toward = -toward;
  }
  const double gap = shape.size() == 2 ? 0.5 * stage.bar_width + 4 : shape.size() > 2 ? 0 : 14;
  stage.label(stage.scene.bodies[body].name, middle, toward, gap, ink::faint, 10.5, true);
}

/// A thin line to a centre of mass that lies beside its body's shape, so that its body is seen.
void tie_to_body(Stage& stage, int body, Vec2 at) {
  const std::vector<Vec2> shape = stage.outline(body, stage.now);
  if (shape.empty()) return;
  std::vector<Vec2> with_centre = shape;
  with_centre.push_back(at);
  const bool within = shape.size() > 2 && convex_hull(with_centre).size() == convex_hull(shape).size();
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < shape.size(); ++i) {
    distance = std::min(distance, distance_to_line(at, shape[i], shape[(i + 1) % shape.size()]));
  }
  if (within || distance < stage.bar_width) return;
  const Vec2 nearest =
      *std::min_element(shape.begin(), shape.end(), [&](Vec2 a, Vec2 b) { return norm(a - at) < norm(b - at); });
  stage.canvas.line(nearest, at, {.stroke = ink::free_stop, .width = 1.2, .dash = "4 3"});
}

}  // namespace

void draw_other_poses(Stage& stage) {
  constexpr double visible = 2.0;
  stage.canvas.open("other-positions");
  for (std::size_t k = 0; k < stage.others.size(); ++k) {
    const Readings& other = stage.others[k];
    double moved = visible;
    Vec2 farthest{};
    for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) {
      for (const NamedPoint& p : stage.scene.bodies[i].points) {
        const Vec2 there = other.poses[i].world(p.at);
        const double distance = stage.scale * norm(stage.now.poses[i].world(p.at) - there);
        if (distance <= moved) continue;
        moved = distance;
        farthest = stage.page(there);
      }
    }
    if (moved == visible) continue;
    stage.canvas.item(stage.picture.others[k].name);
    stage.signs.insert(Sign::other_pose);
    stage.shadows.push_back(stage.picture.others[k].name);
    if (stage.others.size() > 1) stage.label(stage.shadows.back(), farthest, {0, -1}, 6, ink::faint, 10.5, true);
    if (stage.detail == Detail::sketch) {
      for (const auto& stroke : strokes_of(stage, other)) {
        stage.canvas.polyline(stroke, {.stroke = ink::ghost, .width = 1.2});
      }
      continue;
    }
    for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) {
      draw_shadow(stage, stage.outline(static_cast<int>(i), other));
    }
    for (const Joint& joint : stage.scene.joints) {
      if (!joint.keeps_length()) continue;
      draw_shadow(stage,
                  {stage.page(world(stage.scene, other, joint.a)), stage.page(world(stage.scene, other, joint.b))});
    }
  }
  stage.canvas.close();
}

void draw_paths(Stage& stage) {
  constexpr double visible = 0.7;
  if (stage.picture.paths.empty()) return;
  stage.canvas.open("paths");
  for (std::size_t k = 0; k < stage.picture.paths.size(); ++k) {
    const PointPath& path = stage.picture.paths[k];
    std::vector<Vec2> points;
    for (const Vec2& p : path.points) {
      if (points.empty() || norm(stage.page(p) - points.back()) > visible) points.push_back(stage.page(p));
    }
    if (points.empty()) continue;
    stage.canvas.item((stage.picture.paths_are_links ? "bent " : "path of ") + path.name);
    const Colour colour = curve_colour(k);
    stage.canvas.polyline(points, {.stroke = colour, .width = 1.8});
    stage.canvas.circle(points.front(), 2.6, {.fill = colour});
    for (std::size_t i = 1; i < points.size(); ++i) stage.setter.avoid(points[i - 1], points[i], 2.0);
    // Beside the middle of the path, away from its ends.
    const Vec2 middle = points[points.size() / 2];
    const Vec2 bulge = middle - 0.5 * (points.front() + points.back());
    const Vec2 away = norm(bulge) > 1.0 ? (1 / norm(bulge)) * bulge : Vec2{0, -1};
    stage.label(path.name, middle, away, 6, ink::dark);
    stage.signs.insert(stage.picture.paths_are_links ? Sign::bent_link : Sign::path);
  }
  stage.canvas.close();
}

void draw_bodies(Stage& stage) {
  stage.canvas.open("bodies");
  if (stage.detail == Detail::sketch) {
    sketch_bodies(stage);
  } else {
    for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) draw_body(stage, static_cast<int>(i));
  }
  for (const Cylinder& c : stage.cylinders) {
    const double width = 2.0 * stage.bar_width;
    stage.canvas.item(stage.scene.bodies[c.barrel].name + " and " + stage.scene.bodies[c.rod].name,
                      stage.reading(stage.now.travel[c.joint], Quantity::length));
    draw_cylinder(stage.canvas, c.foot, c.mouth, c.piston, c.eye, width, body_colour(c.barrel - 1),
                  body_colour(c.rod - 1));
    stage.setter.avoid(c.foot, c.eye, width);
  }
  for (const Joint& joint : stage.scene.joints) {
    if (!joint.keeps_length()) continue;
    const Vec2 a = stage.page(joint.a);
    const Vec2 b = stage.page(joint.b);
    stage.canvas.item(Stage::item_of(joint));
    draw_massless_bar(stage.canvas, a, b, stage.detail == Detail::sketch ? 1.0 : 0.6 * stage.bar_width);
    if (stage.detail != Detail::sketch) stage.setter.avoid(a, b, 0.6 * stage.bar_width);
    stage.signs.insert(Sign::massless_bar);
  }
  stage.canvas.close();
}

void draw_centres_of_mass(Stage& stage) {
  constexpr double thinnest = 4.0;  // the sign does not fit on thinner bars
  if (stage.scene.gravity == Vec2{} || stage.detail == Detail::sketch || stage.bar_width < thinnest) return;
  stage.canvas.open("centres-of-mass");
  for (std::size_t i = 1; i < stage.scene.bodies.size(); ++i) {
    const Body& body = stage.scene.bodies[i];
    if (body.mass <= 0) continue;
    const double radius = std::clamp(0.55 * stage.bar_width, 2.0, 4.5);
    const Vec2 at = stage.page(stage.now.poses[i].world(body.center));
    stage.canvas.item("centre of mass of " + body.name,
                      significant(in_unit(body.mass, Quantity::mass, stage.scene.units), 5) + " " +
                          unit_name(Quantity::mass, stage.scene.units));
    tie_to_body(stage, static_cast<int>(i), at);
    draw_centre_of_mass(stage.canvas, at, radius);
    stage.setter.avoid(at, radius);
    stage.signs.insert(Sign::centre_of_mass);
  }
  stage.canvas.close();
}

}  // namespace poise::app
