#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise::test {

/// Kinds of scenes in which answers about equilibria have been wrong, or easily are.
///
/// planted       random mechanisms with loops of every kind (random_mechanism.hpp)
/// followers     the same with loads that follow a body, and chains of torsion springs with a follower at the tip
/// stops         the same with stops, some with force
/// touching      stops that touch the planted equilibrium: gap 0, +-1e-16 ... 1e-6, on one side or both
/// kinks         one-way springs at their free length there, or for ever, or next to it
/// curvature     the smallest curvature is made +-1e-15 ... 1e-2 of the others
/// cusps         inverted pendulums and columns whose curvature is zero or nearly so
/// trusses       shallow trusses of slope 1e-4 ... 0.5 at P_max (1 +- 1e-3 ... 1e-15)
/// pins          pins that coincide or nearly so, and redundant loops
/// change_points flat four-bars and parallelograms with springs
/// scales        any of the others in other units of length, force and mass, and far from the origin
/// soft          springs of very different stiffness
/// neutral       balanced arms, unloaded trusses, level rails
/// locks         held by stops from both sides
const std::vector<std::string>& scene_families();

/// The scene of a seed, SI; the same on every machine with the same libm.
Scene random_scene(const std::string& family, std::uint64_t seed);

/// The scene as a scene file that is read back to the same doubles (axes to rounding).
std::string scene_text(const Scene& scene);

}  // namespace poise::test
