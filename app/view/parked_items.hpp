#pragma once

#include <set>
#include <string>
#include <vector>

#include "model/parameters.hpp"
#include "model/scene.hpp"

namespace poise::app {

/// A force element, stop or load, which can be switched off.
struct SwitchedItem {
  std::string item;   ///< "spring.holder", "stop.open", "load.P": unlike all others of the scene
  std::string group;  ///< "springs", "dampers", "stops", "loads"
  std::string name;
  int line = 0;  ///< in the scene file: of its table
};

/// All of them.
std::vector<SwitchedItem> items_of(const Scene& scene);
/// What one is called (SwitchedItem::item), by its place in the list of its owner; empty of what cannot be switched
/// off.
std::string switched_item(const Scene& scene, Owner owner, int index);

/// The scene without some of its items.
Scene without_items(Scene scene, const std::set<std::string>& off);

/// The text of a scene file in which the tables of some items are comments, so that they can be put back. `scene` was
/// read from a text with the same lines.
std::string parked(const std::string& text, const Scene& scene, const std::set<std::string>& off);

}  // namespace poise::app
