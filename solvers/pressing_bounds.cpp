#include "solvers/pressing_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double tried_within = 1e-9;    // way back from which the same bounds are not tried again
constexpr std::size_t most_touched = 8;  // bounds of which all sets are tried
constexpr double goes_into = 1e-9;       // rate, relative to the velocity, that is rounding

}  // namespace

PressingBounds::PressingBounds(const DampedProblem& problem, double touching, Kkt& kkt)
    : active(problem.constraints(), 0),
      gap(problem.constraints()),
      problem_(problem),
      touching_(touching),
      kkt_(kkt),
      n_(problem.variables()),
      equalities_(problem.equalities()),
      rows_(problem.constraints()),
      upper_(rows_, 0),
      idle_(rows_, 0),
      resistance_(problem.tangent_pattern().size()) {}

void PressingBounds::begin() {
  std::fill(active.begin(), active.end(), 0);
  std::fill(active.begin(), active.begin() + equalities_, 1);
  std::fill(idle_.begin(), idle_.end(), 0);
  tried_.clear();
  scale_ = 0.0;
}

double PressingBounds::noise() const { return 16 * std::numeric_limits<double>::epsilon() * scale_; }

double PressingBounds::gap_of(const Evaluation& at, int row) const {
  return row < equalities_ ? at.constraint[row] : at.constraint[row] - bound(row);
}

void PressingBounds::find_gap(const Evaluation& at) {
  for (int r = 0; r < rows_; ++r) gap[r] = active[r] != 0 ? gap_of(at, r) : 0.0;
}

bool PressingBounds::set_velocity(Evaluation& at, std::span<double> v, std::span<double> y) {
  problem_.resistance(at, resistance_);
  if (!kkt_.set_jacobian(at, active) || kkt_.factor_tangent(resistance_) == Kkt::Factors::singular) return false;
  kkt_.solve(at.gradient, {}, v);
  kkt_.solved_multipliers(at.gradient, y);
  scale_ = std::max({scale_, largest(at.gradient), largest(y)});
  return std::isfinite(largest(v));
}

double PressingBounds::pull(int row, std::span<const double> y) const {
  const int k = row - equalities_;
  if (problem_.lower()[k] == problem_.upper()[k]) return 0.0;
  return upper_[row] != 0 ? -y[row] : y[row];
}

double PressingBounds::distance(const Evaluation& at, int row, char* upper) const {
  const int k = row - equalities_;
  const double below = problem_.upper()[k] - at.constraint[row];
  const double above = at.constraint[row] - problem_.lower()[k];
  if (upper != nullptr) *upper = below < above ? 1 : 0;
  return std::min(below, above);
}

double PressingBounds::rate(const Evaluation& at, int row, std::span<const double> v) const {
  const Pattern& pattern = problem_.jacobian_pattern();
  double sum = 0.0;
  for (int e = 0; e < pattern.size(); ++e) {
    if (pattern.row[e] == row) sum += at.jacobian[e] * v[pattern.column[e]];
  }
  return sum;
}

bool PressingBounds::choose(Evaluation& now, std::span<double> v, std::span<double> y) {
  for (int r = equalities_; r < rows_; ++r) {
    if (active[r] == 0 && idle_[r] == 0 && distance(now, r, &upper_[r]) <= touching_) active[r] = 1;
  }
  for (int k = 0; k < 4 * rows_ + 4; ++k) {
    if (!set_velocity(now, v, y)) return false;
    int worst = -1;
    double most = noise();
    for (int r = equalities_; r < rows_; ++r) {
      if (active[r] == 0 || pull(r, y) <= most) continue;
      worst = r;
      most = pull(r, y);
    }
    if (worst >= 0) {
      active[worst] = 0;
      continue;
    }
    for (int r = equalities_; r < rows_ && worst < 0; ++r) {
      char upper = 0;
      if (active[r] != 0 || distance(now, r, &upper) > touching_) continue;
      const double into = rate(now, r, v) * (upper != 0 ? 1.0 : -1.0);
      if (into <= 1e-12 * (1.0 + largest(v))) continue;
      worst = r;
      upper_[r] = upper;
    }
    if (worst < 0) return true;
    active[worst] = 1;
    idle_[worst] = 0;
  }
  return true;
}

bool PressingBounds::release_idle(Evaluation& now, std::span<double> v, std::span<double> y) {
  if (!set_velocity(now, v, y) || !kkt_.redundant()) return false;
  bool any = false;
  for (int r = equalities_; r < rows_; ++r) {
    if (active[r] == 0 || y[r] != 0.0 || problem_.lower()[r - equalities_] == problem_.upper()[r - equalities_]) {
      continue;
    }
    active[r] = 0;
    idle_[r] = 1;
    any = true;
  }
  return any && choose(now, v, y);
}

bool PressingBounds::choose_otherwise(Evaluation& now, std::span<double> v, std::span<double> y) {
  double moved = 0.0;
  for (int i = 0; i < n_ && !tried_.empty(); ++i) moved = std::max(moved, std::abs(now.x[i] - tried_at_[i]));
  if (moved > tried_within) tried_.clear();
  tried_at_ = now.x;
  std::vector<int> touched;
  for (int r = equalities_; r < rows_; ++r) {
    const int k = r - equalities_;
    if (problem_.lower()[k] == problem_.upper()[k]) continue;
    if (active[r] != 0 || distance(now, r, &upper_[r]) <= touching_) touched.push_back(r);
  }
  if (touched.size() > most_touched) return false;
  const std::vector<char> active_before = active, idle_before = idle_;
  for (unsigned set = 1U << touched.size(); set-- > 0;) {
    for (std::size_t k = 0; k < touched.size(); ++k) {
      active[touched[k]] = (set >> k & 1U) != 0 ? 1 : 0;
      idle_[touched[k]] = 1 - active[touched[k]];
    }
    if (std::find(tried_.begin(), tried_.end(), active) != tried_.end()) continue;
    tried_.push_back(active);
    if (!set_velocity(now, v, y) || kkt_.redundant()) continue;
    const bool holds = std::all_of(touched.begin(), touched.end(), [&](int r) {
      return active[r] != 0 ? pull(r, y) <= noise()
                            : rate(now, r, v) * (upper_[r] != 0 ? 1.0 : -1.0) <= goes_into * (1.0 + largest(v));
    });
    if (holds) return true;
  }
  active = active_before;
  idle_ = idle_before;
  return false;
}

}  // namespace poise::solvers
