#pragma once

// Where scene files and SceneBuilder meet. Private to model/.

#include <vector>

#include "model/scene.hpp"
#include "model/scene_names.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// What readers of a scene may want besides.
struct ReadingOptions {
  bool may_lack_bodies = false;          ///< it is still being drawn
  std::vector<NameUse>* uses = nullptr;  ///< where its items refer to others, but in [start] and [outputs]
};

/// Reads and checks the document of a scene; `place` names it in messages.
Scene read_document(toml::table document, const TomlPlace& place, const ReadingOptions& options = {});

/// Reads a table [units].
Units read_units(const TomlTable& table);

/// The table [units] with these names.
toml::table table_of(const UnitNames& names);

}  // namespace poise
