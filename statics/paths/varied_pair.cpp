#include "statics/paths/varied_pair.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "model/dependent_number.hpp"
#include "model/input_error.hpp"
#include "model/parameters.hpp"

namespace poise {
namespace {

/// A named number of a scene in which some load follows from such.
bool moves_load(const Scene& scene, const ParameterRow& row) {
  if (row.place.owner != Owner::number || !scene.dependents) return false;
  return std::any_of(scene.dependents->begin(), scene.dependents->end(), [](const DependentNumber& one) {
    return one.at.place.owner == Owner::force || one.at.place.owner == Owner::torque;
  });
}

VariedScene second_number(const Scene& scene, const VariedNumber& first, const VariedNumber& second) {
  const auto fail = [](const std::string& what) { throw InputError(what); };
  if (first.name == second.name) {
    fail(fmt::format("{}: named twice; expected two different numbers", first.name));
  }
  VariedScene out(scene, second.name, second.from, second.to);
  if (out.is_driven())
    fail(fmt::format("{}: a driven measure can be the first number only; name it first", second.name));
  const auto is_load = [&](const std::string& name) {
    const auto row = find_parameter(scene, name);
    return row && (row->place.owner == Owner::force || row->place.owner == Owner::torque || moves_load(scene, *row));
  };
  for (const auto& [a, b] : {std::pair(first.name, second.name), std::pair(second.name, first.name)}) {
    if (a == "loads" && is_load(b))
      fail(fmt::format("{}: \"loads\" multiplies it; expected a number apart from it", b));
  }
  return out;
}

}  // namespace

VariedPair::VariedPair(const Scene& scene, const VariedNumber& first, const VariedNumber& second)
    : second_(second_number(scene, first, second)),
      first_(second_.scene_at(second_.generic()), first.name, first.from, first.to) {
  first_.vary_with(second_);
  second_.vary_with(first_);
}

}  // namespace poise
