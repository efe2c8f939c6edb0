#pragma once

// Reads functions of time of loads and drives. Private to the readers of model/.

#include <optional>
#include <string_view>

#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// The function of time under `key` of an item, empty where it has none: the function's value is a factor, or on a
/// measure that measure's value. On a measure the function's rate must not jump. Throws InputError.
std::optional<TimeLaw> read_time_law(const TomlTable& item, std::string_view key, const Measure* on);
/// The table [frame], if there is one: accelerations along x and y.
void read_frame(const TomlTable& root, Scene& scene);

}  // namespace poise
