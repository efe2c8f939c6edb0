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
  std::size_t repeated = 0;   ///< readings at rest that at_rest_once() has left out
};

/// Adds whole periods to readings of a column that starts again after each, so that no two successive ones differ by
/// more than half a period.
void unwrap(Series& series, double period);
/// The reading before which a series must have started again: where it jumps by 3/4 to 5/4 of the period at most and,
/// unwrapped, never by more than `part` of it. None where there is no such jump.
std::optional<std::size_t> wrapped_at(const Series& series, double period, double part = 0.25);

/// The largest standard deviation, SI, that noise of evenly spaced readings can have, be it white or with correlations
/// r^i over i readings, r <= 0.9. Third differences at lags of h readings,
///   d(i) = y_i - 3 y_{i-h} + 3 y_{i-2h} - y_{i-3h},
/// of such noise have the variance (20 - 30 r^h + 12 r^2h - 2 r^3h) sigma^2, least with r = 0.9, and motion adds to it.
/// So for each of h = 1, 2, 4, ... 64 sigma is at most their deviation, median |d| / 0.6745, over the root of that with
/// r = 0.9; the least of these is returned, or, where it is more, the resolution q of the readings as q / sqrt(12), or
/// 1e-5 of their root mean square. Infinite where there are fewer than 13 readings.
double noise_at_most(const Series& series);
/// The step of readings that are counts of an encoder or digits of a display: where one in 50 or more is like the one
/// before, the tenth part of the steps that are not 0 is smaller. 0 where readings are seldom alike.
double resolution_of(const std::vector<double>& readings);

/// The series with one of the readings that differ by no more than their resolution_of() to its end, the last: where an
/// encoder has come to rest its rounding is one error, not one of each reading; noise that is less than a step changes
/// it little. One that does not move by more in all stays as it is.
Series at_rest_once(Series series);

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
