#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/readings.hpp"
#include "statics/equilibrium.hpp"
#include "statics/reference.hpp"

namespace poise::app {

/// What one method answered, with all that is measured of it.
struct Answer {
  Equilibrium rest;
  std::optional<Readings> readings;    ///< where the search ended; none when it did not begin
  std::optional<Reference> reference;  ///< of confirmed answers
};

/// What an energy that is shown counts; Mechanism::energy drops the constants.
inline constexpr const char* energy_note = "springs in full, loads without the part that no motion changes";

/// The error that is shown: against the 50-digit reference, empty where there is none.
std::optional<double> error_of(const Answer& answer);

/// Takes the readings of a result, and, of a confirmed one, its reference.
Answer measure(const StaticModel& model, Equilibrium rest);

/// How the confirmed answers of several methods compare.
struct Agreement {
  int confirmed = 0;  ///< answers that count
  bool same = true;   ///< they are one equilibrium
  /// Places of the confirmed answers, those of one equilibrium together; in their order.
  std::vector<std::vector<std::size_t>> rests;
  double difference = 0.0;   ///< largest difference of a scaled coordinate between two of them
  std::string coordinate;    ///< the coordinate of that difference
  bool whole_turns = false;  ///< some angle differs by whole turns, which are not counted
};

/// Two answers are the same equilibrium where their 50-digit references are (differences below 1e-9), or, without
/// references, where they differ by less than 1e-6. Angles count without whole turns unless a torsion spring or an
/// angle stop tells turns apart.
Agreement compare_answers(const StaticModel& model, const std::vector<Answer>& answers);

}  // namespace poise::app
