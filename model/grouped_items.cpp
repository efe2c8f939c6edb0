#include "model/grouped_items.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "model/toml_text.hpp"

namespace poise {
namespace {

bool is_in_front(const toml::node& a, const toml::node& b) { return a.source().begin < b.source().begin; }

/// Keys of a table with their values as they are written, in the order of the text.
TomlKeys keys_as_written(const toml::table& table, const TomlEdits& text) {
  std::vector<std::pair<std::string, const toml::node*>> entries;
  for (auto&& [key, node] : table) entries.emplace_back(key.str(), &node);
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return is_in_front(*a.second, *b.second); });
  TomlKeys out;
  for (const auto& [key, node] : entries) out.emplace_back(key, text.source(*node));
  return out;
}

/// Calls with each word in the strings below a node that may be expressions.
template <class Visit>
void each_word(const toml::node& node, const std::set<const toml::node*>& names, Visit visit) {
  if (const toml::table* const table = node.as_table()) {
    for (auto&& [key, below] : *table) {
      if (key.str() != "name") each_word(below, names, visit);
    }
  } else if (const toml::array* const list = node.as_array()) {
    for (const toml::node& one : *list) each_word(one, names, visit);
  } else if (const auto* const text = node.as_string(); text != nullptr && !names.contains(&node)) {
    std::string word;
    for (const char c : text->get() + " ") {
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
        word += c;
      } else if (!word.empty()) {
        visit(word);
        word.clear();
      }
    }
  }
}

}  // namespace

std::string written_table(const toml::table& table, const std::string& header, const TomlEdits& text) {
  const char* const end = text.line_end();
  std::string out = text.block(table);
  if (out.empty() && table.is_inline()) out = header + end + listed(keys_as_written(table, text), "", end);
  if (out.empty()) {
    for (const toml::table* const below : text.headers_below(table)) out += text.block(*below);
  }
  if (out.empty()) throw InputError(header + ": expected a table of its own lines; change the text");
  out.erase(out.find_last_not_of(" \t\r\n") + 1);
  return out + end;
}

std::string text_of_part(const GroupedItems& items, const toml::table& document, const std::string& ground,
                         const TomlEdits& text, TomlKeys& numbers) {
  const char* const end = text.line_end();
  static const toml::table none;
  const auto table_called = [&](const toml::table& in, std::string_view key) -> const toml::table& {
    const toml::table* const table = in.get_as<toml::table>(key);
    return table != nullptr ? *table : none;
  };
  std::vector<std::string> blocks;
  const auto add = [&](const std::string& header, const TomlKeys& keys) {
    if (!keys.empty()) blocks.push_back(header + end + listed(keys, "", end) + end);
  };
  const toml::table& known = table_called(document, "numbers");
  std::set<std::string> needed;
  std::vector<const toml::node*> to_read;
  const auto look_at = [&](const toml::node& node) { to_read.push_back(&node); };
  TomlKeys points, guesses, places;
  const toml::table& all_points = table_called(table_called(document, ground), "points");
  for (const std::string& point : items.ground_points) {
    const toml::node* const at = all_points.get(point);
    if (at == nullptr) {
      throw InputError(fmt::format("{}.{}: expected a point that the scene's text has", ground, point));
    }
    points.emplace_back(point, text.source(*at));
    look_at(*at);
  }
  const auto take_guesses = [&](const toml::table& from, TomlKeys& to) {
    for (auto&& [key, node] : from) {
      if (!items.guessed.contains(std::string(key.str())) || node.is_table()) continue;
      to.emplace_back(key.str(), text.source(node));
      look_at(node);
    }
  };
  const toml::table& start = table_called(document, "start");
  take_guesses(start, guesses);
  take_guesses(table_called(start, "position"), places);
  if (const toml::node* const gravity = document.get("gravity")) {
    blocks.push_back("gravity = " + std::string(text.source(*gravity)) + end);
    look_at(*gravity);
  }
  for (const auto& [header, table] : items.tables) look_at(*table);
  while (!to_read.empty()) {
    const toml::node& node = *to_read.back();
    to_read.pop_back();
    each_word(node, items.names, [&](const std::string& word) {
      if (known.contains(word) && needed.insert(word).second) look_at(*known.get(word));
    });
  }
  add("[units]", keys_as_written(table_called(document, "units"), text));
  TomlKeys values = keys_as_written(known, text);
  std::erase_if(values, [&](const auto& one) { return !needed.contains(one.first); });
  for (const auto& [key, value] : values) numbers.emplace_back(key, toml_string(key));
  add("[numbers]", values);
  if (!points.empty()) add("[ground]", {{"points", "{ " + listed(points, "", ", ") + " }"}});
  std::vector<std::pair<std::string, const toml::table*>> tables = items.tables;
  std::stable_sort(tables.begin(), tables.end(),
                   [](const auto& a, const auto& b) { return is_in_front(*a.second, *b.second); });
  for (const auto& [header, table] : tables) blocks.push_back(written_table(*table, header, text));
  add("[start]", guesses);
  add("[start.position]", places);
  std::string out;
  for (const std::string& block : blocks) out += (out.empty() ? "" : end) + block;
  return out;
}

}  // namespace poise
