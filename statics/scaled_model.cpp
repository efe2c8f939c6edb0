#include "statics/scaled_model.hpp"

#include <utility>

namespace poise {

ScaledModel::ScaledModel(Scene scene, Purpose purpose) : scene_(std::move(scene)), mechanism_(compiled(purpose)) {}

ScaledModel::ScaledModel(Scene scene, Purpose purpose, const Scales& scales)
    : scene_(std::move(scene)), scales_(scales), mechanism_(scene_, lay_out(scene_, purpose), purpose, scales_) {}

// The layout tells the scales, and serves to compile.
Mechanism<double> ScaledModel::compiled(Purpose purpose) {
  Layout layout = lay_out(scene_, purpose);
  scales_ = choose_scales(scene_, layout.size);
  return {scene_, std::move(layout), purpose, scales_};
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
  auto poses = mechanism_.poses(x.data());
  for (auto& pose : poses) pose.origin = scales_.length * pose.origin;
  return poses;
}

}  // namespace poise
