#include "statics/equilibrium/method.hpp"

#include <cmath>
#include <limits>

namespace poise {

const std::vector<MethodTraits>& all_methods() {
  constexpr int any = std::numeric_limits<int>::max();
  static const std::vector<MethodTraits> all = {
      {Method::virtual_work, "virtual-work", "Newton-Raphson on the equations of virtual work", false, false, 1e-9, 500,
       any, 1},
      {Method::energy, "energy", "minimum energy, by Ipopt", true, true, 1e-14, 1000, any, 1},
      {Method::augmented_lagrangian, "augmented-lagrangian", "Newton on the augmented Lagrangian", false, false, 1e-12,
       200, 2000, 3},
      {Method::augmented_lagrangian_modified, "augmented-lagrangian-modified",
       "the same without the curvature of the constraints, as in MECANO", false, false, 1e-12, 1000, 2000, 3},
      {Method::slsqp, "slsqp", "minimum energy by sequential quadratic programming (NLopt)", true, true, 1e-12, 2000,
       300, 3},
      {Method::auglag_lbfgs, "auglag-lbfgs", "minimum energy by an augmented Lagrangian around L-BFGS (NLopt)", true,
       true, 1e-12, 20000, 2000, 2},
      {Method::cobyla, "cobyla", "minimum energy without derivatives (NLopt)", true, true, 1e-10, 20000, 30, 2},
      {Method::dynamic_relaxation, "dynamic-relaxation", "damped fictitious motion", false, true, 1e-12, 20000, 2000,
       2},
      {Method::least_squares, "least-squares", "least squares of the residuals of all equations, by Ceres", false,
       false, 1e-12, 500, 4000, 3},
  };
  return all;
}

double work_of_an_evaluation(Method method, int coordinates) {
  const auto n = static_cast<double>(coordinates);
  return 1.0 + n / 10.0 + std::pow(n / 40.0, traits(method).growth);
}

const MethodTraits& traits(Method method) { return all_methods()[static_cast<std::size_t>(method)]; }

std::string to_string(Method method) { return traits(method).name; }

}  // namespace poise
