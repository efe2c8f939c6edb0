#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace poise::app {

/// A mechanism to begin with: a scene of datasets/, whose text is within the program.
struct SceneTemplate {
  std::string_view name, title;
  std::string_view file;  ///< in datasets/
  std::string_view text;
};

/// The rows of app/view/templates.txt. cmake/embed_templates.cmake writes the source.
const std::vector<SceneTemplate>& scene_templates();

/// The answer to {"do": "templates"}: [{"name", "title"}]. With {"name"}: its text and drawing, at rest, small. Throws
/// InputError for a name that is none.
nlohmann::json answer_templates(const nlohmann::json& request);

}  // namespace poise::app
