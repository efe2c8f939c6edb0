#include "exchange/private/drawn_scene.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "exchange/private/reading.hpp"
#include "model/one_line.hpp"
#include "model/scene_builder.hpp"

namespace poise {

DrawnScene::DrawnScene(std::string file, std::string length) : file_(std::move(file)), length_(std::move(length)) {
  units_of({.length = length_});  // throws where there is no such unit
  link("ground");
}

DrawnScene::DrawnScene(std::string file, const ImportOptions& options, const std::string& length)
    : DrawnScene(std::move(file), options.length.value_or(length)) {
  if (!options.length) add_note(fmt::format("The file names no unit of length: they are taken for {}.", length_));
}

DrawnScene::Link& DrawnScene::link(const std::string& name) {
  const auto [place, is_new] = places_.emplace(name, links_.size());
  if (is_new) {
    if (links_.size() > most_items) fail_at(file_, 0, "links", fmt::format("expected at most {} links", most_items));
    links_.push_back({name, {}, {}});
  }
  return links_[place->second];
}

void DrawnScene::add_point(const std::string& name, const std::string& point, Vec2 at) {
  link(name).points.emplace_back(point, at);
}

void DrawnScene::set_mass(const std::string& name, const Mass& mass) { link(name).mass = mass; }

void DrawnScene::add_joint(Joint::Kind kind, const std::string& a, const std::string& b, const std::string& point,
                           Vec2 axis) {
  joints_.push_back({kind, a + "." + point, b + "." + point, axis});
}

Imported DrawnScene::finish() const {
  if (links_.size() < 2) fail_at(file_, 0, "links", "expected a link besides the ground, found none");
  SceneBuilder builder(one_line(std::filesystem::path(file_).stem().string()), {.length = length_, .angle = "deg"});
  builder.source("imported from " + one_line(std::filesystem::path(file_).filename().string()));
  for (const auto& [point, at] : links_.front().points) builder.ground_point(point, at);
  for (auto link = links_.begin() + 1; link != links_.end(); ++link) {
    builder.body(
        link->name,
        {.points = link->points, .mass = link->mass.mass, .center = link->mass.center, .inertia = link->mass.inertia});
  }
  for (const DrawnJoint& joint : joints_) {
    switch (joint.kind) {
      case Joint::Kind::slide:
        builder.slide(joint.a, joint.b, joint.axis);
        break;
      case Joint::Kind::pin_in_slot:
        builder.pin_in_slot(joint.a, joint.b, joint.axis);
        break;
      case Joint::Kind::weld:
        builder.weld(joint.a, joint.b);
        break;
      default:
        builder.pin(joint.a, joint.b);
        break;
    }
  }
  return {builder.text(), notes_};
}

}  // namespace poise
