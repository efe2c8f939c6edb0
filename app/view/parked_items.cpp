#include "app/view/parked_items.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/dependent_number.hpp"

namespace poise::app {
namespace {

/// Items of all kinds, in the order of the scene's lists.
struct AllItems {
  std::vector<SwitchedItem> elements, stops, forces, torques;
};

AllItems all_items(const Scene& scene) {
  AllItems out;
  std::set<std::string> used;
  // Elements of one table may share a name.
  const auto unlike = [&](const std::string& item) {
    std::string name = item;
    for (int k = 2; !used.insert(name).second; ++k) name = fmt::format("{} ({})", item, k);
    return name;
  };
  for (const Element& element : scene.elements) {
    out.elements.push_back({unlike(element.table + "." + element.name),
                            stores_energy(element.law) ? "springs" : "dampers", element.name, element.line});
  }
  for (const Stop& stop : scene.stops) {
    const CouplingKind* const kind = coupling_kind(stop);
    // Rows of one coupling are on or off together.
    if (kind != nullptr && kind->row > 0)
      out.stops.push_back(out.stops.back());
    else
      out.stops.push_back({unlike("stop." + stop.name), "stops", stop.name, stop.line});
  }
  for (const Force& force : scene.forces)
    out.forces.push_back({unlike("load." + force.name), "loads", force.name, force.line});
  for (const Torque& torque : scene.torques)
    out.torques.push_back({unlike("load." + torque.name), "loads", torque.name, torque.line});
  return out;
}

std::map<Owner, const std::vector<SwitchedItem>*> by_owner(const AllItems& all) {
  return {{Owner::element, &all.elements},
          {Owner::stop, &all.stops},
          {Owner::coupling, &all.stops},
          {Owner::force, &all.forces},
          {Owner::torque, &all.torques}};
}

template <class Kept>
void remove(std::vector<Kept>& list, const std::vector<SwitchedItem>& items, const std::set<std::string>& off) {
  std::size_t at = 0;
  std::erase_if(list, [&](const Kept&) { return off.contains(items[at++].item); });
}

/// Place of an item among those that are left; -1 of one that is off.
int place_left(const std::vector<SwitchedItem>& items, int place, const std::set<std::string>& off) {
  const auto is_off = [&](const SwitchedItem& item) { return off.contains(item.item); };
  const auto at = items.begin() + place;
  return is_off(*at) ? -1 : place - static_cast<int>(std::count_if(items.begin(), at, is_off));
}

/// The place of the load, spring or drive of a function among those that are left; -1 of one that is off.
int place_of_load(const AllItems& all, const TimeFunction& function, const std::set<std::string>& off) {
  if (function.of == TimeFunction::Of::drive || function.of == TimeFunction::Of::frame) return function.item;
  if (function.of == TimeFunction::Of::element) return place_left(all.elements, function.item, off);
  return place_left(function.of == TimeFunction::Of::force ? all.forces : all.torques, function.item, off);
}

/// Expressions of items that are left, at their new places.
void move_expressions(Scene& scene, const AllItems& all, const std::set<std::string>& off) {
  if (!scene.dependents) return;
  const std::map<Owner, const std::vector<SwitchedItem>*> lists = by_owner(all);
  const auto place_of_function = [&](int place) {
    int at = 0;
    for (int f = 0; f <= place; ++f) {
      const TimeFunction& function = scene.time_functions[static_cast<std::size_t>(f)];
      const bool is_left = place_of_load(all, function, off) >= 0;
      if (f == place) return is_left ? at : -1;
      at += is_left ? 1 : 0;
    }
    return -1;
  };
  std::vector<DependentNumber> left;
  for (DependentNumber one : *scene.dependents) {
    if (one.at.place.owner == Owner::time && one.at.of == DependentPlace::Of::row) {
      one.at.place.item = place_of_function(one.at.place.item);
      if (one.at.place.item < 0) continue;
    }
    if (const auto list = lists.find(one.at.place.owner); list != lists.end()) {
      one.at.place.item = place_left(*list->second, one.at.place.item, off);
      if (one.at.place.item < 0) continue;
    }
    left.push_back(std::move(one));
  }
  scene.dependents = std::make_shared<const std::vector<DependentNumber>>(std::move(left));
}

/// Functions of time of what is left, at their new places.
void move_functions(Scene& scene, const AllItems& all, const std::set<std::string>& off) {
  for (TimeFunction& function : scene.time_functions) {
    function.item = place_of_load(all, function, off);
  }
  std::erase_if(scene.time_functions, [](const TimeFunction& function) { return function.item < 0; });
}

/// Springs of flexible links that are left, at their new places.
void move_springs(Scene& scene, const AllItems& all, const std::set<std::string>& off) {
  for (FlexibleLink& link : scene.flexible_links) {
    for (int& spring : link.springs) spring = place_left(all.elements, spring, off);
    std::erase(link.springs, -1);
  }
}

}  // namespace

std::vector<SwitchedItem> items_of(const Scene& scene) {
  AllItems all = all_items(scene);
  std::vector<SwitchedItem> out;
  for (auto* list : {&all.elements, &all.stops, &all.forces, &all.torques}) {
    std::unique_copy(list->begin(), list->end(), std::back_inserter(out),
                     [](const SwitchedItem& a, const SwitchedItem& b) { return a.item == b.item; });
  }
  return out;
}

std::string switched_item(const Scene& scene, Owner owner, int index) {
  const AllItems all = all_items(scene);
  const auto lists = by_owner(all);
  const auto list = lists.find(owner);
  return list != lists.end() ? list->second->at(static_cast<std::size_t>(index)).item : "";
}

Scene without_items(Scene scene, const std::set<std::string>& off) {
  if (off.empty()) return scene;
  const AllItems all = all_items(scene);
  remove(scene.elements, all.elements, off);
  remove(scene.stops, all.stops, off);
  remove(scene.forces, all.forces, off);
  remove(scene.torques, all.torques, off);
  move_expressions(scene, all, off);
  move_functions(scene, all, off);
  move_springs(scene, all, off);
  return scene;
}

std::string parked(const std::string& text, const Scene& scene, const std::set<std::string>& off) {
  if (off.empty()) return text;
  std::set<int> begins;
  for (const SwitchedItem& item : items_of(scene)) {
    if (off.contains(item.item)) begins.insert(item.line);
  }
  std::istringstream lines(text);
  std::string out;
  bool parking = false;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    const std::size_t first = line.find_first_not_of(" \t");
    const bool is_header = first != std::string::npos && line[first] == '[';
    if (begins.contains(number))
      parking = true;
    else if (is_header)
      parking = false;
    out += (parking && first != std::string::npos ? "# " : "") + line + "\n";
  }
  return out;
}

}  // namespace poise::app
