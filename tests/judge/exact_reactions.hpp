#pragma once

#include <optional>
#include <vector>

#include "statics/equilibrium/equilibrium.hpp"
#include "tests/judge/exact_mechanics.hpp"

namespace poise::judge {

/// What a joint does to the body of its second point: N and N m.
struct ExactReaction {
  Planar<Real> force{};
  Real moment{};
};

/// The forces of an equilibrium in 50 digits.
struct ExactForces {
  std::vector<ExactReaction> joints;  ///< per joint of the scene
  std::vector<Real> stops;            ///< per active stop: effort that tends to increase its measure, N or N m
  std::vector<Real> elements;         ///< T of each, N or N m
};

/// By Newton's method on the equations of ExactMechanics, with the reactions as their multipliers, from an answer.
/// Empty if that does not converge, for equilibria that are not isolated, where joints are redundant, or if a one-way
/// spring is not in the state there that it has in the answer.
std::optional<ExactForces> exact_forces(const StaticModel& model, const Equilibrium& answer);

}  // namespace poise::judge
