#include "model/parts.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/expression.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "model/read_elements.hpp"
#include "model/read_scene.hpp"
#include "model/scene_names.hpp"
#include "model/text_file.hpp"

namespace poise {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_items = 10'000;
constexpr std::size_t deepest_part = 16;
constexpr long long most_repeats = 1000;
constexpr std::string_view fixed_frame = "ground";

bool is_letter_of_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

std::string* text_in(toml::table& table, std::string_view key) {
  toml::value<std::string>* const value = table.get_as<std::string>(key);
  return value != nullptr ? &value->get() : nullptr;
}

toml::array* list_in(toml::table& table, std::string_view key) { return table.get_as<toml::array>(key); }

toml::table* table_in(toml::table& table, std::string_view key) { return table.get_as<toml::table>(key); }

/// The table under a key, which is made where there is none; null where something else is there.
toml::table* made_table(toml::table& in, std::string_view key) {
  if (!in.contains(key)) in.insert_or_assign(key, toml::table{});
  return table_in(in, key);
}

/// The tables of [[key]].
std::vector<toml::table*> tables_in(toml::table& document, std::string_view key) {
  std::vector<toml::table*> out;
  toml::array* const list = list_in(document, key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    if (toml::table* const table = list->get_as<toml::table>(i)) out.push_back(table);
  }
  return out;
}

/// The expression with other names in the place of its own: rename(name) of each that is neither pi nor a function.
template <class Rename>
std::string renamed(std::string_view text, Rename rename) {
  const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  const auto is_letter = [&](std::size_t i) { return i < text.size() && is_letter_of_name(text[i]); };
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t begin = i;
    if (is_digit(i) || (text[i] == '.' && is_digit(i + 1))) {
      while (is_digit(i) || (i < text.size() && text[i] == '.')) ++i;
      if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        const std::size_t sign = i + 1 < text.size() && (text[i + 1] == '+' || text[i + 1] == '-') ? 1 : 0;
        if (is_digit(i + 1 + sign)) i += 1 + sign;
        while (is_digit(i)) ++i;
      }
      out += text.substr(begin, i - begin);
    } else if (is_letter(i)) {
      while (is_letter(i) || (i < text.size() && text[i] == '.' && is_letter(i + 1))) ++i;
      const std::string name(text.substr(begin, i - begin));
      const std::size_t next = text.find_first_not_of(" \t\r\n", i);
      const bool is_called = next != std::string_view::npos && text[next] == '(';
      out += is_called || name == "pi" ? name : rename(name);
    } else {
      out += text[i++];
    }
  }
  return out;
}

}  // namespace

namespace parts {

/// A number, or an expression of one.
struct Amount {
  double value = 0.0;
  std::string text{};  ///< empty of a number

  static Amount of(const toml::node* node) {
    if (node == nullptr) return {};
    if (const auto* text = node->as_string()) return {0.0, text->get()};
    return {node->value<double>().value_or(0.0)};
  }
  static Amount component(const toml::node* list, std::size_t at) {
    const toml::array* const all = list != nullptr ? list->as_array() : nullptr;
    return all != nullptr ? of(all->get(at)) : Amount{};
  }
  bool is_number() const { return text.empty(); }
  bool is(double number) const { return is_number() && value == number; }
  std::string factor() const { return is_number() && value >= 0.0 ? fmt::format("{}", value) : "(" + whole() + ")"; }
  std::string whole() const { return is_number() ? fmt::format("{}", value) : text; }
  template <class Add>
  void put(Add add) const {
    if (is_number())
      add(value);
    else
      add(text);
  }
};

inline Amount operator+(const Amount& a, const Amount& b) {
  if (a.is_number() && b.is_number()) return {a.value + b.value};
  if (a.is(0.0)) return b;
  if (b.is(0.0)) return a;
  return {0.0, a.whole() + " + " + b.factor()};
}

inline Amount operator*(const Amount& a, const Amount& b) {
  if (a.is_number() && b.is_number()) return {a.value * b.value};
  if (a.is(0.0) || b.is(0.0)) return {};
  if (a.is(1.0)) return b;
  if (b.is(1.0)) return a;
  return {0.0, a.factor() + "*" + b.factor()};
}

struct Place {
  Amount x, y;
};

/// A direction in the plane, at an angle in rad per unit.
struct Direction {
  Amount cos{1.0}, sin{};

  static Direction at(const Amount& angle, double unit) {
    if (angle.is_number()) return {{std::cos(angle.value * unit)}, {std::sin(angle.value * unit)}};
    const std::string radians = unit == 1.0 ? angle.text : fmt::format("{}*({})", unit, angle.text);
    return {{0.0, "cos(" + radians + ")"}, {0.0, "sin(" + radians + ")"}};
  }
  Place turned(const Place& p) const { return {cos * p.x + Amount{-1.0} * (sin * p.y), sin * p.x + cos * p.y}; }
};

inline toml::array array_of(const Place& place) {
  toml::array out;
  place.x.put([&](const auto& x) { out.push_back(x); });
  place.y.put([&](const auto& y) { out.push_back(y); });
  return out;
}

}  // namespace parts

namespace {

/// The first name of "BODY.POINT".
std::string body_of_point(const std::string& point) { return point.substr(0, point.rfind('.')); }

/// Tables of the items of a scene, [[pin]] to [[rope]].
std::vector<std::string_view> item_tables() {
  std::vector<std::string_view> keys;
  for (const JointTraits& kind : Joint::kinds) keys.push_back(kind.key);
  for (const std::string_view key : element_tables()) keys.push_back(key);
  keys.insert(keys.end(), {"drive", "force", "distributed_load", "torque", "stop"});
  for (const CouplingKind& kind : coupling_kinds()) {
    if (kind.row == 0) keys.push_back(kind.table);
  }
  return keys;
}

/// The path without links and dots.
fs::path resolved(const fs::path& path) {
  std::error_code failed;
  const fs::path whole = fs::absolute(path, failed);
  const fs::path out = failed ? fs::path() : fs::weakly_canonical(whole, failed);
  if (failed) throw InputError("expected the name of a file, found \"" + path.string() + "\": " + failed.message());
  return out;
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// Gives items without names those that they have in a scene of their own.
void give_names(toml::table& document, const TomlTable& root) {
  const auto give = [&](const std::vector<std::string_view>& keys, auto default_names) {
    std::vector<TomlTable> read;
    std::vector<toml::table*> written;
    std::vector<std::string> defaults;
    for (const std::string_view key : keys) {
      const std::vector<TomlTable> tables = root.tables(key);
      for (const std::string& name : default_names(key, tables)) defaults.push_back(name);
      read.insert(read.end(), tables.begin(), tables.end());
      for (toml::table* const one : tables_in(document, key)) written.push_back(one);
    }
    std::vector<std::size_t> order(read.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return read[a].position() < read[b].position(); });
    std::vector<TomlTable> sorted;
    std::vector<std::string> of_sorted;
    for (const std::size_t i : order) {
      sorted.push_back(read[i]);
      of_sorted.push_back(defaults[i]);
    }
    const std::vector<std::string> names = names_of(sorted, of_sorted, {});
    for (std::size_t i = 0; i < order.size(); ++i) {
      toml::table& table = *written[order[i]];
      if (!table.contains("name")) table.insert_or_assign(toml::key("name", table.source()), names[i]);
    }
  };
  std::vector<std::string_view> joints;
  for (const JointTraits& kind : Joint::kinds) joints.push_back(kind.key);
  give(joints, [](std::string_view, const std::vector<TomlTable>& tables) {
    std::vector<std::string> out;
    for (const TomlTable& table : tables) {
      const std::array<TomlText, 2> points = table.two_texts("points");
      out.push_back(points[0].value + "-" + points[1].value);
    }
    return out;
  });
  const auto by_words = [](std::string_view key, const std::vector<TomlTable>& tables) {
    return numbered(words_of_key(key), tables.size());
  };
  for (const std::string_view key : element_tables()) give({key}, by_words);
  give({"drive"}, by_words);
  give({"force", "distributed_load", "torque"}, by_words);
  give({"stop"}, by_words);
  for (const CouplingKind& kind : coupling_kinds()) {
    if (kind.row > 0) continue;
    give({kind.table},
         [](std::string_view key, const std::vector<TomlTable>& tables) { return numbered(key, tables.size()); });
  }
}

}  // namespace

/// Puts the parts of a document in their places, those of a part's file before the part itself.
class PartExpander {
  using Amount = parts::Amount;
  using Place = parts::Place;
  using Direction = parts::Direction;

 public:
  PartExpander(PartedDocument& out, const TomlPlace& place) : out_(out), place_(place) {
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
  /// A file that is being read: the scene's own, or that of a part.
  struct Level {
    toml::table document;
    Units units;
    std::string name;  ///< in front of its items in the scene; empty of the scene's own
    std::vector<PartUse*> uses;
    TomlPlace place;
  };

  /// Numbers of parts' files, unless the scene has them; in the order of the files in both cases.
  void merge_globals(Level& scene) {
    toml::table* const numbers =
        globals_.empty() && out_.given_.empty() ? nullptr : made_table(scene.document, "numbers");
    if (numbers == nullptr) return;
    for (auto&& [key, node] : globals_) {
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

  /// What a table [[part]] says.
  struct Group {
    const TomlTable* table;
    toml::table* written;
    std::string name{}, number_scope{};
    fs::path shown{}, file{};
    bool mirrored = false, is_repeated = false;
    double scale = 1.0, turn = 0.0;
    int count = 1;
    Place at{}, step{};
    Amount angle{};
    std::string on{};
    std::map<std::string, std::string> join{}, join_next{};
    std::vector<std::string> instances{};
    toml::table* numbers = nullptr;
  };

  Units units_of_document(const Level& level) const {
    const TomlTable root(level.document, level.place, nullptr, &out_.files_);
    const std::optional<TomlTable> units = root.find_table("units");
    return units ? read_units(*units) : Units{};
  }

  static std::string in_front(const std::string& name, const std::string& of) {
    return name.empty() ? of : name + "." + of;
  }

  [[noreturn]] static void fail_number_taken(const TomlPlace& place, const std::string& name) {
    place.fail("expected numbers of different names, found two called \"" + name +
               "\": one that all parts of a file share, and one that a part gives; give the part another name");
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
        bodies != nullptr && bodies->contains(group.name)) {
      table.place_of("name").fail("expected a name of its own; \"" + group.name +
                                  "\" is a body; give the part another");
    }
    group.mirrored = table.flag("mirror", false);
    group.scale = table.find_number("scale", 1.0, Range::positive).value_or(1.0);
    group.is_repeated = table.has("repeat");
    const long long count = table.whole_number("repeat", 1, 1);
    if (count > most_repeats) {
      table.place_of("repeat").fail(fmt::format("expected at most {} parts, found {}", most_repeats, count));
    }
    group.count = static_cast<int>(count);
    group.turn = table.find_number("turn", 1.0, Range::finite).value_or(0.0);
    for (const std::string_view key : {"step", "turn", "join_next"}) {
      if (table.has(key) && !group.is_repeated) {
        table.place_of(key).fail("expected the key repeat beside " + std::string(key) + "; add repeat = 2");
      }
    }
    group.at = place_in(table, written, "at");
    group.step = place_in(table, written, "step");
    if (const toml::node* const angle = written.get("angle")) {
      if (!angle->is_number() && !angle->is_string()) table.place_of("angle").fail("expected a number");
      group.angle = Amount::of(angle);
    }
    group.on = table.has("on") ? table.text("on").value : std::string(fixed_frame);
    group.join = names_in(table, "join");
    group.join_next = names_in(table, "join_next");
    if (table.has("numbers")) {
      table.find_table("numbers");
      group.numbers = table_in(written, "numbers");
    }
    return group;
  }

  static Place place_in(const TomlTable& table, const toml::table& written, std::string_view key) {
    const toml::node* const node = written.get(key);
    if (node == nullptr) return {};
    const toml::array* const list = node->as_array();
    const auto is_amount = [](const toml::node& one) { return one.is_number() || one.is_string(); };
    if (list == nullptr || list->size() != 2 || !std::all_of(list->begin(), list->end(), is_amount)) {
      table.place_of(key).fail("expected two numbers [X, Y]");
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
    for (PartUse* const one : part.uses) {
      one->scale *= group.scale;
    }
    const toml::source_position begin = group.written->source().begin;
    Placing(*this, level, part, group, k, use, {begin, begin, path}).run();
    level.uses.insert(level.uses.end(), part.uses.begin(), part.uses.end());
  }

  /// Brings one part, whose own parts are in their places, into the document that has it.
  class Placing {
   public:
    Placing(PartExpander& all, Level& level, Level& part, const Group& group, int k, PartUse& use,
            toml::source_region held_at)
        : all_(all),
          level_(level),
          part_(part),
          group_(group),
          k_(k),
          use_(use),
          name_(group.instances.back()),
          held_at_(std::move(held_at)) {}

    void run() {
      const TomlTable root(part_.document, part_.place, nullptr, &all_.out_.files_);
      const std::optional<TomlTable> bodies = root.find_table("body");
      if (!bodies || bodies->keys().empty()) root.place().fail("body: expected at least one body; add [body.NAME]");
      if (bodies->has(fixed_frame)) {
        bodies->place_of(fixed_frame)
            .fail("expected another name, this is the fixed frame; give its points in [ground]");
      }
      give_names(part_.document, root);
      find_place();
      find_joined(root);
      scope_numbers();
      for (const std::string_view key : item_tables()) {
        const std::vector<TomlTable> places = root.tables(key);
        const std::vector<toml::table*> tables = tables_in(part_.document, key);
        for (std::size_t i = 0; i < tables.size(); ++i) transform(key, *tables[i], places[i]);
      }
      for (auto&& [key, node] : *table_in(part_.document, "body")) {
        if (toml::table* const body = node.as_table()) transform_body(*body, *bodies->find_table(key.str()));
      }
      add_start(root);
      add_ground(root);
      merge();
    }

   private:
    std::string named(const std::string& item) const { return name_ + "." + item; }
    std::string frame() const { return named(std::string(fixed_frame)); }

    // Where instance k is: each is a step and a turn behind the one before.
    void find_place() {
      const double unit = level_.units.angle;
      const toml::source_position begin{1, 1};
      source_ = {begin, begin, part_.document.source().path};
      at_ = group_.at;
      for (int j = 0; j + 1 < k_; ++j) {
        const Place step = Direction::at({j * group_.turn}, unit).turned(group_.step);
        at_ = {at_.x + step.x, at_.y + step.y};
      }
      angle_ = group_.angle + Amount{(k_ - 1) * group_.turn};
      direction_ = Direction::at(angle_, unit);
    }

    // Points of the part's ground that are points of other bodies.
    void find_joined(const TomlTable& root) {
      joined_ = group_.join;
      if (k_ > 1) {
        for (const auto& [point, to] : group_.join_next) {
          joined_[point] = group_.instances[static_cast<std::size_t>(k_ - 2)] + "." + to;
        }
      }
      std::vector<std::string> known;
      const std::optional<TomlTable> own = root.find_table(fixed_frame);
      if (const auto points = own ? own->find_table("points") : std::nullopt) known = points->keys();
      for (const std::map<std::string, std::string>* const names : {&group_.join, &group_.join_next}) {
        for (const auto& [point, to] : *names) {
          if (std::find(known.begin(), known.end(), point) != known.end()) continue;
          group_.table->place_of(names == &group_.join ? "join" : "join_next")
              .fail("expected points of the ground of " + use_.file + ", found \"" + point + "\"" +
                    did_you_mean_or_list(point, known));
        }
      }
    }

    // The names that numbers of the part have in the scene: a number that the part gives, or that follows from one, is
    // its own, all others are those of the file.
    void scope_numbers() {
      toml::table none;  // where the part has no numbers
      toml::table* const numbers = part_.document.contains("numbers") ? table_in(part_.document, "numbers") : &none;
      if (numbers == nullptr) {
        TomlTable(part_.document, part_.place, nullptr, &all_.out_.files_).find_table("numbers");
        return;
      }
      std::set<std::string> own;
      if (group_.numbers != nullptr) {
        for (auto&& [key, node] : *group_.numbers) own.insert(std::string(key.str()));
      }
      for (bool grows = !own.empty(); grows;) {
        grows = false;
        for (auto&& [key, node] : *numbers) {
          const std::string name(key.str());
          if (!node.is_string() || own.contains(name)) continue;
          bool uses = false;
          renamed(node.as_string()->get(), [&](const std::string& used) {
            uses = uses || own.contains(used);
            return used;
          });
          if (uses) grows = own.insert(name).second || grows;
        }
      }
      for (auto&& [key, node] : *numbers) {
        const std::string name(key.str());
        scoped_[name] = (own.contains(name) ? group_.name : group_.number_scope) + "." + name;
      }
      for (PartUse* const one : part_.uses) {
        for (auto& [path, name] : one->replaced) name = scoped(name);
      }
      toml::table* const above = own.empty() ? nullptr : made_table(level_.document, "numbers");
      if (group_.numbers != nullptr && above != nullptr) {
        const TomlTable given = *group_.table->find_table("numbers");
        for (auto&& [key, node] : *group_.numbers) {
          const std::string path(key.str());
          const bool is_named = numbers->contains(path);
          const std::string name = group_.name + "." + name_in_expressions(path);
          if (!is_named) use_.replaced[name_in_expressions(path)] = name;
          if (k_ > 1) continue;
          if (!is_named) {
            TomlPlace place = given.place_of(path);
            all_.out_.replacements_.push_back({&use_, path, std::move(place)});
          }
          if (above->contains(name) || all_.globals_.contains(name)) fail_number_taken(given.place_of(path), name);
          // Left in its table, which other instances look into.
          const toml::key at(name, key.source());
          above->insert_or_assign(at, std::move(node));
        }
      }
      for (auto&& [key, node] : *numbers) {
        const std::string name(key.str());
        const bool is_own = own.contains(name);
        if (is_own && group_.numbers != nullptr && group_.numbers->contains(name)) continue;
        toml::table* const to = is_own ? above : &all_.globals_;
        if (to == nullptr || to->contains(scoped_[name])) continue;
        if (node.is_string()) rename(*node.as_string());
        to->insert_or_assign(toml::key(scoped_[name], key.source()), std::move(node));
      }
      part_.document.erase("numbers");
    }

    std::string scoped(const std::string& name) const {
      const auto found = scoped_.find(name);
      if (found != scoped_.end()) return found->second;
      return all_.globals_.contains(name) ? name : group_.number_scope + "." + name;
    }

    void rename(toml::value<std::string>& expression) const {
      expression = renamed(expression.get(), [&](const std::string& name) { return scoped(name); });
    }

    // Expressions of a value, not of the names in it.
    void rename_below(toml::node& node, std::string_view key) const {
      if (auto* const text = node.as_string()) {
        if (!is_one_of(key, {"name", "at",  "on",     "follows", "slide",        "x",
                             "y",    "pin", "center", "carrier", "pinion",       "wheel",
                             "line", "a",   "b",      "pulley",  "turn",         "roller",
                             "acts", "law", "file",   "profile", "interpolation"})) {
          rename(*text);
        }
      } else if (toml::array* const list = node.as_array()) {
        const bool names = is_one_of(key, {"points", "bodies", "over", "rope", "line"});
        for (toml::node& one : *list) {
          if (!names || !one.is_string()) rename_below(one, "");
        }
      } else if (toml::table* const table = node.as_table()) {
        for (auto&& [below, value] : *table) rename_below(value, below.str());
      }
    }

    void name_body(std::string& name) {
      needs_frame_ = needs_frame_ || name == fixed_frame;
      name = named(name);
    }
    void name_point(std::string& name) {
      constexpr std::string_view of_ground = "ground.";
      if (name.starts_with(of_ground)) {
        const auto to = joined_.find(name.substr(of_ground.size()));
        if (to != joined_.end()) {
          name = to->second;
          return;
        }
        needs_frame_ = true;
      }
      name = named(name);
    }
    void name_in(toml::table& table, std::string_view key, void (Placing::*give)(std::string&)) {
      if (std::string* const name = text_in(table, key)) (this->*give)(*name);
    }
    void name_joint(std::string& name) { name = named(name); }
    void name_list(toml::table& table, std::string_view key, void (Placing::*give)(std::string&)) {
      toml::array* const list = list_in(table, key);
      for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        if (auto* const name = list->get_as<std::string>(i)) (this->*give)(name->get());
      }
    }

    void negate(toml::node* node) {
      if (node == nullptr) return;
      if (auto* const text = node->as_string()) *text = "-(" + text->get() + ")";
      if (auto* const whole = node->as_integer()) *whole = -whole->get();
      if (auto* const real = node->as_floating_point()) *real = -real->get();
      bool& is_negated = all_.out_.negated_[node];
      is_negated = !is_negated;
    }
    void mirror(toml::node* vector, std::size_t component = 1) {
      toml::array* const list = group_.mirrored && vector != nullptr ? vector->as_array() : nullptr;
      if (list != nullptr && list->size() == 2) negate(list->get(component));
    }
    void mirror_number(toml::table& table, std::string_view key) {
      if (group_.mirrored) negate(table.get(key));
    }
    void mirror_curve(toml::table& table) {
      toml::array* const points = list_in(table, "curve");
      for (std::size_t i = 0; points != nullptr && i < points->size(); ++i) mirror(points->get(i));
    }
    void exchange(toml::table& table, std::string_view key) const {
      toml::array* const list = group_.mirrored ? list_in(table, key) : nullptr;
      if (list == nullptr || list->size() != 2) return;
      auto *const a = list->get_as<std::string>(0), *const b = list->get_as<std::string>(1);
      if (a != nullptr && b != nullptr) std::swap(a->get(), b->get());
    }
    void mirror_turn(toml::table& table) const {
      std::string* const turn = group_.mirrored ? text_in(table, "turn") : nullptr;
      if (turn == nullptr) return;
      if (*turn == "clockwise")
        *turn = "counterclockwise";
      else if (*turn == "counterclockwise")
        *turn = "clockwise";
    }

    void transform_measure(toml::table& table) {
      name_list(table, "points", &Placing::name_point);
      mirror(table.get("axis"));
      name_list(table, "bodies", &Placing::name_body);
      exchange(table, "bodies");
      name_in(table, "slide", &Placing::name_joint);
      for (const std::string_view key : {"x", "y"}) {
        const std::string* const point = text_in(table, key);
        if (point == nullptr || table.contains("points")) continue;
        // A place is one in the frame of the part.
        std::string name = *point;
        name_point(name);
        needs_frame_ = true;
        const toml::source_region source = table.find(key)->first.source();
        table.erase(key);
        table.insert_or_assign(toml::key("points", source), toml::array{frame() + "." + origin(), name});
        const double y = group_.mirrored ? -1.0 : 1.0;
        table.insert_or_assign(toml::key("axis", source), key == "x" ? toml::array{1.0, 0.0} : toml::array{0.0, y});
      }
      transform_rope(table, "rope");
      for (toml::table* const term : tables_in(table, "sum")) transform_measure(*term);
    }
    void transform_rope(toml::table& table, std::string_view key) {
      name_list(table, key, &Placing::name_point);
      for (toml::table* const pulley : tables_in(table, key)) {
        name_in(*pulley, "pulley", &Placing::name_point);
        mirror_turn(*pulley);
      }
    }
    // Loads that keep their direction in the world.
    void turn_load(toml::table& table) {
      for (const std::string_view key : {"vector", "direction"}) {
        toml::array* const vector = list_in(table, key);
        mirror(vector);
        if (vector == nullptr || vector->size() != 2 || angle_.is(0.0) || table.contains("follows")) continue;
        *vector = parts::array_of(direction_.turned({Amount::component(vector, 0), Amount::component(vector, 1)}));
      }
    }

    void transform(std::string_view key, toml::table& table, const TomlTable& place) {
      rename_below(table, "");
      name_in(table, "name", &Placing::name_joint);
      if (is_one_of(key, {"force", "distributed_load"})) {
        name_in(table, "at", &Placing::name_point);
        name_list(table, "points", &Placing::name_point);
        name_in(table, "follows", &Placing::name_body);
        turn_load(table);
      } else if (key == "torque") {
        name_in(table, "on", &Placing::name_body);
        name_in(table, "at", &Placing::name_point);
        mirror_number(table, "value");
      } else if (is_one_of(key, {"gear", "belt"})) {
        if (!table.contains("carrier")) table.insert_or_assign("carrier", std::string(fixed_frame));
        name_list(table, "bodies", &Placing::name_body);
        name_in(table, "carrier", &Placing::name_body);
        mirror_number(table, "phase");
      } else if (key == "rack") {
        name_in(table, "slide", &Placing::name_joint);
        name_in(table, "pinion", &Placing::name_body);
        name_in(table, "carrier", &Placing::name_body);
        mirror_number(table, "radius");
      } else if (key == "cam") {
        name_list(table, "bodies", &Placing::name_body);
        exchange(table, "bodies");
        if (toml::table* const follower = table_in(table, "follower")) transform_measure(*follower);
        name_in(table, "roller", &Placing::name_point);
      } else if (key == "rope") {
        transform_rope(table, "over");
      } else if (key == "chain") {
        name_in(table, "a", &Placing::name_point);
        name_in(table, "b", &Placing::name_point);
        if (group_.mirrored && !table.contains("turn")) table.insert_or_assign("turn", "counterclockwise");
        mirror_turn(table);
      } else if (is_one_of(key, {"circular_slot", "curved_slot", "rolling", "rolling_on_circle", "rolling_profile",
                                 "rolling_profile_on_circle"})) {
        transform_track(key, table, place);
      } else {  // joints, force elements, drives, stops and couplings of measures
        transform_measure(table);
        if (is_one_of(key, {"slide", "weld"})) mirror_number(table, "angle");
      }
    }
    void transform_track(std::string_view key, toml::table& table, const TomlTable& place) {
      for (const std::string_view point : {"pin", "center", "at", "wheel", "line"}) {
        name_in(table, point, &Placing::name_point);
      }
      if (!group_.mirrored) return;
      if (key == "circular_slot") {
        for (const std::string_view end : {"from", "to"}) negate(table.get(end));
        exchange_ends(table);
      } else if (key == "curved_slot") {
        mirror_curve(table);
      } else if (key == "rolling") {  // the wheel stays on the left of the line, which so goes the other way
        mirror(table.get("axis"), 0);
        mirror_number(table, "offset");
      } else if (key == "rolling_on_circle") {
        mirror_number(table, "offset");
      } else {
        place.place().fail(
            "expected a part that is not mirrored: places on a profile that rolls count from its first "
            "point, and the mirrored one has another; draw it in a file of its own");
      }
    }
    void exchange_ends(toml::table& table) {
      toml::table ends;
      for (const auto& [key, other] : {std::pair("from", "to"), std::pair("to", "from")}) {
        toml::node* const node = table.get(key);
        if (node == nullptr) continue;
        const std::string in_file(all_.out_.key_in_file(*node, key));
        move_marked(*node, ends, toml::key(other, key_source(table, key)));
        all_.out_.moved_[ends.get(other)] = in_file;
        table.erase(key);
      }
      for (auto&& [key, node] : ends) move_marked(node, table, key);
    }
    void move_marked(toml::node& from, toml::table& to, const toml::key& key) {
      auto negated = all_.out_.negated_.extract(&from);
      auto moved = all_.out_.moved_.extract(&from);
      to.insert_or_assign(key, std::move(from));
      const toml::node* const node = to.get(key.str());
      if (negated) all_.out_.negated_[node] = negated.mapped();
      if (moved) all_.out_.moved_[node] = moved.mapped();
    }

    void transform_body(toml::table& body, const TomlTable& place) {
      for (auto&& [key, value] : body) {
        if (key.str() != "points") rename_below(value, key.str());
      }
      transform_points(body);
      mirror(body.get("center"));
      toml::table* const section = table_in(body, "section");
      if (section != nullptr && group_.scale != 1.0) {
        place.find_table("section")->place().fail(
            "expected a part without the key scale, which changes lengths and no sections; remove one of them");
      }
      if (section == nullptr || !group_.mirrored || !section->contains("left")) return;
      // What was on the left of the line is on the left of it in the other direction.
      toml::array* const line = list_in(*section, "line");
      if (line == nullptr || place.find_table("section")->flag("flexible", false)) {
        place.find_table("section")->place_of("left").fail(
            "expected a part that is not mirrored, or a section of a rigid body with its line; add line = [\"A\", "
            "\"B\"]");
      }
      toml::array turned;
      for (std::size_t i = line->size(); i-- > 0;) turned.push_back(std::move(*line->get(i)));
      *line = std::move(turned);
    }
    void transform_points(toml::table& owner) {
      toml::table* const points = table_in(owner, "points");
      if (points == nullptr) return;
      for (auto&& [key, at] : *points) {
        rename_below(at, "");
        mirror(&at);
      }
    }

    std::string origin() {
      if (!origin_.empty()) return origin_;
      origin_ = "origin";
      toml::table* const own = table_in(part_.document, fixed_frame);
      const toml::table* const points = own != nullptr ? table_in(*own, "points") : nullptr;
      while (points != nullptr && points->contains(origin_)) origin_ += "_";
      return origin_;
    }

    // The guesses, at the place of the part; those that the document has itself stay.
    void add_start(const TomlTable& root) {
      const std::optional<TomlTable> start = root.find_table("start");
      toml::table* const written = table_in(part_.document, "start");
      std::set<std::string> travels;
      for (const std::string_view key :
           {"slide", "pin_in_slot", "curved_slot", "rolling_profile", "rolling_profile_on_circle"}) {
        for (toml::table* const table : tables_in(part_.document, key)) {
          if (const std::string* const name = text_in(*table, "name")) travels.insert(*name);
        }
      }
      const Amount angle = angle_ + angle_of_base();
      const Amount sense{group_.mirrored ? -1.0 : 1.0};
      std::set<std::string> guessed;
      if (start) {
        for (const std::string& key : start->keys()) {
          toml::node& value = *written->get(key);
          const toml::key name(named(key), written->find(key)->first.source());
          rename_below(value, "");
          if (key == "position" && value.is_table()) {
            add_positions(*value.as_table());
          } else if (!value.is_number() && !value.is_string()) {
            start->number(key, 1.0, Range::finite);
          } else if (travels.contains(named(key))) {
            guess(name, Amount{use_.unit(dimension::length) / level_.units.length} * Amount::of(&value));
          } else {
            guessed.insert(key);
            guess(name, Amount{use_.units.angle / level_.units.angle} * sense * Amount::of(&value) + angle);
          }
        }
      }
      if (angle.is(0.0)) return;
      for (const std::string& body : free_bodies(guessed)) guess(toml::key(body), angle);
    }
    Amount angle_of_base() const {
      const toml::table* const start = level_.document.get_as<toml::table>("start");
      return start != nullptr && start->contains(group_.on) ? Amount::of(start->get(group_.on)) : Amount{};
    }
    void guess(const toml::key& key, const Amount& value) {
      toml::table* const to = made_table(level_.document, "start");
      if (to == nullptr || to->contains(key.str())) return;
      value.put([&](const auto& number) { to->insert_or_assign(key, number); });
    }
    void add_positions(toml::table& positions) {
      toml::table* const start = made_table(level_.document, "start");
      toml::table* const to = start != nullptr ? made_table(*start, "position") : nullptr;
      const double unit = use_.unit(dimension::length) / level_.units.length;
      for (auto&& [key, node] : positions) {
        const toml::array* const vector = node.as_array();
        if (to == nullptr || to->contains(named(std::string(key.str())))) continue;
        const toml::key name(named(std::string(key.str())), key.source());
        if (vector == nullptr || vector->size() != 2) {
          to->insert_or_assign(name, std::move(node));
          continue;
        }
        const Place own{Amount{unit} * Amount::component(vector, 0),
                        Amount{group_.mirrored ? -unit : unit} * Amount::component(vector, 1)};
        const Place turned = direction_.turned(own);
        to->insert_or_assign(name, parts::array_of({at_.x + turned.x, at_.y + turned.y}));
      }
    }
    // Bodies, under their names in the scene, that no slides and welds keep at an angle to a guess or to the ground:
    // their guess is 0 in the part.
    std::vector<std::string> free_bodies(const std::set<std::string>& guessed) {
      std::set<std::string> known;
      for (const std::string& body : guessed) known.insert(named(body));
      std::vector<std::pair<std::string, std::string>> kept;
      for (const std::string_view key : {"slide", "weld"}) {
        for (toml::table* const table : tables_in(part_.document, key)) {
          toml::array* const points = list_in(*table, "points");
          if (points == nullptr || points->size() != 2) continue;
          const auto *const a = points->get_as<std::string>(0), *const b = points->get_as<std::string>(1);
          if (a != nullptr && b != nullptr) kept.emplace_back(body_of_point(a->get()), body_of_point(b->get()));
        }
      }
      std::vector<std::string> all;
      for (auto&& [key, node] : *table_in(part_.document, "body")) all.push_back(named(std::string(key.str())));
      const auto is_own = [&](const std::string& body) { return std::find(all.begin(), all.end(), body) != all.end(); };
      for (bool grows = true; grows;) {
        grows = false;
        for (const auto& [a, b] : kept) {
          const bool one = known.contains(a) || !is_own(a), other = known.contains(b) || !is_own(b);
          if (one && is_own(b)) grows = known.insert(b).second || grows;
          if (other && is_own(a)) grows = known.insert(a).second || grows;
        }
      }
      std::erase_if(all, [&](const std::string& body) { return known.contains(body); });
      return all;
    }

    // The ground of the part as a body of the scene, where anything is fixed in it.
    void add_ground(const TomlTable& root) {
      if (const auto own = root.find_table(fixed_frame)) own->allow_keys({"points"});
      origin();
      toml::table frame_body;
      if (toml::table* const own = table_in(part_.document, fixed_frame)) {
        transform_points(*own);
        frame_body = std::move(*own);
      }
      part_.document.erase(fixed_frame);
      toml::table* const points = made_table(frame_body, "points");
      if (points == nullptr) return;
      for (const auto& [point, to] : joined_) points->erase(point);
      if (!needs_frame_ && points->empty()) return;
      points->insert_or_assign(origin_, toml::array{0.0, 0.0});
      toml::table* const bodies = made_table(level_.document, "body");
      if (bodies == nullptr) return;
      place_on(*bodies);
      toml::table weld;
      weld.insert_or_assign(toml::key("name", held_at_), name_);
      weld.insert_or_assign("points", toml::array{group_.on + "." + name_, frame() + "." + origin_});
      const toml::source_region source = key_source(*group_.written, "angle");
      if (k_ == 1 && group_.written->contains("angle")) {
        weld.insert_or_assign(toml::key("angle", source), std::move(*group_.written->get("angle")));
      } else {
        angle_.put([&](const auto& angle) { weld.insert_or_assign(toml::key("angle", source), angle); });
      }
      append("weld", std::move(weld));
      bodies->insert_or_assign(toml::key(frame(), source_), std::move(frame_body));
    }
    static toml::source_region key_source(const toml::table& table, std::string_view key) {
      const auto found = table.find(key);
      return found != table.end() ? found->first.source() : table.source();
    }
    // The point at which the part is held, of the ground or of a body.
    void place_on(toml::table& bodies) {
      toml::table* const base =
          group_.on == fixed_frame ? made_table(level_.document, fixed_frame) : table_in(bodies, group_.on);
      if (base == nullptr) {
        std::vector<std::string> known{std::string(fixed_frame)};
        for (auto&& [key, node] : bodies) known.emplace_back(key.str());
        group_.table->place_of("on").fail("expected the name of a body, of the scene or of a part above, found \"" +
                                          group_.on + "\"" + did_you_mean_or_list(group_.on, known));
      }
      toml::table* const places = made_table(*base, "points");
      if (places == nullptr) return;
      if (places->contains(name_)) {
        group_.table->place_of("name").fail("expected a name that no point of \"" + group_.on +
                                            "\" has: there the part is placed; give it another");
      }
      const toml::key key(name_, key_source(*group_.written, "at"));
      double unit = 1.0;
      if (const auto of = bodies.find(group_.on); of != bodies.end()) {
        const TomlPart& file = *all_.out_.files_.of(of->first.source()).part;
        if (!file.name.empty() && &file != level_.place.part) unit = level_.units.length / file.unit(dimension::length);
      }
      if (k_ == 1 && unit == 1.0 && group_.written->contains("at")) {
        places->insert_or_assign(key, std::move(*group_.written->get("at")));
      } else {
        places->insert_or_assign(key, parts::array_of({Amount{unit} * at_.x, Amount{unit} * at_.y}));
      }
    }

    void append(std::string_view key, toml::table&& table) {
      if (!level_.document.contains(key)) level_.document.insert_or_assign(key, toml::array{});
      if (toml::array* const list = list_in(level_.document, key)) list->push_back(std::move(table));
    }

    void merge() {
      toml::table* const bodies = made_table(level_.document, "body");
      for (auto&& [key, node] : *table_in(part_.document, "body")) {
        if (bodies == nullptr) break;
        count();
        bodies->insert_or_assign(toml::key(named(std::string(key.str())), key.source()), std::move(node));
      }
      for (const std::string_view key : item_tables()) {
        for (toml::table* const table : tables_in(part_.document, key)) {
          count();
          append(key, std::move(*table));
        }
        part_.document.erase(key);
      }
      for (const std::string_view key :
           {"title", "source", "gravity", "units", "outputs", "body", "start", "numbers"}) {
        part_.document.erase(key);
      }
      // What no scene has is refused where the document is read.
      for (auto&& [key, node] : part_.document) {
        if (!level_.document.contains(key.str())) level_.document.insert_or_assign(key, std::move(node));
      }
    }
    void count() const {
      if (++all_.items_ <= most_items) return;
      group_.table->place().fail(
          fmt::format("expected at most {} bodies, joints and other items in all parts", most_items));
    }

    PartExpander& all_;
    Level& level_;
    Level& part_;
    const Group& group_;
    int k_;
    PartUse& use_;
    std::string name_, origin_{};
    toml::source_region held_at_;
    toml::source_region source_{};  // of what the part brings that its file does not have
    Place at_{};
    Amount angle_{};
    Direction direction_{};
    std::map<std::string, std::string> joined_{}, scoped_{};
    bool needs_frame_ = false;
  };

  PartedDocument& out_;
  TomlPlace place_;
  fs::path file_, folder_;
  std::map<fs::path, std::string> texts_;
  std::map<std::string, fs::path> stems_;
  toml::table globals_;
  std::size_t items_ = 0;
};

PartedDocument::PartedDocument(toml::table document, const TomlPlace& place) : document_(std::move(document)) {
  own_.file = place.file;
  files_.add(nullptr, own_);
  if (document_.contains("part")) PartExpander(*this, place).run();
}

const PartUse* PartedDocument::use_of(const toml::node& node) const {
  const auto* const use = static_cast<const PartUse*>(files_.of(node.source()).part);
  return use->file_stem.empty() ? nullptr : use;
}

std::string_view PartedDocument::key_in_file(const toml::node& number, std::string_view key) const {
  const auto found = moved_.find(&number);
  return found != moved_.end() ? std::string_view(found->second) : key;
}

void check_number_name(const std::string& name, const TomlTable& numbers) {
  if (Expression::is_name(name)) return;
  numbers.place_of(name).fail(
      "expected a name of letters, digits and underscores that does not begin with a digit and is neither pi nor a "
      "function");
}

std::string name_in_expressions(std::string_view path) {
  std::string out;
  for (const char c : path) out += is_letter_of_name(c) || c == '.' ? c : '_';
  if (out.empty() || (out.front() >= '0' && out.front() <= '9')) out.insert(0, "_");
  return out;
}

}  // namespace poise
