#pragma once

#include <string>
#include <utility>
#include <vector>

#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"

namespace poise {

/// A principal direction of the reduced Hessian  Z^T (grad2 V + sum lambda grad2 c) Z,  Z an orthonormal basis of the
/// null space of the Jacobian of closures and active stops in scaled coordinates (rad, mechanism sizes).
struct CurvatureDirection {
  double curvature = 0.0;  ///< J per (unit of scaled coordinates)^2, positive where stable
  /// Coordinates that move, largest first, with their component of the unit direction.
  std::vector<std::pair<std::string, double>> moves;
};

/// Those with the lowest curvatures at the equilibrium of a certificate, lowest first, at most six, in double: they
/// describe, the certificate proves. None with follower loads, which have no potential, and for more than 300
/// coordinates.
std::vector<CurvatureDirection> principal_directions(const StaticModel& model, const Certificate& certificate);

}  // namespace poise
