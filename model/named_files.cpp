#include "model/named_files.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "model/text_file.hpp"
#include "model/toml_reader.hpp"

namespace poise {
namespace {

void add_named(const toml::node& node, std::vector<NamedFile>& out) {
  if (const toml::array* const list = node.as_array()) {
    for (const toml::node& one : *list) add_named(one, out);
  }
  const toml::table* const table = node.as_table();
  if (table == nullptr) return;
  for (const auto& [key, value] : *table) {
    if (const auto* const name = value.as_string(); name != nullptr && key.str() == "file") {
      out.push_back({name->get(), static_cast<int>(name->source().begin.line)});
    }
    add_named(value, out);
  }
}

}  // namespace

std::vector<NamedFile> named_files(std::string_view text, const std::string& scene) {
  std::vector<NamedFile> out;
  add_named(parse_toml(text, scene), out);
  return out;
}

std::vector<std::string> files_named_from(const std::string& file) {
  namespace fs = std::filesystem;
  std::vector<std::string> out, open{file};
  while (!open.empty()) {
    const fs::path path = open.back();
    open.pop_back();
    std::error_code unknown;
    if (path.extension() != ".toml" || !fs::is_regular_file(path, unknown)) continue;
    try {
      for (const NamedFile& one : named_files(read_text_file(path), path.string())) {
        std::string named = (path.parent_path() / one.name).lexically_normal().string();
        if (std::find(out.begin(), out.end(), named) != out.end()) continue;
        open.push_back(named);
        out.push_back(std::move(named));
      }
    } catch (const InputError&) {
      continue;
    }
  }
  return out;
}

void expect_beside_files(std::string_view text, const std::string& scene, const std::string& written) {
  namespace fs = std::filesystem;
  const auto folder_of = [](const fs::path& file) { return fs::weakly_canonical(fs::absolute(file).parent_path()); };
  const std::vector<NamedFile> named = named_files(text, scene);
  if (written.empty() || named.empty() || folder_of(written) == folder_of(scene)) return;
  throw InputError(fmt::format("--scene {}: expected a file in the folder of {}, beside which it reads {}", written,
                               scene, named.front().name));
}

}  // namespace poise
