#pragma once

// Which numbers of a result are shown, by name.

#include <string>
#include <vector>

#include "app/quantity.hpp"
#include "app/readings.hpp"

namespace poise::app {

struct NamedValue {
  std::string name;
  double value = 0.0;      ///< SI
  bool determined = true;  ///< false: nothing depends on it, it stayed at its start
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

/// Size below which a value of this mechanism is rounding and is shown as zero, SI: 1e-13 of the scale of its lengths,
/// forces or work.
double rounding_of(const ScaledModel& model, Quantity quantity);

/// SI values in the scene's unit, rounding put to zero.
std::vector<double> in_units(const ScaledModel& model, Quantity quantity, std::vector<double> values);

}  // namespace poise::app
