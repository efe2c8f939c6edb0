#include "statics/numbered_equations.hpp"

#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace poise {

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
      case Owner::drive:
      case Owner::start:
        break;
    }
  }
  const auto put = [&](int at, double value) { numbers_[at] = value; };
  const auto put_all = [&](int at, const auto& item, std::span<const Number> numbers) {
    for (const Number& number : numbers) put(at++, number.get(&item).value_or(0.0));
  };
  put_all(gravity_, scene_, Scene::numbers);
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Body& body = scene_.bodies[i];
    for (std::size_t p = 0; p < body.points.size(); ++p) put_all(point_[i][p], body.points[p], NamedPoint::numbers);
    if (i > 0) put_all(body_[i], body, Body::numbers);
  }
  for (std::size_t f = 0; f < scene_.forces.size(); ++f) {
    const Vec2& vector = scene_.forces[f].vector;
    put_all(force_[f], scene_.forces[f], Force::numbers);
    direction_.push_back(norm(vector) > 0.0 ? direction<double>(vector) : Vec2{});
  }
  for (std::size_t t = 0; t < scene_.torques.size(); ++t) put_all(torque_[t], scene_.torques[t], Torque::numbers);
  for (std::size_t e = 0; e < scene_.elements.size(); ++e) {
    std::visit([&](const auto& law) { put_all(element_[e], law, numbers_of_law(law)); }, scene_.elements[e].law);
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
    if (strut_.back() < 0) put_all(stop_number_[s], scene_.stops[s], scene_.stops[s].numbers());
  }
  for (std::size_t h = 0; h < held_.size(); ++h) stop_.push_back(unknowns_++);
  turns_.assign(scene_.joints.size(), 0.0);
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
