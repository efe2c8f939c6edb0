#include "statics/quantities/numbered_equations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace poise {

NumberedEquations::NumberedEquations(const Scene& scene, std::vector<ActingStop> acting)
    : NumberedEquations(std::make_shared<const NumberList>(scene), std::move(acting)) {}

NumberedEquations::NumberedEquations(std::shared_ptr<const NumberList> list, std::vector<ActingStop> acting)
    : list_(std::move(list)), acting_(std::move(acting)), turns_(scene().joints.size(), 0.0) {
  unknowns_ = poses();
  for (const Joint& joint : scene().joints) {
    joint_.push_back(unknowns_);
    unknowns_ += joint.traits().constraints();
  }
  for (const ActingStop& one : acting_) {
    stop_.push_back(unknowns_++);
    const Stop& stop = scene().stops[static_cast<std::size_t>(one.stop)];
    contact_.emplace_back();
    if (loads_bearings(stop)) contact_.back() = contact_place(scene(), stop);
  }
}

const Stop* NumberedEquations::idle_teeth(int joint, const std::vector<double>& z, double nothing) const {
  for (std::size_t h = 0; h < acting_.size(); ++h) {
    const Stop& stop = scene().stops[static_cast<std::size_t>(acting_[h].stop)];
    if (!separates(stop) || std::abs(z[static_cast<std::size_t>(stop_[h])]) > nothing) continue;
    const std::vector<int> loaded = loaded_joints(scene(), stop);
    if (std::find(loaded.begin(), loaded.end(), joint) != loaded.end()) return &stop;
  }
  return nullptr;
}

void NumberedEquations::count_turns(const double* z) {
  const auto angle = [&](int body) { return body == 0 ? 0.0 : z[3 * (body - 1) + 2]; };
  for (std::size_t j = 0; j < turns_.size(); ++j) {
    const Joint& joint = scene().joints[j];
    if (!joint.keeps_angle()) continue;
    const double over = angle(joint.b.body) - angle(joint.a.body) - joint.angle;
    constexpr double turn = 2 * std::numbers::pi;
    turns_[j] = std::round(over / turn) * turn;
  }
}

}  // namespace poise
