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
  const LeftSides here = differentiate(at);
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

LeftSides ConditionedEquilibrium::differentiate(const Point& at) const {
  const int n = equations_.unknowns(), all = size();
  const std::vector<double> p = numbers_->at(at.s);
  const UnknownNumbers::Slopes slopes = numbers_->slopes(p);
  LeftSides out{Eigen::VectorXd(all), Eigen::MatrixXd(all, all)};
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

std::vector<double> ConditionedEquilibrium::rounding_effect(const Point& at) const {
  constexpr double rounding = 2.0 * std::numeric_limits<double>::epsilon();
  const int n = equations_.unknowns(), all = size(), count = numbers_->count();
  // Rows l of the inverse:  ds = -l dH.
  const solvers::LeastSquares<double> transposed(differentiate(at).by.transpose(), solvers::known_to::solution);
  Eigen::MatrixXd rows(all, count);
  for (int k = 0; k < count; ++k) rows.col(k) = transposed.solve(Eigen::VectorXd::Unit(all, n + k));
  std::vector<double> out(static_cast<std::size_t>(count), 0.0);
  for (int k = 0; k < count; ++k) {
    for (int c = 0; c < count; ++c) {
      out[static_cast<std::size_t>(k)] +=
          rounding * std::abs(rows(n + c, k) * conditions_[static_cast<std::size_t>(c)].value);
    }
  }
  const std::vector<double> p = numbers_->at(at.s);
  std::vector<ConditionDual> z(at.z.begin(), at.z.end()), numbers(p.begin(), p.end()), values;
  const int last = static_cast<int>(p.size());
  for (int first = 0; first < last; first += lanes_at_once) {
    const int lanes = std::min(lanes_at_once, last - first);
    for (int l = 0; l < lanes; ++l) numbers[static_cast<std::size_t>(first + l)].v[l] = 1.0;
    evaluate(numbers.data(), z.data(), values);
    for (int l = 0; l < lanes; ++l) {
      const auto j = static_cast<std::size_t>(first + l);
      numbers[j].v[l] = 0.0;
      if (!std::isfinite(p[j])) continue;
      Eigen::VectorXd by(all);
      for (int i = 0; i < all; ++i) by[i] = values[static_cast<std::size_t>(i)].v[l];
      if (!by.allFinite()) continue;
      for (int k = 0; k < count; ++k)
        out[static_cast<std::size_t>(k)] += rounding * std::abs(rows.col(k).dot(by) * p[j]);
    }
  }
  return out;
}

template <class Replace>
bool ConditionedEquilibrium::improve(Point& at, Replace replace) const {
  const Eigen::Index n = equations_.unknowns(), all = size();
  Eigen::VectorXd u(all);
  std::copy(at.z.begin(), at.z.end(), u.begin());
  std::copy(at.s.begin(), at.s.end(), u.begin() + n);
  const auto point_of = [&](const Eigen::VectorXd& from) {
    return Point{{from.begin(), from.begin() + n}, {from.begin() + n, from.end()}};
  };
  const bool converged = least_norm_newton(
      u,
      [&](const Eigen::VectorXd& from) {
        const Point there = point_of(from);
        LeftSides sides = differentiate(there);
        replace(there, sides);
        return sides;
      },
      [&](Eigen::Index i) { return i >= equations_.poses() && i < n; });
  at = point_of(u);
  return converged;
}

bool ConditionedEquilibrium::solve(Point& at) const {
  return improve(at, [](const Point&, LeftSides&) {});
}

bool ConditionedEquilibrium::solve_across(Point& at, const Point& through, const Eigen::VectorXd& along) const {
  return improve(at, [&](const Point& here, LeftSides& derivatives) {
    const Eigen::Index last = derivatives.value.size() - 1;
    derivatives.value[last] = along.dot(difference(through, here));
    derivatives.by.row(last) = along.transpose();
  });
}

}  // namespace poise
