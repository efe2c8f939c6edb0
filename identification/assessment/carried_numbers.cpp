#include "identification/assessment/carried_numbers.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "model/parameters.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using FittedNumber = FittedNumbers::Number;

/// An uncertain number that the fit took as known and that a scene may have too.
struct KnownOfScene {
  std::string path;
  Dimension dimension{};
  double value = 0.0, deviation = 0.0, unit = 1.0;
  const KnownEffect* effect = nullptr;
};

std::vector<KnownOfScene> known_of_scene(const FitProblem& problem, const Identification& answer) {
  const Experiment& experiment = problem.experiment();
  std::vector<KnownOfScene> out;
  for (const KnownEffect& effect : answer.known) {
    const auto known = std::find_if(experiment.known.begin(), experiment.known.end(), [&](const KnownNumber& one) {
      return one.path == effect.name && one.per.empty() && !one.of_sensor && !one.of_clock;
    });
    if (known == experiment.known.end()) continue;
    const Scene& scene = experiment.scene_of(known->part);
    const ParameterRow row = parameter(scene, known->path);
    const double value = value_at(scene, row.place).value_or(not_a_number);
    out.push_back({known->path, row.dimension, value,
                   known->relative ? known->deviation * std::abs(value) : known->deviation,
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

FittedNumber::Bound bound_of(const FitProblem& problem, const Fit& fitted, std::size_t p) {
  if (!fitted.estimates[p].at_bound) return FittedNumber::Bound::none;
  const Parameter& range = problem.parameters()[p];
  return fitted.parameters[p] - range.min < range.max - fitted.parameters[p] ? FittedNumber::Bound::least
                                                                             : FittedNumber::Bound::most;
}

}  // namespace

std::optional<FittedNumbers> carried_numbers(const FitProblem& problem, const Identification& answer) {
  const Fit& fitted = answer.fit;
  if (!fitted.usable() || !fitted.identifiability.ok || fitted.errors.error.empty()) return std::nullopt;
  FittedNumbers out;
  out.degrees = fitted.errors.readings_degrees;
  if (fitted.status == FitStatus::misfit) {
    out.notes.emplace_back(misfit_note);
  }
  const bool scatters = fitted.errors.leading == StandardErrors::Kind::runs;
  const auto own = static_cast<Index>(fitted.estimates.size());
  for (std::size_t p = 0; p < fitted.estimates.size(); ++p) {
    const Unknown& unknown = problem.unknown_of(p);
    FittedNumber& number = out.numbers.emplace_back();
    number.name = fitted.estimates[p].name;
    number.path = unknown.path;
    number.dimension = problem.dimension(static_cast<int>(p));
    number.value = fitted.parameters[p];
    number.unit = unknown.unit;
    number.bound = bound_of(problem, fitted, p);
    number.origin = unknown.of_sensor     ? FittedNumber::Origin::sensor
                    : unknown.per.empty() ? FittedNumber::Origin::estimated
                                          : FittedNumber::Origin::several;
    const bool known = scatters && !std::isnan(fitted.errors.runs[p]);
    out.degrees_by_runs.push_back(known ? fitted.errors.runs_degrees[p] : not_a_number);
  }
  const std::vector<KnownOfScene> known = known_of_scene(problem, answer);
  for (const KnownOfScene& one : known) {
    FittedNumber& number = out.numbers.emplace_back();
    number.name = number.path = one.path;
    number.dimension = one.dimension;
    number.value = one.value;
    number.unit = one.unit;
    number.origin = FittedNumber::Origin::taken;
    out.degrees_by_runs.push_back(not_a_number);
  }
  // Errors of known numbers add to those of the estimates, with which they are correlated.
  const auto all = static_cast<Index>(out.numbers.size());
  MatrixXd from_known = MatrixXd::Zero(all, static_cast<Index>(answer.known.size() + answer.inputs.size()));
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
    MatrixXd v = from_known * from_known.transpose();
    v.topLeftCorner(own, own) += longer.asDiagonal() * of_estimates * longer.asDiagonal();
    return v;
  };
  out.covariance = whole(fitted.errors.by_readings);
  if (scatters) out.by_runs = whole(fitted.errors.by_runs * fitted.errors.by_runs.transpose());

  out.unknown = nulls_of(problem, fitted.parameters, fitted.identifiability);
  for (FittedNumbers::Direction& direction : out.unknown) {
    direction.part.conservativeResizeLike(VectorXd::Zero(all));
    direction.error.conservativeResizeLike(VectorXd::Zero(all));
  }
  for (Index i = 0; i < own; ++i) {
    const auto p = static_cast<std::size_t>(i);
    const Estimate& estimate = fitted.estimates[p];
    if (!estimate.withheld || estimate.at_bound || std::isinf(fitted.identifiability.standard_error[p])) continue;
    out.unknown.push_back({out.numbers[p].unit * VectorXd::Unit(all, i), VectorXd::Zero(all),
                           fmt::format("{} is withheld, {}", estimate.name, estimate.why)});
  }
  return out;
}

std::vector<FittedNumbers::Direction> nulls_of(const FitProblem& problem, const std::vector<double>& parameters,
                                               const Identifiability& found) {
  std::vector<FittedNumbers::Direction> out;
  const auto count = static_cast<Index>(parameters.size());
  VectorXd scale(count);
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Unknown& unknown = problem.unknown_of(p);
    scale[static_cast<Index>(p)] = problem.scale_of(p, parameters[p] + unknown.includes).size_or(unknown.unit);
  }
  for (const Identifiability::Direction& direction : found.null_directions) {
    if (direction.error.empty()) continue;  // a direction with too little effect
    out.push_back({scale.cwiseProduct(Eigen::Map<const VectorXd>(direction.part.data(), count)),
                   scale.cwiseProduct(Eigen::Map<const VectorXd>(direction.error.data(), count)), direction.words});
  }
  return out;
}

}  // namespace poise
