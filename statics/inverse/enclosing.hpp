#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "statics/inverse/unknown_numbers.hpp"

namespace poise {

/// That exactly one solution of equations with sought numbers lies near a point, in ball arithmetic.
struct SolutionProof {
  bool proved = false;
  std::string why;             ///< one sentence, where it is not
  std::vector<double> part;    ///< each sought part, the middle of its enclosure
  std::vector<double> radius;  ///< the exact ones are this close
  int neutral = 0;             ///< directions in which the equations do not change, held where they are
  double reach = 0.0;          ///< no other solution has all unknowns, scaled, within this of the point's
};

/// Why so many unknowns of the equations of a scene are not enclosed; empty where they may be.
std::string why_not_enclosed(const UnknownNumbers& numbers, const Scene& scene, int unknowns);

/// As many columns as the rank, ascending.
std::vector<int> independent_columns(const Eigen::MatrixXd& a);

/// The inverse of a square matrix; not finite where it has none.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& a);

}  // namespace poise
