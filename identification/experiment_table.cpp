#include "identification/experiment_table.hpp"

#include <cmath>
#include <string>

namespace poise {

bool ExperimentTable::holds_list(std::string_view key) const {
  const toml::node* const node = table_->get(key);
  return node != nullptr && node->is_array();
}

bool ExperimentTable::flag(std::string_view key, bool otherwise) const {
  const toml::node* const node = table_->get(key);
  if (node == nullptr) return otherwise;
  if (!node->is_boolean()) place_of(key).fail("expected true or false, without quotes");
  return node->as_boolean()->get();
}

long long ExperimentTable::whole_number(std::string_view key, long long least, long long otherwise) const {
  constexpr double most = 9007199254740992.0;  // up to which a double holds every whole number
  const std::optional<double> number = find_number(key, 1.0, Range::finite);
  if (!number) return otherwise;
  if (*number != std::floor(*number) || *number < static_cast<double>(least) || *number > most) {
    place_of(key).fail("expected a whole number from " + std::to_string(least) + " to 2^53");
  }
  return static_cast<long long>(*number);
}

std::vector<TomlText> ExperimentTable::texts(std::string_view key) const {
  std::vector<TomlText> result;
  const toml::node* const node = table_->get(key);
  if (node == nullptr) return result;
  const std::string expected = "expected a list of strings [\"...\", ...]";
  if (!node->is_array()) place_of(key).fail(expected);
  for (const toml::node& element : *node->as_array()) {
    TomlPlace place = place_of(key);
    place.line = static_cast<int>(element.source().begin.line);
    if (!element.is_string()) place.fail(expected);
    result.push_back({element.as_string()->get(), std::move(place)});
  }
  return result;
}

std::optional<ExperimentTable> ExperimentTable::find_table(std::string_view key) const {
  const std::optional<TomlTable> table = TomlTable::find_table(key);
  if (!table) return std::nullopt;
  return ExperimentTable(*table_->get_as<toml::table>(key), table->place());
}

std::vector<ExperimentTable> ExperimentTable::tables(std::string_view key) const {
  const std::vector<TomlTable> checked = TomlTable::tables(key);
  std::vector<ExperimentTable> result;
  for (std::size_t i = 0; i < checked.size(); ++i) {
    result.emplace_back(*table_->get_as<toml::array>(key)->get_as<toml::table>(i), checked[i].place());
  }
  return result;
}

}  // namespace poise
