#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/path_positions.hpp"
#include "app/commands/session.hpp"
#include "app/draw/mechanism.hpp"
#include "app/results/exchange.hpp"
#include "exchange/dxf.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/static_model.hpp"

namespace poise::app {
namespace {

const std::vector<std::string> pose_words = {"start", "equilibrium"};
constexpr std::string_view ending_of_results = ".json";

struct ExportRequest {
  Request common;
  std::string pose = pose_words.front();
};

std::vector<const FileFormat*> written_formats() {
  std::vector<const FileFormat*> out;
  for (const FileFormat& format : formats()) {
    if (format.write != nullptr) out.push_back(&format);
  }
  return out;
}

void expect_a_file(const Request& request) {
  const bool is_any = std::any_of(request.exported.begin(), request.exported.end(),
                                  [](const auto& one) { return !one.second.empty(); });
  if (is_any || !request.svg.empty()) return;
  std::string options;
  for (const auto& [option, path] : request.exported) options += option + " FILE, ";
  throw InputError(fmt::format("poise: expected a file to write, {}or --svg FILE", options));
}

/// The words of --pose, with commas between.
std::vector<std::string> wanted_positions(const std::string& words) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= words.size();) {
    const std::size_t end = std::min(words.find(',', begin), words.size());
    const std::string word = words.substr(begin, end - begin);
    if (!word.ends_with(ending_of_results)) chosen("--pose", word, pose_words);
    if (std::find(out.begin(), out.end(), word) != out.end()) {
      throw InputError(fmt::format("--pose: expected each position once, found {} twice", word));
    }
    out.push_back(word);
    begin = end + 1;
  }
  return out;
}

/// A drawing alone has several positions.
void expect_one_position(const Request& request, std::size_t positions) {
  const std::string fix = fmt::format("expected one position, found {}; several are for --dxf alone", positions);
  for (const auto& [option, path] : request.exported) {
    if (positions > 1 && !path.empty() && option != "--dxf") throw InputError(fmt::format("{}: {}", option, fix));
  }
  if (positions > 1 && !request.svg.empty()) throw InputError(fmt::format("--svg: {}", fix));
}

int run_export(const ExportRequest& words, const Palette& palette) {
  const Request& request = words.common;
  const std::vector<std::string> wanted = wanted_positions(words.pose);
  expect_a_file(request);
  Progress progress(request.listener());
  progress.now("reading the scene");
  const Scene scene = load_scene(request);
  OutputFiles files(request);
  std::vector<NamedPosition> positions;
  for (const std::string& word : wanted) {
    if (word.ends_with(ending_of_results)) {
      progress.now("closing the loops");
      for (NamedPosition& one : positions_of_path(word, scene)) positions.push_back(std::move(one));
      continue;
    }
    if (word == pose_words.front()) {
      progress.now("closing the loops");
      const ScaledModel model(with_masses(scene), Purpose::dynamics);
      positions.push_back({"START", scene, model.poses(close_loops(model))});
      continue;
    }
    const StaticModel model(scene);
    SolveOptions options;
    options.interrupt = &request.interrupt();
    const Answer answer = search(model, options, progress);
    const Equilibrium& found = answer.equilibrium;
    if (!found.found() && found.status != Status::checked) {
      Result result = export_result(scene, request.settings, words.pose, 1, {});
      result.verdict = bad(fmt::format("Nothing was written, for no equilibrium was found: {}", found.why));
      return finish(request, result, nullptr, {}, false, progress, palette);
    }
    positions.push_back({"EQUILIBRIUM", scene, model.poses(found.x)});
  }
  expect_one_position(request, positions.size());
  std::vector<ExportedFormat> notes;
  std::vector<std::string> texts;
  const std::vector<const FileFormat*> known = written_formats();
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (request.exported[i].second.empty()) {
      texts.emplace_back();
      continue;
    }
    Exported exported = positions.size() > 1 ? export_dxf_positions(positions)
                                             : known[i]->write(positions.front().scene, positions.front().poses);
    texts.push_back(std::move(exported.text));
    notes.push_back({known[i], std::move(exported.notes)});
  }
  const Result result = export_result(scene, request.settings, words.pose, positions.size(), notes);
  Pictures pictures;
  if (files.wants_svg()) {
    const NamedPosition& shown = positions.front();
    pictures.svg = draw_mechanism(shown.scene, {.poses = shown.poses, .heading = result.verdict.text});
  }
  progress.now("writing the files");
  const std::string written = files.write(result, pictures, "", texts);
  progress.done();
  print(request, result, written, palette);
  return solved;
}

}  // namespace

Command export_command() {
  const auto request = std::make_shared<ExportRequest>();
  Command command{"export", "Write a scene as files of other programs"};
  add_scene_options(command, request->common);
  command
      .add({"--pose", &request->pose, "NAMES",
            "Where the mechanism is written: start (the default), equilibrium, or the\n"
            "file of poise path --json, with all its positions; of a drawing several,\nwith commas between"})
      .choices = pose_words;
  const std::vector<const FileFormat*> known = written_formats();
  request->common.exported.resize(known.size());  // options point into it
  for (std::size_t i = 0; i < known.size(); ++i) {
    auto& [option, path] = request->common.exported[i];
    option = fmt::format("--{}", known[i]->name);
    command.add({option, &path, "FILE", fmt::format("Write to FILE: {}", known[i]->what)})
        .writes(std::string(known[i]->ending));
  }
  add_output_options(command, request->common, {.svg = "Draw the mechanism in that position into FILE"});
  command.run = [request](const Palette& palette) { return run_export(*request, palette); };
  return command;
}

}  // namespace poise::app
