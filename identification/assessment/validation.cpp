#include "identification/assessment/validation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "identification/fit/first_readings.hpp"
#include "identification/fit/projection.hpp"
#include "model/nearest_name.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

const FittedModel::Sensor* sensor_of(const FittedModel& model, const std::string& name) {
  const auto at = std::find_if(model.sensors.begin(), model.sensors.end(),
                               [&](const FittedModel::Sensor& sensor) { return sensor.name == name; });
  return at == model.sensors.end() ? nullptr : &*at;
}

/// Places of the experiment's parameters in the model.
std::vector<Eigen::Index> places_in(const FitProblem& problem, const FittedModel& model) {
  std::vector<std::string> valid;
  for (const FittedModel::Parameter& parameter : model.parameters) valid.push_back(parameter.name);
  std::vector<Eigen::Index> out;
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    const std::string& name = problem.parameters()[p].name;
    const Unknown& unknown = problem.unknown_of(p);
    const auto fail = [&](const std::string& message) {
      throw InputError(
          fmt::format("{}:{}: unknown \"{}\": {}", problem.experiment().file, unknown.line, name, message));
    };
    const auto at = std::find(valid.begin(), valid.end(), name);
    if (at == valid.end()) {
      fail(fmt::format("expected the name of an estimate in {}{}; take it out, its value is then that of the scene",
                       model.file, did_you_mean_or_list(name, valid)));
    }
    const auto& found = model.parameters[static_cast<std::size_t>(at - valid.begin())];
    if (found.path != unknown.path) {
      fail(fmt::format("expected the path {} as in {}, found {}", found.path, model.file, unknown.path));
    }
    if (!found.withheld.empty() || !std::isfinite(found.value)) {
      fail(fmt::format("expected an estimate in {}, it is withheld: {}; take it out and give its value with set",
                       model.file, found.withheld));
    }
    out.push_back(at - valid.begin());
  }
  return out;
}

/// Per sensor: root mean square of the part of the predictions that the uncertainty of the parameters explains.
std::vector<double> explained(const FitProblem& problem, const Fit& fitted, const std::vector<Record>& records,
                              const Eigen::MatrixXd& covariance, Starts starts) {
  const std::size_t sensors = problem.experiment().sensors.size();
  std::vector<double> squares(sensors, 0.0), readings(sensors, 0.0);
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const LinearRun run = problem.linearized(r, fitted.parameters, fitted.runs[r].nuisances, &records[r], INFINITY,
                                             problem.accuracy(r), fitted.weighting);
    if (run.rows.size() == 0) return std::vector<double>(sensors, not_a_number);
    const Eigen::Index nuisances = problem.run(r).nuisances();
    Eigen::MatrixXd a = run.rows.middleCols(nuisances, problem.run(r).unknowns());
    if (starts == Starts::fitted) a = unexplained(std::move(a), run.rows.leftCols(nuisances));
    const std::vector<int>& used = problem.parameters_of(r);
    const Eigen::MatrixXd own = covariance(used, used);
    const Eigen::VectorXd variance = (a * own).cwiseProduct(a).rowwise().sum();
    for (std::size_t k = 0; k < sensors; ++k) {
      const auto count = run.first[k + 1] - run.first[k];
      squares[k] += variance.segment(run.first[k], count).sum();
      readings[k] += static_cast<double>(count);
    }
  }
  std::vector<double> out;
  for (std::size_t k = 0; k < sensors; ++k) {
    out.push_back(fitted.weighting.noise[k] * std::sqrt(std::max(0.0, squares[k]) / readings[k]));
  }
  return out;
}

/// Root mean squares of a prediction over others, of the sensors that have both, each over its noise.
std::optional<double> ratio_of(const Fit& predicted, const std::vector<double>& rms) {
  double held_out = 0.0, own = 0.0;
  for (std::size_t k = 0; k < rms.size(); ++k) {
    const double noise = predicted.weighting.noise[k];
    if (!(rms[k] > 0) || !std::isfinite(predicted.rms[k])) continue;
    held_out += std::pow(predicted.rms[k] / noise, 2);
    own += std::pow(rms[k] / noise, 2);
  }
  return own > 0 ? std::optional(std::sqrt(held_out / own)) : std::nullopt;
}

}  // namespace

void take_noise(const FittedModel& model, Experiment& experiment) {
  for (Sensor& sensor : experiment.sensors) {
    const FittedModel::Sensor* const found = sensor_of(model, sensor.name);
    if (sensor.noise_known || found == nullptr || !(found->noise > 0)) continue;
    sensor.noise = found->noise;
    sensor.noise_known = true;
  }
}

std::vector<double> parameters_of(const FitProblem& problem, const FittedModel& model) {
  std::vector<double> out;
  for (const Eigen::Index at : places_in(problem, model)) {
    out.push_back(model.parameters[static_cast<std::size_t>(at)].value);
  }
  return out;
}

Validation validate(const FitProblem& problem, const std::vector<Record>& records, const FittedModel& model,
                    Starts starts, const FitOptions& options) {
  Validation out;
  const std::vector<Eigen::Index> places = places_in(problem, model);
  out.covariance = model.covariance(places, places);
  Fit from;
  from.parameters = parameters_of(problem, model);
  from.weighting = problem.weighting();
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    const std::vector<double> unknowns = problem.unknowns_of(r, from.parameters);
    RunFit& start = from.runs.emplace_back();
    start.nuisances = starts == Starts::measured ? started_from_readings(run, unknowns, run.released(), records[r])
                                                 : first_guess(run, unknowns, records[r]);
  }
  FitOptions with = options;
  with.from = &from;
  with.holds_starts = starts == Starts::measured;
  for (std::size_t p = 0; p < from.parameters.size(); ++p) {
    with.held.emplace_back(static_cast<int>(p), from.parameters[p]);
  }
  out.fit = fit(problem, records, with);
  out.fit.start =
      starts == Starts::measured ? "from the first readings of every run" : "fitted, with the parameters held";
  if (!out.fit.usable()) return out;
  if (out.fit.status == FitStatus::misfit) {
    out.fit.why = fmt::format("the residuals are {:.3g} times the noise", out.fit.residual_over_noise);
  }
  out.fit.errors.disagreement.clear();  // of estimates, which there are none of
  out.from_parameters = explained(problem, out.fit, records, out.covariance, starts);
  for (const Sensor& sensor : problem.experiment().sensors) {
    const FittedModel::Sensor* const found = sensor_of(model, sensor.name);
    out.identification.push_back(found != nullptr ? found->rms : not_a_number);
  }
  out.ratio = ratio_of(out.fit, out.identification);
  with.from = &out.fit;  // whose starts are no guesses any more
  with.held.clear();
  const Fit again = fit(problem, records, with);
  if (!again.usable()) return out;
  out.refitted = again.rms;
  out.ratio_refitted = ratio_of(out.fit, out.refitted);
  return out;
}

}  // namespace poise
