#include "app/results/statics/find.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/quantities.hpp"
#include "statics/model/pose_values.hpp"
#include "statics/paths/path_words.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_found = 10, digits_of_nearest = 5;  // the nearest is that of the points of the curves

bool is_fold(const FoundNumbers& one) { return one.at.proof == PointProof::critical; }

/// "2 values" or "2 pairs of values".
std::string values_in_words(const FindView& view, std::size_t number) {
  return view.numbers.size() == 1 ? count(static_cast<int>(number), "value", "values")
                                  : count(static_cast<int>(number), "pair of values", "pairs of values");
}

std::string with_unit_of(double in_unit, const std::string& unit, int digits = digits_of_found) {
  return significant(in_unit, digits) + (unit.empty() ? "" : " " + unit);
}

std::string number_in_words(const VariedScene& number, double si, int digits = digits_of_found) {
  return number.name() + " = " + with_unit_of(si / number.unit(), number.unit_name(), digits);
}

std::string quantity_in_words(const WantedValue& wanted, double si, const Units& units, int digits) {
  return wanted.of.name + " = " +
         with_unit_of(si / wanted.of.dimension.unit(units), wanted.of.dimension.unit_name(units), digits);
}

std::string numbers_in_words(const FindView& view, const FoundNumbers& one, int digits = digits_of_found) {
  std::string out;
  for (std::size_t k = 0; k < view.numbers.size(); ++k) {
    out += (k == 0 ? "" : ", ") + number_in_words(*view.numbers[k], one.numbers[k], digits);
  }
  return out;
}

std::string quantities_in_words(const FindView& view, const FoundNumbers& one, const Units& units, int digits) {
  std::string out;
  for (std::size_t k = 0; k < view.wanted.size(); ++k) {
    out += (k == 0 ? "" : ", ") + quantity_in_words(view.wanted[k], one.values[k], units, digits);
  }
  return out;
}

/// What was looked at: "on the curve of equilibria through the scene's own; others not searched".
std::string searched_in_words(const FindView& view, const FoundSet& found) {
  if (view.wanted[0].of.kind == SoughtQuantity::Kind::load_at_fold) {
    if (found.values.empty()) {
      return fmt::format("at {} at which the first fold was found", count(found.paths, "value", "values"));
    }
    return fmt::format("as a fold; that it is the first is found by paths at {} of the number",
                       count(found.paths, "value", "values"));
  }
  if (view.numbers.size() == 2)
    return fmt::format("from the closest places on {}; others not searched", count(found.curves, "curve", "curves"));
  if (!view.all) return "on the curve of equilibria through the scene's own; others not searched";
  return fmt::format("on {} of equilibria", count(found.curves, "curve", "curves"));
}

/// "; it is between 1 N and 2 N there", at the points of the curves.
std::string reach_in_words(const FindView& view, const FoundSet& found, const Units& units) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const QuantityCourse& course : found.courses) {
    for (const double value : course.values) {
      if (!std::isfinite(value)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  if (!(least < most)) return "";
  const Dimension& of = view.wanted[0].of.dimension;
  constexpr int digits = 6;
  return fmt::format("; it is between {} and {} there", significant(least / of.unit(units), digits),
                     with_unit_of(most / of.unit(units), of.unit_name(units), digits));
}

Line verdict_of(const FindView& view, const FoundSet& found, const Units& units) {
  using Status = FoundSet::Status;
  switch (found.status) {
    case Status::found: {
      const auto unproved = std::count_if(found.values.begin(), found.values.end(),
                                          [](const FoundNumbers& one) { return !one.proved && !is_fold(one); });
      const std::string what = values_in_words(view, found.values.size());
      if (found.values.empty()) return doubtful("It has the value all along a part of the range, which is not proved.");
      const bool folds = is_fold(found.values.front());
      if (unproved > 0) {
        return doubtful(fmt::format("{} {}; {} not proved.", what, searched_in_words(view, found),
                                    unproved == static_cast<std::ptrdiff_t>(found.values.size())
                                        ? std::string(unproved == 1 ? "it is" : "they are")
                                        : count(static_cast<int>(unproved), "is", "are")));
      }
      const bool all_proved =
          std::all_of(found.values.begin(), found.values.end(), [](const FoundNumbers& one) { return one.proved; });
      return good(fmt::format("{}{} {}.", what, folds ? (all_proved ? ", proved" : ", not proved") : ", proved,",
                              searched_in_words(view, found)));
    }
    case Status::none:
      return bad(fmt::format("None in the range {}{}; the nearest is {} at {}.", searched_in_words(view, found),
                             reach_in_words(view, found, units),
                             quantities_in_words(view, *found.nearest, units, digits_of_nearest),
                             numbers_in_words(view, *found.nearest, digits_of_nearest)));
    case Status::no_start:
      return bad("No equilibrium to begin from: " + found.why + ".");
    case Status::undefined:
      return bad(found.why.empty() ? "The quantity has no value anywhere on the curve of equilibria."
                                   : sentence_of("The quantity has no value in the range: " + found.why));
    default:
      return bad(fmt::format("Interrupted; {} found so far.", values_in_words(view, found.values.size())));
  }
}

/// What else is shown where a value was found.
std::vector<QuantityValue> shown_at(const FindView& view, const FoundNumbers& one) {
  const bool is_known = !one.at.x.empty() && !is_fold(one);
  std::vector<QuantityValue> out(view.shown.size(), {std::numeric_limits<double>::quiet_NaN(), "no equilibrium"});
  if (!is_known || view.shown.empty()) return out;
  const VariedScene& first = *view.numbers.front();
  const VariedScene held =
      view.numbers.size() == 2 ? first.in(view.numbers[1]->scene_at(one.numbers[1]), first) : first;
  const auto model = held.model_at(one.numbers[0]);
  std::vector<int> active = one.at.active_stops;
  const int driven = first.is_driven() ? static_cast<int>(model->scene().stops.size()) - 1 : -1;
  if (driven >= 0) active.push_back(driven);
  return quantity_values(resting_place(*model, one.at.x, active, driven, other_quantity), view.shown);
}

void add_found_data(Group& group, const FindView& view, const FoundNumbers& one, const Units& units) {
  std::vector<double> numbers, quantities;
  for (std::size_t k = 0; k < view.numbers.size(); ++k) numbers.push_back(one.numbers[k] / view.numbers[k]->unit());
  for (std::size_t k = 0; k < view.wanted.size(); ++k) {
    quantities.push_back(one.values[k] / view.wanted[k].of.dimension.unit(units));
  }
  group.data("numbers", numbers);
  std::vector<double> radii;
  for (std::size_t k = 0; k < view.numbers.size(); ++k) radii.push_back(one.radii[k] / view.numbers[k]->unit());
  group.data("radii", one.proved ? Value(radii) : Value());
  group.data("reached", quantities);
  group.data("proved", one.proved);
  group.data("statement", one.at.statement);
  group.data("stability", to_string(one.at.stability));
  group.data("unstable_directions", one.at.unstable_directions);
  const VariedScene& first = *view.numbers.front();
  group.data("active_stops", each(one.at.active_stops,
                                  [&](int stop) { return first.scene().stops[static_cast<std::size_t>(stop)].name; }));
  add_quantities(group, view.shown, shown_at(view, one), units);
  if (one.at.x.empty() || view.numbers.size() != 1) return;
  const auto model = first.model_at(one.numbers[0]);
  const Readings readings = read_off(*model, one.at.x);
  add_named(group, "angles", angles_of(*model, readings), Quantity::angle, units);
  add_named(group, "slides", travels_of(*model, readings), Quantity::length, units);
}

/// So many significant digits of a number that the last is within its radius; of what is not proved ten.
int known_digits(const FoundSet& found, std::size_t number) {
  constexpr int most = 16;
  int out = digits_of_found;
  for (const FoundNumbers& one : found.values) {
    const double relative = one.radii[number] / std::abs(one.numbers[number]);
    if (one.proved && relative > 0.0) out = std::max(out, static_cast<int>(std::ceil(-std::log10(relative))) + 1);
  }
  return std::min(out, most);
}

/// A row for each that was found, of the CSV file too.
void add_table(Group& content, const FindView& view, const FoundSet& found, const Units& units) {
  Table& table = content.table("", "Found", Rows::list);
  table.csv = true;
  for (std::size_t k = 0; k < view.numbers.size(); ++k) {
    const VariedScene& number = *view.numbers[k];
    table.numbers(number.name(), number.name(), number.unit_name(),
                  each(found.values, [&](const FoundNumbers& one) { return one.numbers[k] / number.unit(); }),
                  {.style = Format::Style::significant, .digits = known_digits(found, k)});
    table.numbers(
        number.name() + ".radius", "+-", number.unit_name(),
        each(found.values,
             [&](const FoundNumbers& one) { return one.proved ? one.radii[k] / number.unit() : or_gap(std::nullopt); }),
        {.style = Format::Style::error});
  }
  for (std::size_t k = 0; k < view.wanted.size(); ++k) {
    const SoughtQuantity& of = view.wanted[k].of;
    table.numbers(of.name, of.name, of.dimension.unit_name(units),
                  each(found.values, [&](const FoundNumbers& one) { return one.values[k] / of.dimension.unit(units); }),
                  {.style = Format::Style::significant, .digits = digits_of_found});
  }
  std::vector<std::vector<QuantityValue>> shown;
  for (const FoundNumbers& one : found.values) shown.push_back(shown_at(view, one));
  add_quantity_columns(table, view.shown, shown, units);
  table.words("stability", "stability", each(found.values, [](const FoundNumbers& one) {
                return is_fold(one) ? std::string("fold") : to_string(one.at.stability);
              }));
  table.words("proof", "proof", each(found.values, [](const FoundNumbers& one) {
                return std::string(one.proved ? "proved" : is_fold(one) ? "found by a path" : "not proved");
              }));
}

}  // namespace

std::vector<Panel> find_panels(const FindView& view, const FoundSet& found) {
  if (view.numbers.size() != 1 || found.courses.empty()) return {};
  const VariedScene& number = *view.numbers.front();
  const WantedValue& wanted = view.wanted.front();
  const Units& units = number.scene().units;
  const double unit = wanted.of.dimension.unit(units);
  const auto label = [](const std::string& name, const std::string& unit_name) {
    return unit_name.empty() ? name : name + " (" + unit_name + ")";
  };
  Panel panel{.title = wanted.of.name + " over " + number.name(),
              .x_label = label(number.name(), number.unit_name()),
              .y_label = label(wanted.of.name, wanted.of.dimension.unit_name(units))};
  for (const QuantityCourse& course : found.courses) {
    Curve curve;
    curve.colour = 0;
    for (std::size_t k = 0; k < course.numbers.size(); ++k) {
      curve.x.push_back(course.numbers[k] / number.unit());
      curve.y.push_back(course.values[k] / unit);
    }
    panel.curves.push_back(std::move(curve));
  }
  panel.levels.push_back({wanted.value / unit, "wanted"});
  for (std::size_t k = 0; k < found.values.size(); ++k) {
    panel.marks.push_back(
        {found.values[k].numbers[0] / number.unit(), found.values[k].values[0] / unit, std::to_string(k + 1)});
  }
  return {panel};
}

bool is_settled(const FoundSet& found) {
  return found.status == FoundSet::Status::found && found.all_along.empty() &&
         std::all_of(found.values.begin(), found.values.end(), [](const FoundNumbers& one) { return one.proved; });
}

Result find_result(const FindView& view, const FoundSet& found, const std::vector<std::string>& settings) {
  const Scene& scene = view.numbers.front()->scene();
  Result out = scene_result(scene, settings);
  const Units& units = scene.units;
  out.verdict = verdict_of(view, found, units);
  for (const FoundNumbers& one : found.values) {
    if (one.proved || is_fold(one)) continue;
    out.warnings.push_back(
        doubtful(sentence_of(fmt::format("Not proved at {}: {}", numbers_in_words(view, one), one.at.statement))));
  }
  if (found.branch_points > 0) {
    out.warnings.push_back(doubtful(fmt::format(
        "The curve meets {} at which others cross it; these are not followed, but through equilibria of --all.",
        count(found.branch_points, "point", "points"))));
  }
  for (const auto& [from, to] : found.all_along) {
    out.warnings.push_back(doubtful(fmt::format("It has the value all along from {} to {}, to rounding.",
                                                number_in_words(*view.numbers.front(), from),
                                                number_in_words(*view.numbers.front(), to))));
  }
  if (!found.whole) {
    out.warnings.push_back(
        doubtful("Not every curve was followed to an end of the range; values beyond are not seen."));
  }
  warn_of_friction(out, scene);
  static constexpr const char* names_of_status[] = {"not_started", "found",     "none",
                                                    "no_start",    "undefined", "interrupted"};
  out.content.data("status", names_of_status[static_cast<std::size_t>(found.status)]);
  out.content.data("why", found.why.empty() ? Value() : Value(found.why));
  Branch& numbers = out.content.array("numbers");
  for (const VariedScene* number : view.numbers) {
    Group& one = numbers.parts.emplace_back();
    one.data("name", number->name());
    one.data("unit", number->unit_name());
    one.data("from", number->from() / number->unit());
    one.data("to", number->to() / number->unit());
  }
  Branch& wanted = out.content.array("wanted");
  for (const WantedValue& want : view.wanted) {
    Group& one = wanted.parts.emplace_back();
    one.data("name", want.of.name);
    one.data("unit", want.of.dimension.unit_name(units));
    one.data("value", want.value / want.of.dimension.unit(units));
  }
  Branch& values = out.content.array("values");
  for (const FoundNumbers& one : found.values) add_found_data(values.parts.emplace_back(), view, one, units);
  Branch& ranges = out.content.array("all_along");
  for (const auto& [from, to] : found.all_along) {
    Group& one = ranges.parts.emplace_back();
    one.data("from", from / view.numbers.front()->unit());
    one.data("to", to / view.numbers.front()->unit());
  }
  if (found.nearest) {
    add_found_data(out.content.group("nearest", "", Verbosity::data), view, *found.nearest, units);
  } else {
    out.content.data("nearest", Value());
  }
  out.content.data("curves", found.curves);
  out.content.data("branch_points", found.branch_points);
  out.content.data("whole", found.whole);
  out.content.data("sets", found.sets.empty() ? Value() : Value(found.sets));
  out.content.data("paths", found.paths);
  if (!found.values.empty()) add_table(out.content, view, found, units);
  if (!found.sets.empty()) out.content.note(sentence_of(found.sets));
  return out;
}

}  // namespace poise::app
