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
  double gap = 0.0;                  ///< last singular value of the rank over the next one
  std::vector<std::string> base;     ///< "bpc.m y + 1.0000 platform.m + ...", SI
  std::vector<std::string> without;  ///< parameters that no motion depends on
};

/// Throws InputError where the loops cannot be closed.
BaseParameters base_parameters(const Scene& scene);

}  // namespace poise
