#pragma once

// Look-up of items of a scene by name, for what users ask of it.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// Place of an item in its list, or, where none has the name, the names to choose from.
struct NamedItem {
  int index = -1;                  ///< -1 where there is none
  std::vector<std::string> known;  ///< in the order of the list; empty where there is one

  explicit operator bool() const { return index >= 0; }
};

/// Finds the first item called `name` among those that `fits(item)`. Only a failure copies names.
template <class Items, class Fits>
NamedItem find_item(const Items& items, std::string_view name, Fits fits) {
  NamedItem out;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name && fits(items[i])) return {static_cast<int>(i), {}};
  }
  for (const auto& item : items) {
    if (fits(item)) out.known.push_back(item.name);
  }
  return out;
}

/// Finds the first item of that name.
template <class Items>
NamedItem find_item(const Items& items, std::string_view name) {
  return find_item(items, name, [](const auto&) { return true; });
}

}  // namespace poise
