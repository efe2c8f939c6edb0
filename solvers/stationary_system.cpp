#include "solvers/stationary_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "solvers/optimality.hpp"
#include "solvers/residuals.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double gap_weight = 3.0;
constexpr double touching = 1e-9;

// a + b - sqrt(a^2 + b^2): zero exactly where a >= 0, b >= 0 and a b = 0. b for an infinite a.
struct Complementarity {
  double value, by_a = 0.0, by_b = 1.0;

  Complementarity(double a, double b) : value(b) {
    if (std::isinf(a)) return;
    const double r = std::hypot(a, b);
    // The sum as written cancels if both are positive.
    value = a > 0 && b > 0 ? 2 * a * b / (a + b + r) : a + b - r;
    // At the kink any element of the subdifferential serves.
    by_a = 1 - (r > 0 ? a / r : 1 / std::numbers::sqrt2);
    by_b = 1 - (r > 0 ? b / r : 1 / std::numbers::sqrt2);
  }
};

}  // namespace

StationarySystem::StationarySystem(const Problem& problem, const std::vector<double>& start,
                                   const std::vector<int>& rows)
    : problem_(problem),
      kept_(rows),
      n_(problem.variables()),
      at_(problem.make_evaluation()),
      start_(start),
      tangent_(problem.tangent_pattern().size()) {
  if (kept_.empty()) {
    kept_.resize(problem.constraints());
    std::iota(kept_.begin(), kept_.end(), 0);
  }
  at_.x = start;
  problem.evaluate(at_);
  evaluated_ = true;
  ++evaluations_;
  y_ = optimality_at(problem, at_, kept_, touching).multipliers;
  for (const int row : kept_) start_.push_back(y_[row]);
  residual_.resize(start_.size());
  by_row_.assign(kept_.size(), gap_weight);
  by_multiplier_.assign(kept_.size(), 0.0);
  list_entries();
}

void StationarySystem::list_entries() {
  const Pattern& tangent = problem_.tangent_pattern();
  for (int e = 0; e < tangent.size(); ++e) {
    entries_.push_back({tangent.row[e], tangent.column[e], Kind::tangent, e, 0});
    if (problem_.has_objective() && tangent.row[e] != tangent.column[e])
      entries_.push_back({tangent.column[e], tangent.row[e], Kind::tangent, e, 0});
  }
  std::vector<int> place(problem_.constraints(), -1);
  for (int k = 0; k < kept_rows(); ++k) place[kept_[k]] = k;
  const Pattern& jacobian = problem_.jacobian_pattern();
  for (int e = 0; e < jacobian.size(); ++e) {
    const int k = place[jacobian.row[e]];
    if (k < 0) continue;
    entries_.push_back({jacobian.column[e], n_ + k, Kind::transposed, e, 0});
    entries_.push_back({n_ + k, jacobian.column[e], Kind::row, e, k});
  }
  for (int k = 0; k < kept_rows(); ++k) {
    const int row = n_ + k;
    if (kept_[k] >= problem_.equalities()) entries_.push_back({row, row, Kind::own, 0, k});
  }
  std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.row < b.row; });
  first_.assign(size() + 1, 0);
  for (const Entry& entry : entries_) ++first_[entry.row + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  slope_.resize(entries_.size());
}

void StationarySystem::evaluate(const std::vector<double>& z) {
  if (!evaluated_ || !std::equal(at_.x.begin(), at_.x.end(), z.begin())) {
    at_.x = x_of(z);
    problem_.evaluate(at_);
    evaluated_ = true;
    ++evaluations_;
  }
  for (int k = 0; k < kept_rows(); ++k) y_[kept_[k]] = z[n_ + k];
  unbalanced(problem_, at_, y_, force_);
  std::copy(force_.begin(), force_.end(), residual_.begin());
  for (int k = 0; k < kept_rows(); ++k) meet(k);
}

void StationarySystem::meet(int kept) {
  const int row = kept_[kept];
  const double value = at_.constraint[row];
  const int inequality = row - problem_.equalities();
  if (inequality < 0) {
    residual_[n_ + kept] = gap_weight * value;
    return;
  }
  const Complementarity above(problem_.upper()[inequality] - value, y_[row]);
  const Complementarity both(value - problem_.lower()[inequality], -above.value);
  residual_[n_ + kept] = both.value;
  by_row_[kept] = both.by_a + both.by_b * above.by_a;
  by_multiplier_[kept] = -both.by_b * above.by_b;
}

void StationarySystem::differentiate() {
  problem_.tangent(at_, y_, tangent_);
  for (int e = 0; e < static_cast<int>(entries_.size()); ++e) {
    const Entry& entry = entries_[e];
    switch (entry.kind) {
      case Kind::tangent:
        slope_[e] = tangent_[entry.source];
        break;
      case Kind::transposed:
        slope_[e] = at_.jacobian[entry.source];
        break;
      case Kind::row:
        slope_[e] = by_row_[entry.kept] * at_.jacobian[entry.source];
        break;
      case Kind::own:
        slope_[e] = by_multiplier_[entry.kept];
        break;
    }
  }
}

double StationarySystem::error() const {
  double worst = largest(force_) / (1.0 + largest(at_.gradient));
  for (int k = 0; k < kept_rows(); ++k) {
    const double weight = kept_[k] < problem_.equalities() ? gap_weight : 1.0;
    worst = std::max(worst, std::abs(residual_[n_ + k]) / weight);
  }
  const bool known = std::all_of(residual_.begin(), residual_.end(), [](double r) { return std::isfinite(r); });
  return known ? worst : std::numeric_limits<double>::infinity();
}

std::vector<double> StationarySystem::x_of(const std::vector<double>& z) const { return {z.begin(), z.begin() + n_}; }

std::vector<double> StationarySystem::multipliers_of(const std::vector<double>& z) const {
  std::vector<double> y(problem_.constraints(), 0.0);
  for (int k = 0; k < kept_rows(); ++k) y[kept_[k]] = z[n_ + k];
  return y;
}

}  // namespace poise::solvers
