#include "app/results/identification/fitted_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "model/input_error.hpp"
#include "model/parameters.hpp"
#include "model/text_file.hpp"
#include "solvers/not_a_number.hpp"

namespace poise::app {
namespace {

using nlohmann::json;
using Bound = FittedNumbers::Number::Bound;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<double> listed_values(const VectorXd& v) { return {v.begin(), v.end()}; }

/// An uncertain number that the fit took as known and that a scene may have too.
struct KnownOfScene {
  std::string path;
  double value = 0.0, deviation = 0.0, unit = 1.0;
  const KnownEffect* effect = nullptr;
};

std::vector<KnownOfScene> known_of_scene(const FitProblem& problem, const Identification& answer) {
  const Experiment& experiment = problem.experiment();
  std::vector<KnownOfScene> out;
  for (const KnownEffect& effect : answer.known) {
    const auto known = std::find_if(experiment.known.begin(), experiment.known.end(), [&](const KnownNumber& one) {
      return one.path == effect.name && one.per.empty() && !one.of_sensor;
    });
    if (known == experiment.known.end()) continue;
    const Scene& scene = experiment.scene_of(known->part);
    const ParameterRow row = parameter(scene, known->path);
    const double value = value_at(scene, row.place).value_or(not_a_number);
    out.push_back({known->path, value, known->relative ? known->deviation * std::abs(value) : known->deviation,
                   row.dimension.unit(scene.units), &effect});
  }
  return out;
}

/// By how much more the standard error of an estimate is than that of the parabola, where its cost is none.
VectorXd longer_by_curvature(const Identification& answer) {
  const Fit& fitted = answer.fit;
  VectorXd out = VectorXd::Ones(static_cast<Index>(fitted.estimates.size()));
  for (std::size_t p = 0; p < fitted.estimates.size(); ++p) {
    const Estimate& estimate = fitted.estimates[p];
    if (!estimate.is_curved || estimate.at_bound || !(fitted.errors.error[p] > 0)) continue;
    double square = estimate.standard_error * estimate.standard_error;
    for (const KnownEffect& effect : answer.known) square -= effect.change[p] * effect.change[p];
    for (const KnownEffect& effect : answer.inputs) square -= effect.change[p] * effect.change[p];
    const double longer = std::sqrt(std::max(0.0, square)) / fitted.errors.error[p];
    if (std::isfinite(longer)) out[static_cast<Index>(p)] = std::max(1.0, longer);
  }
  return out;
}

std::string bound_of(const FitProblem& problem, const Fit& fitted, std::size_t p) {
  if (!fitted.estimates[p].at_bound) return "";
  const Parameter& parameter = problem.parameters()[p];
  return fitted.parameters[p] - parameter.min < parameter.max - fitted.parameters[p] ? "least" : "most";
}

}  // namespace

void add_fitted_numbers(Group& content, const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  if (!fitted.usable() || !fitted.identifiability.ok || fitted.errors.error.empty()) {
    content.data("fitted_numbers", Value());
    return;
  }
  const std::vector<KnownOfScene> known = known_of_scene(problem, answer);
  const auto own = static_cast<Index>(fitted.estimates.size());
  const Index all = own + static_cast<Index>(known.size());
  // Errors of known numbers add to those of the estimates, with which they are correlated.
  MatrixXd from_known(all, static_cast<Index>(answer.known.size() + answer.inputs.size()));
  from_known.setZero();
  Index column = 0;
  for (const std::vector<KnownEffect>* effects : {&answer.known, &answer.inputs}) {
    for (const KnownEffect& effect : *effects) {
      from_known.col(column).head(own) = Eigen::Map<const VectorXd>(effect.change.data(), own);
      for (std::size_t k = 0; k < known.size(); ++k) {
        if (known[k].effect == &effect) from_known(own + static_cast<Index>(k), column) = known[k].deviation;
      }
      ++column;
    }
  }
  const VectorXd longer = longer_by_curvature(answer);
  const auto whole = [&](const MatrixXd& of_estimates) {
    MatrixXd out = from_known * from_known.transpose();
    out.topLeftCorner(own, own) += longer.asDiagonal() * of_estimates * longer.asDiagonal();
    return out;
  };
  const bool scatters = fitted.errors.leading == StandardErrors::Kind::runs;
  const MatrixXd covariance = whole(fitted.errors.by_readings);
  const MatrixXd by_runs =
      scatters ? whole(fitted.errors.by_runs * fitted.errors.by_runs.transpose()) : MatrixXd(all, 0);
  VectorXd unit(all), scale(own);
  for (Index i = 0; i < own; ++i) {
    const auto p = static_cast<std::size_t>(i);
    const Unknown& unknown = problem.unknown_of(p);
    unit[i] = unknown.unit;
    scale[i] = problem.scale_of(p, fitted.parameters[p] + unknown.includes).size_or(unknown.unit);
  }
  for (std::size_t k = 0; k < known.size(); ++k) unit[own + static_cast<Index>(k)] = known[k].unit;
  const MatrixXd per_unit = unit.cwiseInverse().asDiagonal();

  Group& group = content.group("fitted_numbers", "", Verbosity::data);
  group.data("degrees_of_freedom", fitted.errors.readings_degrees);
  Branch& numbers = group.array("numbers");
  for (Index i = 0; i < all; ++i) {
    const auto p = static_cast<std::size_t>(i);
    Group& one = numbers.parts.emplace_back();
    if (i < own) {
      const Unknown& unknown = problem.unknown_of(p);
      one.data("name", fitted.estimates[p].name);
      one.data("path", unknown.path);
      one.data("kind", unknown.of_sensor ? "sensor" : unknown.per.empty() ? "scene" : "several");
      one.data("value", fitted.parameters[p] / unit[i]);
      const std::string bound = bound_of(problem, fitted, p);
      one.data("bound", bound.empty() ? Value() : Value(bound));
      one.data("degrees_by_runs",
               scatters && !std::isnan(fitted.errors.runs[p]) ? Value(fitted.errors.runs_degrees[p]) : Value());
    } else {
      const KnownOfScene& number = known[p - static_cast<std::size_t>(own)];
      one.data("name", number.path);
      one.data("path", number.path);
      one.data("kind", "known");
      one.data("value", number.value / number.unit);
      one.data("bound", Value());
      one.data("degrees_by_runs", Value());
    }
    one.data("unit_si", unit[i]);
    one.data("covariance", listed_values(per_unit * covariance.col(i) / unit[i]));
    one.data("covariance_by_runs", scatters ? Value(listed_values(per_unit * by_runs.col(i) / unit[i])) : Value());
  }
  Branch& directions = group.array("unknown");
  const auto add = [&](const VectorXd& part, const VectorXd& error, const std::string& words) {
    Group& one = directions.parts.emplace_back();
    one.data("part", listed_values(per_unit * part));
    one.data("error", listed_values(per_unit * error));
    one.data("words", words);
  };
  VectorXd part = VectorXd::Zero(all), error = VectorXd::Zero(all);
  for (const Identifiability::Direction& direction : fitted.identifiability.null_directions) {
    if (direction.error.empty()) continue;  // weak: its parameters are withheld below
    part.head(own) = scale.cwiseProduct(Eigen::Map<const VectorXd>(direction.part.data(), own));
    error.head(own) = scale.cwiseProduct(Eigen::Map<const VectorXd>(direction.error.data(), own));
    add(part, error, direction.words);
  }
  for (Index i = 0; i < own; ++i) {
    const auto p = static_cast<std::size_t>(i);
    const Estimate& estimate = fitted.estimates[p];
    if (!estimate.withheld || estimate.at_bound || std::isinf(fitted.identifiability.standard_error[p])) continue;
    add(unit[i] * VectorXd::Unit(all, i), VectorXd::Zero(all),
        fmt::format("{} is withheld: {}", estimate.name, estimate.why));
  }
}

namespace {

/// What null stands for is not known.
double or_not_known(const json& value) { return value.is_null() ? not_a_number : value.get<double>(); }

VectorXd vector_of(const json& values) {
  VectorXd out(static_cast<Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) out[static_cast<Index>(i)] = or_not_known(values[i]);
  return out;
}

FittedNumbers numbers_in(const json& fit) {
  FittedNumbers out;
  const json& found = fit.at("fitted_numbers");
  const json& numbers = found.at("numbers");
  const auto count = static_cast<Index>(numbers.size());
  out.covariance.resize(count, count);
  out.degrees = or_not_known(found.at("degrees_of_freedom"));
  VectorXd unit(count);
  for (Index i = 0; i < count; ++i) unit[i] = numbers[static_cast<std::size_t>(i)].at("unit_si").get<double>();
  for (Index i = 0; i < count; ++i) {
    const json& one = numbers[static_cast<std::size_t>(i)];
    FittedNumbers::Number& number = out.numbers.emplace_back();
    number.name = one.at("name").get<std::string>();
    number.path = one.at("path").get<std::string>();
    number.value = one.at("value").get<double>() * unit[i];
    const json& bound = one.at("bound");
    if (!bound.is_null()) number.bound = bound.get<std::string>() == "least" ? Bound::least : Bound::most;
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

FittedNumbers read_fitted_numbers(const std::string& file, const Scene& scene) {
  const std::string expected = ": expected the result of poise identify with --json ";
  const json fit = json::parse(read_text_file(file), nullptr, false);
  if (!fit.is_object() || !fit.contains("estimates") || !fit.contains("status")) {
    throw InputError(file + expected + "FILE, found another text");
  }
  FittedNumbers out;
  std::vector<std::string> kinds;
  try {
    const std::string status = fit.at("status");
    if (status != "converged" && status != "misfit") {
      throw InputError(fmt::format("{}{}FILE that converged, found status \"{}\"", file, expected, status));
    }
    if (fit.at("fitted_numbers").is_null()) {
      throw InputError(file + expected + "FILE that has standard errors, found one without; see its warnings");
    }
    out = numbers_in(fit);
    for (const json& one : fit.at("fitted_numbers").at("numbers")) kinds.push_back(one.at("kind").get<std::string>());
    if (status == "misfit") {
      out.notes.push_back("The fit has a misfit: intervals do not contain what its model lacks.");
    }
  } catch (const json::exception&) {
    throw InputError(file + expected + "FILE of this version, found one that lacks keys; fit again");
  }
  out.file = file;
  for (std::size_t i = out.numbers.size(); i-- > 0;) {
    FittedNumbers::Number& number = out.numbers[i];
    const std::string& kind = kinds[i];
    const std::optional<ParameterRow> row = find_parameter(scene, number.path);
    const double value = row ? value_at(scene, row->place).value_or(not_a_number) : not_a_number;
    const bool is_another = kind == "known" && !(std::abs(value - number.value) <= 1e-12 * std::abs(number.value));
    if (kind == "several") {
      out.notes.insert(
          out.notes.begin(),
          fmt::format("{} keeps the scene's value, which counts as exact: the fit has one for each run.", number.name));
    }
    if (kind == "sensor" || kind == "several" || is_another) {
      out.leave_out(i);
      continue;
    }
    if (!row) {
      try {
        parameter(scene, number.path);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {} ({}) is no number of {}: {}", file, number.name, number.path, scene.file,
                                     error.what()));
      }
    }
    number.path = row->path.text();
    number.dimension = row->dimension;
  }
  return out;
}

}  // namespace poise::app
