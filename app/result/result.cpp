#include "app/result/result.hpp"

#include <utility>

namespace poise::app {
namespace {

const Table* csv_of(const Group& group) {
  for (const Item& item : group.items()) {
    const auto* table = std::get_if<Table>(&item.content);
    if (table != nullptr && table->csv) return table;
    const auto* branch = std::get_if<Branch>(&item.content);
    if (branch == nullptr) continue;
    for (const Group& part : branch->parts) {
      if (const Table* found = csv_of(part)) return found;
    }
  }
  return nullptr;
}

}  // namespace

std::string_view name_of(Tone tone) {
  switch (tone) {
    case Tone::plain:
      return "plain";
    case Tone::strong:
      return "strong";
    case Tone::good:
      return "good";
    case Tone::bad:
      return "bad";
    case Tone::doubtful:
      return "doubtful";
    case Tone::faint:
      return "faint";
  }
  return "plain";
}

Column& Table::words(std::string key, std::string title, std::vector<std::string> cells) {
  return columns.emplace_back(
      Column{.key = std::move(key), .title = std::move(title), .kind = Column::Kind::word, .words = std::move(cells)});
}

Column& Table::remarks(std::vector<std::string> cells, Tone tone) {
  Column& column = words("", "", std::move(cells));
  // Where nothing is remarked, nothing is to be seen.
  column.tones = each(column.words, [tone](const std::string& text) { return text.empty() ? Tone::plain : tone; });
  return column;
}

Column& Table::numbers(std::string key, std::string title, std::string unit, std::vector<double> values,
                       Format format) {
  return columns.emplace_back(Column{.key = std::move(key),
                                     .title = std::move(title),
                                     .unit = std::move(unit),
                                     .numbers = std::move(values),
                                     .format = format});
}

Column& Table::counts(std::string key, std::string title, std::vector<double> values) {
  Column& column = numbers(std::move(key), std::move(title), "", std::move(values), {Format::Style::count});
  column.kind = Column::Kind::count;
  return column;
}

Column& Table::flags(std::string key, std::vector<double> values) {
  Column& column = data(std::move(key), std::move(values));
  column.kind = Column::Kind::flag;
  return column;
}

Column& Table::data(std::string key, std::vector<double> values) {
  Column& column = numbers(std::move(key), "", "", std::move(values));
  column.shown = false;
  return column;
}

void Group::data(std::string key, Value value) {
  items_.push_back({std::move(key), "", Verbosity::data, Entry{.value = std::move(value)}});
}

void Group::fact(std::string label, std::string text, Tone tone, Verbosity level) {
  items_.push_back({"", "", level, Line{std::move(label), std::move(text), tone}});
}

void Group::note(std::string text, Tone tone, Verbosity level) { fact("", std::move(text), tone, level); }

void Group::entry(std::string key, std::string label, double value, std::string unit, Format format, std::string remark,
                  Verbosity level) {
  items_.push_back(
      {std::move(key), "", level, Entry{value, std::move(label), std::move(unit), format, std::move(remark)}});
}

void Group::list(std::string key, std::string title, std::vector<std::string> items, Verbosity level) {
  items_.push_back({std::move(key), std::move(title), level, Listing{std::move(items)}});
}

Table& Group::table(std::string key, std::string title, Rows rows, Verbosity level) {
  items_.push_back({std::move(key), std::move(title), level, Table{.rows = rows}});
  return std::get<Table>(items_.back().content);
}

Group& Group::group(std::string key, std::string title, Verbosity level) {
  items_.push_back({std::move(key), std::move(title), level, Branch{}});
  return std::get<Branch>(items_.back().content).parts.emplace_back();
}

Branch& Group::array(std::string key, Verbosity level) {
  items_.push_back({std::move(key), "", level, Branch{.parts = {}, .array = true}});
  return std::get<Branch>(items_.back().content);
}

const Table* Result::csv() const { return csv_of(content); }

}  // namespace poise::app
