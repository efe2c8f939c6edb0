#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"
#include "statics/equilibrium/answer.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// What `poise equilibria` was asked to show beside.
struct EquilibriaView {
  std::vector<SoughtQuantity> show{};
  int driven = -1;  ///< the first of Scene::stops that holds a drive; -1 of none
};

/// What `poise equilibria` shows: of each equilibrium its energy, stability and place, in which one the mechanism
/// settles, and the barriers between them; all that `poise solve` says of each in JSON, the table in CSV, docs/json.md.
/// `answers` are those of the set, in its order.
Result equilibria_result(const StaticModel& model, const EquilibriumSet& set, const std::vector<Answer>& answers,
                         const AllEquilibriaOptions& options, const EquilibriaView& view,
                         const std::vector<std::string>& settings);

}  // namespace poise::app
