#include <numbers>

#include <fmt/format.h>

#include "design/balance/balance_problem.hpp"
#include "model/scene_names.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

namespace fs = std::filesystem;

// The number of a path, which must be one that can be set.
ParameterRow settable_row(const Scene& scene, const std::string& path, const TomlPlace& place) {
  return located(place, [&] {
    const ParameterRow row = parameter(scene, path);
    Scene copy = scene;
    set_value(copy, path, get_value(scene, path));
    return row;
  });
}

// Angles are in degrees, whatever the unit of the scene, as in all design files.
double unit_of_range(const Measure& on, const Scene& scene) {
  return on.is_angle() ? std::numbers::pi / 180 : scene.units.length;
}

FreeNumber free_number(const TomlTable& table, const std::string& path, const Scene& scene) {
  const ParameterRow row = settable_row(scene, path, table.place_of(path));
  const Vec2 ends = table.vector(path, value_unit(scene, path));
  if (!(ends.x <= ends.y)) table.place_of(path).fail("expected [LEAST, GREATEST]; swap them");
  return {path, row.place, ends.x, ends.y};
}

bool is_spring(const Law& law) {
  return std::holds_alternative<LinearSpring>(law) || std::holds_alternative<PreloadedSpring>(law);
}

void read_springs(const TomlTable& table, BalanceProblem& out) {
  for (const std::string& path : table.keys()) {
    FreeNumber number = free_number(table, path, out.scene);
    const bool fits = number.place.owner == Owner::element && number.place.number == 0 &&
                      is_spring(out.scene.elements[number.place.item].law);
    if (!fits) table.place_of(path).fail("expected the stiffness of a linear spring, \"spring.NAME.stiffness\"");
    if (number.min < 0.0) table.place_of(path).fail("expected stiffnesses >= 0, found a range below");
    out.stiffnesses.push_back(std::move(number));
  }
}

void read_points(const TomlTable& table, BalanceProblem& out) {
  for (const std::string& path : table.keys()) {
    FreeNumber number = free_number(table, path, out.scene);
    if (number.place.owner != Owner::point) {
      table.place_of(path).fail("expected a coordinate of a point, \"point.BODY.NAME.x\" or .y");
    }
    const PointRef point{number.place.item, number.place.part};
    const auto used = [&](PointRef p) { return p == point; };
    for (const Joint& joint : out.scene.joints) {
      if (used(joint.a) || used(joint.b)) {
        table.place_of(path).fail(
            fmt::format("expected a point that only springs use, {} \"{}\" has it too; give the "
                        "spring a point of its own",
                        joint.traits().key, joint.name));
      }
    }
    for (const Force& force : out.scene.forces) {
      if (used(force.at) || (force.to && used(*force.to))) {
        table.place_of(path).fail(fmt::format(
            "expected a point that only springs use, force \"{}\" has it too; give the spring a point of its own",
            force.name));
      }
    }
    out.coordinates.push_back(std::move(number));
  }
}

void read_over(const TomlTable& table, BalanceProblem& out) {
  for (const std::string& name : table.keys()) {
    const auto measure = find_measure(out.scene, name);
    const bool fits = measure && ((measure->on.kind == Measure::Kind::angle && measure->on.body_a == 0) ||
                                  measure->on.kind == Measure::Kind::travel);
    if (!fits) {
      const std::string why = measure ? "" : why_no_measure(out.scene, name);
      table.place_of(name).fail(why.empty() ? "expected the angle of a body in the world, \"angle.BODY\", or "
                                              "\"travel.JOINT\""
                                            : why);
    }
    const Vec2 ends = table.vector(name, unit_of_range(measure->on, out.scene));
    if (!(ends.x <= ends.y)) table.place_of(name).fail("expected [LEAST, GREATEST]; swap them");
    out.over.push_back({*measure, ends.x, ends.y});
  }
}

void read_counterweights(const TomlTable& table, const SceneNames& names, BalanceProblem& out) {
  for (const std::string& body : table.keys()) {
    const auto one = table.find_table(body);
    if (!one) table.place_of(body).fail("expected a table: {radius = R} or {mass = M}");
    one->allow_keys({"radius", "mass"});
    Counterweight weight;
    weight.body = names.movable_body({body, table.place_of(body)});
    for (const char* const key : {"mass", "inertia", "center.x", "center.y"}) {
      settable_row(out.scene, "body." + body + "." + key, table.place_of(body));
    }
    weight.radius = one->find_number("radius", out.scene.units.length, Range::positive);
    weight.mass = one->find_number("mass", out.scene.units.mass, Range::positive);
    if (weight.radius.has_value() == weight.mass.has_value()) {
      one->place().fail("expected one of the keys radius and mass: the other follows");
    }
    out.counterweights.push_back(weight);
  }
}

void read_weights(const TomlTable& table, BalanceProblem& out) {
  table.allow_keys({"of", "springs", "points", "over"});
  if (const auto springs = table.find_table("springs")) read_springs(*springs, out);
  if (const auto points = table.find_table("points")) read_points(*points, out);
  if (const auto over = table.find_table("over")) read_over(*over, out);
  if (out.stiffnesses.empty() && out.coordinates.empty()) {
    table.place().fail("expected springs or points to choose; add springs = { \"spring.NAME.stiffness\" = [0, 1000] }");
  }
}

void read_shaking(const TomlTable& table, const SceneNames& names, BalanceProblem& out) {
  table.allow_keys({"of", "counterweights", "drive", "rate", "range"});
  if (const auto weights = table.find_table("counterweights")) read_counterweights(*weights, names, out);
  if (out.counterweights.empty()) {
    table.place().fail(
        "expected bodies that may carry a counterweight; add counterweights = { \"BODY\" = {radius = 0.1} }");
  }
  if (const auto drive = table.find_text("drive")) {
    const auto measure = located(drive->place, [&] {
      const auto found = find_measure(out.scene, drive->value);
      if (!found) throw InputError("expected a measure, say \"angle.BODY\"" + why_no_measure(out.scene, drive->value));
      return *found;
    });
    out.drive = drive->value;
    const double unit = unit_of_range(measure.on, out.scene);
    out.rate = table.find_number("rate", unit, Range::positive).value_or(1.0);
    const bool is_angle = measure.on.is_angle();
    const auto range = table.find_vector("range", unit);
    if (!range && !is_angle) table.place_of("range").fail("expected [FROM, TO] of what is driven; add it");
    out.range_from = range ? range->x : 0.0;
    out.range_to = range ? range->y : 2 * std::numbers::pi;
    if (out.range_from == out.range_to) table.place_of("range").fail("expected a range with a length");
  } else {
    for (const char* const key : {"rate", "range"}) {
      if (table.has(key)) table.place_of(key).fail("expected the key drive too: what moves");
    }
  }
}

}  // namespace

BalanceProblem read_balance(const fs::path& file) {
  const std::string text = read_text_file(file);
  BalanceProblem out;
  out.file = file.string();
  const toml::table document = parse_toml(text, out.file);
  const TomlTable root(document, {out.file, 1, ""});
  root.allow_keys({"title", "source", "scene", "balance"});
  if (const auto title = root.find_text("title")) out.title = title->value;
  if (const auto source = root.find_text("source")) out.source = source->value;
  out.scene = read_scene(file.parent_path() / root.text("scene").value);
  refuse_blades(out.scene, "designs");
  SceneNames names(out.scene);
  for (std::size_t i = 0; i < out.scene.bodies.size(); ++i) names.learn_body(static_cast<int>(i));
  const auto table = root.find_table("balance");
  if (!table) root.place().fail("expected a table [balance]; add it");
  out.line = table->place().line;
  out.of = choose(table->text("of"), {"weights", "shaking"}) == 0 ? BalanceProblem::Of::weights
                                                                  : BalanceProblem::Of::shaking;
  if (out.of == BalanceProblem::Of::weights) {
    read_weights(*table, out);
  } else {
    read_shaking(*table, names, out);
  }
  return out;
}

}  // namespace poise
