#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "model/nearest_name.hpp"
#include "model/one_line.hpp"
#include "model/part_placing.hpp"
#include "model/read_elements.hpp"
#include "model/scene_names.hpp"

namespace poise::parts {

toml::table* made_table(toml::table& in, std::string_view key) {
  if (!in.contains(key)) in.insert_or_assign(key, toml::table{});
  return table_in(in, key);
}

namespace {

constexpr std::size_t most_items = 10'000;
constexpr std::size_t longest_expression = 1000;

/// The first name of "BODY.POINT".
std::string body_of_point(const std::string& point) { return point.substr(0, point.rfind('.')); }

/// Tables of the items of a scene, [[pin]] to [[rope]].
std::vector<std::string_view> item_tables() {
  std::vector<std::string_view> keys;
  for (const JointTraits& kind : Joint::kinds) keys.push_back(kind.key);
  for (const std::string_view key : element_tables()) keys.push_back(key);
  keys.insert(keys.end(), {"drive", "force", "distributed_load", "torque", "stop", "blade"});
  for (const CouplingKind& kind : coupling_kinds()) {
    if (kind.row == 0) keys.push_back(kind.table);
  }
  return keys;
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
  give({"blade"}, by_words);
  for (const CouplingKind& kind : coupling_kinds()) {
    if (kind.row > 0) continue;
    give({kind.table},
         [](std::string_view key, const std::vector<TomlTable>& tables) { return numbered(key, tables.size()); });
  }
}

}  // namespace

void Placing::run() {
  const TomlTable root(part_.document, part_.place, nullptr, &shared_.out.files_);
  const std::optional<TomlTable> bodies = root.find_table("body");
  if (!bodies || bodies->keys().empty()) root.place().fail("body: expected at least one body; add [body.NAME]");
  if (bodies->has(fixed_frame)) {
    bodies->place_of(fixed_frame).fail("expected another name, this is the fixed frame; give its points in [ground]");
  }
  give_names(part_.document, root);
  find_place();
  find_joined(root);
  scope_numbers();
  multiply_scales();
  for (const std::string_view key : item_tables()) {
    const std::vector<TomlTable> places = root.tables(key);
    const std::vector<toml::table*> tables = tables_in(part_.document, key);
    for (std::size_t i = 0; i < tables.size(); ++i) place_item(key, *tables[i], places[i]);
  }
  for (auto&& [key, node] : *table_in(part_.document, "body")) {
    if (toml::table* const body = node.as_table()) place_body(*body, *bodies->find_table(key.str()));
  }
  add_start(root);
  add_ground(root);
  merge();
}

void Placing::find_place() {
  const double unit = level_.units.angle;
  const toml::source_position begin{1, 1};
  mirrored_ = group_.mirrored;
  source_ = {begin, begin, part_.document.source().path};
  const Amount steps{k_ - 1.0};
  at_ = group_.at;
  if (group_.turn.is(0.0)) {
    at_ = {at_.x + steps * group_.step.x, at_.y + steps * group_.step.y};
  } else {
    for (int j = 0; j + 1 < k_; ++j) {
      const Place step = Direction::at(Amount{j * 1.0} * group_.turn, unit).turned(group_.step);
      at_ = {at_.x + step.x, at_.y + step.y};
    }
  }
  if (const std::size_t size = std::max(at_.x.text.size(), at_.y.text.size()); size > longest_expression) {
    group_.table->place_of("repeat").fail(
        fmt::format("expected fewer parts, or a turn that is a number: the place of part {} is an expression of {} "
                    "characters, of at most {}",
                    k_, size, longest_expression));
  }
  angle_ = group_.angle + steps * group_.turn;
  direction_ = Direction::at(angle_, unit);
}

void Placing::find_joined(const TomlTable& root) {
  std::vector<std::string> known;
  const std::optional<TomlTable> own = root.find_table(fixed_frame);
  if (const auto points = own ? own->find_table("points") : std::nullopt) known = points->keys();
  const auto join = [&](std::string_view key, const std::map<std::string, std::string>& names, const std::string& of) {
    for (const auto& [point, to] : names) {
      if (std::find(known.begin(), known.end(), point) == known.end()) {
        group_.table->place_of(key).fail("expected points of the ground of " + use_.file + ", found \"" + point + "\"" +
                                         did_you_mean_or_list(point, known));
      }
      joined_[point] = of + to;
      level_.joined.push_back({group_.table->place_of(key), of + to});
    }
  };
  join("join", group_.join, "");
  if (k_ > 1) join("join_next", group_.join_next, group_.instances[static_cast<std::size_t>(k_ - 2)] + ".");
}

std::string Placing::origin() {
  if (!origin_.empty()) return origin_;
  origin_ = "origin";
  toml::table* const own = table_in(part_.document, fixed_frame);
  const toml::table* const points = own != nullptr ? table_in(*own, "points") : nullptr;
  while (points != nullptr && points->contains(origin_)) origin_ += "_";
  return origin_;
}

void Placing::add_start(const TomlTable& root) {
  const std::optional<TomlTable> start = root.find_table("start");
  toml::table* const written = table_in(part_.document, "start");
  std::set<std::string> travels;
  for (const std::string_view key :
       {"slide", "pin_in_slot", "curved_slot", "rolling_profile", "rolling_profile_on_circle", "curve_contact"}) {
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
        guess(name, unit_of_length() * Amount::of(&value));
      } else {
        guessed.insert(key);
        guess(name, Amount{use_.units.angle / level_.units.angle} * sense * Amount::of(&value) + angle);
      }
    }
  }
  if (angle.is(0.0)) return;
  for (const std::string& line : lines_of_centres()) {
    if (std::none_of(guessed.begin(), guessed.end(), [&](const std::string& key) { return named(key) == line; }))
      guess(toml::key(line), angle);
  }
  for (const std::string& body : free_bodies(guessed)) guess(toml::key(body), angle);
}

/// The bodies that couplings add, which turn as lines between centres do.
std::vector<std::string> Placing::lines_of_centres() {
  std::vector<std::string> out;
  for (const auto& [kind, behind] :
       {std::pair("circular_slot", ""), std::pair("rolling_on_circle", ""),
        std::pair("rolling_profile_on_circle", " radius"), std::pair("curve_contact", " line")}) {
    for (toml::table* const table : tables_in(part_.document, kind)) {
      const std::string* const name = text_in(*table, "name");
      const bool has_line =
          std::string_view(kind) != "circular_slot" || table->contains("from") || table->contains("to");
      if (name != nullptr && has_line) out.push_back(*name + behind);
    }
  }
  return out;
}

Amount Placing::unit_of_length() const {
  return Amount{use_.units.length / level_.units.length} * Amount{use_.scale, use_.scale_text};
}

Amount Placing::angle_of_base() const {
  const toml::table* const start = level_.document.get_as<toml::table>("start");
  return start != nullptr && start->contains(group_.on) ? Amount::of(start->get(group_.on)) : Amount{};
}

void Placing::guess(const toml::key& key, const Amount& value) {
  toml::table* const to = made_table(level_.document, "start");
  if (to == nullptr || to->contains(key.str())) return;
  value.put([&](const auto& number) { to->insert_or_assign(key, number); });
}

void Placing::add_positions(toml::table& positions) {
  toml::table* const start = made_table(level_.document, "start");
  toml::table* const to = start != nullptr ? made_table(*start, "position") : nullptr;
  const Amount unit = unit_of_length(), sense{group_.mirrored ? -1.0 : 1.0};
  for (auto&& [key, node] : positions) {
    const toml::array* const vector = node.as_array();
    if (to == nullptr || to->contains(named(std::string(key.str())))) continue;
    const toml::key name(named(std::string(key.str())), key.source());
    if (vector == nullptr || vector->size() != 2) {
      to->insert_or_assign(name, std::move(node));
      continue;
    }
    const Place own{unit * Amount::component(vector, 0), sense * unit * Amount::component(vector, 1)};
    const Place turned = direction_.turned(own);
    to->insert_or_assign(name, moved::array_of({at_.x + turned.x, at_.y + turned.y}));
  }
}

std::vector<std::string> Placing::free_bodies(const std::set<std::string>& guessed) {
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

void Placing::add_ground(const TomlTable& root) {
  if (const auto own = root.find_table(fixed_frame)) own->allow_keys({"points"});
  origin();
  toml::table frame_body;
  if (toml::table* const own = table_in(part_.document, fixed_frame)) {
    rename_points(*own);
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
  const toml::source_region source = key_source(*group_.written, k_ > 1 ? "turn" : "angle");
  if (k_ == 1 && group_.written->contains("angle")) {
    weld.insert_or_assign(toml::key("angle", source), std::move(*group_.written->get("angle")));
  } else {
    angle_.put([&](const auto& angle) { weld.insert_or_assign(toml::key("angle", source), angle); });
  }
  append("weld", std::move(weld));
  bodies->insert_or_assign(toml::key(frame(), source_), std::move(frame_body));
}

void Placing::place_on(toml::table& bodies) {
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
  const toml::key key(name_, key_source(*group_.written, k_ > 1 ? "step" : "at"));
  if (k_ == 1 && group_.written->contains("at")) {
    places->insert_or_assign(key, std::move(*group_.written->get("at")));
  } else {
    places->insert_or_assign(key, moved::array_of(at_));
  }
}

void Placing::append(std::string_view key, toml::table&& table) {
  if (!level_.document.contains(key)) level_.document.insert_or_assign(key, toml::array{});
  if (toml::array* const list = list_in(level_.document, key)) list->push_back(std::move(table));
}

void Placing::merge() {
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
       {"title", "source", "gravity", "frame", "units", "outputs", "body", "start", "numbers"}) {
    part_.document.erase(key);
  }
  // What no scene has is refused where the document is read.
  for (auto&& [key, node] : part_.document) {
    if (!level_.document.contains(key.str())) level_.document.insert_or_assign(key, std::move(node));
  }
}

void Placing::count() const {
  if (++shared_.items <= most_items) return;
  group_.table->place().fail(
      fmt::format("expected at most {} bodies, joints and other items in all parts", most_items));
}

}  // namespace poise::parts
