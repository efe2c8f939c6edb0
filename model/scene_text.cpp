#include "model/scene_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "model/copied_items.hpp"
#include "model/couplings.hpp"
#include "model/dependent_number.hpp"
#include "model/grouped_items.hpp"
#include "model/nearest_name.hpp"
#include "model/number_spots.hpp"
#include "model/one_line.hpp"
#include "model/parameter_values.hpp"
#include "model/parts.hpp"
#include "model/read_elements.hpp"
#include "model/read_scene.hpp"
#include "model/rewritten_scene.hpp"
#include "model/scene_names.hpp"
#include "model/text_file.hpp"
#include "model/toml_edits.hpp"
#include "model/toml_text.hpp"

namespace poise {
namespace {

/// The order in which a person writes tables: a new one stands behind those of its rank.
int rank_of(std::string_view table) {
  constexpr std::array<std::string_view, 5> first{"units", "numbers", "part", "ground", "body"};
  if (const auto at = std::find(first.begin(), first.end(), table); at != first.end())
    return static_cast<int>(at - first.begin());
  constexpr int joints = 10, elements = 11, couplings = 12, last = 13;
  for (const JointTraits& kind : Joint::kinds) {
    if (kind.key == table) return joints;
  }
  const std::vector<std::string_view> springs = element_tables();
  if (std::find(springs.begin(), springs.end(), table) != springs.end()) return elements;
  for (const CouplingKind& kind : coupling_kinds()) {
    if (kind.table == table) return couplings;
  }
  constexpr std::array<std::string_view, 8> end{"drive", "force", "distributed_load", "torque", "stop",
                                                "blade", "start", "outputs"};
  return last + static_cast<int>(std::find(end.begin(), end.end(), table) - end.begin());
}

/// Whether "BODY.POINT" is a point of the body.
bool is_point_of(std::string_view point, std::string_view body) {
  const std::size_t dot = point.rfind('.');
  return dot != std::string_view::npos && point.substr(0, dot) == body;
}

bool holds(const toml::node& node, const toml::node* wanted) {
  if (&node == wanted) return true;
  if (const toml::table* const table = node.as_table()) {
    return std::any_of(table->begin(), table->end(), [&](const auto& entry) { return holds(entry.second, wanted); });
  }
  const toml::array* const list = node.as_array();
  return list != nullptr &&
         std::any_of(list->begin(), list->end(), [&](const auto& one) { return holds(one, wanted); });
}

const toml::table* table_in(const toml::table* of, std::string_view key) {
  const toml::node* const node = of != nullptr ? of->get(key) : nullptr;
  return node != nullptr ? node->as_table() : nullptr;
}

/// Where a name stands in an expression of [outputs], as a part of the name of a quantity: npos where it does not.
std::size_t find_in_expression(std::string_view expression, std::string_view name, std::size_t from) {
  const auto is_part = [&](std::size_t at) {
    return at < expression.size() &&
           (std::isalnum(static_cast<unsigned char>(expression[at])) != 0 || expression[at] == '_');
  };
  for (std::size_t at = expression.find(name, from); at != std::string_view::npos; at = expression.find(name, at + 1)) {
    if (at > 0 && expression[at - 1] == '.' && !is_part(at + name.size())) return at;
  }
  return std::string_view::npos;
}

}  // namespace

std::string free_letter(std::set<std::string>& taken) {
  for (int round = 0;; ++round) {
    for (char letter = 'A'; letter <= 'Z'; ++letter) {
      std::string name(1, letter);
      if (round > 0) name += std::to_string(round);
      if (taken.insert(name).second) return name;
    }
  }
}

PlaneMotion PlaneMotion::after(const PlaneMotion& first, double angle_unit) const {
  const Vec2 at_first{first.at.x, mirrored ? -first.at.y : first.at.y};
  const double c = std::cos(angle * angle_unit), s = std::sin(angle * angle_unit);
  return {mirrored != first.mirrored,
          angle + (mirrored ? -first.angle : first.angle),
          {at.x + c * at_first.x - s * at_first.y, at.y + s * at_first.x + c * at_first.y}};
}

/// One change of a text.
class SceneText::Editing {
 public:
  Editing(const std::string& text, const std::string& file)
      : file_(file),
        document_(parse_toml(text, file)),
        scene_(read_document(parse_toml(text, file), {file, 1, ""}, {.may_lack_bodies = true, .uses = &named_})),
        parts_(parse_toml(text, file), {file, 1, ""}),
        spots_(parts_.document(), scene_),
        edits_(text, document_) {
    learn(document_);
    // What the files of parts have is not in this text.
    for (const NameUse& use : named_) {
      if (use.source.path || !use.source.begin) continue;
      const auto node = nodes_.find(place_of(use.source));
      // Some names are looked up more than once.
      const auto is_known = [&](const Use& known) { return known.node == node->second; };
      if (node != nodes_.end() && std::none_of(uses_.begin(), uses_.end(), is_known))
        uses_.push_back({use.of, use.text, node->second});
    }
  }

  std::string made() { return edits_.made(); }

  void add_point(const std::string& body, const TomlKeys& point) {
    const toml::table* const owner = table_of_body(body);
    const std::string header = body == scene_.bodies[0].name ? body : "body." + toml_key(body);
    if (const toml::table* const points = table_in(owner, "points"))
      return edits_.add(points, header + ".points", point);
    const TomlKeys points{{"points", "{ " + listed(point, "", ", ") + " }"}};
    if (owner != nullptr) return edits_.add(owner, header, points);
    insert_table(header, "[" + header + "]", points);
  }

  void add_body(const std::string& name, const TomlKeys& keys) {
    const std::string header = "body." + toml_key(name);
    insert_table("body", "[" + header + "]", keys);
  }

  void add_item(const std::string& table, const TomlKeys& keys) {
    const toml::node* const list = document_.get(table);
    if (list != nullptr && !edits_.is_header(*list)) {
      if (const toml::array* const array = list->as_array())
        return edits_.add_element(*array, "{ " + listed(keys, "", ", ") + " }");
    }
    insert_table(table, "[[" + table + "]]", keys);
  }

  void set(const SceneItem& item, const TomlKeys& keys) {
    const toml::table& table = table_of(item);
    TomlKeys added;
    for (const auto& [key, value] : keys) {
      if (const toml::node* const node = table.get(key))
        edits_.replace(*node, value);
      else
        added.emplace_back(key, value);
    }
    if (!added.empty()) edits_.add(&table, item.owner == Owner::body ? "body." + toml_key(item.own_name) : "", added);
  }

  /// Returns where the tables of the originals stand in their lists: each copy is behind those that there were.
  std::vector<CopiedSelection::Item> copy(const std::vector<SceneItem>& chosen, const PlaneMotion& step, int times) {
    const CopiedSelection selection = selected(chosen);
    constexpr std::size_t most_items = 10'000;
    if ((selection.bodies.size() + selection.items.size()) * static_cast<std::size_t>(times) > most_items)
      throw InputError(
          fmt::format("times: expected at most {} bodies, joints and other items in all copies", most_items));
    FreeNames names(scene_);
    TomlKeys ground, start, positions;
    CopiedItems::Tables bodies, items;
    const auto append = [](auto& to, const auto& more) { to.insert(to.end(), more.begin(), more.end()); };
    PlaneMotion motion = step;
    for (int k = 0; k < times; ++k) {
      const CopiedItems one(parse_toml(edits_.text(), file_), document_, edits_, file_, scene_, selection, motion,
                            names, false);
      append(ground, one.ground_points);
      append(bodies, one.bodies);
      append(items, one.items);
      append(start, one.start);
      append(positions, one.positions);
      motion = step.after(motion, scene_.units.angle);
    }
    if (!ground.empty()) add_point(scene_.bodies[0].name, ground);
    for (const auto& [name, keys] : bodies) add_body(name, keys);
    // What is added to the end of the text stands there in this order.
    std::stable_sort(items.begin(), items.end(),
                     [](const auto& a, const auto& b) { return rank_of(a.first) < rank_of(b.first); });
    for (const auto& [table, keys] : items) add_item(table, keys);
    write_start(start, positions);
    return selection.items;
  }

  /// The place of an item in the list of its owner, by that of its table in [[table]].
  int place_of_table(const std::string& table, std::size_t index) const {
    const toml::table* const wanted = document_[table][index].as_table();
    for (const auto& [item, own] : items_of_lists()) {
      if (own == wanted) return item.index;
    }
    return -1;
  }

  std::size_t count_of_tables(const std::string& table) const { return document_[table].as_array()->size(); }

  void move(const std::vector<SceneItem>& chosen, const PlaneMotion& motion) {
    const CopiedSelection selection = selected(chosen);
    FreeNames names(scene_);
    const CopiedItems moved(parse_toml(edits_.text(), file_), document_, edits_, file_, scene_, selection, motion,
                            names, true);
    const std::string& ground = scene_.bodies[0].name;
    for (const auto& [point, at] : moved.placed_points)
      edits_.replace(*table_in(table_of_body(ground), "points")->get(point), at);
    if (!moved.ground_points.empty()) add_point(ground, moved.ground_points);
    moved.change(edits_);
    for (const auto& [name, keys] : moved.bodies) add_body(name, keys);
    for (const auto& [table, keys] : moved.items) add_item(table, keys);
    write_start(moved.start, moved.positions);
  }

  void set_start(const std::string& table, const std::string& name, const std::string& value) {
    const toml::table* const start = table_in(&document_, "start");
    const toml::table* const within = table == "start" ? start : table_in(start, "position");
    const toml::node* const node = within != nullptr ? within->get(name) : nullptr;
    if (node != nullptr) return edits_.replace(*node, value);
    if (within != nullptr) return edits_.add(within, table, {{name, value}});
    if (table != "start" && start != nullptr)
      return edits_.add(start, "start", {{"position", "{ " + listed({{name, value}}, "", ", ") + " }"}});
    insert_table("start", "[" + table + "]", {{name, value}});
  }

  void remove(const std::vector<SceneItem>& items) {
    std::set<std::string> bodies, points, joints;
    std::set<const toml::table*> tables;
    for (const SceneItem& item : items) {
      if (item.owner == Owner::point)
        points.insert(item.name);
      else if (item.owner == Owner::body)
        bodies.insert(item.own_name);
      else
        tables.insert(&table_of(item));
      if (item.owner == Owner::joint) joints.insert(item.own_name);
    }
    const auto is_gone = [&](const Use& use) {
      const std::string& text = use.text;
      if (use.of == NameUse::Of::body) return bodies.contains(text);
      if (use.of == NameUse::Of::joint) return joints.contains(text);
      const std::size_t dot = text.rfind('.');
      return points.contains(text) || (dot != std::string::npos && bodies.contains(text.substr(0, dot)));
    };
    // What refers to what goes, goes too, and with a slide what refers to that.
    const std::vector<std::pair<SceneItem, const toml::table*>> all = items_of_lists();
    for (bool more = true; more;) {
      more = false;
      for (const auto& one : all) {
        const SceneItem& item = one.first;
        const toml::table* const table = one.second;
        if (tables.contains(table)) continue;
        if (std::none_of(uses_.begin(), uses_.end(),
                         [&](const Use& use) { return is_gone(use) && holds(*table, use.node); }))
          continue;
        more = true;
        tables.insert(table);
        if (item.owner == Owner::joint) joints.insert(item.own_name);
      }
    }
    for (const std::string& body : bodies) remove_body(body);
    std::map<std::string, std::vector<std::string>> gone_of_body;
    for (const std::string& point : points) {
      const std::size_t dot = point.rfind('.');
      if (bodies.contains(point.substr(0, dot))) continue;
      gone_of_body[point.substr(0, dot)].push_back(point.substr(dot + 1));
    }
    for (const auto& [body, gone] : gone_of_body) edits_.remove_keys(*table_in(table_of_body(body), "points"), gone);
    remove_tables(tables);
    remove_from_start(bodies);
    remove_from_start(joints);
    for (const auto& [item, table] : all) {
      if (item.owner != Owner::stop || !tables.contains(table)) continue;
      const std::vector<std::string> derived = derived_names(item.own_name);
      remove_from_start({derived.begin(), derived.end()});
    }
    std::set<std::string> names = bodies;
    names.insert(points.begin(), points.end());
    for (const auto& [item, table] : all) {
      if (tables.contains(table)) names.insert(item.own_name);
    }
    remove_outputs(names);
  }

  void rename(const SceneItem& item, const std::string& name) {
    const std::string& old = item.own_name;
    check_name(name, {file_, 0, "name"});
    for (const SceneItem& other : items()) {
      const bool is_twin = other.owner == item.owner && (item.owner != Owner::point || other.index == item.index);
      if (is_twin && other.own_name == name) throw InputError("name: expected another one; " + other.name + " has it");
    }
    switch (item.owner) {
      case Owner::body: {
        rename_key(*table_in(&document_, "body"), old, name, 1);
        for (const Use& use : uses_) {
          const std::string& text = use.text;
          if (use.of == NameUse::Of::body && text == old) edits_.replace(*use.node, toml_string(name));
          if (use.of == NameUse::Of::point && is_point_of(text, old))
            edits_.replace(*use.node, toml_string(name + text.substr(old.size())));
        }
        rename_in_start(old, name);
        rename_in_outputs({{old, name}});
        return;
      }
      case Owner::point: {
        const std::string body = scene_.bodies[static_cast<std::size_t>(item.index)].name;
        const toml::table* const owner = table_of_body(body);
        rename_key(*table_in(owner, "points"), old, name, body == scene_.bodies[0].name ? 2 : 3);
        const std::string renamed = body + "." + name;
        for (const Use& use : uses_) {
          if (use.of == NameUse::Of::point && use.text == item.name) edits_.replace(*use.node, toml_string(renamed));
        }
        const toml::table* const section = table_in(owner, "section");
        const toml::node* const line = section != nullptr ? section->get("line") : nullptr;
        for (std::size_t k = 0; line != nullptr && line->is_array() && k < line->as_array()->size(); ++k) {
          const toml::node& one = *line->as_array()->get(k);
          if (one.is_string() && one.as_string()->get() == old) edits_.replace(one, toml_string(name));
        }
        rename_in_outputs({{item.name, renamed}});
        return;
      }
      default: {
        set(item, {{"name", toml_string(name)}});
        if (item.owner == Owner::stop) {
          for (const std::string& derived : derived_names(old))
            rename_in_start(derived, name + derived.substr(old.size()));
        }
        if (item.owner == Owner::joint) {
          for (const Use& use : uses_) {
            if (use.of == NameUse::Of::joint && use.text == old) edits_.replace(*use.node, toml_string(name));
          }
          rename_in_start(old, name);
        }
        rename_in_outputs({{old, name}});
      }
    }
  }

  GroupedText group(const std::vector<SceneItem>& chosen, const std::string& name, const std::string& file) {
    const CopiedSelection selection = selected(chosen);
    if (selection.bodies.empty()) throw InputError("items: expected a link among what becomes a part; choose one too");
    GroupedItems items;
    std::set<const toml::table*> tables;
    std::set<const toml::node*> within;
    std::map<std::string, std::string> names;  // as outputs have them
    const std::string prefix = name + ".";
    const auto take_table = [&](const toml::table& table, const std::string& header) {
      items.tables.emplace_back(header, &table);
      each_below(table, [&](const toml::node& node) { within.insert(&node); });
    };
    items.guessed = selection.bodies;
    for (const std::string& body : selection.bodies) take_table(*table_of_body(body), "[body." + toml_key(body) + "]");
    for (const FlexibleLink& link : scene_.flexible_links) {
      if (!selection.bodies.contains(link.name)) continue;
      for (const int b : link.bodies) items.guessed.insert(scene_.bodies[static_cast<std::size_t>(b)].name);
    }
    for (const CopiedSelection::Item& item : selection.items) {
      const toml::table& table = *document_[item.table][item.index].as_table();
      tables.insert(&table);
      take_table(table, "[[" + item.table + "]]");
      names.emplace(item.name, prefix + item.name);
      items.guessed.insert(item.derived.begin(), item.derived.end());
      if (item.owner == Owner::joint) items.guessed.insert(item.name);
    }
    for (const std::string& one : items.guessed) names.emplace(one, prefix + one);
    expect_names_in_outputs();
    for (const Use& use : uses_) {
      items.names.insert(use.node);
      const std::size_t dot = use.of == NameUse::Of::point ? use.text.rfind('.') : use.text.size();
      const std::string owner = use.text.substr(0, dot);
      if (within.contains(use.node)) {
        if (use.of == NameUse::Of::point && owner == scene_.bodies[0].name)
          items.ground_points.insert(use.text.substr(dot + 1));
      } else if (items.guessed.contains(owner)) {
        edits_.replace(*use.node, toml_string(prefix + use.text));
      }
    }
    TomlKeys numbers, join;
    GroupedText out;
    out.part = text_of_part(items, document_, scene_.bodies[0].name, edits_, numbers);
    for (const std::string& point : items.ground_points)
      join.emplace_back(point, toml_string(scene_.bodies[0].name + "." + point));
    TomlKeys keys{{"name", toml_string(name)}, {"file", toml_string(file)}};
    if (!join.empty()) keys.emplace_back("join", "{ " + listed(join, "", ", ") + " }");
    if (!numbers.empty()) keys.emplace_back("numbers", "{ " + listed(numbers, "", ", ") + " }");
    add_item("part", keys);
    for (const std::string& one : items.guessed) rename_in_start(one, prefix + one);
    rename_in_outputs(names);
    for (const std::string& body : selection.bodies) remove_body(body);
    remove_tables(tables);
    out.scene = made();
    return out;
  }

  std::string ungroup(const std::string& name) {
    const toml::table& table = table_of_part(name);
    for (auto&& [key, node] : table) {
      if (const std::string_view word = key.str();
          word != "name" && word != "file" && word != "join" && word != "numbers")
        throw InputError(
            fmt::format("part {}: expected one that is where its file says; \"{}\" places it elsewhere", name, word));
    }
    const std::string file =
        (std::filesystem::path(file_).parent_path() / *table["file"].value<std::string>()).string();
    const std::string text = read_text_file(file);
    Editing part(text, file);
    const Units &own = scene_.units, &units = part.scene_.units;
    if (units.length != own.length || units.force != own.force || units.mass != own.mass || units.angle != own.angle)
      throw InputError(file + ": units: expected those of the scene; change them there");
    for (const SceneItem& item : part.items()) {
      if (item.owner == Owner::point || (item.owner == Owner::body && item.index == 0)) continue;
      for (const SceneItem& other : items()) {
        if (other.name == item.name)
          throw InputError(
              fmt::format("part {}: expected names that the scene does not have, found \"{}\" in both; "
                          "give that of the scene another name",
                          name, item.name));
      }
    }
    const std::string& ground = scene_.bodies[0].name;
    const toml::table* const join = table_in(&table, "join");
    const auto joined_to = [&](const std::string& point) {
      const toml::node* const to = join != nullptr ? join->get(point) : nullptr;
      return to != nullptr ? *to->value<std::string>() : ground + "." + point;
    };
    for (const Use& use : part.uses_) {
      const std::size_t dot = use.text.rfind('.');
      if (use.of == NameUse::Of::point && use.text.substr(0, dot) == ground)
        part.edits_.replace(*use.node, toml_string(joined_to(use.text.substr(dot + 1))));
    }
    const std::string joined = part.edits_.made();
    const toml::table document = parse_toml(joined, file);
    const TomlEdits whole(joined, document);
    const toml::table none;
    const auto keys_in = [&](const toml::table* of, auto is_wanted) {
      TomlKeys out;
      for (auto&& [key, node] : of != nullptr ? *of : none) {
        const std::string word(key.str());
        if (!node.is_table() && is_wanted(word)) out.emplace_back(word, whole.source(node));
      }
      return out;
    };
    const toml::table* const own_points = table_in(table_in(&document_, ground), "points");
    const TomlKeys points = keys_in(table_in(table_in(&document, ground), "points"), [&](const std::string& point) {
      const bool is_known = own_points != nullptr && own_points->contains(point);
      const bool is_joined = join != nullptr && join->contains(point);
      if (is_known && !is_joined)
        throw InputError(
            fmt::format("part {}: expected points of the ground that the scene does not have, found \"{}\" "
                        "in both; give that of the scene another name",
                        name, point));
      return !is_joined;
    });
    const toml::table *const numbers = table_in(&document_, "numbers"), *const given = table_in(&table, "numbers");
    const TomlKeys added = keys_in(table_in(&document, "numbers"), [&](const std::string& number) {
      const toml::node* const from = given != nullptr ? given->get(number) : nullptr;
      const bool is_own = from != nullptr && from->value<std::string>() == number;
      if (!is_own && (from != nullptr || (numbers != nullptr && numbers->contains(number))))
        throw InputError(
            fmt::format("part {}: expected the number \"{}\" to be that of the scene of this name; give it "
                        "another name in {}",
                        name, number, file));
      return !is_own;
    });
    if (!added.empty() && numbers != nullptr)
      edits_.add(numbers, "numbers", added);
    else if (!added.empty())
      insert_table("numbers", "[numbers]", added);
    if (!points.empty()) add_point(ground, points);
    std::vector<std::pair<const toml::table*, std::string>> tables;
    for (auto&& [key, node] : document) {
      if (key.str() == "body") {
        for (auto&& [body, one] : *node.as_table())
          tables.emplace_back(one.as_table(), "[body." + toml_key(std::string(body.str())) + "]");
      } else if (const toml::array* const list = node.as_array(); list != nullptr && key.str() != "gravity") {
        for (const toml::node& one : *list) tables.emplace_back(one.as_table(), fmt::format("[[{}]]", key.str()));
      }
    }
    std::sort(tables.begin(), tables.end(),
              [](const auto& a, const auto& b) { return a.first->source().begin < b.first->source().begin; });
    for (const auto& [one, header] : tables) {
      const std::string path = header.substr(header.find_first_not_of('['));
      insert_lines(path.substr(0, path.find_first_of(".]")), written_table(*one, header, whole));
    }
    const std::string prefix = name + ".";
    const toml::table* const start = table_in(&document_, "start");
    const auto is_free = [&](const toml::table* guesses) {
      return [guesses, &prefix](const std::string& word) {
        return guesses == nullptr || !guesses->contains(prefix + word);
      };
    };
    const toml::table* const own_start = table_in(&document, "start");
    write_start(keys_in(own_start, is_free(start)),
                keys_in(table_in(own_start, "position"), is_free(table_in(start, "position"))));
    std::map<std::string, std::string> names;
    const auto rename_all = [&](const auto& list) {
      for (const auto& one : list) {
        if (!one.name.starts_with(prefix)) continue;
        names.emplace(one.name, one.name.substr(prefix.size()));
      }
    };
    rename_all(scene_.bodies);
    rename_all(scene_.joints);
    for (const auto& [old, renamed] : names) rename_in_start(old, renamed);
    rename_all(scene_.elements);
    rename_all(scene_.drives);
    rename_all(scene_.forces);
    rename_all(scene_.torques);
    rename_all(scene_.stops);
    rename_all(scene_.blades);
    rename_in_outputs(names);
    for (const Use& use : uses_) {
      if (use.text.starts_with(prefix)) edits_.replace(*use.node, toml_string(use.text.substr(prefix.size())));
    }
    remove_tables({&table});
    return without_numbers_of(made(), std::filesystem::path(file).stem().string() + ".");
  }

  std::vector<std::string> parts() const {
    std::vector<std::string> out;
    each_part([&](const std::string& name, const toml::table& table) {
      if (!table.contains("repeat")) out.push_back(name);
    });
    return out;
  }

  SceneItem item(const std::string& name) const {
    if (name == scene_.bodies[0].name) throw InputError("the ground stays; expected another item");
    std::vector<std::string> names;
    for (const SceneItem& one : items()) {
      if (one.name == name) return one;
      names.push_back(one.name);
    }
    throw InputError("expected an item of the scene" + did_you_mean_or_list(name, names));
  }

  std::vector<SceneItem> chosen(const std::vector<std::string>& names) const {
    std::vector<SceneItem> out;
    for (const std::string& name : names) out.push_back(item(name));
    return out;
  }

  std::vector<SceneItem> items() const {
    std::vector<SceneItem> out;
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const Body& body = scene_.bodies[b];
      const int index = static_cast<int>(b);
      if (b > 0 && table_in(table_in(&document_, "body"), body.name) == nullptr) continue;
      out.push_back({body.name, body.name, Owner::body, index});
      for (std::size_t p = 0; p < body.points.size(); ++p) {
        const PointRef point{index, static_cast<int>(p)};
        out.push_back({scene_.name_of(point), body.points[p].name, Owner::point, point.body, point.point});
      }
    }
    for (const FlexibleLink& link : scene_.flexible_links)
      out.push_back({link.name, link.name, Owner::body, link.bodies.front()});
    for (const auto& [item, table] : items_of_lists()) out.push_back(item);
    return out;
  }

  Scene take_scene() { return std::move(scene_); }

 private:
  /// A name in this text.
  struct Use {
    NameUse::Of of;
    std::string text;
    const toml::node* node;
  };

  template <class Visit>
  void each_part(Visit visit) const {
    const toml::node* const list = document_.get("part");
    if (list == nullptr) return;
    for (const toml::node& one : *list->as_array()) {
      const toml::table& table = *one.as_table();
      const std::filesystem::path file(*table["file"].value<std::string>());
      visit(table["name"].value<std::string>().value_or(file.stem().string()), table);
    }
  }

  const toml::table& table_of_part(const std::string& wanted) const {
    const toml::table* found = nullptr;
    std::vector<std::string> names;
    each_part([&](const std::string& name, const toml::table& table) {
      names.push_back(name);
      if (name == wanted) found = &table;
    });
    if (found == nullptr) throw InputError("part: expected one of the scene" + did_you_mean_or_list(wanted, names));
    return *found;
  }

  /// Numbers of a part's file that the scene has changed do not outlive it.
  std::string without_numbers_of(std::string text, const std::string& prefix) const {
    const toml::table document = parse_toml(text, file_);
    const toml::table* const numbers = table_in(&document, "numbers");
    std::vector<std::string> gone;
    for (auto&& [key, node] : numbers != nullptr ? *numbers : toml::table()) {
      if (key.str().starts_with(prefix)) gone.emplace_back(key.str());
    }
    if (gone.empty()) return text;
    TomlEdits edits(text, document);
    edits.remove_keys(*numbers, gone);
    return edits.made();
  }

  /// Items without names are counted, and have other numbers where some of them are in a part.
  void expect_names_in_outputs() const {
    const toml::table* const outputs = table_in(&document_, "outputs");
    for (const auto& [item, table] : items_of_lists()) {
      if (item.owner == Owner::joint || table->contains("name") || outputs == nullptr) continue;
      for (auto&& [key, node] : *outputs) {
        if (const auto* const text = node.as_string();
            text != nullptr && find_in_expression(text->get(), item.own_name, 0) != std::string::npos)
          throw InputError(
              fmt::format("outputs: \"{}\" reads {}, which is counted; give that a name first", key.str(), item.name));
      }
    }
  }

  static std::pair<toml::source_index, toml::source_index> place_of(const toml::source_region& source) {
    return {source.begin.line, source.begin.column};
  }

  /// Finds the nodes below one by their places.
  void learn(const toml::node& node) {
    // A table that others imply begins where they do, and a list with its first table.
    if (const toml::table* const table = node.as_table()) {
      for (auto&& [key, below] : *table) learn(below);
      nodes_.emplace(place_of(node.source()), &node);
    } else if (const toml::array* const list = node.as_array()) {
      for (const toml::node& one : *list) learn(one);
    } else {
      nodes_.emplace(place_of(node.source()), &node);
    }
  }

  /// The table of an item in this text; null of one that it does not have.
  const toml::table* own_table(Owner owner, int index) const {
    const toml::table* const table = spots_.item(owner, index);
    if (table == nullptr || table->source().path || !table->source().begin) return nullptr;
    const auto node = nodes_.find(place_of(table->source()));
    return node == nodes_.end() ? nullptr : node->second->as_table();
  }

  [[noreturn]] void fail(const std::string& name) const {
    throw InputError(fmt::format("{}: {} has no table of its own; change the text", file_, name));
  }

  const toml::table* table_of_body(const std::string& name) const {
    if (name == scene_.bodies[0].name) return table_in(&document_, name);
    const toml::table* const body = table_in(table_in(&document_, "body"), name);
    if (body == nullptr) throw InputError("expected a body, found \"" + name + "\"");
    return body;
  }

  const toml::table& table_of(const SceneItem& item) const {
    const toml::table* const table =
        item.owner == Owner::body ? table_of_body(item.own_name) : own_table(item.owner, item.index);
    if (table == nullptr || item.owner == Owner::point) fail(item.name);
    return *table;
  }

  /// Those with a table in a list of the document: what refers to bodies.
  std::vector<std::pair<SceneItem, const toml::table*>> items_of_lists() const {
    std::set<const toml::table*> tables;
    for (auto&& [key, node] : document_) {
      const toml::array* const list = node.as_array();
      for (std::size_t k = 0; list != nullptr && k < list->size(); ++k) tables.insert(list->get(k)->as_table());
    }
    std::vector<std::pair<SceneItem, const toml::table*>> out;
    const auto add = [&](const auto& list, Owner owner, auto family) {
      for (std::size_t k = 0; k < list.size(); ++k) {
        const toml::table* const table = own_table(owner, static_cast<int>(k));
        if (table == nullptr || !tables.contains(table)) continue;
        out.push_back({{family(list[k]) + " " + list[k].name, list[k].name, owner, static_cast<int>(k)}, table});
      }
    };
    add(scene_.joints, Owner::joint, [](const Joint& joint) { return words_of_key(joint.traits().key); });
    add(scene_.elements, Owner::element, [](const Element& element) { return element.family(); });
    add(scene_.drives, Owner::drive, [](const Drive&) { return std::string("drive"); });
    add(scene_.forces, Owner::force,
        [](const Force& force) { return std::string(force.to ? "distributed load" : "load"); });
    add(scene_.torques, Owner::torque, [](const Torque&) { return std::string("torque"); });
    add(scene_.stops, Owner::stop, [](const Stop& stop) { return stop.family(); });
    add(scene_.blades, Owner::blade, [](const Blade&) { return std::string("blade"); });
    return out;
  }

  /// Guesses of the file in place of those that it has, or behind them.
  void write_start(const TomlKeys& start, const TomlKeys& positions) {
    const toml::table* const written = table_in(&document_, "start");
    const toml::table* const places = table_in(written, "position");
    const auto write = [&](const toml::table* table, const TomlKeys& keys) {
      TomlKeys added;
      for (const auto& [key, value] : keys) {
        const toml::node* const known = table != nullptr ? table->get(key) : nullptr;
        if (known != nullptr)
          edits_.replace(*known, value);
        else
          added.emplace_back(key, value);
      }
      return added;
    };
    TomlKeys added = write(written, start);
    const TomlKeys added_places = write(places, positions);
    if (places != nullptr && !added_places.empty())
      edits_.add(places, "start.position", added_places);
    else if (!added_places.empty())
      added.emplace_back("position", "{ " + listed(added_places, "", ", ") + " }");
    if (added.empty()) return;
    if (written != nullptr)
      edits_.add(written, "start", added);
    else
      insert_table("start", "[start]", added);
  }

  /// The chosen items with all that is among the bodies of them, and between these and the ground.
  CopiedSelection selected(const std::vector<SceneItem>& chosen) const {
    CopiedSelection out;
    std::set<const toml::table*> wanted, taken;
    for (const SceneItem& item : chosen) {
      if (item.owner == Owner::body) out.bodies.insert(item.own_name);
      if (item.owner == Owner::point && item.index == 0) out.ground_points.push_back(item.own_name);
      if (item.owner != Owner::body && item.owner != Owner::point) wanted.insert(&table_of(item));
    }
    std::map<const toml::node*, const Use*> uses;
    for (const Use& use : uses_) uses[use.node] = &use;
    std::set<std::string> joints;
    const std::vector<std::pair<SceneItem, const toml::table*>> all = items_of_lists();
    const auto is_copied = [&](const toml::table& table) {
      bool is_among = true, is_of_one = false;
      const auto look = [&](const Use& use) {
        const bool is_point = use.of == NameUse::Of::point;
        const std::string body = is_point ? use.text.substr(0, use.text.rfind('.')) : use.text;
        if (use.of != NameUse::Of::joint && body == scene_.bodies[0].name) return;
        const bool is_known = use.of == NameUse::Of::joint ? joints.contains(use.text) : out.bodies.contains(body);
        is_among = is_among && is_known;
        is_of_one = is_of_one || is_known;
      };
      each_below(table, [&](const toml::node& node) {
        if (const auto use = uses.find(&node); use != uses.end()) look(*use->second);
      });
      return is_among && is_of_one;
    };
    for (bool more = true; more;) {
      more = false;
      for (const auto& [item, table] : all) {
        if (taken.contains(table) || !is_copied(*table)) continue;
        more = true;
        taken.insert(table);
        if (item.owner == Owner::joint) joints.insert(item.own_name);
        if (item.owner != Owner::stop) continue;
        const std::vector<std::string> derived = derived_names(item.own_name);
        joints.insert(derived.begin(), derived.end());
      }
    }
    for (const SceneItem& item : chosen) {
      const bool is_of_list = item.owner != Owner::body && item.owner != Owner::point;
      const bool is_loose = item.owner == Owner::point && item.index > 0 &&
                            !out.bodies.contains(scene_.bodies[static_cast<std::size_t>(item.index)].name);
      if (is_loose || (is_of_list && !taken.contains(&table_of(item))))
        throw InputError(item.name + ": expected its links among the items too; choose them as well");
    }
    std::set<const toml::node*> within;
    for (const toml::table* const table : taken)
      each_below(*table, [&](const toml::node& node) { within.insert(&node); });
    for (const Use& use : uses_) {
      if (use.of == NameUse::Of::point && is_point_of(use.text, scene_.bodies[0].name) && !within.contains(use.node))
        out.shared_points.insert(use.text.substr(use.text.rfind('.') + 1));
    }
    for (auto&& [key, node] : document_) {
      const toml::array* const list = node.as_array();
      for (std::size_t k = 0; list != nullptr && k < list->size(); ++k) {
        const toml::table* const table = list->get(k)->as_table();
        if (!taken.contains(table)) continue;
        const auto one = std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.second == table; });
        const SceneItem& item = one->first;
        const bool may_derive = item.owner == Owner::stop;
        out.items.push_back({std::string(key.str()), k, item.owner, item.own_name,
                             may_derive ? derived_names(item.own_name) : std::vector<std::string>{}});
      }
    }
    return out;
  }

  template <class Visit>
  static void each_below(const toml::node& node, Visit visit) {
    visit(node);
    if (const toml::table* const table = node.as_table()) {
      for (auto&& [key, below] : *table) each_below(below, visit);
    } else if (const toml::array* const list = node.as_array()) {
      for (const toml::node& below : *list) each_below(below, visit);
    }
  }

  /// What [start] calls by the name of a slot, a rolling wheel or a chain: bodies and travels that come with it.
  std::vector<std::string> derived_names(const std::string& name) const {
    std::vector<std::string> out;
    for (const char* const end : {"", " rider", " radius"}) {
      const std::string derived = name + end;
      const auto is_called = [&](const auto& item) { return item.name == derived; };
      const auto body = std::find_if(scene_.bodies.begin(), scene_.bodies.end(), is_called);
      const auto joint = std::find_if(scene_.joints.begin(), scene_.joints.end(), is_called);
      const bool is_own = table_in(table_in(&document_, "body"), derived) != nullptr ||
                          (joint != scene_.joints.end() &&
                           own_table(Owner::joint, static_cast<int>(joint - scene_.joints.begin())) != nullptr);
      if (!is_own && (body != scene_.bodies.end() || joint != scene_.joints.end())) out.push_back(derived);
    }
    return out;
  }

  void insert_table(const std::string& path, const std::string& header, const TomlKeys& keys) {
    const char* const end = edits_.line_end();
    insert_lines(path, header + end + listed(keys, "", end) + end);
  }

  /// Behind all tables of its rank and of lower ones.
  void insert_lines(const std::string& path, const std::string& lines) {
    const char* const end = edits_.line_end();
    const int rank = rank_of(path.substr(0, path.find('.')));
    std::vector<std::pair<const toml::table*, int>> headers;
    for (auto&& [key, node] : document_) {
      const int of_key = rank_of(key.str());
      const auto add = [&](const toml::table& table) {
        if (edits_.has_header(table)) headers.emplace_back(&table, of_key);
        for (const toml::table* const below : edits_.headers_below(table)) headers.emplace_back(below, of_key);
      };
      if (const toml::table* const table = node.as_table()) add(*table);
      if (const toml::array* const list = node.as_array(); list != nullptr && edits_.is_header(node)) {
        for (const toml::node& element : *list) add(*element.as_table());
      }
    }
    std::sort(headers.begin(), headers.end(),
              [](const auto& a, const auto& b) { return a.first->source().begin < b.first->source().begin; });
    std::size_t at = headers.size();
    while (at > 0 && headers[at - 1].second > rank) --at;
    if (at < headers.size()) return edits_.insert_before(headers[at].first, lines + end);
    edits_.insert_before(nullptr, (edits_.is_empty() ? "" : end) + lines);
  }

  void remove_body(const std::string& name) {
    const toml::table& bodies = *table_in(&document_, "body");
    const toml::table& body = *table_of_body(name);
    if (edits_.remove_table(body)) return;
    const std::vector<const toml::table*> below = edits_.headers_below(body);
    if (below.empty()) return edits_.remove_keys(bodies, {name});
    for (const toml::table* const one : below) edits_.remove_table(*one);
  }

  void remove_tables(const std::set<const toml::table*>& tables) {
    for (auto&& [key, node] : document_) {
      const toml::array* const list = node.as_array();
      if (list == nullptr) continue;
      std::vector<std::size_t> gone;
      for (std::size_t k = 0; k < list->size(); ++k) {
        if (tables.contains(list->get(k)->as_table())) gone.push_back(k);
      }
      if (edits_.is_header(node)) {
        for (const std::size_t k : gone) edits_.remove_table(*list->get(k)->as_table());
      } else if (gone.size() == list->size()) {
        if (!gone.empty()) edits_.remove_keys(document_, {std::string(key.str())});
      } else if (!gone.empty()) {
        edits_.remove_elements(*list, gone);
      }
    }
  }

  void remove_from_start(const std::set<std::string>& names) {
    const toml::table* const start = table_in(&document_, "start");
    for (const toml::table* const table : {start, table_in(start, "position")}) {
      if (table == nullptr) continue;
      std::vector<std::string> gone;
      for (auto&& [key, node] : *table) {
        if (names.contains(std::string(key.str())) && !(table == start && node.is_table()))
          gone.emplace_back(key.str());
      }
      edits_.remove_keys(*table, gone);
    }
  }

  void remove_outputs(const std::set<std::string>& names) {
    const toml::table* const outputs = table_in(&document_, "outputs");
    if (outputs == nullptr) return;
    std::vector<std::string> gone;
    for (auto&& [key, node] : *outputs) {
      const auto* const text = node.as_string();
      if (text != nullptr && std::any_of(names.begin(), names.end(), [&](const std::string& name) {
            return find_in_expression(text->get(), name, 0) != std::string::npos;
          }))
        gone.emplace_back(key.str());
    }
    edits_.remove_keys(*outputs, gone);
  }

  /// A key of a table; where it stands in headers, behind so many other parts of them, there.
  void rename_key(const toml::table& table, const std::string& old, const std::string& name, std::size_t parts_before) {
    for (auto&& [key, node] : table) {
      if (key.str() != old) continue;
      const toml::table* const below = node.as_table();
      if (below == nullptr || (!edits_.has_header(*below) && edits_.headers_below(*below).empty()))
        return edits_.replace_key(key, name);
      if (edits_.has_header(*below)) edits_.replace_in_header(*below, parts_before, name);
      for (const toml::table* const one : edits_.headers_below(*below))
        edits_.replace_in_header(*one, parts_before, name);
    }
  }

  void rename_in_start(const std::string& old, const std::string& name) {
    const toml::table* const start = table_in(&document_, "start");
    for (const toml::table* const table : {start, table_in(start, "position")}) {
      if (table == nullptr) continue;
      for (auto&& [key, node] : *table) {
        if (key.str() == old && !(table == start && node.is_table())) edits_.replace_key(key, name);
      }
    }
  }

  void rename_in_outputs(const std::map<std::string, std::string>& names) {
    const toml::table* const outputs = table_in(&document_, "outputs");
    if (outputs == nullptr) return;
    for (auto&& [key, node] : *outputs) {
      const auto* const text = node.as_string();
      if (text == nullptr) continue;
      const std::string& before = text->get();
      std::string out;
      for (std::size_t at = 0; at < before.size();) {
        std::size_t next = before.size();
        const std::pair<const std::string, std::string>* found = nullptr;
        for (const auto& one : names) {
          const std::size_t there = find_in_expression(before, one.first, at);
          if (there > next || there == std::string::npos || (there == next && found == nullptr)) continue;
          if (there == next && one.first.size() < found->first.size()) continue;
          next = there;
          found = &one;
        }
        out.append(before, at, next - at).append(found != nullptr ? found->second : "");
        at = next + (found != nullptr ? found->first.size() : 0);
      }
      if (out != before) edits_.replace(node, toml_string(out));
    }
  }

  const std::string& file_;
  toml::table document_;
  std::vector<NameUse> named_;
  Scene scene_;
  PartedDocument parts_;
  NumberSpots spots_;
  TomlEdits edits_;
  std::map<std::pair<toml::source_index, toml::source_index>, const toml::node*> nodes_;
  std::vector<Use> uses_;
};

SceneText::SceneText(std::string text, std::string file) : file_(std::move(file)) { take(std::move(text)); }

void SceneText::take(std::string text) {
  Editing read(text, file_);
  items_ = read.items();
  parts_ = read.parts();
  scene_ = read.take_scene();
  text_ = std::move(text);
}

void SceneText::add_point(const std::string& body, const std::string& name, const std::string& at) {
  Editing editing(text_, file_);
  editing.add_point(body, {{name, at}});
  take(editing.made());
}

void SceneText::add_body(const std::string& name, const TomlKeys& keys) {
  Editing editing(text_, file_);
  editing.add_body(name, keys);
  take(editing.made());
}

void SceneText::add_item(const std::string& table, const TomlKeys& keys) {
  Editing editing(text_, file_);
  editing.add_item(table, keys);
  take(editing.made());
}

void SceneText::set(const std::string& item, const TomlKeys& keys) {
  if (keys.empty()) throw InputError("values: expected a key at least");
  Editing editing(text_, file_);
  editing.set(editing.item(item), keys);
  take(editing.made());
}

void SceneText::set_start(const std::string& name, const std::string& value) {
  Editing editing(text_, file_);
  editing.set_start("start", name, value);
  take(editing.made());
}

void SceneText::set_start_position(const std::string& body, const std::string& value) {
  Editing editing(text_, file_);
  editing.set_start("start.position", body, value);
  take(editing.made());
}

void SceneText::remove(const std::vector<std::string>& items) {
  if (items.empty()) throw InputError("items: expected one at least");
  Editing editing(text_, file_);
  editing.remove(editing.chosen(items));
  take(editing.made());
}

std::vector<ItemCopy> SceneText::copy(const std::vector<std::string>& items, const PlaneMotion& step, int times) {
  constexpr int most_times = 1000;
  if (items.empty()) throw InputError("items: expected one at least");
  if (times < 1 || times > most_times)
    throw InputError(fmt::format("times: expected a whole number from 1 to {}, found {}", most_times, times));
  Editing editing(text_, file_);
  const std::vector<CopiedSelection::Item> originals = editing.copy(editing.chosen(items), step, times);
  take(editing.made());
  const Editing made(text_, file_);
  std::vector<ItemCopy> out;
  std::map<std::string, std::size_t> next;  // in the list of each table
  for (int k = 0; k < times; ++k) {
    for (const CopiedSelection::Item& one : originals) {
      const std::size_t at = next.emplace(one.table, editing.count_of_tables(one.table)).first->second++;
      out.push_back({one.owner, editing.place_of_table(one.table, one.index), made.place_of_table(one.table, at)});
    }
  }
  return out;
}

void SceneText::move(const std::vector<std::string>& items, const PlaneMotion& motion) {
  if (items.empty()) throw InputError("items: expected one at least");
  Editing editing(text_, file_);
  editing.move(editing.chosen(items), motion);
  take(editing.made());
}

void SceneText::rename(const std::string& item, const std::string& name) {
  Editing editing(text_, file_);
  editing.rename(editing.item(item), name);
  take(editing.made());
}

GroupedText SceneText::grouped(const std::vector<std::string>& items, const std::string& name,
                               const std::string& file) const {
  if (items.empty()) throw InputError("items: expected one at least");
  Editing editing(text_, file_);
  return editing.group(editing.chosen(items), name, file);
}

std::string SceneText::ungrouped(const std::string& part) const {
  Editing editing(text_, file_);
  const std::string text = editing.ungroup(part);
  Scene scene = parse_sketch(text, file_);
  std::map<std::string, double> wanted;
  const std::vector<ParameterRow> rows = parameter_table(scene_);
  const std::vector<std::optional<double>> values = parameter_values(scene_);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::string path = rows[i].path.text();
    if (const std::size_t at = path.find("." + part + "."); at != std::string::npos) path.erase(at, part.size() + 1);
    if (values[i]) wanted.emplace(std::move(path), *values[i]);
  }
  for (const ParameterRow& row : parameter_table(scene)) {
    const auto value = wanted.find(row.path.text());
    if (value == wanted.end() || dependent_number(scene, row.place) != nullptr) continue;
    if (value_at(scene, row.place) != value->second) set_value_at(scene, row.place, value->second);
  }
  return rewritten_scene(text, file_, scene);
}

}  // namespace poise
