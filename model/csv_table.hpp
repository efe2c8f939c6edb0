#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// A column of words, kept as they are written.
struct CsvWords {
  std::string column;
  std::vector<std::string> value;  ///< per row
};

/// A table with a header, as read from a CSV file (RFC 4180; comma, semicolon or tab, whichever the header has most
/// of).
struct CsvTable {
  std::string file;
  std::vector<std::string> columns;         ///< those read as numbers, each once
  std::vector<std::vector<double>> values;  ///< per column, per row; finite, or NaN for a gap in a column with gaps
  std::vector<CsvWords> words;              ///< columns read as words
  std::vector<int> line;                    ///< per row, in the file

  /// The numbers of a column that was read. Throws std::out_of_range for any other.
  const std::vector<double>& column(const std::string& name) const;
};

/// The names of the columns. Throws InputError for an empty file.
std::vector<std::string> read_csv_header(const std::filesystem::path& file);

/// Reads the columns asked for, `words` as they are written and the others as numbers with a decimal point. Blanks
/// around a cell and empty lines at the end are ignored. Those of the columns that are also in `gaps` may have empty
/// cells and NaN, which are read as NaN. Throws InputError "file:line: column: ..." for a missing column (with the
/// nearest name), any other gap, a word that is not a number, NaN, infinity, a number beyond 1e50, or a row with too
/// few or too many cells.
CsvTable read_csv(const std::filesystem::path& file, const std::vector<std::string>& columns,
                  const std::vector<std::string>& words = {}, const std::vector<std::string>& gaps = {});

/// A cell as it is shown in a message: in quotes, cut when long.
std::string shown_cell(std::string_view cell);

}  // namespace poise
