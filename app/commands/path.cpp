#include "statics/path.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/chart/plot.hpp"
#include "app/draw/path_picture.hpp"
#include "app/present/numbers.hpp"
#include "app/results/statics/path.hpp"
#include "app/terminal/interrupt.hpp"
#include "motion/dynamic_stability.hpp"
#include "statics/mobility.hpp"

namespace poise::app {
namespace {

struct PathRequest {
  Request common;
  std::string vary, from = "settle", follow = "unstable", at;
  std::vector<std::string> measures;
  bool branches = false;
  std::optional<double> proof_seconds;
};

VariedScene read_vary(const std::string& text, Scene scene) {
  const NamedRange given = read_named_range("--vary", text, "NAME=FROM..TO, say load.P=0..5");
  try {
    return {std::move(scene), given.name, given.from, given.to};
  } catch (const AssemblyError&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(std::string("--vary ") + error.what());
  }
}

/// SI.
std::vector<double> read_at(const std::string& text, const VariedScene& varied) {
  if (text.empty()) return {};
  const auto [least, most] = std::minmax({varied.from(), varied.to()});
  std::vector<double> out;
  for (const double value : read_numbers("--at", text)) {
    const double si = value * varied.unit();
    if (si < least || si > most) {
      throw InputError(fmt::format("--at {}: expected values within the range of {}, {}..{}, found {}", text,
                                   varied.name(), varied.from() / varied.unit(), varied.to() / varied.unit(), value));
    }
    out.push_back(si);
  }
  return out;
}

std::vector<PathMeasure> read_measures(const std::vector<std::string>& names, const Scene& scene) {
  std::vector<PathMeasure> out;
  for (const std::string& name : names) {
    try {
      out.push_back(path_measure(scene, name));
    } catch (const InputError& error) {
      throw InputError(std::string("--measure ") + error.what());
    }
  }
  return out;
}

PathOptions read_options(const PathRequest& request) {
  PathOptions options;
  options.from = chosen("--from", request.from, {"settle", "equilibrium"}) == 0 ? PathOptions::From::settle
                                                                                : PathOptions::From::equilibrium;
  options.follow = chosen("--follow", request.follow, {"unstable", "jump"}) == 0 ? PathOptions::Follow::unstable
                                                                                 : PathOptions::Follow::jump;
  options.branches = request.branches;
  options.certificate = read_proof(request.proof_seconds);
  options.dynamic_stability = dynamic_stability;
  options.interrupt = &watch_for_interrupt();
  return options;
}

/// Shows how far a path has come.
std::function<void(double, int)> progress_of(Progress& progress, const VariedScene& varied) {
  return [&](double parameter, int points) {
    progress.now_and_then([&] {
      return fmt::format("following the curve: {} = {:.4g} {}, {}", varied.name(), parameter / varied.unit(),
                         varied.unit_name(), count(points, "point", "points"));
    });
  };
}

int run_path(const PathRequest& request, const Palette& palette) {
  PathOptions options = read_options(request);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress;
  progress.now("reading the scene");
  const VariedScene varied = read_vary(request.vary, load_scene(request.common));
  options.at = read_at(request.at, varied);
  PathView view{
      .measures = read_measures(request.measures, varied.scene()), .at = options.at, .follow = options.follow};
  OutputFiles files(request.common);
  progress.now("following the curve of equilibria");
  options.progress = progress_of(progress, varied);
  const Path found = path(varied, options);

  const bool any = std::any_of(found.branches.begin(), found.branches.end(),
                               [](const PathBranch& branch) { return !branch.points.empty(); });
  const std::vector<PathMeasure> asked = view.measures;
  if (any && view.measures.empty() && !varied.is_driven()) view.measures = {most_changing(varied, found)};
  const Result result = path_result(varied, found, view, request.common.settings);
  const bool proved = found.status == Path::Status::traced && found.unproved() == 0;
  std::string svg;
  if (files.wants_svg() && any) {
    progress.now("drawing");
    svg = path_picture(varied, found, asked, result.verdict.text, proved);
  }
  return finish(request.common, result, &files, svg, proved, progress, palette);
}

}  // namespace

Command path_command() {
  const auto request = std::make_shared<PathRequest>();
  Command command{"path", "Follow the equilibria as a load, a dimension or a driven angle or travel changes"};
  add_scene_options(command, request->common);
  command.add(
      {"--vary", &request->vary, "NAME=FROM..TO",
       "Vary a number of the scene, in its own units: load.P=0..5,\nspring.S.stiffness=1..3; loads=0..1 (a factor "
       "of all loads);\nangle.BODY or travel.JOINT: what is driven, with the effort needed",
       Presence::required});
  command.add(
      {"--from", &request->from, "WHAT",
       "settle: where the mechanism comes to rest when released from its\nstart (the default); equilibrium: the "
       "one nearest to the start"});
  command.add({"--follow", &request->follow, "WHAT",
               "unstable: the curve through its folds (the default); jump: stable\nequilibria only, snapping at folds, "
               "there and back"});
  command.add({"--branches", &request->branches, "", "Follow all curves that cross at branch points too"});
  command.add({"--at", &request->at, "NUMBERS", "Show the equilibria at these values of the number: 1,2.5,5"});
  command.add({"--measure", &request->measures, "NAME",
               "Show this at every point: a body's angle, a slide's travel,\nBODY.POINT.x, BODY.POINT.y, the length or "
               "angle of a force element;\nseveral times (what changes most)"});
  add_proof_option(command, request->proof_seconds);
  add_output_options(command, request->common,
                     {.svg = "Draw the curve, and the mechanism at its start, end, folds, snaps and\nstops, into FILE",
                      .csv = "Write the curve, one line for each point, to FILE"});
  command.run = [request](const Palette& palette) { return run_path(*request, palette); };
  return command;
}

}  // namespace poise::app
