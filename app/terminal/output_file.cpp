#include "app/terminal/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "model/scene.hpp"

namespace poise::app {
namespace fs = std::filesystem;
namespace {

// Writes all of the text; returns 0 or the error.
int write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

/// A link that leads nowhere yet is a file to be made where it leads, as for a shell.
fs::path where_links_lead(fs::path path) {
  constexpr int most_links = 40;
  std::error_code none;
  for (int k = 0; k < most_links && fs::is_symlink(fs::symlink_status(path, none)); ++k) {
    const fs::path next = fs::read_symlink(path, none);
    if (none) break;
    path = path.parent_path() / next;
  }
  return path;
}

}  // namespace

OutputFile::OutputFile(fs::path path, std::string option) : path_(std::move(path)), option_(std::move(option)) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path_, ignored);
  if (fs::is_directory(status)) fail("it is a folder; give the name of a file in it");
  if (!path_.has_filename()) fail("it names no file");
  // What is a pipe or a device may have a link that names no path (/dev/stdout).
  target_ = fs::exists(status) ? fs::canonical(path_, ignored) : where_links_lead(path_);
  if (target_.empty()) target_ = path_;
  if (!fs::exists(status) && fs::is_symlink(fs::symlink_status(target_, ignored))) fail("its links lead in a circle");
  direct_ = fs::exists(status) && !fs::is_regular_file(status);
  if (fs::exists(status) && ::access(target_.c_str(), W_OK) != 0) fail(std::strerror(errno));
  if (direct_) return;
  passing_ = target_;
  passing_ += fmt::format(".{}.part", ::getpid());
  // Creating a file is the only reliable test that it can be created.
  const RemovedAtEnd removed(passing_);
  const int file = ::open(passing_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) fail(std::strerror(errno));
  ::close(file);
  ::unlink(passing_.c_str());
}

OutputFile::~OutputFile() {
  if (prepared_) ::unlink(passing_.c_str());
}

void OutputFile::prepare(std::string_view text) {
  const fs::path& place = direct_ ? target_ : passing_;
  auto removed = direct_ ? nullptr : std::make_unique<RemovedAtEnd>(passing_);
  const int file = ::open(place.c_str(), O_WRONLY | O_CLOEXEC | (direct_ ? 0 : O_CREAT | O_EXCL), 0666);
  if (file < 0) fail(std::strerror(errno));
  prepared_ = std::move(removed);
  const int error = write_all(file, text);
  const bool closed = ::close(file) == 0;
  if (error != 0) fail(std::strerror(error));
  if (!closed) fail(std::strerror(errno));
}

void OutputFile::commit() {
  if (!prepared_) return;
  std::error_code error;
  fs::rename(passing_, target_, error);
  if (error) fail(error.message());
  prepared_.reset();
}

void OutputFile::fail(const std::string& why) const {
  throw InputError(
      fmt::format("{}: cannot write \"{}\": {}; expected a path that can be written", option_, path_.string(), why));
}

}  // namespace poise::app
