#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "model/units.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// Charts of quantities over x, one for each unit of theirs, energies apart, in the units of the scene: `value` of
/// each, SI, as many as there are x; the line is broken where one is not a number. The last one has the label of x.
std::vector<Panel> quantity_panels(const std::vector<SoughtQuantity>& of, const std::vector<std::vector<double>>& value,
                                   const Units& units, const std::vector<double>& x, const std::string& x_label);

}  // namespace poise::app
