#include "app/view/part_file.hpp"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "app/terminal/output_file.hpp"
#include "model/input_error.hpp"
#include "model/one_line.hpp"
#include "model/text_file.hpp"

namespace poise::app {
namespace {

bool is_something(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::exists(std::filesystem::symlink_status(path, unknown));
}

}  // namespace

PartFile::PartFile(const std::filesystem::path& scene, const std::string& given, const std::vector<std::string>& parts)
    : name_(given) {
  const auto path_of = [&](const std::string& name) { return scene.parent_path() / (name + ".toml"); };
  if (!given.empty()) {
    // What is no name of a part could name a file elsewhere.
    const bool is_plain = std::all_of(given.begin(), given.end(), [](unsigned char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!is_plain || (given[0] >= '0' && given[0] <= '9'))
      throw InputError(fmt::format("name: expected letters, digits and underscores, not a digit first, found \"{}\"",
                                   one_line(given)));
  }
  for (int k = 1; name_.empty(); ++k) {
    const std::string name = fmt::format("part_{}", k);
    const bool is_taken = std::find(parts.begin(), parts.end(), name) != parts.end();
    if (!is_taken && !is_something(path_of(name))) name_ = name;
  }
  path_ = path_of(name_);
}

void PartFile::write(const std::string& text) {
  if (is_something(path_)) {
    expect_regular_file(path_);
    if (read_text_file(path_) == text) return;
    throw InputError(fmt::format("name: expected another one; {} is there already", path_.filename().string()));
  }
  OutputFile out(path_, "name");
  out.prepare(text);
  out.commit();
  is_new_ = true;
}

void PartFile::remove() {
  std::error_code ignored;
  if (is_new_) std::filesystem::remove(path_, ignored);
}

}  // namespace poise::app
