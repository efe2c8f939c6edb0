#include "design/balance/bounded_system.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "solvers/linear_algebra.hpp"
#include "solvers/linear_program.hpp"

namespace poise {
namespace {

constexpr double repeats = 1e-11;  // equations and unknowns that are others to rounding
constexpr double misses = 1e-9;    // of the right side: more is no rounding
constexpr double eased = 1e-13;    // by which bounds may be passed in the program, before x is put within them

using solvers::LinearProgramResult;

// The system in unknowns whose columns, and a right side, have the size 1.
struct ScaledSystem {
  BoundedSystem system;
  Eigen::VectorXd unit;  // x = unit * scaled x
  double size = 1.0;
};

ScaledSystem to_size(const BoundedSystem& s) {
  ScaledSystem out;
  out.size = std::max(s.size, s.b.size() > 0 ? s.b.cwiseAbs().maxCoeff() : 0.0);
  if (out.size == 0.0) out.size = 1.0;
  out.unit = Eigen::VectorXd::Ones(s.a.cols());
  for (Eigen::Index j = 0; j < s.a.cols(); ++j) {
    const double column = s.a.rows() > 0 ? s.a.col(j).cwiseAbs().maxCoeff() : 0.0;
    if (column > 0.0) out.unit[j] = out.size / column;
  }
  out.system.a = s.a * out.unit.asDiagonal() / out.size;
  out.system.b = s.b / out.size;
  out.system.g = s.g * out.unit.asDiagonal();
  out.system.h = s.h;
  for (Eigen::Index i = 0; i < out.system.g.rows(); ++i) {
    const double row = out.system.g.cols() > 0 ? out.system.g.row(i).cwiseAbs().maxCoeff() : 0.0;
    if (row > 0.0) {
      out.system.g.row(i) /= row;
      out.system.h[i] /= row;
    }
  }
  out.system.cost = out.unit.cwiseProduct(s.cost);
  out.system.near = s.near.cwiseQuotient(out.unit);
  return out;
}

// Multipliers of the rows of g as they were before they were scaled.
Eigen::VectorXd unscaled(const BoundedSystem& s, const ScaledSystem& scaled, const Eigen::VectorXd& mu) {
  Eigen::VectorXd out = mu;
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    const double row = (s.g.row(i) * scaled.unit.asDiagonal()).cwiseAbs().maxCoeff();
    if (row > 0.0) out[i] /= row;
  }
  return out;
}

// An equation that no x within the bounds meets.
bool refuted_by_one(const BoundedSystem& s, BoundedSolution& out) {
  double worst = misses;
  for (Eigen::Index i = 0; i < s.a.rows(); ++i) {
    for (const double sign : {1.0, -1.0}) {
      const Eigen::VectorXd along = sign * s.a.row(i).transpose();
      double most = 0.0;
      Eigen::VectorXd mu = Eigen::VectorXd::Zero(s.g.rows());
      if (along.cwiseAbs().maxCoeff() > repeats) {
        const LinearProgramResult best = solvers::solve({s.g, s.h, along});
        if (best.status != LinearProgramResult::Status::optimal) continue;
        most = along.dot(best.x);
        mu = best.multipliers;
      }
      if (sign * s.b[i] - most <= worst) continue;
      worst = sign * s.b[i] - most;
      out.row = static_cast<int>(i);
      out.y = Eigen::VectorXd::Zero(s.a.rows());
      out.y[i] = sign;
      out.mu = mu;
    }
  }
  return out.row >= 0;
}

// The nearest x that meets the equations and is on the bounds that it is near to, which were eased.
Eigen::VectorXd on_bounds(const BoundedSystem& s, const Eigen::VectorXd& x) {
  constexpr double near = 1e-9;
  std::vector<Eigen::Index> active;
  const Eigen::VectorXd left = s.h - s.g * x;
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    if (left[i] < near * std::max(1.0, x.cwiseAbs().maxCoeff())) active.push_back(i);
  }
  const auto rows = s.a.rows(), more = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd a(rows + more, x.size());
  Eigen::VectorXd missed(rows + more);
  a.topRows(rows) = s.a;
  missed.head(rows) = s.b - s.a * x;
  for (Eigen::Index k = 0; k < more; ++k) {
    a.row(rows + k) = s.g.row(active[static_cast<std::size_t>(k)]);
    missed[rows + k] = left[active[static_cast<std::size_t>(k)]];
  }
  return x + solvers::minimum_norm_solution<double>(a, missed, repeats);
}

// x = from + open w within the bounds, with least cost.
bool least_cost(const BoundedSystem& s, const Eigen::VectorXd& from, const Eigen::MatrixXd& open,
                BoundedSolution& out) {
  const double room = eased * std::max(1.0, from.cwiseAbs().maxCoeff());
  const Eigen::VectorXd left = s.h - s.g * from;
  const Eigen::VectorXd eased_left = left.array() + room;
  if (open.cols() == 0) {
    if (left.size() > 0 && left.minCoeff() < -room) {
      Eigen::Index worst = 0;
      left.minCoeff(&worst);
      out.mu = Eigen::VectorXd::Unit(s.g.rows(), worst);
      out.y = solvers::minimum_norm_solution<double>(s.a.transpose(), s.g.transpose() * out.mu, repeats);
      return false;
    }
    out.x = from;
    return true;
  }
  if (s.cost.isZero() && (left.size() == 0 || left.minCoeff() >= 0.0)) {
    out.x = from;
    return true;
  }
  const LinearProgramResult best = solvers::solve({s.g * open, eased_left, -(open.transpose() * s.cost)});
  if (best.status == LinearProgramResult::Status::optimal) {
    out.x = on_bounds(s, from + open * best.x);
    return true;
  }
  if (best.status == LinearProgramResult::Status::infeasible) {
    out.mu = best.multipliers;
    out.y = solvers::minimum_norm_solution<double>(s.a.transpose(), s.g.transpose() * out.mu, repeats);
  }
  return false;
}

}  // namespace

BoundedSolution solve(const BoundedSystem& given) {
  const ScaledSystem scaled = to_size(given);
  const BoundedSystem& s = scaled.system;
  BoundedSolution out;
  const solvers::LeastSquares<double> equations(s.a, repeats);
  const Eigen::VectorXd from = s.near + equations.solve(s.b - s.a * s.near);
  const Eigen::VectorXd missed = s.b - s.a * from;
  const bool consistent = missed.size() == 0 || missed.cwiseAbs().maxCoeff() <= misses;
  if (consistent && least_cost(s, from, equations.null_space(), out)) {
    out.solved = true;
    out.x = scaled.unit.cwiseProduct(out.x);
    out.residual = given.b.size() > 0 ? (given.a * out.x - given.b).cwiseAbs().maxCoeff() / scaled.size : 0.0;
    return out;
  }
  if (!consistent) {
    out.y = missed;
    out.mu = Eigen::VectorXd::Zero(s.g.rows());
  }
  refuted_by_one(s, out);
  if (out.y.size() == 0) return out;
  // a' y = g' mu of the scaled rows: per unknown the same factor, and a over the size.
  out.mu = unscaled(given, scaled, out.mu * scaled.size);
  const double largest = out.y.cwiseAbs().maxCoeff();
  out.y /= largest;
  out.mu /= largest;
  out.demand = out.y.dot(given.b);
  out.most = out.mu.dot(given.h);
  return out;
}

bool is_refutation(const BoundedSystem& system, const BoundedSolution& solution, const Eigen::VectorXd& largest) {
  if (solution.y.size() != system.a.rows() || solution.mu.size() != system.g.rows()) return false;
  if (solution.mu.size() > 0 && solution.mu.minCoeff() < 0.0) return false;
  const Eigen::VectorXd left = system.a.transpose() * solution.y - system.g.transpose() * solution.mu;
  return solution.demand - solution.most > left.cwiseAbs().dot(largest);
}

}  // namespace poise
