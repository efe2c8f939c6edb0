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

}  // namespace poise
