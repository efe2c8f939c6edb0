#pragma once

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "app/quantity.hpp"

namespace poise::app {

inline namespace replaced {

struct Cell {
  std::string text;
  Tone tone = Tone::plain;
};

/// Rows under a heading, columns aligned; texts to the left, numbers to the right.
class Table {
 public:
  /// Long tables show this many rows and tell how many more there are, unless all are asked for.
  static constexpr std::size_t shown_rows = 24;

  void add_text_column(std::string title, std::vector<std::string> cells);
  void add_text_column(std::string title, std::vector<Cell> cells);
  void add_number_column(std::string title, std::vector<std::string> cells);
  void add_number_cells(std::string title, std::vector<Cell> cells);
  void show_all() { all_ = true; }

  bool empty() const { return columns_.empty() || columns_.front().cells.empty(); }
  /// Each line is indented by two blanks and ends with a line break.
  std::string print(const Palette& palette) const;

 private:
  struct Column {
    std::string title;
    std::vector<Cell> cells;
    bool to_the_right;
  };
  std::vector<Column> columns_;
  bool all_ = false;
};

}  // namespace replaced
}  // namespace poise::app
