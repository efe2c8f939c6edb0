#include "design/goals/design_kind.hpp"

#include <string>

#include <fmt/format.h>

#include "model/text_file.hpp"
#include "model/toml_reader.hpp"

namespace poise {

DesignKind kind_of_design(const std::filesystem::path& file) {
  const std::string text = read_text_file(file), name = file.string();
  const toml::table document = parse_toml(text, name);
  const TomlTable root(document, {name, 1, ""});  // which refers to the name
  if (root.has("body") && !root.has("scene")) {
    root.place_of("body").fail("expected a design, found a scene; give a file that names it with scene = \"...\"");
  }
  const toml::node* const goal = document.get("goal");
  std::string first;
  DesignKind kind = DesignKind::guidance;
  const auto see = [&](const std::string& key, DesignKind of) {
    if (!root.has(key)) return;
    if (!first.empty()) {
      root.place_of(key).fail(fmt::format("expected one kind of design, found {} and {}; remove one", first, key));
    }
    first = key;
    kind = of;
  };
  see("goal", goal != nullptr && goal->is_array() ? DesignKind::goals : DesignKind::guidance);
  see("synthesis", DesignKind::synthesis);
  see("balance", DesignKind::balance);
  if (first.empty()) {
    root.place().fail(
        "expected a table that says what is designed: [[goal]], [synthesis], [balance] or [goal]; add one");
  }
  return kind;
}

}  // namespace poise
