#include "identification/assessment/private/cause_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "identification/assessment/private/altered.hpp"

namespace poise {
namespace {

using std::numbers::pi;

struct UsualFactor {
  double factor;
  const char* words;
};

/// A column or an input that is in another unit than was stated is off by one of these.
std::vector<UsualFactor> usual_factors(bool is_angle) {
  std::vector<UsualFactor> out = {
      {1e-3, "a thousandth"}, {1e3, "a thousand"}, {2 * pi, "2 pi"}, {1 / (2 * pi), "1/2 pi"}};
  if (is_angle) {
    out.insert(out.begin(), {{pi / 180, "pi/180"}, {180 / pi, "180/pi"}});
    out.push_back({2 * pi / 60, "2 pi/60"});
  } else {
    out.insert(out.end(), {{1e-2, "a hundredth"}, {1e2, "a hundred"}, {9.80665, "9.81"}, {1 / 9.80665, "1/9.81"}});
  }
  return out;
}

void scale_readings(Experiment& experiment, std::size_t k, double factor) {
  Sensor& sensor = experiment.sensors[k];
  for (Record& record : experiment.records) {
    if (k >= record.sensors.size()) continue;
    for (double& value : record.sensors[k].value) value = sensor.zero + factor * (value - sensor.zero);
    // Degrees that were taken for radians were not made continuous.
    if (sensor.reads_angle() && std::abs(factor) < 1 && sensor.wraps.value_or(1.0) > 0) {
      unwrap(record.sensors[k], 2 * pi);
    }
  }
  sensor.unit *= factor;
  if (!sensor.noise_known) sensor.noise *= std::abs(factor);
}

class Candidates {
 public:
  Candidates(const Experiment& experiment, const std::vector<std::size_t>& worst)
      : experiment_(experiment), worst_(worst) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
      double span = 0.0;
      for (const Series& series : experiment.records[r].sensors) {
        if (!series.time.empty()) span = std::max(span, series.time.back());
      }
      shortest_ = std::min(shortest_, span);
      moves_ = moves_ && !experiment.runs[r].is_at_rest();
    }
  }

  std::vector<CauseCandidate> run() {
    add_plain("the search ended beside the best minimum", "give other starts", [](Experiment&, double) {});
    for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) add_signs(k);
    add_exchanged();
    add_frames();
    for (const std::string& path : inputs()) add_input(path);
    for (const std::string& path : row_inputs()) add_row_input(path);
    for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) add_sensor(k);
    add_all_sensors();
    if (moves_) {
      add_times();
      add_parts();
    }
    add_lost_runs();
    return std::move(out_);
  }

 private:
  const Sensor& sensor(std::size_t k) const { return experiment_.sensors[k]; }
  static std::string named(const Sensor& sensor) { return fmt::format("the sensor \"{}\"", sensor.name); }
  double unit(std::size_t k) const { return sensor(k).dimension().unit(experiment_.scene.units); }
  bool is_scaled(std::size_t k) const { return !sensor(k).reads_impacts(); }

  void add_plain(std::string words, std::string cure, std::function<void(Experiment&, double)> change) {
    CauseCandidate& one = out_.emplace_back();
    one.words = std::move(words);
    one.cure = [cure = std::move(cure)](double) { return cure; };
    one.change = std::move(change);
  }
  void add_number(std::string words, std::function<std::string(double)> cure,
                  std::function<void(Experiment&, double)> change, double start, double least, double most,
                  double step) {
    out_.push_back({std::move(words), std::move(cure), std::move(change), start, least, most, step});
  }

  // --- sensors ------------------------------------------------------------------------------------------------------

  /// With more sensors those of one dimension alone are exchanged.
  static constexpr std::size_t most_to_exchange = 4;

  std::string factor_of(std::size_t k, double times) const {
    return fmt::format("factor = {:.9g} in {}", times * sensor(k).unit / unit(k), named(sensor(k)));
  }

  void add_signs(std::size_t k) {
    if (!is_scaled(k)) return;
    add_plain(fmt::format("{} counts the other way", named(sensor(k))), factor_of(k, -1),
              [k](Experiment& e, double) { scale_readings(e, k, -1); });
  }

  void add_turned_axis(std::size_t k, const std::string& name) {
    const double written = *sensor(k).axis, unit = experiment_.scene.units.angle;
    const auto cure = [=](double by) { return fmt::format("direction = {:.6g} in {}", (written + by) / unit, name); };
    for (const double turn : {pi / 2, -pi / 2}) {
      add_plain(fmt::format("the axis of {} stands across", name), cure(turn),
                [k, turn](Experiment& e, double) { *e.sensors[k].axis += turn; });
    }
    add_number(
        fmt::format("the axis of {} is turned", name), cure,
        [k](Experiment& e, double by) { *e.sensors[k].axis += by; }, 0.0, -pi, pi, 0.01);
  }

  void add_sensor(std::size_t k) {
    if (!is_scaled(k)) return;
    const std::string name = named(sensor(k));
    if (sensor(k).is_accelerometer()) add_turned_axis(k, name);
    for (const UsualFactor& one : usual_factors(sensor(k).on.is_angle())) {
      add_plain(fmt::format("{} has another unit, by {}", name, one.words), factor_of(k, one.factor),
                [k, one](Experiment& e, double) { scale_readings(e, k, one.factor); });
    }
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Record& record : experiment_.records) {
      if (k >= record.sensors.size() || record.sensors[k].value.empty()) continue;
      const auto [a, b] = std::minmax_element(record.sensors[k].value.begin(), record.sensors[k].value.end());
      low = std::min(low, *a);
      high = std::max(high, *b);
    }
    const double range = std::max({high - low, std::abs(low), std::abs(high)});
    if (!(range > 0) || !std::isfinite(range)) return;
    add_number(
        fmt::format("the zero of {} is off", name),
        [zero = sensor(k).zero, unit = unit(k), name](double x) {
          return fmt::format("zero = {:.6g} in {}", (zero + x) / unit, name);
        },
        [k](Experiment& e, double x) {
          for (Record& record : e.records) {
            if (k >= record.sensors.size()) continue;
            for (double& value : record.sensors[k].value) value += x;
          }
        },
        0.0, -10 * range, 10 * range, 1e-3 * range);
    add_number(
        fmt::format("{} has another factor", name),
        [written = sensor(k).unit / unit(k), name](double x) {
          return fmt::format("factor = {:.6g} in {}", x * written, name);
        },
        [k](Experiment& e, double x) { scale_readings(e, k, x); }, 1.0, 0.01, 100.0, 1e-3);
    if (moves_) add_sensor_in_time(k, range);
  }

  void add_sensor_in_time(std::size_t k, double range) {
    const std::string name = named(sensor(k));
    add_number(
        fmt::format("the zero of {} drifts", name),
        [unit = unit(k), name](double x) {
          return fmt::format("its column {} by {:.6g} per second in its quantity's unit: take that out of the file",
                             x < 0 ? "grows" : "falls", std::abs(x) / unit);
        },
        [k](Experiment& e, double x) {
          for (Record& record : e.records) {
            if (k >= record.sensors.size()) continue;
            Series& series = record.sensors[k];
            for (std::size_t i = 0; i < series.value.size(); ++i) series.value[i] += x * series.time[i];
          }
        },
        0.0, -10 * range / shortest_, 10 * range / shortest_, 1e-3 * range / shortest_);
    if (experiment_.sensors.size() < 2 && inputs().empty()) return;
    const double most = most_delay_part * shortest_;
    add_number(
        fmt::format("{} is late or early", name),
        [written = sensor(k).delay, name](double x) { return fmt::format("delay = {:.6g} in {}", written + x, name); },
        [k, most](Experiment& e, double x) {
          Sensor& own = e.sensors[k];
          own.least_delay = own.delay - most;
          own.most_delay = own.delay + most;
          own.delay += x;
          for (std::size_t r = 0; r < e.runs.size(); ++r) {
            if (k >= e.records[r].sensors.size() || e.records[r].sensors[k].time.empty()) continue;
            leave_out(compared_times(e, e.runs[r], k, e.records[r].sensors[k].time.back()), e.records[r].sensors[k]);
          }
        },
        0.0, -most, most, 1e-3 * most);
  }

  void add_all_sensors() {
    for (const bool angles : {true, false}) {
      std::vector<std::size_t> all;
      for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
        if (is_scaled(k) && sensor(k).on.is_angle() == angles) all.push_back(k);
      }
      if (all.size() < 2) continue;
      std::vector<UsualFactor> factors = usual_factors(angles);
      factors.insert(factors.begin(), {-1.0, "-1"});
      for (const UsualFactor& one : factors) {
        const char* const of = angles ? "angles" : "lengths and forces";
        add_plain(one.factor < 0 ? fmt::format("all {} count the other way", of)
                                 : fmt::format("all {} have another unit, by {}", of, one.words),
                  fmt::format("{:.9g} times the factor in each of their sensors", one.factor),
                  [all, one](Experiment& e, double) {
                    for (const std::size_t k : all) scale_readings(e, k, one.factor);
                  });
      }
    }
  }

  void add_exchanged() {
    for (std::size_t a = 0; a < experiment_.sensors.size(); ++a) {
      for (std::size_t b = a + 1; b < experiment_.sensors.size(); ++b) {
        if (!is_scaled(a) || !is_scaled(b)) continue;
        if (sensor(a).dimension() != sensor(b).dimension() && experiment_.sensors.size() > most_to_exchange) continue;
        add_plain(fmt::format("the columns of \"{}\" and \"{}\" are exchanged", sensor(a).name, sensor(b).name),
                  fmt::format("column = \"{}\" in {}, column = \"{}\" in {}", sensor(b).column, named(sensor(a)),
                              sensor(a).column, named(sensor(b))),
                  [a, b](Experiment& e, double) {
                    const Sensor& one = e.sensors[a];
                    const Sensor& other = e.sensors[b];
                    for (Record& record : e.records) {
                      if (b >= record.sensors.size()) continue;
                      std::swap(record.sensors[a], record.sensors[b]);
                      for (double& v : record.sensors[a].value) v = one.zero + one.unit * (v - other.zero) / other.unit;
                      for (double& v : record.sensors[b].value) v = other.zero + other.unit * (v - one.zero) / one.unit;
                    }
                  });
      }
    }
  }

  /// An angle from the ground that was taken for one between bodies, or the reverse.
  void add_frames() {
    const Scene& scene = experiment_.scene;
    for (std::size_t k = 0; experiment_.parts.empty() && k < experiment_.sensors.size(); ++k) {
      const Measure& on = sensor(k).on;
      if (!sensor(k).is_of_measure() || on.kind != Measure::Kind::angle) continue;
      const std::string& body = scene.bodies[static_cast<std::size_t>(on.body_b)].name;
      const auto add = [&](int from, std::string cure) {
        add_plain(fmt::format("{} counts from {}", named(sensor(k)),
                              from == 0 ? std::string("the ground")
                                        : fmt::format("\"{}\"", scene.bodies[static_cast<std::size_t>(from)].name)),
                  std::move(cure), [k, from](Experiment& e, double) { e.sensors[k].on.body_a = from; });
      };
      if (on.body_a != 0) add(0, fmt::format("angle = \"{}\" in {}", body, named(sensor(k))));
      for (std::size_t other = 0; on.body_a == 0 && other < experiment_.sensors.size(); ++other) {
        const Measure& from = sensor(other).on;
        if (other == k || from.kind != Measure::Kind::angle || from.body_a != 0 || from.body_b == on.body_b) continue;
        add(from.body_b, fmt::format("angle = [\"{}\", \"{}\"] in {}",
                                     scene.bodies[static_cast<std::size_t>(from.body_b)].name, body, named(sensor(k))));
      }
    }
  }

  // --- inputs -------------------------------------------------------------------------------------------------------

  std::vector<std::string> inputs() const { return measured_inputs(experiment_); }

  using OfTime = std::function<double(double, double)>;  // of a value, by the number
  static std::function<void(Experiment&, double)> moves(const std::string& path, const OfTime& time,
                                                        const OfTime& value) {
    return [=](Experiment& e, double x) {
      for (Run& run : e.runs) {
        for (RunInput& input : run.inputs) {
          if (input.path != path) continue;
          move_input(
              input, [&](double t) { return time(t, x); }, [&](double v) { return value(v, x); });
        }
      }
    };
  }

  std::vector<std::string> row_inputs() const {
    std::vector<std::string> out;
    for (const Run& run : experiment_.runs) {
      for (const RowInput& input : run.row_inputs) {
        if (std::find(out.begin(), out.end(), input.path) == out.end()) out.push_back(input.path);
      }
    }
    return out;
  }

  /// Adds what may be wrong with a column of runs at rest, and its exchange with that of a sensor.
  void add_row_input(const std::string& path) {
    double largest = 0.0;
    bool is_angle = false;
    for (const Run& run : experiment_.runs) {
      for (const RowInput& input : run.row_inputs) {
        if (input.path != path) continue;
        const Scene& scene = experiment_.scene_of(run.part);
        is_angle = input.drive >= 0 && scene.drives[static_cast<std::size_t>(input.drive)].on.is_angle();
        for (const double value : input.values) largest = std::max(largest, std::abs(value));
      }
    }
    if (!(largest > 0)) return;
    const std::string name = fmt::format("the input \"{}\"", path);
    const auto changes = [path](const std::function<double(double, double)>& value) {
      return [=](Experiment& e, double x) {
        for (Run& run : e.runs) {
          for (RowInput& input : run.row_inputs) {
            if (input.path != path) continue;
            for (double& one : input.values) one = value(one, x);
          }
        }
      };
    };
    const auto times = [&](double by) { return fmt::format("multiply the column of {} by {:.9g}", name, by); };
    add_plain(name + " counts the other way", times(-1), changes([](double v, double) { return -v; }));
    for (const UsualFactor& one : usual_factors(is_angle)) {
      add_plain(fmt::format("{} has another unit, by {}", name, one.words), times(one.factor),
                changes([f = one.factor](double v, double) { return f * v; }));
    }
    add_number(
        fmt::format("the zero of {} is off", name),
        [name](double x) {
          return fmt::format("{:.6g} {} in all rows of {}, in the scene's unit", std::abs(x), x > 0 ? "more" : "less",
                             name);
        },
        changes([](double v, double x) { return v + x; }), 0.0, -10 * largest, 10 * largest, 1e-3 * largest);
    for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
      if (!is_scaled(k)) continue;
      add_plain(fmt::format("the columns of \"{}\" and {} are exchanged", sensor(k).name, name),
                "exchange the names of their columns", [k, path](Experiment& e, double) {
                  const Sensor& own = e.sensors[k];
                  for (std::size_t r = 0; r < e.runs.size(); ++r) {
                    for (RowInput& input : e.runs[r].row_inputs) {
                      std::vector<double>& read = e.records[r].sensors[k].value;
                      if (input.path != path || read.size() != input.values.size()) continue;
                      for (std::size_t i = 0; i < read.size(); ++i) {
                        const double column = (read[i] - own.zero) / own.unit;
                        read[i] = own.zero + own.unit * input.values[i];
                        input.values[i] = column;
                      }
                    }
                  }
                });
    }
  }

  /// Exchanges the columns of a sensor and a load in runs in which the readings of both are as long.
  static void exchange_with_input(Experiment& e, std::size_t k, const std::string& path) {
    const Sensor& own = e.sensors[k];
    for (std::size_t r = 0; r < e.runs.size(); ++r) {
      for (RunInput& input : e.runs[r].inputs) {
        if (input.path != path || k >= e.records[r].sensors.size()) continue;
        Series& read = e.records[r].sensors[k];
        const std::vector<double>& breaks = input.motion.curve->breaks();
        if (read.time.size() < 2 || read.time.front() > breaks.front() || read.time.back() < breaks.back()) continue;
        std::vector<double> given;
        for (std::size_t i = 0; i < read.time.size(); ++i) {
          given.push_back(input.zero + input.unit * (read.value[i] - own.zero) / own.unit);
          read.value[i] = own.zero + own.unit * (input.motion.curve->at(read.time[i]) - input.zero) / input.unit;
        }
        input.motion.curve = std::make_shared<const TimeCurve>(TimeCurve::through(read.time, given));
      }
    }
  }

  void add_input(const std::string& path) {
    double largest = 0.0;
    bool is_angle = false, drives = false;
    for (const Run& run : experiment_.runs) {
      for (const RunInput& input : run.inputs) {
        if (input.path != path) continue;
        drives = input.motion.of == MotionInput::Of::drive;
        is_angle =
            drives && experiment_.scene_of(run.part).drives[static_cast<std::size_t>(input.motion.item)].on.is_angle();
        for (const double t : input.motion.curve->breaks())
          largest = std::max(largest, std::abs(input.motion.curve->at(t)));
      }
    }
    if (!(largest > 0)) return;
    const std::string name = fmt::format("the input \"{}\"", path);
    const auto same = [](double v, double) { return v; };
    const auto times = [&](double by) { return fmt::format("{:.6g} times the factor of {}", by, name); };
    add_plain(name + " counts the other way", times(-1), moves(path, same, [](double v, double) { return -v; }));
    for (std::size_t k = 0; !drives && k < experiment_.sensors.size(); ++k) {
      if (!is_scaled(k) || experiment_.sensors.size() > most_to_exchange) continue;
      add_plain(fmt::format("the columns of \"{}\" and {} are exchanged", sensor(k).name, name),
                "exchange the names of their columns",
                [k, path](Experiment& e, double) { exchange_with_input(e, k, path); });
    }
    for (const UsualFactor& one : usual_factors(is_angle)) {
      add_plain(fmt::format("{} has another unit, by {}", name, one.words), times(one.factor),
                moves(path, same, [f = one.factor](double v, double) { return f * v; }));
    }
    add_number(
        name + " has another factor",
        [name](double x) { return fmt::format("{:.6g} times the factor of {}", x, name); },
        moves(path, same, [](double v, double x) { return x * v; }), 1.0, 0.01, 100.0, 1e-3);
    add_number(
        fmt::format("the zero of {} is off", name),
        [name](double x) {
          return fmt::format("{:.6g} (SI) {} in the column of {}", std::abs(x), x > 0 ? "more" : "less", name);
        },
        moves(path, same, [](double v, double x) { return v + x; }), 0.0, -10 * largest, 10 * largest, 1e-3 * largest);
    const double most = most_delay_part * shortest_;
    add_number(
        name + " is early or late",
        [name](double x) {
          return fmt::format("shift the times of {} by {:.6g} s {}", name, std::abs(x), x > 0 ? "later" : "earlier");
        },
        moves(
            path, [](double t, double x) { return t + x; }, same),
        0.0, -most, most, 1e-3 * most);
    if (drives) return;
    add_number(
        fmt::format("{} saturates: the motor gives less than was commanded", name),
        [name](double x) { return fmt::format("at most {:.6g} (SI) in the column of {}", x, name); },
        moves(path, same, [](double v, double x) { return std::clamp(v, -x, x); }), 0.6 * largest, 0.02 * largest,
        largest, 1e-3 * largest);
  }

  // --- times and parts of the records -------------------------------------------------------------------------------

  static void stretch_all(Experiment& e, double factor) {
    for (std::size_t r = 0; r < e.runs.size(); ++r) stretch_clock(e, r, factor);
  }

  void add_times() {
    const bool stated = std::all_of(experiment_.runs.begin(), experiment_.runs.end(),
                                    [](const Run& run) { return run.states_time_factor; });
    for (const auto& [factor, words] :
         {std::pair(1e-3, "milliseconds"), std::pair(1e3, "thousands of seconds"), std::pair(60.0, "minutes"),
          std::pair(1 / 60.0, "sixtieths of a second"), std::pair(0.1, "tenths of a second"),
          std::pair(0.01, "hundredths of a second")}) {
      add_plain(fmt::format("the times are {}{}", stated ? "by a factor off, as if they were " : "", words),
                fmt::format("{} time_factor = {:.6g} in the runs", stated ? "multiply" : "add", factor),
                [f = factor](Experiment& e, double) { stretch_all(e, f); });
    }
    add_number(
        "the clock is fast or slow",
        [](double x) { return fmt::format("multiply time_factor by {:.6g} in the runs", x); },
        [](Experiment& e, double x) { stretch_all(e, x); }, 1.0, 0.2, 5.0, 1e-4);
  }

  static double span_of(const Record& record) {
    double out = 0.0;
    for (const Series& series : record.sensors) {
      if (!series.time.empty()) out = std::max(out, series.time.back());
    }
    return out;
  }

  /// "from = 1.5 in run "low", and so in the others": where a part of a run begins on the clock of its files.
  std::string part_of_run(const char* key, double part) const {
    const Run& run = experiment_.runs.front();
    return fmt::format("{} = {:.4g} in run \"{}\"{}", key, run.clock_zero + part * span_of(experiment_.records.front()),
                       run.name, experiment_.runs.size() > 1 ? ", and so in the others" : "");
  }

  void add_parts() {
    const bool starts_are_sought = std::all_of(experiment_.runs.begin(), experiment_.runs.end(),
                                               [](const Run& run) { return run.unknown_start && run.release.empty(); });
    for (const double part : {0.05, 0.15, 0.3, 0.5}) {
      if (starts_are_sought) {
        add_plain(fmt::format("the first {:.0f} % of the records are something else", 100 * part),
                  part_of_run("from", part), [part](Experiment& e, double) {
                    for (std::size_t r = 0; r < e.runs.size(); ++r) keep(e, r, part, 1.0);
                  });
        out_.back().leaves_out = CauseCandidate::LeavesOut::beginning;
      }
      add_plain(fmt::format("the last {:.0f} % of the records are something else", 100 * part),
                part_of_run("to", 1 - part), [part](Experiment& e, double) {
                  for (std::size_t r = 0; r < e.runs.size(); ++r) keep(e, r, 0.0, 1 - part);
                });
      out_.back().leaves_out = CauseCandidate::LeavesOut::end;
    }
  }

  /// Keeps a part of the readings of run r; time 0 is then where it begins.
  static void keep(Experiment& e, std::size_t r, double from, double to) {
    const double span = span_of(e.records[r]);
    double begin = std::numeric_limits<double>::infinity();
    for (Series& series : e.records[r].sensors) {
      leave_out({from * span, to * span}, series);
      if (!series.time.empty()) begin = std::min(begin, series.time.front());
    }
    if (from == 0 || !std::isfinite(begin)) return;
    for (Series& series : e.records[r].sensors) {
      for (double& t : series.time) t -= begin;
    }
    for (RunInput& input : e.runs[r].inputs) {
      move_input(
          input, [&](double t) { return t - begin; }, [](double v) { return v; });
    }
  }

  void add_lost_runs() {
    constexpr std::size_t most = 2;
    for (std::size_t i = 0; experiment_.runs.size() > 1 && i < std::min(most, worst_.size()); ++i) {
      const std::size_t r = worst_[i];
      add_plain(fmt::format("run \"{}\" is another motion", experiment_.runs[r].name), "leave the run out",
                [r](Experiment& e, double) {
                  e.runs.erase(e.runs.begin() + static_cast<std::ptrdiff_t>(r));
                  e.records.erase(e.records.begin() + static_cast<std::ptrdiff_t>(r));
                });
    }
  }

  const Experiment& experiment_;
  const std::vector<std::size_t>& worst_;
  double shortest_ = std::numeric_limits<double>::infinity();
  bool moves_ = true;  // in all runs
  std::vector<CauseCandidate> out_;
};

}  // namespace

std::vector<CauseCandidate> cause_candidates(const Experiment& experiment, const std::vector<std::size_t>& worst) {
  return Candidates(experiment, worst).run();
}

}  // namespace poise
