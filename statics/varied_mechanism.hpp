#pragma once

#include <deque>
#include <memory>
#include <vector>

#include <ceres/jet.h>

#include "solvers/parametric_problem.hpp"
#include "statics/varied_scene.hpp"

namespace poise {

/// A scene of which one number varies, compiled for given states of its one-way springs, which act both ways or not at
/// all. Rows of c: closures, stops of VariedScene::scene_at() (a driven measure is the last of them), then the measure
/// of each one-way spring, whose lower bound is its free length. The parameter is 0 at VariedScene::from() and 1 at
/// to(). Scaled units.
class VariedMechanism final : public solvers::ParametricProblem {
 public:
  /// `acts`: one per one_way_springs(). `varied` must outlive this.
  VariedMechanism(const VariedScene& varied, const std::vector<char>& acts);

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
  using Dual = ceres::Jet<double, 1>;
  // Compiled at one value of the parameter.
  struct Piece {
    double p = 0.0;
    std::unique_ptr<ScaledModel> model;
    std::unique_ptr<Mechanism<Dual>> dual;  // made when first needed
    std::vector<Planar<double>> pose;
    std::vector<Planar<Dual>> dual_pose;
  };
  Piece compiled(double p) const;
  // They have the same coordinates and entries.
  static bool alike(const Piece& a, const Piece& b);
  Piece& at(double p);
  void make_dual(Piece& piece) const;
  template <class T>
  void fill(const Mechanism<T>& m, std::vector<Planar<T>>& pose, const T* x, T* values) const;
  void plain(double p, std::span<const double> x, std::vector<double>& values);
  // Of two compiled pieces:  f(p) = f_a + (p - a) / (b - a) (f_b - f_a).
  double share(double p) const { return (p - first_.p) / (second_.p - first_.p); }

  const VariedScene& varied_;
  std::vector<int> one_way_;
  std::vector<char> acts_;
  bool affine_ = false;
  Piece first_, second_;      // of an affine parameter
  std::deque<Piece> recent_;  // of others
  int n_ = 0, equalities_ = 0, rows_ = 0;
  bool symmetric_ = true;
  solvers::Pattern jacobian_pattern_, tangent_pattern_;
  std::vector<double> at_first_, at_second_, stencil_[4], tangents_[2];
};

}  // namespace poise
