#include "motion/impact.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "solvers/complementarity.hpp"

namespace poise {
namespace {

/// Impulses at two sides do not act on one another below this part of what they do at their own.
constexpr double apart = 1e-9;
/// Rates below this part of the largest before are zero.
constexpr double no_rate_left = 1e-12;
/// An impulse that friction balances but for this part changes no rate.
constexpr double wedged = 1e-12;

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

/// Impulses at the gaps and along the slips.
struct Impulses {
  VectorXd at, along;
};

/// A single side as the impulse at it grows.
class GrowingImpulse {
 public:
  GrowingImpulse(double nn, double nt, double tt, const ImpactSide& side)
      : nn_(nn), nt_(nt), tt_(tt), mu_(side.friction), u_(side.rate), v_(side.slip) {}

  /// False where the gap never stops closing.
  bool run(double restitution, ImpactLaw law) {
    const double fastest = std::abs(u_) + std::abs(v_);
    double taken = 0.0;
    while (u_ < 0.0 || (u_ == 0.0 && by_impulse() < 0.0 && at_ == 0.0)) {
      const double to_end = by_impulse() > 0.0 ? -u_ / by_impulse() : std::numeric_limits<double>::infinity();
      const double part = std::min(to_end, to_stop());
      if (!std::isfinite(part)) return false;
      taken -= work(part);
      advance(part, part == to_stop());
      if (part == to_end || std::abs(u_) <= no_rate_left * fastest) {
        u_ = 0.0;
        break;
      }
    }
    double left = law == ImpactLaw::poisson ? restitution * at_ : restitution * restitution * taken;
    while (left > 0.0) {
      // u x + u' x^2 / 2 = left
      const double k = by_impulse();
      // What wedges gives nothing back.
      if (k <= 0.0 && u_ <= no_rate_left * fastest) break;
      const double root = u_ * u_ + 2 * k * left;
      const double by_work = root >= 0.0 && u_ + std::sqrt(root) > 0.0 ? 2 * left / (u_ + std::sqrt(root))
                                                                       : std::numeric_limits<double>::infinity();
      const double to_end = law == ImpactLaw::poisson ? left : by_work;
      const double part = std::min(to_end, to_stop());
      if (!std::isfinite(part)) return false;
      left -= law == ImpactLaw::poisson ? part : work(part);
      advance(part, part == to_stop());
      if (part == to_end) break;
    }
    return true;
  }

  double at() const { return at_; }
  double along() const { return along_; }

 private:
  /// The friction for a unit of the impulse.
  double rubbed() const {
    if (v_ != 0.0) return v_ > 0.0 ? -mu_ : mu_;
    const double sticking = -nt_ / tt_;
    return std::clamp(sticking, -mu_, mu_);
  }
  /// Rates for a unit of the impulse; rounding of what wedges is zero.
  static double sum(double a, double b) { return std::abs(a + b) > wedged * (std::abs(a) + std::abs(b)) ? a + b : 0.0; }
  double by_impulse() const { return sum(nn_, nt_ * rubbed()); }
  double slip_by_impulse() const { return sum(nt_, tt_ * rubbed()); }
  double to_stop() const {
    const double by = slip_by_impulse();
    return v_ != 0.0 && by * v_ < 0.0 ? -v_ / by : std::numeric_limits<double>::infinity();
  }
  double work(double part) const { return part * (u_ + by_impulse() * part / 2); }
  void advance(double part, bool stops) {
    const double c = rubbed(), u = by_impulse(), v = slip_by_impulse();
    at_ += part;
    along_ += c * part;
    u_ += u * part;
    v_ = stops ? 0.0 : v_ + v * part;
  }

  double nn_, nt_, tt_, mu_, u_, v_;
  double at_ = 0.0, along_ = 0.0;
};

/// With P_R = P_T + mu P_N and P_L = mu P_N - P_T, both >= 0, and the final slip w_R - w_L.
std::optional<Impulses> rubbing_newton(const MatrixXd& D, const std::vector<ImpactSide>& sides, double share) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  MatrixXd M = MatrixXd::Zero(3 * m, 3 * m);
  VectorXd q = VectorXd::Zero(3 * m);
  for (Eigen::Index j = 0; j < m; ++j) {
    const double mu = sides[static_cast<std::size_t>(j)].friction;
    for (Eigen::Index i = 0; i < 2 * m; ++i) {
      M(i, j) = D(i, j) - mu * D(i, m + j);
      M(i, m + j) = D(i, m + j);
    }
    M(m + j, 2 * m + j) = 1.0;
    M(2 * m + j, j) = 2 * mu;
    M(2 * m + j, m + j) = -1.0;
    const ImpactSide& side = sides[static_cast<std::size_t>(j)];
    q[j] = side.rate < 0.0 ? (1.0 + share * side.restitution) * side.rate : side.rate;
    q[m + j] = side.slip;
  }
  const std::optional<VectorXd> z = solvers::solve_complementarity(M, q);
  if (!z) return std::nullopt;
  Impulses out{z->head(m), z->segment(m, m)};
  for (Eigen::Index j = 0; j < m; ++j) out.along[j] -= sides[static_cast<std::size_t>(j)].friction * out.at[j];
  return out;
}

void state(const MatrixXd& D, const std::vector<ImpactSide>& sides, const Impulses& by, Impact& out) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  VectorXd all(D.rows());
  all.head(m) = by.at;
  if (D.rows() > m) all.tail(m) = by.along;
  const VectorXd change = D * all;
  out.impulse.assign(by.at.begin(), by.at.end());
  out.rub.assign(by.along.begin(), by.along.end());
  out.rate.clear();
  out.energy_lost = out.terms = 0.0;
  const VectorXd sizes = D.cwiseAbs() * all.cwiseAbs();
  double fastest = 0.0, lowest = 0.0;
  for (Eigen::Index i = 0; i < m; ++i) {
    const ImpactSide& side = sides[static_cast<std::size_t>(i)];
    const double after = side.rate + change[i];
    out.rate.push_back(after);
    fastest = std::max({fastest, std::abs(side.rate), 1e-5 * sizes[i], 1e-5 * std::abs(side.slip)});
    lowest = std::min(lowest, after);
    const auto take = [&](double impulse, double before, double then) {
      out.energy_lost -= impulse * (before + then) / 2;
      out.terms += std::abs(impulse) * (std::abs(before) + std::abs(then)) / 2;
    };
    take(by.at[i], side.rate, after);
    if (D.rows() > m) take(by.along[i], side.slip, side.slip + change[m + i]);
  }
  out.found = lowest >= -1e-9 * fastest;
}

Impact rubbing_impact(const MatrixXd& D, const std::vector<ImpactSide>& sides, ImpactLaw law) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  Impact out;
  Eigen::Index closing = -1;
  for (Eigen::Index i = 0; i < m; ++i) {
    if (sides[static_cast<std::size_t>(i)].rate < 0.0 &&
        (closing < 0 || sides[static_cast<std::size_t>(i)].rate < sides[static_cast<std::size_t>(closing)].rate)) {
      closing = i;
    }
  }
  if (closing >= 0 && law != ImpactLaw::newton) {
    const ImpactSide& side = sides[static_cast<std::size_t>(closing)];
    GrowingImpulse one(D(closing, closing), D(closing, m + closing), D(m + closing, m + closing), side);
    if (one.run(side.restitution, law)) {
      Impulses by{VectorXd::Zero(m), VectorXd::Zero(m)};
      by.at[closing] = one.at();
      by.along[closing] = one.along();
      state(D, sides, by, out);
      if (out.found) return out;
    }
  }
  const auto with_share = [&](double share) {
    const std::optional<Impulses> by = rubbing_newton(D, sides, share);
    if (by) state(D, sides, *by, out);
    return by.has_value() && out.found;
  };
  out.unique = m == 1;
  if (!with_share(1.0)) return out;
  if (law != ImpactLaw::energetic || !out.gains()) return out;
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 50; ++k) {
    const double middle = (low + high) / 2;
    (with_share(middle) && !out.gains() ? low : high) = middle;
  }
  out.found = with_share(low) && !out.gains();
  return out;
}

}  // namespace

Impact impact(const MatrixXd& D, const std::vector<ImpactSide>& sides, ImpactLaw law) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  if (D.rows() > m) return rubbing_impact(D, sides, law);
  VectorXd before(m), e(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    before[i] = sides[static_cast<std::size_t>(i)].rate;
    e[i] = sides[static_cast<std::size_t>(i)].restitution;
  }
  Impact out;
  const std::optional<VectorXd> impulse =
      law == ImpactLaw::newton ? newton(D, before, e) : in_two_phases(D, before, e, law == ImpactLaw::energetic);
  if (!impulse) return out;
  state(D, sides, {*impulse, VectorXd::Zero(m)}, out);
  out.unique = is_unique(D, *impulse, before + D * *impulse, e, before.cwiseAbs().maxCoeff());
  return out;
}

}  // namespace poise
