#include "model/joint_friction.hpp"

#include <variant>

#include "model/cam_geometry.hpp"
#include "model/couplings.hpp"
#include "model/input_error.hpp"

namespace poise {

int friction_element(const Scene& scene, int joint) {
  const Joint& of = scene.joints[static_cast<std::size_t>(joint)];
  if (!of.friction) return -1;
  for (std::size_t e = scene.elements.size(); e-- > 0;) {
    if (scene.elements[e].table == of.traits().key && scene.elements[e].name == of.name) return static_cast<int>(e);
  }
  return -1;
}

namespace {

bool is_friction_of(const Element& element, const Stop& stop) {
  return element.table == stop.table && element.name == stop.name;
}

}  // namespace

int stop_friction_element(const Scene& scene, int stop) {
  const Stop& of = scene.stops[static_cast<std::size_t>(stop)];
  if (!of.friction) return -1;
  for (std::size_t e = scene.elements.size(); e-- > 0;) {
    if (is_friction_of(scene.elements[e], of)) return static_cast<int>(e);
  }
  return -1;
}

int stop_rubbed_by(const Scene& scene, int element) {
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const bool rubs = scene.stops[s].friction.has_value();
    if (rubs && is_friction_of(scene.elements[static_cast<std::size_t>(element)], scene.stops[s])) {
      return static_cast<int>(s);
    }
  }
  return -1;
}

std::optional<Measure> tangent_of(const Scene& scene, int stop) {
  const Stop& of = scene.stops[static_cast<std::size_t>(stop)];
  const std::optional<CamGeometry> cam = of.roller ? cam_geometry(scene, of) : std::nullopt;
  if (!cam) return of.tangent();
  Measure slip = Measure::distance_between(cam->on_cam, cam->roller);
  slip.kind = Measure::Kind::slip_on_cam;
  slip.stop = stop;
  slip.turns = cam->slide < 0;
  return slip;
}

double grip_factor(const Joint& joint) {
  return joint.has_travel() ? joint.friction->coefficient : joint.friction->circle();
}

bool grips(const Scene& scene, int joint) {
  return friction_element(scene, joint) >= 0 && grip_factor(scene.joints[static_cast<std::size_t>(joint)]) != 0.0;
}

Scene resisted_by_joints(Scene scene) {
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    const int index = static_cast<int>(j);
    if (!joint.friction || friction_element(scene, index) >= 0) continue;
    Element element;
    element.table = joint.traits().key;
    element.name = joint.name;
    element.on = joint.has_travel() ? Measure::travel_of(index) : Measure::angle_between(joint.a.body, joint.b.body);
    element.law = DryFriction{.force = 0.0, .width = 0.0};
    element.line = joint.line;
    scene.elements.push_back(std::move(element));
  }
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    if (!stop.friction || stop_friction_element(scene, static_cast<int>(s)) >= 0) continue;
    Element element;
    element.table = stop.table;
    element.name = stop.name;
    element.on = *tangent_of(scene, static_cast<int>(s));
    element.law = DryFriction{.force = 0.0, .width = 0.0};
    element.line = stop.line;
    scene.elements.push_back(std::move(element));
  }
  let_friction_follow(scene);
  return scene;
}

void let_friction_follow(Scene& scene) {
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const int element = friction_element(scene, static_cast<int>(j));
    if (element < 0) continue;
    const Joint& joint = scene.joints[j];
    std::get<DryFriction>(scene.elements[static_cast<std::size_t>(element)].law).force =
        joint.has_travel() ? joint.friction->force : joint.friction->torque;
  }
}

void refuse_rubbing_ropes(const Scene& scene, std::string_view what) {
  for (const Stop& rope : scene.stops) {
    if (rubbing_rims(rope.on).empty()) continue;
    throw InputError(scene.file + (rope.line > 0 ? ":" + std::to_string(rope.line) : "") + ": rope \"" + rope.name +
                     "\".friction: " + std::string(what) +
                     " does not treat a rope that rubs on its pulleys; remove the key friction there");
  }
}

std::vector<std::string> joints_with_friction(const Scene& scene) {
  std::vector<std::string> out;
  for (const Joint& joint : scene.joints) {
    if (joint.friction) out.push_back("\"" + joint.name + "\"");
  }
  return out;
}

}  // namespace poise
