#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "app/draw/frames.hpp"

namespace poise::app {

/// How many frames a moving figure of a scene has at most: 60 to 300, so that the page stays below 1.5 MB; fewer where
/// every frame shows all forces too.
std::size_t most_frames(const Scene& scene, bool forces);

/// At most `most` (two at least) of n places, evenly spaced, the first and the last among them.
std::vector<std::size_t> evenly(std::size_t n, std::size_t most);

/// Draws the positions, one at least, as frames of the figure, and follows all points of moving bodies, or, where a
/// page cannot hold these, those of `traced` ("coupler.P"), which leave a trace at first. A single position is a still
/// picture.
void animate(Figure& figure, std::vector<Position> positions, Play play, const std::string& description,
             const std::vector<std::string>& traced);

}  // namespace poise::app
