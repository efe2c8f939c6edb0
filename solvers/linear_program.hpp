#pragma once

#include <Eigen/Core>

namespace poise::solvers {

/// Linear program:  maximise objective x  subject to  rows x <= bounds, x of any sign.
struct LinearProgram {
  Eigen::MatrixXd rows;
  Eigen::VectorXd bounds;
  Eigen::VectorXd objective;
};

/// How it ended. Multipliers z >= 0, one per row: where it is optimal rows' z = objective; where it is infeasible
/// rows' z = 0 and bounds z < 0, which no x allows (Farkas). In double precision.
struct LinearProgramResult {
  enum class Status {
    optimal,
    unbounded,  ///< x is feasible, and so is x + s ray for every s >= 0, along which the objective grows
    infeasible,
    not_solved  ///< more steps than `most_steps`
  };
  Status status = Status::not_solved;
  Eigen::VectorXd x, multipliers, ray;
};

/// Solves a small dense program by the simplex method on dictionaries in two phases (V. Chvatal, "Linear Programming",
/// 1983, chapters 2, 3 and 8), with Bland's rule where steps have no length.
LinearProgramResult solve(const LinearProgram& program);

}  // namespace poise::solvers
