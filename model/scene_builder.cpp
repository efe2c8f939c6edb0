#include "model/scene_builder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "model/read_elements.hpp"
#include "model/read_scene.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

MeasureByName measures::angle(std::string body_a, std::string body_b) {
  return {"bodies", {std::move(body_a), std::move(body_b)}, {}};
}

MeasureByName measures::distance(std::string a, std::string b) { return {"points", {std::move(a), std::move(b)}, {}}; }

MeasureByName measures::travel(std::string joint) { return {"slide", {std::move(joint)}, {}}; }

MeasureByName measures::x(std::string point) { return {"x", {std::move(point)}, {}}; }

MeasureByName measures::y(std::string point) { return {"y", {std::move(point)}, {}}; }

MeasureByName measures::sum(std::vector<MeasureByName::Term> terms) { return {"sum", {}, std::move(terms)}; }

MeasureByName measures::nothing() { return {}; }

namespace {

toml::array pair_of(Vec2 v) { return toml::array{v.x, v.y}; }

toml::array list_of(const std::vector<std::string>& words) {
  toml::array list;
  for (const std::string& word : words) list.push_back(word);
  return list;
}

toml::array pairs_of(const std::vector<Vec2>& pairs) {
  toml::array rows;
  for (const Vec2& pair : pairs) rows.push_back(pair_of(pair));
  return rows;
}

/// A value that has no members, or a key. Numbers have the digits that the same double is read from.
std::string written(const toml::node& node) {
  if (const std::optional<double> number = node.value_exact<double>()) {
    return *number == 0.0 && std::signbit(*number) ? "-0.0" : fmt::format("{}", *number);
  }
  std::ostringstream out;
  out << toml::toml_formatter{node, toml::format_flags::allow_unicode_strings};
  return out.str();
}

std::string written_key(std::string_view name) {
  const auto is_bare = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  if (!name.empty() && std::all_of(name.begin(), name.end(), is_bare)) return std::string(name);
  return written(toml::value<std::string>(std::string(name)));
}

/// Members in the order of their places, in which the reader takes them.
std::vector<std::pair<std::string, const toml::node*>> members_of(const toml::table& table) {
  std::vector<std::pair<const toml::key*, const toml::node*>> found;
  for (const auto& [key, node] : table) found.emplace_back(&key, &node);
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return a.first->source().begin.column < b.first->source().begin.column;
  });
  std::vector<std::pair<std::string, const toml::node*>> out;
  for (const auto& [key, node] : found) out.emplace_back(written_key(key->str()), node);
  return out;
}

std::string in_one_line(const toml::node& node) {
  std::vector<std::string> parts;
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, member] : members_of(*table)) parts.push_back(key + " = " + in_one_line(*member));
    return fmt::format("{{ {} }}", fmt::join(parts, ", "));
  }
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& member : *array) parts.push_back(in_one_line(member));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  return written(node);
}

bool is_list_of_tables(const toml::node& node) {
  const toml::array* array = node.as_array();
  return array != nullptr && !array->empty() &&
         std::all_of(array->begin(), array->end(), [](const toml::node& one) { return one.is_table(); });
}

/// A table with the line above it.
struct Block {
  std::uint32_t place = 0;
  std::string header;
  const toml::table* table = nullptr;
};

/// The place of a table of a list, which is that of its first key.
std::uint32_t place_of(const toml::table& table) {
  std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
  for (const auto& [key, node] : table) first = std::min(first, key.source().begin.column);
  return first;
}

/// The tables of a document in the order in which they were added, those of bodies each by itself.
std::vector<Block> blocks_of(const toml::table& root) {
  std::vector<Block> out;
  for (const auto& [key, node] : root) {
    const std::string name = written_key(key.str());
    if (const toml::table* table = node.as_table(); table != nullptr && name != "body") {
      out.push_back({key.source().begin.column, fmt::format("[{}]", name), table});
    } else if (table != nullptr) {
      for (const auto& [body, data] : *table) {
        out.push_back({body.source().begin.column, fmt::format("[body.{}]", written_key(body.str())), data.as_table()});
      }
    } else if (is_list_of_tables(node)) {
      for (const toml::node& one : *node.as_array()) {
        out.push_back({place_of(*one.as_table()), fmt::format("[[{}]]", name), one.as_table()});
      }
    }
  }
  std::sort(out.begin(), out.end(), [](const Block& a, const Block& b) { return a.place < b.place; });
  return out;
}

}  // namespace

/// The document that a scene file with these items would be parsed to, but without lines.
struct SceneBuilder::Document {
  std::string title;
  toml::table root;
  std::string last_joint;  ///< list of the joint that was added last

  /// Keys count up: the reader takes tables in the order of their places in the text.
  toml::key key(std::string_view name) {
    ++keys_;
    return toml::key(name, toml::source_region{{0, keys_}, {0, keys_}, {}});
  }

  template <class Value>
  void set(toml::table& table, std::string_view name, Value&& value) {
    table.insert(key(name), std::forward<Value>(value));
  }

  /// Adds what has a name of its own, at the path "OWNER.NAME" of messages.
  template <class Value>
  void add(toml::table& table, const std::string& path, const std::string& name, Value&& value) {
    const auto [place, is_new] = table.insert(key(name), std::forward<Value>(value));
    if (!is_new) fail_taken({title, 0, path + "." + name}, name, 0);
  }

  /// The table under a key, made where there is none yet.
  toml::table& part(toml::table& table, std::string_view name) {
    if (!table.contains(name)) set(table, name, toml::table{});
    return *table.get_as<toml::table>(name);
  }

  /// A new table of [[name]].
  toml::table& next(const std::string& list, const std::string& name) {
    if (!root.contains(list)) set(root, list, toml::array{});
    toml::table& table = root.get_as<toml::array>(list)->emplace_back<toml::table>();
    if (!name.empty()) set(table, "name", name);
    return table;
  }

  toml::table& next_joint(std::string_view kind, const std::string& a, const std::string& b, const std::string& name) {
    last_joint = kind;
    toml::table& table = next(last_joint, name);
    set(table, "points", toml::array{a, b});
    return table;
  }

  void set_measure(toml::table& table, const MeasureByName& on) {
    if (on.key.empty()) return;
    toml::array list;
    for (const MeasureByName::Term& term : on.terms) {
      toml::table& written = list.emplace_back<toml::table>();
      set(written, "factor", term.factor);
      set_measure(written, term.measure);
    }
    for (const std::string& name : on.names) list.push_back(name);
    if (on.names.size() == 1)
      set(table, on.key, on.names.front());
    else
      set(table, on.key, std::move(list));
  }

  void add_on(const std::string& list, const std::string& name, const MeasureByName& on,
              const std::vector<Key>& entries) {
    toml::table& table = next(list, name);
    set_measure(table, on);
    add_keys(table, list, name, entries);
  }

  void add_keys(toml::table& table, const std::string& list, const std::string& name, const std::vector<Key>& entries) {
    for (const Key& entry : entries) {
      toml::table* owner = &table;
      std::string key = entry.name;
      bool is_taken = false;
      // Paths in the table numbers of a part are keys with dots.
      const bool is_path = key.starts_with("numbers.");
      for (std::size_t dot = key.find('.'); dot != std::string::npos && !is_taken; dot = key.find('.')) {
        const std::string first = key.substr(0, dot);
        is_taken = owner->contains(first) && !owner->get(first)->is_table();
        if (!is_taken) owner = &part(*owner, first);
        key.erase(0, dot + 1);
        if (is_path) break;
      }
      if (is_taken || owner->contains(key)) {
        const std::string item = name.empty() ? list : fmt::format("{} \"{}\"", list, name);
        TomlPlace{title, 0, item}.fail("expected the key " + entry.name + " once, found it twice");
      }
      if (const auto* const tables = std::get_if<Key::Tables>(&entry.value)) {
        toml::array all;
        for (const std::vector<Key>& one : *tables) add_keys(all.emplace_back<toml::table>(), list, name, one);
        set(*owner, key, std::move(all));
        continue;
      }
      with_value(entry, [&](auto value) { set(*owner, key, std::move(value)); });
    }
  }

  /// use(value) with the value of a key, as a list where it is several.
  template <class Use>
  static void with_value(const Key& entry, Use use) {
    if (const auto* pairs = std::get_if<std::vector<Vec2>>(&entry.value)) {
      use(pairs_of(*pairs));
    } else if (const auto* pair = std::get_if<Vec2>(&entry.value)) {
      use(pair_of(*pair));
    } else if (const auto* words = std::get_if<std::vector<std::string>>(&entry.value)) {
      use(list_of(*words));
    } else if (const auto* numbers = std::get_if<std::vector<double>>(&entry.value)) {
      toml::array list;
      for (const double number : *numbers) list.push_back(number);
      use(std::move(list));
    } else if (const auto* flag = std::get_if<bool>(&entry.value)) {
      use(*flag);
    } else if (const auto* number = std::get_if<double>(&entry.value)) {
      use(*number);
    } else {
      use(std::get<std::string>(entry.value));
    }
  }

 private:
  std::uint32_t keys_ = 0;
};

SceneBuilder::SceneBuilder(std::string title, const UnitNames& units) : document_(std::make_unique<Document>()) {
  document_->title = std::move(title);
  document_->set(document_->root, "title", document_->title);
  document_->set(document_->root, "units", table_of(units));
}

SceneBuilder::~SceneBuilder() = default;
SceneBuilder::SceneBuilder(SceneBuilder&&) noexcept = default;
SceneBuilder& SceneBuilder::operator=(SceneBuilder&&) noexcept = default;

SceneBuilder& SceneBuilder::source(std::string text) {
  document_->root.insert_or_assign("source", std::move(text));
  return *this;
}

SceneBuilder& SceneBuilder::number(const std::string& name, double value) {
  document_->add(document_->part(document_->root, "numbers"), "numbers", name, value);
  return *this;
}

SceneBuilder& SceneBuilder::number(const std::string& name, const std::string& expression) {
  document_->add(document_->part(document_->root, "numbers"), "numbers", name, expression);
  return *this;
}

SceneBuilder& SceneBuilder::output(const std::string& name, const std::string& quantity) {
  document_->add(document_->part(document_->root, "outputs"), "outputs", name, quantity);
  return *this;
}

SceneBuilder& SceneBuilder::gravity(Vec2 acceleration) {
  document_->root.insert_or_assign("gravity", pair_of(acceleration));
  return *this;
}

SceneBuilder& SceneBuilder::frame(const std::string& axis, const std::vector<Key>& keys) {
  document_->add(document_->part(document_->root, "frame"), "frame", axis, toml::table{});
  document_->add_keys(document_->part(document_->part(document_->root, "frame"), axis), "frame", axis, keys);
  return *this;
}

SceneBuilder& SceneBuilder::ground_point(const std::string& name, Vec2 at) {
  toml::table& points = document_->part(document_->part(document_->root, "ground"), "points");
  document_->add(points, "ground.points", name, pair_of(at));
  return *this;
}

SceneBuilder& SceneBuilder::body(const std::string& name, const BodyData& data) {
  const std::string path = "body." + name;
  toml::table points;
  for (const auto& [point, at] : data.points) document_->add(points, path + ".points", point, pair_of(at));
  toml::table body;
  document_->set(body, "points", std::move(points));
  // What is the default is left out, as in a file that a person writes.
  if (data.mass != 0.0) document_->set(body, "mass", data.mass);
  if (!(data.center == Vec2{})) document_->set(body, "center", pair_of(data.center));
  if (data.inertia != 0.0) document_->set(body, "inertia", data.inertia);
  document_->add(document_->part(document_->root, "body"), "body", name, std::move(body));
  return *this;
}

SceneBuilder& SceneBuilder::section(const std::string& body, const std::vector<Key>& keys,
                                    const std::vector<std::string>& line) {
  toml::table& bodies = document_->part(document_->root, "body");
  toml::table* const owner = bodies.get_as<toml::table>(body);
  const std::string path = "body." + body;
  if (owner == nullptr) TomlPlace{document_->title, 0, path}.fail("expected a body; add it before its section");
  toml::table section;
  for (const Key& key : keys) {
    Document::with_value(key,
                         [&](auto value) { document_->add(section, path + ".section", key.name, std::move(value)); });
  }
  if (!line.empty()) document_->set(section, "line", list_of(line));
  document_->add(*owner, path, "section", std::move(section));
  return *this;
}

SceneBuilder& SceneBuilder::part(const std::string& file, const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("part", name);
  document_->set(table, "file", file);
  document_->add_keys(table, "part", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::pin(const std::string& a, const std::string& b, const std::string& name) {
  document_->next_joint("pin", a, b, name);
  return *this;
}

SceneBuilder& SceneBuilder::slide(const std::string& a, const std::string& b, Vec2 axis, const std::string& name,
                                  double angle) {
  toml::table& joint = document_->next_joint("slide", a, b, name);
  document_->set(joint, "axis", pair_of(axis));
  document_->set(joint, "angle", angle);
  return *this;
}

SceneBuilder& SceneBuilder::pin_in_slot(const std::string& a, const std::string& b, Vec2 axis,
                                        const std::string& name) {
  document_->set(document_->next_joint("pin_in_slot", a, b, name), "axis", pair_of(axis));
  return *this;
}

SceneBuilder& SceneBuilder::weld(const std::string& a, const std::string& b, double angle, const std::string& name) {
  document_->set(document_->next_joint("weld", a, b, name), "angle", angle);
  return *this;
}

SceneBuilder& SceneBuilder::bar(const std::string& a, const std::string& b, double length, const std::string& name) {
  document_->set(document_->next_joint("bar", a, b, name), "length", length);
  return *this;
}

SceneBuilder& SceneBuilder::friction(const std::vector<Key>& keys) {
  if (document_->last_joint.empty()) {
    TomlPlace{document_->title, 0, "friction"}.fail("expected a joint before it; add the joint first");
  }
  toml::array& joints = *document_->root.get_as<toml::array>(document_->last_joint);
  toml::table friction;
  for (const Key& key : keys) {
    Document::with_value(key, [&](auto value) {
      document_->add(friction, document_->last_joint + ".friction", key.name, std::move(value));
    });
  }
  document_->add(*joints.back().as_table(), document_->last_joint, "friction", std::move(friction));
  return *this;
}

SceneBuilder& SceneBuilder::element(const std::string& table, const std::string& name, const MeasureByName& on,
                                    const std::vector<Key>& keys) {
  const std::vector<std::string_view> tables = element_tables();
  choose({table, {document_->title, 0, "element" + (name.empty() ? "" : " \"" + name + "\"")}},
         {tables.begin(), tables.end()});
  document_->add_on(table, name, on, keys);
  return *this;
}

SceneBuilder& SceneBuilder::drive(const std::string& name, const MeasureByName& on, const std::vector<Key>& keys) {
  document_->add_on("drive", name, on, keys);
  return *this;
}

SceneBuilder& SceneBuilder::stop(const std::string& name, const MeasureByName& on, const std::vector<Key>& keys) {
  document_->add_on("stop", name, on, keys);
  return *this;
}

SceneBuilder& SceneBuilder::blade(const std::string& at, const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("blade", name);
  document_->set(table, "at", at);
  document_->add_keys(table, "blade", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::gear(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                                 const std::string& name) {
  document_->add_on("gear", name, measures::angle(a, b), keys);
  return *this;
}

SceneBuilder& SceneBuilder::belt(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                                 const std::string& name) {
  document_->add_on("belt", name, measures::angle(a, b), keys);
  return *this;
}

SceneBuilder& SceneBuilder::geneva(const std::string& crank, const std::string& wheel, const std::vector<Key>& keys,
                                   const std::string& name) {
  document_->add_on("geneva", name, measures::angle(crank, wheel), keys);
  return *this;
}

SceneBuilder& SceneBuilder::rack(const std::string& slide, const std::string& pinion, const std::vector<Key>& keys,
                                 const std::string& name) {
  toml::table& table = document_->next("rack", name);
  document_->set(table, "slide", slide);
  document_->set(table, "pinion", pinion);
  document_->add_keys(table, "rack", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::coupling(const MeasureByName& sum, const std::vector<Key>& keys, const std::string& name) {
  document_->add_on("coupling", name, sum, keys);
  return *this;
}

SceneBuilder& SceneBuilder::cam(const std::string& a, const std::string& b, const MeasureByName& follower,
                                const std::vector<CamPart>& law, const std::vector<Key>& keys,
                                const std::string& name) {
  toml::table& table = document_->next("cam", name);
  document_->set_measure(table, measures::angle(a, b));
  toml::table followed;
  document_->set_measure(followed, follower);
  document_->set(table, "follower", std::move(followed));
  toml::array parts;
  for (const CamPart& part : law) {
    toml::table& written = parts.emplace_back<toml::table>();
    document_->set(written, "to", part.to);
    document_->set(written, "law", part.law);
    if (part.lift) document_->set(written, "lift", *part.lift);
  }
  if (!law.empty()) document_->set(table, "law", std::move(parts));
  document_->add_keys(table, "cam", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::rope(const std::vector<RopePoint>& over, const std::vector<Key>& keys,
                                 const std::string& name) {
  toml::table& table = document_->next("rope", name);
  toml::array list;
  for (const RopePoint& point : over) {
    if (point.turn.empty()) {
      list.push_back(point.at);
      continue;
    }
    toml::table& pulley = list.emplace_back<toml::table>();
    document_->set(pulley, "pulley", point.at);
    document_->set(pulley, "radius", point.radius);
    document_->set(pulley, "turn", point.turn);
  }
  document_->set(table, "over", std::move(list));
  document_->add_keys(table, "rope", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::chain(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                                  const std::string& name) {
  toml::table& table = document_->next("chain", name);
  document_->set(table, "a", a);
  document_->set(table, "b", b);
  document_->add_keys(table, "chain", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::contact(const std::string& point, const std::vector<std::string>& way,
                                    const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("contact", name);
  document_->set(table, "point", point);
  toml::array points;
  for (const std::string& one : way) points.push_back(one);
  document_->set(table, way.size() == 2 ? "segment" : "outline", std::move(points));
  document_->add_keys(table, "contact", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::contact_of_outlines(const std::vector<std::string>& outline,
                                                const std::vector<std::string>& against, const std::vector<Key>& keys,
                                                const std::string& name) {
  toml::table& table = document_->next("contact", name);
  for (const auto& [key, way] : {std::pair("outline", &outline), std::pair("against", &against)}) {
    toml::array points;
    for (const std::string& one : *way) points.push_back(one);
    document_->set(table, key, std::move(points));
  }
  document_->add_keys(table, "contact", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::contact_with_arc(const std::string& point, const std::string& center,
                                             const std::string& from, const std::string& to, bool hollow,
                                             const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("contact", name);
  document_->set(table, "point", point);
  toml::table arc;
  document_->set(arc, "center", center);
  document_->set(arc, "from", from);
  document_->set(arc, "to", to);
  if (hollow) document_->set(arc, "hollow", true);
  document_->set(table, "arc", std::move(arc));
  document_->add_keys(table, "contact", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::loose_pin(const std::string& a, const std::string& b, const std::vector<Key>& keys,
                                      const std::string& name) {
  toml::table& table = document_->next("loose_pin", name);
  document_->set(table, "points", toml::array{a, b});
  document_->add_keys(table, "loose_pin", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::loose_slot(const std::string& a, const std::string& b, Vec2 axis,
                                       const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("loose_slot", name);
  document_->set(table, "points", toml::array{a, b});
  document_->set(table, "axis", pair_of(axis));
  document_->add_keys(table, "loose_slot", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::circular_slot(const std::string& pin, const std::string& center,
                                          const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("circular_slot", name);
  document_->set(table, "pin", pin);
  document_->set(table, "center", center);
  document_->add_keys(table, "circular_slot", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::curved_slot(const std::string& pin, const std::string& at, const std::vector<Vec2>& curve,
                                        const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("curved_slot", name);
  document_->set(table, "pin", pin);
  document_->set(table, "at", at);
  document_->set(table, "curve", pairs_of(curve));
  document_->add_keys(table, "curved_slot", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::rolling(const std::string& wheel, const std::string& line, Vec2 axis,
                                    const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("rolling", name);
  document_->set(table, "wheel", wheel);
  document_->set(table, "line", line);
  document_->set(table, "axis", pair_of(axis));
  document_->add_keys(table, "rolling", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::rolling_on_circle(const std::string& wheel, const std::string& center,
                                              const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("rolling_on_circle", name);
  document_->set(table, "wheel", wheel);
  document_->set(table, "center", center);
  document_->add_keys(table, "rolling_on_circle", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::rolling_profile(const std::string& at, const std::vector<Vec2>& curve,
                                            const std::string& line, Vec2 axis, const std::vector<Key>& keys,
                                            const std::string& name) {
  toml::table& table = document_->next("rolling_profile", name);
  document_->set(table, "at", at);
  document_->set(table, "curve", pairs_of(curve));
  document_->set(table, "line", line);
  document_->set(table, "axis", pair_of(axis));
  document_->add_keys(table, "rolling_profile", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::curve_contact(const std::string& at, const std::vector<Vec2>& curve,
                                          const std::string& against, const std::vector<Vec2>& against_curve,
                                          const std::vector<Key>& keys, const std::string& name) {
  toml::table& table = document_->next("curve_contact", name);
  document_->set(table, "at", at);
  document_->set(table, "curve", pairs_of(curve));
  document_->set(table, "against", against);
  document_->set(table, "against_curve", pairs_of(against_curve));
  document_->add_keys(table, "curve_contact", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::rolling_profile_on_circle(const std::string& at, const std::vector<Vec2>& curve,
                                                      const std::string& center, const std::vector<Key>& keys,
                                                      const std::string& name) {
  toml::table& table = document_->next("rolling_profile_on_circle", name);
  document_->set(table, "at", at);
  document_->set(table, "curve", pairs_of(curve));
  document_->set(table, "center", center);
  document_->add_keys(table, "rolling_profile_on_circle", name, keys);
  return *this;
}

SceneBuilder& SceneBuilder::force(const std::string& name, const std::string& at, Vec2 vector,
                                  const std::string& follows) {
  toml::table& load = document_->next("force", name);
  document_->set(load, "at", at);
  document_->set(load, "vector", pair_of(vector));
  if (!follows.empty()) document_->set(load, "follows", follows);
  return *this;
}

SceneBuilder& SceneBuilder::force_along(const std::string& name, const std::string& at, Vec2 direction, double size,
                                        const std::string& follows) {
  toml::table& load = document_->next("force", name);
  document_->set(load, "at", at);
  document_->set(load, "direction", pair_of(direction));
  document_->set(load, "size", size);
  if (!follows.empty()) document_->set(load, "follows", follows);
  return *this;
}

SceneBuilder& SceneBuilder::distributed_load(const std::string& name, const std::string& a, const std::string& b,
                                             Vec2 vector, const std::string& follows) {
  toml::table& load = document_->next("distributed_load", name);
  document_->set(load, "points", toml::array{a, b});
  document_->set(load, "vector", pair_of(vector));
  if (!follows.empty()) document_->set(load, "follows", follows);
  return *this;
}

SceneBuilder& SceneBuilder::distributed_load_along(const std::string& name, const std::string& a, const std::string& b,
                                                   Vec2 direction, double size, const std::string& follows) {
  toml::table& load = document_->next("distributed_load", name);
  document_->set(load, "points", toml::array{a, b});
  document_->set(load, "direction", pair_of(direction));
  document_->set(load, "size", size);
  if (!follows.empty()) document_->set(load, "follows", follows);
  return *this;
}

SceneBuilder& SceneBuilder::torque(const std::string& name, const std::string& body, double value) {
  toml::table& load = document_->next("torque", name);
  document_->set(load, "on", body);
  document_->set(load, "value", value);
  return *this;
}

SceneBuilder& SceneBuilder::start(const std::string& name, double value) {
  document_->add(document_->part(document_->root, "start"), "start", name, value);
  return *this;
}

SceneBuilder& SceneBuilder::start_position(const std::string& body, Vec2 at) {
  toml::table& positions = document_->part(document_->part(document_->root, "start"), "position");
  document_->add(positions, "start.position", body, pair_of(at));
  return *this;
}

std::string SceneBuilder::text() const {
  std::string out;
  for (const auto& [key, member] : members_of(document_->root)) {
    if (!member->is_table() && !is_list_of_tables(*member)) out += fmt::format("{} = {}\n", key, in_one_line(*member));
  }
  for (const Block& block : blocks_of(document_->root)) {
    out += fmt::format("\n{}\n", block.header);
    for (const auto& [key, member] : members_of(*block.table)) {
      out += fmt::format("{} = {}\n", key, in_one_line(*member));
    }
  }
  return out;
}

Scene SceneBuilder::build() const { return read_document(document_->root, {document_->title, 0, ""}); }

}  // namespace poise
