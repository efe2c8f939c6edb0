#include "identification/run_data.hpp"

#include <algorithm>
#include <system_error>

#include "model/nearest_name.hpp"

namespace poise {

DataFiles::DataFiles(const std::vector<Sensor>& sensors) {
  for (const Sensor& sensor : sensors) readings_.push_back(sensor.column);
}

void DataFiles::want(const std::filesystem::path& file, const RunSource& source) {
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) {
    source.place.fail("expected a data file, there is no \"" + file.string() + "\"; give it with --data FILE");
  }
  Wanted& wanted = files_.try_emplace(file, Wanted{readings_, {}, {}}).first->second;
  wanted.columns.push_back(source.time);
  if (source.split.empty()) return;
  if (std::find(wanted.words.begin(), wanted.words.end(), source.split) == wanted.words.end()) {
    wanted.words.push_back(source.split);
  }
}

const CsvTable& DataFiles::read(const std::filesystem::path& file) {
  Wanted& wanted = files_.at(file);
  if (!wanted.table) wanted.table = read_csv(file, wanted.columns, wanted.words);
  return *wanted.table;
}

std::vector<CsvPart> chosen_parts(const CsvTable& table, const RunSource& source) {
  std::vector<CsvPart> parts = parts_of(table, source.split);
  if (parts.empty()) source.place.fail("expected a data file with rows, \"" + table.file + "\" has only a header");
  if (source.segments.empty()) return parts;
  std::vector<std::string> values;
  for (const CsvPart& part : parts) values.push_back(part.value);
  std::vector<CsvPart> chosen;
  for (const TomlText& segment : source.segments) {
    const auto found = std::find(values.begin(), values.end(), segment.value);
    if (found == values.end()) {
      segment.place.fail("expected a value of the column \"" + source.split + "\", found \"" + segment.value + "\"" +
                         did_you_mean_or_list(segment.value, values));
    }
    chosen.push_back(parts[static_cast<std::size_t>(found - values.begin())]);
  }
  return chosen;
}

Record record_of(const CsvTable& table, const RunSource& source, std::size_t first, std::size_t last,
                 double time_factor, const std::vector<Sensor>& sensors) {
  check_times(table, source.time, first, last, source.every);
  const std::vector<double>& time = table.column(source.time);
  Record record;
  for (const Sensor& sensor : sensors) {
    const std::vector<double>& column = table.column(sensor.column);
    Series& series = record.sensors.emplace_back();
    for (std::size_t row = first; row < last; row += source.every) {
      series.time.push_back(time_factor * (time[row] - time[first]));
      series.value.push_back(sensor.zero + sensor.unit * column[row]);
    }
  }
  return record;
}

}  // namespace poise
