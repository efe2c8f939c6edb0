#include "identification/assessment/record_faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "model/toml_reader.hpp"

namespace poise {
namespace {

double quantile_of(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::vector<double> step_sizes(const std::vector<double>& y) {
  std::vector<double> out;
  for (std::size_t i = 1; i < y.size(); ++i) out.push_back(std::abs(y[i] - y[i - 1]));
  return out;
}

/// A number that is often written in place of a reading.
bool is_usual_marker(double column) {
  constexpr std::array whole = {0.0,     999.0,   9999.0,  99999.0,      999999.0,
                                32767.0, 32768.0, 65535.0, 2147483647.0, 2147483648.0};
  return std::find(whole.begin(), whole.end(), std::abs(column)) != whole.end();
}

/// Readings [first, last] of a series.
struct Stretch {
  std::size_t first = 0, last = 0;

  std::size_t count() const { return last - first + 1; }
};

std::vector<Stretch> alike(const std::vector<double>& y, std::size_t least) {
  std::vector<Stretch> out;
  for (std::size_t i = 0; i < y.size();) {
    std::size_t end = i + 1;
    while (end < y.size() && y[end] == y[i]) ++end;
    if (end - i >= least) out.push_back({i, end - 1});
    i = end;
  }
  return out;
}

/// Whether a run has readings of a motion.
bool has_motion(const Run& run) { return !run.is_simulated() && !run.is_at_rest(); }

class RunFaults {
 public:
  RunFaults(const Experiment& experiment, std::size_t r, std::vector<RecordFault>& out)
      : experiment_(experiment), r_(r), run_(experiment.runs[r]), record_(experiment.records[r]), out_(out) {}

  void find() {
    const auto found = std::ssize(out_);
    for (std::size_t k = 0; k < record_.sensors.size(); ++k) {
      if (record_.sensors[k].value.size() < least_readings || experiment_.sensors[k].reads_impacts()) continue;
      if (find_constant(k)) continue;
      if (!can_halt()) find_alike(k);
      find_wild(k);
    }
    for (const RunInput& input : run_.inputs) find_stuck(input);
    find_lost();
    // What is cut off stands still too.
    const bool is_wrong =
        std::any_of(out_.begin() + found, out_.end(), [](const RecordFault& one) { return one.is_wrong; });
    if (!is_wrong) find_idle();
  }

 private:
  static constexpr std::size_t least_readings = 10, least_stuck = 10, parabola = 6;

  const Sensor& sensor(std::size_t k) const { return experiment_.sensors[k]; }
  const Series& series(std::size_t k) const { return record_.sensors[k]; }
  /// As the file has it.
  double column(std::size_t k, double value) const { return (value - sensor(k).zero) / sensor(k).unit; }
  /// On the files' clock, as from, to and skip count.
  std::string clock(double time) const { return fmt::format("{:.6g}", run_.clock_zero + time); }
  void add(std::size_t k, std::string words, std::string cure, bool is_wrong = true) {
    out_.push_back({r_, k, std::move(words), std::move(cure), is_wrong});
  }

  /// Whether the mechanism itself may halt at once, or jump: at a stop, or as it is driven.
  bool can_halt() const {
    const Scene& scene = experiment_.scene_of(run_.part);
    return !scene.stops.empty() || !scene.drives.empty();
  }

  bool find_constant(std::size_t k) {
    const std::vector<double>& y = series(k).value;
    if (std::adjacent_find(y.begin(), y.end(), std::not_equal_to<>()) != y.end()) return false;
    const bool others_change = std::any_of(record_.sensors.begin(), record_.sensors.end(), [](const Series& other) {
      return std::adjacent_find(other.value.begin(), other.value.end(), std::not_equal_to<>()) != other.value.end();
    });
    if (others_change || record_.sensors.size() == 1) {
      add(k,
          fmt::format("all {} readings of \"{}\" in run \"{}\" are {:.6g}", y.size(), sensor(k).name, run_.name,
                      column(k, y.front())),
          "if the sensor was not connected, take it out of the run with sensors = [...]", false);
    }
    return true;
  }

  // --- clipped and stuck --------------------------------------------------------------------------------------------

  void find_alike(std::size_t k) {
    constexpr std::size_t least = 4;
    const std::vector<double>& y = series(k).value;
    const double resolution = resolution_of(y), noise = noise_at_most(series(k)), unsure = std::max(noise, resolution);
    const auto [low, high] = std::minmax_element(y.begin(), y.end());
    const std::vector<Stretch> all = alike(y, least);
    std::vector<double> steps = step_sizes(y);
    std::sort(steps.begin(), steps.end());
    // Where readings are cut off once, all that have that value are.
    std::vector<double> limits;
    for (const Stretch& one : all) {
      const double value = y[one.first];
      const bool is_known = std::find(limits.begin(), limits.end(), value) != limits.end();
      if (is_known || (value != *low && value != *high)) continue;
      const auto again =
          std::count_if(all.begin(), all.end(), [&](const Stretch& other) { return y[other.first] == value; });
      if (stops(y, one, steps, resolution) || exceeds(y, one, unsure, again > 1)) limits.push_back(value);
    }
    std::vector<Stretch> clipped, stuck;
    for (const Stretch& one : all) {
      if (std::find(limits.begin(), limits.end(), y[one.first]) != limits.end()) {
        clipped.push_back(one);
      } else if (stops(y, one, steps, resolution)) {
        stuck.push_back(one);
      }
    }
    report_alike(k, clipped, true);
    report_alike(k, stuck, false);
  }

  /// Whether a smooth curve with the slopes at both ends of the stretch leaves its value, by more than noise and the
  /// steps of an encoder that turns round there explain; that does not stop twice at the same value, as `again` says.
  static bool exceeds(const std::vector<double>& y, const Stretch& one, double unsure, bool again) {
    constexpr std::size_t slope_over = 3;
    if (one.first < slope_over || one.last + slope_over >= y.size()) return false;
    const double before = (y[one.first] - y[one.first - slope_over]) / slope_over;
    const double behind = (y[one.last + slope_over] - y[one.last]) / slope_over;
    const double by = std::abs(before - behind) * static_cast<double>(one.count()) / 8;
    const double slope_error = 0.5 * unsure;  // sqrt(2) sqrt(2) / 3, of the difference of two slopes, and some more
    const double edge = std::max(std::abs(y[one.first] - y[one.first - 1]), std::abs(y[one.last + 1] - y[one.last]));
    return before * behind < 0 && by > (again ? 1.5 : 3.0) * edge &&
           by > 4 * unsure + 3 * slope_error * static_cast<double>(one.count()) / 8;
  }

  /// Whether the sensor alone stands still: its readings jump behind a long stretch, or halt within one. `steps`: all
  /// sizes of steps, ascending, of which those within the stretch are 0.
  static bool stops(const std::vector<double>& y, const Stretch& one, const std::vector<double>& steps,
                    double resolution) {
    if (one.count() < least_stuck) return false;
    const std::size_t within = one.count() - 1;
    const auto of_others = [&](double part) {
      return steps[within + static_cast<std::size_t>(part * static_cast<double>(steps.size() - 1 - within))];
    };
    const double jump = one.last + 1 < y.size() ? std::abs(y[one.last + 1] - y[one.last]) : 0.0;
    const double before = one.first > 0 ? std::abs(y[one.first] - y[one.first - 1]) : 0.0;
    const double usual = of_others(0.5);
    return jump > 5 * of_others(0.95) || (before > 0.5 * usual && usual > 4 * resolution);
  }

  void report_alike(std::size_t k, const std::vector<Stretch>& found, bool clipped) {
    if (found.empty()) return;
    constexpr std::size_t most_spans = 3;
    const Series& read = series(k);
    std::size_t readings = 0;
    std::string skip;
    for (std::size_t i = 0; i < found.size(); ++i) {
      readings += found[i].count();
      if (i < most_spans) {
        skip += fmt::format("{}[{}, {}]", i > 0 ? ", " : "", clock(read.time[found[i].first]),
                            clock(read.time[found[i].last]));
      }
    }
    if (found.size() > most_spans) skip += ", ...";
    add(k,
        fmt::format("readings of \"{}\" in run \"{}\" {} at {:.6g}: {} of them, from {} s on", sensor(k).name,
                    run_.name, clipped ? "are cut off" : "stand still", column(k, read.value[found.front().first]),
                    readings, clock(read.time[found.front().first])),
        fmt::format("add skip = [{}] to the run", skip));
  }

  /// Loads may stand still, at 0 and at their limits, before and behind what they do, and again and again.
  void find_stuck(const RunInput& input) {
    if (input.motion.of == MotionInput::Of::drive) return;
    const std::vector<double>& times = input.motion.curve->breaks();
    std::vector<double> y;
    for (const double t : times) y.push_back(input.motion.curve->at(t));
    const std::vector<Stretch> all = alike(y, 2);
    if (all.size() != 1 || y.size() < 4 * all.front().count()) return;
    const Stretch& one = all.front();
    const double value = y[one.first];
    const auto [low, high] = std::minmax_element(y.begin(), y.end());
    if (value == 0.0 || value == *low || value == *high || one.first == 0 || one.last + 1 == y.size()) return;
    std::vector<double> steps = step_sizes(y);
    std::sort(steps.begin(), steps.end());
    if (!stops(y, one, steps, resolution_of(y))) return;
    add(0,
        fmt::format("the load of input \"{}\" in run \"{}\" stands still at {:.6g}: {} readings, from {} s on",
                    input.path, run_.name, (value - input.zero) / input.unit, one.count(), clock(times[one.first])),
        "leave these cells empty and add gaps = true to the input");
  }

  void find_wild(std::size_t k) {
    const std::vector<double>& y = series(k).value;
    if (experiment_.loss != Loss::squares || !sensor(k).is_of_measure() || sensor(k).reads_acceleration()) return;
    std::vector<double> medians = y;
    for (std::size_t i = 2; i + 2 < y.size(); ++i) {
      const auto at = y.begin() + static_cast<std::ptrdiff_t>(i);
      medians[i] = quantile_of({at - 2, at + 3}, 0.5);
    }
    const std::vector<double> steps = step_sizes({medians.begin() + 2, medians.end() - 2});
    const double far = std::max(20 * noise_at_most(series(k)), 3 * *std::max_element(steps.begin(), steps.end()));
    std::vector<std::size_t> wild;
    for (std::size_t i = 0; i < y.size(); ++i) {
      if (std::abs(y[i] - medians[i]) > far) wild.push_back(i);
    }
    if (wild.empty()) return;
    add(k,
        fmt::format("{} wild of \"{}\" in run \"{}\", first {:.6g} at {} s",
                    wild.size() == 1 ? "a reading is" : fmt::format("{} readings are", wild.size()), sensor(k).name,
                    run_.name, column(k, y[wild.front()]), clock(series(k).time[wild.front()])),
        "add loss = \"huber\" to the experiment, which limits what they do, or skip them in the run");
  }

  // --- lost samples -------------------------------------------------------------------------------------------------

  /// A value and a slope between two readings.
  struct At {
    double value, slope;
  };

  /// Evaluates the parabola through the readings [first, first + parabola), in least squares, at time t.
  static At parabola_at(const Series& read, std::size_t first, double t, double spacing) {
    std::array<double, 5> powers{};  // sums of x^k
    std::array<double, 3> b{};       // of y x^k
    for (std::size_t i = first; i < first + parabola; ++i) {
      const double x = (read.time[i] - t) / spacing;
      double power = 1.0;
      for (std::size_t k = 0; k < powers.size(); ++k, power *= x) {
        powers[k] += power;
        if (k < b.size()) b[k] += power * read.value[i];
      }
    }
    const auto& [s0, s1, s2, s3, s4] = powers;
    // Cramer's rule for the normal equations.
    const double m0 = s2 * s4 - s3 * s3, m1 = s1 * s4 - s2 * s3, m2 = s1 * s3 - s2 * s2;
    const double determinant = s0 * m0 - s1 * m1 + s2 * m2;
    const double value = (b[0] * m0 - b[1] * m1 + b[2] * m2) / determinant;
    const double slope = (-b[0] * m1 + b[1] * (s0 * s4 - s2 * s2) - b[2] * (s0 * s3 - s1 * s2)) / determinant;
    return {value, slope / spacing};
  }

  struct Jump {
    std::size_t at = 0;  // the reading behind it
    double lost = 0.0, over = 0.0;
  };

  std::optional<Jump> largest_jump(std::size_t k) const {
    const Series& read = series(k);
    if (read.value.size() < 4 * parabola || !sensor(k).reads_measure()) return std::nullopt;
    std::vector<double> spacings;
    for (std::size_t i = 1; i < read.time.size(); ++i) spacings.push_back(read.time[i] - read.time[i - 1]);
    const double spacing = quantile_of(spacings, 0.5);
    // Each side half a spacing from its edge: between them passes what the clock says beyond one spacing.
    std::vector<double> sizes, slopes;
    struct Gap {
      double extra, jump, slope;
      bool slopes_agree;
    };
    std::vector<Gap> all;
    for (std::size_t i = parabola; i + parabola <= read.value.size(); ++i) {
      const At left = parabola_at(read, i - parabola, read.time[i - 1] + spacing / 2, spacing);
      const At right = parabola_at(read, i, read.time[i] - spacing / 2, spacing);
      const double slope = (left.slope + right.slope) / 2;
      all.push_back({read.time[i] - read.time[i - 1] - spacing, right.value - left.value, slope,
                     std::abs(left.slope - right.slope) < 0.3 * std::abs(slope)});
      sizes.push_back(std::abs(all.back().jump - slope * all.back().extra));
      slopes.push_back(std::abs(slope));
    }
    // Where it is at rest for most of the record the parabolas miss little there.
    const double rounding = resolution_of(read.value) / std::sqrt(12.0);
    const double usual = std::max({quantile_of(sizes, 0.5), 1e-9 * quantile_of(slopes, 0.9) * spacing, rounding});
    const double fast = 0.3 * quantile_of(slopes, 0.75);
    std::optional<Jump> largest;
    for (std::size_t n = 0; n < all.size(); ++n) {
      const auto& [extra, jump, slope, slopes_agree] = all[n];
      if (!slopes_agree || std::abs(slope) < fast || sizes[n] < 10 * usual || !stands_out(sizes, n)) continue;
      // Over a long gap that was only not read the motion is no straight line.
      if (extra > 0.5 * spacing && std::abs(jump) > 0.3 * std::abs(slope) * extra) continue;
      const double lost = jump / slope - extra;
      if (std::abs(lost) < 0.7 * spacing) continue;
      const double over = sizes[n] / usual;
      if (!largest || over > largest->over) largest = Jump{n + parabola, lost, over};
    }
    return largest;
  }

  /// Whether a size is larger by far than those whose parabolas do not cross the same place.
  static bool stands_out(const std::vector<double>& sizes, std::size_t n) {
    double around = 0.0;
    for (std::size_t d = parabola + 1; d <= 3 * parabola; ++d) {
      if (n >= d) around = std::max(around, sizes[n - d]);
      if (n + d < sizes.size()) around = std::max(around, sizes[n + d]);
    }
    return sizes[n] > 4 * around;
  }

  void find_lost() {
    if (can_halt()) return;
    std::optional<Jump> worst;
    std::size_t in = 0;
    for (std::size_t k = 0; k < record_.sensors.size(); ++k) {
      const std::optional<Jump> found = largest_jump(k);
      if (!found || (worst && worst->over > found->over)) continue;
      worst = found;
      in = k;
    }
    if (!worst) return;
    const std::vector<double>& time = series(in).time;
    const std::string before = clock(time[worst->at - 1]), behind = clock(time[worst->at]);
    add(in,
        fmt::format("between {} s and {} s of run \"{}\" \"{}\" jumps by what {:.3g} s of motion make: {}", before,
                    behind, run_.name, sensor(in).name, std::abs(worst->lost),
                    worst->lost > 0 ? "readings were lost, or the clock stood still"
                                    : "the clock jumped, or readings were taken twice"),
        fmt::format("end the run there with to = {}, and add a second run with from = {}", before, behind));
  }

  // --- standstill ---------------------------------------------------------------------------------------------------

  void find_idle() {
    const Scene& scene = experiment_.scene_of(run_.part);
    if (!run_.inputs.empty() || !scene.time_functions.empty() || !scene.drives.empty()) return;
    std::array<double, 3> left = {INFINITY, INFINITY, INFINITY};
    constexpr std::array levels = {8.0, 32.0, 128.0};
    std::size_t in = 0;
    for (std::size_t k = 0; k < record_.sensors.size(); ++k) {
      const Series& read = series(k);
      if (read.value.size() < least_readings || !sensor(k).is_of_rest()) continue;
      const double unsure = noise_at_most(read);
      const double place = quantile_of({read.value.begin(), read.value.begin() + 5}, 0.5);
      std::size_t i = 0;
      for (std::size_t level = 0; level < levels.size(); ++level) {
        while (i < read.value.size() && std::abs(read.value[i] - place) < levels[level] * unsure) ++i;
        if (i == read.value.size()) break;
        if (level == 0 && read.time[i] < left[0]) in = k;
        left[level] = std::min(left[level], read.time[i]);
      }
    }
    if (!std::isfinite(left[2])) return;
    const double first = left[1] - left[0], second = left[2] - left[1];
    const double began = 2 * left[0] - left[1];
    const std::vector<double>& time = series(in).time;
    const auto still = std::lower_bound(time.begin(), time.end(), began) - time.begin();
    constexpr std::ptrdiff_t least_still = 8;
    if (still < least_still || began < 3 * first || second < 1.5 * first) return;
    const double from = run_.unknown_start ? left[0] : began;
    add(in,
        fmt::format("run \"{}\" stands still until {} s, {} readings, while a free mechanism does not", run_.name,
                    clock(began), still),
        fmt::format("add from = {} to the run", clock(*std::lower_bound(time.begin(), time.end(), from))));
  }

  const Experiment& experiment_;
  std::size_t r_;
  const Run& run_;
  const Record& record_;
  std::vector<RecordFault>& out_;
};

/// Whether values stand on steps of an instrument that are coarser than this: all differences are multiples of the
/// least.
bool has_steps(std::vector<double> values, double coarse) {
  constexpr double whole_within = 0.01;
  std::sort(values.begin(), values.end());
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] > values[i - 1]) steps.push_back(values[i] - values[i - 1]);
  }
  if (steps.empty()) return true;
  const double least = *std::min_element(steps.begin(), steps.end());
  return least > coarse && std::all_of(steps.begin(), steps.end(), [&](double step) {
           return std::abs(step / least - std::round(step / least)) <= whole_within;
         });
}

/// Finds rows of a run at rest that repeat others in all digits, though the readings have more of them than their
/// noise.
void find_copies(const Experiment& experiment, std::size_t r, std::vector<RecordFault>& out) {
  constexpr std::size_t least = 3;
  constexpr double part = 0.25, fine = 0.3, fine_of_range = 1e-4;
  const Run& run = experiment.runs[r];
  std::vector<const std::vector<double>*> columns;
  std::size_t first_sensor = experiment.sensors.size();
  for (std::size_t k = 0; k < experiment.records[r].sensors.size(); ++k) {
    const std::vector<double>& y = experiment.records[r].sensors[k].value;
    if (y.size() != run.rows) continue;
    const auto [low, high] = std::minmax_element(y.begin(), y.end());
    const Sensor& sensor = experiment.sensors[k];
    const double coarse = sensor.noise_known ? fine * sensor.noise : fine_of_range * (*high - *low);
    if (has_steps(y, coarse)) return;
    first_sensor = std::min(first_sensor, k);
    columns.push_back(&y);
  }
  if (columns.empty()) return;
  for (const RowInput& input : run.row_inputs) columns.push_back(&input.values);
  std::set<std::vector<double>> rows;
  for (std::size_t i = 0; i < run.rows; ++i) {
    std::vector<double> row;
    for (const std::vector<double>* column : columns) row.push_back((*column)[i]);
    rows.insert(std::move(row));
  }
  const std::size_t copies = run.rows - rows.size();
  if (copies < least || static_cast<double>(copies) < part * static_cast<double>(run.rows)) return;
  out.push_back(
      {r, first_sensor,
       fmt::format("{} of {} rows of run \"{}\" repeat others in all digits: copies are no readings of their own",
                   copies, run.rows, run.name),
       "leave the copies out of the file"});
}

/// A marker in a series: its value as the column has it, the first reading, and how many.
struct Marker {
  double column = 0.0;
  std::size_t first = 0, count = 0;
};

/// Finds one in a column that was read as  zero + unit column.
std::optional<Marker> marker_in(const Series& series, double zero, double unit) {
  constexpr std::size_t least_readings = 10, often = 3;
  const std::vector<double>& y = series.value;
  if (y.size() < least_readings) return std::nullopt;
  const double noise = noise_at_most(series);
  std::map<double, std::vector<std::size_t>> places;
  for (std::size_t i = 0; i < y.size(); ++i) places[y[i]].push_back(i);
  const std::vector<double> steps = step_sizes(y);
  // Candidates stand behind the largest steps.
  std::vector<std::size_t> order(steps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  constexpr std::size_t tried = 6;
  std::partial_sort(order.begin(), order.begin() + std::min(tried, order.size()), order.end(),
                    [&](std::size_t a, std::size_t b) { return steps[a] > steps[b]; });
  for (std::size_t n = 0; n < std::min(tried, order.size()); ++n) {
    for (const std::size_t i : {order[n], order[n] + 1}) {
      const double value = y[i];
      const std::vector<std::size_t>& all = places[value];
      const double column = (value - zero) / unit;
      const double rounded = std::round(column);
      const bool is_usual =
          std::abs(column - rounded) < 1e-6 * std::max(1.0, std::abs(column)) && is_usual_marker(rounded);
      if (all.size() > y.size() / 2 || (!is_usual && all.size() < often)) continue;
      double largest = 0.0;       // step between others
      std::vector<double> jumps;  // from others to the marker, the smaller of those before and behind
      std::optional<std::size_t> last;
      for (std::size_t j = 0; j < y.size(); ++j) {
        if (y[j] == value) continue;
        if (last && j == *last + 1) largest = std::max(largest, std::abs(y[j] - y[*last]));
        if (last && j > *last + 1) {
          jumps.push_back(std::min(std::abs(value - y[*last]), std::abs(value - y[j])));
        }
        last = j;
      }
      // A few may fall where the motion passes the marker's value.
      constexpr double few = 0.3;
      const bool stands_out = !jumps.empty() && quantile_of(jumps, few) > std::max(3 * largest, 20 * noise);
      if (stands_out && (is_usual || jumps.size() >= often))
        return Marker{is_usual ? rounded : column, all.front(), all.size()};
    }
  }
  return std::nullopt;
}

/// Finds a usual marker, but 0, that is far from all other values, which are in no order.
std::optional<Marker> marker_at_rest(const std::vector<double>& values, double zero, double unit) {
  constexpr double far = 10.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double column = (values[i] - zero) / unit, rounded = std::round(column);
    const bool is_whole = std::abs(column - rounded) < 1e-6 * std::max(1.0, std::abs(column));
    if (!is_whole || rounded == 0.0 || !is_usual_marker(rounded)) continue;
    std::vector<double> others;
    for (const double one : values) {
      if (one != values[i]) others.push_back(one);
    }
    if (others.size() < 2) return std::nullopt;
    const auto [low, high] = std::minmax_element(others.begin(), others.end());
    const double away = std::max(*low - values[i], values[i] - *high);
    if (away > far * std::max(*high - *low, std::max(std::abs(*low), std::abs(*high)))) {
      return Marker{rounded, i, values.size() - others.size()};
    }
  }
  return std::nullopt;
}

/// Throws InputError for a marker that was found at `place`; `when` tells where it is read first.
void refuse_marker(const std::optional<Marker>& found, const TomlPlace& place, const Run& run, const char* readings,
                   const std::function<std::string(std::size_t)>& when,
                   const std::function<std::string(double)>& cure) {
  if (!found) return;
  place.fail(fmt::format(
      "expected readings of {}, found {:.10g} {} in run \"{}\", first {}, as loggers write where they read nothing; {}",
      readings, found->column, found->count == 1 ? "once" : fmt::format("{} times", found->count), run.name,
      when(found->first), cure(found->column)));
}

void expect_no_markers_in(const Experiment& experiment, std::size_t r) {
  const Run& run = experiment.runs[r];
  const std::string& file = experiment.file_of(run.part);
  const auto row = [](std::size_t i) { return fmt::format("in row {}", i + 1); };
  for (std::size_t k = 0; k < experiment.records[r].sensors.size(); ++k) {
    const Sensor& sensor = experiment.sensors[k];
    const Series& series = experiment.records[r].sensors[k];
    if (sensor.missing || sensor.reads_impacts()) continue;
    const auto time = [&](std::size_t i) { return fmt::format("at {:.6g} s", run.clock_zero + series.time[i]); };
    const auto cure = [](double m) {
      return fmt::format("add missing = [{:.10g}], or missing = [] if it was read", m);
    };
    const TomlPlace place{file, sensor.line, "sensor \"" + sensor.name + "\""};
    if (run.is_at_rest()) {
      refuse_marker(marker_at_rest(series.value, sensor.zero, sensor.unit), place, run, "positions or forces", row,
                    cure);
    } else {
      refuse_marker(marker_in(series, sensor.zero, sensor.unit), place, run, "a motion", time, cure);
    }
  }
  for (const RunInput& input : run.inputs) {
    if (input.motion.of == MotionInput::Of::drive) continue;  // a curve through them, whose values are not those read
    Series series;
    series.time = input.motion.curve->breaks();
    for (const double t : series.time) series.value.push_back(input.motion.curve->at(t));
    const auto time = [&](std::size_t i) { return fmt::format("at {:.6g} s", run.clock_zero + series.time[i]); };
    const TomlPlace place{file, input.line, "input \"" + input.path + "\""};
    refuse_marker(marker_in(series, input.zero, input.unit), place, run, "a load", time,
                  [](double) { return std::string("leave these cells empty and add gaps = true to the input"); });
  }
  for (const RowInput& input : run.row_inputs) {
    refuse_marker(marker_at_rest(input.values, 0.0, 1.0), {file, input.line, "input \"" + input.path + "\""}, run,
                  "a load", row, [](double) { return std::string("leave these rows out of the file"); });
  }
}

}  // namespace

void expect_no_markers(const Experiment& experiment) {
  for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
    if (!experiment.runs[r].is_simulated()) expect_no_markers_in(experiment, r);
  }
}

std::vector<RecordFault> record_faults(const Experiment& experiment) {
  std::vector<RecordFault> out;
  for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
    const Run& run = experiment.runs[r];
    if (has_motion(run)) RunFaults(experiment, r, out).find();
    if (run.is_at_rest() && !run.is_simulated()) find_copies(experiment, r, out);
  }
  return out;
}

}  // namespace poise
