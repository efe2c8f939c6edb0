#pragma once

// Changes of a TOML text in which comments and layout stay. Private to the writers of model/.

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/scene_text.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// "a = 1, b = 2" or, with another text between them, lines; `prefix` stands before each key.
std::string listed(const TomlKeys& keys, const std::string& prefix, const std::string& between);

/// Gathers changes of a text by the nodes of its document, and makes them all at once. Changes must not overlap.
class TomlEdits {
 public:
  /// `document` was parsed from `text`, which has no byte order mark; both outlive this.
  TomlEdits(std::string_view text, const toml::table& document);

  void replace(const toml::node& node, std::string value);
  void replace_key(const toml::key& key, const std::string& name);
  /// Behind the last value of the table where it has one: comments in front of values stay in front of them. A table
  /// that the text does not have (null) is added at the end of the text as [header].
  void add(const toml::table* table, const std::string& header, const TomlKeys& keys);
  /// Other names in the header of a table, whose path has so many parts before: [body.NAME.section] has one before
  /// NAME.
  void replace_in_header(const toml::table& table, std::size_t parts_before, const std::string& name);
  /// Keys of a table with their values: their lines, or their parts of an inline table.
  void remove_keys(const toml::table& table, const std::vector<std::string>& keys);
  /// Values of an array that is written within brackets.
  void remove_elements(const toml::array& array, const std::vector<std::size_t>& indices);
  /// A table under a header of its own with all tables that belong to it, and the comment that stands directly above;
  /// false where it has no such header.
  bool remove_table(const toml::table& table);
  /// The text that remove_table() takes away; empty of a table without a header of its own.
  std::string block(const toml::table& table) const;
  /// A value behind the last of an array that is written within brackets.
  void add_element(const toml::array& array, const std::string& value);
  /// Lines in front of the line where a table begins, above its comment; null: at the end of the text.
  void insert_before(const toml::table* table, const std::string& lines);

  /// The text with all changes.
  std::string made();

  /// All tables below this one that are written under headers, in the order of the text.
  std::vector<const toml::table*> headers_below(const toml::table& table) const;
  /// Whether a table has a header of its own, and is not only implied by those of tables in it.
  bool has_header(const toml::table& table) const;
  /// Whether a node is a table, or a list of tables, that is written under headers.
  bool is_header(const toml::node& node) const;
  bool is_empty() const { return text_.empty(); }
  std::string_view text() const { return text_; }
  /// A value as it is written, of tables and lists those within braces and brackets alone.
  std::string_view source(const toml::node& node) const;
  /// The end of line of the text: "\n" or "\r\n".
  const char* line_end() const;

 private:
  struct Edit {
    std::size_t from, to;
    std::string text;
  };

  std::size_t offset(const toml::source_position& position) const;
  std::size_t begin_of_line(std::size_t at) const;
  std::size_t end_of_line(std::size_t at) const;
  std::size_t begin_of_next_line(std::size_t at) const;
  std::size_t begin_of_dotted(std::size_t key) const;
  std::size_t above_comment(std::size_t line) const;
  std::vector<std::pair<std::size_t, std::size_t>> blocks(const toml::table& table) const;
  static toml::source_position end_of(const toml::node& node);
  void insert(std::size_t at, std::string text) { edits_.push_back({at, at, std::move(text)}); }
  void remove(std::size_t from, std::size_t to) { edits_.push_back({from, to, ""}); }
  /// A part of a list with commas.
  struct Listed {
    std::size_t from, to;
    bool is_gone;
  };
  void remove_listed(std::vector<Listed> list);

  std::string_view text_;
  const toml::table& document_;
  std::vector<std::size_t> lines_;  // offsets of their first characters
  std::vector<Edit> edits_;
  std::string appendix_;
};

}  // namespace poise
