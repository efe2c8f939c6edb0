#include "statics/static_model.hpp"

#include <utility>

namespace poise {

StaticModel::StaticModel(Scene scene) : ScaledModel(std::move(scene), Purpose::statics), problem_(mechanism()) {}

StaticModel::StaticModel(Scene scene, const Scales& scales)
    : ScaledModel(std::move(scene), Purpose::statics, scales), problem_(mechanism()) {}

}  // namespace poise
