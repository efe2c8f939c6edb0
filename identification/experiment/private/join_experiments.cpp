#include "identification/experiment/private/join_experiments.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "identification/experiment/private/same_record.hpp"
#include "model/parameters.hpp"
#include "model/toml_reader.hpp"

namespace poise {
namespace {

bool same_units(const Units& a, const Units& b) {
  return a.length == b.length && a.force == b.force && a.mass == b.mass && a.angle == b.angle;
}

bool same_scene(const Scene& a, const Scene& b) {
  if (a.file != b.file) return false;
  for (const ParameterRow& row : parameter_table(a)) {
    if (value_at(a, row.place) != value_at(b, row.place)) return false;
  }
  return true;
}

bool same_sensor(const Sensor& a, const Sensor& b) {
  const auto name = [](const Sensor& s) { return s.quantity ? s.quantity->name : std::string(); };
  return name(a) == name(b) && a.on.kind == b.on.kind && a.on.body_a == b.on.body_a && a.on.body_b == b.on.body_b &&
         a.on.joint == b.on.joint && a.on.a == b.on.a && a.on.b == b.on.b && a.element == b.element &&
         a.stops == b.stops && a.axis == b.axis && a.slips == b.slips && a.by_time == b.by_time &&
         a.noise_known == b.noise_known && (a.noise == b.noise || !a.noise_known) && a.delay == b.delay &&
         a.least_delay == b.least_delay && a.most_delay == b.most_delay;
}

/// Whether a number of sensor k is unknown or known with a deviation.
bool is_scaled(const Experiment& part, std::size_t k) {
  const auto is_its = [&](const auto& number) { return number.of_sensor && number.of_sensor->sensor == k; };
  return std::any_of(part.unknowns.begin(), part.unknowns.end(), is_its) ||
         std::any_of(part.known.begin(), part.known.end(), is_its);
}

class Joining {
 public:
  Joining(std::string file, std::vector<Experiment> parts) : parts_(std::move(parts)) {
    out_.file = std::move(file);
    for (const Experiment& part : parts_) {
      names_.push_back(std::filesystem::path(part.file).stem().string());
      out_.parts.push_back({part.file, part.scene});
      simulated_.push_back(
          std::any_of(part.runs.begin(), part.runs.end(), [](const Run& r) { return r.is_simulated(); }));
    }
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (std::count(names_.begin(), names_.end(), names_[p]) == 1) continue;
      for (std::size_t q = 0; q < parts_.size(); ++q) names_[q] = parts_[q].file;
      break;
    }
    out_.scene = parts_.front().scene;
  }

  Experiment run() {
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      expect_same_units(p);
      const std::vector<std::size_t> sensors = add_sensors(p);
      for (const ParameterChange& change : parts_[p].changes) out_.changes.push_back(change);
      for (const Unknown& unknown : parts_[p].unknowns) add_unknown(p, unknown);
      for (const KnownNumber& known : parts_[p].known) add_known(p, known);
      add_runs(p, sensors);
    }
    for (Unknown& unknown : out_.unknowns) {
      const Unknown& first = *find_unknown(unknown.name);
      unknown.start = first.start;
      unknown.min = first.min;
      unknown.max = first.max;
      unknown.prior = first.prior;
      unknown.prior_deviation = first.prior_deviation;
      unknown.scale = first.scale;
    }
    for (Record& record : out_.records) {
      if (!record.sensors.empty()) record.sensors.resize(out_.sensors.size());
    }
    return std::move(out_);
  }

 private:
  void expect_same_units(std::size_t p) const {
    if (same_units(parts_[p].scene.units, parts_[0].scene.units)) return;
    throw InputError(fmt::format("{}:1: units: expected those of {} in all scenes of one fit; write the same [units]",
                                 parts_[p].scene.file, parts_[0].scene.file));
  }

  /// Which sensors of the whole those of a part are.
  std::vector<std::size_t> add_sensors(std::size_t p) {
    std::vector<std::size_t> places;
    for (const Sensor& sensor : parts_[p].sensors) {
      bool alone = true;
      std::size_t place = out_.sensors.size();
      for (std::size_t q = 0; q < parts_.size(); ++q) {
        if (q == p) continue;
        const std::vector<Sensor>& others = parts_[q].sensors;
        const auto other =
            std::find_if(others.begin(), others.end(), [&](const Sensor& s) { return s.name == sensor.name; });
        if (other == others.end()) continue;
        const bool scaled = is_scaled(parts_[p], places.size()) ||
                            is_scaled(parts_[q], static_cast<std::size_t>(other - others.begin()));
        // What is unknown or uncertain of a column is so of columns that were converted alike.
        const bool converted_alike = sensor.zero == other->zero && sensor.unit == other->unit;
        if (!same_sensor(sensor, *other) || !same_scene(parts_[p].scene, parts_[q].scene) ||
            (scaled && !converted_alike)) {
          alone = false;
        } else if (q < p) {
          place = places_[q][static_cast<std::size_t>(other - others.begin())];
        }
      }
      places.push_back(place);
      if (place < out_.sensors.size()) continue;
      out_.sensors.push_back(sensor);
      if (!alone) out_.sensors.back().name += " (" + names_[p] + ")";
    }
    places_.push_back(places);
    return places;
  }

  /// The first of that name.
  std::vector<Unknown>::iterator find_unknown(const std::string& name) {
    return std::find_if(out_.unknowns.begin(), out_.unknowns.end(),
                        [&](const Unknown& unknown) { return unknown.name == name; });
  }

  /// Makes a number of a sensor of a part one of the whole. A sensor of another name is another one, with numbers of
  /// its own.
  template <class Number>
  void place_sensor(std::size_t p, Number& number) const {
    if (!number.of_sensor) return;
    const std::string& own = parts_[p].sensors[number.of_sensor->sensor].name;
    number.of_sensor->sensor = places_[p][number.of_sensor->sensor];
    number.path.replace(std::string_view("sensor.").size(), own.size(), out_.sensors[number.of_sensor->sensor].name);
  }

  void add_unknown(std::size_t p, Unknown unknown) {
    unknown.part = p;
    const bool by_path = unknown.name == unknown.path;
    place_sensor(p, unknown);
    if (by_path) unknown.name = unknown.path;
    const auto first = find_unknown(unknown.name);
    if (first != out_.unknowns.end()) reconcile(*first, unknown);
    out_.unknowns.push_back(std::move(unknown));
  }

  /// Makes the first of the unknowns of one name what is known of both.
  void reconcile(Unknown& first, const Unknown& other) const {
    const std::string& here = parts_[other.part].file;
    const std::string& there = parts_[first.part].file;
    const auto fail = [&](const std::string& key, const std::string& expected) {
      const std::string item = fmt::format("unknown \"{}\"{}", other.name, key.empty() ? "" : "." + key);
      TomlPlace{here, other.line, item}.fail(fmt::format("expected {}, which is the same number in {}:{}; {}", expected,
                                                         there, first.line,
                                                         "make them agree, or give one of them another name"));
    };
    const Dimension a = dimension_of(out_, first);
    const Dimension b = dimension_of(out_, other);
    const auto exponents = [](const Dimension& d) { return std::array{d.mass, d.force, d.length, d.angle, d.time}; };
    if (exponents(a) != exponents(b)) fail("path", "the dimension of " + first.path);
    if (first.per != other.per) fail("per", first.per.empty() ? "none" : "\"" + first.per + "\"");
    const double unit = first.unit;
    if (first.includes != other.includes) fail("includes", fmt::format("{:.12g}", first.includes / unit));
    if (first.start && other.start && *first.start != *other.start) {
      fail("start", fmt::format("{:.12g}", *first.start / unit));
    }
    const bool same_prior = first.prior == other.prior && first.prior_deviation == other.prior_deviation;
    if (first.prior && other.prior && !same_prior) {
      fail("prior", fmt::format("[{:.12g}, {:.12g}]", *first.prior / unit, first.prior_deviation / unit));
    }
    const double value = written_value(out_, first);
    const bool same_value = written_value(out_, other) == value;
    if (!same_value && !first.start && !other.start)
      fail("", fmt::format("a start, or {:.12g} in the scene", value / unit));
    if (!same_value && (simulated_[first.part] || simulated_[other.part])) {
      fail("", fmt::format("{:.12g} in the scene of a simulation", value / unit));
    }
    if (first.scale && other.scale && *first.scale != *other.scale) {
      fail("scale", fmt::format("{:.12g}", *first.scale / unit));
    }
    if (!first.scale) first.scale = other.scale;
    if (!first.start) first.start = other.start;
    if (!first.prior) std::tie(first.prior, first.prior_deviation) = std::tie(other.prior, other.prior_deviation);
    first.min = std::max(first.min, other.min);
    first.max = std::min(first.max, other.max);
    const double start = first.start.value_or(value + first.includes);
    if (!(first.min < first.max) || start < first.min || start > first.max) {
      fail("", fmt::format("a range with the start {:.12g} in common with the one", start / unit));
    }
  }

  void add_known(std::size_t p, KnownNumber known) {
    known.part = p;
    place_sensor(p, known);
    for (const KnownNumber& other : out_.known) {
      if (other.path != known.path) continue;
      if (other.deviation == known.deviation && other.relative == known.relative && other.per == known.per) continue;
      TomlPlace{parts_[p].file, known.line, "known \"" + known.path + "\""}.fail(
          fmt::format("expected the deviation and per of the same number in {}:{}; make them agree",
                      parts_[other.part].file, other.line));
    }
    out_.known.push_back(std::move(known));
  }

  /// Readings that count twice would make the estimates look better than they are.
  void expect_own_readings(const Run& run) const {
    for (const Run& other : out_.runs) {
      if (run.is_simulated() || other.data != run.data || other.segment != run.segment) continue;
      for (const std::size_t k : run.sensors) {
        const auto same = [&](std::size_t i) { return out_.sensors[i].column == out_.sensors[k].column; };
        if (std::none_of(other.sensors.begin(), other.sensors.end(), same)) continue;
        TomlPlace{parts_[run.part].file, run.line, "run \"" + run.name + "\""}.fail(fmt::format(
            "expected the column \"{}\" of its data once, run \"{}\" reads it too; leave one of the runs out",
            out_.sensors[k].column, other.name));
      }
    }
  }

  /// The same of the last run, of a copy under another name.
  void expect_own_record() const {
    const Run& run = out_.runs.back();
    for (std::size_t r = 0; r + 1 < out_.runs.size(); ++r) {
      if (!same_record(out_.records[r], out_.records.back())) continue;
      TomlPlace{parts_[run.part].file, run.line, "run \"" + run.name + "\""}.fail(
          "expected readings of its own, all are those of run \"" + out_.runs[r].name + "\"; leave one of the two out");
    }
  }

  void add_runs(std::size_t p, const std::vector<std::size_t>& sensors) {
    for (std::size_t r = 0; r < parts_[p].runs.size(); ++r) {
      Run run = std::move(parts_[p].runs[r]);
      run.part = p;
      run.name = names_[p] + ": " + run.name;
      std::vector<std::size_t> read;
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        if (run.reads(k)) read.push_back(sensors[k]);
      }
      std::sort(read.begin(), read.end());
      run.sensors = std::move(read);
      expect_own_readings(run);
      out_.runs.push_back(std::move(run));
      Record& record = out_.records.emplace_back();
      std::vector<Series>& series = parts_[p].records[r].sensors;
      if (series.empty()) continue;
      record.sensors.resize(out_.sensors.size());
      for (std::size_t k = 0; k < series.size(); ++k) record.sensors[sensors[k]] = std::move(series[k]);
      expect_own_record();
    }
  }

  std::vector<Experiment> parts_;
  std::vector<std::string> names_;
  std::vector<bool> simulated_;                   // per part, whether a run of it is
  std::vector<std::vector<std::size_t>> places_;  // per part, per sensor of it: which it is in the whole
  Experiment out_;
};

}  // namespace

Experiment join_experiments(std::string file, std::vector<Experiment> parts) {
  return Joining(std::move(file), std::move(parts)).run();
}

}  // namespace poise
