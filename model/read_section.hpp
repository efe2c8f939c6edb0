#pragma once

// Reads the cross-section of a body. Private to the readers of model/.

#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads the table [body.NAME.section] of a body whose points have been read. A profile gives those of area,
/// second_moment and height that the table does not have.
CrossSection read_section(const TomlTable& table, const Body& body);

}  // namespace poise
