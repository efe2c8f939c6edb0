#include "comparison/catalogue.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "comparison/series.hpp"
#include "model/read_parameter_changes.hpp"
#include "model/scene_names.hpp"
#include "model/text_file.hpp"
#include "model/toml_reader.hpp"

namespace poise::comparison {
namespace {
namespace fs = std::filesystem;

constexpr const char* list_file = "catalogue.toml";

/// A case's name and the "file:line" that gave it.
using NamesTaken = std::map<std::string, std::string>;

int small_number(const TomlTable& table, std::string_view key, int otherwise) {
  const long long number = table.whole_number(key, 1, otherwise);
  if (number > std::numeric_limits<int>::max()) table.place_of(key).fail("expected at most 2^31 - 1");
  return static_cast<int>(number);
}

std::size_t read_choice(const TomlTable& table, std::string_view key, const std::vector<std::string>& words) {
  const auto text = table.find_text(key);
  return text ? choose(*text, words) : 0;
}

std::string required_text(const TomlTable& table, std::string_view key) {
  const TomlText text = table.text(key);
  if (text.value.empty()) text.place.fail("expected some text");
  return text.value;
}

/// Reads one file of cases.
class CasesReader {
 public:
  CasesReader(const TomlTable& root, const fs::path& file) : root_(root), folder_(file.parent_path()) {}

  void read(NamesTaken& taken, std::vector<HardCase>& cases) {
    root_.allow_keys({"kind", "case"});
    const std::string kind = required_text(root_, "kind");
    const std::vector<TomlTable> tables = root_.tables("case");
    if (tables.empty()) root_.place().fail("case: expected at least one case; add [[case]]");
    for (const TomlTable& table : tables) {
      HardCase hard = read_case(table);
      hard.kind = kind;
      expect_new_name(table, hard.name, taken);
      cases.push_back(std::move(hard));
    }
  }

 private:
  HardCase read_case(const TomlTable& table) const {
    table.allow_keys({"name", "title", "source", "scene", "series", "size", "set", "seek", "expect", "why", "starts",
                      "reach", "complete", "turns_count", "everywhere", "equilibrium"});
    HardCase hard;
    const TomlText name = table.text("name");
    check_name(name.value, name.place);
    hard.name = name.value;
    hard.title = required_text(table, "title");
    hard.source = required_text(table, "source");
    const std::optional<Scene> scene = read_its_scene(table, hard);
    hard.seek = read_choice(table, "seek", {"nearest", "stable"}) == 0 ? Seek::any : Seek::stable;
    hard.answer = static_cast<KnownAnswer>(read_choice(table, "expect", {"equilibrium", "locked", "none"}));
    if (table.has("why")) hard.why = required_text(table, "why");
    hard.starts = small_number(table, "starts", hard.starts);
    hard.reach = table.find_number("reach", 1.0, Range::not_negative).value_or(hard.reach);
    hard.complete = table.flag("complete", false);
    hard.turns_count = table.flag("turns_count", false);
    hard.everywhere = table.flag("everywhere", false);
    for (const TomlTable& known : table.tables("equilibrium")) hard.known.push_back(read_equilibrium(known, scene));
    expect_consistent(table, hard);
    return hard;
  }

  /// The scene of the file with its changes; empty for a series, which may be huge.
  std::optional<Scene> read_its_scene(const TomlTable& table, HardCase& hard) const {
    if (table.has("scene") == table.has("series")) table.place().fail("expected one of the keys scene, series");
    if (table.has("series")) {
      read_series(table, hard);
      return std::nullopt;
    }
    if (table.has("size")) table.place_of("size").fail("expected no size with a scene; series have one");
    const TomlText name = table.text("scene");
    const fs::path file = (folder_ / name.value).lexically_normal();
    std::error_code unknown;
    if (!fs::is_regular_file(file, unknown)) {
      name.place.fail(fmt::format("expected a scene file, relative to this file; there is no \"{}\"", file.string()));
    }
    hard.scene = file.string();
    Scene scene = read_scene(file);
    hard.changes = read_parameter_changes(table, scene);
    return scene;
  }

  static void read_series(const TomlTable& table, HardCase& hard) {
    const TomlText series = table.text("series");
    choose(series, series_names());
    hard.series = series.value;
    if (!table.has("size")) table.place().fail("expected the key size with a series; add size = NUMBER");
    hard.size = small_number(table, "size", 1);
    if (table.has("set")) table.place_of("set").fail("expected no settings with a series; write a scene file");
  }

  static KnownEquilibrium read_equilibrium(const TomlTable& table, const std::optional<Scene>& scene) {
    table.allow_keys({"angles", "travels", "stability"});
    KnownEquilibrium known;
    known.angles = read_numbers(table, "angles");
    known.travels = read_numbers(table, "travels");
    if (known.angles.empty() && known.travels.empty()) {
      table.place().fail("expected an angle or a travel; add angles = { BODY = NUMBER }");
    }
    constexpr Stability kinds[] = {Stability::stable, Stability::unstable, Stability::neutral, Stability::unknown};
    std::vector<std::string> words;
    for (const Stability kind : kinds) words.push_back(to_string(kind));
    known.stability = kinds[choose(table.text("stability"), words)];
    if (scene) expect_names(table, *scene);
    return known;
  }

  static std::map<std::string, double> read_numbers(const TomlTable& owner, std::string_view key) {
    std::map<std::string, double> numbers;
    const std::optional<TomlTable> table = owner.find_table(key);
    if (!table) return numbers;
    for (const std::string& name : table->keys()) {
      if (table->holds_table(name)) {
        table->place_of(name).fail("expected a number; put a name that holds dots in quotes");
      }
      numbers[name] = table->number(name, 1.0, Range::finite);
    }
    return numbers;
  }

  /// Angles are those of moving bodies, travels those of slides and pins in slots.
  static void expect_names(const TomlTable& table, const Scene& scene) {
    SceneNames names(scene);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) names.learn_body(static_cast<int>(i));
    for (std::size_t i = 0; i < scene.joints.size(); ++i) names.learn_joint(static_cast<int>(i));
    if (const auto angles = table.find_table("angles")) {
      for (const std::string& name : angles->keys()) names.movable_body({name, angles->place_of(name)});
    }
    if (const auto travels = table.find_table("travels")) {
      for (const std::string& name : travels->keys()) names.travelling_joint({name, travels->place_of(name)});
    }
  }

  static void expect_consistent(const TomlTable& table, const HardCase& hard) {
    if (hard.answer != KnownAnswer::equilibrium) {
      for (const char* const key : {"equilibrium", "complete", "everywhere"}) {
        if (!table.has(key)) continue;
        table.place_of(key).fail("expected no such key in a case without equilibrium; remove it or the key expect");
      }
      if (hard.why.empty()) table.place().fail("expected the key why, the reason to report; add why = \"...\"");
      return;
    }
    if (table.has("why")) {
      table.place_of("why").fail(
          "expected no such key in a case with an equilibrium; it gives the reason why there is none");
    }
    if (hard.everywhere) {
      for (const char* const key : {"equilibrium", "complete"}) {
        if (table.has(key)) table.place_of(key).fail("expected no such key if every closed position is an equilibrium");
      }
      return;
    }
    if (hard.complete && hard.known.empty()) {
      table.place_of("complete").fail("expected an equilibrium in a complete list; add [[case.equilibrium]]");
    }
    const auto is_unstable = [](const KnownEquilibrium& known) { return known.stability == Stability::unstable; };
    if (hard.complete && hard.seek == Seek::stable && std::all_of(hard.known.begin(), hard.known.end(), is_unstable)) {
      table.place_of("seek").fail("expected at least one equilibrium in the list that is not unstable");
    }
  }

  static void expect_new_name(const TomlTable& table, const std::string& name, NamesTaken& taken) {
    const TomlPlace place = table.place_of("name");
    const auto [other, is_new] = taken.emplace(name, fmt::format("{}:{}", place.file, place.line));
    if (!is_new)
      place.fail(fmt::format("expected a name of its own, it is taken in {}; rename the case", other->second));
  }

  TomlTable root_;
  fs::path folder_;
};

void read_cases(const TomlText& name, const fs::path& folder, NamesTaken& taken, std::vector<HardCase>& cases) {
  const fs::path file = (folder / name.value).lexically_normal();
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown)) {
    name.place.fail(fmt::format("expected a file of cases, relative to this file; there is no \"{}\"", file.string()));
  }
  const std::string shown = file.string();
  const toml::table document = parse_toml(read_text_file(file), shown);
  CasesReader(TomlTable(document, {shown, 1, ""}), file).read(taken, cases);
}

}  // namespace

std::vector<HardCase> read_catalogue(const fs::path& folder) {
  const fs::path file = (folder / list_file).lexically_normal();
  const std::string shown = file.string();
  const toml::table document = parse_toml(read_text_file(file), shown);
  const TomlTable root(document, {shown, 1, ""});
  root.allow_keys({"files"});
  const std::vector<TomlText> files = root.texts("files");
  if (files.empty()) root.place_of("files").fail("expected at least one file of cases; add files = [\"...\"]");
  NamesTaken taken;
  std::vector<HardCase> cases;
  for (const TomlText& name : files) read_cases(name, folder, taken, cases);
  return cases;
}

Scene scene_of(const HardCase& hard) {
  Scene scene = hard.scene.empty() ? series_scene(hard.series, hard.size) : read_scene(hard.scene);
  for (const ParameterChange& change : hard.changes) set_value(scene, change.path, change.value);
  return scene;
}

}  // namespace poise::comparison
