#include "identification/experiment/private/read_runs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "identification/experiment/pieces.hpp"
#include "identification/experiment/private/read_inputs.hpp"
#include "identification/experiment/private/run_data.hpp"
#include "identification/experiment/private/run_keys.hpp"
#include "identification/experiment/private/same_record.hpp"
#include "model/dependent_number.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "model/read_parameter_changes.hpp"

namespace poise {
namespace {
namespace fs = std::filesystem;

constexpr std::size_t least_run_readings = 3, least_piece_readings = 12;

/// A [[run]] as written; one whose data files are split becomes many runs.
struct RunTable {
  Run run;
  RunSource source;
  std::vector<InputTable> inputs;
  bool measured = false;
  double piece = INFINITY;  // s, about which the pieces last that its records are cut into
  TomlPlace piece_place{};
};

class RunsReader {
 public:
  RunsReader(const TomlTable& root, const SceneNames& names, Experiment& experiment)
      : tables_(root.tables("run")), rests_too_(root.has("static")), names_(names), experiment_(experiment) {
    if (tables_.empty() && !root.has("static")) root.place().fail("run: expected at least one run; add [[run]]");
  }

  void read(const fs::path& folder, const fs::path& data) {
    std::vector<std::string> defaults;
    for (const TomlTable& table : tables_) {
      defaults.push_back(table.has("split") ? "segment" : "run " + std::to_string(defaults.size() + 1));
    }
    const std::vector<std::string> names = names_of({tables_.begin(), tables_.end()}, defaults, {});
    std::vector<RunTable> runs;
    for (std::size_t i = 0; i < tables_.size(); ++i) {
      runs.push_back(read_run(tables_[i], folder));
      runs.back().run.name = names[i];
    }
    if (!data.empty()) take_data_from(data, runs);
    for (RunTable& written : runs) {
      if (!written.measured) continue;
      for (const DataFile& file : written.source.files) {
        if (file.replaceable) written.run.data.push_back(file.path);
      }
    }
    DataFiles files;
    for (RunTable& written : runs) {
      if (!written.source.files.empty()) files.want(written.source);
    }
    for (RunTable& written : runs) add(std::move(written), files);
  }

 private:
  RunTable read_run(const TomlTable& table, const fs::path& folder) {
    RunTable written;
    Run& run = written.run;
    run.line = table.place().line;
    if (table.has("data")) {
      expect_none(table, {"duration", "rate", "seed"},
                  "of a simulated run only, this one has data; leave it out, or leave data out to simulate");
      table.allow_keys({"name", "set", "labels", "rest", "release", "release_rate", "start_known", "sensors", "inputs",
                        "data", "time", "time_factor", "split", "segments", "every", "from", "to", "skip", "piece"});
      written.measured = true;
      written.source = read_source(table, folder);
      read_kept(table, written.source);
      run.time_column = written.source.files.front().time;
      run.states_time_factor = read_time_factors(table, written.source);
    } else {
      expect_none(table, {"time", "time_factor", "split", "segments", "every", "from", "to", "skip", "piece"},
                  "of a measured run only, this one has no data; leave it out, or add data = \"...\"");
      table.allow_keys({"name", "set", "labels", "rest", "release", "release_rate", "start_known", "sensors", "inputs",
                        "data", "duration", "rate", "seed"});
      read_simulation(table, run);
    }
    read_sensors(table, experiment_, rests_too_, run);
    if (written.measured) want_columns(run, written.source);
    Scene scene = experiment_.scene;
    run.changes = read_parameter_changes(table, scene);
    read_labels(table, run);
    if (const auto equilibrium = table.find_table("rest")) run.equilibrium = read_equilibrium(*equilibrium, scene);
    read_release(table, "release", false, run);
    read_release(table, "release_rate", true, run);
    run.unknown_start = !table.flag("start_known", false);
    written.source.begins_at_first_row = !run.unknown_start;
    written.inputs = read_inputs(table, folder, scene, written.measured, written.source);
    if (table.has("piece")) {
      written.piece = read_piece(table, run);
      written.piece_place = table.place_of("piece");
    }
    return written;
  }

  /// Pieces begin at states, and times, of their own.
  double read_piece(const TomlTable& table, const Run& run) const {
    const TomlPlace place = table.place_of("piece");
    const auto fail = [&](const char* what) {
      place.fail(fmt::format("expected no pieces of a run {}; leave it out", what));
    };
    if (!run.unknown_start) fail("whose start is known");
    if (!experiment_.scene.time_functions.empty()) fail("of a scene with functions of time, which begin with the run");
    for (const std::size_t k : sensors_of(run)) {
      if (experiment_.sensors[k].reads_impacts()) fail("whose impacts are counted from its start");
    }
    return table.number("piece", 1.0, Range::positive);
  }

  /// The sensors that are read in a run, as indices.
  std::vector<std::size_t> sensors_of(const Run& run) const {
    if (!run.sensors.empty()) return run.sensors;
    std::vector<std::size_t> all(experiment_.sensors.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }

  void want_columns(const Run& run, RunSource& source) const {
    for (const std::size_t k : sensors_of(run)) {
      const Sensor& sensor = experiment_.sensors[k];
      const bool lists_times = sensor.reads_impacts();
      source.columns.push_back({.name = sensor.column,
                                .wanted_by = {experiment_.file, sensor.line, "sensor \"" + sensor.name + "\""},
                                .gaps = sensor.gaps || lists_times,
                                .missing = sensor.missing.value_or(std::vector<double>()),
                                .begins = !lists_times,
                                .lists_times = lists_times});
    }
  }

  /// One string, or a list of them.
  static std::vector<TomlText> text_or_texts(const TomlTable& table, std::string_view key) {
    if (table.holds_list(key)) return table.texts(key);
    return {table.text(key)};
  }

  static void expect_one_or_each(const TomlPlace& place, const char* what, std::size_t found, const RunSource& source) {
    if (found == 1 || found == source.files.size()) return;
    place.fail(fmt::format("expected one {}, or one for each of the {} data files, found {}", what, source.files.size(),
                           found));
  }

  static RunSource read_source(const TomlTable& table, const fs::path& folder) {
    RunSource source;
    source.place = table.place_of("data");
    for (const TomlText& name : text_or_texts(table, "data")) {
      if (name.value.empty()) name.place.fail("expected the path of a data file, relative to this file");
      const fs::path path = (folder / name.value).lexically_normal();
      for (const DataFile& other : source.files) {
        if (other.path == path) name.place.fail("expected each file once, found \"" + name.value + "\" again");
      }
      source.files.push_back({path, "time", 1.0, name.place});
    }
    if (source.files.empty()) source.place.fail("expected the path of a data file; leave the key out to simulate");
    if (table.has("time")) {
      const std::vector<TomlText> times = text_or_texts(table, "time");
      expect_one_or_each(table.place_of("time"), "column", times.size(), source);
      for (std::size_t f = 0; f < source.files.size(); ++f) {
        source.files[f].time = times[times.size() > 1 ? f : 0].value;
      }
    }
    source.segments = table.texts("segments");
    if (const auto split = table.find_text("split")) {
      if (split->value.empty()) split->place.fail("expected the name of a column");
      source.split = split->value;
    }
    if (table.has("segments")) {
      if (source.split.empty()) {
        table.place_of("segments").fail("expected the key split as well, the column that names the segments");
      }
      if (source.segments.empty()) table.place_of("segments").fail("expected a segment; leave the key out for all");
    }
    source.every = static_cast<std::size_t>(table.whole_number("every", 1, 1));
    return source;
  }

  /// The part of the record that is read:  from = 1.2, to = 8, skip = [[3.1, 3.4], ...].
  static void read_kept(const TomlTable& table, RunSource& source) {
    source.kept.from = table.find_number("from", 1.0, Range::finite).value_or(source.kept.from);
    source.kept.to = table.find_number("to", 1.0, Range::finite).value_or(source.kept.to);
    if (!(source.kept.from < source.kept.to)) {
      table.place_of(table.has("to") ? "to" : "from").fail("expected to > from; exchange them");
    }
    if (!table.has("skip")) return;
    for (const TomlTable::Pair& span : table.pairs("skip", 1.0, 1.0)) {
      if (!(span.value.x <= span.value.y)) span.place.fail("expected [FROM, TO], TO >= FROM; exchange them");
      source.skip.push_back({span.value.x, span.value.y});
    }
  }

  /// One for all data files, or one for each. Whether there are any.
  static bool read_time_factors(const TomlTable& table, RunSource& source) {
    if (!table.has("time_factor")) return false;
    const bool is_list = table.holds_list("time_factor");
    const std::vector<double> factors =
        is_list ? table.numbers("time_factor") : std::vector{table.number("time_factor", 1.0, Range::positive)};
    expect_one_or_each(table.place_of("time_factor"), "number", factors.size(), source);
    for (std::size_t f = 0; f < source.files.size(); ++f) {
      const double factor = factors[factors.size() > 1 ? f : 0];
      if (!(factor > 0)) {
        table.place_of("time_factor").fail(fmt::format("expected numbers > 0, seconds per unit, found {:.6g}", factor));
      }
      source.files[f].time_factor = factor;
    }
    return true;
  }

  static void read_simulation(const TomlTable& table, Run& run) {
    constexpr double most_samples = 1e7;
    for (const char* const key : {"duration", "rate"}) {
      if (table.has(key)) continue;
      table.place().fail("expected the key data, or duration and rate of a simulation; add " + std::string(key) +
                         " = NUMBER");
    }
    run.duration = table.number("duration", 1.0, Range::positive);
    run.sample_rate = table.number("rate", 1.0, Range::positive);
    run.seed = static_cast<std::uint64_t>(table.whole_number("seed", 0, 0));
    // Readings at 0, 1/rate, ..., duration: three at least.
    if (run.duration * run.sample_rate < 2.0) {
      table.place_of("duration").fail("expected duration rate >= 2, for at least 3 readings; raise one of them");
    }
    if (run.duration * run.sample_rate > most_samples) {
      table.place_of("duration").fail("expected duration rate <= 1e7 readings; lower one of them");
    }
  }

  EquilibriumPose read_equilibrium(const TomlTable& table, const Scene& scene) const {
    table.allow_keys({"angle", "travel", "at", "by", "known"});
    if (table.has("angle") + table.has("travel") != 1) {
      table.place().fail("expected one of the keys angle = \"BODY\", travel = \"JOINT\"");
    }
    EquilibriumPose equilibrium;
    equilibrium.line = table.place().line;
    const bool is_angle = table.has("angle");
    if (is_angle) {
      equilibrium.body = names_.movable_body(table.text("angle"));
    } else {
      equilibrium.joint = names_.travelling_joint(table.text("travel"));
    }
    equilibrium.at = table.number("at", is_angle ? scene.units.angle : scene.units.length, Range::finite);
    equilibrium.by = read_spring_number(table.text("by"), scene);
    equilibrium.unknown = !table.flag("known", false);
    return equilibrium;
  }

  /// The path of the free length of a line spring, or the free angle of a torsion spring.
  static std::string read_spring_number(const TomlText& path, const Scene& scene) {
    std::vector<std::string> valid;
    for (const ParameterRow& row : parameter_table(scene)) {
      const std::string_view number = row.path.parts[3];
      // The equilibrium is linear in it, so that RunModel finds it in one step.
      const bool linear =
          row.place.owner == Owner::element &&
          std::holds_alternative<LinearSpring>(scene.elements[static_cast<std::size_t>(row.place.item)].law);
      if (linear && dependent_number(scene, row.place) == nullptr &&
          (number == "free_length" || number == "free_angle")) {
        valid.push_back(row.path.text());
      }
    }
    if (std::find(valid.begin(), valid.end(), path.value) == valid.end()) {
      path.place.fail("expected spring.NAME.free_length or torsion_spring.NAME.free_angle, found \"" + path.value +
                      "\"" + did_you_mean_or_list(path.value, valid));
    }
    return path.value;
  }

  void read_release(const TomlTable& owner, std::string_view key, bool rate, Run& run) const {
    const auto table = owner.find_table(key);
    if (!table) return;
    for (const std::string& name : table->keys()) {
      const TomlPlace place = table->place_of(name);
      if (table->holds_table(name)) place.fail("expected a number; put a name that holds dots in quotes");
      Release release;
      release.rate = rate;
      release.line = place.line;
      release.body = names_.index_of_body(name);
      release.joint = names_.index_of_joint(name);
      const bool turns = release.body > 0;
      const bool travels = release.joint >= 0 && experiment_.scene.joints[release.joint].has_travel();
      if (!turns && !travels) {
        std::vector<std::string> valid = names_.movable_body_names();
        for (std::string& other : names_.travelling_joint_names()) valid.push_back(std::move(other));
        place.fail("expected the name of a body, slide or pin_in_slot" + did_you_mean_or_list(name, valid));
      }
      const Units& units = experiment_.scene.units;
      release.value = table->number(name, turns ? units.angle : units.length, Range::finite);
      run.release.push_back(release);
    }
  }

  static void take_data_from(const fs::path& data, std::vector<RunTable>& runs) {
    const fs::path* named = nullptr;
    for (const RunTable& written : runs) {
      for (const DataFile& file : written.source.files) {
        if (!file.replaceable) continue;
        if (named != nullptr && file.path != *named) {
          written.source.place.fail("expected all runs to name one data file, for --data to take its place");
        }
        named = &file.path;
      }
    }
    if (named == nullptr) {
      throw InputError("--data " + data.string() + ": expected an experiment with measured runs; give one a data file");
    }
    for (RunTable& written : runs) {
      for (DataFile& file : written.source.files) {
        if (file.replaceable) file.path = data;
      }
    }
  }

  void add(RunTable written, DataFiles& files) {
    const RunSource& source = written.source;
    if (source.files.empty()) {
      check_delays(written.run, written.run.duration);
      add_run(std::move(written.run), {});
      return;
    }
    for (RunData& data : files.read(source)) {
      Run run = written.run;
      if (written.measured && !run.states_time_factor) expect_no_row_numbers(source, data);
      if (data.segment) run.name += " " + *data.segment;
      run.segment = data.segment;
      Piece whole;
      std::size_t column = 0;
      if (written.measured) {
        whole.record.sensors.resize(experiment_.sensors.size());
        for (const std::size_t k : sensors_of(run)) {
          const Sensor& sensor = experiment_.sensors[k];
          Series& series = whole.record.sensors[k];
          series = in_si(std::move(data.columns[column++]), sensor.zero, sensor.unit);
          if (!sensor.reads_angle()) continue;
          make_continuous({experiment_.file, sensor.line, "sensor \"" + sensor.name + "\""}, sensor.wraps, sensor.unit,
                          run.name, series);
        }
        expect_readings(whole.record, run, source);
        expect_own_columns(run, source);
      }
      for (const InputTable& table : written.inputs) {
        Series& series = whole.inputs.emplace_back(in_si(std::move(data.columns[column++]), table.zero, table.unit));
        if (table.is_angle) make_continuous(table.place, table.wraps, table.unit, run.name, series);
      }
      const double end = end_of(whole.record, run);
      std::vector<Piece> pieces = pieces_of(std::move(whole), written.piece, end);
      for (Piece& piece : pieces) {
        Run own = run;
        own.clock_zero = data.clock_zero + piece.zero;
        if (pieces.size() > 1) {
          own.labels.emplace_back("run", run.name);  // a number per run is one for all of them
          own.name += fmt::format(" from {:.6g} s", own.clock_zero);
          if (piece.zero > 0) own.release.clear();
          own.states_time_factor = true;  // pieces may be short beside the periods that check_spans() looks for
          if (piece.record.count() < least_piece_readings) {
            written.piece_place.fail(
                fmt::format("expected pieces with at least {} readings, {} has {}; make them longer",
                            least_piece_readings, own.name, piece.record.count()));
          }
        }
        add(written, std::move(own), std::move(piece));
      }
    }
  }

  void add(const RunTable& written, Run run, Piece piece) {
    const RunSource& source = written.source;
    const double end = end_of(piece.record, run);
    std::size_t column = written.measured ? sensors_of(run).size() : 0;
    for (std::size_t i = 0; i < written.inputs.size(); ++i) {
      run.inputs.push_back(input_of(written.inputs[i], std::move(piece.inputs[i]), run.name, end));
      run.inputs.back().file = source.files[*source.columns[column++].file].path;
    }
    check_delays(run, end);
    if (written.measured) leave_out_of(run, piece.record, end);
    if (written.measured) expect_own_record(run, piece.record, source);
    add_run(std::move(run), std::move(piece.record));
  }

  /// Returns the time of the last reading, s, or the duration of a simulated run.
  static double end_of(const Record& record, const Run& run) {
    double end = run.duration;
    for (const Series& series : record.sensors) {
      if (!series.time.empty()) end = std::max(end, series.time.back());
    }
    return end;
  }

  static void expect_readings(const Record& record, const Run& run, const RunSource& source) {
    if (record.count() >= least_run_readings) return;
    source.place.fail("expected at least 3 readings in run \"" + run.name + "\", found " +
                      std::to_string(record.count()) + ", all others are gaps or left out; leave the run out");
  }

  /// Whole numbers in steps of one are seldom seconds.
  static void expect_no_row_numbers(const RunSource& source, const RunData& data) {
    constexpr std::size_t least_rows = 20;
    for (std::size_t c = 0; c < data.columns.size(); ++c) {
      const std::vector<double>& time = data.columns[c].time;
      if (source.every > 1 || source.columns[c].lists_times || time.size() < least_rows) continue;
      const auto is_next = [](double before, double after) { return after - before != 1.0; };
      if (std::adjacent_find(time.begin(), time.end(), is_next) != time.end()) continue;
      const DataFile& file = source.files[*source.columns[c].file];
      source.place.fail(
          fmt::format("expected seconds in the column \"{}\" of \"{}\", found {:g}, {:g}, {:g}, ... as the numbers of "
                      "readings are; "
                      "add time_factor = SECONDS from one reading to the next, or time_factor = 1 if they are seconds",
                      file.time, file.path.filename().string(), data.clock_zero + time[0], data.clock_zero + time[1],
                      data.clock_zero + time[2]));
    }
  }

  /// Readings that count twice would make the estimates look better than they are.
  void expect_own_columns(const Run& run, const RunSource& source) {
    const std::vector<std::size_t> sensors = sensors_of(run);
    for (std::size_t i = 0; i < sensors.size(); ++i) {
      const DataColumn& column = source.columns[i];
      const fs::path& file = source.files[*column.file].path;
      const std::string& sensor = experiment_.sensors[sensors[i]].name;
      std::vector<ReadColumn>& readers = columns_[std::tuple(file, run.segment, column.name)];
      for (const ReadColumn& other : readers) {
        if (other.kept.to < source.kept.from || source.kept.to < other.kept.from) continue;
        const std::string read = fmt::format("the column \"{}\" of \"{}\" once", column.name, file.filename().string());
        if (other.run != run.name) {
          source.place.fail(fmt::format(
              "expected {}, run \"{}\" reads it too; leave one of the runs out, or part them with from and to", read,
              other.run));
        }
        TomlPlace{experiment_.file, experiment_.sensors[sensors[i]].line, "sensor \"" + sensor + "\""}.fail(
            fmt::format("expected {}, sensor \"{}\" reads it too; leave one of the two out, or give it its own column",
                        read, other.sensor));
      }
      readers.push_back({run.name, sensor, source.kept});
    }
  }

  /// The same of a copy under another name.
  void expect_own_record(const Run& run, const Record& record, const RunSource& source) const {
    for (std::size_t r = 0; r < experiment_.runs.size(); ++r) {
      if (!same_record(experiment_.records[r], record)) continue;
      source.place.fail(
          fmt::format("expected runs with readings of their own, all of run \"{}\" are those of run \"{}\"; leave one "
                      "of the two out",
                      run.name, experiment_.runs[r].name));
    }
  }

  /// Delays must be shorter than the run, and leave readings of it.
  void check_delays(const Run& run, double end) const {
    for (const std::size_t k : sensors_of(run)) {
      const Sensor& sensor = experiment_.sensors[k];
      const bool late = sensor.most_delay >= end;
      if (!late && -sensor.least_delay < end) continue;
      const double found = late ? sensor.most_delay : sensor.least_delay;
      TomlPlace{experiment_.file, sensor.line, "sensor \"" + sensor.name + "\".delay"}.fail(
          fmt::format("expected delays shorter than run \"{}\" of {:.6g} s, found {}", run.name, end,
                      found == sensor.delay
                          ? fmt::format("{:.6g} s; correct it, or leave the run out", found)
                          : fmt::format("{} = {:.6g} s where it is unknown; narrow min and max, or leave the run out",
                                        late ? "max" : "min", found)));
    }
    if (!run.is_simulated()) return;
    std::size_t left = 0;
    std::size_t all = 0;
    for (const std::size_t k : sensors_of(run)) {
      if (experiment_.sensors[k].reads_impacts()) continue;
      left += simulated_times(experiment_, run, k).size();
      all += static_cast<std::size_t>(std::llround(run.duration * run.sample_rate));
    }
    if (left < least_run_readings && left < all) fail_left_out(run, left);
  }

  void leave_out_of(Run& run, Record& record, double end) const {
    for (std::size_t k = 0; k < record.sensors.size(); ++k) {
      run.left_out += leave_out(compared_times(experiment_, run, k, end), record.sensors[k]);
    }
    if (record.count() < least_run_readings) fail_left_out(run, record.count());
  }

  [[noreturn]] void fail_left_out(const Run& run, std::size_t left) const {
    TomlPlace{experiment_.file, run.line, "run \"" + run.name + "\""}.fail(
        fmt::format("expected at least 3 readings, found {} at which the motion is known for all delays that its "
                    "sensors may have; narrow min and max of the delays, or leave the run out",
                    left));
  }

  static Series in_si(Series series, double zero, double unit) {
    for (double& value : series.value) value = zero + unit * value;
    return series;
  }

  void add_run(Run run, Record record) {
    // Names of tables are unique, but not always with the segment's value behind.
    const auto [other, is_new] = taken_.emplace(run.name, run.line);
    if (!is_new) {
      TomlPlace{experiment_.file, run.line, "run \"" + run.name + "\""}.fail(
          "expected a name of its own, it is taken in line " + std::to_string(other->second) + "; rename the run");
    }
    experiment_.runs.push_back(std::move(run));
    experiment_.records.push_back(std::move(record));
  }

  std::vector<TomlTable> tables_;
  bool rests_too_;
  const SceneNames& names_;
  Experiment& experiment_;
  NameLines taken_;
  /// Who reads a column, and which part of it.
  struct ReadColumn {
    std::string run, sensor;
    TimeSpan kept;
  };
  std::map<std::tuple<fs::path, std::optional<std::string>, std::string>, std::vector<ReadColumn>> columns_;
};

}  // namespace

void read_runs(const TomlTable& root, const SceneNames& names, const fs::path& folder, const fs::path& data,
               Experiment& experiment) {
  RunsReader(root, names, experiment).read(folder, data);
}

}  // namespace poise
