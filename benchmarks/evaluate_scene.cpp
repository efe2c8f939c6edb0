// A library for programs in other languages: a scene's potential, closures and their exact derivatives, dense, row by
// row, in Poise's scaled coordinates, at compiled speed. scipy_baseline.py loads it. Input and output are in the
// scene's own memory, so that a call passes one pointer.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/baseline_scenes.hpp"
#include "statics/model/static_model.hpp"

namespace {

using poise::solvers::Evaluation;
using poise::solvers::Pattern;
using poise::solvers::Problem;

// The interface to the other language. n variables x, m closures c with multipliers y.
struct SceneView {
  int n, m;
  long evaluations;    // distinct points x so far
  double* point;       // n + m, to be filled: x, y
  double* value;       // 1: V
  double* gradient;    // n: grad V
  double* constraint;  // m: c
  double* jacobian;    // m n: J = grad c
  double* hessian;     // n n: H = grad2 V + sum y grad2 c
  double* residual;    // n + m: grad V + J^T y, c
  double* tangent;     // (n + m)^2: [H J^T; J 0]
};

class DenseScene : public SceneView {
 public:
  explicit DenseScene(const std::string& name)
      : SceneView{},
        model_(poise::benchmarks::baseline_scene(name)),
        problem_(model_.problem()),
        at_(problem_.make_evaluation()),
        multipliers_(problem_.constraints()),
        values_(problem_.tangent_pattern().size()) {
    if (problem_.inequalities() > 0) throw poise::InputError(name + ": its stops are not known here");
    if (!problem_.has_objective()) throw poise::InputError(name + ": it has a load without potential");
    n = problem_.variables();
    m = problem_.equalities();
    lay_out();
    at_.x.assign(n, NAN);
  }

  void evaluate() {
    if (std::equal(at_.x.begin(), at_.x.end(), point)) return;
    std::copy_n(point, n, at_.x.begin());
    problem_.evaluate(at_);
    ++evaluations;
    *value = problem_.objective(at_);
    std::copy(at_.gradient.begin(), at_.gradient.end(), gradient);
    std::copy(at_.constraint.begin(), at_.constraint.end(), constraint);
    const Pattern& pattern = problem_.jacobian_pattern();
    for (int e = 0; e < pattern.size(); ++e) {
      jacobian[pattern.row[e] * n + pattern.column[e]] = at_.jacobian[e];
    }
  }

  void evaluate_hessian() {
    evaluate();
    put_hessian(hessian, n);
  }

  void evaluate_residual() {
    evaluate();
    std::copy_n(gradient, n, residual);
    std::copy_n(constraint, m, residual + n);
    const Pattern& pattern = problem_.jacobian_pattern();
    for (int e = 0; e < pattern.size(); ++e) {
      residual[pattern.column[e]] += at_.jacobian[e] * point[n + pattern.row[e]];
    }
  }

  void evaluate_tangent() {
    evaluate();
    put_hessian(tangent, n + m);
    const Pattern& pattern = problem_.jacobian_pattern();
    for (int e = 0; e < pattern.size(); ++e) {
      const int row = n + pattern.row[e], column = pattern.column[e];
      tangent[row * (n + m) + column] = tangent[column * (n + m) + row] = at_.jacobian[e];
    }
  }

 private:
  void lay_out() {
    memory_.resize(3 * (n + m) + 1 + m * n + n * n + (n + m) * (n + m));
    double* next = memory_.data();
    const auto take = [&next](int count) { return std::exchange(next, next + count); };
    point = take(n + m);
    value = take(1);
    gradient = take(n);
    constraint = take(m);
    jacobian = take(m * n);
    hessian = take(n * n);
    residual = take(n + m);
    tangent = take((n + m) * (n + m));
  }

  void put_hessian(double* to, int stride) {
    std::copy_n(point + n, m, multipliers_.begin());
    problem_.tangent(at_, multipliers_, values_);
    const Pattern& pattern = problem_.tangent_pattern();
    for (int e = 0; e < pattern.size(); ++e) {
      to[pattern.row[e] * stride + pattern.column[e]] = to[pattern.column[e] * stride + pattern.row[e]] = values_[e];
    }
  }

  poise::StaticModel model_;
  const Problem& problem_;
  Evaluation at_;
  std::vector<double> multipliers_, values_, memory_;
};

DenseScene& dense(SceneView* scene) { return *static_cast<DenseScene*>(scene); }

}  // namespace

extern "C" {

// Null if the scene cannot be read; the reason is on stderr.
SceneView* scene_open(const char* name) {
  try {
    return new DenseScene(name);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return nullptr;
  }
}
void scene_close(SceneView* scene) { delete &dense(scene); }
void scene_evaluate(SceneView* scene) { dense(scene).evaluate(); }
void scene_evaluate_hessian(SceneView* scene) { dense(scene).evaluate_hessian(); }
void scene_evaluate_residual(SceneView* scene) { dense(scene).evaluate_residual(); }
void scene_evaluate_tangent(SceneView* scene) { dense(scene).evaluate_tangent(); }
}
