#include "statics/numbered_equations.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "model/curved_slots.hpp"
#include "statics/static_numbers.hpp"

namespace poise {
namespace {

// Of CrossSection::numbers.
constexpr int second_moment = 1, modulus = 2;

}  // namespace

NumberedEquations::NumberedEquations(const Scene& scene, std::vector<HeldStop> held)
    : scene_(scene), held_(std::move(held)), rows_(parameter_table(scene_)) {
  for (const Body& body : scene_.bodies) point_.emplace_back(body.points.size());
  body_.resize(scene_.bodies.size());
  element_.resize(scene_.elements.size());
  force_.resize(scene_.forces.size());
  torque_.resize(scene_.torques.size());
  joint_number_.resize(scene_.joints.size());
  stop_number_.resize(scene_.stops.size());
  numbers_.resize(rows_.size());
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const ParameterPlace& place = rows_[k].place;
    if (place.number != 0) continue;
    const int at = static_cast<int>(k);
    switch (place.owner) {
      case Owner::scene:
        gravity_ = at;
        break;
      case Owner::force:
        force_[place.item] = at;
        break;
      case Owner::torque:
        torque_[place.item] = at;
        break;
      case Owner::body:
        body_[place.item] = at;
        break;
      case Owner::point:
        point_[place.item][place.part] = at;
        break;
      case Owner::element:
        element_[place.item] = at;
        break;
      case Owner::joint:
        joint_number_[place.item] = at;
        break;
      case Owner::stop:
      case Owner::coupling:
        stop_number_[place.item] = at;
        break;
      case Owner::section:
        if (place.part == 1) section_.push_back(at);
        break;
      case Owner::number:
      case Owner::drive:
      case Owner::time:
      case Owner::start:
        break;
    }
  }
  const auto put = [&](int at, double value) { numbers_[at] = value; };
  // Numbers of bodies that come with curved slots and rolling wheels stand behind those of the table.
  const std::vector<int> of_tracks = bodies_of_tracks(scene_);
  const auto is_of_track = [&](int body) {
    return std::find(of_tracks.begin(), of_tracks.end(), body) != of_tracks.end();
  };
  const auto add = [&](std::span<const Number> numbers) {
    const int first = static_cast<int>(numbers_.size());
    numbers_.resize(numbers_.size() + numbers.size());
    return first;
  };
  for (const int body : of_tracks) {
    for (int& point : point_[body]) point = add(NamedPoint::numbers);
    body_[body] = add(Body::numbers);
  }
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    if (is_of_track(scene_.joints[j].b.body)) joint_number_[j] = add(scene_.joints[j].numbers());
  }
  const auto put_all = [&](int at, const auto& item, std::span<const Number> numbers) {
    for (const Number& number : numbers) put(at++, number.get(&item).value_or(0.0));
  };
  for (std::size_t i = 0; i < scene_.named_values.size(); ++i) put(static_cast<int>(i), scene_.named_values[i].value);
  put_all(gravity_, scene_, Scene::numbers);
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Body& body = scene_.bodies[i];
    for (std::size_t p = 0; p < body.points.size(); ++p) put_all(point_[i][p], body.points[p], NamedPoint::numbers);
    if (i > 0) put_all(body_[i], body, Body::numbers);
  }
  for (std::size_t f = 0; f < scene_.forces.size(); ++f) {
    const Vec2& vector = scene_.forces[f].vector;
    put_all(force_[f], scene_.forces[f], scene_.forces[f].numbers());
    direction_.push_back(norm(vector) > 0.0 ? direction<double>(vector) : Vec2{});
  }
  for (std::size_t t = 0; t < scene_.torques.size(); ++t) put_all(torque_[t], scene_.torques[t], Torque::numbers);
  for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
    std::visit([&](const auto& law) { put_all(element_[e], law, numbers_of_law(law)); }, scene_.elements[e].law);
  }
  for (std::size_t l = 0; l < section_.size(); ++l) {
    put_all(section_[l], scene_.flexible_links[l].section, CrossSection::numbers);
  }
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    if (rows_[k].place.owner == Owner::number || moves_springs(rows_[k].place)) leaders_.push_back(static_cast<int>(k));
  }
  unknowns_ = poses();
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    const Joint& joint = scene_.joints[j];
    put_all(joint_number_[j], joint, joint.numbers());
    joint_.push_back(unknowns_);
    unknowns_ += joint.traits().constraints();
  }
  for (std::size_t s = 0; s < scene_.stops.size(); ++s) {
    strut_.push_back(strut_of(scene_, scene_.stops[s]));
    coupling_.push_back(coupling_kind(scene_.stops[s]));
    curve_of_.push_back(curve_numbers_of(scene_.stops[s]));
    contact_.emplace_back();
    if (loads_bearings(scene_.stops[s])) contact_.back() = contact_place(scene_, scene_.stops[s]);
    if (coupling_.back() != nullptr && coupling_.back()->row > 0) {
      stop_number_[s] = stop_number_[s - static_cast<std::size_t>(coupling_.back()->row)];
      continue;
    }
    if (strut_.back() < 0) put_all(stop_number_[s], scene_.stops[s], scene_.stops[s].numbers());
  }
  for (std::size_t h = 0; h < held_.size(); ++h) stop_.push_back(unknowns_++);
  turns_.assign(scene_.joints.size(), 0.0);
  place_dependents();
}

void NumberedEquations::place_dependents() {
  if (!scene_.dependents) return;
  followed_ = dependent_values(scene_, named_values(scene_), false);
  std::size_t row = 0;
  for (std::size_t k = 0; k < followed_.size(); ++k) {
    const DependentPlace& at = (*scene_.dependents)[k].at;
    const auto item = static_cast<std::size_t>(at.place.item);
    int place = -1;
    if (at.of == DependentPlace::Of::row && at.place.owner != Owner::number) {
      while (!(rows_[row].place == at.place)) ++row;
      place = static_cast<int>(row);
    } else if (at.of == DependentPlace::Of::force || at.of == DependentPlace::Of::axis) {
      const bool is_force = at.of == DependentPlace::Of::force;
      std::vector<Components>& all = is_force ? vector_ : axis_;
      all.resize(is_force ? scene_.forces.size() : scene_.joints.size());
      const Vec2& vector = is_force ? scene_.forces[item].vector : scene_.joints[item].axis;
      place = static_cast<int>(numbers_.size());
      (at.component == 0 ? all[item].x : all[item].y) = place;
      numbers_.push_back(at.component == 0 ? vector.x : vector.y);
    }
    dependent_.push_back(place);
  }
}

const Stop* NumberedEquations::idle_teeth(int joint, const std::vector<double>& z, double nothing) const {
  for (std::size_t h = 0; h < held_.size(); ++h) {
    const Stop& stop = scene_.stops[held_[h].stop];
    if (!separates(stop) || std::abs(z[stop_[h]]) > nothing) continue;
    const std::vector<int> loaded = loaded_joints(scene_, stop);
    if (std::find(loaded.begin(), loaded.end(), joint) != loaded.end()) return &stop;
  }
  return nullptr;
}

namespace {

/// The named numbers come first in p, and have no unit.
std::vector<double> named_in(const Scene& scene, const std::vector<double>& numbers) {
  return {numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(scene.named_values.size())};
}

}  // namespace

void NumberedEquations::follow(std::vector<double>& numbers) const {
  follow_names(numbers);
  for (std::size_t l = 0; l < section_.size(); ++l) {
    const double* const now = &numbers[section_[l]];
    const double* const before = &numbers_[section_[l]];
    const double ratio = now[second_moment] * now[modulus] / (before[second_moment] * before[modulus]);
    for (const int spring : scene_.flexible_links[l].springs) numbers[element_[spring]] *= ratio;
  }
}

void NumberedEquations::follow_names(std::vector<double>& numbers) const {
  if (dependent_.empty()) return;
  const std::vector<double> values = dependent_values(scene_, named_in(scene_, numbers), false);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (dependent_[k] >= 0) numbers[dependent_[k]] += values[k] - followed_[k];
  }
  for (std::size_t f = 0; f < vector_.size(); ++f) {
    if (!vector_[f].varies()) continue;
    const Vec2& before = scene_.forces[f].vector;
    const Vec2 after{vector_[f].x >= 0 ? numbers[vector_[f].x] : before.x,
                     vector_[f].y >= 0 ? numbers[vector_[f].y] : before.y};
    numbers[force_[f]] += norm(after) - norm(before);
  }
}

void NumberedEquations::add_springs_of(int row, double slope, const std::vector<double>& numbers,
                                       std::vector<std::pair<int, double>>& out) const {
  const ParameterPlace& place = rows_[row].place;
  const int section = section_[place.item];
  const int other = section + (place.number == modulus ? second_moment : modulus);
  const double by = slope * numbers[other] / (numbers_[section + second_moment] * numbers_[section + modulus]);
  for (const int spring : scene_.flexible_links[place.item].springs) {
    out.emplace_back(element_[spring], by * numbers_[element_[spring]]);
  }
}

std::vector<std::pair<int, double>> NumberedEquations::followers(int row, const std::vector<double>& numbers) const {
  std::vector<std::pair<int, double>> out;
  if (moves_springs(rows_[row].place)) add_springs_of(row, 1.0, numbers, out);
  if (dependent_.empty() || rows_[row].place.owner != Owner::number) return out;
  const std::vector<double> slopes = dependents_by(scene_, rows_[row].place.item, named_in(scene_, numbers));
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    if (dependent_[k] < 0 || slopes[k] == 0.0 || !std::isfinite(slopes[k])) continue;
    out.emplace_back(dependent_[k], slopes[k]);
    if (dependent_[k] < static_cast<int>(rows_.size()) && moves_springs(rows_[dependent_[k]].place)) {
      add_springs_of(dependent_[k], slopes[k], numbers, out);
    }
    const DependentPlace& at = (*scene_.dependents)[k].at;
    if (at.of != DependentPlace::Of::force) continue;
    // The magnitude follows from the components.
    const Planar<double> direction = along(scene_.forces[at.place.item].vector, vector_[at.place.item], numbers.data());
    out.emplace_back(force_[at.place.item], slopes[k] * (at.component == 0 ? direction.x : direction.y));
  }
  return out;
}

std::string NumberedEquations::why_not_followed(int row) const {
  if (dependent_.empty() || rows_[row].place.owner != Owner::number) return "";
  const std::vector<double> slopes = dependents_by(scene_, rows_[row].place.item, named_values(scene_));
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    const DependentNumber& one = (*scene_.dependents)[k];
    if (one.at.of == DependentPlace::Of::left_out) continue;
    const std::string written = one.item + " = \"" + one.text() + "\"";
    if (!std::isfinite(slopes[k])) return written + " has no derivative by it";
    if (slopes[k] != 0.0 && one.at.of == DependentPlace::Of::factor) {
      return written + " is a factor of a sum, by which there are no derivatives";
    }
    if (slopes[k] != 0.0 && one.at.of == DependentPlace::Of::force &&
        scene_.forces[one.at.place.item].vector == Vec2{}) {
      return written + " is a force of zero, which has no direction";
    }
  }
  return "";
}

void NumberedEquations::count_turns(const double* z) {
  const auto angle = [&](int body) { return body == 0 ? 0.0 : z[3 * (body - 1) + 2]; };
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    const Joint& joint = scene_.joints[j];
    if (!joint.keeps_angle()) continue;
    const double over = angle(joint.b.body) - angle(joint.a.body) - joint.angle;
    constexpr double turn = 2 * std::numbers::pi;
    turns_[j] = std::round(over / turn) * turn;
  }
}

}  // namespace poise
