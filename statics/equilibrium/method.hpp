#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// Methods to find an equilibrium. All are called by solve() and verified by the same check.
enum class Method {
  virtual_work,                   ///< Newton-Raphson on c(q) = 0, N^T Q(q) = 0
  energy,                         ///< min V(q) subject to c(q) = 0 and stops, by Ipopt; finds stable equilibria only
  augmented_lagrangian,           ///< Newton on V + k lambda^T c + p/2 c^T c, exact tangent
  augmented_lagrangian_modified,  ///< the same without the second derivatives of c, as in MECANO
  slsqp,                          ///< minimum energy by sequential quadratic programming (NLopt)
  auglag_lbfgs,                   ///< minimum energy by an augmented Lagrangian around L-BFGS (NLopt)
  cobyla,                         ///< minimum energy without derivatives (NLopt)
  dynamic_relaxation,             ///< damped fictitious motion until equilibrium
  least_squares                   ///< residuals of all equations by Levenberg-Marquardt (Ceres)
};

/// Weights of the augmented Lagrangian  V + k lambda^T c + p/2 c^T c  of both methods that have it, in the units of the
/// scaled scene, in which forces and lengths are about 1.
struct LagrangianWeights {
  double scaling = 1.0;   ///< k, > 0
  double penalty = 10.0;  ///< p, >= 0
};

/// Whether a method has such weights.
constexpr bool has_weights(Method method) {
  return method == Method::augmented_lagrangian || method == Method::augmented_lagrangian_modified;
}

/// Properties of a method.
struct MethodTraits {
  Method method;
  const char* name;      ///< as on the command line: "virtual-work"
  const char* what;      ///< description in one line
  bool needs_potential;  ///< does not apply to loads that follow a body
  bool minimises;        ///< finds stable equilibria only, whatever is sought
  double tolerance;      ///< default: the smallest with which it still terminates by itself
  int iterations;        ///< default limit
  int coordinates;       ///< largest number it accepts; beyond, it would take hours or all memory
  int growth;            ///< power of the number of coordinates with which the time of an evaluation grows
};

/// All methods, in the order of the enumeration.
const std::vector<MethodTraits>& all_methods();
const MethodTraits& traits(Method method);

/// Work of one evaluation of a method, its linear algebra included, in those of a small mechanism:
/// 1 + n / 10 + (n / 40)^growth for n coordinates.
double work_of_an_evaluation(Method method, int coordinates);

/// "virtual-work", "energy", ...
std::string to_string(Method method);

}  // namespace poise
