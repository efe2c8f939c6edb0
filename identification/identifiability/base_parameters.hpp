#pragma once

#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// The combinations of the bodies' inertial parameters on which the motion of a mechanism can depend.
///
/// The equations of motion are linear in (m, m x, m y, J about the body's origin) of every body:  B^T G = Y(q, v, a) p
/// + ... The rank of Y, stacked over many random states, is the number of base parameters.
/// Each base parameter is one of p plus fixed multiples of others, found by pivoting.
struct BaseParameters {
  int parameters = 0;  ///< four for each body that has mass or inertia
  int rank = 0;
  double gap = 0.0;  ///< last singular value of the rank over the next one
  /// One of the inertial parameters of a body, times a factor, SI.
  struct Term {
    int body = 0;  ///< index into Scene::bodies
    int part = 0;  ///< 0 m, 1 m x, 2 m y, 3 J
    double factor = 1.0;
  };
  struct Sum {
    std::string words;        ///< "bpc.m y + 1.0000 platform.m + ..."
    std::vector<Term> terms;  ///< the first of factor 1
  };
  std::vector<Sum> sums;             ///< the base parameters, SI, in the order of their words
  std::vector<std::string> without;  ///< parameters that no motion depends on
};

/// The value of a base parameter in a scene of the same structure, SI.
double value_of(const BaseParameters::Sum& sum, const Scene& scene);
/// Its dimension: mass, mass times length, or inertia.
Dimension dimension_of(const BaseParameters::Sum& sum);

/// Throws InputError where the loops cannot be closed.
BaseParameters base_parameters(const Scene& scene);

}  // namespace poise
