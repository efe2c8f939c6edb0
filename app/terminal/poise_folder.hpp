#pragma once

#include <filesystem>
#include <optional>

namespace poise::app {

/// The folder that holds Poise's docs/ and datasets/ on this machine, absolute: that installed with the running
/// program, else the sources that it was built from. Empty where there is neither.
std::optional<std::filesystem::path> poise_folder();

}  // namespace poise::app
