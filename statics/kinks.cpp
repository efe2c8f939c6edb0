#include "statics/kinks.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra.hpp"
#include "statics/curvature.hpp"

namespace poise {
namespace {

constexpr double at_kink = 1e-9;  // of the mechanism's size
constexpr double beyond = 1e-8;   // by which free lengths are moved to have springs act, or not
constexpr double aside = 1e-5;    // rad or sizes: how far a side is looked at

double length_of(const StaticModel& model, const Spring& spring, const std::vector<double>& x) {
  const std::vector<BodyPose<double>> poses = model.poses(x);
  const Scene& scene = model.scene();
  return norm(poses[spring.b.body].world(scene.local(spring.b)) - poses[spring.a.body].world(scene.local(spring.a)));
}

ReducedHessian<double> reduced_with(const StaticModel& model, const std::vector<double>& x,
                                    const std::vector<int>& rows, const std::vector<int>& springs,
                                    const std::vector<char>& act) {
  Scene scene = model.scene();
  for (std::size_t k = 0; k < springs.size(); ++k) {
    Spring& spring = scene.springs[springs[k]];
    const bool longer = (spring.acts == Spring::Acts::tension) != (act[k] != 0);
    spring.free_length += (longer ? beyond : -beyond) * model.scales().length;
  }
  const StaticModel changed(scene, model.scales());
  return {changed.mechanism(), x, rows};
}

// -1, 0 or 1 of the smallest eigenvalue.
int sign_of_least(const ReducedHessian<double>& reduced, double zero) {
  const double least = solvers::symmetric_eigenvalues(reduced.matrix)[0];
  return least > zero ? 1 : least < -zero ? -1 : 0;
}

}  // namespace

std::vector<int> springs_at_kinks(const StaticModel& model, const std::vector<double>& x) {
  std::vector<int> out;
  const std::vector<Spring>& springs = model.scene().springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    if (springs[s].acts == Spring::Acts::both || springs[s].free_length == 0.0 || springs[s].stiffness == 0.0) continue;
    const double over = length_of(model, springs[s], x) - springs[s].free_length;
    if (std::abs(over) <= at_kink * model.scales().length) out.push_back(static_cast<int>(s));
  }
  return out;
}

Stability stability_at_kinks(const StaticModel& model, const std::vector<double>& x, const std::vector<int>& rows,
                             const std::vector<int>& springs, double zero) {
  const ReducedHessian<double> none = reduced_with(model, x, rows, springs, std::vector<char>(springs.size(), 0));
  if (sign_of_least(none, zero) > 0) return Stability::stable;
  if (sign_of_least(reduced_with(model, x, rows, springs, std::vector<char>(springs.size(), 1)), zero) < 0) {
    return Stability::unstable;
  }
  if (none.matrix.rows() != 1) return Stability::unknown;
  int least = 1;
  for (const double side : {-aside, aside}) {
    std::vector<double> moved = x;
    for (std::size_t i = 0; i < x.size(); ++i) moved[i] += side * none.basis(static_cast<Eigen::Index>(i), 0);
    std::vector<char> act;
    for (int s : springs) {
      const Spring& spring = model.scene().springs[s];
      const bool longer = length_of(model, spring, moved) > length_of(model, spring, x);
      act.push_back(longer == (spring.acts == Spring::Acts::tension));
    }
    least = std::min(least, sign_of_least(reduced_with(model, x, rows, springs, act), zero));
  }
  return least > 0 ? Stability::stable : least < 0 ? Stability::unstable : Stability::neutral;
}

}  // namespace poise
