#include "app/view/held_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace poise::app {
namespace {

/// The lock covers the whole file. It belongs to what was opened, so that two sessions of one program see each other's.
struct flock whole_file(short type) {
  struct flock out {};
  out.l_type = type;
  out.l_whence = SEEK_SET;
  return out;
}

// A pipe must not be waited for.
int opened_to_lock(const std::filesystem::path& path) {
  return open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

/// Whether somebody else holds the file that was opened; where the file system knows no locks nobody does.
bool is_locked(int file) {
  struct flock wanted = whole_file(F_WRLCK);
  return fcntl(file, F_OFD_GETLK, &wanted) == 0 &&
         wanted.l_type != F_UNLCK;  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

bool is_same_file(int file, const std::filesystem::path& path) {
  struct stat here {
  }, there{};
  return fstat(file, &here) == 0 && stat(path.c_str(), &there) == 0 && here.st_dev == there.st_dev &&
         here.st_ino == there.st_ino;
}

}  // namespace

void HeldFile::hold(const std::filesystem::path& path) {
  path_ = path;
  hold();
}

void HeldFile::hold() {
  let_go();
  file_ = opened_to_lock(path_);
  if (file_ < 0) return;
  struct flock shared = whole_file(F_RDLCK);
  fcntl(file_, F_OFD_SETLK, &shared);  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

void HeldFile::let_go() {
  if (file_ >= 0) close(file_);
  file_ = -1;
}

bool HeldFile::is_shared() {
  if (path_.empty()) return false;
  if (file_ < 0 || !is_same_file(file_, path_)) hold();
  return file_ >= 0 && is_locked(file_);
}

bool HeldFile::is_held(const std::filesystem::path& path) {
  const int file = opened_to_lock(path);
  if (file < 0) return false;
  const bool out = is_locked(file);
  close(file);
  return out;
}

}  // namespace poise::app
