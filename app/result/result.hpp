#pragma once

// The result of a command: named values with units, tables and notes, in the units that a person asked for. Commands
// fill it once; presenters (app/present/) turn it into text, JSON, CSV and Markdown.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/result/each.hpp"
#include "app/result/tone.hpp"

namespace poise::app {

/// Which text shows an item. Data shows it nowhere: it is in JSON and CSV only.
enum class Verbosity { quiet, normal, verbose, data };

/// A value of the data. A double that is not finite is null.
class Value {
 public:
  Value(std::nullptr_t = nullptr) {}
  Value(bool value) : is(value) {}
  Value(double value) : is(value) {}
  Value(const char* text) : is(std::string(text)) {}
  Value(std::string text) : is(std::move(text)) {}
  Value(std::vector<double> values) : is(std::move(values)) {}
  Value(std::vector<std::int64_t> counts) : is(std::move(counts)) {}
  Value(std::vector<std::string> texts) : is(std::move(texts)) {}
  template <std::signed_integral T>
  Value(T value) : is(std::int64_t{value}) {}
  template <std::unsigned_integral T>
  Value(T value) : is(std::uint64_t{value}) {}
  template <class T>
  Value(const std::optional<T>& value) {
    if (value) *this = Value(*value);
  }

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, std::vector<double>,
               std::vector<std::int64_t>, std::vector<std::string>>
      is = nullptr;
};

/// How the numbers of a column, or a number alone, are written as text.
struct Format {
  enum class Style {
    aligned,      ///< decimals shared by the column: so many that a number of the size `scale` has `digits` digits
    significant,  ///< each with `digits` significant digits
    error,        ///< two digits, "<1e-16" below that: errors and residuals
    duration,     ///< from microseconds: "12.3 ms"
    count         ///< a whole number
  };
  Style style = Style::aligned;
  int digits = 6;
  double scale = 0.0;       ///< of aligned numbers; 0: the largest of the column
  double zero_below = 0.0;  ///< smaller ones are rounding and are written as 0
  double radius = 0.0;      ///< to which they are known, in their unit: no digits beyond are written; infinite: as if 0
};

/// A column of a table: data under `key`, text under `title`.
struct Column {
  enum class Kind { number, count, flag, word, word_or_null };

  std::string key{};    ///< JSON member, name in CSV; empty: text only. "force[]" in several columns: one JSON array
  std::string title{};  ///< in text
  std::string unit{};   ///< of the numbers, as text shows it behind the title; empty: none
  Kind kind = Kind::number;
  std::vector<double> numbers{};     ///< of number, count, flag (0 or 1); not a number: null, "-"
  std::vector<std::string> words{};  ///< of word, word_or_null (empty: null)
  Format format{};
  std::vector<std::string> texts{};  ///< where not empty: what text shows in place of the numbers
  std::vector<Tone> tones{};         ///< of the cells as text; empty: all plain
  bool shown = true;                 ///< in text

  bool is_words() const { return kind == Kind::word || kind == Kind::word_or_null; }
  std::size_t size() const { return is_words() ? words.size() : !numbers.empty() ? numbers.size() : texts.size(); }
};

/// The shape of a table in JSON.
enum class Rows {
  list,     ///< [{key: value, ...}, ...]
  by_name,  ///< {first column: {key: value, ...}, ...}
  values,   ///< {first column: value, ...}: one column, or "[]" columns for a value that is an array
  columns   ///< {key: [values], ...}
};

/// Rows under titles. All columns are of the same length.
struct Table {
  enum class Shown { first, spread, all };  ///< of a long table, as text: its first rows, rows spread evenly, all

  Rows rows = Rows::list;
  Shown shown = Shown::first;
  bool csv = false;                      ///< this is the table of the CSV file
  bool charted = false;                  ///< a picture made of signs, in whose place pages have a chart
  std::deque<Column> columns{};          ///< a deque, in which a column keeps its place while others are added
  std::vector<std::string> footnotes{};  ///< below it, as text

  /// Text in each row. The references returned are valid as long as the table.
  Column& words(std::string key, std::string title, std::vector<std::string> cells);
  /// A text that is not in the data: a remark beside the row.
  Column& remarks(std::vector<std::string> cells, Tone tone = Tone::plain);
  Column& numbers(std::string key, std::string title, std::string unit, std::vector<double> values, Format format = {});
  Column& counts(std::string key, std::string title, std::vector<double> values);
  Column& flags(std::string key, std::vector<double> values);  ///< data only
  /// Numbers that text does not show.
  Column& data(std::string key, std::vector<double> values);

  std::size_t size() const { return columns.empty() ? 0 : columns.front().size(); }
};

class Group;

/// A line of text, "  label   text", or, without a label, a paragraph of its own.
struct Line {
  std::string label{}, text;
  Tone tone = Tone::plain;
};

inline Line good(std::string text) { return {"", std::move(text), Tone::good}; }
inline Line doubtful(std::string text) { return {"", std::move(text), Tone::doubtful}; }
inline Line bad(std::string text) { return {"", std::move(text), Tone::bad}; }

/// A value of the data, which text shows as a line where it has a label.
struct Entry {
  Value value;
  std::string label{}, unit{};
  Format format{Format::Style::significant};
  std::string remark{};  ///< behind the value, as text
};

/// A JSON array of texts, one line each as text.
struct Listing {
  std::vector<std::string> items;
};

/// Parts: one, a JSON object; or an array of objects.
struct Branch {
  std::list<Group> parts;
  bool array = false;
};

/// An item of a group.
struct Item {
  std::string key;    ///< JSON member; empty: text only. Of an object without a key its items are members.
  std::string title;  ///< of a section of text
  Verbosity level = Verbosity::normal;
  std::variant<Line, Entry, Listing, Table, Branch> content;
};

/// Items in the order in which text shows them. References to tables and groups are valid as long as the group exists.
class Group {
 public:
  /// JSON only.
  void data(std::string key, Value value);
  /// Text only: "  label   text".
  void fact(std::string label, std::string text, Tone tone = Tone::plain, Verbosity level = Verbosity::normal);
  /// Text only: a paragraph.
  void note(std::string text, Tone tone = Tone::plain, Verbosity level = Verbosity::normal);
  /// Both: a JSON member, and "  label   value unit remark".
  void entry(std::string key, std::string label, double value, std::string unit,
             Format format = {Format::Style::significant}, std::string remark = {},
             Verbosity level = Verbosity::normal);
  /// An array of texts; as text a section, left out where it is empty.
  void list(std::string key, std::string title, std::vector<std::string> items, Verbosity level = Verbosity::normal);
  /// A table; as text a section, left out where it is empty.
  Table& table(std::string key, std::string title, Rows rows, Verbosity level = Verbosity::normal);
  /// A JSON object, or, without a key, a part of this one; as text a section where it has a title.
  Group& group(std::string key, std::string title = {}, Verbosity level = Verbosity::normal);
  /// An array of JSON objects, empty so far.
  Branch& array(std::string key, Verbosity level = Verbosity::data);

  const std::list<Item>& items() const { return items_; }

 private:
  std::list<Item> items_;
};

/// What a command found.
struct Result {
  std::string title, source{};
  Line verdict{};                ///< one sentence: what was found, and whether that is confirmed
  std::vector<Line> warnings{};  ///< sentences that a reader must not miss
  Group content{};
  bool compact = false;  ///< JSON in one line: of a scene too large for reading

  /// The table for CSV; null where there is none.
  const Table* csv() const;
};

}  // namespace poise::app
