#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// Ways to find where a mechanism rests. All go through solve() and through the same check.
enum class Method {
  virtual_work,                   ///< Newton-Raphson on c(q) = 0, N^T Q(q) = 0
  energy,                         ///< min V(q) subject to c(q) = 0 and stops, by Ipopt; finds stable rest only
  augmented_lagrangian,           ///< Newton on V + k lambda^T c + p/2 c^T c, exact tangent
  augmented_lagrangian_modified,  ///< the same without the second derivatives of c, as MECANO has it
  slsqp,                          ///< least energy by sequential quadratic programming (NLopt)
  auglag_lbfgs,                   ///< least energy by an augmented Lagrangian around L-BFGS (NLopt)
  cobyla,                         ///< least energy without derivatives (NLopt)
  dynamic_relaxation,             ///< damped motion to rest
  least_squares                   ///< residuals of all equations by Levenberg-Marquardt (Ceres)
};

/// What there is to know of a method before it runs.
struct MethodTraits {
  Method method;
  const char* name;      ///< as on the command line: "virtual-work"
  const char* what;      ///< one line for a person
  bool needs_potential;  ///< refuses loads that follow a body
  bool minimises;        ///< leads to stable rest only, whatever is sought
  double tolerance;      ///< its own, by default: the tightest at which it still ends by itself
  int iterations;        ///< its own limit, by default
  int coordinates;       ///< largest mechanism it is let loose on; it would take hours or all memory beyond
};

/// All methods, in the order of the enumeration.
const std::vector<MethodTraits>& all_methods();
const MethodTraits& traits(Method method);

/// "virtual-work", "energy", ...
std::string to_string(Method method);

}  // namespace poise
