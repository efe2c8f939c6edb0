#include <utility>

#include "model/couplings.hpp"
#include "model/part_placing.hpp"

namespace poise::parts {
namespace {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

void Placing::rename_below(toml::node& node, std::string_view key) const {
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

void Placing::name_in(toml::table& table, std::string_view key, void (Placing::*give)(std::string&)) {
  if (std::string* const name = text_in(table, key)) (this->*give)(*name);
}

void Placing::name_list(toml::table& table, std::string_view key, void (Placing::*give)(std::string&)) {
  toml::array* const list = list_in(table, key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    if (auto* const name = list->get_as<std::string>(i)) (this->*give)(name->get());
  }
}

void Placing::negate(toml::node* node) {
  if (node == nullptr) return;
  if (auto* const text = node->as_string()) *text = "-(" + text->get() + ")";
  if (auto* const whole = node->as_integer()) *whole = -whole->get();
  if (auto* const real = node->as_floating_point()) *real = -real->get();
  bool& is_negated = shared_.out.negated_[node];
  is_negated = !is_negated;
}

void Placing::mirror(toml::node* vector, std::size_t component) {
  toml::array* const list = group_.mirrored && vector != nullptr ? vector->as_array() : nullptr;
  if (list != nullptr && list->size() == 2) negate(list->get(component));
}

void Placing::mirror_number(toml::table& table, std::string_view key) {
  if (group_.mirrored) negate(table.get(key));
}

void Placing::mirror_curve(toml::table& table) {
  toml::array* const points = list_in(table, "curve");
  for (std::size_t i = 0; points != nullptr && i < points->size(); ++i) mirror(points->get(i));
}

void Placing::exchange(toml::table& table, std::string_view key) const {
  toml::array* const list = group_.mirrored ? list_in(table, key) : nullptr;
  if (list == nullptr || list->size() != 2) return;
  auto *const a = list->get_as<std::string>(0), *const b = list->get_as<std::string>(1);
  if (a != nullptr && b != nullptr) std::swap(a->get(), b->get());
}

void Placing::mirror_turn(toml::table& table) const {
  std::string* const turn = group_.mirrored ? text_in(table, "turn") : nullptr;
  if (turn == nullptr) return;
  if (*turn == "clockwise")
    *turn = "counterclockwise";
  else if (*turn == "counterclockwise")
    *turn = "clockwise";
}

void Placing::transform_measure(toml::table& table) {
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

void Placing::transform_rope(toml::table& table, std::string_view key) {
  name_list(table, key, &Placing::name_point);
  for (toml::table* const pulley : tables_in(table, key)) {
    name_in(*pulley, "pulley", &Placing::name_point);
    mirror_turn(*pulley);
  }
}

void Placing::turn_load(toml::table& table) {
  for (const std::string_view key : {"vector", "direction"}) {
    toml::array* const vector = list_in(table, key);
    mirror(vector);
    if (vector == nullptr || vector->size() != 2 || angle_.is(0.0) || table.contains("follows")) continue;
    *vector = parts::array_of(direction_.turned({Amount::component(vector, 0), Amount::component(vector, 1)}));
  }
}

void Placing::transform(std::string_view key, toml::table& table, const TomlTable& place) {
  if (!use_.scale_text.empty()) check_follows_scale(table, place);
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

void Placing::check_follows_scale(const toml::table& table, const TomlTable& place) const {
  const toml::array* const curve = table.get_as<toml::array>("curve");
  if (table.get_as<std::string>("file") != nullptr || (curve != nullptr && curve->size() > most_curve_points)) {
    place.place().fail("expected a part whose key scale is a number: the points of this curve are none of its numbers");
  }
  for (auto&& [key, below] : table) {
    if (const toml::table* const one = below.as_table()) check_follows_scale(*one, *place.find_table(key.str()));
  }
}

void Placing::transform_track(std::string_view key, toml::table& table, const TomlTable& place) {
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

void Placing::exchange_ends(toml::table& table) {
  toml::table ends;
  for (const auto& [key, other] : {std::pair("from", "to"), std::pair("to", "from")}) {
    toml::node* const node = table.get(key);
    if (node == nullptr) continue;
    const std::string in_file(shared_.out.key_in_file(*node, key));
    move_marked(*node, ends, toml::key(other, key_source(table, key)));
    shared_.out.moved_[ends.get(other)] = in_file;
    table.erase(key);
  }
  for (auto&& [key, node] : ends) move_marked(node, table, key);
}

void Placing::move_marked(toml::node& from, toml::table& to, const toml::key& key) {
  auto negated = shared_.out.negated_.extract(&from);
  auto moved = shared_.out.moved_.extract(&from);
  to.insert_or_assign(key, std::move(from));
  const toml::node* const node = to.get(key.str());
  if (negated) shared_.out.negated_[node] = negated.mapped();
  if (moved) shared_.out.moved_[node] = moved.mapped();
}

void Placing::transform_body(toml::table& body, const TomlTable& place) {
  for (auto&& [key, value] : body) {
    if (key.str() != "points") rename_below(value, key.str());
  }
  transform_points(body);
  mirror(body.get("center"));
  toml::table* const section = table_in(body, "section");
  if (section != nullptr && !group_.scale.is(1.0)) {
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

void Placing::transform_points(toml::table& owner) {
  toml::table* const points = table_in(owner, "points");
  if (points == nullptr) return;
  for (auto&& [key, at] : *points) {
    rename_below(at, "");
    mirror(&at);
  }
}

}  // namespace poise::parts
