#include "identification/assessment/input_readings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "identification/fit/projection.hpp"
#include "motion/time_curve.hpp"
#include "solvers/quintic_spline.hpp"

namespace poise {
namespace {

constexpr std::size_t least_input_readings = 6;

bool is_sampled(const RunInput& input) {
  return input.motion.of != MotionInput::Of::drive && input.motion.curve->breaks().size() >= least_input_readings;
}

/// The smooth curve through the breaks of one made of lines.
std::shared_ptr<const TimeCurve> smooth(const TimeCurve& lines) {
  std::vector<double> values;
  for (const double t : lines.breaks()) values.push_back(lines.at(t));
  return std::make_shared<const TimeCurve>(TimeCurve::along(solvers::interpolating_spline(lines.breaks(), values)));
}

}  // namespace

std::vector<KnownEffect> input_effects(const FitProblem& problem, const Fit& fitted,
                                       const std::vector<Record>& records) {
  Experiment experiment = problem.experiment();
  std::map<std::string, Eigen::VectorXd> sums;  // A^T (e of the smooth curve - e of the lines)
  for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
    std::vector<RunInput>& inputs = experiment.runs[r].inputs;
    if (experiment.runs[r].is_simulated() || std::none_of(inputs.begin(), inputs.end(), is_sampled)) continue;
    const RunModel& run = problem.run(r);
    const std::vector<double>& nuisances = fitted.runs[r].nuisances;
    const LinearRun lines = problem.linearized(r, fitted.parameters, nuisances, &records[r], INFINITY,
                                               problem.accuracy(r), fitted.weighting);
    if (lines.rows.size() == 0) throw std::runtime_error("run \"" + run.run().name + "\": its motion fails");
    const Eigen::MatrixXd a =
        unexplained(lines.rows.middleCols(run.nuisances(), run.unknowns()), lines.rows.leftCols(run.nuisances()));
    for (RunInput& input : inputs) {
      if (!is_sampled(input)) continue;
      const auto as_read = std::exchange(input.motion.curve, smooth(*input.motion.curve));
      const RunModel other(experiment, r, run.numbers(), run.sensor_numbers());
      input.motion.curve = as_read;
      Prediction there;
      other.predict(problem.unknowns_of(r, fitted.parameters).data(), nuisances.data(), INFINITY, problem.accuracy(r),
                    false, there);
      if (!there.ok) throw std::runtime_error("run \"" + run.run().name + "\": " + there.why);
      Eigen::VectorXd change = -lines.rows.col(lines.rows.cols() - 1);
      Eigen::Index row = 0;
      for (std::size_t k = 0; k < records[r].sensors.size(); ++k) {
        for (const double reading : records[r].sensors[k].value) {
          change[row] += (there.reading[static_cast<std::size_t>(row)] - reading) / fitted.weighting.noise[k];
          ++row;
        }
      }
      const auto count = static_cast<Eigen::Index>(problem.parameters().size());
      Eigen::VectorXd& sum = sums.try_emplace(input.path, Eigen::VectorXd::Zero(count)).first->second;
      sum(problem.parameters_of(r)) += a.transpose() * change;
    }
  }
  std::vector<KnownEffect> out;
  for (const auto& [path, sum] : sums) {
    const Eigen::VectorXd change = -fitted.identifiability.covariance * sum;
    out.push_back({path + " between readings", {change.begin(), change.end()}});
  }
  return out;
}

}  // namespace poise
