#include "identification/experiment/private/read_static_runs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "identification/experiment/private/run_keys.hpp"
#include "identification/experiment/private/same_record.hpp"
#include "model/csv_table.hpp"
#include "model/dependent_number.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "model/read_parameter_changes.hpp"
#include "model/scene_names.hpp"
#include "statics/model/static_numbers.hpp"

namespace poise {
namespace {
namespace fs = std::filesystem;

constexpr long long most_rows = 10'000;

/// An input as written: its numbers, or the column that has them.
struct WrittenInput {
  RowInput input;
  std::string column;
  TomlPlace place;
};

class StaticRunsReader {
 public:
  StaticRunsReader(const TomlTable& root, const fs::path& folder, Experiment& experiment)
      : tables_(root.tables("static")), folder_(folder), experiment_(experiment) {}

  void read() {
    std::vector<std::string> defaults;
    for (std::size_t i = 1; i <= tables_.size(); ++i) defaults.push_back("static " + std::to_string(i));
    NameLines taken;
    for (const Run& run : experiment_.runs) taken.emplace(run.name, run.line);
    const std::vector<std::string> names = names_of(tables_, defaults, taken);
    for (std::size_t i = 0; i < tables_.size(); ++i) add(tables_[i], names[i]);
  }

 private:
  void add(const TomlTable& table, const std::string& name) {
    Run run;
    run.name = name;
    run.line = table.place().line;
    run.rows = 1;  // as a run at rest has, for read_sensors()
    run.unknown_start = false;
    table.allow_keys({"name", "set", "labels", "sensors", "inputs", "data", "every", "readings", "repeat", "seed"});
    read_sensors(table, experiment_, true, run);
    if (run.sensors.empty()) {
      for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) run.sensors.push_back(k);
    }
    read_labels(table, run);
    Scene scene = experiment_.scene;
    run.changes = read_parameter_changes(table, scene);
    if (!scene.time_functions.empty()) {
      table.place().fail(
          "expected a scene whose numbers are the same at all times, it has a function of time; leave that out, or "
          "give the readings at rest an experiment of their own");
    }
    std::vector<WrittenInput> inputs = read_inputs(table, scene, run);
    Record record;
    if (table.has("data") && table.has("readings")) {
      table.place_of("readings").fail("expected either data or readings, found both; take one of them out");
    }
    if (table.has("data")) {
      record = read_file(table, inputs, run);
    } else {
      expect_none(table, {"every"}, "of a run with data only; leave it out");
      for (const WrittenInput& input : inputs) {
        if (input.column.empty()) continue;
        input.place.fail("expected the numbers of the rows, the run has no data whose column \"" + input.column +
                         "\" would be; write [NUMBER, ...]");
      }
      if (table.has("readings")) {
        record = read_readings(table, inputs, run);
      } else {
        set_rows(table, inputs, run);
      }
    }
    for (WrittenInput& input : inputs) {
      check_values(input, scene);
      run.row_inputs.push_back(std::move(input.input));
    }
    if (!record.empty()) expect_own_record(table, run, record);
    experiment_.runs.push_back(std::move(run));
    experiment_.records.push_back(std::move(record));
  }

  // --- inputs -------------------------------------------------------------------------------------------------------

  static std::vector<WrittenInput> read_inputs(const TomlTable& table, const Scene& scene, const Run& run) {
    std::vector<WrittenInput> out;
    const auto inputs = table.find_table("inputs");
    if (!inputs) return out;
    for (const std::string& path : inputs->keys()) {
      WrittenInput& written = out.emplace_back();
      written.place = inputs->place_of(path);
      written.input.path = path;
      written.input.line = written.place.line;
      if (inputs->holds_table(path)) written.place.fail("expected a column or [NUMBER, ...]; put the path in quotes");
      written.input.drive = find_drive(scene, path);
      if (written.input.drive < 0) check_number(written, scene);
      for (const ParameterChange& change : run.changes) {
        if (change.path == path)
          written.place.fail("expected a number that set does not give; take one of the two out");
      }
      if (inputs->holds_list(path)) {
        written.input.values = inputs->numbers(path);
        if (written.input.values.empty()) written.place.fail("expected a number for each row");
      } else {
        written.column = inputs->text(path).value;
        if (written.column.empty()) written.place.fail("expected the name of a column");
      }
    }
    return out;
  }

  static int find_drive(const Scene& scene, const std::string& path) {
    for (std::size_t d = 0; d < scene.drives.size(); ++d) {
      if (path == "drive." + scene.drives[d].name) return static_cast<int>(d);
    }
    return -1;
  }

  /// An equilibrium must depend on it.
  static void check_number(const WrittenInput& written, const Scene& scene) {
    const std::string& path = written.input.path;
    const ParameterRow row = located(written.place, [&] { return parameter(scene, path); });
    located(written.place, [&] { check_is_free(scene, row); });
    if (!acts_in_statics(scene, row.place)) {
      written.place.fail(
          "expected a number that equilibria depend on, as load.NAME, body.NAME.mass or spring.NAME.free_length, or "
          "drive.NAME for a position that is held");
    }
    if (row.place.owner == Owner::stop && scene.stops[static_cast<std::size_t>(row.place.item)].holds()) {
      written.place.fail(
          "expected a stop with a lower and an upper limit, this one holds its measure; replace it by a drive, whose "
          "positions drive.NAME gives");
    }
    if (row.place.owner == Owner::force &&
        scene.forces[static_cast<std::size_t>(row.place.item)].line_of_action() == Vec2{}) {
      written.place.fail(
          "expected a force with a direction, its vector is [0, 0]; give it a direction and a size in the scene");
    }
  }

  /// The scene must be able to have each of its values.
  void check_values(const WrittenInput& written, const Scene& scene) const {
    if (written.input.drive >= 0) return;
    for (std::size_t i = 0; i < written.input.values.size(); ++i) {
      Scene changed = scene;
      located({written.place.file, written.place.line, fmt::format("{}, row {}", written.place.item, i + 1)},
              [&] { set_value(changed, written.input.path, written.input.values[i]); });
    }
  }

  // --- readings -----------------------------------------------------------------------------------------------------

  /// Rows of a simulated run: those of its inputs, each so often.
  static void set_rows(const TomlTable& table, std::vector<WrittenInput>& inputs, Run& run) {
    run.seed = static_cast<std::uint64_t>(table.whole_number("seed", 0, 0));
    const std::size_t rows = inputs.empty() ? 1 : inputs.front().input.values.size();
    for (const WrittenInput& input : inputs) expect_rows(input.place, input.input.values.size(), rows);
    const long long repeat = table.whole_number("repeat", 1, 1);
    if (repeat > most_rows || static_cast<long long>(rows) * repeat > most_rows) {
      table.place().fail(fmt::format("expected at most {} rows; shorten the lists or lower repeat", most_rows));
    }
    run.rows = rows * static_cast<std::size_t>(repeat);
    for (WrittenInput& input : inputs) {
      const std::vector<double> once = input.input.values;
      for (long long i = 1; i < repeat; ++i) {
        input.input.values.insert(input.input.values.end(), once.begin(), once.end());
      }
    }
  }

  static void expect_rows(const TomlPlace& place, std::size_t found, std::size_t rows) {
    if (found == rows) return;
    place.fail(fmt::format("expected {} numbers, one for each row, found {}; make the lists of the run equally long",
                           rows, found));
  }

  void expect_measured(const TomlTable& table) const {
    expect_none(table, {"repeat", "seed"},
                "of a simulated run only, this one has readings; leave it out, or leave the readings out to simulate");
  }

  /// Readings that stand in the experiment file.
  Record read_readings(const TomlTable& table, const std::vector<WrittenInput>& inputs, Run& run) const {
    expect_measured(table);
    const auto readings = table.find_table("readings");
    Record record;
    record.sensors.resize(experiment_.sensors.size());
    std::vector<std::string> columns;
    for (const std::size_t k : run.sensors) columns.push_back(experiment_.sensors[k].column);
    for (const std::string& key : readings->keys()) {
      if (std::find(columns.begin(), columns.end(), key) != columns.end()) continue;
      readings->place_of(key).fail("expected the column of a sensor of this run, found \"" + key + "\"" +
                                   did_you_mean_or_list(key, columns));
    }
    std::optional<std::size_t> rows;
    for (std::size_t i = 0; i < run.sensors.size(); ++i) {
      const Sensor& sensor = experiment_.sensors[run.sensors[i]];
      const TomlPlace place = readings->place_of(columns[i]);
      if (!readings->has(columns[i])) {
        table.place_of("readings")
            .fail(fmt::format("expected the column \"{}\" of sensor \"{}\"; add {} = [NUMBER, ...], or name the "
                              "sensors that are read with "
                              "sensors = [...]",
                              columns[i], sensor.name, columns[i]));
      }
      const std::vector<double> values = readings->numbers(columns[i]);
      if (values.empty()) place.fail("expected a number for each row");
      if (!rows) rows = values.size();
      expect_rows(place, values.size(), *rows);
      take(run.sensors[i], values, record);
    }
    for (const WrittenInput& input : inputs) expect_rows(input.place, input.input.values.size(), *rows);
    set_measured(table.place_of("readings"), *rows, fs::path(experiment_.file), run);
    return record;
  }

  /// Readings, and inputs, of a data file, which has a row for each position.
  Record read_file(const TomlTable& table, std::vector<WrittenInput>& inputs, Run& run) const {
    expect_measured(table);
    const TomlText name = table.text("data");
    const fs::path path = (folder_ / name.value).lexically_normal();
    std::error_code unknown;
    if (name.value.empty() || !fs::exists(path, unknown)) {
      name.place.fail("expected a data file, there is no \"" + path.string() + "\"; correct the path");
    }
    std::vector<std::string> columns, gaps;
    const auto want = [&](const std::string& column) {
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
    };
    for (const std::size_t k : run.sensors) {
      want(experiment_.sensors[k].column);
      if (experiment_.sensors[k].gaps) gaps.push_back(experiment_.sensors[k].column);
    }
    for (const WrittenInput& input : inputs) {
      if (!input.column.empty()) want(input.column);
    }
    const CsvTable csv = read_csv(path, columns, {}, gaps);
    const auto every = static_cast<std::size_t>(table.whole_number("every", 1, 1));
    const auto rows_of = [&](const std::string& column) {
      std::vector<double> out;
      for (std::size_t row = 0; row < csv.line.size(); row += every) out.push_back(csv.column(column)[row]);
      return out;
    };
    Record record;
    record.sensors.resize(experiment_.sensors.size());
    for (const std::size_t k : run.sensors) take(k, rows_of(experiment_.sensors[k].column), record);
    const std::size_t rows = rows_of(columns.front()).size();
    for (WrittenInput& input : inputs) {
      if (input.column.empty()) {
        expect_rows(input.place, input.input.values.size(), rows);
        continue;
      }
      input.input.values = rows_of(input.column);
      const auto gap = std::find_if(input.input.values.begin(), input.input.values.end(),
                                    [](double value) { return std::isnan(value); });
      if (gap == input.input.values.end()) continue;
      const auto row = static_cast<std::size_t>(gap - input.input.values.begin()) * every;
      TomlPlace{csv.file, csv.line[row], input.column}.fail(
          "expected a value, found a gap in an input; leave the row out");
    }
    set_measured(table.place_of("data"), rows, path, run);
    return record;
  }

  /// Adds readings of sensor k, which are gaps where they are not numbers.
  void take(std::size_t k, const std::vector<double>& column, Record& record) const {
    const Sensor& sensor = experiment_.sensors[k];
    if (sensor.wraps.value_or(0.0) > 0) {
      TomlPlace{experiment_.file, sensor.line, "sensor \"" + sensor.name + "\".wraps"}.fail(
          "expected no wraps of a sensor that is read at rest, where rows do not follow each other; give it angles "
          "without jumps");
    }
    for (std::size_t row = 0; row < column.size(); ++row) {
      if (std::isnan(column[row])) continue;
      record.sensors[k].time.push_back(static_cast<double>(row + 1));
      record.sensors[k].value.push_back(sensor.zero + sensor.unit * column[row]);
    }
  }

  static void set_measured(const TomlPlace& place, std::size_t rows, fs::path file, Run& run) {
    if (rows == 0 || rows > static_cast<std::size_t>(most_rows)) {
      place.fail(fmt::format("expected 1 to {} rows, found {}", most_rows, rows));
    }
    run.rows = rows;
    run.data = {std::move(file)};
  }

  /// Readings that count twice would make the estimates look better than they are.
  void expect_own_record(const TomlTable& table, const Run& run, const Record& record) const {
    const auto same_inputs = [&](const Run& other) {
      return std::equal(run.row_inputs.begin(), run.row_inputs.end(), other.row_inputs.begin(), other.row_inputs.end(),
                        [](const RowInput& a, const RowInput& b) { return a.path == b.path && a.values == b.values; });
    };
    for (std::size_t r = 0; r < experiment_.runs.size(); ++r) {
      const Run& other = experiment_.runs[r];
      if (!other.is_at_rest() || !same_inputs(other) || !same_record(experiment_.records[r], record)) continue;
      table.place().fail(fmt::format(
          "expected readings of its own, all are those of run \"{}\"; leave one of the two out", other.name));
    }
  }

  std::vector<TomlTable> tables_;
  const fs::path& folder_;
  Experiment& experiment_;
};

}  // namespace

void read_static_runs(const TomlTable& root, const fs::path& folder, Experiment& experiment) {
  StaticRunsReader(root, folder, experiment).read();
}

}  // namespace poise
