#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// A file that a scene reads, of points of a curve, of a function of time or of a part.
struct NamedFile {
  std::string name;  ///< as it is written: it counts from the scene's folder
  int line = 0;      ///< where it is named
};

/// The values of all keys `file` of a scene's text, without reading any of the files. Throws InputError where the text
/// is no TOML.
std::vector<NamedFile> named_files(std::string_view text, const std::string& scene);

/// The paths of the files that a TOML file names so, and of those that these name. What cannot be read names none here:
/// whoever reads it says so.
std::vector<std::string> files_named_from(const std::string& file);

/// Throws InputError where --scene writes a scene's text beside other files than those that it names; nowhere where
/// that is empty.
void expect_beside_files(std::string_view text, const std::string& scene, const std::string& written);

}  // namespace poise
