#include "solvers/active_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace poise::solvers {

double violation(const Problem& problem, const Evaluation& at, int row) {
  const int inequality = row - problem.equalities();
  const double value = at.constraint[row];
  if (inequality < 0) return value;
  return std::max(0.0, value - problem.upper()[inequality]) + std::min(0.0, value - problem.lower()[inequality]);
}

ActiveSet::ActiveSet(const Problem& problem, const std::vector<int>& kept, const ActiveSetOptions& options)
    : problem_(problem),
      options_(options),
      equalities_(problem.equalities()),
      kept_(kept),
      flags_(problem.constraints(), 0),
      upper_(problem.constraints(), 0),
      releases_(problem.constraints(), 0) {
  if (kept_.empty()) {
    kept_.resize(problem.constraints());
    std::iota(kept_.begin(), kept_.end(), 0);
  }
  std::sort(kept_.begin(), kept_.end());
  const auto inequality = std::lower_bound(kept_.begin(), kept_.end(), equalities_);
  first_inequality_ = static_cast<int>(inequality - kept_.begin());
  for (auto r = kept_.begin(); r != inequality; ++r) flags_[*r] = 1;
  rows_.reserve(kept_.size());
  list_rows();
}

void ActiveSet::list_rows() {
  ++changes_;
  rows_.clear();
  for (const int r : kept_) {
    if (holds(r)) rows_.push_back(r);
  }
}

void ActiveSet::reset() {
  std::fill(releases_.begin() + equalities_, releases_.end(), 0);
  release_inequalities();
}

void ActiveSet::release_inequalities() {
  if (static_cast<int>(rows_.size()) == first_inequality_) return;
  std::fill(flags_.begin() + equalities_, flags_.end(), 0);
  list_rows();
}

void ActiveSet::activate(int row, bool upper) {
  flags_[row] = 1;
  upper_[row] = upper ? 1 : 0;
  list_rows();
}

bool ActiveSet::activate_violated(const Evaluation& at, double outside) {
  bool any = false;
  for (auto r = kept_.begin() + first_inequality_; r != kept_.end(); ++r) {
    if (holds(*r)) continue;
    const double above = at.constraint[*r] - problem_.upper()[*r - equalities_];
    const double below = problem_.lower()[*r - equalities_] - at.constraint[*r];
    if (!(std::max(above, below) > outside)) continue;
    flags_[*r] = 1;
    upper_[*r] = above > below ? 1 : 0;
    any = true;
  }
  if (any) list_rows();
  return any;
}

ActiveSet::Release ActiveSet::release_wrong_sign(std::span<const double> multipliers, double least) {
  int worst = -1;
  double strongest = least;
  for (auto r = rows_.begin() + first_inequality_; r != rows_.end(); ++r) {
    if (problem_.lower()[*r - equalities_] == problem_.upper()[*r - equalities_]) continue;
    const double pull = upper_[*r] != 0 ? -multipliers[*r] : multipliers[*r];
    if (pull > strongest) {
      strongest = pull;
      worst = *r;
    }
  }
  if (worst < 0) return Release::none;
  if (releases_[worst] >= options_.releases) return Release::cycling;
  ++releases_[worst];
  flags_[worst] = 0;
  list_rows();
  return Release::released;
}

double ActiveSet::gap(const Evaluation& at, int row) const {
  const int inequality = row - equalities_;
  if (inequality < 0) return at.constraint[row];
  return at.constraint[row] - (upper_[row] != 0 ? problem_.upper()[inequality] : problem_.lower()[inequality]);
}

void ActiveSet::gaps(const Evaluation& at, std::span<double> out) const {
  for (int r = 0; r < equalities_; ++r) out[r] = at.constraint[r];
  for (int r = 0; first_inequality_ < equalities_ && r < equalities_; ++r) {
    if (!holds(r)) out[r] = 0.0;
  }
  for (int r = equalities_; r < static_cast<int>(out.size()); ++r) out[r] = holds(r) ? gap(at, r) : 0.0;
}

double ActiveSet::largest_gap(const Evaluation& at) const {
  double worst = 0.0;
  for (const int r : kept_) {
    const double left = std::abs(holds(r) ? gap(at, r) : violation(problem_, at, r));
    worst = std::isnan(left) ? std::numeric_limits<double>::infinity() : std::max(worst, left);
  }
  return worst;
}

double ActiveSet::largest_left_out(const Evaluation& at) const {
  double worst = 0.0;
  for (int r = 0; r < problem_.constraints(); ++r) {
    if (!std::binary_search(kept_.begin(), kept_.end(), r))
      worst = std::max(worst, std::abs(violation(problem_, at, r)));
  }
  return worst;
}

void ActiveSet::clear_inactive(std::span<double> multipliers) const {
  for (int r = 0; r < static_cast<int>(multipliers.size()); ++r) {
    if (!holds(r)) multipliers[r] = 0.0;
  }
}

ActiveSet::Crossing ActiveSet::first_crossing(const Evaluation& from, const Evaluation& to) const {
  Crossing first;
  for (auto r = kept_.begin() + first_inequality_; r != kept_.end(); ++r) {
    if (holds(*r)) continue;
    const double outside = violation(problem_, to, *r);
    if (outside == 0.0) continue;
    if (std::abs(outside) <= options_.touching) {
      first.row = *r;
      first.upper = outside > 0;
      continue;
    }
    const double travelled = to.constraint[*r] - from.constraint[*r];
    // Aim just beyond the bound, so that the next trial ends outside within the touching distance and not short of it.
    const double aim = outside - std::copysign(0.5 * options_.touching, outside);
    first.fraction = std::min(first.fraction, std::max(0.0, 1.0 - aim / travelled));
  }
  if (first.fraction < 1.0) first.row = -1;
  return first;
}

}  // namespace poise::solvers
