#pragma once

// Where the records of measured runs come from. Private to the readers of experiment files.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "identification/experiment.hpp"
#include "identification/record.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// How a run was measured: the keys beside `data`.
struct RunSource {
  TomlPlace place;  ///< of `data`
  std::string time;
  std::string split;  ///< empty: the file is one run
  std::vector<TomlText> segments;
  std::size_t every = 1;
};

/// Data files, each of which is read once, with all the columns that any run needs of it.
class DataFiles {
 public:
  /// All sensors are read from every file.
  explicit DataFiles(const std::vector<Sensor>& sensors);

  /// To be called for every run before the first file is read. Throws InputError where there is no such file.
  void want(const std::filesystem::path& file, const RunSource& source);
  /// A file that was wanted. Throws InputError as read_csv.
  const CsvTable& read(const std::filesystem::path& file);

 private:
  struct Wanted {
    std::vector<std::string> columns, words;
    std::optional<CsvTable> table;
  };
  std::vector<std::string> readings_;
  std::map<std::filesystem::path, Wanted> files_;
};

/// The parts of the file that a run with a `split` asks for: all, or those of its `segments` in their order. Throws
/// InputError where the file has no such segment.
std::vector<CsvPart> chosen_parts(const CsvTable& table, const RunSource& source);

/// Rows first, first + every, ... of [first, last) in SI, the first of them at time 0; `time_factor`: seconds per unit
/// of the time column. Throws InputError as check_times.
Record record_of(const CsvTable& table, const RunSource& source, std::size_t first, std::size_t last,
                 double time_factor, const std::vector<Sensor>& sensors);

}  // namespace poise
