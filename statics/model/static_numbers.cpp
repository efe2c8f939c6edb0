#include "statics/model/static_numbers.hpp"

#include <string_view>

#include "model/dependent_number.hpp"

namespace poise {
namespace {

/// A named number, through expressions that use it.
bool acts_by_followers(const Scene& scene, int named) {
  if (!scene.dependents) return false;
  std::vector<char> follows(scene.named_values.size(), 0);
  follows[static_cast<std::size_t>(named)] = 1;
  for (const DependentNumber& one : *scene.dependents) {
    bool uses = false;
    for (const int used : one.uses()) uses = uses || follows[static_cast<std::size_t>(used)] != 0;
    if (!uses) continue;
    if (one.at.place.owner == Owner::number) {
      follows[static_cast<std::size_t>(one.at.place.item)] = 1;
    } else if (acts_in_statics(scene, one.at.place)) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool acts_in_statics(const Scene& scene, const ParameterPlace& place) {
  if (moves_springs(place)) return true;
  if (!counts_in_statics(place.owner)) return false;
  switch (place.owner) {
    case Owner::number:
      return acts_by_followers(scene, place.item);
    case Owner::body:
      return place.number != 1;
    case Owner::element:
      return stores_energy(scene.elements[static_cast<std::size_t>(place.item)].law);
    case Owner::joint: {
      const Joint& joint = scene.joints[static_cast<std::size_t>(place.item)];
      return place.number < static_cast<int>(joint.numbers().size() - joint.friction_numbers().size());
    }
    case Owner::stop:
    case Owner::coupling: {
      const Stop& stop = scene.stops[static_cast<std::size_t>(place.item)];
      const std::string_view key = stop.numbers()[static_cast<std::size_t>(place.number)].key;
      if (key == "restitution" || key == "friction") return false;
      return place.number == 0 || stop.table != "rope";  // behind its length is friction on pulleys
    }
    default:
      return true;
  }
}

}  // namespace poise
