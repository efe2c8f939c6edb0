#pragma once

#include <atomic>
#include <functional>
#include <string>

#include <Eigen/Core>

namespace poise::solvers {

/// Value and gradient of f, and of the constraints c(x) <= 0 and h(x) = 0, one row each.
struct ProgramAt {
  double value = 0.0;
  Eigen::VectorXd gradient;
  Eigen::VectorXd below, equal;
  Eigen::MatrixXd below_by, equal_by;
};

/// Evaluates all at x; false where they have no values.
using ProgramFunction = std::function<bool(const Eigen::VectorXd& x, ProgramAt& out)>;

enum class ProgramMethod {
  slsqp,  ///< sequential quadratic programming (Kraft)
  mma,    ///< moving asymptotes (Svanberg); no equations
  auglag  ///< augmented Lagrangian (Birgin, Martinez) around L-BFGS
};

struct NonlinearProgramOptions {
  ProgramMethod method = ProgramMethod::slsqp;
  int evaluations = 400;  ///< at most
  double step_tolerance = 1e-9;
  double constraint_tolerance = 1e-9;
  const std::atomic<bool>* interrupt = nullptr;
};

struct NonlinearProgramResult {
  Eigen::VectorXd x;   ///< the best point that keeps all constraints to their tolerance, else the start
  double value = 0.0;  ///< f there
  bool keeps = false;  ///< all constraints, to their tolerance
  int evaluations = 0;
  std::string status;  ///< as NLopt reports it
};

/// min f(x) subject to  c(x) <= 0,  h(x) = 0,  lower <= x <= upper,  by NLopt with exact gradients, from a start. Where
/// there are no values f counts as much more than at the start, so that a search turns back.
NonlinearProgramResult nonlinear_program(const ProgramFunction& function, const Eigen::VectorXd& start,
                                         const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                         const NonlinearProgramOptions& options = {});

}  // namespace poise::solvers
