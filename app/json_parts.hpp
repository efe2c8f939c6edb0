#pragma once

// What all results in JSON have in common.

#include <optional>
#include <string>
#include <vector>

#include "app/json.hpp"
#include "model/scene.hpp"

namespace poise::app {

/// The number, or null: JSON knows no NaN and no infinity.
Json json_number(double value);
/// The same, and null where there is none.
Json json_number(const std::optional<double>& value);

/// {file, title, source, set}.
Json json_scene(const Scene& scene, const std::vector<std::string>& settings);

/// {length, force, mass, angle, moment, energy}: the names of the units.
Json json_units(const Units& units);

/// The text of a document, indented for people unless the scene is larger than anyone reads through.
std::string json_text(const Json& document, const Scene& scene);

}  // namespace poise::app
