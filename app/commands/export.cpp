#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/mechanism.hpp"
#include "app/results/exchange.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/static_model.hpp"

namespace poise::app {
namespace {

const std::vector<std::string> pose_words = {"start", "equilibrium"};

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

int run_export(const ExportRequest& words, const Palette& palette) {
  const Request& request = words.common;
  const bool at_start = chosen("--pose", words.pose, pose_words) == 0;
  expect_a_file(request);
  Progress progress(request.listener());
  progress.now("reading the scene");
  const Scene scene = load_scene(request);
  OutputFiles files(request);
  std::vector<BodyPose<double>> poses;
  if (at_start) {
    progress.now("closing the loops");
    const ScaledModel model(with_masses(scene), Purpose::dynamics);
    poses = model.poses(close_loops(model));
  } else {
    const StaticModel model(scene);
    SolveOptions options;
    options.interrupt = &request.interrupt();
    const Answer answer = search(model, options, progress);
    const Equilibrium& found = answer.equilibrium;
    if (!found.found() && found.status != Status::checked) {
      Result result = export_result(scene, request.settings, words.pose, {});
      result.verdict = bad(fmt::format("Nothing was written, for no equilibrium was found: {}", found.why));
      return finish(request, result, nullptr, {}, false, progress, palette);
    }
    poses = model.poses(found.x);
  }
  std::vector<ExportedFormat> notes;
  std::vector<std::string> texts;
  const std::vector<const FileFormat*> known = written_formats();
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (request.exported[i].second.empty()) {
      texts.emplace_back();
      continue;
    }
    Exported exported = known[i]->write(scene, poses);
    texts.push_back(std::move(exported.text));
    notes.push_back({known[i], std::move(exported.notes)});
  }
  const Result result = export_result(scene, request.settings, words.pose, notes);
  Pictures pictures;
  if (files.wants_svg()) {
    pictures.svg = draw_mechanism(scene, {.poses = poses, .heading = result.verdict.text});
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
  command.add({"--pose", &request->pose, "WHICH", "start (the default) or equilibrium: where the mechanism is written"})
      .choices = pose_words;
  const std::vector<const FileFormat*> known = written_formats();
  request->common.exported.resize(known.size());  // options point into it
  for (std::size_t i = 0; i < known.size(); ++i) {
    auto& [option, path] = request->common.exported[i];
    option = fmt::format("--{}", known[i]->name);
    command.add({option, &path, "FILE", fmt::format("Write to FILE: {}", known[i]->what)})
        .writes(std::string(known[i]->ending));
  }
  add_output_options(command, request->common, {.svg = "Draw the mechanism in that pose into FILE"});
  command.run = [request](const Palette& palette) { return run_export(*request, palette); };
  return command;
}

}  // namespace poise::app
