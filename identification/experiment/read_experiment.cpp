#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "identification/experiment/experiment.hpp"
#include "identification/experiment/private/join_experiments.hpp"
#include "identification/experiment/private/read_plan.hpp"
#include "identification/experiment/private/read_runs.hpp"
#include "identification/experiment/private/read_static_runs.hpp"
#include "identification/experiment/scene_parameter.hpp"
#include "model/dependent_number.hpp"
#include "model/joint_friction.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "model/read_parameter_changes.hpp"
#include "model/scene_names.hpp"
#include "model/set_parameter.hpp"
#include "model/text_file.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/friction/held.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise {
namespace {
namespace fs = std::filesystem;

std::optional<Loss> read_loss(const TomlTable& root) {
  const auto word = root.find_text("loss");
  if (!word) return std::nullopt;
  const std::optional<Loss> loss = loss_of(word->value);
  if (!loss) {
    const std::vector<std::string> valid(loss_words.begin(), loss_words.end());
    word->place.fail("expected squares, huber, cauchy or student" + did_you_mean_or_list(word->value, valid));
  }
  return loss;
}

/// Reads the parts of an experiment, each after those that it refers to.
class ExperimentReader {
 public:
  ExperimentReader(const TomlTable& root, const fs::path& file) : root_(root), file_(file) {
    experiment_.file = file.string();
  }

  Experiment read(const ExperimentOptions& options) {
    if (root_.has("body") && !root_.has("scene")) {
      root_.place_of("body").fail(
          "expected an experiment, found a scene; give a file that names it with scene = \"...\"");
    }
    root_.allow_keys(
        {"title", "source", "scene", "set", "loss", "sensor", "unknown", "known", "run", "static", "plan"});
    if (const auto title = root_.find_text("title")) experiment_.title = title->value;
    if (const auto source = root_.find_text("source")) experiment_.source = source->value;
    read_its_scene(options);
    experiment_.loss = read_loss(root_).value_or(Loss::squares);
    const SceneNames names = names_of_scene();
    read_sensors(names);
    read_unknowns();
    read_known();
    read_runs(root_, names, file_.parent_path(), options.data, experiment_);
    read_static_runs(root_, file_.parent_path(), experiment_);
    for (const Unknown& unknown : experiment_.unknowns) check_against_runs(unknown);
    for (const KnownNumber& known : experiment_.known) {
      check_label(fmt::format("known \"{}\"", known.path), known.line, known.per);
    }
    for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
      check_is_read(k);
      check_is_constant(experiment_.sensors[k]);
    }
    guess_noise();
    if (const auto plan = root_.find_table("plan")) experiment_.plan = read_plan(*plan, names, experiment_);
    return std::move(experiment_);
  }

 private:
  void read_its_scene(const ExperimentOptions& options) {
    const TomlText name = root_.text("scene");
    const fs::path scene = (file_.parent_path() / name.value).lexically_normal();
    std::error_code unknown;
    const auto whole = [&](const fs::path& path) { return fs::weakly_canonical(fs::absolute(path), unknown); };
    const bool is_given = options.scene != nullptr && whole(options.scene->file) == whole(scene);
    if (!is_given && !fs::is_regular_file(scene, unknown)) {
      name.place.fail(fmt::format("expected a scene file, relative to this file; there is no \"{}\"", scene.string()));
    }
    experiment_.scene = is_given ? *options.scene : read_scene(scene);
    refuse_rubbing_ropes(experiment_.scene, "identification");
    experiment_.changes = read_parameter_changes(root_, experiment_.scene);
    for (const std::string& setting : options.settings) set_parameter(experiment_.scene, setting);
  }

  /// A first guess where the noise is not stated: third differences of readings contain little but noise, whose
  /// variance they multiply by 20. Of readings that are all alike, a part of their size.
  void guess_noise() {
    for (std::size_t k = 0; k < experiment_.sensors.size(); ++k) {
      Sensor& sensor = experiment_.sensors[k];
      if (sensor.noise_known) continue;
      double differences = 0.0;
      double squares = 0.0;
      std::size_t count = 0;
      for (std::size_t r = 0; r < experiment_.runs.size(); ++r) {
        if (experiment_.runs[r].is_simulated() && experiment_.runs[r].reads(k)) {
          TomlPlace{experiment_.file, sensor.line, "sensor \"" + sensor.name + "\".noise"}.fail(
              "expected a number, since run \"" + experiment_.runs[r].name + "\" is simulated; add noise = NUMBER");
        }
        if (experiment_.runs[r].is_simulated()) continue;
        const std::vector<double>& y = experiment_.records[r].sensors[k].value;
        for (std::size_t i = 3; i < y.size(); ++i, ++count) {
          const double third = y[i] - 3 * y[i - 1] + 3 * y[i - 2] - y[i - 3];
          differences += third * third / 20;
          squares += y[i] * y[i];
        }
      }
      const double n = static_cast<double>(std::max<std::size_t>(count, 1));
      const double size = std::sqrt(squares / n);
      sensor.noise = std::max(std::sqrt(differences / n), size > 0 ? 1e-5 * size : 1e-12);
    }
  }

  SceneNames names_of_scene() const {
    SceneNames names(experiment_.scene);
    for (std::size_t i = 0; i < experiment_.scene.bodies.size(); ++i) names.learn_body(static_cast<int>(i));
    for (std::size_t i = 0; i < experiment_.scene.joints.size(); ++i) names.learn_joint(static_cast<int>(i));
    return names;
  }

  void read_sensors(const SceneNames& names) {
    const std::vector<TomlTable> tables = root_.tables("sensor");
    if (tables.empty()) root_.place().fail("sensor: expected at least one sensor; add [[sensor]]");
    std::vector<std::string> defaults;
    for (std::size_t i = 1; i <= tables.size(); ++i) defaults.push_back("sensor " + std::to_string(i));
    const std::vector<std::string> sensor_names = names_of({tables.begin(), tables.end()}, defaults, {});
    for (std::size_t i = 0; i < tables.size(); ++i) {
      experiment_.sensors.push_back(read_sensor(tables[i], sensor_names[i], names));
    }
  }

  Sensor read_sensor(const TomlTable& table, const std::string& name, const SceneNames& names) const {
    table.allow_keys({"name",  "read",    "angle",         "travel", "distance",  "x",      "y",
                      "force", "impacts", "accelerometer", "slips",  "direction", "rate",   "column",
                      "gaps",  "missing", "wraps",         "noise",  "zero",      "factor", "delay"});
    Sensor sensor;
    sensor.name = name;
    sensor.line = table.place().line;
    const double unit = read_quantity(table, names, sensor);
    if (sensor.by_time > 0 && table.has("rate")) {
      table.place_of("rate").fail("d(A)/dt is a rate already; leave it out");
    }
    if (table.flag("rate", false)) {
      if (!sensor.reads_impacts() && !sensor.is_of_measure()) {
        table.place_of("rate").fail(
            fmt::format("expected the rate of a position or angle; the rate of {} is not available",
                        sensor.reads_force()        ? "a force"
                        : sensor.slips              ? "a load"
                        : sensor.is_accelerometer() ? "an acceleration"
                                                    : sensor.quantity->name));
      }
      sensor.by_time = 1;
    }
    if (table.has("direction") && !sensor.is_accelerometer()) {
      table.place_of("direction").fail("expected a direction of an accelerometer only; leave it out");
    }
    if (sensor.reads_impacts()) {
      for (const char* const key : {"rate", "gaps", "missing", "delay"}) {
        if (table.has(key)) table.place_of(key).fail("expected no such key of a sensor of impacts; leave it out");
      }
      if (!table.has("noise")) table.place().fail("expected the deviation of its times, s; add noise = NUMBER");
    }
    const auto noise = table.find_number("noise", unit, Range::positive);
    sensor.noise_known = noise.has_value();
    sensor.noise = noise.value_or(0.0);
    sensor.zero = table.find_number("zero", unit, Range::finite).value_or(0.0);
    sensor.unit = table.find_number("factor", unit, Range::finite).value_or(unit);
    if (sensor.unit == 0.0) table.place_of("factor").fail("expected a number other than 0; leave it out for 1");
    sensor.delay = table.find_number("delay", 1.0, Range::finite).value_or(0.0);
    sensor.least_delay = sensor.most_delay = sensor.delay;
    sensor.column = name;
    if (const auto column = table.find_text("column")) {
      if (column->value.empty()) column->place.fail("expected the name of a column");
      sensor.column = column->value;
    }
    sensor.gaps = table.flag("gaps", false);
    if (table.has("missing")) sensor.missing = table.numbers("missing");
    if (table.has("wraps") && !sensor.reads_angle()) {
      table.place_of("wraps").fail("expected wraps of a sensor of an angle only; leave it out");
    }
    sensor.wraps = table.find_number("wraps", std::abs(sensor.unit), Range::not_negative);
    return sensor;
  }

  /// What the sensor measures; returns the unit of the scene, or of the scene per second, in SI.
  double read_quantity(const TomlTable& table, const SceneNames& names, Sensor& sensor) const {
    constexpr std::array measures = {"read", "angle", "travel",  "distance",      "x",
                                     "y",    "force", "impacts", "accelerometer", "slips"};
    std::vector<std::string> given;
    std::copy_if(measures.begin(), measures.end(), std::back_inserter(given),
                 [&](const char* key) { return table.has(key); });
    if (given.size() != 1) {
      table.place().fail(fmt::format(
          "expected one of the keys {}{}", fmt::join(measures, ", "),
          given.empty() ? ""
                        : fmt::format(", found {}; leave one in, or give each a sensor", fmt::join(given, " and "))));
    }
    const Units& units = experiment_.scene.units;
    if (table.has("read")) return read_by_name(table.text("read"), sensor);
    if (table.has("angle")) {
      sensor.on = read_bodies(table, names);
      return units.angle;
    }
    if (table.has("force")) {
      sensor.element = find_spring(table.text("force"));
      sensor.on = experiment_.scene.elements[sensor.element].on;
      return units.force;
    }
    if (table.has("slips")) return read_slips(table, sensor);
    if (table.has("impacts")) {
      sensor.stops = find_stops(table.text("impacts"));
      sensor.on = experiment_.scene.stops[static_cast<std::size_t>(sensor.stops.front())].on;
      return 1.0;
    }
    if (table.has("accelerometer")) {
      const TomlText point = table.text("accelerometer");
      sensor.on = Measure::y_of(movable_point(point, names));
      sensor.axis = table.find_number("direction", units.angle, Range::finite).value_or(0.0);
      for (const TimeFunction& function : experiment_.scene.time_functions) {
        if (function.of == TimeFunction::Of::frame) {
          point.place.fail("accelerometers of a scene with a [frame] that moves are not available; read positions");
        }
      }
      return sensor.dimension().unit(units);
    }
    if (table.has("travel")) {
      sensor.on = Measure::travel_of(names.travelling_joint(table.text("travel")));
    } else if (table.has("distance")) {
      const std::array<TomlText, 2> points = table.two_texts("distance");
      sensor.on = Measure::distance_between(names.point(points[0]), names.point(points[1]));
      if (sensor.on.a.body == sensor.on.b.body) {
        points[1].place.fail("expected points of two different bodies, the distance of these never changes");
      }
    } else {
      const char* const key = table.has("x") ? "x" : "y";
      const PointRef at = movable_point(table.text(key), names);
      sensor.on = table.has("x") ? Measure::x_of(at) : Measure::y_of(at);
    }
    return units.length;
  }

  /// slips = "load.P", or { growing = "load.P" } or { falling = "load.P" }.
  double read_slips(const TomlTable& table, Sensor& sensor) const {
    const Scene& scene = experiment_.scene;
    TomlText path = table.holds_table("slips") ? TomlText{} : table.text("slips");
    Sensor::SlipLoad out;
    if (table.holds_table("slips")) {
      const TomlTable way = *table.find_table("slips");
      way.allow_keys({"growing", "falling"});
      if (way.has("growing") == way.has("falling")) way.place().fail("expected one of the keys growing, falling");
      out.falling = way.has("falling");
      path = way.text(out.falling ? "falling" : "growing");
    }
    std::vector<std::string> valid;
    for (const Force& force : scene.forces) valid.push_back("load." + force.name);
    for (const Torque& torque : scene.torques) valid.push_back("load." + torque.name);
    if (std::find(valid.begin(), valid.end(), path.value) == valid.end()) {
      path.place.fail("expected the load of a force or torque at which it slips" +
                      did_you_mean_or_list(path.value, valid));
    }
    if (!has_friction(scene)) path.place.fail("expected a scene in which something rubs; add friction to a joint");
    out.path = path.value;
    out.dimension = parameter(scene, path.value).dimension;
    sensor.slips = out;
    return out.dimension.unit(scene.units);
  }

  static PointRef movable_point(const TomlText& point, const SceneNames& names) {
    const PointRef at = names.point(point);
    if (at.body == 0) point.place.fail("expected a point of a body that can move, found one of the ground");
    return at;
  }

  /// read = "length.strut", a quantity of the scene: a measure, its rate or the force of a spring; or any other that a
  /// mechanism has at rest.
  double read_by_name(const TomlText& name, Sensor& sensor) const {
    const Scene& scene = experiment_.scene;
    SoughtQuantity found = located(name.place, [&] { return find_quantity(scene, name.value, AskedOf::motion); });
    const double unit = found.dimension.unit(scene.units);
    int by_time = 0;
    for (; found.kind == SoughtQuantity::Kind::by_time; ++by_time) found = SoughtQuantity(found.of.front());
    const bool is_force = found.kind == SoughtQuantity::Kind::element_force && by_time == 0 &&
                          stores_energy(scene.elements[static_cast<std::size_t>(found.item)].law);
    sensor.on = is_force ? scene.elements[static_cast<std::size_t>(found.item)].on : found.on;
    if (is_force) {
      sensor.element = found.item;
      return unit;
    }
    using Kind = Measure::Kind;
    constexpr std::array read_as_they_are = {Kind::angle, Kind::distance, Kind::travel, Kind::x, Kind::y};
    const bool is_measure =
        found.kind == SoughtQuantity::Kind::measure &&
        std::find(read_as_they_are.begin(), read_as_they_are.end(), found.on.kind) != read_as_they_are.end();
    if (is_measure && by_time <= 2)
      sensor.by_time = by_time;
    else
      read_other(name, by_time == 0 ? std::optional(found) : std::nullopt, sensor);
    return unit;
  }

  /// A quantity that is no measure, as it was found of motions, unless it has none there.
  void read_other(const TomlText& name, const std::optional<SoughtQuantity>& in_motion, Sensor& sensor) const {
    sensor.quantity_moves = in_motion && moves(*in_motion);
    sensor.quantity = at_rest(name);
    sensor.quantity_rests = sensor.quantity.has_value();
    if (!sensor.quantity && sensor.quantity_moves) sensor.quantity = in_motion;
    if (sensor.quantity && !sensor.quantity_moves && !root_.has("static")) {
      name.place.fail(fmt::format("{} belongs to mechanisms at rest; expected a quantity of motions, or add [[static]]",
                                  name.value));
    }
    if (sensor.quantity) return;
    name.place.fail(fmt::format(
        "sensors read angle.BODY, travel.JOINT, x.BODY.POINT, y.BODY.POINT, length.ELEMENT between two points "
        "or bodies, their d(A)/dt and d(d(A)/dt)/dt, other quantities of a motion without rates, and at rest "
        "all quantities but stresses, loads inside of links, modes and those over a path; found {}",
        name.value));
  }

  /// Whether a motion has this quantity at each time by itself.
  static bool moves(const SoughtQuantity& of) {
    using Kind = SoughtQuantity::Kind;
    constexpr std::array those = {Kind::measure,  Kind::number,         Kind::element_force, Kind::drive_force,
                                  Kind::reaction, Kind::stop_reaction,  Kind::shaking,       Kind::blade_force,
                                  Kind::energy,   Kind::kinetic_energy, Kind::element_rate,  Kind::ratio,
                                  Kind::center,   Kind::transmission,   Kind::sum,           Kind::difference,
                                  Kind::product,  Kind::quotient,       Kind::link_load};
    return std::find(those.begin(), those.end(), of.kind) != those.end() &&
           std::all_of(of.of.begin(), of.of.end(), moves);
  }

  /// A quantity that equilibria have, with derivatives; none where they have no such.
  std::optional<SoughtQuantity> at_rest(const TomlText& name) const {
    using Kind = SoughtQuantity::Kind;
    std::optional<SoughtQuantity> out;
    try {
      out = find_quantity(experiment_.scene, name.value, AskedOf::rest);
    } catch (const InputError&) {
      return std::nullopt;
    }
    constexpr std::array without_derivatives = {Kind::stress, Kind::link_load, Kind::frequency, Kind::damping};
    // At a fold a quantity is the load itself: expressions of it have no derivatives.
    const bool mixes_fold = out->kind != Kind::load_at_fold && out->has(Kind::load_at_fold);
    if (out->is_over_path() || mixes_fold ||
        std::any_of(without_derivatives.begin(), without_derivatives.end(), [&](Kind k) { return out->has(k); })) {
      return std::nullopt;
    }
    return out;
  }

  /// angle = "b" from the ground, or angle = ["a", "b"] from a to b.
  static Measure read_bodies(const TomlTable& table, const SceneNames& names) {
    if (!table.holds_list("angle")) return Measure::angle_between(0, names.movable_body(table.text("angle")));
    const std::array<TomlText, 2> bodies = table.two_texts("angle");
    Measure angle = Measure::angle_between(names.body(bodies[0]), names.body(bodies[1]));
    if (angle.body_a == angle.body_b) bodies[1].place.fail("expected two different bodies");
    return angle;
  }

  int find_spring(const TomlText& name) const {
    std::vector<std::string> valid;
    const std::vector<Element>& elements = experiment_.scene.elements;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (!stores_energy(elements[i].law) || elements[i].on.is_angle()) continue;
      if (elements[i].name == name.value) return static_cast<int>(i);
      valid.push_back(elements[i].name);
    }
    name.place.fail(fmt::format("expected the name of a line spring, found \"{}\"{}", name.value,
                                did_you_mean_or_list(name.value, valid)));
  }

  /// The places of a stop, or of those of a contact, which has one for each pair that can meet.
  std::vector<int> find_stops(const TomlText& name) const {
    const std::vector<Stop>& stops = experiment_.scene.stops;
    std::vector<int> out;
    std::vector<std::string> valid;
    for (std::size_t s = 0; s < stops.size(); ++s) {
      if (stops[s].name == name.value) out.push_back(static_cast<int>(s));
      valid.push_back(stops[s].name);
    }
    if (out.empty()) {
      name.place.fail(fmt::format("expected the name of a stop, contact, rope or cam that may be hit, found \"{}\"{}",
                                  name.value, did_you_mean_or_list(name.value, valid)));
    }
    return out;
  }

  void read_unknowns() {
    const std::vector<TomlTable> tables = root_.tables("unknown");
    std::vector<std::string> paths;
    NameLines lines;
    for (const TomlTable& table : tables) {
      const TomlText path = table.text("path");
      const auto [other, is_new] = lines.emplace(path.value, path.place.line);
      if (!is_new) path.place.fail(fmt::format("expected another path, it is unknown in line {}", other->second));
      paths.push_back(path.value);
    }
    const std::vector<std::string> names = names_of({tables.begin(), tables.end()}, paths, {});
    for (std::size_t i = 0; i < tables.size(); ++i) {
      const Unknown unknown = read_unknown(tables[i], names[i]);
      experiment_.unknowns.push_back(unknown);
      if (!unknown.of_sensor || unknown.of_sensor->of != SensorNumber::Of::delay) continue;
      Sensor& sensor = experiment_.sensors[unknown.of_sensor->sensor];
      sensor.least_delay = std::min(sensor.delay, unknown.min);
      sensor.most_delay = std::max(sensor.delay, unknown.max);
    }
  }

  /// The number of a sensor that a path names; none where it is one of the scene.
  std::optional<SensorNumber> find_sensor_number(const TomlText& path) const {
    constexpr std::string_view owner = "sensor.";
    if (!path.value.starts_with(owner)) return std::nullopt;
    const std::size_t dot = path.value.rfind('.');
    const std::string key = path.value.substr(dot + 1);
    const std::vector<std::string> keys = {"zero", "factor", "delay"};
    const auto of = std::find(keys.begin(), keys.end(), key);
    if (dot < owner.size() || of == keys.end()) {
      path.place.fail(fmt::format("expected sensor.NAME.zero, sensor.NAME.factor or sensor.NAME.delay, found \"{}\"{}",
                                  path.value, did_you_mean_or_list(key, keys)));
    }
    const std::string name = path.value.substr(owner.size(), dot - owner.size());
    std::vector<std::string> valid;
    for (const Sensor& sensor : experiment_.sensors) valid.push_back(sensor.name);
    const auto at = std::find(valid.begin(), valid.end(), name);
    if (at == valid.end()) {
      path.place.fail("expected the name of a sensor, found \"" + name + "\"" + did_you_mean_or_list(name, valid));
    }
    const auto sensor = static_cast<std::size_t>(at - valid.begin());
    if (experiment_.sensors[sensor].reads_impacts() && *of != "zero") {
      path.place.fail("expected sensor." + name + ".zero, the only number of a sensor of impacts that can be unknown");
    }
    return SensorNumber{sensor, static_cast<SensorNumber::Of>(of - keys.begin())};
  }

  /// The SI value of the unit in which the file gives a number of a sensor, and the number itself, SI.
  double unit_of(const SensorNumber& number) const {
    return experiment_.sensors[number.sensor].dimension(number.of).unit(experiment_.scene.units);
  }
  double value_of(const SensorNumber& number) const { return experiment_.sensors[number.sensor].number(number.of); }

  /// Sets the unit of an unknown; returns its number as written, SI.
  double read_written(const TomlText& path, Unknown& unknown) const {
    unknown.of_sensor = find_sensor_number(path);
    if (!unknown.of_sensor) {
      // First, because it fails for a path that does not exist.
      const double value = located(path.place, [&] { return get_value(experiment_.scene, path.value); });
      if (path.value.starts_with("start.")) {
        path.place.fail(
            "expected a number that the motion depends on; start values of a run are estimated unless start_known = "
            "true");
      }
      located(path.place, [&] { check_is_free(experiment_.scene, parameter(experiment_.scene, path.value)); });
      unknown.unit = value_unit(experiment_.scene, path.value);
      return value * unknown.unit;
    }
    unknown.unit = unit_of(*unknown.of_sensor);
    return value_of(*unknown.of_sensor);
  }

  /// The range that an unknown has by default; `written` and its start, SI.
  void set_default_range(const TomlText& path, double written, Unknown& unknown) const {
    if (unknown.of_sensor) {
      // A factor of 0 would divide by it, so that its sign stays.
      if (unknown.of_sensor->of == SensorNumber::Of::factor) (written > 0 ? unknown.min : unknown.max) = 0.0;
      return;
    }
    if (may_not_be_negative(path.value)) unknown.min = 0.0;
    const ParameterRow row = parameter(experiment_.scene, path.value);
    const auto within = [&](double reach) {
      const double middle = unknown.start.value_or(written + unknown.includes);
      unknown.min = middle - reach;
      unknown.max = middle + reach;
    };
    // The direction of a line turns into its opposite after half a turn, which other numbers may make up for.
    if (row.place.owner == Owner::joint && row.path.parts[3] == "angle") within(std::numbers::pi / 2);
    if (is_periodic(row)) within(std::numbers::pi);
  }

  /// A phase of a sine or of the profile of a cam, which a whole turn does not change. That of a gear or belt is the
  /// angle of a body, of which turns count.
  static bool is_periodic(const ParameterRow& row) {
    const bool has_phase =
        row.path.parts[0] == "cam" || row.place.owner == Owner::drive || row.place.owner == Owner::time;
    return has_phase && row.path.text().ends_with(".phase");
  }

  /// What the range and the start of a sensor's number must be.
  static void check_sensor_number(const TomlTable& table, const Unknown& unknown, double first) {
    if (table.has("includes")) {
      table.place_of("includes").fail("expected a number of the scene, this is one of a sensor; leave includes out");
    }
    if (unknown.of_sensor->of == SensorNumber::Of::delay && !std::isfinite(unknown.max - unknown.min)) {
      table.place().fail(
          fmt::format("expected the range of the delay in s, which says how many readings are left out; "
                      "add {}",
                      std::isfinite(unknown.min)   ? "max = NUMBER"
                      : std::isfinite(unknown.max) ? "min = NUMBER"
                                                   : "min = NUMBER and max = NUMBER"));
    }
    if (unknown.of_sensor->of != SensorNumber::Of::factor) return;
    if (unknown.min < 0 && unknown.max > 0) {
      table.place_of(table.has("min") ? "min" : "max")
          .fail("expected a range of the factor without 0 inside; leave min and max out to keep its sign");
    }
    if (first == 0) table.place_of("start").fail("expected a factor other than 0");
  }

  Unknown read_unknown(const TomlTable& table, const std::string& name) const {
    table.allow_keys({"path", "name", "per", "start", "min", "max", "includes", "prior", "scale"});
    const TomlText path = table.text("path");
    Unknown unknown;
    unknown.path = path.value;
    unknown.name = name;
    unknown.line = table.place().line;
    const double written = read_written(path, unknown);
    if (const auto per = table.find_text("per")) {
      if (per->value.empty()) per->place.fail("expected \"run\" or a label of the runs; leave it out for one value");
      unknown.per = per->value;
    }
    unknown.includes = table.find_number("includes", unknown.unit, Range::finite).value_or(0.0);
    unknown.start = table.find_number("start", unknown.unit, Range::finite);
    set_default_range(path, written, unknown);
    unknown.min = table.find_number("min", unknown.unit, Range::finite).value_or(unknown.min);
    unknown.max = table.find_number("max", unknown.unit, Range::finite).value_or(unknown.max);
    if (!(unknown.min < unknown.max)) {
      table.place_of("max").fail(
          fmt::format("expected max > min = {:.12g}; exchange them", unknown.min / unknown.unit));
    }
    unknown.scale = table.find_number("scale", unknown.unit, Range::positive);
    const double first = unknown.start.value_or(written + unknown.includes);
    if (unknown.of_sensor) check_sensor_number(table, unknown, first);
    if (first < unknown.min || first > unknown.max) {
      const bool bounded = std::isfinite(unknown.min) && std::isfinite(unknown.max);
      table.place_of("start").fail(fmt::format(
          "expected a start {}, found {:.12g}{}",
          bounded ? fmt::format("from {:.12g} to {:.12g}", unknown.min / unknown.unit, unknown.max / unknown.unit)
          : first < unknown.min ? fmt::format("of at least {:.12g}", unknown.min / unknown.unit)
                                : fmt::format("of at most {:.12g}", unknown.max / unknown.unit),
          first / unknown.unit,
          unknown.start ? fmt::format("; change one of the {}", bounded ? "three" : "two")
                        : fmt::format(", the {}'s value; add start = NUMBER", unknown.of_sensor ? "sensor" : "scene")));
    }
    if (const auto prior = table.find_vector("prior", unknown.unit)) {
      if (!(prior->y > 0.0)) table.place_of("prior").fail("expected [MEAN, STANDARD DEVIATION], the second > 0");
      unknown.prior = prior->x;
      unknown.prior_deviation = prior->y;
    }
    return unknown;
  }

  /// Whether the number at this path is one of those that a scene wants to be >= 0: masses, stiffnesses, ...
  bool may_not_be_negative(const std::string& path) const {
    return parameter(experiment_.scene, path).range != Range::finite;
  }

  /// Every run must have the label that a number's values belong to.
  void check_label(const std::string& item, int line, const std::string& per) const {
    for (const Run& run : experiment_.runs) {
      const bool labelled =
          std::any_of(run.labels.begin(), run.labels.end(), [&](const auto& label) { return label.first == per; });
      if (per.empty() || per == "run" || labelled) continue;
      std::vector<std::string> valid = {"run"};
      for (const auto& label : run.labels) valid.push_back(label.first);
      TomlPlace{experiment_.file, line, item + ".per"}.fail(
          fmt::format("expected \"run\" or a label that all runs have, run \"{}\" has no \"{}\"{}", run.name, per,
                      did_you_mean_or_list(per, valid)));
    }
  }

  /// Numbers whose uncertainty is propagated.
  void read_known() {
    NameLines lines;
    for (const TomlTable& table : root_.tables("known")) {
      table.allow_keys({"path", "per", "deviation", "relative"});
      const TomlText path = table.text("path");
      const auto [other, is_new] = lines.emplace(path.value, path.place.line);
      if (!is_new) {
        path.place.fail(
            fmt::format("expected another path, it is known in line {}; take one of the two out", other->second));
      }
      KnownNumber known;
      known.path = path.value;
      known.line = table.place().line;
      known.of_clock = path.value == "clock";
      known.of_sensor = find_sensor_number(path);
      const double unit = known.of_clock ? 1.0
                          : known.of_sensor
                              ? unit_of(*known.of_sensor)
                              : located(path.place, [&] { return value_unit(experiment_.scene, path.value); });
      for (const Unknown& unknown : experiment_.unknowns) {
        if (unknown.path == known.path) {
          path.place.fail(
              fmt::format("expected a number that is not unknown, it is in line {}; take one of them out, or "
                          "give the unknown a prior",
                          unknown.line));
        }
      }
      const bool of_scene = !known.of_sensor && !known.of_clock;
      if (of_scene) {
        located(path.place, [&] { check_is_free(experiment_.scene, parameter(experiment_.scene, path.value)); });
      }
      if (of_scene && !SceneParameter::find(experiment_.scene, known.path)) {
        path.place.fail(
            "expected a number that the motion or a reading has derivatives by: of a body, an element, a load or a "
            "sensor, or \"clock\"");
      }
      if (table.has("deviation") + table.has("relative") != 1) {
        table.place().fail(
            "expected one of the keys deviation (in the unit of the number) and relative (a part of it)");
      }
      known.relative = table.has("relative");
      if (known.relative && known.of_sensor && value_of(*known.of_sensor) == 0) {
        table.place_of("relative").fail("expected deviation, since the number is 0, of which any part is none");
      }
      known.deviation = known.relative ? table.number("relative", 1.0, Range::positive)
                                       : table.number("deviation", unit, Range::positive);
      if (const auto per = table.find_text("per")) known.per = per->value;
      experiment_.known.push_back(known);
    }
  }

  /// Every run must have the label that an unknown's values belong to, and must not set the unknown.
  void check_against_runs(const Unknown& unknown) const {
    const auto fail = [&](const std::string& key, const std::string& message) {
      TomlPlace{experiment_.file, unknown.line, fmt::format("unknown \"{}\".{}", unknown.name, key)}.fail(message);
    };
    check_label(fmt::format("unknown \"{}\"", unknown.name), unknown.line, unknown.per);
    for (const Run& run : experiment_.runs) {
      for (const ParameterChange& change : run.changes) {
        if (change.path != unknown.path) continue;
        fail("path", fmt::format("expected a number that no run sets, run \"{}\" does in line {}; take it out of one",
                                 run.name, change.line));
      }
      for (const RunInput& input : run.inputs) {
        if (input.motion.multiplies) continue;
        if (unknown.path != input.path && !unknown.path.starts_with(input.path + ".")) continue;
        fail("path",
             fmt::format("expected a number that no input takes the place of, run \"{}\" has \"{}\" as an input "
                         "in line {}; take one of the two out{}",
                         run.name, input.path, input.line,
                         input.motion.of == MotionInput::Of::drive
                             ? ""
                             : ", or let the input multiply it with multiplies = true"));
      }
      for (const RowInput& input : run.row_inputs) {
        if (unknown.path != input.path && !(input.drive >= 0 && unknown.path.starts_with(input.path + "."))) continue;
        fail("path",
             fmt::format("expected a number that no input takes the place of, static run \"{}\" has \"{}\" as an "
                         "input in line {}; take one of the two out",
                         run.name, input.path, input.line));
      }
      if (run.equilibrium && run.equilibrium->by == unknown.path) {
        fail("path",
             fmt::format("expected a number that no equilibrium position sets, rest of run \"{}\" sets it in line "
                         "{}; take one of the two out",
                         run.name, run.equilibrium->line));
      }
    }
  }

  /// A force that is read is one of the numbers of the scene, not of the time.
  void check_is_constant(const Sensor& sensor) const {
    if (!sensor.reads_force()) return;
    const auto fail = [&](const std::string& what) {
      TomlPlace{experiment_.file, sensor.line, "sensor \"" + sensor.name + "\".force"}.fail(
          "expected an element with constant numbers, found \"" +
          experiment_.scene.elements[static_cast<std::size_t>(sensor.element)].name + "\", of which " + what +
          "; read another quantity");
    };
    for (const TimeFunction& function : experiment_.scene.time_functions) {
      if (function.of == TimeFunction::Of::element && function.item == sensor.element) fail("one follows time");
    }
    for (const Run& run : experiment_.runs) {
      for (const RunInput& input : run.inputs) {
        if (input.motion.of == MotionInput::Of::element && input.motion.item == sensor.element) {
          fail(fmt::format("one is an input of run \"{}\"", run.name));
        }
      }
    }
  }

  /// A sensor must have readings in some run.
  void check_is_read(std::size_t k) const {
    for (std::size_t r = 0; r < experiment_.runs.size(); ++r) {
      const Run& run = experiment_.runs[r];
      if (run.is_simulated() && run.reads(k) && experiment_.sensors[k].reads_impacts()) return;
      if (run.is_simulated() ? !simulated_times(experiment_, run, k).empty()
                             : !experiment_.records[r].sensors[k].value.empty()) {
        return;
      }
    }
    TomlPlace{experiment_.file, experiment_.sensors[k].line, "sensor \"" + experiment_.sensors[k].name + "\""}.fail(
        "expected readings in at least one run, no run has any; name it in the sensors of a run, or leave it out");
  }

  TomlTable root_;
  fs::path file_;
  Experiment experiment_;
};

/// experiments = ["one.toml", "other.toml"]: all runs of several experiments.
Experiment read_joint(const TomlTable& root, const fs::path& file, const ExperimentOptions& options) {
  root.allow_keys({"title", "source", "loss", "experiments"});
  const std::string own = ": expected an experiment with a scene of its own; ";
  if (!options.data.empty()) {
    throw InputError("--data " + options.data.string() + own + "name the file in the experiments");
  }
  if (!options.settings.empty()) {
    throw InputError("--set " + options.settings.front() + own + "write set in the experiments");
  }
  const std::vector<TomlText> names = root.texts("experiments");
  const TomlPlace place = root.place_of("experiments");
  if (names.size() < 2) {
    place.fail("expected two experiments at least; give a single one to the command itself");
  }
  std::vector<Experiment> parts;
  for (const TomlText& name : names) {
    const fs::path path = (file.parent_path() / name.value).lexically_normal();
    std::error_code unknown;
    if (!fs::is_regular_file(path, unknown)) {
      name.place.fail(
          fmt::format("expected an experiment file, relative to this file; there is no \"{}\"", path.string()));
    }
    for (const Experiment& other : parts) {
      if (other.file == path.string()) {
        name.place.fail("expected each experiment once, found \"" + name.value + "\" again");
      }
    }
    const std::string text = read_text_file(path);
    const toml::table document = parse_toml(text, path.string());
    const TomlTable part(document, {path.native(), 1, ""});
    if (part.has("experiments")) {
      name.place.fail("expected experiments with scenes of their own, \"" + name.value + "\" names others");
    }
    parts.push_back(ExperimentReader(part, path).read({}));
  }
  std::optional<Loss> loss = read_loss(root);
  for (const Experiment& part : parts) {
    if (!loss && part.loss != parts.front().loss) {
      place.fail(fmt::format("expected one loss in all experiments, found {} and {}; write loss = \"...\" in this file",
                             to_string(parts.front().loss), to_string(part.loss)));
    }
  }
  if (!loss) loss = parts.front().loss;
  Experiment joint = join_experiments(file.string(), std::move(parts));
  joint.loss = *loss;
  if (const auto title = root.find_text("title")) joint.title = title->value;
  if (const auto source = root.find_text("source")) joint.source = source->value;
  return joint;
}

}  // namespace

Experiment read_experiment(const fs::path& file, const ExperimentOptions& options) {
  return parse_experiment(read_text_file(file), file, options);
}

Experiment parse_experiment(const std::string& text, const fs::path& file, const ExperimentOptions& options) {
  const std::string name = file.string();
  const toml::table document = parse_toml(text, name);
  const TomlTable root(document, {name, 1, ""});
  return root.has("experiments") ? read_joint(root, file, options) : ExperimentReader(root, file).read(options);
}

}  // namespace poise
