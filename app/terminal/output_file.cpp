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

}  // namespace

OutputFile::OutputFile(fs::path path, std::string option) : path_(std::move(path)), option_(std::move(option)) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path_, ignored);
  if (fs::is_directory(status)) fail("it is a folder; give the name of a file in it");
  if (!path_.has_filename()) fail("it names no file");
  target_ = fs::exists(status) ? fs::canonical(path_, ignored) : path_;
  if (target_.empty()) target_ = path_;
  direct_ = fs::exists(status) && !fs::is_regular_file(status);
  if (fs::exists(status) && ::access(target_.c_str(), W_OK) != 0) fail(std::strerror(errno));
  if (direct_) return;
  passing_ = target_;
  passing_ += fmt::format(".{}.part", ::getpid());
  // Creating a file is the only reliable test that it can be created.
  const int file = ::open(passing_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) fail(std::strerror(errno));
  ::close(file);
  ::unlink(passing_.c_str());
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      passing_(std::move(other.passing_)),
      option_(std::move(other.option_)),
      direct_(other.direct_),
      prepared_(std::exchange(other.prepared_, false)) {}

OutputFile::~OutputFile() {
  if (prepared_) ::unlink(passing_.c_str());
}

void OutputFile::prepare(std::string_view text) {
  const fs::path& place = direct_ ? target_ : passing_;
  const int file = ::open(place.c_str(), O_WRONLY | O_CLOEXEC | (direct_ ? 0 : O_CREAT | O_EXCL), 0666);
  if (file < 0) fail(std::strerror(errno));
  prepared_ = !direct_;
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
  prepared_ = false;
}

void OutputFile::fail(const std::string& why) const {
  throw InputError(
      fmt::format("{}: cannot write \"{}\": {}; expected a path that can be written", option_, path_.string(), why));
}

}  // namespace poise::app
