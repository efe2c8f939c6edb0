#include "statics/static_model.hpp"

namespace poise {

StaticModel::StaticModel(Scene scene)
    : scene_(std::move(scene)),
      scales_(choose_scales(scene_, lay_out(scene_, Purpose::statics).size)),
      scaled_(scaled(scene_, scales_)),
      mechanism_(scaled_, Purpose::statics),
      problem_(mechanism_) {}

std::vector<double> StaticModel::to_si(std::vector<double> x) const {
  for (int t = layout().angles; t < layout().kept; ++t) x[t] *= scales_.length;
  return x;
}

std::vector<double> StaticModel::from_si(std::vector<double> q) const {
  for (int t = layout().angles; t < layout().kept; ++t) q[t] /= scales_.length;
  return q;
}

std::vector<BodyPose<double>> StaticModel::poses(const std::vector<double>& x) const {
  auto poses = mechanism_.poses(x.data());
  for (auto& pose : poses) pose.origin = scales_.length * pose.origin;
  return poses;
}

}  // namespace poise
