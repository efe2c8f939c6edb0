#pragma once

// Where scene files and SceneBuilder meet. Private to model/.

#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads and checks the document of a scene; `place` names it in messages.
Scene read_document(const toml::table& document, const TomlPlace& place);

/// The table [units] with these names.
toml::table table_of(const UnitNames& names);

}  // namespace poise
