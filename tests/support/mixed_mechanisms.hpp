#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise::test {

/// Kinds of mechanisms of mixed parts:
///
/// chain          1 to 3 bodies in series on pins and slides, open
/// slider_crank   crank, coupler, and a block that slides on the ground
/// slotted_lever  crank with a pin that runs in the slot of a lever
/// linkage        crank, coupler, rocker
const std::vector<std::string>& mixed_kinds();

/// The mechanism of a seed, SI, assembled at its start; the same on every machine. What acts on it is drawn too:
/// springs between points, along slides and on angles, also such as act one way only; forces, which may follow a body;
/// torques; stops on angles, travels and distances, with one limit or two, wide, narrow or equal, some of them where it
/// starts. Every other one has round numbers: lengths that are equal, points in one line, right angles, limits and free
/// lengths at the start. Some have no gravity. Throws std::invalid_argument for an unknown kind.
Scene mixed_mechanism(const std::string& kind, std::uint64_t seed);

}  // namespace poise::test
