#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "solvers/linear_algebra.hpp"
#include "statics/model/static_model.hpp"
#include "statics/sensitivity/private/numbered_equations.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {

/// Value of a quantity at z and its derivatives, in the units of the equations' scene.
struct QuantityGradient {
  double value = 0.0;
  Eigen::VectorXd by_unknowns, by_numbers;
};

/// The value of a quantity, but of a load at a fold, in any scalar.
template <class T>
T value_of(const SoughtQuantity& of, const NumberedEquations& equations, const T* numbers, const T* z,
           std::vector<NumberedEquations::Placed<T>>& placed) {
  equations.place(z, placed);
  const NumberedEquations::Bodies<T> bodies = equations.bodies(numbers, placed);
  switch (of.kind) {
    case SoughtQuantity::Kind::measure:
      return bodies.value(of.on);
    case SoughtQuantity::Kind::element_force:
      return bodies.element_force(of.item);
    case SoughtQuantity::Kind::energy:
      return bodies.energy();
    case SoughtQuantity::Kind::stop_reaction:
      for (std::size_t h = 0; h < equations.acting().size(); ++h) {
        if (equations.acting()[h].stop != of.item) continue;
        const T& effort = z[equations.multiplier_of_stop(static_cast<int>(h))];
        return equations.acting()[h].upper ? T(-effort) : effort;
      }
      return T(0);
    case SoughtQuantity::Kind::reaction: {
      const Joint& joint = equations.scene().joints[of.item];
      const int first = equations.multiplier_of_joint(of.item);
      if (of.part == SoughtQuantity::Part::axial) return -z[first];
      if (of.part == SoughtQuantity::Part::moment) return z[first + joint.traits().constraints() - 1];
      const Planar<T> force = bodies.joint_effort(of.item, z + first).force;
      if (of.part == SoughtQuantity::Part::x) return force.x;
      return of.part == SoughtQuantity::Part::y ? force.y : norm(force);
    }
    case SoughtQuantity::Kind::load_at_fold:
      break;
  }
  return T(0);
}

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
QuantityGradient gradient_of(const SoughtQuantity& of, const NumberedEquations& equations,
                             const std::vector<double>& numbers, const std::vector<double>& z);

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
  QuantityGradient gradient(const SoughtQuantity& of, const std::vector<double>& z) const {
    return gradient_of(of, equations_, equations_.numbers(), z);
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
