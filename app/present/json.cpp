#include "app/present/json.hpp"

#include <cmath>
#include <type_traits>

#include <nlohmann/json.hpp>

namespace poise::app {
namespace {

using nlohmann::json;

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json in_json(const Value& value) {
  return std::visit(
      [](const auto& is) -> json {
        using Type = std::decay_t<decltype(is)>;
        if constexpr (std::is_same_v<Type, double>) {
          return number(is);
        } else if constexpr (std::is_same_v<Type, std::vector<double>>) {
          json out = json::array();
          for (const double v : is) out.push_back(number(v));
          return out;
        } else {
          return is;
        }
      },
      value.is);
}

json cell(const Column& column, std::size_t row) {
  switch (column.kind) {
    case Column::Kind::number:
      return number(column.numbers[row]);
    case Column::Kind::count:
      return std::isfinite(column.numbers[row]) ? json(std::llround(column.numbers[row])) : json(nullptr);
    case Column::Kind::flag:
      return std::isfinite(column.numbers[row]) ? json(column.numbers[row] != 0.0) : json(nullptr);
    case Column::Kind::word:
      return column.words[row];
    case Column::Kind::word_or_null:
      return column.words[row].empty() ? json(nullptr) : json(column.words[row]);
  }
  return nullptr;
}

/// Puts a cell in its place: the member of its key; of a key "name[]" the next element of that array, and of "[]" of
/// the value itself.
void put(json& into, const std::string& key, json value) {
  if (!key.ends_with("[]")) {
    into[key] = std::move(value);
  } else {
    const std::string name = key.substr(0, key.size() - 2);
    (name.empty() ? into : into[name]).push_back(std::move(value));
  }
}

json row_of(const Table& table, std::size_t row, std::size_t first_column) {
  const bool is_array = first_column < table.columns.size() && table.columns[first_column].key == "[]";
  json out = table.rows == Rows::values || is_array ? json(nullptr) : json::object();
  for (std::size_t c = first_column; c < table.columns.size(); ++c) {
    const Column& column = table.columns[c];
    if (column.key.empty()) continue;
    if (table.rows == Rows::values && column.key != "[]") return cell(column, row);
    put(out, column.key, cell(column, row));
  }
  return out;
}

json in_json(const Table& table) {
  json out = table.rows == Rows::list ? json::array() : json::object();
  if (table.rows == Rows::columns) {
    for (const Column& column : table.columns) {
      if (column.key.empty()) continue;
      json values = json::array();
      for (std::size_t row = 0; row < table.size(); ++row) values.push_back(cell(column, row));
      out[column.key] = std::move(values);
    }
    return out;
  }
  for (std::size_t row = 0; row < table.size(); ++row) {
    if (table.rows == Rows::list)
      out.push_back(row_of(table, row, 0));
    else
      out[table.columns.front().words[row]] = row_of(table, row, 1);
  }
  return out;
}

void add(json& into, const Group& group);

json in_json(const Branch& branch) {
  json out = branch.array ? json::array() : json::object();
  for (const Group& part : branch.parts) {
    json object = json::object();
    add(object, part);
    if (branch.array)
      out.push_back(std::move(object));
    else
      out = std::move(object);
  }
  return out;
}

json in_json(const Entry& entry) { return in_json(entry.value); }
json in_json(const Listing& list) { return list.items; }
json in_json(const Line&) { return nullptr; }

void add(json& into, const Group& group) {
  for (const Item& item : group.items()) {
    if (!item.key.empty()) {
      into[item.key] = std::visit([](const auto& content) { return in_json(content); }, item.content);
    } else if (const auto* branch = std::get_if<Branch>(&item.content)) {
      for (const Group& part : branch->parts) add(into, part);
    }
  }
}

}  // namespace

json result_json(const Result& result) {
  json out = {{"poise", POISE_VERSION}, {"verdict", result.verdict.text}, {"warnings", json::array()}};
  for (const Line& warning : result.warnings) out["warnings"].push_back(warning.text);
  add(out, result.content);
  return out;
}

std::string json_text(const Result& result) {
  return result_json(result).dump(result.compact ? -1 : 2, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace poise::app
