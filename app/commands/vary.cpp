#include "app/commands/vary.hpp"

#include <utility>

#include "app/commands/session.hpp"

namespace poise::app {

NamedRange read_vary_range(const std::string& text) {
  return read_named_range("--vary", text, "NAME=FROM..TO, say load.P=0..5");
}

VariedScene load_varied_scene(const Request& request, const NamedRange& range) {
  Scene scene = load_scene(request);
  return naming_vary([&] { return VariedScene(std::move(scene), range.name, range.from, range.to); });
}

}  // namespace poise::app
