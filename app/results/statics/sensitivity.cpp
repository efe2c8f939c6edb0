#include "app/results/statics/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

constexpr double ranked_part = 1e-3;  // of the size, of a radian, of a number: the change by which numbers are ranked
constexpr int digits_of_effects = 6;

/// A number's row: values in the scene's units.
struct EffectRow {
  const Sensitivity* of = nullptr;
  std::string unit, derivative_unit;
  double value = 0.0, derivative = 0.0;
  double effect = 0.0;  // of the change by which numbers are ranked
};

/// What a number is ranked by a thousandth of: the size of the mechanism for a length, a radian for an angle, else the
/// number itself, or, of one that is zero, the largest of its kind, or its unit where all are zero.
double size_of(const Sensitivity& s, const QuantitySensitivity& quantity, const Sensitivities& found,
               const Units& units) {
  if (s.dimension == dimension::length) return found.size;
  if (s.dimension == dimension::angle) return 1.0;
  if (s.value != 0.0) return std::abs(s.value);
  double largest = 0.0;
  for (const Sensitivity& other : quantity.by) {
    if (other.dimension == s.dimension) largest = std::max(largest, std::abs(other.value));
  }
  return largest > 0.0 ? largest : s.dimension.unit(units);
}

EffectRow row_of(const Sensitivity& s, const QuantitySensitivity& quantity, const Sensitivities& found,
                 const Units& units) {
  EffectRow row;
  row.of = &s;
  const Dimension slope = quantity.of.dimension * s.dimension.power(-1);
  row.unit = s.dimension.unit_name(units);
  row.derivative_unit = slope.unit_name(units);
  row.value = s.value / s.dimension.unit(units);
  if (!s.why.empty()) return row;
  row.derivative = s.derivative / slope.unit(units);
  row.effect = s.derivative * ranked_part * size_of(s, quantity, found, units) / quantity.of.dimension.unit(units);
  return row;
}

std::vector<EffectRow> ranked(const QuantitySensitivity& quantity, const Sensitivities& found, const Units& units) {
  std::vector<EffectRow> rows;
  for (const Sensitivity& s : quantity.by) rows.push_back(row_of(s, quantity, found, units));
  std::stable_sort(rows.begin(), rows.end(), [](const EffectRow& a, const EffectRow& b) {
    return to_rank(std::abs(a.effect)) > to_rank(std::abs(b.effect));
  });
  return rows;
}

std::string sentence(const EffectRow& row, const QuantitySensitivity& quantity, const Units& units) {
  const std::string of = quantity.of.dimension.unit_name(units);
  return fmt::format("1{} of {} moves {} by {}{}", row.unit.empty() ? "" : " " + row.unit, row.of->number,
                     quantity.of.name, significant(row.derivative, digits_of_effects), of.empty() ? "" : " " + of);
}

void add_data(Branch& quantities, const QuantitySensitivity& quantity, const std::vector<EffectRow>& rows,
              const Units& units) {
  Group& group = quantities.parts.emplace_back();
  group.data("name", quantity.of.name);
  group.data("unit", quantity.of.dimension.unit_name(units));
  const bool known = quantity.why.empty();
  group.data("value", known ? Value(quantity.value / quantity.of.dimension.unit(units)) : Value());
  group.data("why", known ? Value() : Value(quantity.why));
  Branch& numbers = group.array("numbers");
  for (const EffectRow& row : rows) {
    Group& one = numbers.parts.emplace_back();
    const bool has_derivative = row.of->why.empty();
    one.data("number", row.of->number);
    one.data("value", row.value);
    one.data("unit", row.unit);
    one.data("derivative", has_derivative ? Value(row.derivative) : Value());
    one.data("derivative_unit", row.derivative_unit);
    one.data("effect", has_derivative ? Value(row.effect) : Value());
    one.data("why", has_derivative ? Value() : Value(row.of->why));
  }
}

void add_text(Group& content, const QuantitySensitivity& quantity, const std::vector<EffectRow>& rows, int top,
              const Units& units) {
  const std::string unit = quantity.of.dimension.unit_name(units);
  const double value = quantity.value / quantity.of.dimension.unit(units);
  Group& group = content.group("", fmt::format("{} = {}{}", quantity.of.name, significant(value, digits_of_effects),
                                               unit.empty() ? "" : " " + unit));
  std::vector<EffectRow> shown;
  int idle = 0;
  std::map<std::string, std::vector<std::string>> without;
  for (const EffectRow& row : rows) {
    if (!row.of->why.empty()) {
      without[row.of->why].push_back(row.of->number);
    } else if (row.derivative == 0.0) {
      ++idle;
    } else {
      shown.push_back(row);
    }
  }
  const int all = static_cast<int>(shown.size());
  if (top > 0 && all > top) shown.resize(static_cast<std::size_t>(top));
  std::vector<std::string> remarks;
  if (all > static_cast<int>(shown.size())) {
    remarks.push_back(fmt::format("and {} with less effect: --top 0 shows all",
                                  count(all - static_cast<int>(shown.size()), "number", "numbers")));
  }
  if (idle > 0) remarks.push_back(count(idle, "number", "numbers") + " without effect");
  constexpr std::size_t most_names = 4;
  for (auto& [why, names] : without) {
    const std::size_t number = names.size();
    if (number > most_names) names.resize(most_names);
    remarks.push_back(fmt::format("no derivative by {}{}: {}", fmt::join(names, ", "),
                                  number > most_names ? fmt::format(" and {} more", number - most_names) : "", why));
  }
  // A table without rows is not shown.
  if (shown.empty()) {
    for (const std::string& remark : remarks) group.note("  " + remark);
    return;
  }
  Table& table = group.table("", "", Rows::list);
  table.numbers("", "effect", unit, each(shown, &EffectRow::effect), {.digits = 4});
  table.words("", "derivative", each(shown, [&](const EffectRow& row) { return sentence(row, quantity, units); }));
  table.footnotes = std::move(remarks);
}

}  // namespace

Result sensitivity_result(const Scene& scene, const Sensitivities& found, int top,
                          const std::vector<std::string>& settings) {
  Result out = scene_result(scene, settings);
  const Units& units = scene.units;
  std::vector<std::string> failed;
  for (const QuantitySensitivity& quantity : found.of) {
    if (!quantity.why.empty()) failed.push_back(fmt::format("{}: {}", quantity.of.name, quantity.why));
  }
  if (!found.why.empty()) {
    out.verdict = bad("No derivatives: " + found.why + ".");
  } else if (failed.size() == found.of.size()) {
    out.verdict = bad("No derivatives; " + failed.front() + ".");
    failed.erase(failed.begin());
  } else {
    const Stability stability = found.equilibrium.certificate.stability;
    out.verdict = good(stability == Stability::unknown
                           ? "Derivatives at the equilibrium, which is proved; its stability is not known."
                           : fmt::format("Derivatives at the equilibrium, which is proved: {}.", to_string(stability)));
  }
  for (const std::string& line : failed) out.warnings.push_back(bad("No derivative of " + line + "."));
  warn_of_friction(out, scene);
  const double step = ranked_part * found.size / dimension::length.unit(units);
  out.content.data("status", to_string(found.equilibrium.status));
  out.content.data("why", found.why.empty() ? Value() : Value(found.why));
  out.content.data("length_change", found.why.empty() ? Value(step) : Value());
  if (found.why.empty()) {
    out.content.fact(
        "ranked by",
        fmt::format("the effect of {} {} more of a length (a thousandth of the mechanism's size), "
                    "1 mrad more of an angle, 0.1 % more of any other number (where that is 0, of the largest of its "
                    "kind)",
                    significant(step, 3), dimension::length.unit_name(units)));
  }
  Branch& quantities = out.content.array("quantities");
  std::vector<std::string> names, numbers, number_units, derivative_units;
  std::vector<double> values, derivatives, effects;
  for (const QuantitySensitivity& quantity : found.of) {
    const std::vector<EffectRow> rows = ranked(quantity, found, units);
    add_data(quantities, quantity, rows, units);
    for (const EffectRow& row : rows) {
      const double gap = or_gap(std::nullopt);
      names.push_back(quantity.of.name);
      numbers.push_back(row.of->number);
      values.push_back(row.value);
      number_units.push_back(row.unit);
      derivatives.push_back(row.of->why.empty() ? row.derivative : gap);
      derivative_units.push_back(row.derivative_unit);
      effects.push_back(row.of->why.empty() ? row.effect : gap);
    }
    if (quantity.why.empty()) add_text(out.content, quantity, rows, top, units);
  }
  Table& csv = out.content.table("", "", Rows::list, Verbosity::data);
  csv.csv = true;
  csv.words("quantity", "", std::move(names));
  csv.words("number", "", std::move(numbers));
  csv.data("value", std::move(values));
  csv.words("unit", "", std::move(number_units));
  csv.data("derivative", std::move(derivatives));
  csv.words("derivative_unit", "", std::move(derivative_units));
  csv.data("effect", std::move(effects));
  return out;
}

}  // namespace poise::app
