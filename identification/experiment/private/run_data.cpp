#include "identification/experiment/private/run_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <system_error>

#include <fmt/format.h>

#include "model/nearest_name.hpp"

namespace poise {
namespace {

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (!holds(names, name)) names.push_back(name);
}

/// Whether a cell holds no reading.
bool is_gap(const DataColumn& column, double value) {
  return std::isnan(value) || std::find(column.missing.begin(), column.missing.end(), value) != column.missing.end();
}

/// Whether a row of a column is one of those that a run is read from.
bool takes(const RunSource& source, const DataColumn& column, const DataFile& file, double time) {
  return !column.trimmed || source.takes(file.time_factor * time);
}

void expect_no_gaps(const CsvTable& table, const DataColumn& column, const CsvPart& rows, const RunSource& source) {
  const std::vector<double>& values = table.column(column.name);
  const DataFile& file = source.files[*column.file];
  for (std::size_t row = rows.first; row < rows.last; row += source.every) {
    if (!std::isnan(values[row]) || !takes(source, column, file, table.column(file.time)[row])) continue;
    TomlPlace{table.file, table.line[row], column.name}.fail(
        fmt::format("expected a value, found a gap; fill it, leave the row out, or add gaps = true to the {} ({}:{})",
                    column.wanted_by.item, column.wanted_by.file, column.wanted_by.line));
  }
}

std::vector<CsvPart>::const_iterator find_segment(const std::vector<CsvPart>& parts, const std::string& value) {
  return std::find_if(parts.begin(), parts.end(), [&](const CsvPart& part) { return part.value == value; });
}

/// Each file of a run must have the segments of the first, and no more.
void expect_same_segments(const RunSource& source, const std::vector<std::vector<CsvPart>>& parts) {
  for (std::size_t f = 1; f < parts.size(); ++f) {
    for (const auto& [lacking, having] : {std::pair(f, std::size_t{0}), std::pair(std::size_t{0}, f)}) {
      for (const CsvPart& part : parts[having]) {
        if (find_segment(parts[lacking], part.value) != parts[lacking].end()) continue;
        source.place.fail(fmt::format(
            "expected the same segments in every file of the run, \"{}\" has no \"{}\"; name those that all have with "
            "segments = [...]",
            source.files[lacking].path.string(), part.value));
      }
    }
  }
}

}  // namespace

void make_continuous(const TomlPlace& wanted_by, const std::optional<double>& wraps, double unit,
                     const std::string& run, Series& series) {
  constexpr double turn = 2 * std::numbers::pi;
  if (wraps) {
    if (*wraps > 0) unwrap(series, *wraps);
    return;
  }
  const auto expect_none = [&](double period, double part, const std::string& remedy) {
    const std::optional<std::size_t> at = wrapped_at(series, period, part);
    if (!at) return;
    wanted_by.fail(fmt::format(
        "expected readings of a continuous angle, found a jump by {:.4g} at {:.6g} s of run \"{}\", as of an encoder "
        "that starts again after each turn; add wraps = {:.10g} ({}), or wraps = 0 if it does not",
        (series.value[*at] - series.value[*at - 1]) / unit, series.time[*at], run, period / std::abs(unit), remedy));
  };
  expect_none(turn, 0.25, "a turn in the column's unit");
  // Degrees, gons and counts that are taken for another unit.
  for (const double period : {360.0, 400.0, 1024.0, 4096.0, 8192.0, 16384.0, 65536.0}) {
    const double factor = turn / period;
    expect_none(period * std::abs(unit), 0.05,
                fmt::format("and, if that is a turn, factor = {:.10g} for radians", factor));
  }
}

void DataFiles::want(RunSource& source) {
  std::vector<Wanted*> files;
  for (const DataFile& file : source.files) {
    std::error_code unknown;
    if (!std::filesystem::exists(file.path, unknown)) {
      file.named.fail("expected a data file, there is no \"" + file.path.string() + "\"; " +
                      (file.replaceable ? "give it with --data FILE" : "correct the path"));
    }
    Wanted& here = files_[file.path];
    files.push_back(&here);
    if (source.files.size() > 1 && here.header.empty()) here.header = read_csv_header(file.path);
    here.columns.push_back(file.time);
    if (source.split.empty()) continue;
    if (source.files.size() > 1 && !holds(here.header, source.split)) {
      source.place.fail(fmt::format(
          "expected the column \"{}\" of split in every file of the run, \"{}\" has none; name its segments there too",
          source.split, file.path.string()));
    }
    add_once(here.words, source.split);
  }
  for (DataColumn& column : source.columns) {
    std::vector<std::size_t> having;
    if (column.file) having.push_back(*column.file);
    for (std::size_t f = 0; f < files.size() && !column.file; ++f) {
      // A file alone is asked for every column, so that the error is about its header.
      if (files.size() == 1 || holds(files[f]->header, column.name)) having.push_back(f);
    }
    if (having.empty()) {
      std::vector<std::string> known;
      for (const Wanted* file : files) {
        for (const std::string& name : file->header) add_once(known, name);
      }
      column.wanted_by.fail(fmt::format("expected the column \"{}\" in a file of the run in line {}, none has it{}",
                                        column.name, source.place.line, did_you_mean_or_list(column.name, known)));
    }
    if (having.size() > 1) {
      column.wanted_by.fail(fmt::format(
          "expected the column \"{}\" in one file of the run in line {}, \"{}\" and \"{}\" have it; rename one of them",
          column.name, source.place.line, source.files[having[0]].path.string(),
          source.files[having[1]].path.string()));
    }
    column.file = having.front();
    Wanted& file = *files[*column.file];
    add_once(file.columns, column.name);
    add_once(file.gaps, column.name);
  }
  // The times have no gaps, even where a column of a sensor is the time.
  for (std::size_t f = 0; f < files.size(); ++f) std::erase(files[f]->gaps, source.files[f].time);
}

const CsvTable& DataFiles::table(const DataFile& file) {
  Wanted& wanted = files_.at(file.path);
  if (!wanted.table) wanted.table = read_csv(file.path, wanted.columns, wanted.words, wanted.gaps);
  return *wanted.table;
}

// All parts of a file, or those that the run names, in that order.
std::vector<CsvPart> DataFiles::parts(const RunSource& source, std::size_t file) {
  const CsvTable& table = this->table(source.files[file]);
  if (source.split.empty()) return {{"", 0, table.line.size()}};
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

std::vector<RunData> DataFiles::read(const RunSource& source) {
  std::vector<std::vector<CsvPart>> parts_of_file;
  for (std::size_t f = 0; f < source.files.size(); ++f) parts_of_file.push_back(parts(source, f));
  expect_same_segments(source, parts_of_file);
  std::vector<RunData> runs;
  for (const CsvPart& first : parts_of_file.front()) {
    RunData& run = runs.emplace_back();
    if (!source.split.empty()) run.segment = first.value;
    std::vector<CsvPart> rows;
    double begin = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < source.files.size(); ++f) {
      const CsvTable& table = this->table(source.files[f]);
      const auto part = find_segment(parts_of_file[f], first.value);
      constexpr std::size_t least_samples = 3;
      const bool has_samples = std::any_of(source.columns.begin(), source.columns.end(),
                                           [&](const DataColumn& c) { return c.file == f && !c.lists_times; });
      check_times(table, source.files[f].time, part->first, part->last, source.every, has_samples ? least_samples : 1);
      rows.push_back(*part);
    }
    for (const DataColumn& column : source.columns) {
      if (!column.begins) continue;
      const DataFile& file = source.files[*column.file];
      const CsvTable& table = this->table(file);
      const std::vector<double>& values = table.column(column.name);
      std::size_t row = rows[*column.file].first;
      const auto is_before = [&] {
        return !takes(source, column, file, table.column(file.time)[row]) ||
               (!source.begins_at_first_row && is_gap(column, values[row]));
      };
      while (row < rows[*column.file].last && is_before()) row += source.every;
      if (row < rows[*column.file].last) begin = std::min(begin, file.time_factor * table.column(file.time)[row]);
    }
    // Times alone count from that of their clock.
    if (begin == std::numeric_limits<double>::infinity()) begin = 0.0;
    run.clock_zero = begin;
    for (const DataColumn& column : source.columns) {
      const CsvTable& table = this->table(source.files[*column.file]);
      const CsvPart& part = rows[*column.file];
      if (!column.gaps) expect_no_gaps(table, column, part, source);
      const DataFile& file = source.files[*column.file];
      const std::vector<double>& time = table.column(file.time);
      const std::vector<double>& values = table.column(column.name);
      Series& series = run.columns.emplace_back();
      for (std::size_t row = part.first; row < part.last; row += source.every) {
        if (is_gap(column, values[row]) || !takes(source, column, file, time[row])) continue;
        series.time.push_back(file.time_factor * time[row] - begin);
        series.value.push_back(column.lists_times ? series.time.back() : values[row]);
      }
    }
  }
  return runs;
}

}  // namespace poise
