#include "tests/support/vector_mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

namespace poise::test {

Vec2 world(const Scene& scene, PointRef p, const Poses& poses) { return poses[p.body].world(scene.local(p)); }

double potential_energy(const Scene& scene, const Poses& poses) {
  double v = 0.0;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    v -= body.mass * dot(scene.gravity, poses[i].world(body.center));
  }
  for (const Force& force : scene.forces) {
    if (force.follows < 0) v -= dot(force.vector, world(scene, force.at, poses));
  }
  for (const Torque& torque : scene.torques) v -= torque.value * poses[torque.body].angle;
  for (const Element& element : scene.elements) {
    const double g = measured(scene, element.on, poses);
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    if (spring == nullptr) {
      v += energy(element.law, g);
      continue;
    }
    const double stretch = g - spring->free_length;
    if (spring->acts == LinearSpring::Acts::tension && stretch < 0) continue;
    if (spring->acts == LinearSpring::Acts::compression && stretch > 0) continue;
    v += spring->stiffness / 2 * stretch * stretch;
  }
  return v;
}

Vec2 gap(const Scene& scene, int joint, double travel, const Poses& poses) {
  const Joint& j = scene.joints[joint];
  const Vec2 apart = world(scene, j.b, poses) - world(scene, j.a, poses);
  if (j.has_travel()) return apart - travel * (j.direction() * unit(poses[j.a.body].angle));
  if (j.kind != Joint::Kind::bar) return apart;
  const auto bars_before = std::count_if(scene.joints.begin(), scene.joints.begin() + joint,
                                         [](const Joint& other) { return other.kind == Joint::Kind::bar; });
  const BodyPose<double>& bar = poses[scene.bodies.size() + static_cast<std::size_t>(bars_before)];
  return apart - j.length * unit(bar.angle);
}

namespace {

/// Straight parts by Pythagoras, wraps as differences of their directions: those of the lines of centres, turned by the
/// angle whose sine is the difference of the radii over the distance.
double rope_length(const Scene& scene, const Measure& rope, const Poses& poses) {
  double length = 0.0, before = 0.0;
  for (std::size_t k = 0; k + 1 < rope.contacts.size(); ++k) {
    const RopeContact& a = rope.contacts[k];
    const RopeContact& b = rope.contacts[k + 1];
    const Vec2 d = world(scene, b.at, poses) - world(scene, a.at, poses);
    const double apart = std::hypot(d.x, d.y), offset = b.turn * b.radius - a.turn * a.radius;
    const double direction = std::atan2(d.y, d.x) - std::asin(offset / apart);
    length += std::sqrt(apart * apart - offset * offset);
    if (k > 0) {
      double wrap = std::fmod(a.turn * (direction - before), 2 * M_PI);
      if (wrap < -0.5 * M_PI) wrap += 2 * M_PI;
      if (wrap > 1.5 * M_PI) wrap -= 2 * M_PI;
      length += a.radius * wrap;
    }
    before = direction;
  }
  return length;
}

/// The points of a polygon in the world, with the one behind it.
std::vector<Vec2> corners(const Scene& scene, const Measure& measure, const Poses& poses) {
  std::vector<Vec2> out;
  for (const PointRef& point : measure.outline.points) out.push_back(world(scene, point, poses));
  if (measure.outline.backed) {
    const Vec2 chord = out.back() - out.front();
    out.push_back(0.5 * (out.front() + out.back()) + 0.5 * Vec2{chord.y, -chord.x});
  }
  return out;
}

/// Where on the outline a point is nearest to: for polygons by trying all of their edges, for arcs their nearest angle.
Vec2 nearest(const Scene& scene, const Measure& measure, const Poses& poses, Vec2 p) {
  Vec2 best{};
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](Vec2 at) {
    if (norm(p - at) >= least) return;
    least = norm(p - at);
    best = at;
  };
  if (measure.outline.form == Outline::Form::polygon) {
    const std::vector<Vec2> of = corners(scene, measure, poses);
    for (std::size_t k = 0; k < of.size(); ++k) {
      const Vec2 edge = of[(k + 1) % of.size()] - of[k];
      offer(of[k] + std::clamp(dot(p - of[k], edge) / dot(edge, edge), 0.0, 1.0) * edge);
    }
    return best;
  }
  const Vec2 centre = world(scene, measure.outline.points[0], poses);
  const Vec2 begin = world(scene, measure.outline.points[1], poses) - centre;
  const Vec2 end = world(scene, measure.outline.points[2], poses) - centre;
  const double way = measure.outline.form == Outline::Form::hollow_arc ? 1.0 : -1.0;
  const auto turned = [&](Vec2 to) {
    const double angle = way * std::atan2(cross(begin, to), dot(begin, to));
    return angle < 0.0 ? angle + 2 * M_PI : angle;
  };
  const double sweep = measure.outline.points[1] == measure.outline.points[2] ? 2 * M_PI : turned(end);
  for (const double angle : {0.0, sweep}) offer(centre + begin * unit(way * angle));
  if (turned(p - centre) < sweep) offer(centre + (norm(begin) / norm(p - centre)) * (p - centre));
  return best;
}

/// The distance from what is nearest, negative inside: of a polygon right of all edges, of an arc behind it in its
/// angle.
double clearance(const Scene& scene, const Measure& measure, const Poses& poses) {
  const Vec2 p = world(scene, measure.b, poses);
  const Vec2 at = nearest(scene, measure, poses, p);
  bool is_inside = true;
  if (measure.outline.form == Outline::Form::polygon) {
    const std::vector<Vec2> of = corners(scene, measure, poses);
    for (std::size_t k = 0; k < of.size(); ++k) {
      is_inside = is_inside && cross(of[(k + 1) % of.size()] - of[k], p - of[k]) <= 0.0;
    }
  } else {
    const Vec2 centre = world(scene, measure.outline.points[0], poses);
    const double behind = norm(p - centre) - norm(at - centre);
    const bool is_hollow = measure.outline.form == Outline::Form::hollow_arc;
    // In the angle of the arc the nearest place is on the same ray.
    is_inside = std::abs(cross(p - centre, at - centre)) < 1e-9 * dot(at - centre, at - centre) &&
                dot(p - centre, at - centre) > 0.0 && (is_hollow ? behind > 0.0 : behind < 0.0);
  }
  return is_inside ? -norm(p - at) : norm(p - at);
}

/// The way of the nearest point along the outline, and `radius` times the angle by which the normal has turned.
double along_outline(const Scene& scene, const Measure& measure, const Poses& poses) {
  const double rounding = 1e-9;
  const Vec2 p = world(scene, measure.b, poses);
  const Vec2 at = nearest(scene, measure, poses, p);
  const Vec2 normal = (clearance(scene, measure, poses) < 0.0 ? -1.0 : 1.0) * (p - at);
  const auto clockwise = [&](Vec2 from, Vec2 to) {
    const double angle = -std::atan2(cross(from, to), dot(from, to));
    return angle < -rounding ? angle + 2 * M_PI : angle;
  };
  if (measure.outline.form == Outline::Form::polygon) {
    const std::vector<Vec2> of = corners(scene, measure, poses);
    const double turned = clockwise(quarter_turn(of[1] - of[0]), normal);
    double way = 0.0;
    for (std::size_t k = 0; k < of.size(); ++k) {
      const Vec2 edge = of[(k + 1) % of.size()] - of[k];
      const double share = dot(at - of[k], edge) / dot(edge, edge);
      const bool is_on = norm(at - of[k] - share * edge) < rounding && share > -rounding && share < 1 + rounding;
      if (is_on && (k > 0 || share > rounding)) return way + share * norm(edge) + measure.radius * turned;
      // The first corner belongs to the edge above which the place is higher, the first or the last one.
      const Vec2 last = of[0] - of.back();
      if (is_on && cross(edge, p - of[0]) / norm(edge) > cross(last, p - of[0]) / norm(last)) {
        return measure.radius * (turned - 2 * M_PI);
      }
      way += norm(edge);
    }
    return way + measure.radius * turned;
  }
  const Vec2 centre = world(scene, measure.outline.points[0], poses);
  const Vec2 begin = world(scene, measure.outline.points[1], poses) - centre;
  const bool is_hollow = measure.outline.form == Outline::Form::hollow_arc;
  const double angle = is_hollow ? clockwise(at - centre, begin) : clockwise(begin, at - centre);
  const Vec2 outward = (is_hollow ? -1.0 : 1.0) * (at - centre);
  const double further = -std::atan2(cross(outward, normal), dot(outward, normal));
  const double arm = norm(begin) + (is_hollow ? -1.0 : 1.0) * measure.radius;
  return arm * angle + measure.radius * further;
}

}  // namespace

double measured(const Scene& scene, const Measure& measure, const Poses& poses) {
  switch (measure.kind) {
    case Measure::Kind::angle:
      return poses[measure.body_b].angle - poses[measure.body_a].angle;
    case Measure::Kind::distance:
      return norm(world(scene, measure.b, poses) - world(scene, measure.a, poses));
    case Measure::Kind::travel: {
      const Joint& joint = scene.joints[measure.joint];
      return dot(joint.direction() * unit(poses[joint.a.body].angle),
                 world(scene, joint.b, poses) - world(scene, joint.a, poses));
    }
    case Measure::Kind::x:
      return world(scene, measure.b, poses).x;
    case Measure::Kind::y:
      return world(scene, measure.b, poses).y;
    case Measure::Kind::component: {
      const Vec2 axis = (1 / norm(measure.axis)) * measure.axis * unit(poses[measure.a.body].angle);
      return dot(axis, world(scene, measure.b, poses) - world(scene, measure.a, poses));
    }
    case Measure::Kind::rope:
      return rope_length(scene, measure, poses);
    case Measure::Kind::clearance:
      return clearance(scene, measure, poses);
    case Measure::Kind::along_outline:
      return along_outline(scene, measure, poses);
    case Measure::Kind::slip_on_cam:
      throw std::invalid_argument("friction on a cam does not depend on how far it has slipped");
    case Measure::Kind::sum:
      break;
  }
  double sum = 0.0;
  for (const Measure::Term& term : measure.terms) {
    const double g = measured(scene, term.measure, poses);
    const double span = term.measure.is_angle() ? 2 * M_PI : term.span;
    sum += term.factor * (term.profile ? term.profile->at((g - term.shift) / span).value : g);
  }
  return sum;
}

}  // namespace poise::test
