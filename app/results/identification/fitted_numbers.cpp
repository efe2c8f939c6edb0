#include "app/results/identification/fitted_numbers.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/result/each.hpp"
#include "app/results/identification/experiment.hpp"
#include "identification/assessment/carried_numbers.hpp"
#include "identification/assessment/determined_inertia.hpp"
#include "model/input_error.hpp"
#include "model/text_file.hpp"
#include "solvers/not_a_number.hpp"

namespace poise::app {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using nlohmann::json;
using FittedNumber = FittedNumbers::Number;

const std::vector<std::string> number_origins = {"estimated", "taken", "sensor", "several"};
const std::vector<std::string> number_bounds = {"none", "least", "most"};

std::vector<double> listed_values(const VectorXd& v) { return {v.begin(), v.end()}; }

/// What null stands for is not known.
double or_not_known(const json& value) { return value.is_null() ? not_a_number : value.get<double>(); }

VectorXd vector_of(const json& values) {
  VectorXd out(static_cast<Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) out[static_cast<Index>(i)] = or_not_known(values[i]);
  return out;
}

std::size_t place_among(const std::vector<std::string>& words, const json& word) {
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), word.get<std::string>()) - words.begin());
}

FittedNumbers numbers_in(const json& found) {
  FittedNumbers out;
  const json& numbers = found.at("numbers");
  const auto count = static_cast<Index>(numbers.size());
  out.covariance.resize(count, count);
  out.degrees = or_not_known(found.at("degrees_of_freedom"));
  VectorXd unit(count);
  for (Index i = 0; i < count; ++i) unit[i] = numbers[static_cast<std::size_t>(i)].at("unit_si").get<double>();
  for (Index i = 0; i < count; ++i) {
    const json& one = numbers[static_cast<std::size_t>(i)];
    FittedNumber& number = out.numbers.emplace_back();
    number.name = one.at("name").get<std::string>();
    number.path = one.at("path").get<std::string>();
    number.value = one.at("value").get<double>() * unit[i];
    number.unit = unit[i];
    number.bound = static_cast<FittedNumber::Bound>(place_among(number_bounds, one.at("bound")));
    number.origin = static_cast<FittedNumber::Origin>(place_among(number_origins, one.at("origin")));
    out.covariance.col(i) = unit.cwiseProduct(vector_of(one.at("covariance"))) * unit[i];
    if (!one.at("covariance_by_runs").is_null()) {
      if (!out.by_runs) out.by_runs.emplace(count, count);
      out.by_runs->col(i) = unit.cwiseProduct(vector_of(one.at("covariance_by_runs"))) * unit[i];
    }
    out.degrees_by_runs.push_back(or_not_known(one.at("degrees_by_runs")));
  }
  for (const json& one : found.at("unknown")) {
    out.unknown.push_back({unit.cwiseProduct(vector_of(one.at("part"))), unit.cwiseProduct(vector_of(one.at("error"))),
                           one.at("words").get<std::string>()});
  }
  return out;
}

}  // namespace

void add_fitted_numbers(Group& content, const FitProblem& problem, const Identification& answer) {
  const std::optional<FittedNumbers> found = carried_numbers(problem, answer);
  if (!found) {
    content.data("fitted_numbers", Value());
    return;
  }
  VectorXd per_unit(found->covariance.rows());
  for (Index i = 0; i < per_unit.size(); ++i) per_unit[i] = 1.0 / found->numbers[static_cast<std::size_t>(i)].unit;
  const auto column = [&](const MatrixXd& v, Index i) {
    return listed_values(per_unit.cwiseProduct(v.col(i)) * per_unit[i]);
  };
  Group& group = content.group("fitted_numbers", "", Verbosity::data);
  group.data("degrees_of_freedom", found->degrees);
  Branch& numbers = group.array("numbers");
  for (Index i = 0; i < per_unit.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const FittedNumber& number = found->numbers[at];
    Group& one = numbers.parts.emplace_back();
    one.data("name", number.name);
    one.data("path", number.path);
    one.data("unit_si", number.unit);
    one.data("value", number.value / number.unit);
    one.data("bound", number_bounds[static_cast<std::size_t>(number.bound)]);
    one.data("origin", number_origins[static_cast<std::size_t>(number.origin)]);
    one.data("covariance", column(found->covariance, i));
    one.data("covariance_by_runs", found->by_runs ? Value(column(*found->by_runs, i)) : Value());
    one.data("degrees_by_runs", found->degrees_by_runs[at]);
  }
  Branch& directions = group.array("unknown");
  for (const FittedNumbers::Direction& direction : found->unknown) {
    Group& one = directions.parts.emplace_back();
    one.data("part", listed_values(per_unit.cwiseProduct(direction.part)));
    one.data("error", listed_values(per_unit.cwiseProduct(direction.error)));
    one.data("words", direction.words);
  }
}

void add_determined_inertia(Group& content, const FitProblem& problem, const Identification& answer) {
  const std::vector<PredictedResult> found = determined_inertia(problem, answer);
  const Units& units = problem.experiment().scene.units;
  const auto unit = [&](const PredictedResult& one) { return one.dimension.unit(units); };
  const auto unit_name = [&](const PredictedResult& one) { return one.dimension.unit_name(units); };
  Branch& data = content.array("inertia");
  for (const PredictedResult& one : found) {
    Group& row = data.parts.emplace_back();
    row.data("name", one.name);
    row.data("value", one.value / unit(one));
    row.data("standard_error", one.sigma / unit(one));
    row.data("low", one.low / unit(one));
    row.data("high", one.high / unit(one));
    row.data("unit", unit_name(one));
  }
  if (found.empty()) return;
  Table& table = content.table("", "Base parameters that are identifiable", Rows::list);
  const auto digits = [&](const PredictedResult& one, double si) {
    return rounded_to(si / unit(one), one.sigma / unit(one));
  };
  table.words("", "base parameter", each(found, &PredictedResult::name));
  table.numbers("", "value", "", {}).texts = each(found, [&](const auto& one) { return digits(one, one.value); });
  table.words("", "95 % interval",
              each(found, [&](const auto& one) { return digits(one, one.low) + " to " + digits(one, one.high); }));
  table.words("", "unit", each(found, unit_name));
  content.group("", "").note(
      "m x and m y are the mass times the place of its centre, and J the inertia about the body's origin, "
      "inertia + m (x^2 + y^2).");
}

FittedNumbers read_fitted_numbers(const std::string& file, const Scene& scene) {
  const std::string expected = ": expected the result of poise identify with --json ";
  const json fit = json::parse(read_text_file(file), nullptr, false);
  if (!fit.is_object() || !fit.contains("estimates") || !fit.contains("status")) {
    throw InputError(file + expected + "FILE, found another text");
  }
  FittedNumbers out;
  try {
    const std::string status = fit.at("status");
    if (status != "converged" && status != "misfit") {
      throw InputError(fmt::format("{}{}FILE that converged, found status \"{}\"", file, expected, status));
    }
    if (fit.at("fitted_numbers").is_null()) {
      throw InputError(file + expected + "FILE that has standard errors, found one without; see its warnings");
    }
    out = numbers_in(fit.at("fitted_numbers"));
    if (status == "misfit") out.notes.emplace_back(misfit_note);
  } catch (const json::exception&) {
    throw InputError(file + expected + "FILE of this version, found one that lacks keys; fit again");
  }
  out.file = file;
  return out.of(scene);
}

}  // namespace poise::app
