#pragma once

// What the numbers of an experiment are shown in: the units of its scene.

#include <string>
#include <vector>

#include "app/quantity.hpp"
#include "identification/run_model.hpp"

namespace poise::app {

/// "kg", "N/m", "kg m²": the unit of Unknown::unit.
std::string unit_name(const Unknown& unknown, const Scene& scene);

Quantity quantity_of(const Sensor& sensor);
/// "rad", "mm/s".
std::string unit_name(const Sensor& sensor, const Units& units);
/// SI value -> number in that unit.
double in_unit(double si, const Sensor& sensor, const Units& units);

/// Quantity of every nuisance of a run, rates counted as what they are rates of.
std::vector<Quantity> nuisance_quantities(const RunModel& run);

}  // namespace poise::app
