#include "motion/small_motions.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

#include "motion/body_motion.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/curvature.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Distance within which a stop is touched, rad or mechanism sizes.
constexpr double touching_within = 1e-8;

// Closure rows, and the stops at x: those that press, which hold, and those that only touch.
struct HoldingRows {
  std::vector<int> rows, released;
  VectorXd push;  // of the rows, scaled
};

bool is_at_max(const Mechanism<double>& m, int s, double g) { return g >= m.upper()[s] - touching_within; }

HoldingRows holding_rows(const Mechanism<double>& m, const std::vector<double>& x) {
  const int closures = m.equalities();
  HoldingRows out;
  std::vector<int>& rows = out.rows;
  rows.resize(static_cast<std::size_t>(closures));
  std::iota(rows.begin(), rows.end(), 0);
  const DensePoint<double> at(m, x, rows);
  for (int s = 0; s < m.stops(); ++s) {
    const double g = at.constraint[closures + s];
    if (is_at_max(m, s, g) || g <= m.lower()[s] + touching_within) rows.push_back(closures + s);
  }
  // Stops whose reaction has the wrong sign or is zero are released, the largest wrong one first; those whose limits
  // are equal hold whatever they carry.
  while (static_cast<int>(rows.size()) > closures) {
    const DensePoint<double> point(m, x, rows);
    out.push = point.multipliers();
    const double zero = 1e-10 * std::max(1.0, out.push.cwiseAbs().maxCoeff());
    Index worst = -1;
    double hardest = zero;
    for (Index k = closures; k < out.push.size(); ++k) {
      const int s = rows[k] - closures;
      if (m.upper()[s] == m.lower()[s]) continue;
      const bool both = m.upper()[s] - m.lower()[s] <= 2 * touching_within;
      const double pressure = both                                         ? std::abs(out.push[k])
                              : is_at_max(m, s, point.constraint[rows[k]]) ? out.push[k]
                                                                           : -out.push[k];
      if (pressure >= hardest) continue;
      hardest = pressure;
      worst = k;
    }
    if (worst < 0) break;
    out.released.push_back(rows[worst]);
    rows.erase(rows.begin() + worst);
  }
  return out;
}

// C = sum of dT/dw r r^T over all elements that damp small motions, with r the rates of their measures along the
// columns of the basis.
MatrixXd reduced_damping(const MotionModel& model, const std::vector<double>& x, const MatrixXd& basis) {
  const Scene& scene = model.scene();
  MatrixXd c = MatrixXd::Zero(basis.cols(), basis.cols());
  const auto damps = [](const Element& e) { return damps_small_motion(e.law); };
  if (std::none_of(scene.elements.begin(), scene.elements.end(), damps)) return c;
  const std::vector<std::vector<BodyMotion>> motions = motions_along(model, x, basis);
  const std::vector<BodyPose<double>> poses = model.poses(x);
  for (const Element& e : scene.elements) {
    if (!damps(e)) continue;
    VectorXd r(basis.cols());
    for (Index k = 0; k < r.size(); ++k) r[k] = rate_of(scene, motions[k], e.on);
    const double coefficient = force_of_motion(e.law, value_of(scene, e.on, poses), 0.0).by_rate;
    c += coefficient / model.scales().energy() * r * r.transpose();
  }
  return c;
}

MatrixXd reduced_mass(const MotionModel& model, const std::vector<double>& x, const MatrixXd& basis) {
  const Mechanism<double>& m = model.mechanism();
  std::vector<Planar<double>> pose(m.pose_size());
  m.place(x.data(), pose.data());
  MatrixXd full(m.coordinates(), m.coordinates());
  model.inertia().mass_matrix(pose.data(), full.data());
  return basis.transpose() * full * basis;
}

}  // namespace

SmallMotions small_motions(const MotionModel& model, const std::vector<double>& x) {
  refuse_blades(model.scene(), "small motions about an equilibrium");
  const Mechanism<double>& m = model.mechanism();
  const HoldingRows holding = holding_rows(m, x);
  const std::vector<int>& rows = holding.rows;
  const ReducedHessian reduced(m, x, rows);
  SmallMotions out;
  out.basis = reduced.basis;
  out.stiffness = reduced.matrix;
  out.largest = reduced.largest;
  out.symmetric = !m.has_follower_loads();
  if (out.symmetric) out.stiffness = (out.stiffness + out.stiffness.transpose()).eval() / 2;
  out.mass = reduced_mass(model, x, out.basis);
  out.damping = reduced_damping(model, x, out.basis);
  const bool is_regular = out.basis.cols() == m.coordinates() - static_cast<Index>(rows.size());
  out.mobility = freedoms_at(model, x, is_regular ? std::optional(0) : std::nullopt);
  for (std::size_t k = static_cast<std::size_t>(m.equalities()); k < rows.size(); ++k) {
    const int index = rows[k] - m.equalities();
    const Stop& stop = model.scene().stops[static_cast<std::size_t>(index)];
    if (stop.couples()) continue;
    const double unit = stop.on.is_angle() ? model.scales().energy() : model.scales().force;
    const double push = unit * holding.push[static_cast<Index>(k)];
    out.stops.push_back({index, push > 0.0, std::abs(push)});
  }
  const DensePoint<double> released(m, x, holding.released);
  const MatrixXd rates = released.jacobian * out.basis;
  for (std::size_t k = 0; k < holding.released.size(); ++k) {
    constexpr double no_rate = 1e-9;
    if (rates.cols() == 0 || rates.row(static_cast<Index>(k)).norm() <= no_rate) continue;
    const int index = holding.released[k] - m.equalities();
    out.just_touched.push_back({index, is_at_max(m, index, released.constraint[holding.released[k]])});
  }
  return out;
}

std::vector<std::vector<BodyMotion>> motions_along(const MotionModel& model, const std::vector<double>& x,
                                                   const MatrixXd& basis) {
  std::vector<std::vector<BodyMotion>> motions;
  const std::vector<double> none(x.size(), 0.0);
  for (Index k = 0; k < basis.cols(); ++k) {
    motions.push_back(body_motions(model, x, {basis.col(k).begin(), basis.col(k).end()}, none));
  }
  return motions;
}

}  // namespace poise
