#include "statics/paths/path.hpp"

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
#include "app/result/numbers.hpp"
#include "app/results/statics/fold_curve.hpp"
#include "app/results/statics/path.hpp"
#include "app/terminal/interrupt.hpp"
#include "motion/dynamic_stability.hpp"
#include "statics/model/mobility.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {
namespace {

struct PathRequest {
  Request common;
  std::string curve = "equilibria", from = "settle", follow = "unstable", at;
  std::vector<std::string> vary, measures, show;
  bool branches = false;
  int search = 0;
  std::optional<double> proof_seconds;
};

/// Names the option in what make() says of bad input.
template <class Make>
auto naming_option(Make make) {
  try {
    return make();
  } catch (const AssemblyError&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(std::string("--vary ") + error.what());
  }
}

NamedRange read_range(const std::string& text) {
  return read_named_range("--vary", text, "NAME=FROM..TO, say load.P=0..5");
}

VariedScene read_vary(const PathRequest& request) {
  if (request.vary.size() != 1) {
    throw InputError(fmt::format("--vary: expected one number, found {}; two with --curve fold", request.vary.size()));
  }
  const NamedRange given = read_range(request.vary[0]);
  return naming_option([&] { return VariedScene(load_scene(request.common), given.name, given.from, given.to); });
}

VariedPair read_pair(const PathRequest& request) {
  if (request.vary.size() != 2) {
    throw InputError(fmt::format("--curve fold: expected --vary twice, found {} of it", request.vary.size()));
  }
  for (const auto& [option, given] :
       {std::pair("--at", !request.at.empty()), std::pair("--show", !request.measures.empty() || !request.show.empty()),
        std::pair("--branches", request.branches), std::pair("--search", request.search != 0),
        std::pair("--proof-seconds", request.proof_seconds.has_value()),
        std::pair("--follow", request.follow != "unstable")}) {
    if (given) throw InputError(fmt::format("{}: not with --curve fold, where it has no meaning", option));
  }
  const NamedRange first = read_range(request.vary[0]), second = read_range(request.vary[1]);
  return naming_option([&] {
    return VariedPair(load_scene(request.common), {first.name, first.from, first.to},
                      {second.name, second.from, second.to});
  });
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

PathOptions::From read_from(const PathRequest& request) {
  return chosen("--from", request.from, {"settle", "equilibrium"}) == 0 ? PathOptions::From::settle
                                                                        : PathOptions::From::equilibrium;
}

PathOptions read_options(const PathRequest& request) {
  PathOptions options;
  options.from = read_from(request);
  options.follow = chosen("--follow", request.follow, {"unstable", "jump"}) == 0 ? PathOptions::Follow::unstable
                                                                                 : PathOptions::Follow::jump;
  options.branches = request.branches;
  expect_between("--search", request.search, 0, 1'000'000);
  options.search = request.search;
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

int run_fold_curve(const PathRequest& request, const Palette& palette) {
  FoldCurveOptions options;
  options.from = read_from(request);
  options.interrupt = &watch_for_interrupt();
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress;
  progress.now("reading the scene");
  const VariedPair pair = read_pair(request);
  OutputFiles files(request.common);
  progress.now("looking for folds");
  options.progress = [&](double first, double second, int points) {
    progress.now_and_then([&] {
      return fmt::format("following folds: {} = {:.4g}, {} = {:.4g}, {}", pair.first().name(),
                         first / pair.first().unit(), pair.second().name(), second / pair.second().unit(),
                         count(points, "point", "points"));
    });
  };
  const FoldCurve found = fold_curve(pair, options);
  const Result result = fold_curve_result(pair, found, request.common.settings);
  Pictures pictures;
  if (files.wants_svg() && !found.curves.empty()) {
    progress.now("drawing");
    pictures.svg = draw_plot({fold_curve_panel(pair, found)});
  }
  if (files.wants_html() && !found.curves.empty()) {
    pictures.figures = chart_figures("Curve of folds", {fold_curve_panel(pair, found)});
  }
  return finish(request.common, result, &files, pictures, found.status == FoldCurve::Status::traced, progress, palette);
}

int run_path(const PathRequest& request, const Palette& palette) {
  if (chosen("--curve", request.curve, {"equilibria", "fold"}) == 1) return run_fold_curve(request, palette);
  PathOptions options = read_options(request);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress;
  progress.now("reading the scene");
  const VariedScene varied = read_vary(request);
  options.at = read_at(request.at, varied);
  const Scene named = named_scene(varied);
  std::vector<std::string> names = request.measures;
  names.insert(names.end(), request.show.begin(), request.show.end());
  Shown shown = read_shown(request.measures.empty() ? "--show" : "--measure", names, named);
  PathView view{.measures = std::move(shown.of_position),
                .over_path = std::move(shown.over_path),
                .at = options.at,
                .follow = options.follow};
  OutputFiles files(request.common);
  progress.now("following the curve of equilibria");
  options.progress = progress_of(progress, varied);
  options.courses = files.wants_html();  // snaps are shown
  const Path found = path(varied, options);

  const bool any = std::any_of(found.branches.begin(), found.branches.end(),
                               [](const PathBranch& branch) { return !branch.points.empty(); });
  const std::vector<SoughtQuantity> asked = view.measures;
  if (any && view.measures.empty() && !varied.is_driven()) view.measures = {most_changing(varied, found)};
  const Result result = path_result(varied, found, view, request.common.settings);
  const bool proved = found.status == Path::Status::traced && found.unproved() == 0;
  Pictures pictures;
  if (files.wants_svg() && any) {
    progress.now("drawing");
    pictures.svg = path_picture(varied, found, asked, result.verdict.text, proved);
  }
  if (files.wants_html() && any) {
    progress.now("drawing");
    pictures.figures = {path_figure(varied, found, asked)};
  }
  return finish(request.common, result, &files, pictures, proved, progress, palette);
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
      {"--curve", &request->curve, "WHAT",
       "equilibria: as one number changes (the default); fold: the curve of\nfolds, with its cusps, in the plane "
       "of two numbers, --vary twice"});
  command.add(
      {"--from", &request->from, "WHAT",
       "settle: where the mechanism comes to rest when released from its\nstart (the default); equilibrium: the "
       "one nearest to the start"});
  command.add({"--follow", &request->follow, "WHAT",
               "unstable: the curve through its folds (the default); jump: stable\nequilibria only, snapping at folds, "
               "there and back"});
  command.add({"--branches", &request->branches, "", "Follow all curves that cross at branch points too"});
  command.add({"--search", &request->search, "N",
               "Search also for curves that are not connected with the start, by\ndeflation from N starts at each of "
               "five values (0)"});
  command.add({"--at", &request->at, "NUMBERS", "Show the equilibria at these values of the number: 1,2.5,5"});
  add_show_option(command, request->show);
  command.add({"--measure", &request->measures, "NAME", "The same, of one; several times"});
  add_proof_option(command, request->proof_seconds);
  add_output_options(command, request->common,
                     {.svg = "Draw the curve, and the mechanism at its start, end, folds, snaps and\nstops, into FILE",
                      .csv = "Write the curve, one line for each point, to FILE"});
  command.run = [request](const Palette& palette) { return run_path(*request, palette); };
  return command;
}

}  // namespace poise::app
