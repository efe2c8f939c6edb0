#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::test {

/// Two unknowns in the plane, all of whose answers can be worked out by hand:
///
///   F = (a x - t y - p, t x + b y),   gradient of  f = a x^2/2 + b y^2/2 - p x + offset  where t = 0,
///   c = (x^2 + y^2 - r2)/2 = 0 where there is a circle,   lower <= y <= upper where either is finite.
class PlaneProblem final : public solvers::Problem {
 public:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  double a = 1, b = 4, t = 0, p = 0, offset = 0;
  double r2 = 1;

  explicit PlaneProblem(bool on_circle, double lower = -infinity, double upper = infinity) : on_circle_(on_circle) {
    if (std::isfinite(lower) || std::isfinite(upper)) {
      lower_ = {lower};
      upper_ = {upper};
    }
    if (on_circle) jacobian_ = {0, 2, {0, 0}, {0, 1}};
    if (!lower_.empty()) {
      jacobian_.row.push_back(equalities());
      jacobian_.column.push_back(1);
    }
    jacobian_.rows = constraints();
    jacobian_.columns = 2;
  }

  int variables() const override { return 2; }
  int equalities() const override { return on_circle_ ? 1 : 0; }
  const std::vector<double>& lower() const override { return lower_; }
  const std::vector<double>& upper() const override { return upper_; }
  bool has_objective() const override { return t == 0; }
  const solvers::Pattern& jacobian_pattern() const override { return jacobian_; }
  const solvers::Pattern& tangent_pattern() const override { return t == 0 ? diagonal_ : full_; }

  double objective(solvers::Evaluation& at) const override {
    return a * at.x[0] * at.x[0] / 2 + b * at.x[1] * at.x[1] / 2 - p * at.x[0] + offset;
  }

  void evaluate(solvers::Evaluation& at) const override {
    ++calls_;
    const double x = at.x[0];
    const double y = at.x[1];
    at.gradient = {a * x - t * y - p, t * x + b * y};
    if (on_circle_) {
      at.constraint[0] = (x * x + y * y - r2) / 2;
      at.jacobian[0] = x;
      at.jacobian[1] = y;
    }
    if (!lower_.empty()) {
      at.constraint.back() = y;
      at.jacobian.back() = 1;
    }
  }

  void tangent(solvers::Evaluation&, std::span<const double> multipliers, std::span<double> values) const override {
    const double bend = on_circle_ ? multipliers[0] : 0.0;
    values[0] = a + bend;
    values[1] = b + bend;
    if (t == 0) return;
    values[2] = -t;
    values[3] = t;
  }

  int calls() const { return calls_; }  ///< of evaluate()

 private:
  bool on_circle_;
  std::vector<double> lower_, upper_;
  solvers::Pattern jacobian_;
  solvers::Pattern diagonal_{2, 2, {0, 1}, {0, 1}};
  solvers::Pattern full_{2, 2, {0, 1, 0, 1}, {0, 1, 1, 0}};
  mutable int calls_ = 0;
};

}  // namespace poise::test
