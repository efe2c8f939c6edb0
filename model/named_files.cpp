#include "model/named_files.hpp"

#include <filesystem>

#include <fmt/format.h>

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

std::vector<std::string> files_beside(std::string_view text, const std::string& scene, const std::string& written) {
  namespace fs = std::filesystem;
  const auto folder_of = [](const fs::path& file) { return fs::weakly_canonical(fs::absolute(file).parent_path()); };
  std::vector<std::string> out;
  for (const NamedFile& one : named_files(text, scene)) {
    if (!written.empty() && folder_of(written) != folder_of(scene)) {
      throw InputError(fmt::format("--scene {}: expected a file in the folder of {}, beside which it reads {}", written,
                                   scene, one.name));
    }
    out.push_back((fs::path(scene).parent_path() / one.name).string());
  }
  return out;
}

}  // namespace poise
