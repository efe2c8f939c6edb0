#include "solvers/curve_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/LU>

#include "solvers/linear_algebra.hpp"
#include "solvers/vectors.hpp"

namespace poise::solvers {
namespace {

constexpr double unit_roundoff = std::numeric_limits<double>::epsilon();
constexpr double least_tangent_cosine = 0.9;  // between the tangents of a step's ends
constexpr int largest_dense_curve = 48;  // variables up to which factors are dense and gaps between branches detected
constexpr int corrections = 12;

}  // namespace

CurvePoints::CurvePoints(const DampedProblem& problem)
    : active(problem.constraints(), 0),
      problem_(problem),
      n_(problem.variables()),
      equalities_(problem.equalities()),
      dense_(!problem.has_objective() || n_ <= largest_dense_curve),
      kkt_(dense_ ? make_null_space(problem) : make_sparse_kkt(problem)),
      bounds_(problem.limits()),
      gap_(problem.constraints()),
      step_(n_),
      field_(n_),
      y_(problem.constraints()),
      tangent_(problem.tangent_pattern().size()),
      measures_(problem.switches().size()),
      side_(problem.switches().size(), 1.0) {
  std::fill(active.begin(), active.begin() + equalities_, 1);
  std::vector<std::vector<std::size_t>> bounds_of(problem.constraints() - equalities_);
  for (std::size_t b = 0; b < bounds_.size(); ++b) bounds_of[bounds_[b].inequality].push_back(b);
  const Pattern& pattern = problem.jacobian_pattern();
  for (int e = 0; e < pattern.size(); ++e) {
    if (pattern.row[e] < equalities_) continue;
    for (const std::size_t b : bounds_of[pattern.row[e] - equalities_]) bound_entries_.emplace_back(e, b);
  }
}

CurvePoints::Point CurvePoints::make() const {
  Point out;
  out.at = problem_.make_evaluation();
  out.t.resize(n_);
  out.value.resize(functions());
  out.slope.resize(functions());
  return out;
}

double CurvePoints::noise_of(const Point& p, int function) const {
  return function == 0 ? p.noise : 4 * unit_roundoff * (1.0 + largest(p.at.x));
}

Cubic CurvePoints::cubic(const Point& left, const Point& a, const Point& b, int function) {
  return {a.value[function], a.slope[function] / dot(left.t, a.t), b.value[function],
          b.slope[function] / dot(left.t, b.t), b.sigma - a.sigma};
}

bool CurvePoints::begin(std::span<const double> x, Point& p) {
  std::fill(side_.begin(), side_.end(), 1.0);
  scale_ = 0.0;
  evaluations = 0;
  std::copy(x.begin(), x.end(), p.at.x.begin());
  problem_.evaluate(p.at);
  ++evaluations;
  if (!factor(p)) return false;
  // Any direction within the tangent will do.
  for (int i = 0; i < n_; ++i) step_[i] = 1.0 + 0.37 * std::sin(1.0 + 2.0 * i);
  if (!set_tangent(p, step_)) return false;
  if (std::abs(dot(p.t, p.at.gradient)) > 1e-6 * largest(p.at.gradient)) {
    for (int i = 0; i < n_; ++i) step_[i] = -p.at.gradient[i];
    if (!set_tangent(p, step_)) return false;
  } else if (dot(p.t, p.at.gradient) > 0) {
    for (double& t : p.t) t = -t;
  }
  choose_rows(p, rows_);
  set_functions(p);
  turn_switches(p);
  return true;
}

bool CurvePoints::factor(Point& p) {
  return kkt_->set_jacobian(p.at, active) && kkt_->factor_identity() != Kkt::Factors::singular;
}

// Sets t to the projection of `along` on the tangent, normalized; false if it vanishes.
bool CurvePoints::set_tangent(Point& p, std::span<const double> along) {
  for (int i = 0; i < n_; ++i) field_[i] = -along[i];
  kkt_->solve(field_, {}, p.t);
  const double length = std::sqrt(dot(p.t, p.t));
  if (!(length > 0.0) || !std::isfinite(length)) return false;
  for (double& t : p.t) t /= length;
  return true;
}

// Sets r and its slope, distances and switches; after factor() and set_tangent().
void CurvePoints::set_functions(Point& p) {
  kkt_->solve(p.at.gradient, {}, step_);
  kkt_->solved_multipliers(p.at.gradient, y_);
  problem_.tangent(p.at, y_, tangent_);
  const Pattern& pattern = problem_.tangent_pattern();
  const bool symmetric = problem_.has_objective();
  double bend = 0.0, stiffest = 0.0;
  for (int e = 0; e < pattern.size(); ++e) {
    const int i = pattern.row[e], j = pattern.column[e];
    const double part = tangent_[e] * p.t[i] * p.t[j];
    bend += symmetric && i != j ? 2 * part : part;
    stiffest = std::max(stiffest, std::abs(tangent_[e]));
  }
  p.value[0] = -dot(p.t, p.at.gradient);
  p.slope[0] = -bend;
  scale_ = std::max({scale_, largest(p.at.gradient), largest(y_)});
  // The problem is scaled, so that forces that cancel each other in the gradient are of the size 1.
  p.noise = 4 * unit_roundoff * (1.0 + scale_ + stiffest * std::max(1.0, largest(p.at.x)));
  set_distances(p);
  set_switches(p);
}

void CurvePoints::set_distances(Point& p) {
  if (bounds_.empty()) return;
  for (std::size_t b = 0; b < bounds_.size(); ++b) {
    const double g = p.at.constraint[equalities_ + bounds_[b].inequality];
    p.value[1 + b] = bounds_[b].sign * bounds_[b].threshold.past(g);
    p.slope[1 + b] = 0.0;
  }
  const Pattern& pattern = problem_.jacobian_pattern();
  for (const auto& [e, b] : bound_entries_) {
    const double by = bounds_[b].sign * bounds_[b].threshold.slope(p.at.constraint[pattern.row[e]]);
    p.slope[1 + b] += by * p.at.jacobian[e] * p.t[pattern.column[e]];
  }
}

void CurvePoints::set_switches(Point& p) {
  if (measures_.empty()) return;
  problem_.switch_measures(p.at, measures_);
  for (std::size_t k = 0; k < measures_.size(); ++k) {
    const Threshold& threshold = problem_.switches()[k];
    p.value[first_switch() + k] = side_[k] * threshold.past(measures_[k]);
    problem_.switch_gradient(p.at, static_cast<int>(k), field_);
    p.slope[first_switch() + k] = side_[k] * threshold.slope(measures_[k]) * dot(field_, p.t);
  }
}

void CurvePoints::turn_switches(Point& p) {
  for (std::size_t k = 0; k < side_.size(); ++k) {
    double& value = p.value[first_switch() + k];
    double& slope = p.slope[first_switch() + k];
    const bool touches = std::abs(value) <= 4 * unit_roundoff;
    if (touches ? slope < 0 : value < 0) {
      side_[k] = -side_[k];
      value = -value;
      slope = -slope;
    }
  }
}

// --- branches -------------------------------------------------------------------------------------------------------

void CurvePoints::dense_jacobian(const Point& p) {
  full_.setZero(equalities_, n_);
  const Pattern& pattern = problem_.jacobian_pattern();
  for (int e = 0; e < pattern.size(); ++e) {
    if (pattern.row[e] < equalities_) full_(pattern.row[e], pattern.column[e]) += p.at.jacobian[e];
  }
}

// Chooses n - 1 independent rows of J.
void CurvePoints::choose_rows(const Point& p, std::vector<int>& rows) {
  rows.resize(equalities_);
  std::iota(rows.begin(), rows.end(), 0);
  if (!dense_ || equalities_ == n_ - 1) return;
  dense_jacobian(p);
  const PivotOrder order = pivot_order<double>(full_.transpose(), known_to::rounding);
  const std::size_t kept = std::min<std::size_t>(order.columns.size(), static_cast<std::size_t>(n_ - 1));
  rows.assign(order.columns.begin(), order.columns.begin() + static_cast<std::ptrdiff_t>(kept));
  std::sort(rows.begin(), rows.end());
}

void CurvePoints::choose_rows_at(const Point& p) {
  if (dense_ && equalities_ > n_ - 1) choose_rows(p, rows_);
}

double CurvePoints::orientation(const Point& p, const std::vector<int>& rows) {
  if (static_cast<int>(rows.size()) != n_ - 1) return 1.0;
  dense_jacobian(p);
  square_.resize(n_, n_);
  for (int k = 0; k < n_ - 1; ++k) square_.row(k) = full_.row(rows[k]);
  for (int i = 0; i < n_; ++i) square_(n_ - 1, i) = p.t[i];
  return square_.partialPivLu().determinant();
}

// Whether the curve leads from one point to the other without a change of branch between.
bool CurvePoints::same_branch(const Point& from, const Point& to) {
  if (!dense_ || n_ == 1 || equalities_ == 0) return true;
  if (orientation(from, rows_) * orientation(to, rows_) > 0) return true;
  if (equalities_ == n_ - 1) return false;
  choose_rows(to, other_rows_);
  return orientation(from, other_rows_) * orientation(to, other_rows_) > 0;
}

// --- points of the curve --------------------------------------------------------------------------------------------

bool CurvePoints::correct(const Point& left, double sigma, Point& p) {
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < corrections; ++k) {
    problem_.evaluate(p.at);
    ++evaluations;
    double along = sigma;
    for (int i = 0; i < n_; ++i) along -= left.t[i] * (p.at.x[i] - left.at.x[i]);
    for (int r = 0; r < equalities_; ++r) gap_[r] = p.at.constraint[r];
    const double off = std::max(equalities_ > 0 ? largest(std::span(gap_).first(equalities_)) : 0.0, std::abs(along));
    if (!std::isfinite(off) || off > 4.0) return false;
    if (!factor(p)) return false;
    if (!set_tangent(p, left.t)) return false;
    if (off <= unit_roundoff * (1.0 + largest(p.at.x)) || (k > 1 && off > 0.25 * last && last < 1e-11)) {
      p.sigma = sigma;
      return true;
    }
    if (k > 4 && off > last) return false;
    last = off;
    kkt_->solve({}, gap_, step_);
    const double turned = dot(left.t, p.t);
    if (!(turned > 0.3)) return false;
    const double by = (along - dot(left.t, step_)) / turned;
    for (int i = 0; i < n_; ++i) p.at.x[i] += step_[i] + by * p.t[i];
  }
  return false;
}

bool CurvePoints::reach(const Point& left, double sigma, Point& p) {
  if (!correct(left, sigma, p)) return false;
  if (!(dot(left.t, p.t) > least_tangent_cosine) || !same_branch(left, p)) return false;
  set_functions(p);
  return true;
}

bool CurvePoints::reach_between(const Point& left, const Point& a, const Point& b, double sigma, Point& p) {
  const double tau = (sigma - a.sigma) / (b.sigma - a.sigma);
  const double turned_a = dot(left.t, a.t), turned_b = dot(left.t, b.t);
  for (int i = 0; i < n_; ++i) {
    const Cubic x(a.at.x[i], a.t[i] / turned_a, b.at.x[i], b.t[i] / turned_b, b.sigma - a.sigma);
    p.at.x[i] = x.at(tau);
  }
  return reach(left, sigma, p);
}

}  // namespace poise::solvers
