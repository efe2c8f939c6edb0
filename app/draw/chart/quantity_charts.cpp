#include "app/draw/chart/quantity_charts.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace poise::app {
namespace {

/// Energies and torques have one unit, and other sizes.
bool is_energy(const SoughtQuantity& of) {
  return of.kind == SoughtQuantity::Kind::energy || of.kind == SoughtQuantity::Kind::kinetic_energy;
}

}  // namespace

std::vector<Panel> quantity_panels(const std::vector<SoughtQuantity>& of, const std::vector<std::vector<double>>& value,
                                   const Units& units, const std::vector<double>& x, const std::string& x_label) {
  std::vector<Panel> out;
  std::vector<std::pair<Dimension, bool>> axes;
  for (std::size_t k = 0; k < of.size(); ++k) {
    const std::pair axis{of[k].dimension, is_energy(of[k])};
    const auto same = std::find(axes.begin(), axes.end(), axis);
    const auto place = static_cast<std::size_t>(same - axes.begin());
    if (same == axes.end()) {
      axes.push_back(axis);
      const std::string unit = of[k].dimension.unit_name(units);
      out.push_back({.title = of[k].name, .y_label = unit.empty() ? "1" : unit});
    } else {
      out[place].title += ", " + of[k].name;
    }
    std::vector<double> y = value[k];
    for (double& one : y) one /= of[k].dimension.unit(units);
    out[place].curves.push_back({.name = of[k].name, .x = x, .y = std::move(y)});
  }
  if (!out.empty()) out.back().x_label = x_label;
  return out;
}

}  // namespace poise::app
