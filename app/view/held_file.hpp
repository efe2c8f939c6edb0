#pragma once

#include <filesystem>
#include <utility>

namespace poise::app {

/// Tells other programs, and other sessions of this one, that a file is used here, and learns whether they use it: by a
/// lock on it which ends with the program, however that ends. It keeps nobody from reading or writing.
class HeldFile {
 public:
  HeldFile() = default;
  /// Holds the file, or nothing as long as there is none.
  explicit HeldFile(std::filesystem::path path) : path_(std::move(path)) { hold(); }
  ~HeldFile() { let_go(); }
  HeldFile(const HeldFile&) = delete;
  HeldFile& operator=(const HeldFile&) = delete;

  /// Holds what has the path now, which may be another file than before.
  void hold(const std::filesystem::path& path);
  void let_go();
  /// Whether others hold it too. Where another file has taken its place that is held instead.
  bool is_shared();

  /// Whether anybody holds the file.
  static bool is_held(const std::filesystem::path& path);

 private:
  void hold();

  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace poise::app
