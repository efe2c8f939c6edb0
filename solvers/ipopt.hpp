#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

struct IpoptOptions {
  double tolerance = 1e-14;  ///< Ipopt's `tol`: scaled optimality error
  int iterations = 1000;
  const std::atomic<bool>* interrupt = nullptr;
};

struct IpoptResult {
  bool claims_success = false;  ///< Ipopt's own word
  bool interrupted = false;
  std::string status;  ///< Ipopt's own word in words
  std::vector<double> x;
  std::vector<double> multipliers;
  int iterations = 0;
  int evaluations = 0;  ///< distinct points at which the problem was evaluated
};

/// min f(x) subject to the problem's constraints, by the interior point method of Ipopt with exact Jacobian and Hessian
/// of the Lagrangian. `rows` lists the constraint rows to keep (all of them when empty): Ipopt refuses more
/// equalities than variables. The problem must have an objective.
IpoptResult solve_with_ipopt(const Problem& problem, const std::vector<double>& start, const IpoptOptions& options = {},
                             const std::vector<int>& rows = {});

}  // namespace poise::solvers
