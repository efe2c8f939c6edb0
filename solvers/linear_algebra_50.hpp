#pragma once

// Sparse systems in 50 digits.

#include <optional>

#include <Eigen/SparseCore>

#include "solvers/linear_algebra.hpp"
#include "solvers/real50.hpp"

namespace poise::solvers {

/// x of A x = b. All of A is given even if it is symmetric: then by LDL^T without pivoting, which is ten times as fast
/// as LU, and by LU if a pivot vanishes. Empty if A is singular.
std::optional<DenseVector<Real50>> solve(const Eigen::SparseMatrix<Real50>& a, const DenseVector<Real50>& b,
                                         bool symmetric);

}  // namespace poise::solvers
