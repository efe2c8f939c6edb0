#include "statics/model/static_model.hpp"

#include <utility>

#include "statics/model/ball_mechanism.hpp"

namespace poise {

StaticModel::StaticModel(Scene scene)
    : ScaledModel(at_time(std::move(scene), 0.0), Purpose::statics), problem_(mechanism()) {}

StaticModel::StaticModel(Scene scene, const Scales& scales, const VaryingNumbers& varying)
    : ScaledModel(at_time(std::move(scene), 0.0), Purpose::statics, scales, varying), problem_(mechanism()) {}

StaticModel::~StaticModel() = default;

const BallMechanism& StaticModel::balls() const {
  std::call_once(balls_made_, [this] { balls_ = std::make_unique<const BallMechanism>(*this); });
  return *balls_;
}

}  // namespace poise
