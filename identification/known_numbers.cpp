#include "identification/known_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "identification/projection.hpp"

namespace poise {

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
    std::vector<double> values = problem.unknowns_of(r, fitted.parameters);
    const auto of_scene = static_cast<Eigen::Index>(numbers.size());
    std::vector<std::size_t> own;  // known numbers of this run's scene, behind its unknowns of the scene
    for (std::size_t n = 0; n < experiment.known.size(); ++n) {
      const KnownNumber& known = experiment.known[n];
      if (known.part != run.run().part) continue;
      own.push_back(n);
      numbers.push_back(*SceneParameter::find(run.scene(), known.path));
      values.insert(values.begin() + static_cast<std::ptrdiff_t>(numbers.size()) - 1, numbers.back().get(run.scene()));
    }
    const RunModel extended(experiment, r, numbers, run.sensor_numbers());
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
    const Eigen::Index unknowns = run.unknowns();
    const Eigen::Index of_sensors = unknowns - of_scene;
    Eigen::MatrixXd a(rows, unknowns);
    a.leftCols(of_scene) = jacobian.leftCols(of_scene);
    a.rightCols(of_sensors) = jacobian.middleCols(extended.unknowns() - of_sensors, of_sensors);
    a = unexplained(std::move(a), jacobian.rightCols(extended.nuisances()));
    for (std::size_t i = 0; i < own.size(); ++i) {
      const KnownNumber& known = experiment.known[own[i]];
      const auto column = of_scene + static_cast<Eigen::Index>(i);
      const double value = values[static_cast<std::size_t>(column)];
      const double deviation = known.relative ? known.deviation * std::abs(value) : known.deviation;
      Eigen::VectorXd& sum =
          sums.try_emplace({first_of(known), group_of(known.per, run.run())}, Eigen::VectorXd::Zero(count))
              .first->second;
      sum(problem.parameters_of(r)) += a.transpose() * jacobian.col(column) * deviation;
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
