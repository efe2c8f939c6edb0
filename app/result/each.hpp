#pragma once

// Columns of a table out of the rows they describe.

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "app/result/tone.hpp"

namespace poise::app {

/// The cells of a column: `cell` of each row, a member or a function. Text gives texts, a tone gives tones; numbers,
/// counts and flags give numbers, not a number where an optional holds none.
template <class Rows, class Cell>
auto each(const Rows& rows, Cell cell) {
  using Found = std::remove_cvref_t<std::invoke_result_t<Cell&, decltype(*std::begin(rows))>>;
  constexpr bool is_text = std::is_convertible_v<Found, std::string>;
  using Kept = std::conditional_t<std::is_same_v<Found, Tone>, Tone, std::conditional_t<is_text, std::string, double>>;
  std::vector<Kept> cells;
  for (const auto& row : rows) {
    if constexpr (std::is_same_v<Found, std::optional<double>>)
      cells.push_back(std::invoke(cell, row).value_or(std::numeric_limits<double>::quiet_NaN()));
    else
      cells.push_back(static_cast<Kept>(std::invoke(cell, row)));
  }
  return cells;
}

/// 0, 1, ... below `count`: the rows of what stands in several ranges side by side.
inline std::vector<std::size_t> places(std::size_t count) {
  std::vector<std::size_t> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = i;
  return out;
}

/// The members of a range that are `wanted`, in their order.
template <class Rows, class Wanted>
auto chosen_of(const Rows& rows, Wanted wanted) {
  std::vector<std::remove_cvref_t<decltype(*std::begin(rows))>> out;
  for (const auto& row : rows) {
    if (std::invoke(wanted, row)) out.push_back(row);
  }
  return out;
}

}  // namespace poise::app
