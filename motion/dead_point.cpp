#include "motion/dead_point.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "motion/body_motion.hpp"
#include "motion/driven_path.hpp"
#include "motion/stop_room.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"
#include "statics/model/mobility.hpp"

namespace poise {
namespace {

// Work along a motion of unit size that is more than rounding, of the largest generalized force.
constexpr double works = 1e-6;

/// The rows of J and D.
Eigen::MatrixXd rates_of_drives(const MotionModel& model, const DensePoint<double>& point, const std::vector<double>& x,
                                const std::vector<Drive>& drives) {
  const Eigen::Index rows = point.jacobian.rows();
  Eigen::MatrixXd out(rows + static_cast<Eigen::Index>(drives.size()), point.jacobian.cols());
  out.topRows(rows) = point.jacobian;
  const std::vector<double> none(x.size(), 0.0);
  for (std::size_t k = 0; k < x.size(); ++k) {
    std::vector<double> direction = none;
    direction[k] = 1.0;
    const std::vector<BodyMotion> motions = body_motions(model, x, direction, none);
    for (std::size_t d = 0; d < drives.size(); ++d) {
      const double unit = drives[d].on.is_angle() ? 1.0 : model.scales().length;
      out(rows + static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(k)) =
          rate_of(model.scene(), motions, drives[d].on) / unit;
    }
  }
  return out;
}

}  // namespace

bool is_dead_point(const MotionModel& model, const std::vector<double>& x, const std::vector<Drive>& drives) {
  if (drives.empty() || static_cast<int>(drives.size()) < analyse_mobility(model).freedoms) return false;
  const Mechanism<double>& mechanism = model.mechanism();
  std::vector<int> rows(static_cast<std::size_t>(mechanism.equalities()));
  std::iota(rows.begin(), rows.end(), 0);
  const std::vector<StopRoom> rooms = stop_rooms(model, x);
  for (std::size_t s = 0; s < rooms.size(); ++s) {
    if (rooms[s].overrun() >= -StopRoom::rounding) rows.push_back(mechanism.stop_row(static_cast<int>(s)));
  }
  const DensePoint<double> point(mechanism, x, rows);
  const Eigen::MatrixXd rates = rates_of_drives(model, point, x, drives);
  const solvers::SingularValues decomposed = solvers::singular_value_decomposition(rates);
  // Slopes of measures are of order one; a single one vanishes against nothing else.
  const double largest_slope = std::max(decomposed.values.size() > 0 ? decomposed.values[0] : 0.0, 1.0);
  const Eigen::Index left =
      rates.cols() - (decomposed.values.array() >= DrivenPath::singular_below * largest_slope).count();
  if (left == 0) return false;
  const double largest = point.force.lpNorm<Eigen::Infinity>();
  return (decomposed.right.rightCols(left).transpose() * point.force).norm() > works * largest;
}

}  // namespace poise
