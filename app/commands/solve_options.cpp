#include "app/commands/solve_options.hpp"

#include "app/commands/scene_options.hpp"

namespace poise::app {

void add_solve_options(CLI::App& command, Request& request, std::string& seek) {
  add_scene_options(command, request);
  command.add_option("--seek", seek, "nearest: any equilibrium near the start (the default);\nstable: minima only")
      ->type_name("WHAT");
  command.add_option("--json", request.json, "Write the result to FILE as JSON")->type_name("FILE");
  command.add_option("--svg", request.svg, "Draw it at rest, with loads and reactions, into FILE")->type_name("FILE");
}

Seek read_seek(const std::string& word) {
  return chosen("--seek", word, {"nearest", "stable"}) == 0 ? Seek::nearest : Seek::stable;
}

}  // namespace poise::app
