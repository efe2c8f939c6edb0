#include "tests/support/slow_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"
#include "tests/support/closure_rows.hpp"

namespace poise::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd as_vector(const std::vector<double>& x) {
  return Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}
std::vector<double> as_list(const VectorXd& x) { return {x.data(), x.data() + x.size()}; }

// How far a stop is overrun, with the sign of the side; 0 within its limits.
double overrun(const Mechanism<double>& m, const DensePoint<double>& at, int stop) {
  const double g = at.constraint[m.stop_row(stop)];
  return std::max(0.0, g - m.upper()[stop]) + std::min(0.0, g - m.lower()[stop]);
}

// Shortest steps onto the loops and onto the stops that are overrun.
VectorXd closed(const Mechanism<double>& m, VectorXd x) {
  for (int k = 0; k < 4; ++k) {
    std::vector<int> rows = closure_rows(m);
    const DensePoint<double> all(m, as_list(x), rows);
    for (int s = 0; s < m.stops(); ++s) {
      if (overrun(m, all, s) != 0.0) rows.push_back(m.stop_row(s));
    }
    if (rows.empty()) return x;
    const DensePoint<double> at(m, as_list(x), rows);
    VectorXd gap(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const int row = rows[r];
      gap[static_cast<Eigen::Index>(r)] =
          row < m.equalities() ? at.constraint[row] : overrun(m, at, row - m.equalities());
    }
    if (gap.cwiseAbs().maxCoeff() < 1e-14) return x;
    x -= solvers::minimum_norm_solution<double>(at.jacobian, gap, solvers::known_to::path);
  }
  return x;
}

VectorXd projected_force(const DensePoint<double>& at) {
  const MatrixXd basis = at.jacobian.rows() > 0 ? solvers::null_space<double>(at.jacobian, solvers::known_to::path)
                                                : MatrixXd(MatrixXd::Identity(at.force.size(), at.force.size()));
  return -(basis * (basis.transpose() * at.force));
}

// Of all velocities that lead into no stop at its limit the one nearest to the force, by trying which stops press.
VectorXd velocity(const Mechanism<double>& m, const VectorXd& x) {
  const DensePoint<double> free(m, as_list(x), closure_rows(m));
  std::vector<int> touched;
  std::vector<double> side;
  for (int s = 0; s < m.stops(); ++s) {
    const double g = free.constraint[m.stop_row(s)];
    if (g > m.upper()[s] - 1e-7) {
      touched.push_back(s);
      side.push_back(1.0);
    } else if (g < m.lower()[s] + 1e-7) {
      touched.push_back(s);
      side.push_back(-1.0);
    }
  }
  VectorXd best = VectorXd::Zero(x.size());
  double nearest = std::numeric_limits<double>::infinity();
  for (unsigned chosen = 0; chosen < 1U << touched.size(); ++chosen) {
    std::vector<int> rows = closure_rows(m);
    for (std::size_t k = 0; k < touched.size(); ++k) {
      if ((chosen >> k & 1U) != 0U) rows.push_back(m.stop_row(touched[k]));
    }
    const VectorXd v = projected_force(DensePoint<double>(m, as_list(x), rows));
    bool allowed = true;
    for (std::size_t k = 0; k < touched.size(); ++k) {
      const DensePoint<double> stop(m, as_list(x), {m.stop_row(touched[k])});
      allowed = allowed && side[k] * stop.jacobian.row(0).dot(v) <= 1e-9 * (1.0 + v.norm());
    }
    const double off = (v + free.force).norm();
    if (!allowed || off >= nearest) continue;
    nearest = off;
    best = v;
  }
  return best;
}

}  // namespace

SlowMotion slow_motion_along_curve(const StaticModel& model, const std::vector<double>& x, double step, double far) {
  const Mechanism<double>& m = model.mechanism();
  const std::vector<int> rows = closure_rows(m);
  const VectorXd start = as_vector(x);
  VectorXd now = start;
  VectorXd last = VectorXd::Zero(start.size());
  std::vector<double> before(m.constraints());
  for (int k = 0; k < static_cast<int>(6.0 * far / step); ++k) {
    for (int closing = 0; closing < 6; ++closing) {
      const DensePoint<double> open(m, as_list(now), rows);
      const VectorXd gap = Eigen::Map<const VectorXd>(open.constraint.data(), open.jacobian.rows());
      if (gap.size() == 0 || gap.cwiseAbs().maxCoeff() < 1e-13) break;
      now -= solvers::minimum_norm_solution<double>(open.jacobian, gap, solvers::known_to::path);
    }
    const DensePoint<double> at(m, as_list(now), rows);
    for (int s = 0; s < m.stops() && k > 0; ++s) {
      const double g = at.constraint[m.stop_row(s)];
      const double rate = g - before[m.stop_row(s)];
      if ((g >= m.upper()[s] - 1e-9 && rate > 1e-9 * step) || (g <= m.lower()[s] + 1e-9 && rate < -1e-9 * step)) {
        return {SlowMotion::End::rest, as_list(now)};
      }
    }
    before = at.constraint;
    const VectorXd v = projected_force(at);
    if (v.norm() == 0.0 || v.dot(last) < 0.0) return {SlowMotion::End::rest, as_list(now - 0.5 * step * last)};
    if ((now - start).cwiseAbs().maxCoeff() > far) return {SlowMotion::End::far, as_list(now)};
    last = v.normalized();
    now += step * last;
  }
  return {SlowMotion::End::steps, as_list(now)};
}

SlowMotion slow_motion(const StaticModel& model, const std::vector<double>& x, const std::vector<double>& goal,
                       double part, double near, double far, int most_steps) {
  const Mechanism<double>& m = model.mechanism();
  const VectorXd start = as_vector(x);
  const VectorXd end = as_vector(goal);
  VectorXd now = start;
  double h = 0.0;
  double first = 0.0;
  for (int k = 0; k < most_steps; ++k) {
    if (k % 10 == 0) {
      const ReducedHessian hessian(m, as_list(now), closure_rows(m));
      h = part / std::max(hessian.matrix.norm(), 1e-3);
    }
    const VectorXd v = velocity(m, now);
    first = std::max(first, v.norm());
    if ((now - end).cwiseAbs().maxCoeff() < near) return {SlowMotion::End::rest, goal};
    if (v.norm() < 1e-9 * first || v.norm() < 1e-12) return {SlowMotion::End::rest, as_list(now)};
    const double by = std::min(h, 0.1 * part / v.norm());
    const VectorXd middle = closed(m, now + 0.5 * by * v);
    now = closed(m, now + by * velocity(m, middle));
    if ((now - start).cwiseAbs().maxCoeff() > far) return {SlowMotion::End::far, as_list(now)};
  }
  return {SlowMotion::End::steps, as_list(now)};
}

}  // namespace poise::test
