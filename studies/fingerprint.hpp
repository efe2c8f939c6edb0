#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace poise::studies {

/// 16 hexadecimal digits that differ where the contents of the files or the words do (CRC-64 as in xz). Does not depend
/// on where the files are. Throws InputError where one cannot be read.
std::string fingerprint(const std::vector<std::filesystem::path>& files, const std::vector<std::string>& words);

}  // namespace poise::studies
