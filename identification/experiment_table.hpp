#pragma once

// Private to the readers of experiment files.

#include <optional>
#include <string_view>
#include <vector>

#include "model/toml_reader.hpp"

namespace poise {

/// A table of an experiment file: a TomlTable that also reads flags, whole numbers and lists of words. Refers to a
/// document that must outlive it.
class ExperimentTable : public TomlTable {
 public:
  ExperimentTable(const toml::table& table, const TomlPlace& place) : TomlTable(table, place), table_(&table) {}

  bool holds_list(std::string_view key) const;
  /// true or false, `otherwise` when the key is absent.
  bool flag(std::string_view key, bool otherwise) const;
  /// A whole number from `least` to 2^53, `otherwise` when the key is absent.
  long long whole_number(std::string_view key, long long least, long long otherwise) const;
  /// A list of strings, none when the key is absent.
  std::vector<TomlText> texts(std::string_view key) const;

  /// As in TomlTable, but tables of this kind.
  std::optional<ExperimentTable> find_table(std::string_view key) const;
  std::vector<ExperimentTable> tables(std::string_view key) const;

 private:
  const toml::table* table_;
};

}  // namespace poise
