#include "statics/model/reference.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "model/mechanism_impl.hpp"
#include "solvers/linear_algebra_50.hpp"
#include "statics/model/private/curvature_impl.hpp"

namespace poise {
namespace {

using Real = Real50;
using Vector = DensePoint<Real>::Vector;
using DenseReal = DensePoint<Real>::Matrix;

constexpr int dense_reference_limit =
    80;  // number of coordinates up to which redundancy is resolved by a rank-revealing factorization
constexpr int steps = 120;
constexpr double longest_reference_step = 1e-3;
constexpr double same_solution = 1e-2;  // a larger correction leads to another equilibrium
constexpr double nearly = 1e-9;         // accepted where Newton converges only linearly
constexpr double active_within = 1e-7;  // of an active stop

// Newton on {F + J^T y = 0, c = 0} in 50 digits.
class Refinement {
 public:
  Refinement(const StaticModel& model, const std::vector<double>& x)
      : model_(model), mechanism_(scaled(model.scene(), model.scales()), Purpose::statics) {
    for (double v : x) q_.emplace_back(v);
    from_ = q_;
    rows_.resize(mechanism_.equalities());
    std::iota(rows_.begin(), rows_.end(), 0);
  }

  // Active stops: touching, and needed for balance with the right sign.
  void hold_stops() {
    const auto closures = static_cast<std::size_t>(mechanism_.equalities());
    target_.assign(closures, Real(0));
    std::vector<int> sides(closures, 0);
    if (mechanism_.stops() == 0) return;
    std::vector<Planar<Real>> pose(mechanism_.pose_size());
    std::vector<Real> constraint(mechanism_.constraints());
    mechanism_.place(q_.data(), pose.data());
    mechanism_.constraint(q_.data(), pose.data(), constraint.data());
    for (int s = 0; s < mechanism_.stops(); ++s) {
      const Real& g = constraint[mechanism_.stop_row(s)];
      const bool at_top = abs(g - mechanism_.upper()[s]) < active_within;
      const bool at_bottom = abs(g - mechanism_.lower()[s]) < active_within;
      if (!at_top && !at_bottom) continue;
      rows_.push_back(mechanism_.stop_row(s));
      target_.push_back(at_top ? mechanism_.upper()[s] : mechanism_.lower()[s]);
      sides.push_back(at_top && at_bottom ? 0 : at_top ? 1 : -1);
    }
    // In a large mechanism every touched stop counts as active: the check decides whether its reaction has the right
    // sign.
    while (rows_.size() > closures && mechanism_.coordinates() <= dense_reference_limit) {
      const Vector y = DensePoint<Real>(mechanism_, q_, rows_).multipliers();
      std::size_t pulling = rows_.size();
      for (std::size_t k = closures; k < rows_.size(); ++k) {
        if (sides[k] != 0 && sides[k] * y[static_cast<Eigen::Index>(k)] < 1e-13) pulling = k;
      }
      if (pulling == rows_.size()) return;
      const auto at = static_cast<std::ptrdiff_t>(pulling);
      rows_.erase(rows_.begin() + at);
      target_.erase(target_.begin() + at);
      sides.erase(sides.begin() + at);
    }
  }

  // Redundant closures agree only to the rounding of the scene's doubles; in 50 digits they would contradict each
  // other. The independent ones are kept.
  void keep_independent_rows() {
    if (rows_.empty() || mechanism_.coordinates() > dense_reference_limit) return;
    const DensePoint<Real> point(mechanism_, q_, rows_);
    const auto [rank, order] = solvers::pivot_order<Real>(point.jacobian.transpose(), solvers::known_to::data);
    if (rank == static_cast<Eigen::Index>(rows_.size())) return;
    std::vector<std::size_t> kept(order.begin(), order.begin() + rank);
    std::sort(kept.begin(), kept.end());
    const std::vector<int> rows = std::move(rows_);
    const std::vector<Real> targets = std::move(target_);
    rows_.clear();
    target_.clear();
    for (std::size_t k : kept) {
      rows_.push_back(rows[k]);
      target_.push_back(targets[k]);
    }
  }

  bool run(std::string& why) {
    hold_stops();
    keep_independent_rows();
    Real last = 1;
    for (int k = 0; k < steps; ++k) {
      const std::optional<Vector> step =
          mechanism_.coordinates() <= dense_reference_limit ? std::optional(dense_step()) : sparse_step();
      if (!step || !step->allFinite()) {
        why = "Newton in 50 digits: singular system";
        return false;
      }
      const Vector& d = *step;
      Real length = 0;
      for (Eigen::Index i = 0; i < d.size(); ++i) length = std::max(length, Real(abs(d[i])));
      // Near a fold full steps overshoot: they are bounded.
      const Real part = length > longest_reference_step ? Real(longest_reference_step / length) : Real(1);
      Real travelled = 0;
      for (Eigen::Index i = 0; i < d.size(); ++i) {
        q_[i] += part * d[i];
        travelled = std::max(travelled, Real(abs(q_[i] - from_[i])));
      }
      if (travelled > same_solution) {
        why = "the nearest solution in 50 digits is another equilibrium";
        return false;
      }
      // Converged once steps no longer decrease: the rest is rounding in 50 digits.
      if (length < Real(1e-30) && (length == 0 || length * 16 > last || length < Real(1e-45))) {
        settled_ = length;
        if (is_solved()) return true;
        why = "50 digits find no equilibrium here: closures and balance cannot be satisfied together";
        return false;
      }
      last = length;
    }
    // If a curvature vanishes at the equilibrium itself Newton converges only linearly.
    settled_ = last;
    if (last < Real(nearly) && is_solved()) return true;
    why = "Newton in 50 digits did not converge";
    return false;
  }

  const std::vector<Real>& q() const { return q_; }
  int digits() const { return settled_ == 0 ? 50 : std::min(50, static_cast<int>(-log10(settled_))); }

 private:
  // Where J loses rank steps may become small without a solution.
  bool is_solved() {
    if (mechanism_.coordinates() > dense_reference_limit) return true;
    DensePoint<Real> point(mechanism_, q_, rows_);
    const Vector y = point.multipliers();
    const Vector left = point.force + point.jacobian.transpose() * y;
    const Vector c = gaps(point.constraint);
    Real worst = 0;
    for (Eigen::Index i = 0; i < left.size(); ++i) worst = std::max(worst, Real(abs(left[i])));
    for (Eigen::Index i = 0; i < c.size(); ++i) worst = std::max(worst, Real(abs(c[i])));
    return worst < Real(1e-25);
  }

  // c, with active stops measured from their bound.
  Vector gaps(const std::vector<Real>& constraint) const {
    Vector c(static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t k = 0; k < rows_.size(); ++k) c[static_cast<Eigen::Index>(k)] = constraint[rows_[k]] - target_[k];
    return c;
  }

  // Minimum-norm step by a rank-revealing factorization of the whole system: redundant joints and neutral directions
  // are admissible.
  Vector dense_step() {
    DensePoint<Real> point(mechanism_, q_, rows_);
    const Eigen::Index n = mechanism_.coordinates();
    const auto m = static_cast<Eigen::Index>(rows_.size());
    const Vector y = point.multipliers();
    const DenseReal system = point.equations(y);
    Vector right(n + m);
    right << -(point.force + point.jacobian.transpose() * y), -gaps(point.constraint);
    return solvers::minimum_norm_solution(system, right, solvers::known_to::half_of_50_digits).head(n);
  }

  // Large mechanisms: sparse factors with a relaxation far below the printed digits.
  std::optional<Vector> sparse_step() {
    const Eigen::Index n = mechanism_.coordinates();
    const auto m = static_cast<Eigen::Index>(rows_.size());
    std::vector<Planar<Real>> pose(mechanism_.pose_size());
    mechanism_.place(q_.data(), pose.data());
    std::vector<Real> force(n), constraint(mechanism_.constraints()), jacobian(mechanism_.jacobian_row().size());
    mechanism_.negative_force(q_.data(), pose.data(), force.data());
    mechanism_.constraint(q_.data(), pose.data(), constraint.data());
    mechanism_.jacobian(pose.data(), jacobian.data());
    std::vector<int> place(mechanism_.constraints(), -1);
    for (Eigen::Index k = 0; k < m; ++k) place[rows_[k]] = static_cast<int>(k);
    if (sparse_y_.size() != m) {
      const std::optional<Vector> y = least_squares_y(force, jacobian, place);
      if (!y) return std::nullopt;
      sparse_y_ = *y;
    }

    std::vector<Real> all(mechanism_.constraints(), Real(0)), tangent(mechanism_.tangent_row().size());
    for (Eigen::Index k = 0; k < m; ++k) all[rows_[k]] = sparse_y_[k];
    mechanism_.tangent(pose.data(), all.data(), tangent.data());
    std::vector<Eigen::Triplet<Real>> entries;
    for (std::size_t e = 0; e < tangent.size(); ++e) {
      const int i = mechanism_.tangent_row()[e];
      const int j = mechanism_.tangent_column()[e];
      entries.emplace_back(i, j, tangent[e]);
      if (!mechanism_.has_follower_loads() && i != j) entries.emplace_back(j, i, tangent[e]);
    }
    Vector right(n + m);
    right.head(n) = -Eigen::Map<Vector>(force.data(), n);
    right.tail(m) = -gaps(constraint);
    const std::optional<Vector> step = solve_bordered(entries, jacobian, place, right);
    if (!step) return std::nullopt;
    sparse_y_ = step->tail(m);
    return step->head(n).eval();
  }

  std::optional<Vector> least_squares_y(const std::vector<Real>& force, const std::vector<Real>& jacobian,
                                        const std::vector<int>& place) const {
    const Eigen::Index n = mechanism_.coordinates();
    const auto m = static_cast<Eigen::Index>(rows_.size());
    std::vector<Eigen::Triplet<Real>> entries;
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, Real(1));
    Vector right = Vector::Zero(n + m);
    for (Eigen::Index i = 0; i < n; ++i) right[i] = -force[i];
    const std::optional<Vector> all = solve_bordered(entries, jacobian, place, right);
    return all ? std::optional<Vector>(all->tail(m)) : std::nullopt;
  }

  std::optional<Vector> solve_bordered(std::vector<Eigen::Triplet<Real>> entries, const std::vector<Real>& jacobian,
                                       const std::vector<int>& place, const Vector& right) const {
    const int n = mechanism_.coordinates();
    for (std::size_t e = 0; e < jacobian.size(); ++e) {
      const int row = place[mechanism_.jacobian_row()[e]];
      if (row < 0) continue;
      entries.emplace_back(n + row, mechanism_.jacobian_column()[e], jacobian[e]);
      entries.emplace_back(mechanism_.jacobian_column()[e], n + row, jacobian[e]);
    }
    for (int k = 0; k < static_cast<int>(rows_.size()); ++k) entries.emplace_back(n + k, n + k, Real(-1e-40));
    Eigen::SparseMatrix<Real> system(right.size(), right.size());
    system.setFromTriplets(entries.begin(), entries.end());
    return solvers::solve(system, right, !mechanism_.has_follower_loads());
  }

  const StaticModel& model_;
  Mechanism<Real> mechanism_;
  std::vector<Real> q_, from_;
  std::vector<int> rows_;
  std::vector<Real> target_;  // per row: zero for closures, the bound of an active stop
  Vector sparse_y_;
  Real settled_ = 1;
};

}  // namespace

Reference refine(const StaticModel& model, const std::vector<double>& x) {
  Reference out;
  Refinement refinement(model, x);
  out.refined = refinement.run(out.why);
  if (!out.refined) return out;
  out.digits = refinement.digits();
  Real error = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Real& q = refinement.q()[i];
    error = std::max(error, Real(abs(q - x[i])));
    out.x.push_back(static_cast<double>(q));
    const bool is_angle = static_cast<int>(i) < model.layout().angles;
    const Real si = is_angle ? q : Real((q + model.layout().coordinates[i].origin) * model.scales().length);
    out.decimal.push_back(si.str(40));
  }
  out.error = static_cast<double>(error);
  return out;
}

}  // namespace poise
