#include "model/toml_edits.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "model/toml_text.hpp"

namespace poise {
namespace {

/// Tables below this one, and those of its lists, that have headers.
void find_headers(const TomlEdits& edits, const toml::table& table, std::vector<const toml::table*>& out) {
  for (auto&& [key, node] : table) {
    if (const toml::table* const below = node.as_table()) {
      if (edits.has_header(*below)) out.push_back(below);
      if (!below->is_inline()) find_headers(edits, *below, out);
    } else if (edits.is_header(node)) {
      for (const toml::node& one : *node.as_array()) {
        out.push_back(one.as_table());
        find_headers(edits, *one.as_table(), out);
      }
    }
  }
}

}  // namespace

std::string listed(const TomlKeys& keys, const std::string& prefix, const std::string& between) {
  std::string out;
  for (const auto& [key, value] : keys) {
    out += fmt::format("{}{}{} = {}", out.empty() ? "" : between, prefix, toml_key(key), value);
  }
  return out;
}

TomlEdits::TomlEdits(std::string_view text, const toml::table& document) : text_(text), document_(document) {
  lines_.push_back(0);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') lines_.push_back(i + 1);
  }
}

const char* TomlEdits::line_end() const { return text_.find("\r\n") != std::string_view::npos ? "\r\n" : "\n"; }

std::string_view TomlEdits::source(const toml::node& node) const {
  const std::size_t from = offset(node.source().begin);
  return text_.substr(from, offset(node.source().end) - from);
}

void TomlEdits::replace(const toml::node& node, std::string value) {
  edits_.push_back({offset(node.source().begin), offset(node.source().end), std::move(value)});
}

void TomlEdits::replace_key(const toml::key& key, const std::string& name) {
  edits_.push_back({offset(key.source().begin), offset(key.source().end), toml_key(name)});
}

void TomlEdits::replace_in_header(const toml::table& table, std::size_t parts_before, const std::string& name) {
  std::size_t at = offset(table.source().begin);
  while (text_[at] == '[') ++at;
  const auto skip = [&](std::string_view what) {
    while (at < text_.size() && what.find(text_[at]) != std::string_view::npos) ++at;
  };
  for (std::size_t part = 0;; ++part) {
    skip(" \t");
    const std::size_t begin = at;
    if (const char quote = text_[at]; quote == '"' || quote == '\'') {
      for (++at; at < text_.size() && text_[at] != quote; ++at) at += quote == '"' && text_[at] == '\\' ? 1 : 0;
      ++at;
    } else {
      at = std::min(text_.find_first_of(" \t.]", at), text_.size());
    }
    if (part == parts_before) {
      edits_.push_back({begin, at, toml_key(name)});
      return;
    }
    skip(" \t.");
  }
}

void TomlEdits::add(const toml::table* table, const std::string& header, const TomlKeys& keys) {
  const auto append = [&] {
    appendix_ += fmt::format("{0}[{1}]{0}{2}{0}", line_end(), header, listed(keys, "", line_end()));
  };
  if (table == nullptr) return append();
  if (table->is_inline() && table->empty()) {
    return insert(offset(table->source().begin) + 1, " " + listed(keys, "", ", ") + " ");
  }
  const toml::key* last_key = nullptr;
  toml::source_position end{};
  bool implied = false;  // only by the headers of tables in it
  for (auto&& [key, node] : *table) {
    if (is_header(node)) {
      implied = implied || node.source().begin == table->source().begin;
    } else if (last_key == nullptr || end < end_of(node)) {
      last_key = &key;
      end = end_of(node);
    }
  }
  if (table->is_inline()) return insert(offset(end), ", " + listed(keys, "", ", "));
  if (last_key == nullptr && table == &document_) return insert(0, listed(keys, "", line_end()) + line_end());
  if (last_key == nullptr && implied) return append();
  if (last_key == nullptr) {
    return insert(end_of_line(offset(table->source().end)), line_end() + listed(keys, "", line_end()));
  }
  const std::size_t key = offset(last_key->source().begin);
  const std::size_t first = begin_of_dotted(key);
  const std::size_t line = lines_.at(last_key->source().begin.line - 1);
  const std::string_view before = text_.substr(line, first - line);
  const std::string prefix(text_.substr(first, key - first));
  if (before.find_first_not_of(" \t") != std::string_view::npos) {  // in an inline table
    return insert(offset(end), ", " + listed(keys, prefix, ", "));
  }
  const std::string indented = std::string(before) + prefix;
  insert(end_of_line(offset(end)), line_end() + listed(keys, indented, line_end()));
}

void TomlEdits::remove_keys(const toml::table& table, const std::vector<std::string>& keys) {
  std::vector<Listed> list;
  for (auto&& [key, node] : table) {
    const bool is_gone = std::find(keys.begin(), keys.end(), key.str()) != keys.end();
    const std::size_t from = begin_of_dotted(offset(key.source().begin)), to = offset(end_of(node));
    if (table.is_inline())
      list.push_back({from, to, is_gone});
    else if (is_gone)
      remove(begin_of_line(from), begin_of_next_line(to));
  }
  remove_listed(std::move(list));
}

void TomlEdits::remove_elements(const toml::array& array, const std::vector<std::size_t>& indices) {
  std::vector<Listed> list;
  for (std::size_t k = 0; k < array.size(); ++k) {
    const toml::source_region& source = array.get(k)->source();
    const bool is_gone = std::find(indices.begin(), indices.end(), k) != indices.end();
    list.push_back({offset(source.begin), offset(source.end), is_gone});
  }
  remove_listed(std::move(list));
}

/// With the commas that divide what goes from what follows it or, at the end, from what is before it.
void TomlEdits::remove_listed(std::vector<Listed> list) {
  std::sort(list.begin(), list.end(), [](const Listed& a, const Listed& b) { return a.from < b.from; });
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (!list[k].is_gone) continue;
    const std::size_t first = k;
    while (k + 1 < list.size() && list[k + 1].is_gone) ++k;
    if (k + 1 < list.size())
      remove(list[first].from, list[k + 1].from);
    else
      remove(first > 0 ? list[first - 1].to : list[first].from, list[k].to);
  }
}

void TomlEdits::add_element(const toml::array& array, const std::string& value) {
  if (array.empty()) return insert(offset(array.source().begin) + 1, value);
  insert(offset(array.back().source().end), ", " + value);
}

bool TomlEdits::remove_table(const toml::table& table) {
  if (!has_header(table)) return false;
  for (const auto& [from, to] : blocks(table)) remove(from, to);
  return true;
}

std::string TomlEdits::block(const toml::table& table) const {
  std::string out;
  if (!has_header(table)) return out;
  for (const auto& [from, to] : blocks(table)) out += text_.substr(from, to - from);
  return out;
}

/// Where the tables stand that belong to one with a header, in the order of the text.
std::vector<std::pair<std::size_t, std::size_t>> TomlEdits::blocks(const toml::table& table) const {
  const std::vector<const toml::table*> headers = headers_below(document_);
  std::vector<const toml::table*> within = headers_below(table);
  within.push_back(&table);
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (const toml::table* const one : within) {
    const std::size_t from = begin_of_line(offset(one->source().begin));
    std::size_t next = text_.size();
    for (const toml::table* const other : headers) {
      const std::size_t begin = begin_of_line(offset(other->source().begin));
      if (begin > from) next = std::min(next, begin);
    }
    // What stands above the next header is a comment on that.
    out.emplace_back(above_comment(from), next < text_.size() ? above_comment(next) : next);
  }
  std::sort(out.begin(), out.end());
  return out;
}

void TomlEdits::insert_before(const toml::table* table, const std::string& lines) {
  if (table != nullptr) return insert(above_comment(begin_of_line(offset(table->source().begin))), lines);
  const bool ends = text_.empty() || text_.back() == '\n';
  appendix_ += (ends ? "" : line_end()) + lines;
}

/// Where the comment begins that stands directly above a line. What stands above the first table is one on the file.
std::size_t TomlEdits::above_comment(std::size_t line) const {
  std::size_t at = line;
  while (at > 0) {
    const std::size_t before = begin_of_line(at - 1);
    const std::size_t first = text_.find_first_not_of(" \t", before);
    if (first == std::string_view::npos || text_[first] != '#') return at;
    at = before;
  }
  return line;
}

std::string TomlEdits::made() {
  std::stable_sort(edits_.begin(), edits_.end(), [](const Edit& a, const Edit& b) { return a.from < b.from; });
  std::string out;
  std::size_t at = 0;
  for (const Edit& edit : edits_) {
    out.append(text_.substr(at, edit.from - at)).append(edit.text);
    at = edit.to;
  }
  return out.append(text_.substr(at)).append(appendix_);
}

std::vector<const toml::table*> TomlEdits::headers_below(const toml::table& table) const {
  std::vector<const toml::table*> out;
  find_headers(*this, table, out);
  std::sort(out.begin(), out.end(),
            [](const toml::table* a, const toml::table* b) { return a->source().begin < b->source().begin; });
  return out;
}

/// Columns count characters, in UTF-8 of one byte or more.
std::size_t TomlEdits::offset(const toml::source_position& position) const {
  std::size_t at = lines_.at(position.line - 1);
  for (toml::source_index column = 1; column < position.column; ++column) {
    do {
      ++at;
    } while (at < text_.size() && (static_cast<unsigned char>(text_[at]) & 0xC0U) == 0x80U);
  }
  return at;
}

bool TomlEdits::is_header(const toml::node& node) const {
  if (const toml::table* const table = node.as_table()) {
    return !table->is_inline() && text_.at(offset(node.source().begin)) == '[';
  }
  const toml::array* const list = node.as_array();
  return list != nullptr && !list->empty() && list->front().is_table() && !list->front().as_table()->is_inline();
}

bool TomlEdits::has_header(const toml::table& table) const {
  // One that only the headers of tables in it imply begins where the first of these does.
  const auto implies = [&](const auto& entry) { return entry.second.source().begin == table.source().begin; };
  return is_header(table) && std::none_of(table.begin(), table.end(), implies);
}

/// Of a table that dotted keys make, where the last of its values ends.
toml::source_position TomlEdits::end_of(const toml::node& node) {
  const toml::table* const table = node.as_table();
  if (table == nullptr || table->is_inline()) return node.source().end;
  toml::source_position end = node.source().end;
  for (auto&& [key, below] : *table) end = std::max(end, end_of(below));
  return end;
}

std::size_t TomlEdits::begin_of_line(std::size_t at) const {
  const std::size_t end = at == 0 ? std::string_view::npos : text_.rfind('\n', at - 1);
  return end == std::string_view::npos ? 0 : end + 1;
}

std::size_t TomlEdits::end_of_line(std::size_t at) const {
  const std::size_t end = std::min(text_.find('\n', at), text_.size());
  return end > at && text_[end - 1] == '\r' ? end - 1 : end;
}

std::size_t TomlEdits::begin_of_next_line(std::size_t at) const {
  const std::size_t end = text_.find('\n', at);
  return end == std::string_view::npos ? text_.size() : end + 1;
}

/// Where the dotted key begins of which the last part is at `key`.
std::size_t TomlEdits::begin_of_dotted(std::size_t key) const {
  const auto skip_blanks = [&](std::size_t at) {
    while (at > 0 && (text_[at - 1] == ' ' || text_[at - 1] == '\t')) --at;
    return at;
  };
  for (std::size_t at = skip_blanks(key); at > 0 && text_[at - 1] == '.'; at = skip_blanks(key)) {
    at = skip_blanks(at - 1);
    const char quote = at > 0 ? text_[at - 1] : ' ';
    if (quote == '"' || quote == '\'') {
      do {
        at = text_.rfind(quote, at - 2) + 1;
      } while (quote == '"' && at > 1 && text_[at - 2] == '\\');
      key = at - 1;
    } else {
      while (at > 0 && (std::isalnum(static_cast<unsigned char>(text_[at - 1])) != 0 || text_[at - 1] == '_' ||
                        text_[at - 1] == '-')) {
        --at;
      }
      key = at;
    }
  }
  return key;
}

}  // namespace poise
