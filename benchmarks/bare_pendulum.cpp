#include "benchmarks/bare_pendulum.hpp"

#include <algorithm>
#include <cmath>

#include <ceres/ceres.h>

namespace poise::benchmarks {
namespace {

constexpr double longest_step = 1e-3;
constexpr double small_center = 0.01;  // unit of a number that starts from 0

template <class S>
using Numbers = std::array<S, pendulum_numbers>;
template <class S>
using State = std::array<S, 4>;

template <class S>
S dry_friction(const PendulumRig& rig, const S& size, const S& rate) {
  using std::abs;
  using std::tanh;
  const S held = size * tanh(rate / rig.width);
  return rig.fall == 0.0 ? held : held * (1.0 + rig.fall / (1.0 + abs(rate) / rig.fall_rate));
}

/// Lagrange's equations of both arms.
template <class S>
State<S> rates(const PendulumRig& rig, const Numbers<S>& p, const State<S>& y, double torque) {
  using std::cos;
  using std::sin;
  const S c1 = cos(y[0]), c2 = cos(y[1]), s2 = sin(y[1]);
  const S c = cos(y[1] - y[0]), s = sin(y[1] - y[0]);
  const S m11 = p[inertia_1] + rig.mass_1 * p[center_1] * p[center_1] + rig.mass_2 * p[length] * p[length] +
                rig.rotor * rig.gear * rig.gear;
  const S m22 = p[inertia_2] + rig.mass_2 * (p[center_2_x] * p[center_2_x] + p[center_2_y] * p[center_2_y]);
  const S m12 = rig.mass_2 * p[length] * (p[center_2_x] * c - p[center_2_y] * s);
  const S turned = -rig.mass_2 * p[length] * (p[center_2_x] * s + p[center_2_y] * c);  // dm12 / d(difference)
  const S w = y[3] - y[2];
  const S elbow = p[damping_2] * w + dry_friction(rig, p[dry_2], w);
  const S q1 = rig.gear * torque + elbow - p[damping_1] * y[2] - dry_friction(rig, p[dry_1], y[2]) -
               rig.gravity * (rig.mass_1 * p[center_1] + rig.mass_2 * p[length]) * c1 - turned * y[3] * y[3];
  const S q2 = -elbow - rig.gravity * rig.mass_2 * (p[center_2_x] * c2 - p[center_2_y] * s2) + turned * y[2] * y[2];
  const S determinant = m11 * m22 - m12 * m12;
  return {y[2], y[3], (m22 * q1 - m12 * q2) / determinant, (m11 * q2 - m12 * q1) / determinant};
}

template <class S>
State<S> moved(const State<S>& y, double h, const State<S>& by) {
  State<S> out;
  for (std::size_t i = 0; i < 4; ++i) out[i] = y[i] + h * by[i];
  return out;
}

/// Calls `reads(k, state)` at each reading k, between which are `parts` steps.
template <class S, class Reads>
void follow(const PendulumRig& rig, const Numbers<S>& p, State<S> y, const PendulumRecord& record, int parts,
            const Reads& reads) {
  const std::size_t count = record.angle_1.size();
  reads(0, y);
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const double from = record.torque.empty() ? 0.0 : record.torque[k];
    const double rise = record.torque.empty() ? 0.0 : record.torque[k + 1] - from;
    const double h = record.step / parts;
    for (int i = 0; i < parts; ++i) {
      const auto torque = [&](double part) { return from + rise * (i + part) / parts; };
      const State<S> k1 = rates(rig, p, y, torque(0.0));
      const State<S> k2 = rates(rig, p, moved(y, h / 2, k1), torque(0.5));
      const State<S> k3 = rates(rig, p, moved(y, h / 2, k2), torque(0.5));
      const State<S> k4 = rates(rig, p, moved(y, h, k3), torque(1.0));
      for (std::size_t j = 0; j < 4; ++j) y[j] += h / 6 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]);
    }
    reads(k + 1, y);
  }
}

/// Unknowns count in parts of their starts, from these.
double unit_of(double start) { return start != 0.0 ? start : small_center; }

struct Residuals {
  const PendulumRig& rig;
  const PendulumRecord& record;
  const std::vector<PendulumNumber>& unknowns;
  const PendulumValues& known;

  template <class S>
  bool operator()(const S* values, const S* start, S* out) const {
    Numbers<S> p;
    for (std::size_t i = 0; i < known.size(); ++i) p[i] = S(known[i]);
    for (std::size_t i = 0; i < unknowns.size(); ++i) p[unknowns[i]] += values[i] * unit_of(known[unknowns[i]]);
    const int parts = std::max(1, static_cast<int>(std::lround(record.step / longest_step)));
    follow(rig, p, State<S>{start[0], start[1], start[2], start[3]}, record, parts,
           [&](std::size_t k, const State<S>& y) {
             out[2 * k] = y[0] - record.angle_1[k];
             out[2 * k + 1] = y[1] - record.angle_2[k];
           });
    return true;
  }
};

template <int Unknowns>
ceres::CostFunction* cost_of(const PendulumRig& rig, const PendulumRecord& record,
                             const std::vector<PendulumNumber>& unknowns, const PendulumValues& known) {
  return new ceres::AutoDiffCostFunction<Residuals, ceres::DYNAMIC, Unknowns, 4>(
      new Residuals{rig, record, unknowns, known}, 2 * static_cast<int>(record.angle_1.size()));
}

}  // namespace

void move_pendulum(const PendulumRig& rig, const PendulumValues& numbers, const PendulumState& start,
                   PendulumRecord& record) {
  follow(rig, numbers, start, record, static_cast<int>(std::lround(record.step / (0.01 * longest_step))),
         [&](std::size_t k, const PendulumState& y) {
           record.angle_1[k] = y[0];
           record.angle_2[k] = y[1];
         });
}

PendulumFit fit_pendulum(const PendulumRig& rig, const std::vector<PendulumRecord>& records,
                         const std::vector<PendulumNumber>& unknowns, const PendulumValues& numbers,
                         const std::vector<PendulumState>& starts) {
  std::vector<double> values(unknowns.size(), 0.0);
  std::vector<PendulumState> states = starts;
  ceres::Problem problem;
  std::size_t readings = 0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const auto make = unknowns.size() == 7 ? cost_of<7> : unknowns.size() == 8 ? cost_of<8> : cost_of<9>;
    problem.AddResidualBlock(make(rig, records[r], unknowns, numbers), nullptr, values.data(), states[r].data());
    readings += 2 * records[r].angle_1.size();
  }
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    if (unknowns[i] >= damping_1) problem.SetParameterLowerBound(values.data(), static_cast<int>(i), -1.0);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 200;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  PendulumFit out;
  out.numbers = numbers;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    out.numbers[unknowns[i]] += values[i] * unit_of(numbers[unknowns[i]]);
  }
  out.rms = std::sqrt(2 * summary.final_cost / static_cast<double>(readings));
  out.iterations = static_cast<int>(summary.iterations.size());
  out.converged = summary.termination_type == ceres::CONVERGENCE;
  return out;
}

}  // namespace poise::benchmarks
