#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "solvers/linear_algebra.hpp"
#include "statics/model/static_model.hpp"
#include "statics/quantities/numbered_equations.hpp"

namespace poise {

/// Places of the bodies of a model at scaled coordinates: the first unknowns of its equations.
std::vector<double> poses_of(const StaticModel& model, const std::vector<double>& x);
/// The stops that act there, each on the side of its nearest limit; `scene` is scaled.
std::vector<ActingStop> acting_at(const Scene& scene, const std::vector<double>& poses, const std::vector<int>& active);

/// R and its derivatives at (z, p); those by p only where asked for.
struct ResidualDerivatives {
  Eigen::VectorXd residual;
  Eigen::MatrixXd by_unknowns, by_numbers;
};
ResidualDerivatives differentiate(const NumberedEquations& equations, const std::vector<double>& numbers,
                                  const std::vector<double>& z, bool by_numbers);
/// The equations of equilibrium at an equilibrium, with their derivatives.
class LinearResponse {
 public:
  /// At the bodies' places `poses` of `equations.poses()` values, which Newton's method improves; `why` says where it
  /// does not converge.
  LinearResponse(NumberedEquations equations, std::vector<double> poses, double rank_tolerance);

  const NumberedEquations& equations() const { return equations_; }
  const std::vector<double>& z() const { return z_; }
  const std::string& why() const { return why_; }
  const Eigen::MatrixXd& by_unknowns() const { return at_.by_unknowns; }  ///< dR/dz
  const Eigen::MatrixXd& by_numbers() const { return at_.by_numbers; }    ///< dR/dp
  const ResidualDerivatives& derivatives() const { return at_; }          ///< these, and R
  /// The step that Newton's method would take next: rounding, or less.
  Eigen::VectorXd next_step() const;
  /// R and its derivatives at z, and those of a quantity.
  ResidualDerivatives at(const std::vector<double>& z) const {
    return differentiate(equations_, equations_.numbers(), z, true);
  }

 private:
  NumberedEquations equations_;
  std::vector<double> z_;
  std::string why_;
  ResidualDerivatives at_;
  double rank_tolerance_;
};

/// Gives the response where a model is in equilibrium at scaled coordinates x, the stops `active` holding.
LinearResponse response_at(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& active,
                           double rank_tolerance);

}  // namespace poise
