#include "model/parts.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "model/expression.hpp"
#include "model/nearest_name.hpp"
#include "model/part_placing.hpp"
#include "model/read_scene.hpp"
#include "model/text_file.hpp"

namespace poise {

namespace parts {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t deepest_part = 16;
constexpr int most_repeats = 1000;

/// The path without links and dots.
fs::path resolved(const fs::path& path) {
  std::error_code failed;
  const fs::path whole = fs::absolute(path, failed);
  fs::path out = failed ? fs::path() : fs::weakly_canonical(whole, failed);
  if (failed) throw InputError("expected the name of a file, found \"" + path.string() + "\": " + failed.message());
  return out;
}

}  // namespace

/// Puts the parts of a document in their places, those of a part's file before the part itself.
class Expander {
 public:
  Expander(PartedDocument& out, const TomlPlace& place) : out_(out), place_(place) {
    // A scene that is built in code has no folder.
    if (place.line > 0) file_ = place.file;
    folder_ = resolved(file_.has_parent_path() ? file_.parent_path() : ".");
  }

  void run() {
    Level scene{std::move(out_.document_), {}, "", {}, place_};
    scene.units = units_of_document(scene);
    expand(scene, {});
    merge_globals(scene);
    out_.document_ = std::move(scene.document);
  }

 private:
  /// Numbers of parts' files, unless the scene has them; in the order of the files in both cases.
  void merge_globals(Level& scene) {
    toml::table* const numbers =
        shared_.globals.empty() && out_.given_.empty() ? nullptr : made_table(scene.document, "numbers");
    if (numbers == nullptr) return;
    for (auto&& [key, node] : shared_.globals) {
      const std::string name(key.str());
      toml::node* const own = numbers->get(name);
      if (own != nullptr && out_.given_.erase(name) == 0) fail_number_taken(place_, name);
      toml::node& value = own != nullptr ? *own : node;
      toml::table one;
      one.insert_or_assign(key, std::move(value));
      numbers->erase(name);
      numbers->insert_or_assign(key, std::move(*one.get(name)));
    }
    for (auto& [name, given] : out_.given_) {
      const std::optional<double> value = numbers->get(name)->value<double>();
      if (!value) given.place.fail("expected a number");
      given.value = *value;
      numbers->erase(name);
    }
  }

  Units units_of_document(const Level& level) const {
    const TomlTable root(level.document, level.place, nullptr, &out_.files_);
    const std::optional<TomlTable> units = root.find_table("units");
    return units ? read_units(*units) : Units{};
  }

  static std::string in_front(const std::string& name, const std::string& of) {
    return name.empty() ? of : name + "." + of;
  }

  void expand(Level& level, std::vector<fs::path> chain) {
    if (level.document.get_as<toml::table>("numbers") != nullptr) {
      const TomlTable root(level.document, level.place, nullptr, &out_.files_);
      const TomlTable table = *root.find_table("numbers");
      for (const std::string& name : table.keys()) {
        const bool is_of_part = level.name.empty() && name.find('.') != std::string::npos;
        if (is_of_part)
          out_.given_.emplace(name, PartedDocument::Given{table.place_of(name), 0.0});
        else
          check_number_name(name, table);
      }
    }
    toml::node* const list = level.document.get("part");
    if (list == nullptr) return;
    toml::table tables;
    tables.insert_or_assign("part", std::move(*list));
    level.document.erase("part");
    const TomlTable root(tables, level.place, nullptr, &out_.files_);
    std::vector<toml::table*> written = tables_in(tables, "part");
    std::set<std::string> taken;
    for (const TomlTable& table : root.tables("part")) {
      Group group = read_group(level, table, *written.front());
      written.erase(written.begin());
      const auto in_chain = std::find(chain.begin(), chain.end(), group.file);
      if (in_chain != chain.end() || group.file == folder_ / file_.filename()) {
        std::string names = file_.filename().string();
        for (const fs::path& one : chain) names += " -> " + one.filename().string();
        table.place_of("file").fail("expected files that do not contain themselves, found " + names + " -> " +
                                    group.file.filename().string());
      }
      if (chain.size() >= deepest_part) {
        table.place().fail(fmt::format("expected parts within parts to a depth of at most {}", deepest_part));
      }
      chain.push_back(group.file);
      for (int k = 1; k <= group.count; ++k) {
        const std::string instance = group.is_repeated ? fmt::format("{}_{}", group.name, k) : group.name;
        if (!taken.insert(instance).second) {
          table.place_of("name").fail("expected a name of its own; a part called \"" + instance +
                                      "\" is there already");
        }
        group.instances.push_back(instance);
        add(level, group, k, chain);
      }
      chain.pop_back();
    }
    for (const Joined& one : level.joined) check_joined(one, level.document);
  }

  // The parts of a document may join points of each other, so that all have to be there before.
  static void check_joined(const Joined& one, toml::table& document) {
    std::vector<std::string> known;
    const auto learn = [&](const std::string& body, toml::table* of) {
      toml::table* const points = of != nullptr ? table_in(*of, "points") : nullptr;
      if (points == nullptr) return;
      for (auto&& [point, at] : *points) known.push_back(body + "." + std::string(point.str()));
    };
    learn(std::string(fixed_frame), table_in(document, fixed_frame));
    toml::table* const bodies = table_in(document, "body");
    if (bodies == nullptr) return;
    for (auto&& [name, body] : *bodies) learn(std::string(name.str()), body.as_table());
    if (std::find(known.begin(), known.end(), one.to) != known.end()) return;
    one.place.fail("expected a point \"BODY.POINT\" of the scene or of one of its parts, found \"" + one.to + "\"" +
                   did_you_mean_or_list(one.to, known));
  }

  Group read_group(const Level& level, const TomlTable& table, toml::table& written) {
    table.allow_keys({"name", "file", "at", "angle", "scale", "mirror", "on", "join", "join_next", "repeat", "step",
                      "turn", "numbers"});
    Group group{&table, &written};
    const TomlText file = table.text("file");
    const fs::path from = file.place.line > 0 ? fs::path(file.place.file) : fs::path();
    group.shown = from.parent_path() / file.value;
    group.file = located(file.place, [&] { return resolved(group.shown); });
    if (std::mismatch(folder_.begin(), folder_.end(), group.file.begin(), group.file.end()).first != folder_.end()) {
      file.place.fail("expected a file in the folder of the scene or below it, found \"" + file.value +
                      "\"; copy it there");
    }
    if (!texts_.contains(group.file)) {
      if (!fs::exists(group.shown)) fail_missing(file, group.shown);
      texts_[group.file] = located(file.place, [&] {
        expect_regular_file(group.shown);
        return read_text_file(group.shown);
      });
    }
    const std::string stem = group.shown.stem().string();
    group.number_scope = name_in_expressions(stem);
    std::replace(group.number_scope.begin(), group.number_scope.end(), '.', '_');
    const auto [other, is_new] = stems_.emplace(group.number_scope, group.file);
    if (!is_new && other->second != group.file) {
      file.place.fail("expected a file whose name gives other numbers than those of " + other->second.string() +
                      " names: numbers." + group.number_scope + ". ...; rename one of the files");
    }
    const std::optional<TomlText> name = table.find_text("name");
    group.name = name ? name->value : stem;
    if (!Expression::is_name(group.name)) {
      table.place_of("name").fail(
          "expected a name of letters, digits and underscores that does not begin with a digit, "
          "found \"" +
          group.name + "\"; give the part another name");
    }
    if (const auto* bodies = level.document.get_as<toml::table>("body");
        group.name == fixed_frame || (bodies != nullptr && bodies->contains(group.name))) {
      table.place_of("name").fail("expected a name of its own; \"" + group.name +
                                  "\" is a body; give the part another");
    }
    group.mirrored = table.flag("mirror", false);
    group.scale = amount_in(table, written, "scale", Range::positive, 1.0);
    group.is_repeated = table.has("repeat");
    const double count = table.find_number("repeat", 1.0, Range::finite).value_or(1.0);
    if (count != std::floor(count) || count < 1.0 || count > most_repeats) {
      table.place_of("repeat").fail(fmt::format("expected a whole number from 1 to {}, found {}", most_repeats, count));
    }
    group.count = static_cast<int>(count);
    group.turn = amount_in(table, written, "turn", Range::finite, 0.0);
    for (const std::string_view key : {"step", "turn", "join_next"}) {
      if (table.has(key) && !group.is_repeated) {
        table.place_of(key).fail("expected the key repeat beside " + std::string(key) + "; add repeat = 2");
      }
    }
    group.at = place_in(table, written, "at");
    group.step = place_in(table, written, "step");
    group.angle = amount_in(table, written, "angle", Range::finite, 0.0);
    group.on = table.has("on") ? table.text("on").value : std::string(fixed_frame);
    group.join = names_in(table, "join");
    group.join_next = names_in(table, "join_next");
    if (table.has("numbers")) {
      table.find_table("numbers");
      group.numbers = table_in(written, "numbers");
    }
    return group;
  }

  // Where the folder has a file of nearly that name; reading fails of all others.
  static void fail_missing(const TomlText& file, const fs::path& shown) {
    std::vector<std::string> known;
    std::error_code failed;
    for (const auto& one : fs::directory_iterator(shown.has_parent_path() ? shown.parent_path() : ".", failed)) {
      if (one.path().extension() == ".toml") known.push_back(one.path().filename().string());
    }
    const std::string near = did_you_mean(shown.filename().string(), known);
    if (!near.empty()) file.place.fail("expected a file that is there, found \"" + file.value + "\"" + near);
  }

  static Amount amount_in(const TomlTable& table, const toml::table& written, std::string_view key, Range range,
                          double otherwise) {
    if (table.holds_text(key)) return Amount::of(written.get(key));
    return {table.find_number(key, 1.0, range).value_or(otherwise)};
  }

  static Place place_in(const TomlTable& table, const toml::table& written, std::string_view key) {
    const toml::node* const node = written.get(key);
    if (node == nullptr) return {};
    const toml::array* const list = node->as_array();
    const auto is_amount = [](const toml::node& one) {
      return one.is_string() || (one.is_number() && contains(Range::finite, *one.value<double>()));
    };
    if (list == nullptr || list->size() != 2 || !std::all_of(list->begin(), list->end(), is_amount)) {
      table.place_of(key).fail("expected two finite numbers [X, Y]");
    }
    return {Amount::component(node, 0), Amount::component(node, 1)};
  }

  static std::map<std::string, std::string> names_in(const TomlTable& table, std::string_view key) {
    std::map<std::string, std::string> out;
    if (const std::optional<TomlTable> names = table.find_table(key)) {
      for (const std::string& name : names->keys()) out[name] = names->text(name).value;
    }
    return out;
  }

  void add(Level& level, const Group& group, int k, const std::vector<fs::path>& chain) {
    // The weld that holds the part is in the units of the document, in front of all joints of the part.
    PartUse& holding = out_.uses_.emplace_back();
    static_cast<TomlPart&>(holding) = level.place.part != nullptr ? *level.place.part : out_.own_;
    holding.units = level.units;
    const auto path = std::make_shared<const std::string>(holding.file);
    out_.paths_.push_back(path);
    out_.files_.add(path, holding);
    PartUse& use = out_.uses_.emplace_back();
    use.file = group.shown.string();
    use.name = in_front(level.name, group.instances.back());
    use.line = group.table->place().line_in_document();
    use.within = out_.own_.file;
    use.file_stem = group.number_scope;
    toml::table document = parse_toml(texts_[group.file], use);
    out_.paths_.push_back(document.source().path);
    out_.files_.add(document.source().path, use);
    Level part{std::move(document), {}, use.name, {}, TomlPlace{use.file, 1, "", &use}};
    use.units = part.units = units_of_document(part);
    expand(part, chain);
    part.uses.push_back(&use);
    const toml::source_position begin = group.written->source().begin;
    Placing(shared_, level, part, group, k, use, {begin, begin, path}).run();
    level.uses.insert(level.uses.end(), part.uses.begin(), part.uses.end());
  }

  PartedDocument& out_;
  Shared shared_{out_};
  TomlPlace place_;
  fs::path file_, folder_;
  std::map<fs::path, std::string> texts_;
  std::map<std::string, fs::path> stems_;
};

}  // namespace parts

PartedDocument::PartedDocument(toml::table document, const TomlPlace& place) : document_(std::move(document)) {
  own_.file = place.file;
  files_.add(nullptr, own_);
  if (document_.contains("part")) parts::Expander(*this, place).run();
}

const PartUse* PartedDocument::use_of(const toml::node& node) const {
  const auto* const use = static_cast<const PartUse*>(files_.of(node.source()).part);
  return use->file_stem.empty() ? nullptr : use;
}

std::string_view PartedDocument::key_in_file(const toml::node& number, std::string_view key) const {
  const auto found = moved_.find(spot_of(number));
  return found != moved_.end() ? std::string_view(found->second) : key;
}

}  // namespace poise
