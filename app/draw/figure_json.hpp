#pragma once

#include <string>

#include "app/draw/figure.hpp"

namespace poise::app {

// JSON text of what pages show; docs/json.md has the keys.

/// A figure: {"kind": "drawing" | "cards" | "charts", ...}. Frames after the first hold only what changes.
std::string figure_json(const Figure& figure);

/// A drawing alone, for example of one position that is dragged.
std::string drawing_json(const Drawing& drawing);

/// Charts alone.
std::string charts_json(const Charts& charts);

}  // namespace poise::app
