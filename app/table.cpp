#include "app/table.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace poise::app {

void Table::add_text_column(std::string title, std::vector<std::string> cells) {
  std::vector<Cell> plain;
  plain.reserve(cells.size());
  for (std::string& cell : cells) plain.push_back({std::move(cell), Tone::plain});
  add_text_column(std::move(title), std::move(plain));
}

void Table::add_text_column(std::string title, std::vector<Cell> cells) {
  columns_.push_back({std::move(title), std::move(cells), false});
}

void Table::add_number_column(std::string title, std::vector<std::string> cells) {
  add_text_column(std::move(title), std::move(cells));
  columns_.back().to_the_right = true;
}

void Table::add_number_cells(std::string title, std::vector<Cell> cells) {
  add_text_column(std::move(title), std::move(cells));
  columns_.back().to_the_right = true;
}

std::string Table::print(const Palette& palette) const {
  if (empty()) return "";
  const std::size_t rows = columns_.front().cells.size();
  // One row more than the limit is shown rather than counted.
  const std::size_t shown = all_ || rows <= shown_rows + 1 ? rows : shown_rows;
  std::vector<std::size_t> widths;
  for (const Column& column : columns_) {
    std::size_t width = screen_width(column.title);
    for (std::size_t r = 0; r < shown; ++r) width = std::max(width, screen_width(column.cells[r].text));
    widths.push_back(width);
  }
  std::string out;
  const auto print_row = [&](auto cell_of) {
    std::string line;
    std::size_t owed = 2;  // blanks before the next text, so that no line ends in blanks
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const Cell cell = cell_of(columns_[c]);
      const std::size_t fill = widths[c] - screen_width(cell.text);
      const std::size_t text_end = cell.text.find_last_not_of(' ') + 1;
      if (columns_[c].to_the_right) owed += fill;
      if (text_end > 0) line += std::string(owed, ' ') + palette.paint(cell.tone, cell.text.substr(0, text_end));
      owed = (text_end > 0 ? 0 : owed) + cell.text.size() - text_end + (columns_[c].to_the_right ? 0 : fill) + 2;
    }
    out += line + "\n";
  };
  print_row([](const Column& column) { return Cell{column.title, Tone::faint}; });
  for (std::size_t r = 0; r < shown; ++r) {
    print_row([r](const Column& column) { return column.cells[r]; });
  }
  if (shown < rows) out += palette.paint(Tone::faint, fmt::format("  ... and {} more", rows - shown)) + "\n";
  return out;
}

}  // namespace poise::app
