#include "statics/inverse/fold_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/krawczyk.hpp"
#include "solvers/linear_algebra.hpp"
#include "statics/inverse/along_dual.hpp"

namespace poise {

namespace {

constexpr int fold_lanes = 8;
constexpr std::size_t fold_ball_lanes = 4;

}  // namespace

FoldEquations::FoldEquations(const UnknownNumbers& numbers, std::vector<ActingStop> acting)
    : numbers_(&numbers), equations_(numbers.list(), std::move(acting)) {}

template <class Along>
std::vector<Along> FoldEquations::evaluate(const std::vector<Along>& p, const std::vector<Along>& z) const {
  std::vector<Along> r(z.size());
  std::vector<NumberedEquations::Placed<Along>> placed;
  equations_.residual(p.data(), z.data(), r.data(), placed);
  return r;
}

bool FoldEquations::enclose(const std::vector<double>& given, const std::vector<int>& kept, const std::vector<Ball>& u,
                            std::vector<Ball>& values, std::vector<std::vector<Ball>>* by) const {
  const Ball::Undecided undecided;
  const auto n = static_cast<std::size_t>(unknowns());
  std::vector<Ball> all;
  for (const double value : given) all.emplace_back(value);
  for (std::size_t k = 0; k < u.size(); ++k) all[static_cast<std::size_t>(kept[k])] = u[k];
  if (by != nullptr) by->assign(u.size(), {});
  for (std::size_t first = 0; first < (by == nullptr ? 1 : u.size()); first += fold_ball_lanes) {
    const std::size_t lanes = by == nullptr ? 0 : std::min(fold_ball_lanes, u.size() - first);
    std::vector<BallAlong> z, s{BallAlong(all.back())};
    for (std::size_t i = 0; i < n; ++i) {
      z.emplace_back(all[i]);
      z.back().w = all[n + i];
    }
    for (std::size_t l = 0; l < lanes; ++l) {
      const auto k = static_cast<std::size_t>(kept[first + l]);
      if (k < n) z[k].by[l] = Ball(1);
      if (k >= n && k < 2 * n) z[k - n].m[l] = Ball(1);
      if (k == 2 * n) s[0].by[l] = Ball(1);
    }
    const std::vector<BallAlong> r = evaluate(numbers_->enclosed(s), z);
    values.clear();
    for (std::size_t row = 0; row < u.size(); ++row) {
      const auto k = static_cast<std::size_t>(kept[row]);
      if (k == 2 * n) {
        values.push_back(all[n + static_cast<std::size_t>(held_)] - Ball(1));
      } else {
        values.push_back(k < n ? r[k].a : r[k - n].w);
      }
      for (std::size_t l = 0; l < lanes; ++l) {
        const bool is_held = kept[first + l] == unknowns() + held_;
        (*by)[row].push_back(k == 2 * n ? Ball(is_held ? 1 : 0) : k < n ? r[k].by[l] : r[k - n].m[l]);
      }
    }
  }
  return !undecided.any();
}

LeftSides FoldEquations::differentiate(const Point& at) const {
  using Along = AlongDual<double, fold_lanes>;
  const int n = unknowns(), all = 2 * n + 1;
  const std::vector<double> p = numbers_->at({at.s});
  const UnknownNumbers::Slopes slopes = numbers_->slopes(p);
  LeftSides out{Eigen::VectorXd(all), Eigen::MatrixXd::Zero(all, all)};
  for (int first = 0; first < all; first += fold_lanes) {
    const int count = std::min(fold_lanes, all - first);
    std::vector<Along> z(at.z.begin(), at.z.end()), numbers(p.begin(), p.end());
    for (std::size_t i = 0; i < z.size(); ++i) z[i].w = at.w[i];
    for (int l = 0; l < count; ++l) {
      const int k = first + l;
      const auto lane = static_cast<std::size_t>(l);
      if (k < n) z[static_cast<std::size_t>(k)].by[lane] = 1.0;
      if (k >= n && k < 2 * n) z[static_cast<std::size_t>(k - n)].m[lane] = 1.0;
      if (k < 2 * n) continue;
      for (const auto& [place, slope] : slopes[0]) numbers[static_cast<std::size_t>(place)].by[lane] += slope;
    }
    const std::vector<Along> r = evaluate(numbers, z);
    for (int i = 0; i < n; ++i) {
      const Along& one = r[static_cast<std::size_t>(i)];
      out.value[i] = one.a;
      out.value[n + i] = one.w;
      for (int l = 0; l < count; ++l) {
        out.by(i, first + l) = one.by[static_cast<std::size_t>(l)];
        out.by(n + i, first + l) = one.m[static_cast<std::size_t>(l)];
      }
    }
  }
  out.value[2 * n] = at.w[static_cast<std::size_t>(held_)] - 1.0;
  out.by(2 * n, n + held_) = 1.0;
  return out;
}

bool FoldEquations::solve(std::vector<double> poses, double s, Point& out) {
  const Eigen::Index n = unknowns(), bodies = equations_.poses();
  Point at{std::move(poses), std::vector<double>(static_cast<std::size_t>(n), 0.0), s};
  at.z.resize(static_cast<std::size_t>(n), 0.0);
  equations_.count_turns(at.z.data());
  LeftSides here = differentiate(at);
  const Eigen::VectorXd efforts = solvers::minimum_norm_solution<double>(
      here.by.block(0, bodies, bodies, n - bodies), -here.value.head(bodies), solvers::known_to::solution);
  std::copy(efforts.begin(), efforts.end(), at.z.begin() + bodies);
  here = differentiate(at);
  // Where joints repeat others the efforts have null vectors too: that of the fold moves the bodies.
  const solvers::SingularValues parts = solvers::singular_value_decomposition(here.by.topLeftCorner(n, n));
  Eigen::Index best = n - 1;
  for (Eigen::Index k = n - 1; k >= 0 && parts.values[k] < solvers::known_to::singular_point * parts.values[0]; --k) {
    if (parts.right.col(k).head(bodies).norm() > parts.right.col(best).head(bodies).norm()) best = k;
  }
  Eigen::VectorXd along = parts.right.col(best);
  Eigen::Index largest = 0;
  along.head(bodies).cwiseAbs().maxCoeff(&largest);
  held_ = static_cast<int>(largest);
  along /= along[largest];
  std::copy(along.begin(), along.end(), at.w.begin());
  Eigen::VectorXd u(2 * n + 1);
  std::copy(at.z.begin(), at.z.end(), u.begin());
  std::copy(at.w.begin(), at.w.end(), u.begin() + n);
  u[2 * n] = at.s;
  const auto point_of = [&](const Eigen::VectorXd& from) {
    return Point{{from.begin(), from.begin() + n}, {from.begin() + n, from.begin() + 2 * n}, from[2 * n]};
  };
  const bool converged = least_norm_newton(
      u, [&](const Eigen::VectorXd& from) { return differentiate(point_of(from)); },
      [&](Eigen::Index i) { return i < 2 * n && i % n >= bodies; });
  out = point_of(u);
  return converged;
}

double FoldEquations::rounding_effect(const Point& at) const {
  using Along = AlongDual<double, fold_lanes>;
  constexpr double rounding = 2.0 * std::numeric_limits<double>::epsilon();
  const int n = unknowns(), all = 2 * n + 1;
  const solvers::LeastSquares<double> transposed(differentiate(at).by.transpose(), solvers::known_to::solution);
  const Eigen::VectorXd row = transposed.solve(Eigen::VectorXd::Unit(all, all - 1));
  std::vector<Along> z(at.z.begin(), at.z.end());
  for (std::size_t i = 0; i < z.size(); ++i) z[i].w = at.w[i];
  const std::vector<double> p = numbers_->at({at.s});
  double out = 0.0;
  for (std::size_t first = 0; first < p.size(); first += fold_lanes) {
    const std::size_t lanes = std::min<std::size_t>(fold_lanes, p.size() - first);
    std::vector<Along> numbers(p.begin(), p.end());
    for (std::size_t l = 0; l < lanes; ++l) numbers[first + l].by[l] = 1.0;
    const std::vector<Along> r = evaluate(numbers, z);
    for (std::size_t l = 0; l < lanes; ++l) {
      double effect = 0.0;
      for (std::size_t i = 0; i < r.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        effect += row[k] * r[i].by[l] + row[n + k] * r[i].m[l];
      }
      if (std::isfinite(p[first + l]) && std::isfinite(effect)) out += rounding * std::abs(effect * p[first + l]);
    }
  }
  return out;
}

SolutionProof FoldEquations::prove(const Point& at) const {
  const int n = unknowns(), bodies = equations_.poses();
  SolutionProof out;
  const LeftSides here = differentiate(at);
  // The rows of joints that repeat others are left out, with their efforts and the changes of these.
  std::vector<int> kept;
  for (int i = 0; i < bodies; ++i) kept.push_back(i);
  for (const int k : independent_columns(here.by.block(bodies, 0, n - bodies, bodies).transpose())) {
    kept.push_back(bodies + k);
  }
  const std::size_t half = kept.size();
  for (std::size_t i = 0; i < half; ++i) kept.push_back(n + kept[i]);
  kept.push_back(2 * n);
  out.why = why_not_enclosed(*numbers_, equations_.scene(), static_cast<int>(kept.size()));
  if (!out.why.empty()) return out;
  const Eigen::MatrixXd inverse = inverse_of(here.by(kept, kept));
  if (!inverse.allFinite()) {
    out.why = "the fold does not move with the number";
    return out;
  }
  std::vector<double> given = at.z;
  given.insert(given.end(), at.w.begin(), at.w.end());
  given.push_back(at.s);
  std::vector<Ball> point;
  for (const int k : kept) point.emplace_back(given[static_cast<std::size_t>(k)]);
  const auto evaluate_balls = [&](const std::vector<Ball>& u, std::vector<Ball>& values,
                                  std::vector<std::vector<Ball>>* by) { return enclose(given, kept, u, values, by); };
  const solvers::KrawczykProof proof = solvers::krawczyk(std::move(point), inverse, evaluate_balls);
  if (!proof.proved) {
    out.why = proof.undecided ? "it lies where a law of force or a measure changes its piece"
                              : "the enclosure of the equations is not proved to have a solution";
    return out;
  }
  out.proved = true;
  out.part = {proof.solution.back().middle()};
  out.radius = {(proof.solution.back() - Ball(out.part[0])).greatest()};
  out.reach = proof.reach;
  return out;
}

}  // namespace poise
