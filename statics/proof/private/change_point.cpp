#include "statics/proof/private/change_point.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

constexpr double same_place = 1e-15;  // rad or sizes
constexpr double change_margin = 1e-7;
constexpr double straight_within = 1e-9;  // second derivatives that may be rounding
constexpr double farthest_beside = 1e-4;  // rad or sizes

// How far from a change point equilibria may lie whose row is open by so much there: across the branches a gap is the
// square of a distance, v^T T v = 2 open, and equilibria lie where  H v = lambda T v.
double beside_change_point(const Eigen::MatrixXd& h, const Eigen::MatrixXd& t, double open) {
  const double size = t.cwiseAbs().maxCoeff();
  double away = 4 * std::sqrt(open / size);
  const double shift = 0.7 * std::max(1.0, h.cwiseAbs().maxCoeff()) / size;
  const solvers::FullyPivotedLu shifted(h + shift * t);
  const solvers::Eigenpairs pairs = solvers::eigenpairs(shifted.solve(t));
  for (Eigen::Index k = 0; k < pairs.vectors.cols(); ++k) {
    const Eigen::VectorXd v = pairs.vectors.col(k).real();
    const double along = std::abs(v.dot(t * v)) / v.squaredNorm();
    // Along a branch energies of that order are not compared.
    if (along > 1e-6 * size) away = std::max(away, 1.5 * std::sqrt(2 * open / along));
  }
  return away;
}

double least(const Eigen::MatrixXd& a) { return solvers::symmetric_eigenvalues<double>(a)[0]; }

}  // namespace

ChangePoint examine_change_point(const Eigen::MatrixXd& h, const std::vector<LostRow>& lost) {
  ChangePoint out;
  if (h.size() == 0) {
    out.loses_rank = true;
    out.stability = Stability::stable;
    return out;
  }
  double spread = 0.0;
  const LostRow* bent = nullptr;
  for (const LostRow& row : lost) {
    const double size = row.second.cwiseAbs().maxCoeff();
    const double slope = row.gradient.cwiseAbs().maxCoeff();
    if (size <= straight_within && slope <= straight_within) continue;
    const double away = beside_change_point(h, row.second, row.open) + same_place;
    if (size <= straight_within || slope > size * away || away > farthest_beside) return out;
    spread = std::max(spread, away);
    bent = &row;
  }
  if (bent == nullptr) return out;
  out.loses_rank = true;
  out.spread = spread;
  const double scale = std::max(1.0, h.cwiseAbs().maxCoeff());
  if (least(h) > change_margin * scale) out.stability = Stability::stable;
  if (out.stability == Stability::stable || lost.size() != 1) return out;
  const Eigen::MatrixXd& t = bent->second;
  const double size = t.cwiseAbs().maxCoeff();
  double from = -1e6 * scale / size;
  double to = -from;
  for (int k = 0; k < 200; ++k) {  // the least eigenvalue is concave in nu
    const double a = from + (to - from) / 3;
    const double b = to - (to - from) / 3;
    (least(h + a * t) < least(h + b * t) ? from : to) = least(h + a * t) < least(h + b * t) ? a : b;
  }
  const double best = least(h + (from + to) / 2 * t);
  const double near_best = scale + std::abs((from + to) / 2) * size;
  if (best > change_margin * near_best) out.stability = Stability::stable;
  if (best < -change_margin * near_best) out.stability = Stability::unstable;
  return out;
}

}  // namespace poise
