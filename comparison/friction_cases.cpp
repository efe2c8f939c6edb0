#include "comparison/friction_cases.hpp"

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "model/read_parameter_changes.hpp"
#include "model/scene_names.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::comparison {
namespace {
namespace fs = std::filesystem;

constexpr const char* cases_file = "friction.toml";

FrictionCase read_case(const TomlTable& table, const fs::path& folder) {
  table.allow_keys({"name", "title", "source", "scene", "set", "expect", "without_end"});
  FrictionCase out;
  const TomlText name = table.text("name");
  check_name(name.value, name.place);
  out.name = name.value;
  out.title = table.text("title").value;
  out.source = table.text("source").value;
  const TomlText scene_name = table.text("scene");
  const fs::path file = (folder / scene_name.value).lexically_normal();
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown)) {
    scene_name.place.fail(
        fmt::format("expected a scene file, relative to this file; there is no \"{}\"", file.string()));
  }
  out.scene = file.string();
  Scene scene = read_scene(file);
  out.changes = read_parameter_changes(table, scene);
  if (!has_friction(scene)) scene_name.place.fail("expected a scene with friction");
  out.verdict = choose(table.text("expect"), {"held", "slips"}) == 0 ? Holding::held : Holding::slips;
  if (const auto number = table.find_text("without_end")) {
    if (out.verdict != Holding::held) number->place.fail("expected no range without end of a position that slips");
    if (!find_parameter(scene, number->value)) number->place.fail("expected a number of the scene");
    out.without_end = number->value;
  }
  return out;
}

}  // namespace

std::vector<FrictionCase> read_friction_cases(const fs::path& folder) {
  const fs::path file = (folder / cases_file).lexically_normal();
  std::error_code unknown;
  std::vector<FrictionCase> out;
  if (!fs::is_regular_file(file, unknown)) return out;
  const std::string shown = file.string();
  const toml::table document = parse_toml(read_text_file(file), shown);
  const TomlTable root(document, {shown, 1, ""});
  root.allow_keys({"case"});
  std::map<std::string, int> taken;  // lines
  for (const TomlTable& table : root.tables("case")) {
    out.push_back(read_case(table, folder));
    const TomlPlace place = table.place_of("name");
    const auto [other, is_new] = taken.emplace(out.back().name, place.line);
    if (!is_new) place.fail(fmt::format("expected a name of its own, it is taken in line {}", other->second));
  }
  return out;
}

FrictionResult run_friction_case(const FrictionCase& known) {
  Scene scene = read_scene(known.scene);
  for (const ParameterChange& change : known.changes) set_value(scene, change.path, change.value);
  const StaticModel model(std::move(scene));
  const std::vector<double> x = assemble(model);
  FrictionResult out;
  out.known = known;
  if (known.without_end.empty()) {
    out.pose = held_pose(model, x);
    out.agrees = out.pose.verdict == known.verdict;
    out.proved = out.agrees && out.pose.proved;
  } else {
    const HeldRange range = held_range(model, x, known.without_end);
    out.pose = range.now;
    out.agrees = range.contains_now && std::isinf(range.upper.value);
    out.proved = out.agrees && out.pose.proved && range.upper.proved;
    if (range.contains_now && !out.agrees) {
      out.why = fmt::format("it is held up to {} = {} (SI) only", known.without_end, range.upper.value);
    }
  }
  if (out.pose.verdict == Holding::not_decided) out.why = out.pose.why;
  if (!out.agrees && out.why.empty()) out.why = "another verdict is known";
  return out;
}

}  // namespace poise::comparison
