#pragma once

#include <vector>

#include "app/result/result.hpp"
#include "model/units.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise::app {

/// A table of the quantities asked for in one position: names, values ("-" where one is undefined, with the reason) and
/// units of the scene. None where none was.
void add_quantities(Group& group, const std::vector<SoughtQuantity>& of, const std::vector<QuantityValue>& values,
                    const Units& units);

/// Columns of them, one value for each row of a table: data under their names. Without `key` text only.
void add_quantity_columns(Table& table, const std::vector<SoughtQuantity>& of,
                          const std::vector<std::vector<QuantityValue>>& rows, const Units& units, bool key = true,
                          bool shown = true);

/// Stresses by statics/equilibrium/link_loads.hpp, modes by motion/modes.hpp.
QuantityValue other_quantity(const SoughtQuantity& of, const StaticModel& model, const std::vector<double>& x,
                             const std::vector<int>& active);

}  // namespace poise::app
