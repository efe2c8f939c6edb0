#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/terminal/interrupt.hpp"

namespace poise::app {

/// A file that appears whole or not at all: written under a temporary name in the same folder, then renamed. A signal
/// that ends the program removes what has the temporary name.
/// What is no regular file (/dev/stdout, a pipe) is written directly.
class OutputFile {
 public:
  /// Throws InputError, naming `option`, where the path cannot be written: no such folder, a folder itself, no
  /// permission. Leaves nothing behind.
  OutputFile(std::filesystem::path path, std::string option);
  ~OutputFile();
  OutputFile(OutputFile&&) noexcept = default;
  OutputFile& operator=(OutputFile&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes the text under the temporary name. Throws InputError where that fails (the disk is full, say).
  void prepare(std::string_view text);
  /// Renames the prepared file to its final name.
  void commit();

 private:
  [[noreturn]] void fail(const std::string& why) const;

  std::filesystem::path path_;    // as given
  std::filesystem::path target_;  // where links lead, whether something is there or not
  std::filesystem::path passing_;
  std::string option_;
  bool direct_ = false;
  std::unique_ptr<RemovedAtEnd> prepared_;  // holds the temporary name from prepare() to commit()
};

}  // namespace poise::app
