#include "model/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <deque>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "model/nearest_name.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"
#include "model/value_range.hpp"

namespace poise {
namespace {

constexpr std::string_view blanks = " \t";
constexpr std::size_t largest_file = std::size_t{4} << 30U;

/// Tables are read more than once, their header first: a pipe would be empty by then.
std::string text_of_table(const std::filesystem::path& file) {
  expect_regular_file(file);
  return read_text_file(file, largest_file);
}

std::string_view trimmed(std::string_view cell) {
  const std::size_t first = cell.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return cell.substr(first, cell.find_last_not_of(blanks) - first + 1);
}

/// Splits a CSV text into rows and cells.
class CsvRows {
 public:
  CsvRows(std::string_view file, std::string_view text) : file_(file), text_(text) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text_.starts_with(byte_order_mark)) text_.remove_prefix(byte_order_mark.size());
    separator_ = separator_of_header();
  }

  /// Moves on to the next row; false at the end of the file. Its cells are valid until the next call.
  bool next() {
    cells_.clear();
    unquoted_.clear();
    if (text_.find_first_not_of(separator_ == '\t' ? " \r\n" : " \t\r\n", at_) == std::string_view::npos) return false;
    row_line_ = line_;
    do {
      cells_.push_back(trimmed(read_cell()));
    } while (skip_separator());
    return true;
  }

  const std::vector<std::string_view>& cells() const { return cells_; }
  int line() const { return row_line_; }
  char separator() const { return separator_; }
  TomlPlace place(std::string item) const { return {file_, row_line_, std::move(item)}; }

 private:
  /// The one of comma, semicolon and tab that the first line has most of, quoted parts left out.
  char separator_of_header() const {
    int commas = 0, semicolons = 0, tabs = 0;
    bool in_quotes = false;
    for (const char c : text_.substr(0, text_.find_first_of("\r\n"))) {
      if (c == '"') in_quotes = !in_quotes;
      if (in_quotes) continue;
      commas += c == ',';
      semicolons += c == ';';
      tabs += c == '\t';
    }
    if (commas >= semicolons && commas >= tabs) return ',';
    return semicolons >= tabs ? ';' : '\t';
  }

  bool at_cell_end() const {
    return at_ == text_.size() || text_[at_] == separator_ || text_[at_] == '\n' || text_[at_] == '\r';
  }

  void skip_blanks() {
    while (!at_cell_end() && blanks.find(text_[at_]) != std::string_view::npos) ++at_;
  }

  std::string_view read_cell() {
    skip_blanks();
    if (at_ < text_.size() && text_[at_] == '"') return read_quoted();
    const std::size_t begin = at_;
    while (!at_cell_end()) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  /// "..." with "" for a quote; separators and line breaks inside belong to the cell.
  std::string_view read_quoted() {
    std::string& cell = unquoted_.emplace_back();
    ++at_;
    while (true) {
      if (at_ == text_.size()) place("cell " + std::to_string(cells_.size() + 1)).fail("expected a closing quote");
      const char c = text_[at_++];
      if (c == '"') {
        if (at_ == text_.size() || text_[at_] != '"') break;
        ++at_;
      }
      line_ += c == '\n';
      cell += c;
    }
    skip_blanks();
    if (!at_cell_end()) {
      place("cell " + std::to_string(cells_.size() + 1))
          .fail("expected a separator after the closing quote; double the quotes inside a cell");
    }
    return cell;
  }

  /// True past a separator; false past the end of the line: LF, CR LF or CR.
  bool skip_separator() {
    if (at_ == text_.size()) return false;
    const char c = text_[at_++];
    if (c == separator_) return true;
    if (c == '\r' && at_ < text_.size() && text_[at_] == '\n') ++at_;
    ++line_;
    return false;
  }

  std::string_view file_;
  std::string_view text_;
  char separator_ = ',';
  std::size_t at_ = 0;
  int line_ = 1;
  int row_line_ = 1;
  std::vector<std::string_view> cells_;
  std::deque<std::string> unquoted_;  ///< text of the quoted cells of this row; a deque never moves it
};

/// Moves on to the first row; fails where there is none.
void expect_header(CsvRows& rows) {
  if (!rows.next()) rows.place("header").fail("expected the names of the columns, found an empty file");
}

void expect_no_gap(const CsvRows& rows, std::string_view cell, const std::string& column) {
  if (cell.empty()) rows.place(column).fail("expected a value, found a gap; fill it or leave the row out");
}

double number_in(const CsvRows& rows, std::string_view cell, const std::string& column, bool gaps) {
  constexpr double gap = std::numeric_limits<double>::quiet_NaN();
  if (gaps && cell.empty()) return gap;
  expect_no_gap(rows, cell, column);
  const char* begin = cell.data();
  const char* const end = begin + cell.size();
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') ++begin;
  double value = 0.0;
  const auto [stopped, error] = std::from_chars(begin, end, value);
  const bool is_read = error == std::errc() && stopped == end;
  if (is_read && std::abs(value) <= largest_value) return value;
  if (gaps && is_read && std::isnan(value)) return gap;
  const bool is_number = stopped == end && error != std::errc::invalid_argument;
  const bool decimal_comma = cell.find(',') != std::string_view::npos;
  rows.place(column).fail((is_read && std::isfinite(value) ? "expected a number of at most 1e50, found "
                           : is_number                     ? "expected a finite number, found "
                                                           : "expected a number, found ") +
                          shown_cell(cell) +
                          (decimal_comma ? "; write a decimal point" : "; correct it or leave the row out"));
}

/// Where the header has a column; fails when it has none or several.
std::size_t find_column(const CsvRows& header, const std::string& column) {
  const std::vector<std::string_view>& names = header.cells();
  const auto found = std::find(names.begin(), names.end(), column);
  if (found == names.end()) {
    header.place(column).fail("expected a column of this name in the header" +
                              did_you_mean_or_list(column, {names.begin(), names.end()}));
  }
  if (std::find(std::next(found), names.end(), column) != names.end()) {
    header.place(column).fail("expected one column of this name, found several; rename the others");
  }
  return static_cast<std::size_t>(found - names.begin());
}

void expect_cells(const CsvRows& rows, std::size_t expected) {
  const std::size_t found = rows.cells().size();
  if (found == expected) return;
  rows.place("row").fail("expected " + std::to_string(expected) + " cells as in the header, found " +
                         std::to_string(found) +
                         (found < expected ? "; fill the gaps or leave the row out"
                                           : "; write decimal points, and quotes round cells with separators"));
}

}  // namespace

std::string shown_cell(std::string_view cell) {
  constexpr std::size_t longest = 40;
  return "\"" + std::string(cell.substr(0, longest)) + (cell.size() > longest ? "..." : "") + "\"";
}

const std::vector<double>& CsvTable::column(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  if (found == columns.end()) throw std::out_of_range("column \"" + name + "\" was not read");
  return values[static_cast<std::size_t>(found - columns.begin())];
}

std::vector<std::string> read_csv_header(const std::filesystem::path& file) {
  const std::string text = text_of_table(file), name = file.string();
  CsvRows rows(name, text);
  expect_header(rows);
  return {rows.cells().begin(), rows.cells().end()};
}

CsvTable read_csv(const std::filesystem::path& file, const std::vector<std::string>& columns,
                  const std::vector<std::string>& words, const std::vector<std::string>& gaps) {
  const std::string text = text_of_table(file);
  CsvTable table;
  table.file = file.string();
  CsvRows rows(table.file, text);
  expect_header(rows);
  const std::size_t width = rows.cells().size();
  std::vector<std::size_t> number_cell, word_cell;
  std::vector<char> may_have_gaps;
  for (const std::string& column : columns) {
    if (std::find(table.columns.begin(), table.columns.end(), column) != table.columns.end()) continue;
    number_cell.push_back(find_column(rows, column));
    table.columns.push_back(column);
    may_have_gaps.push_back(std::find(gaps.begin(), gaps.end(), column) != gaps.end() ? 1 : 0);
  }
  for (const std::string& column : words) {
    word_cell.push_back(find_column(rows, column));
    table.words.push_back({column, {}});
  }
  table.values.resize(table.columns.size());
  while (rows.next()) {
    expect_cells(rows, width);
    for (std::size_t i = 0; i < number_cell.size(); ++i) {
      table.values[i].push_back(number_in(rows, rows.cells()[number_cell[i]], table.columns[i], may_have_gaps[i] != 0));
    }
    for (std::size_t i = 0; i < word_cell.size(); ++i) {
      const std::string_view cell = rows.cells()[word_cell[i]];
      expect_no_gap(rows, cell, table.words[i].column);
      table.words[i].value.emplace_back(cell);
    }
    table.line.push_back(rows.line());
  }
  return table;
}

}  // namespace poise
