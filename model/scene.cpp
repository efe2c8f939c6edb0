#include "model/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace poise {
namespace {

/// a / |a|, divided by the larger component first so that no square over- or underflows.
Vec2 normalised(const Vec2& a, const std::string& joint) {
  const double larger = std::max(std::abs(a.x), std::abs(a.y));
  if (!std::isfinite(a.x) || !std::isfinite(a.y) || larger == 0.0) {
    throw InputError("joint \"" + joint +
                     "\": axis: expected a finite vector that is not zero; give for example [1, 0]");
  }
  const Vec2 scaled{a.x / larger, a.y / larger};
  return {scaled.x / norm(scaled), scaled.y / norm(scaled)};
}

}  // namespace

std::string Element::family() const {
  std::string words = table;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

Scene::Scene() { add_body("ground"); }

int Scene::add_body(std::string name) {
  bodies.emplace_back().name = std::move(name);
  start.angle.emplace_back();
  start.position.emplace_back();
  return static_cast<int>(bodies.size()) - 1;
}

PointRef Scene::add_point(int body, std::string name, Vec2 at) {
  std::vector<NamedPoint>& points = bodies.at(body).points;
  points.push_back({std::move(name), at});
  return {body, static_cast<int>(points.size()) - 1};
}

int Scene::add_joint(Joint joint) {
  if (joint.name.empty()) joint.name = name_of(joint.a) + "-" + name_of(joint.b);
  if (joint.has_travel()) joint.axis = normalised(joint.axis, joint.name);
  joints.push_back(std::move(joint));
  start.travel.emplace_back();
  return static_cast<int>(joints.size()) - 1;
}

std::string Scene::name_of(PointRef p) const {
  const Body& body = bodies.at(p.body);
  return body.name + "." + body.points.at(p.point).name;
}

}  // namespace poise
