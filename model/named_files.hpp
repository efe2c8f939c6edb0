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

/// The paths of these files, of a scene whose text --scene writes into a file; nowhere where that is empty. Throws
/// InputError unless it is in the folder of the scene, beside which it will read them.
std::vector<std::string> files_beside(std::string_view text, const std::string& scene, const std::string& written);

}  // namespace poise
