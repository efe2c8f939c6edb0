#include "identification/assessment/known_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "identification/assessment/private/altered.hpp"
#include "identification/fit/projection.hpp"

namespace poise {
namespace {

/// d e_r/d clock at 1: the readings of run r are those of the motion at `clock` times the times that are written.
Eigen::VectorXd change_by_clock(const FitProblem& problem, const Fit& fitted, const std::vector<Record>& records,
                                std::size_t r) {
  constexpr double step = 1e-4;
  const RunModel& run = problem.run(r);
  const std::vector<double> unknowns = problem.unknowns_of(r, fitted.parameters);
  const auto predicted = [&](double clock) {
    Experiment experiment = problem.experiment();
    stretch_clock(experiment, r, clock);
    const RunModel other(experiment, r, run.numbers(), run.sensor_numbers());
    Prediction out;
    other.predict(unknowns.data(), fitted.runs[r].nuisances.data(), INFINITY, problem.accuracy(r), false, out);
    if (!out.ok) throw std::runtime_error("run \"" + run.run().name + "\": " + out.why);
    return out.reading;
  };
  const std::vector<double> above = predicted(1 + step), below = predicted(1 - step);
  Eigen::VectorXd out(static_cast<Eigen::Index>(above.size()));
  Eigen::Index row = 0;
  for (std::size_t k = 0; k < records[r].sensors.size(); ++k) {
    for (const double read : records[r].sensors[k].value) {
      const auto i = static_cast<std::size_t>(row);
      // What a sensor of impacts reads are times of the clock themselves.
      const double itself = problem.experiment().sensors[k].reads_impacts() ? read : 0.0;
      out[row++] = ((above[i] - below[i]) / (2 * step) - itself) / fitted.weighting.noise[k];
    }
  }
  return out;
}

/// Takes what the noise of inputs does out of the rows of run r, as FitProblem::linearized() does.
void whiten(const Fit& fitted, const std::vector<Record>& records, std::size_t r, Eigen::MatrixXd& rows) {
  const InputErrors* const errors = fitted.weighting.input_errors(r);
  if (errors == nullptr) return;
  std::vector<Eigen::Index> first{0};
  for (const Series& series : records[r].sensors) first.push_back(first.back() + std::ssize(series.value));
  errors->whiten(rows, first, fitted.weighting.noise);
}

}  // namespace

std::vector<KnownEffect> known_effects(const FitProblem& problem, const Fit& fitted,
                                       const std::vector<Record>& records) {
  const Experiment& experiment = problem.experiment();
  const Eigen::Index count = static_cast<Eigen::Index>(problem.parameters().size());
  // The first known number of the same path, as which it counts.
  const auto first_of = [&](const KnownNumber& known) {
    return static_cast<std::size_t>(std::find_if(experiment.known.begin(), experiment.known.end(),
                                                 [&](const KnownNumber& other) { return other.path == known.path; }) -
                                    experiment.known.begin());
  };
  std::map<std::pair<std::size_t, std::string>, Eigen::VectorXd> sums;  // A^T (d e/d number) d
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    std::vector<SceneParameter> numbers = run.numbers();
    std::vector<SensorNumber> sensor_numbers = run.sensor_numbers();
    const auto of_scene = static_cast<Eigen::Index>(numbers.size());
    const auto of_sensors = static_cast<Eigen::Index>(sensor_numbers.size());
    const std::vector<double> unknowns = problem.unknowns_of(r, fitted.parameters);
    std::vector<double> values(unknowns.begin(), unknowns.begin() + of_scene);
    std::vector<double> sensor_values(unknowns.begin() + of_scene, unknowns.end());
    // Known numbers of this run: those of its scene behind its unknowns of the scene, those of sensors likewise.
    std::vector<std::size_t> own, own_of_sensors, of_clock;
    for (std::size_t n = 0; n < experiment.known.size(); ++n) {
      const KnownNumber& known = experiment.known[n];
      if (known.part != run.run().part) continue;
      if (known.of_clock) {
        of_clock.push_back(n);
      } else if (known.of_sensor) {
        own_of_sensors.push_back(n);
        sensor_numbers.push_back(*known.of_sensor);
        sensor_values.push_back(experiment.sensors[known.of_sensor->sensor].number(known.of_sensor->of));
      } else {
        own.push_back(n);
        numbers.push_back(*SceneParameter::find(run.scene(), known.path));
        values.push_back(numbers.back().get(run.scene()));
      }
    }
    const auto known_of_scene = static_cast<Eigen::Index>(own.size());
    own.insert(own.end(), own_of_sensors.begin(), own_of_sensors.end());
    values.insert(values.end(), sensor_values.begin(), sensor_values.end());
    const RunModel extended(experiment, r, numbers, sensor_numbers);
    Prediction prediction;
    extended.predict(values.data(), fitted.runs[r].nuisances.data(), INFINITY, problem.accuracy(r), true, prediction);
    if (!prediction.ok) throw std::runtime_error("run \"" + run.run().name + "\": " + prediction.why);
    const auto rows = static_cast<Eigen::Index>(prediction.reading.size());
    Eigen::MatrixXd jacobian = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        prediction.jacobian.data(), rows, extended.columns());
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < records[r].sensors.size(); ++k) {
      const auto readings = static_cast<Eigen::Index>(extended.times()[k].size());
      jacobian.middleRows(row, readings) /= fitted.weighting.noise[k];
      row += readings;
    }
    whiten(fitted, records, r, jacobian);
    Eigen::MatrixXd a(rows, of_scene + of_sensors);
    a << jacobian.leftCols(of_scene), jacobian.middleCols(of_scene + known_of_scene, of_sensors);
    a = unexplained(std::move(a), jacobian.rightCols(extended.nuisances()));
    const auto add = [&](const KnownNumber& known, const Eigen::VectorXd& by_error) {
      Eigen::VectorXd& sum =
          sums.try_emplace({first_of(known), group_of(known.per, run.run())}, Eigen::VectorXd::Zero(count))
              .first->second;
      sum(problem.parameters_of(r)) += by_error;
    };
    for (std::size_t i = 0; i < own.size(); ++i) {
      const KnownNumber& known = experiment.known[own[i]];
      const auto place = static_cast<Eigen::Index>(i);
      const Eigen::Index column = of_scene + place + (place < known_of_scene ? 0 : of_sensors);
      const double value = values[static_cast<std::size_t>(column)];
      const double deviation = known.relative ? known.deviation * std::abs(value) : known.deviation;
      add(known, a.transpose() * jacobian.col(column) * deviation);
    }
    for (const std::size_t n : of_clock) {
      const KnownNumber& known = experiment.known[n];
      Eigen::MatrixXd change = change_by_clock(problem, fitted, records, r);
      whiten(fitted, records, r, change);
      add(known, a.transpose() * change.col(0) * known.deviation);
    }
  }
  std::vector<KnownEffect> out;
  for (const auto& [place, sum] : sums) {
    const Eigen::VectorXd change = -fitted.identifiability.covariance * sum;
    const std::string& path = experiment.known[place.first].path;
    out.push_back({place.second.empty() ? path : path + " (" + place.second + ")", {change.begin(), change.end()}});
  }
  return out;
}

void add_known_effects(const std::vector<KnownEffect>& effects, Fit& fitted) {
  for (std::size_t p = 0; p < fitted.estimates.size(); ++p) {
    Estimate& estimate = fitted.estimates[p];
    double squares = 0.0;
    for (const KnownEffect& effect : effects) squares += effect.change[p] * effect.change[p];
    if (!(squares > 0) || !std::isfinite(estimate.standard_error) || !(estimate.standard_error > 0)) continue;
    const double total = std::hypot(estimate.standard_error, std::sqrt(squares));
    const double longer = total / estimate.standard_error;
    estimate.standard_error = total;
    estimate.low = estimate.value - longer * (estimate.value - estimate.low);
    estimate.high = estimate.value + longer * (estimate.high - estimate.value);
  }
}

}  // namespace poise
