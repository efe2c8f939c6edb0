#include "statics/stability_on_cones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/linear_algebra.hpp"

namespace poise {

StabilityOnCones stability_on_cones(const Eigen::MatrixXd& h, const std::vector<Eigen::VectorXd>& acting,
                                    const std::vector<Eigen::VectorXd>& forbidden) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double margin = 1e-9;
  const Eigen::Index d = h.cols();
  if (d == 0) return {Stability::stable, true};
  double steepest = h.norm();
  for (const Eigen::VectorXd& a : acting) steepest += a.squaredNorm();
  const auto energy = [&](const Eigen::VectorXd& v) {
    for (const Eigen::VectorXd& a : forbidden) {
      if (a.dot(v) > 0.0) return infinity;
    }
    double q = v.dot(h * v);
    for (const Eigen::VectorXd& a : acting) q += std::pow(std::max(0.0, a.dot(v)), 2);
    return q;
  };
  double least = infinity;
  double between = 0.0;  // greatest decrease between two directions that were looked at
  if (d == 1) {
    for (const double way : {-1.0, 1.0}) least = std::min(least, energy(Eigen::VectorXd::Constant(1, way)));
  } else if (d == 2) {
    constexpr int directions = 7200;
    for (int k = 0; k < directions; ++k) {
      const double angle = 2 * M_PI * k / directions;
      least = std::min(least, energy(Eigen::Vector2d(std::cos(angle), std::sin(angle))));
    }
    between = 2 * steepest * M_PI / directions;
  } else {
    const solvers::SymmetricEigen eigen = solvers::symmetric_eigen(h);
    for (Eigen::Index k = 0; k < d; ++k) {
      for (const double way : {-1.0, 1.0}) least = std::min(least, energy(way * eigen.vectors.col(k)));
    }
    between = infinity;  // only a direction in which the energy falls is a proof
  }
  const bool locked = d <= 2 && least == infinity;
  if (least < -margin * steepest) return {Stability::unstable, locked};
  return {least > between + margin * steepest ? Stability::stable : Stability::unknown, locked};
}

}  // namespace poise
