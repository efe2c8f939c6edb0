#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "model/mechanism.hpp"
#include "model/scene.hpp"

namespace poise::app {

/// The text of a scene that a request {"name", "text"} means by a file of another program, its notes as comments above.
/// Throws InputError.
std::string imported_text(const nlohmann::json& request);

/// {"exported": {"text", "notes"}}: the scene in this position as a request {"format"} wants it. Throws InputError.
nlohmann::json exported_json(const nlohmann::json& request, const Scene& scene,
                             const std::vector<BodyPose<double>>& poses);

/// {"read", "write"}: the formats that there are, for the page.
nlohmann::json exchange_json();

}  // namespace poise::app
