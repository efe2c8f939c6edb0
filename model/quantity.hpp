#pragma once

// What results are measured in, in the units of the scene.

#include <string>
#include <vector>

#include "model/measure.hpp"
#include "model/units.hpp"

namespace poise {

/// What a result can be measured in; the units follow from those of the scene.
enum class Quantity { length, angle, force, mass, moment, energy };

/// Of a measure: an angle or a length.
Quantity quantity_of(const Measure& on);
/// Of what does work on it: a moment or a force.
Quantity effort_of(const Measure& on);

/// SI value of the unit that the scene uses for a quantity.
double unit_value(Quantity quantity, const Units& units);

/// "mm", "N", "N mm", ...; work in N m is called J.
std::string unit_name(Quantity quantity, const Units& units);

/// SI value -> number in the scene's unit.
inline double in_unit(double si, Quantity quantity, const Units& units) { return si / unit_value(quantity, units); }
/// The same for a row of values.
std::vector<double> in_unit(std::vector<double> si, Quantity quantity, const Units& units);

}  // namespace poise
