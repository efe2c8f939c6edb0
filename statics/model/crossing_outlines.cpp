#include "statics/model/crossing_outlines.hpp"

#include <algorithm>
#include <limits>

namespace poise {
namespace {

using Poses = std::vector<BodyPose<double>>;

std::vector<Vec2> corners_of(const Scene& scene, const Poses& poses, const Outline& outline) {
  std::vector<Vec2> out;
  for (const PointRef& point : outline.points) {
    out.push_back(poses[static_cast<std::size_t>(point.body)].world(scene.local(point)));
  }
  if (outline.backed) {
    const Vec2 first = out.front(), last = out.back();
    out.push_back(0.5 * (first + last - quarter_turn(last - first)));
  }
  return out;
}

/// How far one of two convex polygons would have to move until they are apart: least over the normals of their edges.
double overlap(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<Vec2>* of : {&a, &b}) {
    for (std::size_t k = 0; k < of->size(); ++k) {
      const Vec2 edge = (*of)[(k + 1) % of->size()] - (*of)[k];
      const Vec2 normal = (1 / norm(edge)) * quarter_turn(edge);
      const auto range = [&](const std::vector<Vec2>& corners) {
        std::vector<double> at;
        for (const Vec2& corner : corners) at.push_back(dot(normal, corner));
        return std::pair(*std::min_element(at.begin(), at.end()), *std::max_element(at.begin(), at.end()));
      };
      const auto [from_a, to_a] = range(a);
      const auto [from_b, to_b] = range(b);
      least = std::min({least, to_a - from_b, to_b - from_a});
    }
  }
  return least;
}

}  // namespace

const Stop* crossing_outlines(const Scene& scene, const Poses& poses, double deep) {
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& contact = scene.stops[s];
    if (contact.table != "contact") continue;
    const int body = contact.on.outline.points.front().body;
    std::vector<Outline> own, others;
    for (std::size_t part = s; part < s + static_cast<std::size_t>(contact.parts); ++part) {
      const Outline& outline = scene.stops[part].on.outline;
      std::vector<Outline>& of_body = outline.points.front().body == body ? own : others;
      if (std::find(of_body.begin(), of_body.end(), outline) == of_body.end()) of_body.push_back(outline);
    }
    for (const Outline& a : own) {
      for (const Outline& b : others) {
        if (overlap(corners_of(scene, poses, a), corners_of(scene, poses, b)) > deep) return &contact;
      }
    }
  }
  return nullptr;
}

}  // namespace poise
