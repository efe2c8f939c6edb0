#pragma once

#include <vector>

#include "solvers/problem.hpp"

namespace poise::test {

/// Many points, each on a circle of its own about the origin:  f = sum (x_k^2 + 4 y_k^2)/2 - p_k x_k,
/// c_k = (x_k^2 + y_k^2 - 1)/2 = 0. At rest x_k = 1, y_k = 0, multiplier p_k - 1. The rows may each come twice.
class CirclesProblem final : public solvers::Problem {
 public:
  explicit CirclesProblem(int circles, bool twice = false) : n_(2 * circles) {
    for (int i = 0; i < n_; ++i) {
      tangent_.row.push_back(i);
      tangent_.column.push_back(i);
      jacobian_.row.push_back(i / 2);
      jacobian_.column.push_back(i);
    }
    for (int i = 0; twice && i < n_; ++i) {
      jacobian_.row.push_back(circles + i / 2);
      jacobian_.column.push_back(i);
    }
    jacobian_.rows = twice ? 2 * circles : circles;
    jacobian_.columns = tangent_.rows = tangent_.columns = n_;
  }

  static double pull(int circle) { return 1.5 + 0.01 * circle; }

  int variables() const override { return n_; }
  int equalities() const override { return jacobian_.rows; }
  const std::vector<double>& lower() const override { return none_; }
  const std::vector<double>& upper() const override { return none_; }
  bool has_objective() const override { return true; }
  const solvers::Pattern& jacobian_pattern() const override { return jacobian_; }
  const solvers::Pattern& tangent_pattern() const override { return tangent_; }

  double objective(solvers::Evaluation& at) const override {
    double sum = 0.0;
    for (int k = 0; k < n_ / 2; ++k) {
      const double x = at.x[2 * k];
      const double y = at.x[2 * k + 1];
      sum += (x * x + 4 * y * y) / 2 - pull(k) * x;
    }
    return sum;
  }

  void evaluate(solvers::Evaluation& at) const override {
    for (int r = 0; r < jacobian_.rows; ++r) {
      const int k = r % (n_ / 2);
      const double x = at.x[2 * k];
      const double y = at.x[2 * k + 1];
      at.constraint[r] = (x * x + y * y - 1) / 2;
      at.jacobian[2 * r] = x;
      at.jacobian[2 * r + 1] = y;
      at.gradient[2 * k] = x - pull(k);
      at.gradient[2 * k + 1] = 4 * y;
    }
  }

  void tangent(solvers::Evaluation&, std::span<const double> multipliers, std::span<double> values) const override {
    for (int i = 0; i < n_; ++i) values[i] = i % 2 == 0 ? 1.0 : 4.0;
    for (int r = 0; r < jacobian_.rows; ++r) {
      const int k = r % (n_ / 2);
      values[2 * k] += multipliers[r];
      values[2 * k + 1] += multipliers[r];
    }
  }

 private:
  int n_;
  solvers::Pattern jacobian_, tangent_;
  std::vector<double> none_;
};

}  // namespace poise::test
