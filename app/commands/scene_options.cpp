#include "app/commands/scene_options.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/quantity.hpp"
#include "model/nearest_name.hpp"

namespace poise::app {

void add_scene_options(Command& command, Request& request) {
  command.add({"SCENE", &request.scene, "", "Scene file (TOML)", Presence::required});
  add_settings(command, request);
}

void add_settings(Command& command, Request& request) {
  command.add({"--set", &request.settings, "PATH=NUMBER",
               "Change a number of the scene, in its own units: load.P=40,\n"
               "body.arm.mass=2, spring.S.stiffness=300, start.arm=0.5, ...;\n"
               "can be given several times"});
}

void add_output_options(Command& command, Request& request, const FileHelp& help) {
  command.add({"--json", &request.json, "FILE", "Write the result to FILE as JSON (keys: docs/json.md)"});
  if (!help.csv.empty()) command.add({"--csv", &request.csv, "FILE", help.csv});
  command.add({"--markdown", &request.markdown, "FILE", "Write the result to FILE as Markdown"});
  if (!help.svg.empty()) command.add({"--svg", &request.svg, "FILE", help.svg});
  command.add({"--quiet", &request.quiet, "", "Print the verdict and warnings only"});
  command.add({"--verbose", &request.verbose, "", "Print all details"});
}

void add_seek_option(Command& command, std::string& seek) {
  command.add({"--seek", &seek, "WHAT",
               "nearest: any equilibrium near the start (the default;\nminimising methods find minima only); stable: "
               "minima only"});
}

Seek read_seek(const std::string& word) {
  return chosen("--seek", word, {"nearest", "stable"}) == 0 ? Seek::nearest : Seek::stable;
}

std::size_t chosen(const std::string& option, const std::string& word, const std::vector<std::string>& words) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  throw InputError(
      fmt::format("{}: expected {}, found \"{}\"{}", option, listed(words, "or"), word, did_you_mean(word, words)));
}

}  // namespace poise::app
