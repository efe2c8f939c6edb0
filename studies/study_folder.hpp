#pragma once

// The files of a study; docs/studies.md describes them. Private to this folder.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "studies/study.hpp"

namespace poise::studies {

/// A file that is only written at its end, by one process at a time.
class AppendedFile {
 public:
  /// Throws InputError where the file cannot be opened or made, or another process is writing it.
  explicit AppendedFile(std::filesystem::path path);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  std::uint64_t size() const { return size_; }
  /// Both throw InputError where that fails (the disk is full, say).
  void cut_to(std::uint64_t size);
  void append(std::string_view text);

 private:
  [[noreturn]] void fail(const std::string& expected) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

/// The chunks of a study that are in the files of a folder. Every shard has a file of its own.
class StudyFolder {
 public:
  /// Makes the folder if there is none, and finds the chunks it has. Throws InputError as run_study().
  StudyFolder(const Study& study, const StudyOptions& options);

  bool has(std::uint64_t chunk) const { return places_[chunk].length > 0; }
  /// The rows of the chunk, one behind the other.
  std::vector<double> read(std::uint64_t chunk) const;
  void append(std::uint64_t chunk, const std::vector<double>& rows);
  /// Of records whose checksum is wrong.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Place {
    std::size_t file = 0;  // of files_
    std::uint64_t offset = 0, length = 0;
  };
  std::string header() const;
  std::uint64_t find_chunks(const std::filesystem::path& file);
  void expect_same_study(const std::filesystem::path& file, const std::string& found) const;

  const Study& study_;
  std::filesystem::path own_;
  std::vector<std::filesystem::path> files_;
  std::vector<Place> places_;
  std::vector<std::string> warnings_;
  std::unique_ptr<AppendedFile> file_;
};

}  // namespace poise::studies
