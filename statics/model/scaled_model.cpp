#include "statics/model/scaled_model.hpp"

#include <optional>
#include <utility>

namespace poise {

ScaledModel::ScaledModel(Scene scene, Purpose purpose)
    : scene_(std::move(scene)), mechanism_(compiled(purpose, std::nullopt, {})) {}

ScaledModel::ScaledModel(Scene scene, Purpose purpose, const Scales& scales, const VaryingNumbers& varying)
    : scene_(std::move(scene)), mechanism_(compiled(purpose, scales, varying)) {}

// One layout determines the scales and, measured in them, is used to compile the scaled scene. Large scenes are scaled
// in place and back, which is exact with powers of two, instead of being copied.
Mechanism<double> ScaledModel::compiled(Purpose purpose, const std::optional<Scales>& scales,
                                        const VaryingNumbers& varying) {
  Layout layout = lay_out(scene_, purpose, varying);
  scales_ = scales ? *scales : choose_scales(scene_, layout.size);
  layout.scale_lengths(scales_.per_length());
  scale(scene_, scales_);
  Mechanism<double> compiled(scene_, std::move(layout), purpose);
  scale(scene_, {scales_.per_length(), scales_.per_force()});
  return compiled;
}

std::vector<double> ScaledModel::to_si(std::vector<double> x) const {
  for (int t = layout().angles; t < layout().kept; ++t) x[t] *= scales_.length;
  return x;
}

std::vector<double> ScaledModel::from_si(std::vector<double> q) const {
  for (int t = layout().angles; t < layout().kept; ++t) q[t] /= scales_.length;
  return q;
}

std::vector<BodyPose<double>> ScaledModel::poses(const std::vector<double>& x) const {
  return in_si(mechanism_.poses(x.data()));
}

std::vector<BodyPose<double>> ScaledModel::poses_from_anchor(const std::vector<double>& x) const {
  return in_si(mechanism_.poses(x.data(), layout().anchor));
}

std::vector<BodyPose<double>> ScaledModel::in_si(std::vector<BodyPose<double>> poses) const {
  for (auto& pose : poses) pose.origin = scales_.length * pose.origin;
  return poses;
}

}  // namespace poise
