#pragma once

#include <memory>
#include <span>
#include <vector>

#include "model/mechanism.hpp"
#include "model/planar.hpp"
#include "solvers/problem.hpp"

namespace poise {

/// The phasors of a pose, and the scratch of its mechanism.
struct PhasorPose : solvers::Scratch {
  std::vector<Planar<double>> phasors;
};

/// A compiled mechanism as a problem for the solvers:
///   x = q,  f = V(q),  F = -Q(q),  c = loop closures,  lower <= stops <= upper.
/// The mechanism should be compiled in its own Scales, and must outlive this. Evaluations may have any PhasorPose as
/// their scratch, with phasors of Mechanism::pose_size().
class EquilibriumProblem final : public solvers::Problem {
 public:
  explicit EquilibriumProblem(const Mechanism<double>& mechanism);

  int variables() const override { return mechanism_.coordinates(); }
  int equalities() const override { return mechanism_.equalities(); }
  const std::vector<double>& lower() const override { return mechanism_.lower(); }
  const std::vector<double>& upper() const override { return mechanism_.upper(); }
  bool has_objective() const override { return !mechanism_.has_follower_loads(); }
  const solvers::Pattern& jacobian_pattern() const override { return jacobian_pattern_; }
  const solvers::Pattern& tangent_pattern() const override { return tangent_pattern_; }
  void evaluate(solvers::Evaluation& at) const override;
  double objective(solvers::Evaluation& at) const override;
  void tangent(solvers::Evaluation& at, std::span<const double> multipliers, std::span<double> values) const override;
  std::unique_ptr<solvers::Scratch> make_scratch() const override;

 private:
  const Mechanism<double>& mechanism_;
  solvers::Pattern jacobian_pattern_, tangent_pattern_;
};

}  // namespace poise
