#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "statics/equilibrium/answer.hpp"
#include "statics/model/static_model.hpp"

namespace poise::comparison {

/// How the confirmed answers of several methods compare.
struct Agreement {
  int confirmed = 0;  ///< answers that count
  bool same = true;   ///< they are one equilibrium
  /// Places of the confirmed answers, those of one equilibrium together; in their order.
  std::vector<std::vector<std::size_t>> equilibria;
  double difference = 0.0;   ///< largest difference of a scaled coordinate between two of them
  std::string coordinate;    ///< the coordinate of that difference
  bool whole_turns = false;  ///< some angle differs by whole turns, which are not counted
};

/// Two answers are the same equilibrium where their 50-digit references are (differences below 1e-9), or, without
/// references, where they differ by less than 1e-6. Angles count without whole turns unless a torsion spring or an
/// angle stop tells turns apart.
Agreement compare_answers(const StaticModel& model, const std::vector<Answer>& answers);

}  // namespace poise::comparison
