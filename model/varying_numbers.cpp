#include "model/varying_numbers.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "model/dependent_number.hpp"
#include "model/joint_friction.hpp"

namespace poise {
namespace {

auto order_of(const ParameterPlace& place) { return std::tuple(place.owner, place.item, place.part, place.number); }

bool is_before(const ParameterPlace& a, const ParameterPlace& b) { return order_of(a) < order_of(b); }

template <class T, class Less>
void sort_once(std::vector<T>& list, Less less) {
  std::sort(list.begin(), list.end(), less);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

VaryingNumbers::VaryingNumbers(const Scene& scene, std::span<const ParameterPlace> rows)
    : places_(rows.begin(), rows.end()) {
  add_followers(scene);
  const std::size_t own = places_.size();
  for (std::size_t k = 0; k < own; ++k) {
    const ParameterPlace place = places_[k];
    if (place.owner == Owner::joint) {
      if (const int friction = friction_element(scene, place.item); friction >= 0) {
        places_.push_back({Owner::element, friction});
      }
    }
    if (!moves_springs(place)) continue;
    for (const int spring : scene.flexible_links[static_cast<std::size_t>(place.item)].springs) {
      places_.push_back({Owner::element, spring});
    }
  }
  sort_once(places_, is_before);
  sort_once(axes_, std::less<>());
}

// Each dependent number with a name comes behind those that it uses.
void VaryingNumbers::add_followers(const Scene& scene) {
  if (!scene.dependents) return;
  std::vector<char> named(scene.named_values.size(), 0);
  for (const ParameterPlace& place : places_) {
    if (place.owner == Owner::number) named[static_cast<std::size_t>(place.item)] = 1;
  }
  for (const DependentNumber& one : *scene.dependents) {
    const std::vector<int> uses = one.uses();
    const bool follows =
        std::any_of(uses.begin(), uses.end(), [&](int used) { return named[static_cast<std::size_t>(used)] != 0; });
    if (!follows || one.at.of == DependentPlace::Of::left_out) continue;
    if (one.at.of == DependentPlace::Of::axis) {
      axes_.push_back(one.at.place.item);
      continue;
    }
    if (one.at.place.owner == Owner::number) named[static_cast<std::size_t>(one.at.place.item)] = 1;
    places_.push_back(one.at.place);
  }
}

bool VaryingNumbers::has(const ParameterPlace& place) const {
  return std::binary_search(places_.begin(), places_.end(), place, is_before);
}

bool VaryingNumbers::has_any(Owner owner, int item, int part) const {
  const ParameterPlace first{owner, item, part, 0};
  const auto at = std::lower_bound(places_.begin(), places_.end(), first, is_before);
  return at != places_.end() && at->owner == owner && at->item == item && at->part == part;
}

bool VaryingNumbers::has_some(Owner owner) const {
  const auto at = std::lower_bound(places_.begin(), places_.end(), owner,
                                   [](const ParameterPlace& place, Owner of) { return place.owner < of; });
  return at != places_.end() && at->owner == owner;
}

bool VaryingNumbers::has_angle(const Scene& scene, int joint) const {
  return scene.joints[static_cast<std::size_t>(joint)].keeps_angle() && has({Owner::joint, joint, 0, 0});
}

bool VaryingNumbers::has_length(const Scene& scene, int joint) const {
  return scene.joints[static_cast<std::size_t>(joint)].keeps_length() && has({Owner::joint, joint, 0, 0});
}

bool VaryingNumbers::has_axis(int joint) const { return std::binary_search(axes_.begin(), axes_.end(), joint); }

bool VaryingNumbers::has_carriage(const Scene& scene, int joint) const {
  const Joint& of = scene.joints[static_cast<std::size_t>(joint)];
  if (!of.has_travel() || !of.keeps_angle() || !of.friction) return false;
  return has({Owner::joint, joint, 0, 0}) || has({Owner::joint, joint, 0, 2}) || has_axis(joint);
}

bool VaryingNumbers::has_friction(const Scene& scene, int joint) const {
  const Joint& of = scene.joints[static_cast<std::size_t>(joint)];
  if (of.keeps_length()) return false;
  const int first = of.keeps_angle() ? 1 : 0;
  const auto at =
      std::lower_bound(places_.begin(), places_.end(), ParameterPlace{Owner::joint, joint, 0, first}, is_before);
  return at != places_.end() && at->owner == Owner::joint && at->item == joint;
}

}  // namespace poise
