#include "exchange/private/drawn_scene.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <unordered_set>

#include <fmt/format.h>

#include "exchange/private/reading.hpp"
#include "model/one_line.hpp"
#include "model/scene_builder.hpp"

namespace poise {
namespace {

Vec2 short_pair(Vec2 v) { return {short_number(v.x), short_number(v.y)}; }

}  // namespace

double short_number(double value) {
  const std::string text = fmt::format("{:.12g}", value);
  double out = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out == 0.0 ? 0.0 : out;  // of -0 the sign means nothing
}

Vec2 axis_at(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  // Rounding of the twelfth digit is none of a direction: 0 and 1 are.
  const auto rounded = [](double part) { return std::round(part * 1e12) / 1e12 + 0.0; };
  return {rounded(std::cos(angle)), rounded(std::sin(angle))};
}

std::string length_unit(const ImportOptions& options, const std::string& otherwise, std::vector<std::string>& notes) {
  if (options.length) return *options.length;
  notes.push_back(fmt::format("Lengths are taken for {}: the file names no unit.", otherwise));
  return otherwise;
}

DrawnScene::DrawnScene(std::string file, UnitNames units) : file_(std::move(file)), units_(std::move(units)) {
  units_.angle = "deg";
  link("ground");
}

DrawnScene::Link& DrawnScene::link(const std::string& name) {
  const auto [place, is_new] = places_.emplace(name, links_.size());
  if (is_new) {
    if (links_.size() > most_links) fail_at(file_, 0, "links", fmt::format("expected at most {} links", most_links));
    links_.push_back({name, {}, {}});
  }
  return links_[place->second];
}

void DrawnScene::add_link(const std::string& name) { link(name); }

void DrawnScene::add_point(const std::string& name, const std::string& point, Vec2 at) {
  link(name).points.emplace_back(point, short_pair(at));
}

void DrawnScene::set_mass(const std::string& name, const Mass& mass) { link(name).mass = mass; }

void DrawnScene::add_joint(const DrawnJoint& joint) { joints_.push_back(joint); }

void DrawnScene::limit_travel(double least, double most) { limits_.push_back({joints_.size() - 1, least, most}); }

void DrawnScene::add_force(const std::string& name, const std::string& link, const std::string& point, Vec2 vector,
                           bool fixed) {
  forces_.push_back({name, link, point, vector, fixed});
}

void DrawnScene::add_drive(const std::string& link, double rate) { drives_.emplace_back(link, rate); }

const Vec2& DrawnScene::place_of(const std::pair<std::string, std::string>& point) const {
  const auto& points = links_[places_.at(point.first)].points;
  return std::find_if(points.begin(), points.end(), [&](const auto& one) { return one.first == point.second; })->second;
}

Imported DrawnScene::finish() const {
  if (links_.size() < 2) fail_at(file_, 0, "links", "expected a link besides the ground, found none");
  SceneBuilder builder(one_line(std::filesystem::path(file_).stem().string()), units_);
  builder.source("imported from " + one_line(std::filesystem::path(file_).filename().string()));
  if (gravity_) builder.gravity(short_pair(*gravity_));
  for (const auto& [point, at] : links_.front().points) builder.ground_point(point, at);
  for (auto link = links_.begin() + 1; link != links_.end(); ++link) {
    builder.body(link->name, {.points = link->points,
                              .mass = short_number(link->mass.mass),
                              .center = short_pair(link->mass.center),
                              .inertia = short_number(link->mass.inertia)});
  }
  std::vector<std::pair<std::string, double>> travels;
  std::vector<std::string> names(joints_.size());
  std::unordered_set<std::string> taken;
  for (const Link& link : links_) taken.insert(link.name);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const DrawnJoint& joint = joints_[j];
    const std::string a = joint.a.first + "." + joint.a.second, b = joint.b.first + "." + joint.b.second;
    const Vec2 axis = short_pair(joint.axis);
    switch (joint.kind) {
      case Joint::Kind::slide:
        builder.slide(a, b, axis, names[j] = name_beside("slide " + joint.b.second, taken));
        break;
      case Joint::Kind::pin_in_slot:
        builder.pin_in_slot(a, b, axis, names[j] = name_beside("slot " + joint.b.second, taken));
        break;
      case Joint::Kind::weld:
        builder.weld(a, b);
        break;
      default:
        builder.pin(a, b);
        break;
    }
    if (names[j].empty()) continue;
    const double travel = short_number(dot(place_of(joint.b) - place_of(joint.a), direction<double>(axis)));
    if (travel != 0.0) travels.emplace_back(names[j], travel);
  }
  for (const DrawnForce& force : forces_) {
    builder.force(force.name, force.link + "." + force.point, short_pair(force.vector), force.fixed ? force.link : "");
  }
  for (const auto& [driven, rate] : drives_) {
    builder.drive(driven, measures::angle("ground", driven), {{"rate", short_number(rate)}});
  }
  for (const Limits& one : limits_) {
    builder.stop("ends of " + names[one.joint], measures::travel(names[one.joint]),
                 {{"min", short_number(one.least)}, {"max", short_number(one.most)}});
  }
  for (const auto& [name, travel] : travels) builder.start(name, travel);
  std::vector<std::string> notes = notes_;
  notes.emplace_back("Each link has the frame of the drawing: its angle is 0 where it was drawn.");
  return {builder.text(), std::move(notes)};
}

}  // namespace poise
