#include "motion/impact.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include <ceres/jet.h>

#include "solvers/complementarity.hpp"
#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

/// Impulses at two sides do not act on one another below this part of what they do at their own.
constexpr double apart = 1e-9;
/// Rates below this part of the largest before are zero.
constexpr double no_rate_left = 1e-12;
/// An impulse that friction balances but for this part changes no rate.
constexpr double wedged = 1e-12;
/// Energy that is gained, over the terms of what is lost, beyond rounding.
constexpr double gained = 1e-12;

using Dual = ceres::Jet<double, 1>;
template <class T>
using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
template <class T>
using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

template <class T>
struct SideIn {
  T rate, restitution, friction, slip;
};

template <class T>
T infinite() {
  return T(std::numeric_limits<double>::infinity());
}

double value_of(double x) { return x; }
double value_of(const Dual& x) { return x.a; }

Dual dual(double value, double by) {
  Dual out(value);
  out.v[0] = by;
  return out;
}

std::optional<VectorXd> solve_complementarity(const MatrixXd& M, const VectorXd& q) {
  return solvers::solve_complementarity(M, q);
}

/// While the same of its values are zero:  M_AA z_A = -q_A  of the others, those of the least change where M_AA is
/// singular.
std::optional<Vector<Dual>> solve_complementarity(const Matrix<Dual>& M, const Vector<Dual>& q) {
  const MatrixXd at = M.unaryExpr([](const Dual& x) { return x.a; });
  const std::optional<VectorXd> z = solvers::solve_complementarity(at, q.unaryExpr([](const Dual& x) { return x.a; }));
  if (!z) return std::nullopt;
  Vector<Dual> out = z->cast<Dual>();
  std::vector<Eigen::Index> acting;
  for (Eigen::Index i = 0; i < z->size(); ++i) {
    if ((*z)[i] > 0.0) acting.push_back(i);
  }
  const Vector<Dual> rest = M * out + q;
  const VectorXd change = rest(acting).unaryExpr([](const Dual& x) { return -x.v[0]; });
  const VectorXd by = solvers::minimum_norm_solution<double>(at(acting, acting), change);
  for (std::size_t i = 0; i < acting.size(); ++i) out[acting[i]].v[0] = by[static_cast<Eigen::Index>(i)];
  return out;
}

template <class T>
std::optional<Vector<T>> newton(const Matrix<T>& D, const Vector<T>& before, const Vector<T>& e) {
  Vector<T> q(before.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = before[i] < 0.0 ? (1.0 + e[i]) * before[i] : before[i];
  return solve_complementarity(D, q);
}

template <class T>
std::optional<Vector<T>> in_two_phases(const Matrix<T>& D, const Vector<T>& before, const Vector<T>& e,
                                       bool energetic) {
  using std::sqrt;
  const std::optional<Vector<T>> compression = solve_complementarity(D, before);
  if (!compression) return std::nullopt;
  Vector<T> expansion = e.cwiseProduct(*compression);
  const T given = expansion.dot(D * expansion);
  if (energetic && given > 0.0) {
    const T stored = e.cwiseProduct(e).cwiseProduct(*compression).dot(D * *compression);
    const T taken = compression->dot(D * *compression);
    const T back = std::min(stored, taken);
    expansion *= back > 0.0 ? T(sqrt(back / given)) : T(0);
  }
  const Vector<T> impulse = *compression + expansion;
  const std::optional<Vector<T>> again = solve_complementarity(D, Vector<T>(before + D * impulse));
  if (!again) return std::nullopt;
  return Vector<T>(impulse + *again);
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

/// Impulses at the gaps and along the slips, and what they do.
template <class T>
struct Impulses {
  Vector<T> at, along;
  Vector<T> rate, slip;  // of the gaps, and along them, after them
  T energy_lost = T(0), terms = T(0);
  bool keeps_open = false;
  bool unique = true;

  bool gains() const { return energy_lost < -gained * terms; }
};

/// A single side as the impulse at it grows.
template <class T>
class GrowingImpulse {
 public:
  GrowingImpulse(const T& nn, const T& nt, const T& tt, const SideIn<T>& side)
      : nn_(nn), nt_(nt), tt_(tt), mu_(side.friction), u_(side.rate), v_(side.slip) {}

  /// False where the gap never stops closing.
  bool run(const T& restitution, ImpactLaw law) {
    using std::abs;
    using std::isfinite;
    using std::sqrt;
    const double fastest = std::abs(value_of(u_)) + std::abs(value_of(v_));
    T taken(0);
    while (u_ < 0.0 || (u_ == 0.0 && by_impulse() < 0.0 && at_ == 0.0)) {
      const T to_end = by_impulse() > 0.0 ? T(-u_ / by_impulse()) : infinite<T>();
      const T part = std::min(to_end, to_stop());
      if (!std::isfinite(value_of(part))) return false;
      taken -= work(part);
      advance(part, part == to_stop());
      if (part == to_end || abs(u_) <= no_rate_left * fastest) {
        u_ = T(0);
        break;
      }
    }
    T left = law == ImpactLaw::poisson ? T(restitution * at_) : T(restitution * restitution * taken);
    while (left > 0.0) {
      // u x + u' x^2 / 2 = left
      const T k = by_impulse();
      // What wedges gives nothing back.
      if (k <= 0.0 && u_ <= no_rate_left * fastest) break;
      const T root = u_ * u_ + 2.0 * k * left;
      const T by_work = root > 0.0 && u_ + sqrt(root) > 0.0 ? T(2.0 * left / (u_ + sqrt(root)))
                        : root == 0.0 && u_ > 0.0           ? T(2.0 * left / u_)
                                                            : infinite<T>();
      const T to_end = law == ImpactLaw::poisson ? left : by_work;
      const T part = std::min(to_end, to_stop());
      if (!std::isfinite(value_of(part))) return false;
      left -= law == ImpactLaw::poisson ? part : work(part);
      advance(part, part == to_stop());
      if (part == to_end) break;
    }
    return true;
  }

  const T& at() const { return at_; }
  const T& along() const { return along_; }

 private:
  /// The friction for a unit of the impulse.
  T rubbed() const {
    if (v_ != 0.0) return v_ > 0.0 ? -mu_ : mu_;
    const T sticking = -nt_ / tt_;
    return std::clamp(sticking, T(-mu_), mu_);
  }
  /// Rates for a unit of the impulse; rounding of what wedges is zero.
  static T sum(const T& a, const T& b) {
    using std::abs;
    return abs(a + b) > wedged * (abs(a) + abs(b)) ? T(a + b) : T(0);
  }
  T by_impulse() const { return sum(nn_, nt_ * rubbed()); }
  T slip_by_impulse() const { return sum(nt_, tt_ * rubbed()); }
  T to_stop() const {
    const T by = slip_by_impulse();
    return v_ != 0.0 && by * v_ < 0.0 ? T(-v_ / by) : infinite<T>();
  }
  T work(const T& part) const { return part * (u_ + by_impulse() * part / 2.0); }
  void advance(const T& part, bool stops) {
    const T c = rubbed(), u = by_impulse(), v = slip_by_impulse();
    at_ += part;
    along_ += c * part;
    u_ += u * part;
    v_ = stops ? T(0) : T(v_ + v * part);
  }

  T nn_, nt_, tt_, mu_, u_, v_;
  T at_ = T(0), along_ = T(0);
};

/// Fills in what the impulses do.
template <class T>
void state(const Matrix<T>& D, const std::vector<SideIn<T>>& sides, Impulses<T>& out) {
  using std::abs;
  const auto m = static_cast<Eigen::Index>(sides.size());
  Vector<T> all(D.rows());
  all.head(m) = out.at;
  if (D.rows() > m) all.tail(m) = out.along;
  const Vector<T> change = D * all;
  out.rate.resize(m);
  out.slip = Vector<T>::Constant(m, T(0));
  out.energy_lost = out.terms = T(0);
  double fastest = 0.0, lowest = 0.0;
  for (Eigen::Index i = 0; i < m; ++i) {
    const SideIn<T>& side = sides[static_cast<std::size_t>(i)];
    out.rate[i] = side.rate + change[i];
    double size = 0.0;
    for (Eigen::Index j = 0; j < D.rows(); ++j) size += std::abs(value_of(D(i, j)) * value_of(all[j]));
    fastest = std::max({fastest, std::abs(value_of(side.rate)), 1e-5 * size, 1e-5 * std::abs(value_of(side.slip))});
    lowest = std::min(lowest, value_of(out.rate[i]));
    const auto take = [&](const T& impulse, const T& before, const T& then) {
      out.energy_lost -= impulse * (before + then) / 2.0;
      out.terms += abs(impulse) * (abs(before) + abs(then)) / 2.0;
    };
    take(out.at[i], side.rate, out.rate[i]);
    if (D.rows() == m) continue;
    out.slip[i] = side.slip + change[m + i];
    take(out.along[i], side.slip, out.slip[i]);
  }
  out.keeps_open = lowest >= -1e-9 * fastest;
}

/// With P_R = P_T + mu P_N and P_L = mu P_N - P_T, both >= 0, and the final slip w_R - w_L.
template <class T>
std::optional<Impulses<T>> rubbing_newton(const Matrix<T>& D, const std::vector<SideIn<T>>& sides, const T& share) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  Matrix<T> M = Matrix<T>::Constant(3 * m, 3 * m, T(0));
  Vector<T> q = Vector<T>::Constant(3 * m, T(0));
  for (Eigen::Index j = 0; j < m; ++j) {
    const SideIn<T>& side = sides[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < 2 * m; ++i) {
      M(i, j) = D(i, j) - side.friction * D(i, m + j);
      M(i, m + j) = D(i, m + j);
    }
    M(m + j, 2 * m + j) = T(1);
    M(2 * m + j, j) = 2.0 * side.friction;
    M(2 * m + j, m + j) = T(-1);
    q[j] = side.rate < 0.0 ? T((1.0 + share * side.restitution) * side.rate) : side.rate;
    q[m + j] = side.slip;
  }
  const std::optional<Vector<T>> z = solve_complementarity(M, q);
  if (!z) return std::nullopt;
  Impulses<T> out;
  out.at = z->head(m);
  out.along = z->segment(m, m);
  for (Eigen::Index j = 0; j < m; ++j) out.along[j] -= sides[static_cast<std::size_t>(j)].friction * out.at[j];
  state(D, sides, out);
  if (!out.keeps_open) return std::nullopt;
  return out;
}

/// The share at which the energy lost is zero, as its values have it; its derivative along those of all else.
double zero_share(const MatrixXd&, const std::vector<SideIn<double>>&, double share) { return share; }
Dual zero_share(const Matrix<Dual>& D, const std::vector<SideIn<Dual>>& sides, double share) {
  const auto lost_by = [&](const Matrix<Dual>& at, const std::vector<SideIn<Dual>>& of, const Dual& with) {
    const std::optional<Impulses<Dual>> found = rubbing_newton(at, of, with);
    return found ? found->energy_lost.v[0] : 0.0;
  };
  const auto still = [](const Dual& x) { return Dual(x.a); };
  std::vector<SideIn<Dual>> fixed;
  for (const SideIn<Dual>& side : sides)
    fixed.push_back({still(side.rate), still(side.restitution), still(side.friction), still(side.slip)});
  const double by_share = lost_by(D.unaryExpr(still), fixed, dual(share, 1.0));
  return dual(share, by_share == 0.0 ? 0.0 : -lost_by(D, sides, Dual(share)) / by_share);
}

template <class T>
std::optional<Impulses<T>> rubbing_impact(const Matrix<T>& D, const std::vector<SideIn<T>>& sides, ImpactLaw law) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  Eigen::Index closing = -1;
  for (Eigen::Index i = 0; i < m; ++i) {
    if (sides[static_cast<std::size_t>(i)].rate < 0.0 &&
        (closing < 0 || sides[static_cast<std::size_t>(i)].rate < sides[static_cast<std::size_t>(closing)].rate)) {
      closing = i;
    }
  }
  if (closing >= 0 && law != ImpactLaw::newton) {
    const SideIn<T>& side = sides[static_cast<std::size_t>(closing)];
    GrowingImpulse<T> one(D(closing, closing), D(closing, m + closing), D(m + closing, m + closing), side);
    if (one.run(side.restitution, law)) {
      Impulses<T> by;
      by.at = by.along = Vector<T>::Constant(m, T(0));
      by.at[closing] = one.at();
      by.along[closing] = one.along();
      state(D, sides, by);
      if (by.keeps_open) return by;
    }
  }
  std::optional<Impulses<T>> out = rubbing_newton(D, sides, T(1));
  if (out && law == ImpactLaw::energetic && out->gains()) {
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 50; ++k) {
      const double middle = (low + high) / 2;
      const std::optional<Impulses<T>> with = rubbing_newton(D, sides, T(middle));
      (with && !with->gains() ? low : high) = middle;
    }
    out = rubbing_newton(D, sides, T(zero_share(D, sides, low)));
    if (out && out->gains()) return std::nullopt;
  }
  if (out) out->unique = m == 1;
  return out;
}

template <class T>
std::optional<Impulses<T>> impulses(const Matrix<T>& D, const std::vector<SideIn<T>>& sides, ImpactLaw law) {
  const auto m = static_cast<Eigen::Index>(sides.size());
  if (D.rows() > m) return rubbing_impact(D, sides, law);
  Vector<T> before(m), e(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    before[i] = sides[static_cast<std::size_t>(i)].rate;
    e[i] = sides[static_cast<std::size_t>(i)].restitution;
  }
  const std::optional<Vector<T>> at =
      law == ImpactLaw::newton ? newton(D, before, e) : in_two_phases(D, before, e, law == ImpactLaw::energetic);
  if (!at) return std::nullopt;
  Impulses<T> out;
  out.at = *at;
  out.along = Vector<T>::Constant(m, T(0));
  state(D, sides, out);
  return out;
}

}  // namespace

Impact impact(const MatrixXd& D, const std::vector<ImpactSide>& sides, ImpactLaw law) {
  std::vector<SideIn<double>> all;
  for (const ImpactSide& side : sides) all.push_back({side.rate, side.restitution, side.friction, side.slip});
  Impact out;
  const std::optional<Impulses<double>> by = impulses(D, all, law);
  if (!by) return out;
  out.found = by->keeps_open;
  out.impulse.assign(by->at.begin(), by->at.end());
  out.rub.assign(by->along.begin(), by->along.end());
  out.rate.assign(by->rate.begin(), by->rate.end());
  out.slip.assign(by->slip.begin(), by->slip.end());
  out.energy_lost = by->energy_lost;
  out.gains = by->gains();
  out.unique = by->unique;
  const auto m = static_cast<Eigen::Index>(sides.size());
  if (D.rows() > m) return out;
  VectorXd e(m);
  double fastest = 0.0;
  for (Eigen::Index i = 0; i < m; ++i) {
    e[i] = all[static_cast<std::size_t>(i)].restitution;
    fastest = std::max(fastest, std::abs(all[static_cast<std::size_t>(i)].rate));
  }
  out.unique = is_unique(D, by->at, by->rate, e, fastest);
  return out;
}

ImpulseChange impulse_change(const MatrixXd& D, const MatrixXd& change, const std::vector<ImpactSide>& sides,
                             const std::vector<ImpactSide>& changes, ImpactLaw law) {
  std::vector<SideIn<Dual>> all;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const ImpactSide& at = sides[i];
    const ImpactSide& by = changes[i];
    all.push_back({dual(at.rate, by.rate), dual(at.restitution, by.restitution), dual(at.friction, by.friction),
                   dual(at.slip, by.slip)});
  }
  const std::optional<Impulses<Dual>> found =
      impulses<Dual>(D.binaryExpr(change, [](double value, double by) { return dual(value, by); }), all, law);
  ImpulseChange out{std::vector<double>(sides.size(), 0.0), std::vector<double>(sides.size(), 0.0)};
  for (std::size_t i = 0; found && i < sides.size(); ++i) {
    out.impulse[i] = found->at[static_cast<Eigen::Index>(i)].v[0];
    out.rub[i] = found->along[static_cast<Eigen::Index>(i)].v[0];
  }
  return out;
}

}  // namespace poise
