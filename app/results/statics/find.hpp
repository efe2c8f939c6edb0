#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "statics/inverse/find_numbers.hpp"

namespace poise::app {

/// What `poise find` was asked for. Refers to the ranges.
struct FindView {
  std::vector<const VariedScene*> numbers{};
  std::vector<WantedValue> wanted{};
  bool all = false;
  std::vector<SoughtQuantity> shown{};  ///< with each value that is found
};

/// What `poise find` shows: the values with their radii, what the quantities are there, and what is proved;
/// docs/json.md.
Result find_result(const FindView& view, const FoundSet& found, const std::vector<std::string>& settings);

/// The quantity over the number along the curves that were followed, with the value that is wanted and the numbers that
/// were found; none where two numbers are sought.
std::vector<Panel> find_panels(const FindView& view, const FoundSet& found);

/// Whether values were found, and all of them are proved or, of loads at folds, confirmed.
bool is_settled(const FoundSet& found);

}  // namespace poise::app
