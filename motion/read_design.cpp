#include <algorithm>
#include <numbers>
#include <tuple>

#include <fmt/format.h>

#include "model/nearest_name.hpp"
#include "model/scene_names.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"
#include "motion/design.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise {
namespace {

namespace fs = std::filesystem;

constexpr double degree = std::numbers::pi / 180;

Interval interval(const TomlTable& table, std::string_view key, double unit) {
  const Vec2 ends = table.vector(key, unit);
  if (!(ends.x <= ends.y)) table.place_of(key).fail("expected [LEAST, GREATEST]; swap them");
  return {ends.x, ends.y};
}

/// "point.BODY.NAME.x" for every point of a moving body.
std::vector<DesignVariable> all_variables(const Scene& scene) {
  std::vector<DesignVariable> out;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
      const PointRef point{static_cast<int>(i), static_cast<int>(p)};
      for (const bool is_y : {false, true}) {
        out.push_back({"point." + scene.name_of(point) + (is_y ? ".y" : ".x"), point, is_y, {}});
      }
    }
  }
  return out;
}

void read_variables(const TomlTable& table, DesignProblem& out) {
  const std::vector<DesignVariable> all = all_variables(out.scene);
  for (const std::string& key : table.keys()) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const DesignVariable& v) { return v.path == key; });
    if (found == all.end()) {
      std::vector<std::string> paths;
      for (const DesignVariable& v : all) paths.push_back(v.path);
      table.place_of(key).fail("expected a coordinate of a point, \"point.BODY.NAME.x\" or .y" +
                               did_you_mean_or_list(key, paths));
    }
    out.variables.push_back(*found);
    out.variables.back().range = interval(table, key, out.scene.units.length);
  }
  if (out.variables.empty()) table.place().fail("expected at least one path with its range; add \"point....x\" = [..]");
}

TomlTable required_table(const TomlTable& root, const std::string& key) {
  const auto table = root.find_table(key);
  if (!table) root.place().fail(fmt::format("expected a table [{}]; add it", key));
  return *table;
}

}  // namespace

DesignProblem read_design(const fs::path& file) {
  const std::string text = read_text_file(file);
  DesignProblem out;
  out.file = file.string();
  const toml::table document = parse_toml(text, out.file);
  const TomlTable root(document, {out.file, 1, ""});
  if (root.has("body") && !root.has("scene")) {
    root.place_of("body").fail("expected a design, found a scene; give a file that names it with scene = \"...\"");
  }
  root.allow_keys({"title", "source", "scene", "drive", "goal", "actuator", "variables"});
  if (const auto title = root.find_text("title")) out.title = title->value;
  if (const auto source = root.find_text("source")) out.source = source->value;
  out.scene = read_scene(file.parent_path() / root.text("scene").value);
  refuse_blades(out.scene, "designs");

  SceneNames names(out.scene);
  for (std::size_t i = 0; i < out.scene.bodies.size(); ++i) names.learn_body(static_cast<int>(i));
  const double length = out.scene.units.length;

  const TomlTable drive = required_table(root, "drive");
  drive.allow_keys({"body", "from", "turn"});
  out.driver = names.movable_body(drive.text("body"));
  out.from = interval(drive, "from", degree);
  out.turn = interval(drive, "turn", degree);
  if (out.turn.min <= 0.0 && out.turn.max >= 0.0) {
    drive.place_of("turn").fail("expected a range that does not contain 0; the body must turn");
  }

  const TomlTable goal = required_table(root, "goal");
  goal.allow_keys({"point", "travel", "drift", "level", "inclination", "transmission", "shortest", "longest"});
  out.guided = names.point(goal.text("point"));
  out.travel = goal.number("travel", length, Range::positive);
  out.drift = goal.number("drift", length, Range::positive);
  out.level = names.movable_body(goal.text("level"));
  out.inclination = goal.number("inclination", degree, Range::positive);
  out.transmission = goal.number("transmission", degree, Range::positive);
  out.shortest = goal.number("shortest", length, Range::positive);
  out.longest = goal.number("longest", length, Range::positive);

  for (const TomlTable& table : root.tables("actuator")) {
    table.allow_keys({"points", "ratio", "lever"});
    Actuator actuator;
    std::tie(actuator.a, actuator.b) = names.two_points(table);
    actuator.name = out.scene.name_of(actuator.a) + "-" + out.scene.name_of(actuator.b);
    actuator.ratio = table.number("ratio", 1.0, Range::positive);
    actuator.lever = table.number("lever", length, Range::positive);
    out.actuators.push_back(actuator);
  }
  read_variables(required_table(root, "variables"), out);
  return out;
}

}  // namespace poise
