#include "statics/model/equilibrium_problem.hpp"

namespace poise {
namespace {

Planar<double>* phasors_of(solvers::Evaluation& at) { return static_cast<PhasorPose&>(*at.scratch).phasors.data(); }

}  // namespace

EquilibriumProblem::EquilibriumProblem(const Mechanism<double>& mechanism) : mechanism_(mechanism) {
  const int n = mechanism.coordinates();
  jacobian_pattern_ = {mechanism.constraints(), n, mechanism.jacobian_row(), mechanism.jacobian_column()};
  tangent_pattern_ = {n, n, mechanism.tangent_row(), mechanism.tangent_column()};
}

std::unique_ptr<solvers::Scratch> EquilibriumProblem::make_scratch() const {
  auto pose = std::make_unique<PhasorPose>();
  pose->phasors.resize(mechanism_.pose_size());
  return pose;
}

void EquilibriumProblem::evaluate(solvers::Evaluation& at) const {
  const double* q = at.x.data();
  Planar<double>* pose = phasors_of(at);
  mechanism_.place(q, pose);
  mechanism_.negative_force(q, pose, at.gradient.data());
  mechanism_.constraint(q, pose, at.constraint.data());
  mechanism_.jacobian(pose, at.jacobian.data());
}

double EquilibriumProblem::objective(solvers::Evaluation& at) const {
  return mechanism_.energy(at.x.data(), phasors_of(at));
}

void EquilibriumProblem::tangent(solvers::Evaluation& at, std::span<const double> multipliers,
                                 std::span<double> values) const {
  mechanism_.tangent(phasors_of(at), multipliers.data(), values.data());
}

}  // namespace poise
