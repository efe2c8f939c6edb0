#pragma once

// Files of other programs: the scene that one of them means, and a scene in their words. docs/exchange.md has the
// rules.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "model/mechanism.hpp"
#include "model/scene.hpp"

namespace poise {

/// A file of another program as a scene.
struct Imported {
  std::string text;                ///< of a scene file, which read_scene() takes
  std::vector<std::string> notes;  ///< a sentence on each thing that a rule decided or that was left out
};

/// The text with its notes above, as comments.
std::string text_with_notes(const Imported& imported);

/// A scene as a file of another program.
struct Exported {
  std::string text;
  std::vector<std::string> notes;  ///< a sentence on each thing that the format does not have
};

/// What a file may leave open.
struct ImportOptions {
  std::optional<std::string> length{};  ///< the name of its unit of length, one of UnitNames
  std::optional<double> tolerance{};    ///< distance at which two points are one, in the unit of the file
};

/// A format of files. Of reading and writing one may be missing.
struct FileFormat {
  std::string_view name;    ///< "dxf", the word of --format; poise export has the option --dxf
  std::string_view ending;  ///< of its files
  std::string_view what;    ///< "drawing in DXF: each link on its layer"
  /// `file` is for messages. Throws InputError, "file:line: item: expected ...", where the text is not of this format
  /// and where it has what no scene can have.
  Imported (*read)(std::string_view text, const std::string& file, const ImportOptions& options) = nullptr;
  /// The poses are those of Mechanism::poses(), in SI units. Throws InputError where the format cannot have the scene.
  Exported (*write)(const Scene& scene, const std::vector<BodyPose<double>>& poses) = nullptr;
};

/// All formats, in the order of the help.
std::span<const FileFormat> formats();

/// The format that `name` says, or, where it is empty, the ending of the file. Throws InputError unless it is one that
/// can be read.
const FileFormat& readable_format(const std::string& file, const std::string& name);

/// The scene with a mass for each body that has none, so that a model for dynamics keeps all of it: to see where its
/// points are, and how many freedoms it has.
Scene with_masses(Scene scene);

}  // namespace poise
