#include "statics/equilibrium_problem.hpp"

namespace poise {
namespace {

// The scratch of an Evaluation holds the phasors, two doubles each.
Planar<double>* pose_of(solvers::Evaluation& at) {
  static_assert(sizeof(Planar<double>) == 2 * sizeof(double));
  return reinterpret_cast<Planar<double>*>(at.scratch.data());
}

}  // namespace

EquilibriumProblem::EquilibriumProblem(const Mechanism<double>& mechanism) : mechanism_(mechanism) {
  const int n = mechanism.coordinates();
  jacobian_pattern_ = {mechanism.constraints(), n, mechanism.jacobian_row(), mechanism.jacobian_column()};
  tangent_pattern_ = {n, n, mechanism.tangent_row(), mechanism.tangent_column()};
}

void EquilibriumProblem::evaluate(solvers::Evaluation& at) const {
  const double* q = at.x.data();
  Planar<double>* pose = pose_of(at);
  mechanism_.place(q, pose);
  mechanism_.negative_force(q, pose, at.gradient.data());
  mechanism_.constraint(q, pose, at.constraint.data());
  mechanism_.jacobian(pose, at.jacobian.data());
}

double EquilibriumProblem::objective(solvers::Evaluation& at) const {
  return mechanism_.energy(at.x.data(), pose_of(at));
}

void EquilibriumProblem::tangent(solvers::Evaluation& at, std::span<const double> multipliers,
                                 std::span<double> values) const {
  mechanism_.tangent(pose_of(at), multipliers.data(), values.data());
}

}  // namespace poise
