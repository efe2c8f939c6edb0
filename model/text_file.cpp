#include "model/text_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "model/input_error.hpp"

namespace poise {

std::string read_text_file(const std::filesystem::path& file, std::size_t most_bytes) {
  const auto fail = [&](int error) {
    throw InputError(file.string() + ": cannot be read: " + std::generic_category().message(error) +
                     "; check the path");
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) fail(EISDIR);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(errno);
  std::string text;
  // Part by part: what is no regular file may have no end.
  for (std::array<char, 65536> part{}; stream;) {
    stream.read(part.data(), part.size());
    text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
    const std::size_t nul = text.find('\0', text.size() - static_cast<std::size_t>(stream.gcount()));
    if (nul != std::string::npos) {
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(nul), '\n');
      throw InputError(file.string() + ":" + std::to_string(line) +
                       ": expected a text, found a NUL byte; save the file as UTF-8");
    }
    if (text.size() > most_bytes) {
      throw InputError(file.string() + ": expected at most " + std::to_string(most_bytes >> 20U) +
                       " MiB of text, found more; check the path");
    }
  }
  if (stream.bad()) fail(errno);
  return text;
}

void expect_regular_file(const std::filesystem::path& file) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(file, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return;
  throw InputError(file.string() + ": expected a file, found " +
                   (std::filesystem::is_directory(status) ? "a folder" : "a device or a pipe") + "; check the path");
}

}  // namespace poise
