#pragma once

#include <vector>

#include "statics/model/static_model.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {

/// Values of quantities where a model rests at the scaled coordinates x while the stops `active` hold, SI. Not a number
/// where one is undefined (docs/quantities.md), or where joints that repeat each other leave it open. `driven`: an
/// index of Scene::stops, one of those that hold, in whose stead a push holds the pose; -1 of none.
std::vector<double> quantities_at(const StaticModel& model, const std::vector<double>& x,
                                  const std::vector<int>& active, const std::vector<SoughtQuantity>& of,
                                  int driven = -1);

}  // namespace poise
