#include "app/commands/solve_options.hpp"

#include <fmt/format.h>

#include "app/commands/scene_options.hpp"
#include "app/shown_values.hpp"

namespace poise::app {

void add_solve_options(Command& command, Request& request, std::string& seek) {
  add_scene_options(command, request);
  command.add({"--seek", &seek, "WHAT",
               "nearest: any equilibrium near the start (the default; what seeks\nleast energy finds minima only); "
               "stable: minima only"});
  command.add({"--json", &request.json, "FILE",
               fmt::format("Write the result to FILE as JSON. Its energy counts\n{}", energy_note)});
  command.add({"--svg", &request.svg, "FILE", "Draw it at rest, with loads and reactions, into FILE"});
}

Seek read_seek(const std::string& word) {
  return chosen("--seek", word, {"nearest", "stable"}) == 0 ? Seek::nearest : Seek::stable;
}

}  // namespace poise::app
