#include "motion/impact.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "solvers/complementarity.hpp"

namespace poise {
namespace {

/// Impulses at two sides do not act on one another below this part of what they do at their own.
constexpr double apart = 1e-9;
/// Rates below this part of the largest before are zero.
constexpr double no_rate_left = 1e-12;

using Eigen::MatrixXd;
using Eigen::VectorXd;

std::optional<VectorXd> newton(const MatrixXd& D, const VectorXd& before, const VectorXd& e) {
  VectorXd q(before.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = before[i] < 0.0 ? (1.0 + e[i]) * before[i] : before[i];
  return solvers::solve_complementarity(D, q);
}

std::optional<VectorXd> in_two_phases(const MatrixXd& D, const VectorXd& before, const VectorXd& e, bool energetic) {
  const std::optional<VectorXd> compression = solvers::solve_complementarity(D, before);
  if (!compression) return std::nullopt;
  VectorXd expansion = e.cwiseProduct(*compression);
  const double given = expansion.dot(D * expansion);
  if (energetic && given > 0.0) {
    const double stored = e.cwiseProduct(e).cwiseProduct(*compression).dot(D * *compression);
    const double taken = compression->dot(D * *compression);
    expansion *= std::sqrt(std::clamp(stored, 0.0, taken) / given);
  }
  const VectorXd impulse = *compression + expansion;
  const std::optional<VectorXd> again = solvers::solve_complementarity(D, before + D * impulse);
  if (!again) return std::nullopt;
  return impulse + *again;
}

// One impulse has one effect. Without restitution gaps that all stay closed do so whatever the order of impulses is,
// and of two sides the second is hit by the first or not.
bool is_unique(const MatrixXd& D, const VectorXd& impulse, const VectorXd& after, const VectorXd& e, double rate) {
  const Eigen::Index m = impulse.size();
  const auto coupling = [&](Eigen::Index i, Eigen::Index k) {
    const double size = std::sqrt(D(i, i) * D(k, k));
    return std::abs(D(i, k)) > apart * size ? D(i, k) : 0.0;
  };
  const bool is_plastic = e.cwiseAbs().maxCoeff() == 0.0;
  if (is_plastic && (m <= 2 || after.cwiseAbs().maxCoeff() <= no_rate_left * rate)) return true;
  for (Eigen::Index i = 0; i < m; ++i) {
    if (impulse[i] == 0.0) continue;
    for (Eigen::Index k = 0; k < m; ++k) {
      if (k == i || coupling(i, k) == 0.0) continue;
      if (impulse[k] > 0.0 || coupling(i, k) < 0.0) return false;
    }
  }
  return true;
}

}  // namespace

Impact impact(const MatrixXd& D, const std::vector<ImpactSide>& sides, ImpactLaw law) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  VectorXd before(m), e(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    before[i] = sides[static_cast<std::size_t>(i)].rate;
    e[i] = sides[static_cast<std::size_t>(i)].restitution;
  }
  Impact out;
  const std::optional<VectorXd> impulse =
      law == ImpactLaw::newton ? newton(D, before, e) : in_two_phases(D, before, e, law == ImpactLaw::energetic);
  if (!impulse) return out;
  const VectorXd after = before + D * *impulse;
  const double fastest = before.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < m; ++i) {
    const double work = (*impulse)[i] * (before[i] + after[i]) / 2;
    out.energy_lost -= work;
    out.terms += std::abs((*impulse)[i]) * (std::abs(before[i]) + std::abs(after[i])) / 2;
    out.impulse.push_back((*impulse)[i]);
    out.rate.push_back(after[i]);
  }
  out.found = after.minCoeff() >= -1e-9 * fastest;
  out.unique = is_unique(D, *impulse, after, e, fastest);
  return out;
}

}  // namespace poise
