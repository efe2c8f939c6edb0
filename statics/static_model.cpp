#include "statics/static_model.hpp"

#include <utility>

namespace poise {

StaticModel::StaticModel(Scene scene) : ScaledModel(std::move(scene), Purpose::statics), problem_(mechanism()) {}

}  // namespace poise
