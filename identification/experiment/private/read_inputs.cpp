#include "identification/experiment/private/read_inputs.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "model/dependent_number.hpp"
#include "model/laws/laws.hpp"
#include "model/nearest_name.hpp"
#include "model/parameters.hpp"
#include "solvers/quintic_spline.hpp"

namespace poise {
namespace {
namespace fs = std::filesystem;

/// Whether numbers of a law may follow readings. Those of the points of a curve do not.
bool may_follow(const Law& law) {
  return std::visit(
      []<class L>(const L&) {
        return std::is_same_v<L, LinearSpring> || std::is_same_v<L, CubicSpring> ||
               std::is_same_v<L, PreloadedSpring> || std::is_same_v<L, ConstantForce> || std::is_same_v<L, Damper> ||
               std::is_same_v<L, DragDamper> || std::is_same_v<L, Controller>;
      },
      law);
}

/// The load, drive or number of a force element of a path.
RunInput find_input(const std::string& path, const TomlPlace& place, const Scene& scene) {
  RunInput input;
  input.path = path;
  input.line = place.line;
  std::vector<std::string> valid;
  const auto is_it = [&](const std::string& name, MotionInput::Of of, std::size_t item) {
    valid.push_back(name);
    if (name != path) return false;
    input.motion.of = of;
    input.motion.item = static_cast<int>(item);
    return true;
  };
  for (std::size_t i = 0; i < scene.forces.size(); ++i) {
    if (!is_it("load." + scene.forces[i].name, MotionInput::Of::force, i)) continue;
    if (scene.forces[i].line_of_action() == Vec2{}) {
      place.fail(
          "expected a force with a direction, its vector is [0, 0]; give it a direction and a size in the scene");
    }
    return input;
  }
  for (std::size_t i = 0; i < scene.torques.size(); ++i) {
    if (is_it("load." + scene.torques[i].name, MotionInput::Of::torque, i)) return input;
  }
  for (std::size_t i = 0; i < scene.drives.size(); ++i) {
    if (is_it("drive." + scene.drives[i].name, MotionInput::Of::drive, i)) return input;
  }
  for (const ParameterRow& row : parameter_table(scene)) {
    if (row.place.owner != Owner::element) continue;
    const Element& element = scene.elements[static_cast<std::size_t>(row.place.item)];
    if (!may_follow(element.law)) continue;
    if (!is_it(row.path.text(), MotionInput::Of::element, static_cast<std::size_t>(row.place.item))) continue;
    if (dependent_number(scene, row.place) != nullptr) {
      place.fail("expected a number in the scene, whose place the input takes, found an expression; write its value");
    }
    input.motion.part = row.place.number;
    return input;
  }
  if (valid.empty()) {
    place.fail("expected a load or drive of the scene, which has none; add a force, torque or drive to it");
  }
  place.fail("expected load.NAME of a force or torque, drive.NAME, or a number of a force element, in quotes" +
             did_you_mean_or_list(path, valid));
}

/// The SI value of the unit of an input.
double unit_of(const RunInput& input, const Scene& scene) {
  if (input.motion.of != MotionInput::Of::drive) return value_unit(scene, input.path);
  return scene.drives[static_cast<std::size_t>(input.motion.item)].on.dimension().unit(scene.units);
}

/// What of a scene makes motions jump, or go on from more than their coordinates and rates; empty if nothing does.
std::string without_linear_motion(const Scene& scene) {
  if (!scene.stops.empty()) return "stop \"" + scene.stops.front().name + "\"";
  if (!scene.blades.empty()) return "blade \"" + scene.blades.front().name + "\"";
  for (const Element& element : scene.elements) {
    const Controller* const controller = std::get_if<Controller>(&element.law);
    if (controller != nullptr && controller->holds()) return "controller \"" + element.name + "\" with period or delay";
  }
  return "";
}

/// Adds the file that an input names to those of the run, where it is not one of them; returns which it is.
std::size_t file_of(const TomlTable& input, const TomlText& file, const fs::path& folder, RunSource& source) {
  const fs::path path = (folder / file.value).lexically_normal();
  const std::optional<TomlText> time = input.find_text("time");
  for (std::size_t f = 0; f < source.files.size(); ++f) {
    if (source.files[f].path != path) continue;
    if (time || input.has("time_factor")) {
      file.place.fail("expected no time and time_factor of a file that the run has already; leave them out");
    }
    return f;
  }
  source.files.push_back({path, time ? time->value : "time",
                          input.find_number("time_factor", 1.0, Range::positive).value_or(1.0), file.place, false});
  return source.files.size() - 1;
}

/// Reads { column = "COLUMN", ... }.
void read_table(const TomlTable& table, const fs::path& folder, InputTable& input, DataColumn& column,
                const Scene& scene, bool measured, RunSource& source) {
  table.allow_keys({"column", "file", "time", "time_factor", "zero", "factor", "multiplies", "gaps", "wraps", "noise"});
  column.name = table.text("column").value;
  column.gaps = table.flag("gaps", false);
  input.input.motion.multiplies = table.flag("multiplies", false);
  if (input.input.motion.multiplies && input.input.motion.of == MotionInput::Of::drive) {
    table.place_of("multiplies").fail("expected multiplies of a load only; leave it out");
  }
  if (input.input.motion.multiplies) {
    const std::vector<MotionInput> functions = inputs_of(scene);
    if (std::any_of(functions.begin(), functions.end(), [&](const MotionInput& one) {
          return one.of == input.input.motion.of && one.item == input.input.motion.item &&
                 (one.of != MotionInput::Of::element || one.number() == input.input.motion.number());
        })) {
      table.place_of("multiplies")
          .fail(
              "expected multiplies of a load without a function of time, found one in the scene; leave multiplies "
              "out, the input then takes the place of load and function");
    }
    input.unit = 1.0;
  }
  const double unit = input.unit;
  input.zero = table.find_number("zero", unit, Range::finite).value_or(0.0);
  input.unit = table.find_number("factor", unit, Range::finite).value_or(unit);
  if (table.has("wraps") && !input.is_angle) {
    table.place_of("wraps").fail("expected wraps of a drive of an angle only; leave it out");
  }
  input.wraps = table.find_number("wraps", std::abs(input.unit), Range::not_negative);
  if (table.has("noise")) {
    const TomlPlace place = table.place_of("noise");
    const double noise = table.number("noise", unit, Range::positive);
    if (input.input.motion.of == MotionInput::Of::drive) {
      input.noise = noise;
    } else if (!measured) {
      place.fail("expected noise of a load in a measured run, found it in a simulated one; leave it out");
    } else if (const std::string what = without_linear_motion(scene); !what.empty()) {
      place.fail("expected noise of a load only where motions depend on it smoothly, found " + what +
                 " in the scene; leave it out, and smooth the column");
    } else {
      input.input.noise = noise;
    }
  }
  if (const auto file = table.find_text("file")) {
    column.file = file_of(table, *file, folder, source);
  } else if (table.has("time") || table.has("time_factor")) {
    table.place_of(table.has("time") ? "time" : "time_factor")
        .fail("expected the key file as well; the times of data files are in time of the run");
  }
}

}  // namespace

std::vector<InputTable> read_inputs(const TomlTable& run, const fs::path& folder, const Scene& scene, bool measured,
                                    RunSource& source) {
  std::vector<InputTable> inputs;
  const auto table = run.find_table("inputs");
  if (!table) return inputs;
  if (!measured) source.place = run.place_of("inputs");
  for (const std::string& path : table->keys()) {
    InputTable& input = inputs.emplace_back();
    input.place = table->place_of(path);
    input.input = find_input(path, input.place, scene);
    input.unit = unit_of(input.input, scene);
    input.is_angle = input.input.motion.of == MotionInput::Of::drive &&
                     scene.drives[static_cast<std::size_t>(input.input.motion.item)].on.is_angle();
    DataColumn column;
    column.wanted_by = {input.place.file, input.place.line, "input \"" + path + "\""};
    column.begins = !measured;
    column.trimmed = false;
    if (table->holds_table(path)) {
      read_table(*table->find_table(path), folder, input, column, scene, measured, source);
    } else {
      column.name = table->text(path).value;
    }
    if (source.files.empty()) {
      input.place.fail("expected the file of the column; write { column = \"" + column.name + "\", file = \"...\" }");
    }
    source.columns.push_back(std::move(column));
  }
  return inputs;
}

RunInput input_of(const InputTable& table, Series series, const std::string& run, double end) {
  RunInput input = table.input;
  input.zero = table.zero;
  input.unit = table.unit;
  const bool drives = input.motion.of == MotionInput::Of::drive;
  const std::size_t least = drives ? 6 : 2;
  if (series.time.size() < least) {
    table.place.fail(
        fmt::format("expected at least {} readings, found {}; give a longer record", least, series.time.size()));
  }
  // The last sample of a simulation may be rounded.
  if (series.time.front() > 0.0 || series.time.back() < end * (1 - 1e-12)) {
    table.place.fail(fmt::format(
        "expected readings from the start of run \"{}\", 0 s, to its end, {:.6g} s, found them from {:.6g} s to {:.6g} "
        "s; leave out the rows of the run before and after them",
        run, end, series.time.front(), series.time.back()));
  }
  if (!drives) {
    input.motion.curve = std::make_shared<TimeCurve>(TimeCurve::through(std::move(series.time), series.value));
    return input;
  }
  const std::optional<solvers::QuinticSpline> spline =
      table.noise > 0 ? solvers::smoothing_spline(series.time, series.value, table.noise)
                      : solvers::interpolating_spline(series.time, series.value);
  if (!spline) {
    table.place.fail(
        "expected readings that scatter about a smooth curve by their noise, found more, or fewer than two for each "
        "interval of the curve; raise noise, or leave it out for a curve through every reading");
  }
  input.motion.curve = std::make_shared<TimeCurve>(TimeCurve::along(*spline));
  return input;
}

}  // namespace poise
