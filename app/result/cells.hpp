#pragma once

// Tables and values as pieces of text: what the presenters of text, Markdown and pages share.

#include <cstddef>
#include <string>
#include <vector>

#include "app/result/result.hpp"

namespace poise::app {

/// Rows that text shows of a long table.
inline constexpr std::size_t most_rows = 24;

/// A column as text.
struct TextColumn {
  std::string title, unit;  ///< "Fx", "MN"
  std::vector<std::string> cells;
  const Column* column = nullptr;
  double factor = 1.0;  ///< from the column's numbers to those of the cells

  /// "Fx (MN)".
  std::string heading() const;
};

/// The columns of a table that text shows. Numbers outside 1e-4 .. 1e7 have a prefix before their unit, where it takes
/// one, or an exponent.
std::vector<TextColumn> text_columns(const Table& table);

/// The rows of a table that text shows: `first`: all up to most_rows + 1, else the first most_rows; `spread`: every
/// k-th and the last, most_rows + 1 at most; `all`.
std::vector<std::size_t> shown_rows(const Table& table);

/// "199.4 lbf in: springs in full", or the text, of a value.
std::string text_of(const Entry& entry);

/// Whether text at a level shows an item.
bool is_shown(const Item& item, Verbosity reader);

}  // namespace poise::app
