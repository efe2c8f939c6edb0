#include "model/toml_reader.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "model/nearest_name.hpp"
#include "model/toml_depth.hpp"

namespace poise {
namespace {

int line_of(const toml::source_region& region) { return static_cast<int>(region.begin.line); }

/// Of a table that no file has, that of its name.
const toml::source_region& source_of(const toml::table& table) {
  const auto name = table.source().begin ? table.end() : table.find("name");
  return name == table.end() ? table.source() : name->first.source();
}

/// The text with the names of a part as its file has them, without the part's name in front.
std::string named_in_part(std::string text, const std::string& part) {
  const std::string prefix = part + ".";
  const auto is_of_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;) {
    const bool is_file = text.compare(at + prefix.size(), 4, "toml") == 0;
    if (is_file || (at > 0 && is_of_name(text[at - 1])))
      ++at;
    else
      text.erase(at, prefix.size());
  }
  return text;
}

std::string found(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return ", found a table";
    case toml::node_type::array:
      return ", found a list";
    case toml::node_type::string:
      return ", found a string";
    case toml::node_type::boolean:
      return ", found a boolean";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return ", found a number";
    default:
      return ", found a date or time";
  }
}

TomlText read_text(const toml::node& node, TomlPlace place) {
  const auto* const text = node.as_string();
  if (text == nullptr) place.fail("expected a string" + found(node));
  return {text->get(), std::move(place), &node};
}

}  // namespace

void TomlPlace::fail(const std::string& message) const {
  std::string text(file);
  if (line > 0) text += ":" + std::to_string(line);
  if (!text.empty()) text += ": ";
  const std::string said = (item.empty() ? "" : item + ": ") + message;
  if (part == nullptr) throw InputError(text + said);
  throw InputError(text + named_in_part(said, part->name) + " (part \"" + part->name + "\" of " + part->within +
                   (part->line > 0 ? ":" + std::to_string(part->line) : "") + ")");
}

std::size_t choose(const TomlText& text, const std::vector<std::string>& words) {
  std::string shown;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == text.value) return i;
    shown += (i == 0 ? "" : ", ") + words[i];
  }
  text.place.fail("expected one of " + shown + ", found \"" + text.value + "\"" + did_you_mean(text.value, words));
}

void TomlParts::add(const toml::source_path_ptr& path, const TomlPart& part) {
  uses_.emplace(path.get(), Use{&part, static_cast<int>(uses_.size())});
}

TomlParts::Use TomlParts::of(const toml::source_region& source) const {
  const auto found = uses_.find(source.path.get());
  return found != uses_.end() ? found->second : uses_.at(nullptr);
}

TomlTable::TomlTable(const toml::table& table, TomlPlace place, ExpressionReader* expressions, const TomlParts* parts)
    : table_(&table), place_(std::move(place)), expressions_(expressions), parts_(parts) {}

double TomlTable::unit(const Dimension& of) const {
  return (place_.part != nullptr ? place_.part : parts_->of({}).part)->unit(of);
}

TomlPlace TomlTable::at(TomlPlace place, const toml::source_region& source) const {
  if (!source.begin) return place;
  place.line = line_of(source);
  if (parts_ == nullptr) return place;
  const TomlPart& part = *parts_->of(source).part;
  place.file = part.file;
  place.part = part.name.empty() ? nullptr : &part;
  return place;
}

std::array<int, 3> TomlTable::order(const toml::source_region& source) const {
  return {parts_ != nullptr ? parts_->of(source).order : 0, line_of(source), static_cast<int>(source.begin.column)};
}

double TomlTable::read_number(const toml::node& node, const TomlPlace& place, double unit, Range range) const {
  double written = 0.0;
  const auto* const text = expressions_ != nullptr ? node.as_string() : nullptr;
  if (const auto* integer = node.as_integer()) {
    written = static_cast<double>(integer->get());
  } else if (const auto* real = node.as_floating_point()) {
    written = real->get();
  } else if (text != nullptr) {
    written = expressions_->value(*text, place);
  } else {
    place.fail("expected a number" + found(node));
  }
  const double value = written * unit;
  if (!contains(range, value)) {
    place.fail(out_of_range(range, written) + (text != nullptr ? " from \"" + text->get() + "\"" : ""));
  }
  return value;
}

std::array<int, 3> TomlTable::position() const {
  int column = std::numeric_limits<int>::max();
  for (auto&& [key, node] : *table_) column = std::min(column, static_cast<int>(key.source().begin.column));
  std::array<int, 3> out = order(source_of(*table_));
  out.back() = column;
  return out;
}

bool TomlTable::holds_table(std::string_view key) const {
  const toml::node* const node = find(key);
  return node != nullptr && node->is_table();
}

bool TomlTable::holds_list(std::string_view key) const {
  const toml::node* const node = find(key);
  return node != nullptr && node->is_array();
}

bool TomlTable::holds_text(std::string_view key) const {
  const toml::node* const node = find(key);
  return node != nullptr && node->is_string();
}

TomlPlace TomlTable::place_of(std::string_view key) const {
  TomlPlace place = place_;
  place.item += (place.item.empty() ? "" : ".") + std::string(key);
  const auto entry = table_->find(key);
  return entry != table_->end() ? at(std::move(place), entry->first.source()) : place;
}

TomlPlace TomlTable::place_of(const toml::node& node, std::string_view key) const {
  // Tables implied by a dotted key have no line of their own.
  return node.is_table() ? place_of(key) : at(place_of(key), node.source());
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<const toml::key*> ordered;
  for (auto&& [key, node] : *table_) ordered.push_back(&key);
  std::sort(ordered.begin(), ordered.end(), [&](auto* a, auto* b) { return order(a->source()) < order(b->source()); });
  std::vector<std::string> result;
  for (const toml::key* key : ordered) result.emplace_back(key->str());
  return result;
}

void TomlTable::allow_keys(std::span<const std::string_view> valid) const {
  for (auto&& [key, node] : *table_) {
    if (std::find(valid.begin(), valid.end(), key.str()) != valid.end()) continue;
    std::string list;
    for (const std::string_view name : valid) list += (list.empty() ? "" : ", ") + std::string(name);
    place_of(key.str()).fail((valid.size() == 1 ? "expected only the key " : "expected one of the keys ") + list +
                             did_you_mean(key.str(), {valid.begin(), valid.end()}));
  }
}

const toml::node& TomlTable::require(std::string_view key, const std::string& how) const {
  const toml::node* const node = find(key);
  if (node == nullptr) place_.fail("expected the key " + std::string(key) + "; add " + std::string(key) + " = " + how);
  return *node;
}

double TomlTable::number(std::string_view key, double unit, Range range) const {
  require(key, "NUMBER");
  return *find_number(key, unit, range);
}

std::optional<double> TomlTable::find_number(std::string_view key, double unit, Range range) const {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  return read_number(*node, place_of(*node, key), unit, range);
}

bool TomlTable::flag(std::string_view key, bool otherwise) const {
  const toml::node* const node = find(key);
  if (node == nullptr) return otherwise;
  if (!node->is_boolean()) place_of(key).fail("expected true or false, without quotes");
  return node->as_boolean()->get();
}

long long TomlTable::whole_number(std::string_view key, long long least, long long otherwise) const {
  constexpr double most = 9007199254740992.0;  // up to which a double represents every whole number
  const std::optional<double> number = find_number(key, 1.0, Range::finite);
  if (!number) return otherwise;
  if (*number != std::floor(*number) || *number < static_cast<double>(least) || *number > most) {
    place_of(key).fail("expected a whole number from " + std::to_string(least) + " to 2^53");
  }
  return static_cast<long long>(*number);
}

Vec2 TomlTable::vector(std::string_view key, double unit) const {
  require(key, "[X, Y]");
  return *find_vector(key, unit);
}

std::optional<Vec2> TomlTable::find_vector(std::string_view key, double unit) const {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  const toml::array* const list = node->as_array();
  if (list == nullptr) place_of(*node, key).fail("expected two numbers [X, Y]" + found(*node));
  if (list->size() != 2) {
    place_of(*node, key).fail("expected two numbers [X, Y], found a list of " + std::to_string(list->size()));
  }
  const auto component = [&](std::size_t i) {
    return read_number((*list)[i], place_of((*list)[i], key), unit, Range::finite);
  };
  return Vec2{component(0), component(1)};
}

std::vector<double> TomlTable::numbers(std::string_view key) const {
  std::vector<double> result;
  const toml::node* const node = find(key);
  if (node == nullptr) return result;
  const toml::array* const list = node->as_array();
  if (list == nullptr) place_of(*node, key).fail("expected a list of numbers [A, ...]" + found(*node));
  for (const toml::node& element : *list) {
    result.push_back(read_number(element, place_of(element, key), 1.0, Range::finite));
  }
  return result;
}

std::vector<TomlTable::Pair> TomlTable::pairs(std::string_view key, double unit_a, double unit_b) const {
  const toml::node& node = require(key, "[[A, B], ...]");
  const std::string expected = "expected a list of pairs [[A, B], ...]";
  if (!node.is_array()) place_of(node, key).fail(expected + found(node));
  std::vector<Pair> result;
  for (const toml::node& element : *node.as_array()) {
    const TomlPlace place = place_of(element, key);
    const toml::array* const pair = element.as_array();
    if (pair == nullptr) place.fail(expected + found(element) + " in it");
    if (pair->size() != 2) place.fail(expected + ", found a list of " + std::to_string(pair->size()) + " in it");
    const auto number = [&](std::size_t i, double unit) {
      return read_number((*pair)[i], place_of((*pair)[i], key), unit, Range::finite);
    };
    result.push_back({{number(0, unit_a), number(1, unit_b)}, place});
  }
  return result;
}

TomlText TomlTable::text(std::string_view key) const {
  require(key, "\"...\"");
  return *find_text(key);
}

std::optional<TomlText> TomlTable::find_text(std::string_view key) const {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  return read_text(*node, place_of(*node, key));
}

std::array<TomlText, 2> TomlTable::two_texts(std::string_view key) const {
  const toml::node& node = require(key, "[\"...\", \"...\"]");
  const toml::array* const list = node.as_array();
  if (list == nullptr) place_of(node, key).fail("expected two names [\"...\", \"...\"]" + found(node));
  if (list->size() != 2) {
    place_of(node, key).fail("expected two names [\"...\", \"...\"], found a list of " + std::to_string(list->size()));
  }
  const auto name = [&](std::size_t i) { return read_text((*list)[i], place_of((*list)[i], key)); };
  return {name(0), name(1)};
}

std::vector<TomlText> TomlTable::texts(std::string_view key) const {
  std::vector<TomlText> result;
  const toml::node* const node = find(key);
  if (node == nullptr) return result;
  const std::string expected = "expected a list of strings [\"...\", ...]";
  if (!node->is_array()) place_of(key).fail(expected);
  for (const toml::node& element : *node->as_array()) {
    TomlPlace place = at(place_of(key), element.source());
    if (!element.is_string()) place.fail(expected);
    result.push_back({element.as_string()->get(), std::move(place), &element});
  }
  return result;
}

std::optional<TomlTable> TomlTable::find_table(std::string_view key) const {
  const toml::node* const node = find(key);
  if (node == nullptr) return std::nullopt;
  const toml::table* const table = node->as_table();
  if (table == nullptr) place_of(key).fail("expected a table" + found(*node));
  return TomlTable(*table, place_of(key), expressions_, parts_);
}

std::vector<TomlItem> TomlTable::items(std::string_view key) const {
  std::vector<TomlItem> result;
  const toml::node* const node = find(key);
  if (node == nullptr) return result;
  const toml::array* const list = node->as_array();
  if (list == nullptr) place_of(key).fail("expected a list" + found(*node));
  for (const toml::node& element : *list) {
    TomlPlace place = place_of(element, std::string(key) + " " + std::to_string(result.size() + 1));
    TomlItem item{{}, {}, &element, this, place};
    if (element.is_string()) item.text = TomlText{element.as_string()->get(), place, &element};
    if (const toml::table* const table = element.as_table()) item.table.emplace(*table, place, expressions_, parts_);
    result.push_back(std::move(item));
  }
  return result;
}

Vec2 TomlItem::vector() const {
  const toml::array* const list = node->as_array();
  if (list == nullptr || list->size() != 2) where.fail("expected two numbers [X, Y]" + found(*node));
  const auto component = [&](std::size_t i) { return of->read_number((*list)[i], where, 1.0, Range::finite); };
  return {component(0), component(1)};
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  std::vector<TomlTable> result;
  const toml::node* const node = find(key);
  if (node == nullptr) return result;
  const std::string expected = "expected tables [[" + std::string(key) + "]]";
  const toml::array* const list = node->as_array();
  if (list == nullptr) place_of(key).fail(expected + found(*node));
  for (const toml::node& element : *list) {
    const toml::table* const table = element.as_table();
    if (table == nullptr) place_of(element, key).fail(expected + found(element));
    TomlPlace place = at(place_, source_of(*table));
    place.item += (place.item.empty() ? "" : ".") + std::string(key) + " ";
    const auto* const name = table->get_as<std::string>("name");
    place.item += name == nullptr ? std::to_string(result.size() + 1) : "\"" + name->get() + "\"";
    result.emplace_back(*table, std::move(place), expressions_, parts_);
  }
  return result;
}

namespace {

toml::table parse_at(std::string_view text, const std::string& file, const TomlPart* part) {
  if (const auto deep = find_too_deep(text)) TomlPlace{file, deep->line, "TOML syntax", part}.fail(deep->message);
  try {
    return part != nullptr ? toml::parse(text, file) : toml::parse(text);
  } catch (const toml::parse_error& error) {
    TomlPlace{file, line_of(error.source()), "TOML syntax", part}.fail(std::string(error.description()));
  }
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& file) { return parse_at(text, file, nullptr); }

toml::table parse_toml(std::string_view text, const TomlPart& part) { return parse_at(text, part.file, &part); }

}  // namespace poise
