#include "app/result/cells.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"

namespace poise::app {
namespace {

double without_rounding(double value, const Format& format) {
  return std::abs(value) < format.zero_below ? 0.0 : value;
}

std::string written(double value, const Format& format) {
  switch (format.style) {
    case Format::Style::aligned:
    case Format::Style::significant:
      return significant(value, format.digits, format.radius);
    case Format::Style::error:
      return small_number(value);
    case Format::Style::duration:
      return duration(value);
    case Format::Style::count:
      return std::isfinite(value) ? fmt::format("{}", std::llround(value)) : "-";
  }
  return "";
}

TextColumn text_column(const Column& column) {
  TextColumn out{.title = column.title, .unit = column.unit, .cells = {}, .column = &column};
  if (!column.texts.empty()) {
    out.cells = column.texts;
  } else if (column.is_words()) {
    out.cells = column.words;
  } else {
    std::vector<double> values = column.numbers;
    for (double& value : values) value = without_rounding(value, column.format);
    if (column.format.style == Format::Style::aligned) {
      double scale = column.format.scale;
      for (const double v : values) {
        if (column.format.scale == 0.0 && std::isfinite(v)) scale = std::max(scale, std::abs(v));
      }
      const double radius = column.format.radius;
      const ReadableUnit readable = readable_unit(scale, out.unit, radius);
      out.unit = readable.unit;
      out.factor = readable.factor;
      for (double& value : values) value *= readable.factor;
      out.cells = aligned(values, column.format.digits, scale * readable.factor, radius * readable.factor);
    } else {
      for (const double value : values) out.cells.push_back(written(value, column.format));
    }
  }
  return out;
}

}  // namespace

std::string TextColumn::heading() const {
  return unit.empty() ? title : fmt::format("{}{}({})", title, title.empty() ? "" : " ", unit);
}

std::vector<TextColumn> text_columns(const Table& table) {
  std::vector<TextColumn> out;
  for (const Column& column : table.columns) {
    if (column.shown) out.push_back(text_column(column));
  }
  return out;
}

std::vector<std::size_t> shown_rows(const Table& table) {
  const std::size_t count = table.size();
  std::size_t stride = 1, end = count;
  if (table.shown == Table::Shown::spread) stride = std::max<std::size_t>(1, (count + most_rows - 1) / most_rows);
  // One row more than the limit is shown rather than counted.
  if (table.shown == Table::Shown::first && count > most_rows + 1) end = most_rows;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < end; row += stride) rows.push_back(row);
  if (stride > 1 && rows.back() != count - 1) rows.push_back(count - 1);
  return rows;
}

std::string text_of(const Entry& entry) {
  std::string text;
  if (const auto* number = std::get_if<double>(&entry.value.is)) {
    const double value = without_rounding(*number, entry.format);
    const bool plain = entry.format.style == Format::Style::error || entry.format.style == Format::Style::duration;
    Format format = entry.format;
    const ReadableUnit readable =
        plain ? ReadableUnit{1.0, entry.unit} : readable_unit(std::abs(value), entry.unit, format.radius);
    format.radius *= readable.factor;
    text = written(value * readable.factor, format) + (readable.unit.empty() ? "" : " " + readable.unit);
  } else if (const auto* word = std::get_if<std::string>(&entry.value.is)) {
    text = *word;
  } else if (const auto* whole = std::get_if<std::int64_t>(&entry.value.is)) {
    text = fmt::format("{}", *whole);
  }
  return text + (entry.remark.empty() ? "" : " " + entry.remark);
}

bool is_shown(const Item& item, Verbosity reader) {
  if (item.level == Verbosity::data || item.level > reader) return false;
  if (const auto* entry = std::get_if<Entry>(&item.content)) return !entry->label.empty();
  if (const auto* list = std::get_if<Listing>(&item.content)) return !list->items.empty();
  if (const auto* table = std::get_if<Table>(&item.content)) {
    return table->size() > 0 &&
           std::any_of(table->columns.begin(), table->columns.end(), [](const Column& column) { return column.shown; });
  }
  const auto* branch = std::get_if<Branch>(&item.content);
  if (branch == nullptr) return true;
  return std::any_of(branch->parts.begin(), branch->parts.end(), [&](const Group& part) {
    return std::any_of(part.items().begin(), part.items().end(), [&](const Item& i) { return is_shown(i, reader); });
  });
}

}  // namespace poise::app
