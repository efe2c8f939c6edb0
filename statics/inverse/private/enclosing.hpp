#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "statics/inverse/unknown_numbers.hpp"

namespace poise {

/// Why so many unknowns of the equations of a scene are not enclosed; empty where they may be.
std::string why_not_enclosed(const UnknownNumbers& numbers, const Scene& scene, int unknowns);

/// As many columns as the rank, ascending.
std::vector<int> independent_columns(const Eigen::MatrixXd& a);

/// The inverse of a square matrix; not finite where it has none.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& a);

}  // namespace poise
