#pragma once

// Checked access to a TOML document: every value is read with its expected type and range, and any other throws an
// InputError "file:line: item: expected ...". Private to the readers of files.

#include <array>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "model/dimension.hpp"
#include "model/planar.hpp"
#include "model/scene.hpp"
#include "model/value_range.hpp"

namespace poise {

/// One use of a file whose items are those of a part of a document, or the document itself (model/parts.hpp).
struct TomlPart {
  std::string file;      ///< its path; of the document the name that messages give it
  std::string name{};    ///< "lift.stage_2", in front of the names of its items; empty of the document
  int line = 0;          ///< of the document, where the part is named
  std::string within{};  ///< the document's name
  Units units{};         ///< of its numbers
  double scale = 1.0;    ///< numbers that are lengths alone count so many times

  /// SI value of one unit of a number.
  double unit(const Dimension& dimension) const {
    return dimension.unit(units) * (dimension == dimension::length ? scale : 1.0);
  }
};

/// The place of a value in a file, for messages.
struct TomlPlace {
  std::string_view file;           ///< outlived by what it names: the reader keeps the string
  int line = 0;                    ///< 0: it is in no file
  std::string item;                ///< "body.crank.mass", `pin "hinge".points`, "spring 2"
  const TomlPart* part = nullptr;  ///< in whose file it is; null of the document itself

  /// Throws InputError "file:line: item: message"; without the line where there is none. Of a part, names are those of
  /// its file, and the message ends with where the document names it.
  [[noreturn]] void fail(const std::string& message) const;
  /// The line in the document itself: of what is in a part, where the document names that.
  int line_in_document() const { return part != nullptr ? part->line : line; }
};

/// Calls f; an InputError from f is thrown again with the place in front.
template <class F>
auto located(const TomlPlace& place, F f) {
  try {
    return f();
  } catch (const InputError& error) {
    place.fail(error.what());
  }
}

/// A string and its place.
struct TomlText {
  std::string value;
  TomlPlace place;
  const toml::node* node = nullptr;  ///< of the document
};

/// Index of the text among the allowed words; fails with the nearest.
std::size_t choose(const TomlText& text, const std::vector<std::string>& words);

struct TomlItem;

/// Gives strings that stand where numbers are expected their values.
class ExpressionReader {
 public:
  virtual ~ExpressionReader() = default;
  /// The value in the unit of the place; fails where it has none. The node belongs to the document.
  virtual double value(const toml::value<std::string>& node, const TomlPlace& place) = 0;
  /// The names that expressions may use, and their values.
  virtual const std::vector<std::string>& names() const = 0;
  virtual const std::vector<double>& values() const = 0;
};

/// The files of which a document is put together, told apart by the paths that its nodes have as their sources. Of a
/// file that is used twice, each use has a path of its own.
class TomlParts {
 public:
  struct Use {
    const TomlPart* part;
    int order;  ///< of the uses: 0 is the document itself
  };
  /// Outlived by what is added, in the order of the document.
  void add(const toml::source_path_ptr& path, const TomlPart& part);
  Use of(const toml::source_region& source) const;

 private:
  std::unordered_map<const std::string*, Use> uses_;
};

/// A table read key by key. Refers to a document that must outlive it.
class TomlTable {
 public:
  /// `expressions`: by which strings stand for numbers; none where they do not. `parts`: the files of the document;
  /// none where it is one file whose numbers are read with units that are given. Both outlive this.
  TomlTable(const toml::table& table, TomlPlace place, ExpressionReader* expressions = nullptr,
            const TomlParts* parts = nullptr);

  const TomlPlace& place() const { return place_; }
  /// SI value of one unit of a number in it, where there are parts.
  double unit(const Dimension& of) const;
  /// The reader gives strings that stand for numbers their values; null where they do not stand for any.
  const ExpressionReader* expressions() const { return expressions_; }
  /// Orders tables as the document does: file, line, then column of the first key.
  std::array<int, 3> position() const;
  bool has(std::string_view key) const { return table_->contains(key); }
  bool holds_table(std::string_view key) const;
  bool holds_list(std::string_view key) const;
  bool holds_text(std::string_view key) const;
  /// The place of one key of the table, present or not.
  TomlPlace place_of(std::string_view key) const;
  /// The keys in the order of the file.
  std::vector<std::string> keys() const;
  /// Fails on the first key that is not in `valid`, with the nearest valid one.
  void allow_keys(std::span<const std::string_view> valid) const;
  void allow_keys(std::initializer_list<std::string_view> valid) const { allow_keys(std::span(valid)); }

  /// The number under `key` times `unit`, the SI value of its unit. Fails unless it is an integer, a float or, where
  /// strings stand for numbers, an expression within `range`, also after conversion. The second is empty if the key is
  /// absent.
  double number(std::string_view key, double unit, Range range) const;
  std::optional<double> find_number(std::string_view key, double unit, Range range) const;

  /// true or false, `otherwise` when the key is absent.
  bool flag(std::string_view key, bool otherwise) const;
  /// A whole number from `least` to 2^53, `otherwise` when the key is absent.
  long long whole_number(std::string_view key, long long least, long long otherwise) const;

  /// [x, y], each times `unit`.
  Vec2 vector(std::string_view key, double unit) const;
  std::optional<Vec2> find_vector(std::string_view key, double unit) const;

  /// A list of finite numbers as they are written, none when the key is absent.
  std::vector<double> numbers(std::string_view key) const;

  /// A list of pairs [[A, B], ...], each with its place, A and B times their units.
  struct Pair {
    Vec2 value;
    TomlPlace place;
  };
  std::vector<Pair> pairs(std::string_view key, double unit_a, double unit_b) const;

  TomlText text(std::string_view key) const;
  std::optional<TomlText> find_text(std::string_view key) const;
  /// A list of exactly two strings.
  std::array<TomlText, 2> two_texts(std::string_view key) const;
  /// A list of strings, none when the key is absent.
  std::vector<TomlText> texts(std::string_view key) const;

  std::optional<TomlTable> find_table(std::string_view key) const;
  /// A list of strings, tables and vectors, none when the key is absent.
  std::vector<TomlItem> items(std::string_view key) const;
  /// The tables of [[key]], none when the key is absent; the item of each is `key "NAME"` if it has a name, otherwise
  /// "key 2" by its position in the list, after the item of this table.
  std::vector<TomlTable> tables(std::string_view key) const;

 private:
  friend struct TomlItem;

  const toml::node* find(std::string_view key) const { return table_->get(key); }
  /// The node under `key`; fails when it is absent, showing how it is written.
  const toml::node& require(std::string_view key, const std::string& how) const;
  TomlPlace place_of(const toml::node& node, std::string_view key) const;

  /// The place at a source, if it has one: nodes that no file has are where their table is.
  TomlPlace at(TomlPlace place, const toml::source_region& source) const;
  std::array<int, 3> order(const toml::source_region& source) const;

  double read_number(const toml::node& node, const TomlPlace& place, double unit, Range range) const;

  const toml::table* table_;
  TomlPlace place_;
  ExpressionReader* expressions_;
  const TomlParts* parts_;
};

/// One item of a list of the table `of`, which outlives it: a string, a table or something else.
struct TomlItem {
  std::optional<TomlText> text;
  std::optional<TomlTable> table;
  const toml::node* node;
  const TomlTable* of;
  TomlPlace where;

  const TomlPlace& place() const { return where; }
  /// [x, y] as they are written; fails on anything else.
  Vec2 vector() const;
};

/// Parses a TOML text; throws InputError with file:line of a syntax error.
toml::table parse_toml(std::string_view text, const std::string& file);
/// The same of the file of a part, which is the path of all sources.
toml::table parse_toml(std::string_view text, const TomlPart& part);

}  // namespace poise
