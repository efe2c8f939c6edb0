#include <algorithm>
#include <utility>

#include "model/couplings.hpp"
#include "model/part_placing.hpp"
#include "model/time_function.hpp"

namespace poise::parts {
namespace {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool has_formula(const toml::node& node) {
  if (const toml::array* const list = node.as_array()) return std::any_of(list->begin(), list->end(), has_formula);
  const toml::table* const table = node.as_table();
  if (table == nullptr) return false;
  return table->contains(FormulaInTime::key) ||
         std::any_of(table->begin(), table->end(), [](const auto& one) { return has_formula(one.second); });
}

}  // namespace

void Placing::rename_below(toml::node& node, std::string_view key) const {
  if (auto* const text = node.as_string()) {
    if (!is_one_of(key, {"name",  "at",    "on",     "follows", "slide",         "x",
                         "y",     "pin",   "center", "carrier", "pinion",        "wheel",
                         "line",  "a",     "b",      "pulley",  "turn",          "roller",
                         "acts",  "law",   "file",   "profile", "interpolation", "as",
                         "point", "reads", "sets",   "against", "stribeck"})) {
      rename(*text, key == FormulaInTime::key ? FormulaInTime::time_name : std::string_view());
    }
  } else if (toml::array* const list = node.as_array()) {
    const bool names = is_one_of(key, {"points", "bodies", "over", "rope", "line", "segment", "outline", "against"});
    for (toml::node& one : *list) {
      if (!names || !one.is_string()) rename_below(one, "");
    }
  } else if (toml::table* const table = node.as_table(); table != nullptr && key != "arc") {  // it has names of points
    for (auto&& [below, value] : *table) {
      // What a controller reads is told by names alone.
      if (key != "reads" || !value.is_string()) rename_below(value, below.str());
    }
  }
}

void Placing::name_body(std::string& name) {
  needs_frame_ = needs_frame_ || name == fixed_frame;
  name = named(name);
}

void Placing::name_point(std::string& name) {
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

std::string Placing::origin_of_places() {
  needs_frame_ = true;
  return frame() + "." + origin();
}

std::string Placing::carrier_of_gears() {
  needs_frame_ = true;
  return frame();
}

void Placing::note_negated(const toml::node& node) {
  const auto [at, is_new] = shared_.out.negated_.insert(PartedDocument::spot_of(node));
  if (!is_new) shared_.out.negated_.erase(at);
}

void Placing::take_value(toml::node& from, toml::table& to, const toml::key& key, std::string_view before) {
  if (before != key.str()) {
    std::string in_file(shared_.out.key_in_file(from, before));
    shared_.out.moved_[PartedDocument::spot_of(from)] = std::move(in_file);
  }
  MovedItems::take_value(from, to, key, before);
}

void Placing::place_item(std::string_view key, toml::table& table, const TomlTable& place) {
  if (!use_.scale_text.empty()) check_follows_scale(table, place);
  if (!use_.scale_text.empty() && key == "drive" && has_formula(table)) {
    place.place().fail(
        "expected a part whose key scale is a number: the value of a formula of time is none of its "
        "numbers");
  }
  rename_below(table, "");
  if (std::string* const name = text_in(table, "name")) name_joint(*name);
  transform(key, table, place);
}

void Placing::check_follows_scale(const toml::table& table, const TomlTable& place) const {
  const toml::array* const curve = table.get_as<toml::array>("curve");
  if (table.get_as<std::string>("file") != nullptr || (curve != nullptr && curve->size() > most_curve_points)) {
    place.place().fail("expected a part whose key scale is a number: the points of this curve are none of its numbers");
  }
  for (auto&& [key, below] : table) {
    if (const toml::table* const one = below.as_table()) check_follows_scale(*one, *place.find_table(key.str()));
  }
}

void Placing::place_body(toml::table& body, const TomlTable& place) {
  for (auto&& [key, value] : body) {
    if (key.str() != "points") rename_below(value, key.str());
  }
  rename_points(body);
  if (body.contains("section") && !group_.scale.is(1.0)) {
    place.find_table("section")->place().fail(
        "expected a part without the key scale, which changes lengths and no sections; remove one of them");
  }
  transform_body(body, place);
}

void Placing::rename_points(toml::table& owner) {
  toml::table* const points = table_in(owner, "points");
  if (points == nullptr) return;
  for (auto&& [key, at] : *points) rename_below(at, "");
}

}  // namespace poise::parts
