#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "model/csv_table.hpp"

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

/// The file split by the values of its column `split`, which was read as words (in order of appearance). Throws
/// InputError with the line where a value occurs again: the rows of each part must be contiguous.
struct CsvPart {
  std::string value;
  std::size_t first = 0, last = 0;  ///< rows [first, last)
};
std::vector<CsvPart> parts_of(const CsvTable& table, const std::string& split);

/// Throws InputError with the line where `time` does not ascend within rows [first, last), or where fewer than
/// `least` of the rows first, first + every, ... remain.
void check_times(const CsvTable& table, const std::string& time, std::size_t first, std::size_t last,
                 std::size_t every = 1, std::size_t least = 3);

}  // namespace poise
