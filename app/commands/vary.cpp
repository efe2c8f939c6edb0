#include "app/commands/vary.hpp"

#include <utility>

#include <fmt/format.h>

#include "app/commands/session.hpp"
#include "app/result/numbers.hpp"

namespace poise::app {

NamedRange read_vary_range(const std::string& text) {
  return read_named_range("--vary", text, "NAME=FROM..TO, say load.P=0..5");
}

VariedScene load_varied_scene(const Request& request, const NamedRange& range) {
  Scene scene = load_scene(request);
  return naming_vary([&] { return VariedScene(std::move(scene), range.name, range.from, range.to); });
}

std::vector<std::string> from_words() { return {"settle", "equilibrium"}; }

PathOptions::From read_from(const std::string& word) {
  return chosen("--from", word, from_words()) == 0 ? PathOptions::From::settle : PathOptions::From::equilibrium;
}

std::function<void(double, int)> progress_of(Progress& progress, const VariedScene& varied) {
  return [&](double parameter, int points) {
    progress.now_and_then([&] {
      return fmt::format("following the curve: {} = {:.4g} {}, {}", varied.name(), parameter / varied.unit(),
                         varied.unit_name(), count(points, "point", "points"));
    });
  };
}

}  // namespace poise::app
