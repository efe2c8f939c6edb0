#include "statics/model/pose_values.hpp"

#include <algorithm>
#include <numeric>
#include <set>

#include "model/controllers.hpp"

namespace poise {

std::vector<NamedValue> angles_of(const StaticModel& model, const Readings& readings) {
  const Layout& layout = model.layout();
  const std::set<int> states = bodies_of_states(model.scene());
  std::vector<NamedValue> shown;
  for (std::size_t i = 1; i < model.scene().bodies.size(); ++i) {
    const int frame = layout.links[i].frame;
    if (states.contains(static_cast<int>(i))) continue;
    if (frame >= 0) shown.push_back({model.scene().bodies[i].name, readings.poses[i].angle, frame < layout.kept});
  }
  return shown;
}

std::vector<NamedValue> travels_of(const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  std::vector<NamedValue> shown;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (!scene.joints[j].has_travel()) continue;
    shown.push_back({scene.joints[j].name, readings.travel[j], layout.travel[j] < layout.kept});
  }
  return shown;
}

std::vector<std::size_t> free_bodies(const Layout& layout) {
  std::set<int> places;
  for (std::size_t c = 0; c < layout.coordinates.size(); ++c) {
    if (layout.coordinates[c].kind == Coordinate::Kind::length) places.insert(static_cast<int>(c));
  }
  for (const int travel : layout.travel) places.erase(travel);
  std::vector<std::size_t> bodies;
  for (std::size_t i = 0; i < layout.links.size(); ++i) {
    const Link& link = layout.links[i];
    if (link.parent == 0 && !link.arms.empty() && places.contains(link.arms.back().coordinate)) bodies.push_back(i);
  }
  return bodies;
}

std::vector<NamedValue> places_of(const StaticModel& model, const Readings& readings) {
  const Layout& layout = model.layout();
  const std::set<int> states = bodies_of_states(model.scene());
  std::vector<NamedValue> shown;
  for (const std::size_t i : free_bodies(layout)) {
    if (states.contains(static_cast<int>(i))) continue;
    const Vec2 origin = readings.poses[i].origin;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::vector<Arm>& arms = layout.links[i].arms;
      const int coordinate = arms[arms.size() - 2 + k].coordinate;
      shown.push_back({layout.coordinates[static_cast<std::size_t>(coordinate)].name, k == 0 ? origin.x : origin.y,
                       coordinate < layout.kept});
    }
  }
  return shown;
}

std::vector<int> rigid_groups(const Scene& scene) {
  std::vector<int> first(scene.bodies.size());
  std::iota(first.begin(), first.end(), 0);
  for (const Joint& joint : scene.joints) {
    if (joint.traits().constraints() < 3) continue;
    const int a = first[joint.a.body], b = first[joint.b.body];
    std::replace(first.begin(), first.end(), std::max(a, b), std::min(a, b));
  }
  return first;
}

}  // namespace poise
