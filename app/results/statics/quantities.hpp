#pragma once

#include <vector>

#include "app/result/result.hpp"
#include "model/units.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// A table of the quantities asked for: names, values (SI; "-" where one is undefined) and units of the scene. None
/// where none was.
void add_quantities(Group& group, const std::vector<SoughtQuantity>& of, const std::vector<double>& values,
                    const Units& units);

}  // namespace poise::app
