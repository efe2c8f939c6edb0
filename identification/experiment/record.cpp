#include "identification/experiment/record.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "model/toml_reader.hpp"

namespace poise {

void unwrap(Series& series, double period) {
  for (std::size_t i = 1; i < series.value.size(); ++i) {
    series.value[i] -= period * std::round((series.value[i] - series.value[i - 1]) / period);
  }
}

std::optional<std::size_t> wrapped_at(const Series& series, double period, double part) {
  const auto largest_step = [](const std::vector<double>& values) {
    std::size_t largest = 0;
    double size = 0.0;
    for (std::size_t i = 1; i < values.size(); ++i) {
      const double step = std::abs(values[i] - values[i - 1]);
      if (step <= size) continue;
      size = step;
      largest = i;
    }
    return std::pair(largest, size);
  };
  const auto [at, jump] = largest_step(series.value);
  if (!(jump > 0.75 * period && jump < 1.25 * period)) return std::nullopt;
  Series continuous = series;
  unwrap(continuous, period);
  if (largest_step(continuous.value).second > part * period) return std::nullopt;
  return at;
}

double resolution_of(const std::vector<double>& readings) {
  constexpr std::size_t one_in = 50, tenth = 10;
  std::vector<double> steps;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    if (readings[i] != readings[i - 1]) steps.push_back(std::abs(readings[i] - readings[i - 1]));
  }
  const std::size_t alike = readings.size() - std::min(readings.size(), steps.size() + 1);
  if (steps.empty() || alike * one_in < readings.size()) return 0.0;
  const auto at = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / tenth);
  std::nth_element(steps.begin(), at, steps.end());
  return *at;
}

double noise_at_most(const Series& series) {
  const std::vector<double>& y = series.value;
  constexpr std::size_t most_lag = 64, least_lags = 10;
  constexpr double median_of_normal = 0.6745, correlation = 0.9, least_part = 1e-5;
  double out = INFINITY;
  for (std::size_t lag = 1; lag <= most_lag && y.size() >= (3 + least_lags) * lag; lag *= 2) {
    std::vector<double> sizes;
    for (std::size_t i = 3 * lag; i < y.size(); ++i) {
      sizes.push_back(std::abs(y[i] - 3 * y[i - lag] + 3 * y[i - 2 * lag] - y[i - 3 * lag]));
    }
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const double r = std::pow(correlation, lag);
    out = std::min(out, *middle / (median_of_normal * std::sqrt(20 - 30 * r + 12 * r * r - 2 * r * r * r)));
  }
  double squares = 0.0;
  for (const double value : y) squares += value * value;
  const double size = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(y.size(), 1)));
  return std::max({out, resolution_of(y) / std::sqrt(12.0), least_part * size});
}

Series at_rest_once(Series series) {
  const double resolution = resolution_of(series.value);
  if (resolution == 0.0 || series.repeated > 0) return series;
  constexpr double one_step = 1.01;
  double least = series.value.back(), greatest = least;
  std::size_t first = series.value.size();
  while (first > 0) {
    least = std::min(least, series.value[first - 1]);
    greatest = std::max(greatest, series.value[first - 1]);
    if (greatest - least > one_step * resolution) break;
    --first;
  }
  if (first == 0) return series;
  const auto from = static_cast<std::ptrdiff_t>(first);
  series.repeated = series.value.size() - 1 - first;
  series.value.erase(series.value.begin() + from, series.value.end() - 1);
  series.time.erase(series.time.begin() + from, series.time.end() - 1);
  return series;
}

std::size_t Record::count() const {
  std::size_t sum = 0;
  for (const Series& series : sensors) sum += series.value.size();
  return sum;
}

std::vector<CsvPart> parts_of(const CsvTable& table, const std::string& split) {
  const auto words =
      std::find_if(table.words.begin(), table.words.end(), [&](const CsvWords& w) { return w.column == split; });
  if (words == table.words.end()) throw std::out_of_range("column \"" + split + "\" was not read as words");
  std::vector<CsvPart> parts;
  std::unordered_map<std::string_view, int> seen;  // with the line of the last row
  for (std::size_t row = 0; row < words->value.size(); ++row) {
    const std::string& value = words->value[row];
    if (parts.empty() || parts.back().value != value) {
      const auto [earlier, is_new] = seen.emplace(value, 0);
      if (!is_new) {
        TomlPlace{table.file, table.line[row], split}.fail("expected the rows of " + shown_cell(value) +
                                                           " to stand together, found more after line " +
                                                           std::to_string(earlier->second) + "; sort the rows");
      }
      parts.push_back({value, row, row});
    }
    parts.back().last = row + 1;
    seen[value] = table.line[row];
  }
  return parts;
}

void check_times(const CsvTable& table, const std::string& time, std::size_t first, std::size_t last, std::size_t every,
                 std::size_t least) {
  const std::vector<double>& t = table.column(time);
  for (std::size_t row = first + 1; row < last; ++row) {
    if (t[row] > t[row - 1]) continue;
    TomlPlace{table.file, table.line[row], time}.fail(
        "expected a time after that of the row before; sort the rows, or split the file by the column that names its "
        "segments");
  }
  const std::size_t rows = first < last ? (last - first - 1) / every + 1 : 0;
  if (rows >= least) return;
  TomlPlace{table.file, first < last ? table.line[first] : 1, time}.fail(
      "expected at least " + std::to_string(least) + (least == 1 ? " row" : " rows") + ", found " +
      std::to_string(rows) + (every > 1 ? " after thinning; take more of them" : "; give a longer record"));
}

}  // namespace poise
