#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace poise::app {

/// The file of a new part, beside that of the scene. It is written at once, since the scene is read with it; undo
/// leaves it there for redo.
class PartFile {
 public:
  /// Finds a name where none is given: "part_1", "part_2", ..., the first that neither a part of the scene nor a file
  /// has.
  PartFile(const std::filesystem::path& scene, const std::string& given, const std::vector<std::string>& parts);

  const std::string& name() const { return name_; }
  /// As the scene names it.
  std::string file() const { return path_.filename().string(); }
  /// Writes a file that is not there yet. Throws InputError where another text stands there.
  void write(const std::string& text);
  /// Takes away what write() has written.
  void remove();

 private:
  std::string name_;
  std::filesystem::path path_;
  bool is_new_ = false;
};

}  // namespace poise::app
