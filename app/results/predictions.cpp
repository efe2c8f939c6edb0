#include "app/results/predictions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"
#include "app/results/parts.hpp"
#include "solvers/not_a_number.hpp"

namespace poise::app {
namespace {

/// "all", "three quarters", "a third", ...: the nearest of such parts.
std::string part_in_words(double share) {
  constexpr std::array<std::pair<double, const char*>, 10> parts{{{1.0, "nearly all"},
                                                                  {0.9, "nine tenths"},
                                                                  {0.8, "four fifths"},
                                                                  {0.75, "three quarters"},
                                                                  {2.0 / 3.0, "two thirds"},
                                                                  {0.5, "half"},
                                                                  {1.0 / 3.0, "a third"},
                                                                  {0.25, "a quarter"},
                                                                  {0.2, "a fifth"},
                                                                  {0.1, "a tenth"}}};
  const auto nearest = std::min_element(parts.begin(), parts.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.first - share) < std::abs(b.first - share);
  });
  return nearest->second;
}

/// What the largest part of the variance is due to; empty where nothing moves the result.
std::string origin_in_words(const FittedNumbers& numbers, const PredictedResult& of) {
  if (of.shares.empty() || !(of.sigma > 0)) return "";
  const PredictedResult::Share& first = of.shares.front();
  const std::string& name = numbers.numbers[first.number].name;
  if (of.shares.size() == 1) return "all of it from " + name;
  if (first.share > 1.0) return "from " + name + " and others whose errors partly cancel";
  return part_in_words(first.share) + " of it from " + name;
}

/// In the units of the scene.
struct PredictionView {
  const PredictedResult& of;
  double unit;
  std::string unit_name;

  PredictionView(const PredictedResult& prediction, const Units& units)
      : of(prediction), unit(prediction.dimension.unit(units)), unit_name(prediction.dimension.unit_name(units)) {}

  /// The digits that the interval leaves.
  std::string with_digits(double si) const { return rounded_to(si / unit, of.sigma / unit); }
  std::string interval() const {
    if (!of.is_known()) return "-";
    if (!(of.sigma > 0)) return "exact";
    return with_digits(of.low) + " to " + with_digits(of.high);
  }
};

void add_prediction_data(Branch& results, const FittedNumbers& numbers, const PredictedResult& of, const Units& units) {
  const double unit = of.dimension.unit(units);
  const auto value = [&](double si, bool there) { return there ? Value(si / unit) : Value(); };
  const bool known = of.is_known();
  Group& one = results.parts.emplace_back();
  one.data("name", of.name);
  one.data("unit", of.dimension.unit_name(units));
  one.data("value", value(of.value, of.why.empty() || std::isfinite(of.value)));
  one.data("why", of.why.empty() ? Value() : Value(of.why));
  one.data("not_determined", of.undetermined.empty() ? Value() : Value(of.undetermined));
  one.data("low", value(of.low, known));
  one.data("high", value(of.high, known));
  one.data("standard_error", value(of.sigma, known));
  one.data("first_order_low", value(of.first_low, known));
  one.data("first_order_high", value(of.first_high, known));
  one.data("second_order_mean", value(of.value + of.shift, known && of.has_second));
  one.data("second_order_standard_error", value(of.second_sigma, known && of.has_second));
  one.data("linear", known && of.has_second ? Value(of.is_linear) : Value());
  one.data("one_sided", of.is_one_sided);
  Branch& shares = one.array("shares");
  for (const PredictedResult::Share& share : of.shares) {
    const FittedNumbers::Number& number = numbers.numbers[share.number];
    Group& part = shares.parts.emplace_back();
    part.data("name", number.name);
    part.data("path", number.path);
    part.data("share", share.share);
    part.data("derivative", share.slope * number.dimension.unit(units) / unit);
    part.data("unit", number.dimension.unit_name(units));
  }
}

}  // namespace

std::vector<SoughtQuantity> predicted_by_default(const Scene& scene) {
  std::vector<SoughtQuantity> out = outputs_of(scene);
  std::erase_if(
      out, [](const SoughtQuantity& one) { return one.is_over_path() || one.has(SoughtQuantity::Kind::load_at_fold); });
  for (SoughtQuantity& one : all_quantities(scene)) {
    using Kind = SoughtQuantity::Kind;
    const bool is_coordinate =
        one.kind == Kind::measure && one.on.body_a == 0 && (one.on.is_angle() || one.on.kind == Measure::Kind::travel);
    const bool is_force = one.kind == Kind::element_force || one.kind == Kind::stop_reaction ||
                          (one.kind == Kind::reaction &&
                           (one.part == SoughtQuantity::Part::size || one.part == SoughtQuantity::Part::axial));
    const bool has_name =
        std::any_of(out.begin(), out.end(), [&](const auto& other) { return other.name == one.name; });
    if ((is_coordinate || is_force) && !has_name) out.push_back(std::move(one));
  }
  return out;
}

std::string prediction_in_words(const FittedNumbers& numbers, const PredictedResult& prediction, const Units& units) {
  const PredictionView shown(prediction, units);
  const double below = prediction.value - prediction.low, above = prediction.high - prediction.value;
  const std::string unit = shown.unit_name.empty() ? "" : " " + shown.unit_name;
  const bool is_even = std::abs(above - below) <= 0.1 * (above + below);
  std::string out = is_even
                        ? fmt::format("{} ± {}{} (95 %)", shown.with_digits(prediction.value),
                                      significant(0.5 * (above + below) / shown.unit, 2), unit)
                        : fmt::format("{}{}, {} (95 %)", shown.with_digits(prediction.value), unit, shown.interval());
  const std::string origin = origin_in_words(numbers, prediction);
  return origin.empty() ? out : out + ", " + origin;
}

bool add_predictions(Result& result, const FittedNumbers& numbers, const std::vector<PredictedResult>& predictions,
                     const Units& units) {
  for (const std::string& note : numbers.notes) result.warnings.push_back(doubtful(note));
  std::vector<std::string> bent;
  for (const PredictedResult& one : predictions) {
    if (!one.undetermined.empty()) {
      result.warnings.push_back(bad(fmt::format("{} is not determined by this fit: {}.", one.name, one.undetermined)));
    } else if (!one.why.empty()) {
      result.warnings.push_back(bad(fmt::format("No interval of {}: {}.", one.name, one.why)));
    } else if (!one.is_linear) {
      bent.push_back(one.name);
    }
  }
  if (!bent.empty()) {
    result.warnings.push_back(doubtful(
        fmt::format("First order does not suffice for {}: the intervals are those of second order.", listed(bent))));
  }
  Group& data = result.content.group("predictions", "", Verbosity::data);
  data.data("fit", numbers.file);
  Branch& results = data.array("results");
  for (const PredictedResult& one : predictions) add_prediction_data(results, numbers, one, units);
  Table& table = result.content.table("", "With the errors of " + numbers.file, Rows::list);
  table.shown = Table::Shown::all;
  table.words("", "result", each(predictions, &PredictedResult::name));
  table.words("", "value", each(predictions, [&](const PredictedResult& one) {
                const PredictionView shown(one, units);
                return one.is_known() && one.sigma > 0 ? shown.with_digits(one.value)
                                                       : significant(one.value / shown.unit, 6);
              }));
  table.words("", "95 % interval",
              each(predictions, [&](const PredictedResult& one) { return PredictionView(one, units).interval(); }));
  table.words("", "unit",
              each(predictions, [&](const PredictedResult& one) { return one.dimension.unit_name(units); }));
  table
      .words("", "",
             each(predictions,
                  [&](const PredictedResult& one) {
                    if (!one.undetermined.empty()) return std::string("not determined by this fit");
                    return one.is_known() ? origin_in_words(numbers, one) : std::string("no derivative");
                  }))
      .tones = each(predictions, [](const PredictedResult& one) { return one.is_known() ? Tone::plain : Tone::bad; });
  return std::all_of(predictions.begin(), predictions.end(), [](const auto& one) { return one.is_known(); });
}

}  // namespace poise::app
