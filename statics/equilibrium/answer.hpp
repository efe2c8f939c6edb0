#pragma once

#include <optional>
#include <string>

#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/readings.hpp"
#include "statics/model/reference.hpp"
#include "statics/proof/enclosed_values.hpp"

namespace poise {

/// What one method answered, with all that is measured of it.
struct Answer {
  Equilibrium equilibrium;
  std::optional<Readings> readings;    ///< where the search ended; none when it did not begin
  std::optional<Reference> reference;  ///< of confirmed answers
  ValueRadii radii{};                  ///< of confirmed answers
  std::optional<Freedoms> freedoms{};  ///< there, where it is in balance
};

/// What is known of a result, in a few words: "proved: stable", "degenerate, proved: stable", "neutral, proved:
/// unstable", "proved, stability unknown", "checked, not proved", or its status.
std::string in_few_words(const Equilibrium& equilibrium);

/// Distance of the method's own result from the equilibrium that is proved, rad or mechanism sizes; empty where none
/// is.
std::optional<double> error_of(const Answer& answer);

/// Takes the readings of a result, and, of a confirmed one, its reference.
Answer measure(const StaticModel& model, Equilibrium equilibrium);

/// The largest force of a joint, N, and the sum of all loads, N, where the first is at least `times` the second: the
/// mechanism is close to a dead centre. Loads are forces, weights, torques over the mechanism's size, and of a force
/// element what it carries at the assembled start too: what it carries besides follows from the other loads.
struct HeavyReaction {
  std::string kind, name;
  double force = 0.0, load = 0.0;
};
std::optional<HeavyReaction> heavy_reaction(const StaticModel& model, const Answer& answer, double times = 100.0);

}  // namespace poise
