#include "identification/fit/oscillation_start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <ceres/ceres.h>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

/// A record is taken for a damped sine where the relative residual is below this.
constexpr double pure_below = 0.1;

struct DampedSineResidual {
  const std::vector<double>& time;
  const std::vector<double>& reading;

  template <class T>
  bool operator()(const T* p, T* residual) const {
    using std::cos;
    using std::exp;
    using std::sin;
    for (std::size_t i = 0; i < time.size(); ++i) {
      const T envelope = exp(-p[3] * time[i]);
      residual[i] = p[0] + envelope * (p[1] * cos(p[4] * time[i]) + p[2] * sin(p[4] * time[i])) - reading[i];
    }
    return true;
  }
};

double mean_square(const std::vector<double>& y, double mean, std::size_t first, std::size_t last) {
  double sum = 0.0;
  for (std::size_t i = first; i < last; ++i) sum += (y[i] - mean) * (y[i] - mean);
  return sum / static_cast<double>(last - first);
}

/// The equations of all runs, weighted by their reduced masses at the parameters `from`.
std::optional<OscillationStart> solve_oscillations(const FitProblem& problem, const std::vector<DampedSine>& sines,
                                                   const std::vector<double>& from) {
  const auto count = static_cast<Eigen::Index>(from.size());
  OscillationStart out;
  out.parameters = from;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(problem.runs()), count);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(A.rows());
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    const DampedSine& sine = sines[r];
    std::vector<double> unknowns = problem.unknowns_of(r, out.parameters);
    RunModel::Oscillator at = run.oscillator(unknowns.data(), run.equilibrium_at());
    if (!(at.mass > 0) || at.reading_by_z == 0) return std::nullopt;
    double equilibrium = run.equilibrium_at();
    if (run.equilibrium_is_unknown()) {
      // The equilibrium is where the oscillation is centred, in the sensor's reading.
      equilibrium += (sine.offset - at.reading) / at.reading_by_z * at.equilibrium_by_z;
      at = run.oscillator(unknowns.data(), equilibrium);
      if (!(at.mass > 0)) return std::nullopt;
    }
    std::vector<double> nuisances;
    if (run.equilibrium_is_unknown()) nuisances.push_back(equilibrium);
    nuisances.push_back(at.z + (sine.offset + sine.a - at.reading) / at.reading_by_z);
    nuisances.push_back((sine.omega * sine.b - sine.decay * sine.a) / at.reading_by_z);
    out.nuisances.push_back(std::move(nuisances));

    const double omega2 = sine.omega * sine.omega + sine.decay * sine.decay;
    const double weight = 1.0 / (omega2 * at.mass);
    const double damping_weight = 1.0 / (sine.omega * at.mass);
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(r);
    b[row] = -weight * (omega2 * at.mass - at.stiffness);
    b[row + 1] = -damping_weight * (2 * sine.decay * at.mass - at.damping);
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      const int p = problem.parameters_of(r)[i];
      const double step = problem.parameters()[static_cast<std::size_t>(p)].scale;
      std::vector<double> moved = unknowns;
      moved[i] += step;
      const RunModel::Oscillator there = run.oscillator(moved.data(), equilibrium);
      A(row, p) = weight * (omega2 * (there.mass - at.mass) - (there.stiffness - at.stiffness));
      A(row + 1, p) = damping_weight * (2 * sine.decay * (there.mass - at.mass) - (there.damping - at.damping));
    }
  }
  const Eigen::VectorXd change = solvers::minimum_norm_solution(A, b);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(i)];
    double& value = out.parameters[static_cast<std::size_t>(i)];
    value = std::clamp(value + p.scale * change[i], p.min, p.max);
    if (!std::isfinite(value)) return std::nullopt;
  }
  return out;
}

}  // namespace

std::optional<DampedSine> fit_damped_sine(const std::vector<double>& time, const std::vector<double>& reading) {
  const std::size_t n = time.size();
  if (n < 12) return std::nullopt;
  double mean = 0.0;
  for (const double y : reading) mean += y / static_cast<double>(n);
  const double amplitude = std::sqrt(mean_square(reading, mean, 0, n));
  if (!(amplitude > 0)) return std::nullopt;
  // Crossings of the mean count only after the reading was well away from it, so that noise causes none.
  int crossings = 0;
  int side = 0;
  double first = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double distance = reading[i] - mean;
    if (std::abs(distance) < 0.3 * amplitude) continue;
    const int now = distance > 0 ? 1 : -1;
    if (side != 0 && now != side) {
      if (crossings++ == 0) first = time[i];
      last = time[i];
    }
    side = now;
  }
  if (crossings < 3) return std::nullopt;
  const double span = time.back() - time.front();
  const double early = mean_square(reading, mean, 0, n / 2);
  const double late = mean_square(reading, mean, n / 2, n);
  double p[5] = {mean, reading.front() - mean, 0.0, std::max(0.0, std::log(early / late) / span),
                 std::numbers::pi * (crossings - 1) / (last - first)};
  ceres::Problem problem;
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<DampedSineResidual, ceres::DYNAMIC, 5>(
                               new DampedSineResidual{time, reading}, static_cast<int>(n)),
                           nullptr, p);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 40;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  DampedSine out{p[0], p[1], p[2], p[3], p[4], std::sqrt(2 * summary.final_cost / static_cast<double>(n)) / amplitude};
  if (!summary.IsSolutionUsable() || !std::isfinite(out.relative_residual) || !(out.omega > 0)) return std::nullopt;
  return out;
}

std::optional<OscillationStart> start_from_oscillations(const FitProblem& problem, const std::vector<Record>& records) {
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    if (!problem.scales_with_force(static_cast<int>(i))) return std::nullopt;
  }
  const Sensor& sensor = problem.experiment().sensors.front();
  if (!sensor.reads_measure()) return std::nullopt;
  std::vector<DampedSine> sines;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& run = problem.run(r);
    if (run.freedoms() != 1 || !run.has_equilibrium() || !run.start_is_unknown()) return std::nullopt;
    if (run.has_inputs()) return std::nullopt;
    std::vector<double> times = records[r].sensors[0].time;
    for (double& time : times) time -= sensor.delay;
    const std::optional<DampedSine> sine = fit_damped_sine(times, records[r].sensors[0].value);
    // Noise alone may be a large part of a small oscillation.
    if (!sine || sine->relative_residual > pure_below + 2 * sensor.noise / std::hypot(sine->a, sine->b)) {
      return std::nullopt;
    }
    sines.push_back(*sine);
  }
  // The weights of the equations need the reduced masses: first those at the experiment's starts, then those found.
  std::optional<OscillationStart> out = OscillationStart{problem.starts(), {}};
  for (int round = 0; round < 2 && out; ++round) out = solve_oscillations(problem, sines, out->parameters);
  return out;
}

}  // namespace poise
