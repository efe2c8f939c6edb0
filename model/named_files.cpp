#include "model/named_files.hpp"

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

}  // namespace poise
