#include "statics/paths/path.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/commands/vary.hpp"
#include "app/draw/chart/beside_chart.hpp"
#include "app/draw/chart/path_chart.hpp"
#include "app/draw/chart/plot.hpp"
#include "app/draw/path_picture.hpp"
#include "app/result/numbers.hpp"
#include "app/results/predictions.hpp"
#include "app/results/statics/beside.hpp"
#include "app/results/statics/fold_curve.hpp"
#include "app/results/statics/path.hpp"
#include "motion/dynamic_stability.hpp"
#include "motion/snap_motion.hpp"
#include "statics/model/mobility.hpp"
#include "statics/paths/path_measures.hpp"

namespace poise::app {
namespace {

const std::vector<std::string> path_curves = {"equilibria", "fold"};
const std::vector<std::string> ways_to_follow = {"unstable", "jump"};
const std::vector<std::string> ways_to_snap = {"settle", "dynamic"};

struct PathRequest {
  Request common;
  std::string curve = "equilibria", from = "settle", follow = "unstable", snap = "settle", at;
  std::vector<std::string> vary, measures, show, beside, variants;
  bool branches = false;
  int search = 0;
  std::optional<double> proof_seconds;
};

VariedScene read_scene_of(const PathRequest& request) {
  if (request.vary.size() != 1) {
    throw InputError(fmt::format("--vary: expected one number, found {}; two with --curve fold", request.vary.size()));
  }
  return load_varied_scene(request.common, read_vary_range(request.vary[0]));
}

VariedPair read_pair(const PathRequest& request) {
  if (request.vary.size() != 2) {
    throw InputError(fmt::format("--curve fold: expected --vary twice, found {} of it", request.vary.size()));
  }
  for (const auto& [option, given] :
       {std::pair("--at", !request.at.empty()), std::pair("--show", !request.measures.empty() || !request.show.empty()),
        std::pair("--branches", request.branches), std::pair("--search", request.search != 0),
        std::pair("--beside", !request.beside.empty()), std::pair("--variant", !request.variants.empty()),
        std::pair("--proof-seconds", request.proof_seconds.has_value()),
        std::pair("--follow", request.follow != "unstable"), std::pair("--snap", request.snap != "settle")}) {
    if (given) throw InputError(fmt::format("{}: not with --curve fold, where it has no meaning", option));
  }
  const NamedRange first = read_vary_range(request.vary[0]), second = read_vary_range(request.vary[1]);
  const Scene scene = load_scene(request.common);
  return naming_vary([&] {
    return VariedPair(scene, {first.name, first.from, first.to}, {second.name, second.from, second.to});
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

PathOptions read_options(const PathRequest& request) {
  PathOptions options;
  options.from = read_from(request.from);
  options.follow = chosen("--follow", request.follow, ways_to_follow) == 0 ? PathOptions::Follow::unstable
                                                                           : PathOptions::Follow::jump;
  options.branches = request.branches;
  expect_between("--search", request.search, 0, 1'000'000);
  options.search = request.search;
  options.certificate = read_proof(request.proof_seconds);
  options.dynamic_stability = dynamic_stability;
  options.interrupt = &request.common.interrupt();
  return options;
}

/// Where intervals are not found, the estimates would be taken without a word on their errors.
void refuse_with(const PathRequest& request, const std::string& option) {
  if (request.common.with.empty()) return;
  throw InputError("--with: not with " + option + ", whose results get no intervals; leave it out");
}

int run_fold_curve(const PathRequest& request, const Palette& palette) {
  refuse_with(request, "--curve fold");
  FoldCurveOptions options;
  options.from = read_from(request.from);
  options.interrupt = &request.common.interrupt();
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
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

/// The label and the settings of "A: load.P=3, spring.k.stiffness=2".
std::pair<std::string, std::vector<std::string>> read_variant(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto trimmed = [](std::string word) {
    word.erase(0, std::min(word.find_first_not_of(' '), word.size()));
    word.erase(word.find_last_not_of(' ') + 1);
    return word;
  };
  std::pair<std::string, std::vector<std::string>> out;
  if (colon != std::string::npos) {
    out.first = trimmed(text.substr(0, colon));
    for (std::size_t at = colon; at < text.size();) {
      const std::size_t end = std::min(text.find(',', at + 1), text.size());
      out.second.push_back(trimmed(text.substr(at + 1, end - at - 1)));
      at = end;
    }
  }
  const bool has_gap = std::any_of(out.second.begin(), out.second.end(), [](const auto& word) { return word.empty(); });
  if (out.first.empty() || out.second.empty() || has_gap) {
    throw InputError(
        fmt::format("--variant {}: expected a label and settings, say \"A: load.P=3, spring.S.stiffness=2\"", text));
  }
  return out;
}

/// The requests of all scenes that are followed side by side, with their labels: the scene, its variants, the others.
std::vector<std::pair<std::string, Request>> requests_beside(const PathRequest& request) {
  std::vector<std::pair<std::string, Request>> out;
  const auto add = [&](const std::string& option, const std::string& label, const Request& one) {
    for (const auto& [other, made] : out) {
      if (other != label) continue;
      throw InputError(fmt::format("{}: expected labels that differ, found \"{}\" twice; give another", option, label));
    }
    out.emplace_back(label, one);
  };
  const auto label_of = [](const std::string& file) { return std::filesystem::path(file).stem().string(); };
  add("SCENE", label_of(request.common.scene), request.common);
  for (const std::string& text : request.variants) {
    const auto [label, settings] = read_variant(text);
    Request variant = request.common;
    variant.settings.insert(variant.settings.end(), settings.begin(), settings.end());
    add("--variant " + text, label, variant);
    const std::string varied = request.vary.empty() ? "" : request.vary[0].substr(0, request.vary[0].find('='));
    for (const std::string& setting : settings) {
      if (!setting.starts_with(varied + "=")) continue;
      throw InputError(fmt::format("--variant {}: {} is what --vary varies; expected other numbers", text, varied));
    }
  }
  for (const std::string& file : request.beside) {
    Request other = request.common;
    other.scene = file;
    // Files of one name are told apart by their folders.
    const auto is_taken = [&](const auto& made) { return made.first == label_of(file); };
    add("--beside " + file, std::any_of(out.begin(), out.end(), is_taken) ? file : label_of(file), other);
  }
  return out;
}

bool same_units(const Units& a, const Units& b) {
  return a.length == b.length && a.angle == b.angle && a.force == b.force && a.mass == b.mass;
}

/// The scenes with the quantities that are shown of each.
std::vector<SceneBeside> read_scenes(const PathRequest& request) {
  if (request.vary.size() != 1) {
    throw InputError(fmt::format("--vary: expected one number, found {}", request.vary.size()));
  }
  const NamedRange given = read_vary_range(request.vary[0]);
  std::vector<SceneBeside> out;
  for (auto& [label, one] : requests_beside(request)) {
    try {
      SceneBeside scene{.label = label, .settings = one.settings, .varied = load_varied_scene(one, given)};
      std::vector<std::string> names = request.measures;
      names.insert(names.end(), request.show.begin(), request.show.end());
      scene.measures = read_shown_in_position(names, named_scene(scene.varied));
      out.push_back(std::move(scene));
    } catch (const AssemblyError&) {
      throw;
    } catch (const InputError& error) {
      if (out.empty()) throw;
      throw InputError(fmt::format("{}: {}", label, error.what()));
    }
    if (!same_units(out.back().varied.scene().units, out.front().varied.scene().units)) {
      throw InputError(
          fmt::format("--beside {}: expected a scene in the units of {}, so that values can be compared; "
                      "write its numbers in these",
                      one.scene, request.common.scene));
    }
  }
  return out;
}

int run_beside(const PathRequest& request, const Palette& palette) {
  refuse_with(request, "--beside and --variant");
  PathOptions options = read_options(request);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scenes");
  std::vector<SceneBeside> scenes = read_scenes(request);
  options.at = read_at(request.at, scenes.front().varied);
  OutputFiles files(request.common, request.beside);
  for (SceneBeside& scene : scenes) {
    progress.now("following the curve of " + scene.label);
    options.progress = progress_of(progress, scene.varied);
    scene.found = path(scene.varied, options);
    if (scene.found.status == Path::Status::interrupted) break;
  }
  const auto has_points = [](const SceneBeside& scene) {
    return std::any_of(scene.found.branches.begin(), scene.found.branches.end(),
                       [](const PathBranch& branch) { return !branch.points.empty(); });
  };
  const bool any = std::any_of(scenes.begin(), scenes.end(), has_points);
  if (has_points(scenes.front()) && scenes.front().measures.empty() && !scenes.front().varied.is_driven()) {
    const std::string name = most_changing(scenes.front().varied, scenes.front().found).name;
    for (SceneBeside& scene : scenes) scene.measures = read_of_position("--show", {name}, scene.varied.scene());
  }
  const Result result = beside_result(scenes, options.at);
  const bool proved = std::all_of(scenes.begin(), scenes.end(), [](const SceneBeside& one) { return one.is_proved(); });
  Pictures pictures;
  if (any && (files.wants_svg() || files.wants_html())) {
    progress.now("drawing");
    std::vector<LabelledPanels> panels;
    for (const SceneBeside& scene : scenes) {
      panels.push_back({scene.label, path_panels(scene.varied, scene.found, scene.measures, {}, "")});
    }
    const std::vector<Panel> together = panels_beside(panels);
    if (files.wants_svg()) pictures.svg = draw_plot(together);
    if (files.wants_html()) pictures.figures = chart_figures("Curves of equilibria", together);
  }
  return finish(request.common, result, &files, pictures, proved, progress, palette);
}

/// The motions of all snaps, from the first pose of their courses that is off the fold.
std::map<std::size_t, SnapMotion> motions_of_snaps(const PathRequest& request, const VariedScene& varied,
                                                   const Path& found, Progress& progress) {
  constexpr double off = 1e-3;  // rad, mechanism sizes
  std::map<std::size_t, SnapMotion> out;
  for (std::size_t e = 0; e < found.events.size(); ++e) {
    const PathEvent& event = found.events[e];
    if (event.kind != PathEvent::Kind::snap) continue;
    progress.now("moving where it snaps");
    const auto is_off = [&](const std::vector<double>& x) {
      double most = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, std::abs(x[i] - event.at.x[i]));
      return most > off;
    };
    const auto start = std::find_if(event.course.begin(), event.course.end(), is_off);
    if (start == event.course.end()) {
      out[e].why = "no pose off the fold is known";
      continue;
    }
    out[e] = snap_motion(*varied.model_at(event.at.parameter), *start, {.interrupt = &request.common.interrupt()});
  }
  return out;
}

/// Intervals of the values at which the curve folds, and of what is shown at the values asked for. Returns whether all
/// have one.
bool add_path_predictions(Result& result, const FittedNumbers& fit, const VariedScene& varied, const Path& found,
                          const PathOptions& options, const std::vector<SoughtQuantity>& show) {
  const Units& units = varied.scene().units;
  std::vector<PredictedResult> predictions = predict_folds(fit, varied, found, options);
  for (std::size_t k = 0; k < predictions.size(); ++k) {
    PredictedResult& one = predictions[k];
    if (one.is_known())
      result.content.fact(k == 0 ? "snaps" : "", "at " + varied.name() + " = " + prediction_in_words(fit, one, units));
    one.name = fmt::format("{} at fold {}", one.name, k + 1);
  }
  for (const std::vector<PathPoint>& at : found.wanted) {
    for (std::size_t k = 0; k < at.size() && !show.empty(); ++k) {
      const std::unique_ptr<StaticModel> model = varied.model_at(at[k].parameter);
      std::vector<int> active = at[k].active_stops;
      if (varied.is_driven()) active.push_back(static_cast<int>(model->scene().stops.size()) - 1);
      for (PredictedResult& one : predict_near(fit, *model, at[k].x, active, show)) {
        one.name = fmt::format("{} at {} = {:.6g}{}", one.name, varied.name(), at[k].parameter / varied.unit(),
                               at.size() > 1 ? fmt::format(", {}", k + 1) : "");
        predictions.push_back(std::move(one));
      }
    }
  }
  return add_predictions(result, fit, predictions, units);
}

int run_path(const PathRequest& request, const Palette& palette) {
  if (chosen("--curve", request.curve, path_curves) == 1) return run_fold_curve(request, palette);
  if (!request.beside.empty() || !request.variants.empty()) return run_beside(request, palette);
  PathOptions options = read_options(request);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const VariedScene varied = read_scene_of(request);
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
  const bool moves = chosen("--snap", request.snap, ways_to_snap) == 1;
  options.courses = files.wants_html() || moves;  // snaps are shown
  const Path found = path(varied, options);
  if (moves) view.motions = motions_of_snaps(request, varied, found, progress);

  const bool any = std::any_of(found.branches.begin(), found.branches.end(),
                               [](const PathBranch& branch) { return !branch.points.empty(); });
  const std::vector<SoughtQuantity> asked = view.measures;
  if (any && view.measures.empty() && !varied.is_driven()) view.measures = {most_changing(varied, found)};
  Result result = path_result(varied, found, view, request.common.settings);
  bool all_predicted = true;
  if (const std::optional<FittedNumbers> fit = load_fit(request.common, varied.scene(), varied.name())) {
    progress.now("carrying the errors of the fit into the path");
    all_predicted = add_path_predictions(result, *fit, varied, found, options, asked);
  }
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
  return finish(request.common, result, &files, pictures, proved && all_predicted, progress, palette);
}

}  // namespace

Command path_command() {
  const auto request = std::make_shared<PathRequest>();
  Command command{"path", "Follow the equilibria as a load, a dimension or a driven measure changes"};
  add_scene_options(command, request->common);
  add_with_option(command, request->common);
  command.add(
      {"--vary", &request->vary, "NAME=FROM..TO",
       "Vary a number of the scene, in its own units: load.P=0..5,\nspring.S.stiffness=1..3; loads=0..1 (a factor "
       "of all loads);\nangle.BODY, length.SPRING, x.BODY.POINT, ...: what is driven, with the\neffort needed",
       Presence::required});
  command
      .add({"--curve", &request->curve, "WHAT",
            "equilibria: as one number changes (the default); fold: the curve of\nfolds, with its cusps, in the plane "
            "of two numbers, --vary twice"})
      .choices = path_curves;
  command
      .add({"--from", &request->from, "WHAT",
            "settle: where the mechanism comes to rest when released from its\nstart (the default); equilibrium: the "
            "one nearest to the start"})
      .choices = from_words();
  command
      .add({"--follow", &request->follow, "WHAT",
            "unstable: the curve through its folds (the default); jump: stable\nequilibria only, snapping at folds, "
            "there and back"})
      .choices = ways_to_follow;
  command
      .add(
          {"--snap", &request->snap, "WHAT",
           "settle: snaps land where the mechanism settles with heavy damping (the\ndefault); dynamic: show also their "
           "motion with its inertia and dampers,\nwhat it hits, how fast, and where it comes to rest"})
      .choices = ways_to_snap;
  command.add({"--branches", &request->branches, "", "Follow all curves that cross at branch points too"});
  command.add({"--search", &request->search, "N",
               "Search also for curves that are not connected with the start, by\ndeflation from N starts at each of "
               "five values (0)"});
  command.add({"--at", &request->at, "NUMBERS", "Show the equilibria at these values of the number: 1,2.5,5"});
  add_show_option(command, request->show);
  command.add({"--measure", &request->measures, "NAME", "The same, of one; several times"});
  command
      .add({"--beside", &request->beside, "OTHER",
            "Follow the same number in this scene file too: one chart, and the\ndifferences at the values of --at; "
            "several times"})
      .reads("toml");
  command.add({"--variant", &request->variants, "LABEL: SETTINGS",
               "The same with the scene changed: \"A: load.P=3, spring.S.stiffness=2\";\nseveral times"});
  add_proof_option(command, request->proof_seconds);
  add_output_options(command, request->common,
                     {.svg = "Draw the curve, and the mechanism at its start, end, folds, snaps and\nstops, into FILE",
                      .csv = "Write the curve, one line for each point, to FILE"});
  command.run = [request](const Palette& palette) { return run_path(*request, palette); };
  return command;
}

}  // namespace poise::app
