#pragma once

#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise::comparison {

// Scenes whose size is a parameter, built in code.

/// The hanging chain of the references (static.hanging_chain_span06): n equal uniform links of 1 m total length and 1 N
/// total weight between two pins at the same height, chain_span apart.
inline constexpr double chain_span = 0.6;  ///< m

/// Angles, rad, of the n links laid as chords of the circular arc that hangs between the two pins:
/// t_i = (i - (n - 1)/2) phi,  sin(n phi/2) / (n sin(phi/2)) = chain_span.
std::vector<double> arc_start(int links);

/// The hanging chain as a scene: `links` pinned bars under gravity, started on the arc.
Scene hanging_chain_scene(int links);

/// A ladder of `windows` rhombi hung one below the other from the ground: four bars of 1 m and 1 kg each, the lower
/// corner of one carries the upper corner of the next. Gravity pulls the windows shut; in each a spring of
/// 50 windows N/m and free length 1.2 m between its side corners holds it open. The start is closed, its windows tilted
/// alternately. Four angles, one loop and one spring per window; the upright symmetric equilibrium is stable.
Scene window_ladder_scene(int windows);

/// `arms` arms balanced by springs of free length zero (datasets/hard/balanced_arm.toml), in equilibrium at every
/// angle, side by side, and one body "pendulum" that hangs. All numbers are exact in binary.
Scene balanced_arms_scene(int arms);

/// The shallow truss of datasets/hard/shallow_truss.toml, its bar 1.25 m, loaded with its snap-through load P_max
/// (1 + 1e-13) and started where its two equilibria have merged, beside `pendulums` pendulums of 1 m and 1 kg.
Scene truss_beside_pendulums_scene(int pendulums);

/// "hanging chain", "window ladder", "balanced arms", "truss beside pendulums".
const std::vector<std::string>& series_names();

/// The scene of a series. Throws InputError for a name that series_names() does not have.
Scene series_scene(const std::string& name, int size);

}  // namespace poise::comparison
