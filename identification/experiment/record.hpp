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
/// The reading before which a series must have started again: where it jumps by 3/4 to 5/4 of the period at most and,
/// unwrapped, never by more than `part` of it. None where there is no such jump.
std::optional<std::size_t> wrapped_at(const Series& series, double period, double part = 0.25);

/// Standard deviation of the noise of evenly spaced readings, SI, from their third differences at lags of h readings,
///   d_h(i) = y_i - 3 y_{i-h} + 3 y_{i-2h} - y_{i-3h},  s_h = median |d_h| / (0.6745 sqrt(20)),
/// 0.6745 being the median size of normal noise of unit deviation, and 20 = 1 + 9 + 9 + 1. White noise makes all s_h
/// the same; noise whose correlation falls as exp(-h/n) is too small in s_1 and grows by at most sqrt(2) with each
/// doubling of h, while a smooth motion grows by 8. So h doubles as long as s_h grows by less than 1.6, and the largest
/// is taken, less what the next one shows of the motion: an eighth of what it has more. At least that of the resolution
/// q of the readings, q / sqrt(12), and 1e-5 of their root mean square. 0 where there are fewer than 8 readings.
double noise_of(const Series& series);
/// The step of readings that are counts of an encoder or digits of a display: where one in 50 or more is like the one
/// before, the tenth part of the steps that are not 0 is smaller. 0 where readings are seldom alike.
double resolution_of(const std::vector<double>& readings);

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
