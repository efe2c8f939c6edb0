#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace poise {

/// All bytes of a text file of at most so many. Throws InputError: "FILE: cannot be read: why; check the path", or
/// where it is larger or, like most files that are no text, contains a NUL byte.
std::string read_text_file(const std::filesystem::path& file, std::size_t most_bytes = std::size_t{64} << 20U);

/// Throws InputError for a folder, a device or a pipe, which would wait for a writer. What is not there passes.
void expect_regular_file(const std::filesystem::path& file);

}  // namespace poise
