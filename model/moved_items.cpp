#include "model/moved_items.hpp"

#include <algorithm>
#include <initializer_list>

#include <fmt/format.h>

namespace poise {
namespace {

using moved::Amount;
using moved::list_in;
using moved::table_in;
using moved::tables_in;
using moved::text_in;

bool is_any_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

void MovedItems::name_in(toml::table& table, std::string_view key, NodeName give) {
  if (std::string* const name = text_in(table, key)) (this->*give)(*name);
}

// In the path of a number, "damper.NAME.coefficient" or "load.NAME".
void MovedItems::name_in_sets(toml::table& controller, const TomlTable& place) {
  std::string* const path = text_in(controller, "sets");
  if (path == nullptr) return;
  const bool is_load = path->starts_with("load.");
  if ((is_load || path->starts_with("drive.")) && mirrored_) {
    place.place_of("sets").fail(fmt::format(
        "expected a number of a spring or a damper where the controller is mirrored: {} changes its sign then; "
        "act on a measure",
        is_load ? "a torque" : "the angle of a drive"));
  }
  const std::size_t from = path->find('.') + 1, to = is_load ? path->size() : path->rfind('.');
  if (from == 0 || to <= from) return;
  std::string name = path->substr(from, to - from);
  name_element(name);
  path->replace(from, to - from, name);
}

void MovedItems::name_list(toml::table& table, std::string_view key, NodeName give) {
  toml::array* const list = list_in(table, key);
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    if (auto* const name = list->get_as<std::string>(i)) (this->*give)(name->get());
  }
}

void MovedItems::negate(toml::node* node) {
  if (node == nullptr) return;
  if (auto* const text = node->as_string()) *text = "-(" + text->get() + ")";
  if (auto* const whole = node->as_integer()) *whole = -whole->get();
  if (auto* const real = node->as_floating_point()) *real = -real->get();
  note_negated(*node);
}

void MovedItems::mirror(toml::node* vector, std::size_t component) {
  toml::array* const list = mirrored_ && vector != nullptr ? vector->as_array() : nullptr;
  if (list != nullptr && list->size() == 2) negate(list->get(component));
}

void MovedItems::mirror_number(toml::table& table, std::string_view key) {
  if (mirrored_) negate(table.get(key));
}

void MovedItems::mirror_curve(toml::table& table) {
  toml::array* const points = list_in(table, "curve");
  for (std::size_t i = 0; points != nullptr && i < points->size(); ++i) mirror(points->get(i));
}

void MovedItems::exchange(toml::table& table, std::string_view key) const {
  toml::array* const list = mirrored_ ? list_in(table, key) : nullptr;
  if (list == nullptr || list->size() != 2) return;
  auto *const a = list->get_as<std::string>(0), *const b = list->get_as<std::string>(1);
  if (a != nullptr && b != nullptr) std::swap(a->get(), b->get());
}

void MovedItems::mirror_turn(toml::table& table) const {
  std::string* const turn = mirrored_ ? text_in(table, "turn") : nullptr;
  if (turn == nullptr) return;
  if (*turn == "clockwise")
    *turn = "counterclockwise";
  else if (*turn == "counterclockwise")
    *turn = "clockwise";
}

void MovedItems::transform_measure(toml::table& table) {
  name_list(table, "points", &MovedItems::name_point);
  mirror(table.get("axis"));
  name_list(table, "bodies", &MovedItems::name_body);
  exchange(table, "bodies");
  name_in(table, "slide", &MovedItems::name_joint);
  for (const std::string_view key : {"x", "y"}) {
    const std::string* const point = text_in(table, key);
    if (point == nullptr || table.contains("points")) continue;
    // A place is one in the frame of what is moved.
    std::string name = *point;
    name_point(name);
    const toml::source_region source = table.find(key)->first.source();
    table.erase(key);
    table.insert_or_assign(toml::key("points", source), toml::array{origin_of_places(), name});
    const double y = mirrored_ ? -1.0 : 1.0;
    table.insert_or_assign(toml::key("axis", source), key == "x" ? toml::array{1.0, 0.0} : toml::array{0.0, y});
  }
  transform_rope(table, "rope");
  for (toml::table* const term : tables_in(table, "sum")) transform_measure(*term);
}

void MovedItems::transform_rope(toml::table& table, std::string_view key) {
  name_list(table, key, &MovedItems::name_point);
  for (toml::table* const pulley : tables_in(table, key)) {
    name_in(*pulley, "pulley", &MovedItems::name_point);
    mirror_turn(*pulley);
  }
}

// Loads that keep their direction in the world.
void MovedItems::turn_load(toml::table& table) {
  for (const std::string_view key : {"vector", "direction"}) {
    toml::array* const vector = list_in(table, key);
    mirror(vector);
    if (vector == nullptr || vector->size() != 2 || angle_.is(0.0) || table.contains("follows")) continue;
    *vector = moved::array_of(direction_.turned({Amount::component(vector, 0), Amount::component(vector, 1)}));
  }
}

void MovedItems::transform(std::string_view key, toml::table& table, const TomlTable& place) {
  if (is_any_of(key, {"force", "distributed_load"})) {
    name_in(table, "at", &MovedItems::name_point);
    name_list(table, "points", &MovedItems::name_point);
    name_in(table, "follows", &MovedItems::name_body);
    turn_load(table);
  } else if (key == "torque") {
    name_in(table, "on", &MovedItems::name_body);
    name_in(table, "at", &MovedItems::name_point);
    mirror_number(table, "value");
  } else if (key == "blade") {
    name_in(table, "at", &MovedItems::name_point);
    name_in(table, "on", &MovedItems::name_body);
    mirror_number(table, "angle");
  } else if (is_any_of(key, {"gear", "belt", "geneva"})) {
    name_list(table, "bodies", &MovedItems::name_body);
    name_in(table, "carrier", &MovedItems::name_body);
    const std::string carrier = table.contains("carrier") ? "" : carrier_of_gears();
    if (!carrier.empty()) table.insert_or_assign("carrier", carrier);
    mirror_number(table, "phase");
    if (key == "geneva") mirror_number(table, "offset");
  } else if (key == "rack") {
    name_in(table, "slide", &MovedItems::name_joint);
    name_in(table, "pinion", &MovedItems::name_body);
    name_in(table, "carrier", &MovedItems::name_body);
    mirror_number(table, "radius");
  } else if (key == "cam") {
    name_list(table, "bodies", &MovedItems::name_body);
    exchange(table, "bodies");
    if (toml::table* const follower = table_in(table, "follower")) transform_measure(*follower);
    name_in(table, "roller", &MovedItems::name_point);
  } else if (key == "rope") {
    transform_rope(table, "over");
  } else if (key == "chain") {
    name_in(table, "a", &MovedItems::name_point);
    name_in(table, "b", &MovedItems::name_point);
    if (mirrored_ && !table.contains("turn")) table.insert_or_assign("turn", "counterclockwise");
    mirror_turn(table);
  } else if (key == "contact") {
    transform_contact(table);
  } else if (is_any_of(key, {"circular_slot", "curved_slot", "rolling", "rolling_on_circle", "rolling_profile",
                             "rolling_profile_on_circle", "curve_contact"})) {
    transform_track(key, table, place);
  } else {  // joints, force elements, drives, stops and couplings of measures
    transform_measure(table);
    if (key == "controller") {
      name_in(table, "follows", &MovedItems::name_element);
      name_in_sets(table, place);
      if (toml::table* const reads = table_in(table, "reads")) {
        transform_measure(*reads);
        name_in(*reads, "controller", &MovedItems::name_element);
        name_in(*reads, "force", &MovedItems::name_element);
        name_in(*reads, "reaction", &MovedItems::name_joint);
        const std::string* const along = text_in(*reads, "along");
        if (along != nullptr && ((mirrored_ && *along == "y") || !angle_.is(0.0))) {
          place.find_table("reads")->place_of("along").fail(
              "expected what is neither turned nor mirrored: the controller reads a force along an axis of the world");
        }
      }
    }
    if (is_any_of(key, {"slide", "weld"})) mirror_number(table, "angle");
  }
}

// What was on the left of the way is on the left of it in the other direction.
void MovedItems::transform_contact(toml::table& table) {
  name_in(table, "point", &MovedItems::name_point);
  for (const std::string_view way : {"segment", "outline", "against"}) {
    name_list(table, way, &MovedItems::name_point);
    toml::array* const list = list_in(table, way);
    if (list == nullptr || !mirrored_) continue;
    toml::array turned;
    for (std::size_t i = list->size(); i-- > 0;) turned.push_back(std::move(*list->get(i)));
    *list = std::move(turned);
  }
  toml::table* const arc = table_in(table, "arc");
  if (arc == nullptr) return;
  for (const std::string_view point : {"center", "from", "to"}) name_in(*arc, point, &MovedItems::name_point);
  if (mirrored_) exchange_ends(*arc);
}

void MovedItems::transform_track(std::string_view key, toml::table& table, const TomlTable& place) {
  for (const std::string_view point : {"pin", "center", "at", "wheel", "line", "against"}) {
    name_in(table, point, &MovedItems::name_point);
  }
  if (!mirrored_) return;
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
        "expected what is not mirrored: places on a curve that rolls or touches count from its "
        "first point, and the mirrored one has another; draw it in a file of its own");
  }
}

void MovedItems::exchange_ends(toml::table& table) {
  toml::table ends;
  for (const auto& [key, other] : {std::pair("from", "to"), std::pair("to", "from")}) {
    toml::node* const node = table.get(key);
    if (node == nullptr) continue;
    take_value(*node, ends, toml::key(other, key_source(table, key)), key);
    table.erase(key);
  }
  for (auto&& [key, node] : ends) take_value(node, table, key, key.str());
}

void MovedItems::take_value(toml::node& from, toml::table& to, const toml::key& key, std::string_view) {
  to.insert_or_assign(key, std::move(from));
}

void MovedItems::transform_body(toml::table& body, const TomlTable& place) {
  transform_points(body);
  mirror(body.get("center"));
  toml::table* const section = table_in(body, "section");
  if (section == nullptr || !mirrored_ || !section->contains("left")) return;
  // What was on the left of the line is on the left of it in the other direction.
  toml::array* const line = list_in(*section, "line");
  if (line == nullptr || place.find_table("section")->flag("flexible", false)) {
    place.find_table("section")->place_of("left").fail(
        "expected what is not mirrored, or a section of a rigid body with its line; add line = [\"A\", "
        "\"B\"]");
  }
  toml::array turned;
  for (std::size_t i = line->size(); i-- > 0;) turned.push_back(std::move(*line->get(i)));
  *line = std::move(turned);
}

void MovedItems::transform_points(toml::table& owner) {
  toml::table* const points = table_in(owner, "points");
  if (points == nullptr) return;
  for (auto&& [key, at] : *points) mirror(&at);
}

toml::source_region MovedItems::key_source(const toml::table& table, std::string_view key) {
  const auto found = table.find(key);
  return found != table.end() ? found->first.source() : table.source();
}

}  // namespace poise
