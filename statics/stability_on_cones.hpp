#pragma once

#include <vector>

#include <Eigen/Core>

#include "statics/stability.hpp"

namespace poise {

struct StabilityOnCones {
  Stability stability = Stability::unknown;
  bool locked = false;  ///< no motion is possible
};

/// Stability where one-way springs are exactly at their free length and stops are touched without force. For a motion v
/// the energy changes by half of
///   q(v) = v^T H v + sum_k max(0, a_k.v)^2,
/// H being the reduced Hessian without those springs and a_k (`acting`) the gradient of a measure times the root of the
/// stiffness, positive where the spring acts; stops leave the motions with a_s.v <= 0 (`forbidden`). In double, with a
/// margin of 1e-9; with more than two degrees of freedom only a motion with q < 0 decides.
StabilityOnCones stability_on_cones(const Eigen::MatrixXd& h, const std::vector<Eigen::VectorXd>& acting,
                                    const std::vector<Eigen::VectorXd>& forbidden);

}  // namespace poise
