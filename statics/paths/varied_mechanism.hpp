#pragma once

#include <memory>
#include <vector>

#include <ceres/jet.h>

#include "model/second_dual.hpp"
#include "solvers/parametric_problem.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/varied_numbers.hpp"

namespace poise {

/// A scene of which one number varies, compiled for given states of its one-way springs, which act both ways or not at
/// all. Rows of c: closures, stops of VariedScene::scene_at() (a driven measure is the last of them), then the measure
/// of each one-way spring, whose lower bound is its free length. The parameter is 0 at VariedScene::from() and 1 at
/// to(). Scaled units. Derivatives are exact: the mechanism is evaluated in dual numbers, of the coordinates and of all
/// numbers of the scene.
class VariedMechanism final : public solvers::ParametricProblem {
 public:
  /// `acts`: one per one_way_springs().
  VariedMechanism(const VariedScene& varied, const std::vector<char>& acts);
  ~VariedMechanism() override;

  /// Indices of Scene::elements.
  static std::vector<int> one_way_springs(const Scene& scene);

  int variables() const override { return n_; }
  int equalities() const override { return equalities_; }
  int rows() const override { return rows_; }
  bool symmetric() const override { return symmetric_; }
  const solvers::Pattern& jacobian_pattern() const override { return jacobian_pattern_; }
  const solvers::Pattern& tangent_pattern() const override { return tangent_pattern_; }
  void evaluate(std::span<const double> x, double p, std::span<double> values, std::span<double> by_p) override;
  void tangent(std::span<const double> x, double p, std::span<const double> y, std::span<double> values) override;
  void change(std::span<const double> x, double p, std::span<const double> y, std::span<const double> u,
              std::span<const double> v, double w, std::span<double> values, std::span<double> by_p,
              std::span<double> tangent) override;

 private:
  // The mechanism, and all numbers, in the scalar T.
  template <class T>
  struct Evaluation;
  using Dual = ceres::Jet<double, 1>;

  template <class T>
  Evaluation<T>& in(std::unique_ptr<Evaluation<T>>& evaluation) const;
  template <class T>
  void fill(Evaluation<T>& at, const T& p, T* values) const;

  VariedNumbers numbers_;
  Layout layout_;
  int n_ = 0, equalities_ = 0, rows_ = 0;
  bool symmetric_ = true;
  solvers::Pattern jacobian_pattern_, tangent_pattern_;
  std::unique_ptr<Evaluation<double>> plain_;
  std::unique_ptr<Evaluation<Dual>> by_p_;           // made when first needed
  std::unique_ptr<Evaluation<SecondDual>> changes_;  // the same
};

}  // namespace poise
