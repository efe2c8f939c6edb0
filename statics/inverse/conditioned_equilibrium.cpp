#include "statics/inverse/conditioned_equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <ceres/jet.h>

#include "solvers/linear_algebra.hpp"
#include "statics/inverse/conditioned_impl.hpp"

namespace poise {
namespace {

constexpr int lanes_at_once = 8;
using ConditionDual = ceres::Jet<double, lanes_at_once>;

}  // namespace

ConditionedEquilibrium::ConditionedEquilibrium(const UnknownNumbers& numbers, ActingSet acting,
                                               std::vector<Condition> conditions)
    : numbers_(&numbers),
      acting_(std::move(acting)),
      conditions_(std::move(conditions)),
      equations_(numbers.list(), acting_.stops) {}

ConditionedEquilibrium::Point ConditionedEquilibrium::begin(std::vector<double> poses, std::vector<double> s) {
  const Eigen::Index bodies = equations_.poses(), rows = equations_.unknowns();
  Point at{std::move(poses), std::move(s)};
  at.z.resize(static_cast<std::size_t>(rows), 0.0);
  equations_.count_turns(at.z.data());
  const Derivatives here = differentiate(at);
  const Eigen::VectorXd efforts = solvers::minimum_norm_solution<double>(
      here.by.block(0, bodies, bodies, rows - bodies), -here.value.head(bodies), solvers::known_to::solution);
  std::copy(efforts.begin(), efforts.end(), at.z.begin() + bodies);
  return at;
}

Eigen::VectorXd ConditionedEquilibrium::excess(const Point& at) const {
  const std::vector<double> p = numbers_->at(at.s);
  std::vector<double> out;
  evaluate(p.data(), at.z.data(), out);
  return Eigen::Map<const Eigen::VectorXd>(out.data() + equations_.unknowns(), numbers_->count());
}

Eigen::VectorXd ConditionedEquilibrium::difference(const Point& from, const Point& to) const {
  Eigen::VectorXd out(size());
  Eigen::Index k = 0;
  for (std::size_t i = 0; i < from.z.size(); ++i) out[k++] = to.z[i] - from.z[i];
  for (std::size_t i = 0; i < from.s.size(); ++i) out[k++] = to.s[i] - from.s[i];
  return out;
}

ConditionedEquilibrium::Derivatives ConditionedEquilibrium::differentiate(const Point& at) const {
  const int n = equations_.unknowns(), all = size();
  const std::vector<double> p = numbers_->at(at.s);
  const UnknownNumbers::Slopes slopes = numbers_->slopes(p);
  Derivatives out{Eigen::VectorXd(all), Eigen::MatrixXd(all, all)};
  std::vector<ConditionDual> dual_z(at.z.begin(), at.z.end()), dual_p(p.begin(), p.end()), values;
  // The derivatives of variable k, in the lane l, set or cleared.
  const auto seed = [&](int k, int l, bool is_set) {
    if (k < n) {
      dual_z[static_cast<std::size_t>(k)].v[l] = is_set ? 1.0 : 0.0;
      return;
    }
    for (const auto& [place, slope] : slopes[static_cast<std::size_t>(k - n)]) {
      dual_p[static_cast<std::size_t>(place)].v[l] = is_set ? dual_p[static_cast<std::size_t>(place)].v[l] + slope : 0;
    }
  };
  for (int first = 0; first < all; first += lanes_at_once) {
    const int count = std::min(lanes_at_once, all - first);
    for (int l = 0; l < count; ++l) seed(first + l, l, true);
    evaluate(dual_p.data(), dual_z.data(), values);
    for (int i = 0; i < all; ++i) {
      out.value[i] = values[static_cast<std::size_t>(i)].a;
      for (int l = 0; l < count; ++l) out.by(i, first + l) = values[static_cast<std::size_t>(i)].v[l];
    }
    for (int l = 0; l < count; ++l) seed(first + l, l, false);
  }
  return out;
}

// Newton's steps of least norm, so that joints that repeat others do not matter, halved while they do not help.
template <class Replace>
bool ConditionedEquilibrium::improve(Point& at, Replace replace) const {
  constexpr int most_steps = 40, most_halvings = 8;
  constexpr double converged = 1e-13, near_enough = 1e-9, longest = 0.5;
  const int n = equations_.unknowns();
  const auto moved = [&](const Eigen::VectorXd& by, double part) {
    Point out = at;
    for (int i = 0; i < n; ++i) out.z[static_cast<std::size_t>(i)] += part * by[i];
    for (std::size_t k = 0; k < out.s.size(); ++k) out.s[k] += part * by[n + static_cast<Eigen::Index>(k)];
    return out;
  };
  double last = std::numeric_limits<double>::infinity();
  Derivatives here = differentiate(at);
  replace(at, here);
  for (int step = 0; step < most_steps; ++step) {
    if (!here.value.allFinite() || !here.by.allFinite()) return false;
    // Rows of one size, so that the rank does not depend on units.
    Eigen::VectorXd weight(here.value.size());
    for (Eigen::Index i = 0; i < weight.size(); ++i) weight[i] = 1.0 / std::max(here.by.row(i).norm(), 1e-300);
    const Eigen::MatrixXd matrix = weight.asDiagonal() * here.by;
    const Eigen::VectorXd right = -(weight.asDiagonal() * here.value);
    const Eigen::VectorXd by = solvers::minimum_norm_solution<double>(matrix, right, solvers::known_to::solution);
    if (!by.allFinite()) return false;
    double length = 0.0, poses = 0.0;
    for (Eigen::Index i = 0; i < by.size(); ++i) {
      const bool is_effort = i >= equations_.poses() && i < n;
      const double size = is_effort ? std::max(1.0, std::abs(at.z[static_cast<std::size_t>(i)])) : 1.0;
      length = std::max(length, std::abs(by[i]) / size);
      if (!is_effort) poses = std::max(poses, std::abs(by[i]));
    }
    double part = poses > longest ? longest / poses : 1.0;
    const double before = right.norm();
    bool is_better = false;
    for (int k = 0; k < most_halvings && !is_better; ++k, part *= 0.5) {
      const Point next = moved(by, part);
      Derivatives there = differentiate(next);
      replace(next, there);
      const double after = (weight.asDiagonal() * there.value).norm();
      is_better = after < before || length < near_enough;
      if (!is_better || !std::isfinite(after)) continue;
      at = next;
      here = std::move(there);
    }
    if (!is_better) return false;
    if (length < converged || (length < near_enough && length >= 0.5 * last)) return true;
    last = length;
  }
  return false;
}

bool ConditionedEquilibrium::solve(Point& at) const {
  return improve(at, [](const Point&, Derivatives&) {});
}

bool ConditionedEquilibrium::solve_across(Point& at, const Point& through, const Eigen::VectorXd& along) const {
  return improve(at, [&](const Point& here, Derivatives& derivatives) {
    const Eigen::Index last = derivatives.value.size() - 1;
    derivatives.value[last] = along.dot(difference(through, here));
    derivatives.by.row(last) = along.transpose();
  });
}

}  // namespace poise
