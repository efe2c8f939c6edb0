#include "motion/varied_model.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "model/dependent_number.hpp"
#include "model/inertia_impl.hpp"
#include "model/input_error.hpp"
#include "model/joint_friction.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/variation.hpp"

namespace poise {
namespace {

/// Forces whose vectors follow from named numbers: their components are the numbers, because a force of zero has no
/// direction.
std::vector<int> dependent_forces(const Scene& scene) {
  std::vector<int> out;
  if (!scene.dependents) return out;
  for (const DependentNumber& one : *scene.dependents) {
    if (one.at.of == DependentPlace::Of::force) out.push_back(one.at.place.item);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

NumbersAlong::NumbersAlong(const Scene& scene, const ParameterPlace& number, const Scales& scales)
    : list_(scene, dependent_forces(scene)) {
  for (const double value : list_.values()) values_.emplace_back(value);
  const int row = list_.row(number);
  if (const std::string why = list_.why_not_followed(row); !why.empty()) {
    throw InputError(scene.file + ": " + list_.rows()[static_cast<std::size_t>(row)].path.text() + ": " + why +
                     "; expected one that changes smoothly, or another unknown");
  }
  // Named numbers are not scaled.
  const Dimension& dimension = list_.rows()[static_cast<std::size_t>(row)].dimension;
  values_[static_cast<std::size_t>(row)].v[0] = number.owner == Owner::number ? 1.0 : dimension.per_scale(scales);
  for (const auto& [place, slope] : list_.followers(row, list_.values())) {
    values_[static_cast<std::size_t>(place)].v[0] += slope;
  }
  const Numbers<Dual> all = numbers();
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const int joint = static_cast<int>(j);
    const int element = friction_element(scene, joint);
    if (element < 0) continue;
    const int constant_part = static_cast<int>(scene.joints[j].friction_numbers().size()) - 1;
    values_[static_cast<std::size_t>(list_.element(element))] = all.friction(joint, constant_part);
  }
}

VariedModel::VariedModel(const MotionModel& model, const ParameterPlace& number)
    : along_(std::make_shared<const NumbersAlong>(model.scaled_scene(), number, model.scales())) {
  auto mechanism = std::make_shared<Mechanism<Dual>>(scene(), model.layout(), Purpose::dynamics);
  mechanism->set_numbers(numbers());
  inertia_ = std::make_shared<const Inertia<Dual>>(numbers(), *mechanism);
  mechanism_ = std::move(mechanism);
}

CompiledMeasure<VariedModel::Dual> VariedModel::measure(const Measure& on, int stop) const {
  CompiledMeasure<Dual> out(scene(), mechanism_->layout(), mechanism_->phasors(), on);
  out.set_numbers(mechanism_->phasors());
  out.set_terms(numbers(), on, stop);
  return out;
}

Variation::Variation(std::shared_ptr<const MotionModel> model, const ParameterPlace& number)
    : model_(std::move(model)), number_(number), compiled_(std::make_shared<const VariedModel>(*model_, number)) {}

}  // namespace poise
