#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "model/dependent_number.hpp"
#include "model/scene.hpp"

namespace poise {
namespace {

/// Whether the number is of what a function of time is of.
bool is_of(const DependentNumber& number, const TimeFunction& function) {
  const ParameterPlace& place = number.at.place;
  if (place.owner != owner_of(function.of)) return false;
  const bool has_parts = function.of == TimeFunction::Of::element || function.of == TimeFunction::Of::frame;
  return place.item == function.item && (!has_parts || place.number == function.part);
}

/// A number that a scene file writes as such, as an expression, so that a factor may stand beside it.
DependentNumber constant(const DependentPlace& at, std::string item, double si, Dimension dimension,
                         const Units& units) {
  return {at, std::move(item), Expression(fmt::format("{}", si / dimension.unit(units)), {}), dimension};
}

/// What follows of a load, a spring or gravity, made to follow with the factor: where the factor itself follows from
/// named numbers, all that is not zero.
std::vector<DependentNumber> held(const Scene& scene, Owner owner, int item, std::vector<DependentNumber> own,
                                  const std::shared_ptr<const HeldFactor>& factor) {
  const auto at = static_cast<std::size_t>(item);
  const auto add = [&](DependentPlace::Of of, int component, const std::string& name, double si, Dimension dimension) {
    const bool is_known =
        std::any_of(own.begin(), own.end(), [&](const DependentNumber& one) { return one.at.component == component; });
    if (si == 0.0 || is_known) return;
    own.push_back(constant({of, {owner, item}, component}, name, si, dimension, scene.units));
  };
  if (!factor->numbers.empty()) {
    const int part = factor->function.part;
    if (owner == Owner::scene) {
      const double si = part == 0 ? scene.gravity.x : scene.gravity.y;
      const Dimension acceleration = dimension::length * dimension::time.power(-2);
      if (own.empty()) {
        own.push_back(
            constant({DependentPlace::Of::row, {owner, 0, 0, part}}, "gravity", si, acceleration, scene.units));
      }
    } else if (owner == Owner::element) {
      const Element& element = scene.elements[at];
      const Number& number = numbers_of(element.law)[static_cast<std::size_t>(part)];
      const ParameterPlace place{owner, item, 0, part};
      const std::string key(number.key_on(&element.on));
      if (own.empty()) {
        own.push_back(constant({DependentPlace::Of::row, place}, element.table + " \"" + element.name + "\"." + key,
                               value_at(scene, place).value(), number.dimension_on(&element.on), scene.units));
      }
    } else if (owner == Owner::force) {
      const Force& force = scene.forces[at];
      const std::string name = (force.to ? "distributed_load \"" : "force \"") + force.name;
      const Dimension& dimension = force.numbers()[0].dimension;
      if (force.has_direction_of_its_own()) {
        add(DependentPlace::Of::row, 0, name + "\".size", force.size(), dimension);
      } else {
        add(DependentPlace::Of::force, 0, name + "\".vector", force.vector.x, dimension);
        add(DependentPlace::Of::force, 1, name + "\".vector", force.vector.y, dimension);
      }
    } else {
      const Torque& torque = scene.torques[at];
      add(DependentPlace::Of::row, 0, "torque \"" + torque.name + "\".value", torque.value, dimension::torque);
    }
  }
  for (DependentNumber& one : own) one.factor = factor;
  return own;
}

}  // namespace

TimeFunction HeldFactor::at(std::span<const double> named) const {
  TimeFunction out = function;
  for (const DependentNumber& one : numbers) {
    out.set_among_others(one.at.place.number, one.expression.value(named) * one.dimension.unit(units));
  }
  out.check();
  return out;
}

double DependentNumber::value(std::span<const double> named) const {
  const double own = expression.value(named);
  if (!factor) return own;
  const TimeFunction function = factor->at(named);
  const double there = function.at(factor->time, function.order);
  return function.of == TimeFunction::Of::frame ? own - there / dimension.unit(factor->units) : own * there;
}

double HeldFactor::slope(const TimeFunction& function_there, std::span<const double> named,
                         std::span<const double> slopes) const {
  double change = 0.0;
  for (const DependentNumber& one : numbers) {
    const double by = one.expression.slope(named, slopes) * one.dimension.unit(units);
    if (by == 0.0) continue;
    const int number = one.at.place.number;
    if (!function_there.has_derivative_at(number, time)) return std::numeric_limits<double>::quiet_NaN();
    change += by * function_there.by(number, time, function_there.order, time);
  }
  return change;
}

double DependentNumber::slope(std::span<const double> named, std::span<const double> slopes) const {
  const double own = expression.slope(named, slopes);
  if (!factor) return own;
  const TimeFunction function = factor->at(named);
  const double there = factor->slope(function, named, slopes);
  if (function.of == TimeFunction::Of::frame) return own - there / dimension.unit(factor->units);
  return own * function.at(factor->time) + expression.value(named) * there;
}

double HeldFactor::bend(const TimeFunction& function_there, std::span<const double> named,
                        std::span<const double> slopes, std::span<const double> bends) const {
  std::vector<TimeFunction::Change> changes;
  for (const DependentNumber& one : numbers) {
    const double unit = one.dimension.unit(units);
    const TimeFunction::Change change{one.at.place.number, one.expression.slope(named, slopes) * unit,
                                      one.expression.bend(named, slopes, bends) * unit};
    if (change.slope != 0.0 || change.bend != 0.0) changes.push_back(change);
  }
  if (changes.empty()) return 0.0;
  return function_there.order == 0 ? function_there.bend(time, changes) : std::numeric_limits<double>::quiet_NaN();
}

double DependentNumber::bend(std::span<const double> named, std::span<const double> slopes,
                             std::span<const double> bends) const {
  const double own = expression.bend(named, slopes, bends);
  if (!factor) return own;
  const TimeFunction function = factor->at(named);
  if (function.of == TimeFunction::Of::frame) {
    return own - factor->bend(function, named, slopes, bends) / dimension.unit(factor->units);
  }
  return own * function.at(factor->time) +
         2.0 * expression.slope(named, slopes) * factor->slope(function, named, slopes) +
         expression.value(named) * factor->bend(function, named, slopes, bends);
}

std::vector<int> DependentNumber::uses() const {
  std::vector<int> out = expression.uses();
  if (!factor) return out;
  for (const DependentNumber& one : factor->numbers) {
    out.insert(out.end(), one.expression.uses().begin(), one.expression.uses().end());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::string DependentNumber::text() const {
  if (!factor) return expression.text();
  return fmt::format("({}) {} {}({} s)", expression.text(), factor->function.of == TimeFunction::Of::frame ? '-' : '*',
                     factor->function.kind(), factor->time);
}

void hold_dependents(Scene& scene, double t) {
  if (!scene.dependents || scene.time_functions.empty()) return;
  std::vector<DependentNumber> rows, components, left_out;
  std::vector<std::vector<DependentNumber>> of_functions(scene.time_functions.size()), of_loads(of_functions.size());
  const auto load_of = [&](const DependentNumber& one) {
    return std::find_if(scene.time_functions.begin(), scene.time_functions.end(),
                        [&](const TimeFunction& function) {
                          return function.of != TimeFunction::Of::drive && is_of(one, function);
                        }) -
           scene.time_functions.begin();
  };
  for (const DependentNumber& one : *scene.dependents) {
    if (one.at.place.owner == Owner::time) {
      const auto function = static_cast<std::size_t>(one.at.place.item);
      if (scene.time_functions[function].of != TimeFunction::Of::drive) {
        of_functions[function].push_back(one);
        continue;
      }
      left_out.push_back(one);
      left_out.back().at.of = DependentPlace::Of::left_out;
      continue;
    }
    const auto function = static_cast<std::size_t>(load_of(one));
    if (function < of_loads.size()) {
      of_loads[function].push_back(one);
      continue;
    }
    (one.at.of == DependentPlace::Of::row ? rows : components).push_back(one);
  }
  for (std::size_t f = 0; f < of_loads.size(); ++f) {
    const TimeFunction& function = scene.time_functions[f];
    if (function.of == TimeFunction::Of::drive) continue;
    const auto factor =
        std::make_shared<const HeldFactor>(HeldFactor{function, t, std::move(of_functions[f]), scene.units});
    for (DependentNumber& one : held(scene, owner_of(function.of), function.item, std::move(of_loads[f]), factor)) {
      if (one.at.of != DependentPlace::Of::row) {
        components.push_back(std::move(one));
        continue;
      }
      rows.push_back(std::move(one));
    }
  }
  // Rows follow each other as in the table, behind the named numbers.
  std::vector<ParameterPlace> order;
  for (const ParameterRow& row : parameter_table(scene)) order.push_back(row.place);
  const auto rank = [&](const DependentNumber& one) {
    if (one.at.place.owner == Owner::number) return std::ptrdiff_t{-1};
    return std::find(order.begin(), order.end(), one.at.place) - order.begin();
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](const DependentNumber& a, const DependentNumber& b) { return rank(a) < rank(b); });
  for (auto* part : {&components, &left_out}) std::move(part->begin(), part->end(), std::back_inserter(rows));
  scene.dependents = std::make_shared<const std::vector<DependentNumber>>(std::move(rows));
}

}  // namespace poise
