#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace poise {

/// Readings of one sensor in one run.
struct Series {
  std::vector<double> time;   ///< s, ascending
  std::vector<double> value;  ///< SI, one per time
};

/// Adds whole periods to readings of a column that starts again after each, so that no two successive ones differ by
/// more than half a period.
void unwrap(Series& series, double period);
/// The reading before which a series must have started again: where it jumps by more than 3/4 of the period and,
/// unwrapped, never by more than 1/4. None where there is no such jump.
std::optional<std::size_t> wrapped_at(const Series& series, double period);

/// What was read in one run.
struct Record {
  std::vector<Series> sensors;  ///< one per sensor of the experiment; empty where the run has no readings of it

  std::size_t count() const;
  bool empty() const { return count() == 0; }
};

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

/// The file split by the values of its column `split`, which was read as words (in order of appearance). Throws
/// InputError with the line where a value occurs again: the rows of each part must be contiguous.
struct CsvPart {
  std::string value;
  std::size_t first = 0, last = 0;  ///< rows [first, last)
};
std::vector<CsvPart> parts_of(const CsvTable& table, const std::string& split);

/// Throws InputError with the line where `time` does not ascend within rows [first, last), or where fewer than 3 of the
/// rows first, first + every, ... remain.
void check_times(const CsvTable& table, const std::string& time, std::size_t first, std::size_t last,
                 std::size_t every = 1);

}  // namespace poise
