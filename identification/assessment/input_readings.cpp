#include "identification/assessment/input_readings.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
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

/// A smooth curve along the readings of an input, and straight lines between its values at these: the lines that join
/// the readings, or, where these have noise, lines without it.
struct SmoothAndLines {
  std::shared_ptr<const TimeCurve> smooth, lines;
};

std::optional<SmoothAndLines> curves_of(const RunInput& input) {
  const std::vector<double>& times = input.motion.curve->breaks();
  std::vector<double> values;
  for (const double t : times) values.push_back(input.motion.curve->at(t));
  if (!(input.noise > 0)) {
    return SmoothAndLines{
        std::make_shared<const TimeCurve>(TimeCurve::along(solvers::interpolating_spline(times, values))),
        input.motion.curve};
  }
  const std::optional<solvers::QuinticSpline> spline = solvers::smoothing_spline(times, values, input.noise);
  if (!spline) return std::nullopt;
  auto smooth = std::make_shared<const TimeCurve>(TimeCurve::along(*spline));
  for (std::size_t i = 0; i < times.size(); ++i) values[i] = smooth->at(times[i]);
  return SmoothAndLines{std::move(smooth), std::make_shared<const TimeCurve>(TimeCurve::through(times, values))};
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
      const std::optional<SmoothAndLines> curves = curves_of(input);
      if (!curves) continue;
      const auto as_read = input.motion.curve;
      const auto predicted = [&](const std::shared_ptr<const TimeCurve>& curve) {
        input.motion.curve = curve;
        const RunModel other(experiment, r, run.numbers(), run.sensor_numbers());
        input.motion.curve = as_read;
        Prediction out;
        other.predict(problem.unknowns_of(r, fitted.parameters).data(), nuisances.data(), INFINITY, problem.accuracy(r),
                      false, out);
        if (!out.ok) throw std::runtime_error("run \"" + run.run().name + "\": " + out.why);
        return out.reading;
      };
      const std::vector<double> smooth = predicted(curves->smooth), straight = predicted(curves->lines);
      Eigen::MatrixXd change(lines.rows.rows(), 1);
      for (std::size_t k = 0; k + 1 < lines.first.size(); ++k) {
        for (Eigen::Index row = lines.first[k]; row < lines.first[k + 1]; ++row) {
          const auto i = static_cast<std::size_t>(row);
          change(row, 0) = (smooth[i] - straight[i]) / fitted.weighting.noise[k];
        }
      }
      if (const InputErrors* const errors = fitted.weighting.input_errors(r)) {
        errors->whiten(change, lines.first, fitted.weighting.noise);
      }
      const auto count = static_cast<Eigen::Index>(problem.parameters().size());
      Eigen::VectorXd& sum = sums.try_emplace(input.path, Eigen::VectorXd::Zero(count)).first->second;
      sum(problem.parameters_of(r)) += a.transpose() * change.col(0);
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
