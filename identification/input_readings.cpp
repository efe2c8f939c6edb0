#include "identification/input_readings.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>

#include "motion/time_curve.hpp"
#include "solvers/linear_algebra.hpp"
#include "solvers/quintic_spline.hpp"

namespace poise {
namespace {

constexpr std::size_t least_readings = 6;

bool is_sampled(const RunInput& input) {
  return input.motion.of != MotionInput::Of::drive && input.motion.curve->breaks().size() >= least_readings;
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
  std::set<std::string> paths;
  for (const Run& run : problem.experiment().runs) {
    if (run.is_simulated()) continue;
    for (const RunInput& input : run.inputs) {
      if (is_sampled(input)) paths.insert(input.path);
    }
  }
  std::vector<KnownEffect> out;
  for (const std::string& path : paths) {
    Experiment smoothed = problem.experiment();
    std::vector<std::size_t> runs;
    for (std::size_t r = 0; r < smoothed.runs.size(); ++r) {
      if (smoothed.runs[r].is_simulated()) continue;
      for (RunInput& input : smoothed.runs[r].inputs) {
        if (input.path != path || !is_sampled(input)) continue;
        input.motion.curve = smooth(*input.motion.curve);
        runs.push_back(r);
      }
    }
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.parameters().size()));
    for (const std::size_t r : runs) {
      const RunModel& run = problem.run(r);
      const RunModel other(smoothed, r, run.numbers(), run.sensor_numbers());
      const std::vector<double>& nuisances = fitted.runs[r].nuisances;
      const LinearRun lines = problem.linearized(r, fitted.parameters, nuisances, &records[r], INFINITY,
                                                 problem.accuracy(r), fitted.weighting);
      Prediction there;
      other.predict(problem.unknowns_of(r, fitted.parameters).data(), nuisances.data(), INFINITY, problem.accuracy(r),
                    false, there);
      if (lines.rows.size() == 0 || !there.ok) {
        throw std::runtime_error("run \"" + run.run().name + "\": " + there.why);
      }
      Eigen::VectorXd e(lines.rows.rows());
      Eigen::Index row = 0;
      for (std::size_t k = 0; k < records[r].sensors.size(); ++k) {
        for (const double reading : records[r].sensors[k].value) {
          e[row] = (there.reading[static_cast<std::size_t>(row)] - reading) / fitted.weighting.noise[k];
          ++row;
        }
      }
      Eigen::MatrixXd a = lines.rows.middleCols(run.nuisances(), run.unknowns());
      if (run.nuisances() > 0) {
        const Eigen::MatrixXd basis =
            solvers::orthonormal_columns(Eigen::MatrixXd(lines.rows.leftCols(run.nuisances())));
        a -= basis * (basis.transpose() * a);
      }
      sum(problem.parameters_of(r)) += a.transpose() * (e - lines.rows.col(lines.rows.cols() - 1));
    }
    const Eigen::VectorXd change = -fitted.identifiability.covariance * sum;
    out.push_back({path + " between readings", {change.begin(), change.end()}});
  }
  return out;
}

}  // namespace poise
