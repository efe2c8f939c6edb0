#include "identification/scene_number.hpp"

#include <cmath>

namespace poise {
namespace {

using Element = Mechanism<double>::Element;

}  // namespace

std::optional<SceneNumber> SceneNumber::find(const Scene& scene, std::string_view path) {
  std::optional<SceneNumber> found;
  const auto look = [&](const auto& list, const char* list_name, const char* field, Kind kind, std::size_t first = 0) {
    for (std::size_t i = first; i < list.size() && !found; ++i) {
      const std::string own = std::string(list_name) + "." + list[i].name + (*field != '\0' ? "." : "") + field;
      if (own == path) found = SceneNumber(kind, static_cast<int>(i), own);
    }
  };
  look(scene.bodies, "body", "mass", Kind::mass, 1);
  look(scene.bodies, "body", "inertia", Kind::inertia, 1);
  look(scene.bodies, "body", "center.x", Kind::center_x, 1);
  look(scene.bodies, "body", "center.y", Kind::center_y, 1);
  look(scene.springs, "spring", "stiffness", Kind::stiffness);
  look(scene.springs, "spring", "free_length", Kind::free_length);
  look(scene.torsion_springs, "torsion_spring", "stiffness", Kind::torsion_stiffness);
  look(scene.torsion_springs, "torsion_spring", "free_angle", Kind::free_angle);
  look(scene.dampers, "damper", "coefficient", Kind::damping);
  look(scene.torsion_dampers, "torsion_damper", "coefficient", Kind::torsion_damping);
  look(scene.frictions, "friction", "torque", Kind::friction);
  look(scene.forces, "load", "", Kind::force);
  look(scene.torques, "load", "", Kind::torque);
  return found;
}

template <class AnyScene>
auto& SceneNumber::number(Kind kind, int item, AnyScene& scene) {
  const auto i = static_cast<std::size_t>(item);
  switch (kind) {
    case Kind::mass:
      return scene.bodies[i].mass;
    case Kind::inertia:
      return scene.bodies[i].inertia;
    case Kind::center_x:
      return scene.bodies[i].center.x;
    case Kind::center_y:
      return scene.bodies[i].center.y;
    case Kind::stiffness:
      return scene.springs[i].stiffness;
    case Kind::free_length:
      return scene.springs[i].free_length;
    case Kind::torsion_stiffness:
      return scene.torsion_springs[i].stiffness;
    case Kind::free_angle:
      return scene.torsion_springs[i].free_angle;
    case Kind::damping:
      return scene.dampers[i].coefficient;
    case Kind::torsion_damping:
      return scene.torsion_dampers[i].coefficient;
    case Kind::friction:
      return scene.frictions[i].torque;
    default:
      return scene.torques[i].value;
  }
}

double SceneNumber::get(const Scene& scene) const {
  if (kind_ == Kind::force) return norm(scene.forces[static_cast<std::size_t>(item_)].vector);
  return number(kind_, item_, scene);
}

void SceneNumber::set(Scene& scene, double si) const {
  if (kind_ != Kind::force) {
    number(kind_, item_, scene) = si;
    return;
  }
  Vec2& vector = scene.forces[static_cast<std::size_t>(item_)].vector;
  const double size = norm(vector);
  if (size > 0) vector = (si / size) * vector;
}

Influence SceneNumber::influence(const Scene& scene, const Scales& scales) const {
  const double length = scales.length;
  const double force = scales.force;
  Influence out;
  const auto element = [&](Element e, double by) {
    out.element = e;
    out.index = item_;
    out.by = by;
  };
  if (is_inertial()) {
    const Body& body = scene.bodies[static_cast<std::size_t>(item_)];
    out.body = item_;
    const Vec2& c = body.center;
    switch (kind_) {
      case Kind::mass:
        out.mass = length / force;
        out.first = (1 / force) * c;
        out.moment = dot(c, c) / (length * force);
        break;
      case Kind::inertia:
        out.moment = 1 / (length * force);
        break;
      case Kind::center_x:
        out.first = {body.mass / force, 0.0};
        out.moment = 2 * body.mass * c.x / (length * force);
        break;
      default:
        out.first = {0.0, body.mass / force};
        out.moment = 2 * body.mass * c.y / (length * force);
        break;
    }
    return out;
  }
  switch (kind_) {
    case Kind::stiffness:
      element(Element::stiffness, length / force);
      break;
    case Kind::free_length:
      element(Element::free_length, 1 / length);
      break;
    case Kind::torsion_stiffness:
      element(Element::torsion_stiffness, 1 / (length * force));
      break;
    case Kind::free_angle:
      element(Element::free_angle, 1.0);
      break;
    case Kind::damping:
      element(Element::damping, length / force);
      break;
    case Kind::torsion_damping:
      element(Element::torsion_damping, 1 / (length * force));
      break;
    case Kind::friction:
      element(Element::friction, 1 / (length * force));
      break;
    case Kind::force:
      element(Element::force, 1 / force);
      break;
    default:
      element(Element::torque, 1 / (length * force));
      break;
  }
  return out;
}

bool SceneNumber::scales_with_force() const {
  switch (kind_) {
    case Kind::center_x:
    case Kind::center_y:
    case Kind::free_length:
    case Kind::free_angle:
      return false;
    default:
      return true;
  }
}

}  // namespace poise
