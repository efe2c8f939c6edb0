#pragma once

#include "model/scene.hpp"

namespace poise::benchmarks {

/// The hanging chain of hand_chain.hpp as a scene: `links` pinned bars under gravity, started on the arc.
Scene hanging_chain_scene(int links);

/// A ladder of `windows` rhombi hung one below the other from the ground: four bars of 1 m and 1 kg each, the lower
/// corner of one carries the upper corner of the next. Gravity pulls the windows shut; in each a spring of
/// 50 windows N/m and free length 1.2 m between its side corners holds it open. The start is closed, its windows
/// tilted to and fro. Four angles, one loop and one spring per window; it rests upright and symmetric, stable.
Scene window_ladder_scene(int windows);

}  // namespace poise::benchmarks
