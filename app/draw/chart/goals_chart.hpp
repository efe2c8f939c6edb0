#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "design/goals/design_search.hpp"

namespace poise::app {

/// A panel with the sweep of GoalProblem that it is over; -1: the trade-off.
struct GoalPanel {
  int sweep = -1;
  Panel panel{};
};

/// Each quantity of goals along each of their sweeps, before and after, with the limits; the trade-off where there is
/// one. Nothing where no numbers were found.
std::vector<GoalPanel> goals_panels(const GoalProblem& problem, const GoalDesign& found);

/// Both aims of a trade-off, in the units of the scene: "greatest force.drive", "N".
struct TradedAims {
  std::array<std::string, 2> names{}, units{};
  std::array<std::vector<double>, 2> values{};  ///< at each of TradeOff::points
};
std::optional<TradedAims> traded_aims(const GoalProblem& problem, const GoalDesign& found);

}  // namespace poise::app
