#pragma once

#include <optional>

#include "statics/equilibrium.hpp"
#include "statics/readings.hpp"
#include "statics/reference.hpp"

namespace poise {

/// What one method answered, with all that is measured of it.
struct Answer {
  Equilibrium equilibrium;
  std::optional<Readings> readings;    ///< where the search ended; none when it did not begin
  std::optional<Reference> reference;  ///< of confirmed answers
};

/// The error that is shown: against the 50-digit reference, empty where there is none.
std::optional<double> error_of(const Answer& answer);

/// Takes the readings of a result, and, of a confirmed one, its reference.
Answer measure(const StaticModel& model, Equilibrium equilibrium);

}  // namespace poise
