#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "solvers/linear_algebra.hpp"
#include "solvers/newton.hpp"
#include "solvers/random_stream.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// The rows of the constraint vector that are zero in every pose: closures, and stops whose limits are equal, which
/// hold their measure.
std::vector<int> permanent_rows(const Mechanism<double>& mechanism);

/// Gives what is left open of these rows, from all constraints.
Eigen::VectorXd gaps_of(const Mechanism<double>& mechanism, const std::vector<int>& rows,
                        const std::vector<double>& constraint);

/// Gives how far a stop is passed, rad or mechanism sizes, from all constraints: 0 between its limits.
double passed_by(const Mechanism<double>& mechanism, int stop, const std::vector<double>& constraint);

/// The stops that are at a limit, or beyond: `stop "open" and coupling "rack"`; empty where none is.
std::string stops_at_limits(const ScaledModel& model, const std::vector<double>& x);

/// Degrees of freedom that these rows leave in the closed pose x, known to `tolerance` (solvers::known_to).
int freedoms_of(const StaticModel& model, const std::vector<double>& x,
                double tolerance = solvers::known_to::closed_point);

/// The closed pose that shortest steps lead to from x with every coordinate moved at random by at most `reach`, rad or
/// mechanism sizes; nothing where they do not converge.
std::optional<std::vector<double>> random_closed_pose(solvers::Newton& closing, std::vector<double> x, double reach,
                                                      solvers::RandomStream random);

/// Whether some of many closed poses, found from random ones until `stopped` says so, leaves fewer freedoms than so
/// many.
bool has_stiffer_poses(const StaticModel& model, const std::vector<double>& start, int freedoms,
                       const std::function<bool()>& stopped);

/// How many of the permanent rows others imply in all poses near the closed `start`. Rows that are dependent in single
/// poses only, as where a parallelogram lies flat or a cable is taut, are none of these.
int repeated_rows(const StaticModel& model, const std::vector<double>& start);

}  // namespace poise
