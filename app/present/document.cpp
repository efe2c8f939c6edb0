#include "app/present/document.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/draw/figure_json.hpp"
#include "app/present/json.hpp"
#include "app/present/signs.hpp"
#include "app/result/cells.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

using nlohmann::json;

// With all digits of its data a page would be half as large again.
constexpr int digits_of_data = 9;

double rounded(double value) { return std::strtod(fmt::format("{:.{}g}", value, digits_of_data).c_str(), nullptr); }

void round_all(json& data) {
  if (data.is_number_float()) data = rounded(data.get<double>());
  if (data.is_structured()) {
    for (json& one : data) round_all(one);
  }
}

/// Without the blanks that align text.
std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

json values_of(const TextColumn& column) {
  json values = json::array();
  for (const double number : column.column->numbers) {
    values.push_back(std::isfinite(number) ? json(rounded(number * column.factor)) : json(nullptr));
  }
  return values;
}

json column_of(const TextColumn& column) {
  json out = {{"title", with_true_signs(column.title)},
              {"unit", column.unit},
              {"align", column.column->is_words() ? "left" : "right"},
              {"cells", json::array()}};
  for (const std::string& cell : column.cells) out["cells"].push_back(with_true_signs(trimmed(cell)));
  if (!column.column->is_words() && !column.column->numbers.empty()) out["values"] = values_of(column);
  const std::vector<Tone>& tones = column.column->tones;
  if (std::any_of(tones.begin(), tones.end(), [](Tone tone) { return tone != Tone::plain; })) {
    for (const Tone tone : tones) out["tones"].push_back(name_of(tone));
  }
  return out;
}

json fact(const std::string& label, const std::string& text, Tone tone) {
  return {{"kind", "fact"}, {"label", label}, {"text", with_true_signs(text)}, {"tone", name_of(tone)}};
}

json items_of(const Group& group);

json item_of(const Line& line) {
  if (!line.label.empty()) return fact(line.label, line.text, line.tone);
  return {{"kind", "note"}, {"text", with_true_signs(line.text)}, {"tone", name_of(line.tone)}};
}

json item_of(const Entry& entry) { return fact(entry.label, text_of(entry), Tone::plain); }

json item_of(const Listing& list) { return {{"kind", "list"}, {"items", each(list.items, with_true_signs)}}; }

json item_of(const Table& table) {
  json out = {{"kind", "table"}, {"footnotes", table.footnotes}, {"columns", json::array()}};
  for (const TextColumn& column : text_columns(table)) {
    json one = column_of(column);
    // Remarks of which there are none.
    const bool is_blank =
        one["title"] == "" && one["unit"] == "" &&
        std::all_of(one["cells"].begin(), one["cells"].end(), [](const json& cell) { return cell == ""; });
    if (!is_blank) out["columns"].push_back(std::move(one));
  }
  return out;
}

json item_of(const Branch& branch) {
  json items = json::array();
  for (const Group& part : branch.parts) {
    for (json& item : items_of(part)) items.push_back(std::move(item));
  }
  return {{"kind", "section"}, {"items", std::move(items)}};
}

json items_of(const Group& group) {
  json out = json::array();
  for (const Item& item : group.items()) {
    const auto* table = std::get_if<Table>(&item.content);
    if (!is_shown(item, Verbosity::verbose) || (table != nullptr && table->charted)) continue;
    json one = std::visit([](const auto& content) { return item_of(content); }, item.content);
    if (one["kind"] != "fact" && one["kind"] != "note") one["title"] = item.title;
    one["level"] = item.level == Verbosity::verbose ? "verbose" : "normal";
    out.push_back(std::move(one));
  }
  return out;
}

json in_tone(const Line& line) { return {{"text", with_true_signs(line.text)}, {"tone", name_of(line.tone)}}; }

}  // namespace

json report_json(const Result& result) {
  json out = {{"verdict", in_tone(result.verdict)}, {"warnings", json::array()}, {"report", items_of(result.content)}};
  for (const Line& warning : result.warnings) out["warnings"].push_back(in_tone(warning));
  return out;
}

json page_document(const Result& result, const PageOrigin& origin, const std::vector<Figure>& figures) {
  json out = report_json(result);
  out.update({{"poise", POISE_VERSION},
              {"command", origin.command},
              {"line", origin.line},
              {"title", one_line(result.title)},
              {"source", one_line(result.source)},
              {"palette", json::parse(palette_json())},
              {"figures", json::array()},
              {"result", result_json(result)}});
  round_all(out["result"]);
  // Whose texts may be no UTF-8.
  for (const Figure& figure : figures) {
    const bool is_empty = figure.drawing.frames.empty() && figure.charts.panels.empty();
    if (!is_empty) out["figures"].push_back(json::parse(one_line(figure_json(figure))));
  }
  return out;
}

}  // namespace poise::app
