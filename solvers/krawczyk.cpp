#include "solvers/krawczyk.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace poise::solvers {
namespace {

std::vector<Ball> times_vector(const Eigen::MatrixXd& c, const std::vector<Ball>& v) {
  std::vector<Ball> out(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) {
      const double factor = c(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      if (factor != 0.0) out[i] += Ball(factor) * v[j];
    }
  }
  return out;
}

/// Row i of (I - C DH(U)) (U - m).
Ball spread_of(std::size_t i, const Eigen::MatrixXd& inverse, const std::vector<std::vector<Ball>>& by,
               const std::vector<Ball>& away) {
  Ball spread(0);
  for (std::size_t j = 0; j < away.size(); ++j) {
    Ball entry(i == j ? 1 : 0);
    for (std::size_t k = 0; k < away.size(); ++k) {
      const double factor = inverse(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      if (factor != 0.0) entry -= Ball(factor) * by[k][j];
    }
    spread += entry * away[j];
  }
  return spread;
}

}  // namespace

KrawczykProof krawczyk(std::vector<Ball> point, const Eigen::MatrixXd& inverse, const BallFunction& evaluate) {
  constexpr int refinements = 3;
  constexpr double farthest = 1e-6;  // that the refined point may be from the given one, which converged in double
  KrawczykProof out;
  const std::vector<Ball> given = point;
  std::vector<Ball> values, step;
  for (int k = 0; k <= refinements; ++k) {
    if (!evaluate(point, values, nullptr)) {
      out.undecided = true;
      return out;
    }
    step = times_vector(inverse, values);
    if (k == refinements) break;
    for (std::size_t i = 0; i < point.size(); ++i) point[i] = (point[i] - step[i]).midpoint();
  }
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (!((point[i] - given[i]).greatest() <= farthest * std::max(1.0, std::abs(given[i].middle())))) return out;
  }
  for (const double reach : {1e-12, 1e-10, 1e-8}) {
    std::vector<Ball> box, away;
    for (const Ball& m : point) {
      const double r = reach * std::max(1.0, std::abs(m.middle()));
      box.push_back(m.widened(r));
      away.push_back(Ball(0).widened(r));
    }
    std::vector<std::vector<Ball>> by;
    if (!evaluate(box, values, &by)) {
      out.undecided = true;
      return out;
    }
    bool inside = true;
    std::vector<Ball> solution = point;
    for (std::size_t i = 0; i < point.size() && inside; ++i) {
      const Ball change = spread_of(i, inverse, by, away) - step[i];
      inside = change.is_finite() && change.greatest() < away[i].radius();
      solution[i] = point[i] + change;
    }
    if (!inside) continue;
    out.proved = true;
    out.solution = std::move(solution);
    out.reach = reach;
    return out;
  }
  return out;
}

}  // namespace poise::solvers
