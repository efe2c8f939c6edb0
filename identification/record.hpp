#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace poise {

/// Readings of all sensors over time.
struct Record {
  std::vector<double> time;                  ///< s, ascending
  std::vector<std::vector<double>> reading;  ///< per sensor, per time; SI
  bool empty() const { return time.empty(); }
};

/// A table of numbers with a header, as read from a CSV file (RFC 4180; comma, semicolon or tab).
struct CsvTable {
  std::string file;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> values;  ///< per column
  std::vector<int> line;                    ///< per row, in the file
};

/// Reads the columns asked for. Throws InputError "file:line: column: ..." for a missing column (with the nearest
/// name), a gap, a word that is not a number, NaN, infinity, or a row with too few or too many cells.
CsvTable read_csv(const std::filesystem::path& file, const std::vector<std::string>& columns);

/// The file parted by the values of its column `split` (in order of appearance): rows of each part must stand together.
struct CsvPart {
  std::string value;
  std::size_t first = 0, last = 0;  ///< rows [first, last)
};
std::vector<CsvPart> parts_of(const CsvTable& table, const std::string& split);

/// Throws InputError with the line where `time` does not ascend within rows [first, last), or where fewer than 3 rows
/// remain.
void check_times(const CsvTable& table, const std::string& time, std::size_t first, std::size_t last);

}  // namespace poise
