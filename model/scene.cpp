#include "model/scene.hpp"

#include <cmath>
#include <utility>

#include "model/one_line.hpp"

namespace poise {
namespace {

void check_axis(const Joint& joint) {
  if (std::isfinite(joint.axis.x) && std::isfinite(joint.axis.y) && joint.axis != Vec2{}) return;
  throw InputError("joint \"" + joint.name +
                   "\": axis: expected a finite vector that is not zero; give for example [1, 0]");
}

}  // namespace

std::string Element::family() const { return words_of_key(table); }

Scene::Scene() { add_body("ground"); }

Scene::Scene(const Scene&) = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(const Scene&) = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

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
  if (joint.has_travel()) check_axis(joint);
  joints.push_back(std::move(joint));
  start.travel.emplace_back();
  return static_cast<int>(joints.size()) - 1;
}

std::string Scene::name_of(PointRef p) const {
  const Body& body = bodies.at(p.body);
  return body.name + "." + body.points.at(p.point).name;
}

}  // namespace poise
