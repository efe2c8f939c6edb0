#include "model/text_file.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include "model/scene.hpp"

namespace poise {

std::string read_text_file(const std::filesystem::path& file) {
  const auto fail = [&](int error) {
    throw InputError(file.string() + ": cannot be read: " + std::generic_category().message(error) +
                     "; check the path");
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) fail(EISDIR);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(errno);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace poise
