#pragma once

#include <memory>

#include "benchmarks/plain_mechanism.hpp"

namespace poise::benchmarks {

/// The mechanism as a Simbody system, and its minimum of energy by Simbody, with two methods: LocalEnergyMinimizer, and
/// the same program by hand, with the exact Jacobian of the constraints and a tolerance for them. Throws
/// std::invalid_argument where a body is not tied to the ground by pins and slides that lead away from it, another
/// joint than a pin closes a loop, or there are stops.
std::unique_ptr<PlainSolver> simbody_solver(const PlainMechanism& mechanism);

}  // namespace poise::benchmarks
