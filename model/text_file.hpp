#pragma once

#include <filesystem>
#include <string>

namespace poise {

/// All bytes of a file. Throws InputError "FILE: cannot be read: why; check the path".
std::string read_text_file(const std::filesystem::path& file);

}  // namespace poise
