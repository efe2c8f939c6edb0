#pragma once

// Where the readings of runs come from.

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "identification/experiment/record.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// A data file, and its column of the time.
struct DataFile {
  std::filesystem::path path;
  std::string time;
  double time_factor = 1.0;  ///< seconds per unit of it
  TomlPlace named{};         ///< where
  bool replaceable = true;   ///< by --data
};

/// A part of the files' clock, s, both ends included.
struct TimeSpan {
  double from = -std::numeric_limits<double>::infinity(), to = std::numeric_limits<double>::infinity();

  bool holds(double time) const { return time >= from && time <= to; }
};

/// A column of numbers that a run needs.
struct DataColumn {
  std::string name;
  TomlPlace wanted_by;                ///< the sensor or input
  bool gaps = false;                  ///< empty cells and NaN mean: not read at that time
  std::vector<double> missing{};      ///< cells with one of these values mean the same
  bool trimmed = true;                ///< only what RunSource::takes() is read; all of an input, which goes on
  bool begins = true;                 ///< the run does not begin after the first row of its file
  bool lists_times = false;           ///< its rows are no samples, what is read of them is their time
  std::optional<std::size_t> file{};  ///< index into RunSource::files; absent: found by DataFiles::want()
};

/// Makes the readings of an angle continuous: those of a column that `wraps` after so much, SI. Throws InputError where
/// that is not stated and they must have started again after a full turn; `unit` is the SI value of the column's unit.
void make_continuous(const TomlPlace& wanted_by, const std::optional<double>& wraps, double unit,
                     const std::string& run, Series& series);

/// What a run is read from.
struct RunSource {
  TomlPlace place;  ///< of `data`
  std::vector<DataFile> files;
  std::string split;  ///< column that names the segments; empty: the files are one run
  std::vector<TomlText> segments;
  std::size_t every = 1;
  /// Time 0 is the first row; else the first in which a column that begins was read.
  bool begins_at_first_row = false;
  TimeSpan kept;               ///< rows at other times are left out
  std::vector<TimeSpan> skip;  ///< and those of these
  std::vector<DataColumn> columns;

  /// Whether rows of that time of the files' clock, s, are read.
  bool takes(double time) const {
    return kept.holds(time) &&
           std::none_of(skip.begin(), skip.end(), [&](const TimeSpan& span) { return span.holds(time); });
  }
};

/// Readings of one run as they are written.
struct RunData {
  std::optional<std::string> segment;
  std::vector<Series> columns;  ///< one per column of the source; time 0 is the earliest row of those that begin
  double clock_zero = 0.0;      ///< time 0 on the files' clock, s
};

/// Data files, each of which is read once, with all the columns that any run needs of it.
class DataFiles {
 public:
  /// Finds the file of each column. To be called for every run before the first is read. Throws InputError where there
  /// is no such file, or where none of a run's files has a column, or several have it.
  void want(RunSource& source);
  /// The runs of a source that was wanted: one, or one for each segment. Throws InputError as read_csv(), parts_of()
  /// and check_times(), for a gap in a column without gaps, and where a file has not all of the segments.
  std::vector<RunData> read(const RunSource& source);

 private:
  struct Wanted {
    std::vector<std::string> header, columns, words, gaps;
    std::optional<CsvTable> table;
  };
  const CsvTable& table(const DataFile& file);
  std::vector<CsvPart> parts(const RunSource& source, std::size_t file);

  std::map<std::filesystem::path, Wanted> files_;
};

}  // namespace poise
