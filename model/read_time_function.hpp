#pragma once

// Reads functions of time of loads and drives. Private to the readers of model/.

#include <optional>

#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// The table `time` of a load or drive, empty where it has none: the function's value is a factor, or on a measure that
/// measure's value. On a measure the function must have continuous second derivatives. Throws InputError.
std::optional<TimeLaw> read_time_law(const TomlTable& item, const Measure* on);

}  // namespace poise
