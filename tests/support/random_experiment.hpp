#pragma once

#include <cstdint>

#include "identification/experiment/experiment.hpp"

namespace poise::test {

/// A made-up experiment of a seed: a chain of up to three links with pins and slides, or a four-bar, a slider-crank, a
/// six-bar, or any mechanism of random_mechanism.hpp, with springs, dampers, loads and mostly gravity, every body
/// heavy; read by an angle, a travel or the force of a spring, in one run or two that differ in a known number. Any
/// numbers of bodies, elements and loads are unknown, one of them sometimes with a prior. Where the motion of the
/// mechanism does not depend on an unknown, no rounding of the scene's numbers makes it.
Experiment random_experiment(std::uint64_t seed);

}  // namespace poise::test
