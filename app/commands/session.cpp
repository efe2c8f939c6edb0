#include "app/commands/session.hpp"

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>

#include "app/draw/mechanism.hpp"
#include "app/present/csv.hpp"
#include "app/present/json.hpp"
#include "app/present/markdown.hpp"
#include "app/present/text.hpp"
#include "identification/set_parameter.hpp"

namespace poise::app {
namespace fs = std::filesystem;
namespace {

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
  for (const std::string& setting : request.settings) set_parameter(scene, setting);
  return scene;
}

OutputFiles::OutputFiles(const Request& request, const std::vector<std::string>& read) {
  if (request.quiet && request.verbose) throw InputError("--quiet: expected no --verbose beside it; leave one out");
  const auto expect_not_read = [&](const std::string& file, const std::string& option) {
    expect_different(file, option, request.scene, "the " + request.kind);
    for (const std::string& other : read) expect_different(file, option, other, "a file that is read");
  };
  expect_not_read(request.json, "--json");
  expect_not_read(request.svg, "--svg");
  expect_not_read(request.csv, "--csv");
  expect_not_read(request.markdown, "--markdown");
  expect_different(request.svg, "--svg", request.json, "the --json file");
  expect_different(request.csv, "--csv", request.json, "the --json file");
  expect_different(request.csv, "--csv", request.svg, "the --svg file");
  expect_different(request.markdown, "--markdown", request.json, "the --json file");
  expect_different(request.markdown, "--markdown", request.svg, "the --svg file");
  expect_different(request.markdown, "--markdown", request.csv, "the --csv file");
  if (!request.json.empty()) json_.emplace(request.json, "--json");
  if (!request.svg.empty()) svg_.emplace(request.svg, "--svg");
  if (!request.csv.empty()) csv_.emplace(request.csv, "--csv");
  if (!request.markdown.empty()) markdown_.emplace(request.markdown, "--markdown");
}

std::string OutputFiles::write(const Result& result, const std::string& svg) {
  std::vector<OutputFile*> prepared;
  const auto prepare = [&](std::optional<OutputFile>& file, const std::string& text) {
    if (text.empty()) return;
    file->prepare(text);
    prepared.push_back(&*file);
  };
  const Table* const table = result.csv();
  if (json_) prepare(json_, json_text(result));
  if (svg_) prepare(svg_, svg);
  if (csv_ && table != nullptr) prepare(csv_, csv_text(*table));
  if (markdown_) prepare(markdown_, markdown_text(result));
  std::string lines;
  for (OutputFile* file : prepared) {
    file->commit();
    lines += "wrote " + file->path().string() + "\n";
  }
  return lines;
}

void print(const Request& request, const Result& result, const std::string& written, const Palette& palette) {
  if (request.quiet) return print(plain_text(result, palette, Verbosity::quiet));
  const Verbosity level = request.verbose ? Verbosity::verbose : Verbosity::normal;
  print(plain_text(result, palette, level) + (written.empty() ? "" : "\n" + written));
}

int finish(const Request& request, const Result& result, OutputFiles* files, const std::string& svg, bool is_solved,
           Progress& progress, const Palette& palette) {
  progress.now("writing the result");
  const std::string written = files != nullptr ? files->write(result, svg) : "";
  progress.done();
  print(request, result, written, palette);
  return is_solved ? solved : not_solved;
}

Answer search(const StaticModel& model, const SolveOptions& options, Progress& progress) {
  progress.now("searching by " + to_string(options.method));
  Equilibrium equilibrium = solve(model, options);
  if (equilibrium.found()) progress.now("refining the answer of " + to_string(options.method) + " in 50 digits");
  return measure(model, std::move(equilibrium));
}

std::string picture(const StaticModel& model, const Answer& answer) {
  return draw_svg(model, answer.equilibrium, assemble(model));
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw InputError("cannot write to standard output; expected a place that takes the report");
  }
}

}  // namespace poise::app
