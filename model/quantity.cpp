#include "model/quantity.hpp"

#include "model/dimension.hpp"

namespace poise {

Quantity quantity_of(const Measure& on) { return on.is_angle() ? Quantity::angle : Quantity::length; }

Quantity effort_of(const Measure& on) { return on.is_angle() ? Quantity::moment : Quantity::force; }

double unit_value(Quantity quantity, const Units& units) {
  switch (quantity) {
    case Quantity::length:
      return units.length;
    case Quantity::angle:
      return units.angle;
    case Quantity::force:
      return units.force;
    case Quantity::mass:
      return units.mass;
    case Quantity::moment:
    case Quantity::energy:
      return dimension::torque.unit(units);
  }
  return 1.0;
}

std::string unit_name(Quantity quantity, const Units& units) {
  switch (quantity) {
    case Quantity::length:
      return units.length_name;
    case Quantity::angle:
      return units.angle_name;
    case Quantity::force:
      return units.force_name;
    case Quantity::mass:
      return units.mass_name;
    case Quantity::energy:
      if (units.force_name == "N" && units.length_name == "m") return "J";
      [[fallthrough]];
    case Quantity::moment:
      return units.force_name + " " + units.length_name;
  }
  return "";
}

std::vector<double> in_unit(std::vector<double> si, Quantity quantity, const Units& units) {
  for (double& value : si) value = in_unit(value, quantity, units);
  return si;
}

}  // namespace poise
