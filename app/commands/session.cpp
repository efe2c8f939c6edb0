#include "app/commands/session.hpp"

#include <charconv>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "app/svg.hpp"

namespace poise::app {
namespace fs = std::filesystem;
namespace {

void apply(const std::string& setting, Scene& scene) {
  const std::size_t equals = setting.rfind('=');
  const std::string example = "; expected PATH=NUMBER, say load.P=40";
  if (equals == std::string::npos) throw InputError(fmt::format("--set {}: there is no \"=\"{}", setting, example));
  const char* begin = setting.data() + equals + 1;
  const char* end = setting.data() + setting.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0.0;
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stopped != end) {
    throw InputError(fmt::format("--set {}: \"{}\" is not a number{}", setting, setting.substr(equals + 1), example));
  }
  try {
    set_value(scene, std::string_view(setting).substr(0, equals), value);
  } catch (const InputError& e) {
    throw InputError(fmt::format("--set {}", e.what()));
  }
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code unknown;
  return fs::equivalent(a, b, unknown) || fs::absolute(a).lexically_normal() == fs::absolute(b).lexically_normal();
}

void expect_different(const std::string& a, const std::string& name_a, const std::string& b,
                      const std::string& name_b) {
  if (a.empty() || b.empty() || !same_file(a, b)) return;
  throw InputError(fmt::format("{}: \"{}\" is {} too; expected another file", name_a, a, name_b));
}

}  // namespace

Scene load_scene(const Request& request) {
  Scene scene = read_scene(request.scene);
  for (const std::string& setting : request.settings) apply(setting, scene);
  return scene;
}

OutputFiles::OutputFiles(const Request& request) {
  expect_different(request.json, "--json", request.scene, "the scene");
  expect_different(request.svg, "--svg", request.scene, "the scene");
  expect_different(request.svg, "--svg", request.json, "the --json file");
  if (!request.json.empty()) json_.emplace(request.json, "--json");
  if (!request.svg.empty()) svg_.emplace(request.svg, "--svg");
}

std::string OutputFiles::write(const std::string& json, const std::string& svg) {
  if (json_ && !json.empty()) json_->prepare(json);
  if (svg_ && !svg.empty()) svg_->prepare(svg);
  std::string lines;
  if (json_ && !json.empty()) {
    json_->commit();
    lines += "wrote " + json_->path().string() + "\n";
  }
  if (svg_ && !svg.empty()) {
    svg_->commit();
    lines += "wrote " + svg_->path().string() + "\n";
  }
  return lines;
}

Answer search(const StaticModel& model, const SolveOptions& options, Progress& progress) {
  progress.now("searching by " + to_string(options.method));
  Equilibrium rest = solve(model, options);
  if (rest.found()) progress.now("refining the answer of " + to_string(options.method) + " in 50 digits");
  return measure(model, std::move(rest));
}

std::string picture(const StaticModel& model, const Answer& answer) {
  return draw_svg(model, answer.rest, assemble(model));
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw InputError("cannot write to standard output; expected a place that takes the report");
  }
}

}  // namespace poise::app
