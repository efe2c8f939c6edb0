#include "statics/model/named_pose.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "model/named_item.hpp"
#include "model/nearest_name.hpp"

namespace poise {
namespace {

[[noreturn]] void fail_unknown(const Scene& scene, const char* what, const std::string& name,
                               const std::vector<std::string>& candidates) {
  throw InputError(fmt::format("{}: expected {}, found \"{}\"{}", scene.file, what, name,
                               candidates.empty() ? "; the scene has none" : did_you_mean_or_list(name, candidates)));
}

/// The item so called among those that `fits`.
template <class Item, class Fits = bool (*)(const Item&)>
const Item& find(
    const Scene& scene, const std::vector<Item>& items, const char* what, const std::string& name,
    Fits fits = [](const Item&) { return true; }) {
  const NamedItem found = find_item(items, name, fits);
  if (!found) fail_unknown(scene, what, name, found.known);
  return items[found.index];
}

}  // namespace

NamedPose::NamedPose(Scene scene, std::vector<BodyPose<double>> poses)
    : scene_(std::make_shared<Scene>(std::move(scene))),
      readings_(std::make_shared<Readings>(readings_of(*scene_, std::move(poses)))) {}

double NamedPose::angle(const std::string& body) const {
  const Body& found = find(*scene_, scene_->bodies, "the name of a body", body);
  return shown(readings_->poses[&found - scene_->bodies.data()].angle, dimension::angle);
}

Vec2 NamedPose::point(const std::string& name) const {
  std::vector<std::string> candidates;
  for (std::size_t i = 0; i < scene_->bodies.size(); ++i) {
    const Body& body = scene_->bodies[i];
    for (const NamedPoint& point : body.points) {
      candidates.push_back(body.name + "." + point.name);
      if (candidates.back() == name) return shown(readings_->poses[i].world(point.at), dimension::length);
    }
  }
  fail_unknown(*scene_, "a point \"BODY.POINT\"", name, candidates);
}

double NamedPose::travel(const std::string& joint) const {
  const Joint& found = find(*scene_, scene_->joints, "the name of a slide or pin_in_slot", joint,
                            [](const Joint& j) { return j.has_travel(); });
  return shown(readings_->travel[&found - scene_->joints.data()], dimension::length);
}

double NamedPose::measure(const std::string& element) const {
  const Element& found = find_element(element);
  return shown(reading_of(found).value, found.on.dimension());
}

NamedPose NamedPose::in(const Units& units) const {
  NamedPose other = *this;
  other.units_ = units;
  return other;
}

const Element& NamedPose::find_element(const std::string& name) const {
  std::vector<std::string> candidates;
  const Element* found = nullptr;
  for (const Element& element : scene_->elements) {
    const std::string path = element.table + "." + element.name;
    if (path == name) return element;
    candidates.push_back(element.name);
    if (element.name != name) continue;
    if (found != nullptr) {
      throw InputError(fmt::format("{}: expected one element called \"{}\", found {}.{} and {}; give one of these",
                                   scene_->file, name, found->table, found->name, path));
    }
    found = &element;
  }
  if (found == nullptr) fail_unknown(*scene_, "the name of a force element", name, candidates);
  return *found;
}

const Joint& NamedPose::find_joint(const std::string& name) const {
  return find(*scene_, scene_->joints, "the name of a joint", name);
}

const Stop& NamedPose::find_stop(const std::string& name) const {
  return find(*scene_, scene_->stops, "the name of a stop", name);
}

const ElementReading& NamedPose::reading_of(const Element& element) const {
  return readings_->elements[&element - scene_->elements.data()];
}

}  // namespace poise
