#include "app/results/motion/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"

namespace poise::app {
namespace {

constexpr int most_digits = 8;

std::vector<double> in_unit_of(const SoughtQuantity& of, std::vector<double> si, const Units& units) {
  for (double& one : si) one /= of.dimension.unit(units);
  return si;
}

double largest_finite(const std::vector<double>& values) {
  double out = 0.0;
  for (const double one : values) out = std::isfinite(one) ? std::max(out, std::abs(one)) : out;
  return out;
}

/// How the values of a quantity are written.
struct Written {
  double unit = 1.0;     ///< SI
  double nothing = 0.0;  ///< in it: what is smaller is rounding
  double radius = 0.0;   ///< in it: to which they are known

  std::string text(double si) const {
    const double value = si / unit;
    return significant(std::abs(value) < nothing ? 0.0 : value, most_digits, radius);
  }
};

/// How well a motion is known: the error of its coordinates, and what accelerations leave out of balance, as parts of
/// the largest values.
struct Known {
  double coordinates = 0.0, forces = 0.0;
};

Written written(const SoughtQuantity& of, double largest_value, const ScaledModel& model, double duration,
                const Known& known) {
  constexpr double rounding = 1e-12;
  const bool by_accelerations = MovingQuantities::needs_forces(of) || of.has(SoughtQuantity::Kind::by_time) ||
                                of.has(SoughtQuantity::Kind::shaking);
  const double known_to = by_accelerations ? std::max(known.coordinates, known.forces) : known.coordinates;
  const double unit = of.dimension.unit(model.scene().units);
  const double size = std::pow(duration, of.dimension.time) / of.dimension.per_scale(model.scales());
  return {unit, std::max(rounding, known_to) * size / unit, known_to * largest_value / unit};
}

/// "force.s is undefined at 3 of 1001 times".
std::vector<std::string> undefined_in_words(const QuantitiesInTime& found) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < found.of.size(); ++k) {
    const auto number =
        std::count_if(found.value[k].begin(), found.value[k].end(), [](double value) { return !std::isfinite(value); });
    if (number == 0) continue;
    out.push_back(fmt::format("{} is undefined at {} of {} times.", found.of[k].name, number, found.time.size()));
  }
  return out;
}

void add_ranges(Group& group, const QuantitiesInTime& found, const ScaledModel& model, const Known& known) {
  std::vector<std::string> names, least, greatest, mean, of_units;
  std::vector<double> least_at, greatest_at;
  for (std::size_t k = 0; k < found.of.size(); ++k) {
    const QuantityRange& range = found.range[k];
    const double largest = largest_finite({range.least.value, range.greatest.value});
    const Written as = written(found.of[k], largest, model, found.duration, known);
    names.push_back(found.of[k].name);
    least.push_back(as.text(range.least.value));
    least_at.push_back(range.least.time);
    greatest.push_back(as.text(range.greatest.value));
    greatest_at.push_back(range.greatest.time);
    mean.push_back(as.text(range.mean));
    of_units.push_back(found.of[k].dimension.unit_name(model.scene().units));
  }
  const Format times{.style = Format::Style::significant};
  Table& table = group.table("", "Over the whole motion", Rows::list);
  table.words("", "quantity", std::move(names));
  table.words("", "least", std::move(least));
  table.numbers("", "at", "s", std::move(least_at), times);
  table.words("", "greatest", std::move(greatest));
  table.numbers("", "at", "s", std::move(greatest_at), times);
  table.words("", "mean", std::move(mean));
  table.words("", "unit", std::move(of_units));
}

void add_once(Group& group, const QuantitiesInTime& found, const ScaledModel& model, const Known& known) {
  std::vector<std::string> names, texts, of_units;
  std::vector<double> values, times;
  for (const auto& [of, value, at] : found.once) {
    names.push_back(of.name);
    const Written as = written(of, std::abs(value), model, found.duration, known);
    values.push_back(value / as.unit);
    texts.push_back(as.text(value));
    times.push_back(at);
    of_units.push_back(of.dimension.unit_name(model.scene().units));
  }
  Table& table = group.table("", "Quantities of the whole motion", Rows::list);
  table.csv = found.are_all && found.of.empty();
  table.words("quantity", "quantity", std::move(names));
  table.numbers("value", "value", "", std::move(values)).texts = std::move(texts);
  table.words("unit", "unit", std::move(of_units));
  const bool any = std::any_of(times.begin(), times.end(), [](double at) { return std::isfinite(at); });
  if (any) table.numbers("at", "at", "s", std::move(times), {.style = Format::Style::significant});
}

void add_quantity_data(Group& group, const QuantitiesInTime& found, const Units& units) {
  group.data("quantity_times", found.time);
  Branch& quantities = group.array("quantities");
  for (const auto& [of, value, at] : found.once) {
    Group& one = quantities.parts.emplace_back();
    one.data("name", of.name);
    one.data("unit", of.dimension.unit_name(units));
    one.data("value", value / of.dimension.unit(units));
    one.data("at", at);
  }
  for (std::size_t k = 0; k < found.of.size(); ++k) {
    const SoughtQuantity& of = found.of[k];
    const QuantityRange& range = found.range[k];
    const double unit = of.dimension.unit(units);
    Group& one = quantities.parts.emplace_back();
    one.data("name", of.name);
    one.data("unit", of.dimension.unit_name(units));
    one.data("values", in_unit_of(of, found.value[k], units));
    one.data("least", range.least.value / unit);
    one.data("least_at", range.least.time);
    one.data("greatest", range.greatest.value / unit);
    one.data("greatest_at", range.greatest.time);
    one.data("mean", range.mean / unit);
  }
}

/// When an extreme is reached.
double time_of(const SoughtQuantity& of, QuantitiesAlong& along) {
  const bool is_greatest = of.kind == SoughtQuantity::Kind::maximum;
  if (!is_greatest && of.kind != SoughtQuantity::Kind::minimum) return std::numeric_limits<double>::quiet_NaN();
  const QuantityRange range = along.ranges(of.of).front();
  return is_greatest ? range.greatest.time : range.least.time;
}

}  // namespace

QuantitiesInTime quantities_in_time(const std::vector<SoughtQuantity>& of, const std::vector<double>& time,
                                    double duration, QuantitiesAlong& along) {
  QuantitiesInTime out{.duration = duration, .time = time};
  std::vector<SoughtQuantity> changing;
  for (const SoughtQuantity& one : of) {
    if (!is_constant_in_time(one))
      changing.push_back(one);
    else
      out.once.push_back({one, along.value(one, time.front()), time_of(one, along)});
  }
  out.of = std::move(changing);
  out.value.resize(out.of.size());
  for (const double t : time) {
    for (std::size_t k = 0; k < out.of.size(); ++k) out.value[k].push_back(along.value(out.of[k], t));
  }
  out.range = along.ranges(out.of);
  out.imbalance = along.imbalance();
  return out;
}

void add_quantities_in_time(Group& group, const QuantitiesInTime& found, const ScaledModel& model,
                            const std::optional<double>& error, bool is_confirmed) {
  const Units& units = model.scene().units;
  const Known known{error.value_or(0.0), found.imbalance};
  add_quantity_data(group, found, units);
  add_once(group, found, model, known);
  for (const std::string& why : found.left_out) group.fact("left out", why, Tone::doubtful);
  if (found.of.empty()) return;
  add_ranges(group, found, model, known);
  Table& table = group.table("", "Quantities over time", Rows::columns);
  table.csv = found.are_all;
  table.shown = Table::Shown::spread;
  table.numbers("time", "time", "s", found.time, {.digits = 6});
  if (!is_confirmed) table.words("confirmed", "", std::vector<std::string>(found.time.size(), "no")).shown = false;
  for (std::size_t k = 0; k < found.of.size(); ++k) {
    const SoughtQuantity& of = found.of[k];
    const Written as = written(of, largest_finite(found.value[k]), model, found.duration, known);
    table.numbers(of.name, of.name, of.dimension.unit_name(units), in_unit_of(of, found.value[k], units),
                  {.digits = most_digits, .zero_below = as.nothing, .radius = as.radius});
  }
  table.footnotes = undefined_in_words(found);
}

}  // namespace poise::app
