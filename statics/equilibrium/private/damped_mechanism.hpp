#pragma once

#include <memory>
#include <span>
#include <vector>

#include "model/measures/measures.hpp"
#include "solvers/damped_problem.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// A mechanism that moves slowly through something viscous:  D(x) x' = Q(x)  on its closed loops, with the forces of
/// statics. Switches are the free lengths of one-way springs.
///
/// D is that of the scene's dampers, sum_d c_d Dg_d Dg_d^T with the coefficient c_d and the measure g_d of each, if
/// these resist every freedom at the closed start; else the identity, the same resistance against every scaled
/// coordinate (rad, or mechanism sizes).
class DampedMechanism final : public solvers::DampedProblem {
 public:
  /// `model` must outlive this. `x` is the start, where the dampers are judged.
  DampedMechanism(const StaticModel& model, const std::vector<double>& x);

  bool by_dampers() const { return !dampers_.empty(); }

  int variables() const override { return problem_.variables(); }
  int equalities() const override { return problem_.equalities(); }
  const std::vector<double>& lower() const override { return problem_.lower(); }
  const std::vector<double>& upper() const override { return problem_.upper(); }
  bool has_objective() const override { return problem_.has_objective(); }
  const solvers::Pattern& jacobian_pattern() const override { return problem_.jacobian_pattern(); }
  const solvers::Pattern& tangent_pattern() const override { return tangent_pattern_; }
  void evaluate(solvers::Evaluation& at) const override { problem_.evaluate(at); }
  double objective(solvers::Evaluation& at) const override { return problem_.objective(at); }
  void tangent(solvers::Evaluation& at, std::span<const double> multipliers, std::span<double> values) const override;
  std::unique_ptr<solvers::Scratch> make_scratch() const override;

  bool limits_distance(int inequality) const override {
    return scene_.stops[inequality].on.kind == Measure::Kind::distance;
  }
  const std::vector<solvers::Threshold>& switches() const override { return switches_; }
  void switch_measures(solvers::Evaluation& at, std::span<double> values) const override;
  void switch_gradient(solvers::Evaluation& at, int which, std::span<double> out) const override;
  void resistance(solvers::Evaluation& at, std::span<double> values) const override;

 private:
  struct ViscousElement {
    CompiledMeasure<double> on;
    double coefficient;
    std::vector<int> entry;  // in the tangent's pattern, of support x support
  };

  void compile_one_way_springs(const StaticModel& model);
  void compile_dampers(const StaticModel& model);
  void extend_pattern();
  Configuration<double> configuration(solvers::Evaluation& at) const;
  bool dampers_resist_all(const std::vector<double>& x) const;

  const Scene& scene_;
  const Mechanism<double>& mechanism_;
  const EquilibriumProblem& problem_;
  solvers::Pattern tangent_pattern_;
  std::vector<solvers::Threshold> switches_;
  std::vector<CompiledMeasure<double>> one_way_;
  std::vector<ViscousElement> dampers_;
  int measure_scratch_ = 0;
};

}  // namespace poise
