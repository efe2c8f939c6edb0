#include "app/shown_values.hpp"

#include <cmath>

namespace poise::app {

double rounding_of(const ScaledModel& model, Quantity quantity) {
  constexpr double part = 1e-13;
  switch (quantity) {
    case Quantity::length:
      return part * model.scales().length;
    case Quantity::force:
      return part * model.scales().force;
    case Quantity::moment:
    case Quantity::energy:
      return part * model.scales().energy();
    default:
      return part;
  }
}

std::vector<double> in_units(const ScaledModel& model, Quantity quantity, std::vector<double> values) {
  for (double& value : values) {
    value = std::abs(value) < rounding_of(model, quantity) ? 0.0 : in_unit(value, quantity, model.scene().units);
  }
  return values;
}

}  // namespace poise::app
