#pragma once

// The values that describe a pose, by name.

#include <cstddef>
#include <string>
#include <vector>

#include "statics/model/readings.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

struct NamedValue {
  std::string name;
  double value = 0.0;      ///< SI
  bool determined = true;  ///< false: nothing depends on it, it keeps the value of the start
};

/// Absolute unwrapped angles of the bodies that can turn, rad.
std::vector<NamedValue> angles_of(const StaticModel& model, const Readings& readings);

/// Travels of slides and pins in slots, m.
std::vector<NamedValue> travels_of(const StaticModel& model, const Readings& readings);

/// Bodies that no chain of joints ties to the ground: indices of Scene::bodies. Of those that joints tie together, the
/// one whose place the model counts the others from.
std::vector<std::size_t> free_bodies(const Layout& layout);

/// Places of the free bodies' origins in the world, m: "block.x", "block.y".
std::vector<NamedValue> places_of(const StaticModel& model, const Readings& readings);

/// For every body the first one, in the order of Scene::bodies, that moves with it as one rigid body because welds join
/// them; 0 for those welded to the ground. A body without welds stands for itself.
std::vector<int> rigid_groups(const Scene& scene);

}  // namespace poise
