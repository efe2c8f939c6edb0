#include "app/results/statics/hold.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/hold_pictures.hpp"
#include "app/result/each.hpp"
#include "app/results/parts.hpp"
#include "app/results/predictions.hpp"
#include "model/parameters.hpp"
#include "statics/model/mobility.hpp"
#include "statics/sensitivity/differences.hpp"

namespace poise::app {
namespace {

struct HoldRequest {
  Request common;
  std::string vary;
  bool at_rest = false;
};

/// "load.P" or "load.P=0..5"; SI.
struct VariedNumber {
  std::string name;
  double from = -std::numeric_limits<double>::infinity(), to = std::numeric_limits<double>::infinity();
};

VariedNumber read_vary(const std::string& text, const Scene& scene) {
  if (text.find('=') == std::string::npos) return {text};
  const NamedRange range = read_named_range("--vary", text, "NAME or NAME=FROM..TO, say load.P=0..5");
  const double unit = range.name == "loads" ? 1.0 : value_unit(scene, range.name);
  return {range.name, std::min(range.from, range.to) * unit, std::max(range.from, range.to) * unit};
}

void expect_friction(const Scene& scene) {
  for (const Stop& stop : scene.stops) {
    if (!stop.friction) continue;
    throw InputError(
        fmt::format("{}:{}: {} \"{}\".friction: poise hold does not treat friction across stops; expected "
                    "friction of joints and pulleys, or tables [[friction]]; leave the key out there",
                    scene.file, stop.line, stop.family(), stop.name));
  }
  if (has_friction(scene)) return;
  throw InputError(scene.file +
                   ": expected friction, found none: give a pin friction = { coefficient = 0.1, radius = 5 }, a slide "
                   "friction = { coefficient = 0.1 }, a pulley of a rope friction = 0.1, or add a table [[friction]]");
}

struct PoseToHold {
  std::vector<double> x;
  double radius = 0.0;  ///< distance from the equilibrium that it is at rest in, rad or mechanism sizes
};

/// Nothing where no equilibrium is found.
std::optional<PoseToHold> pose_of(const StaticModel& model, const HoldRequest& request, Progress& progress) {
  // Nothing that loads it can move it: as drawn it is held without friction.
  if (model.mechanism().coordinates() == 0) return PoseToHold{};
  if (!request.at_rest) return PoseToHold{assemble(model)};
  SolveOptions options;
  options.interrupt = &request.common.interrupt();
  const Answer answer = search(model, options, progress);
  if (!answer.equilibrium.found()) return std::nullopt;
  return PoseToHold{answer.equilibrium.x, radius_of(answer.equilibrium)};
}

/// The finite ends of a range at which something slips.
std::vector<ComputedResult> ends_of(const HeldRange& range, const VariedNumber& varied, const Dimension& dimension) {
  std::vector<ComputedResult> out;
  for (const auto& [words, end] : {std::pair("least held", &range.lower), std::pair("greatest held", &range.upper)}) {
    const bool slips = range.any && range.why.empty() && !end->at_limit && std::isfinite(end->value);
    if (slips) out.push_back({fmt::format("{} {}", words, varied.name), dimension, end->value, end->radius});
  }
  return out;
}

/// Adds intervals of the ends of a range. Returns whether all have one.
bool add_held_predictions(Result& result, const FittedNumbers& fit, const HoldRequest& request, const Scene& scene,
                          const VariedNumber& varied, const HeldRange& range, Progress& progress) {
  const Dimension dimension = varied.name == "loads" ? dimension::none : parameter(scene, varied.name).dimension;
  const std::vector<ComputedResult> ends = ends_of(range, varied, dimension);
  const auto at = [&](const Scene& other) -> std::optional<std::vector<double>> {
    try {
      const StaticModel model(other);
      const std::optional<PoseToHold> pose = pose_of(model, request, progress);
      if (!pose) return std::nullopt;
      const HeldRange moved = held_range(model, pose->x, varied.name, varied.from, varied.to);
      const std::vector<ComputedResult> found = ends_of(moved, varied, dimension);
      if (found.size() != ends.size()) return std::nullopt;
      return each(found, [](const ComputedResult& one) { return one.value; });
    } catch (const InputError&) {  // the mechanism cannot be assembled so
      return std::nullopt;
    }
  };
  progress.now("holding with other numbers of the fit");
  return add_predictions(result, fit, predict_by_differences(fit, scene, ends, at), scene.units);
}

int run_hold(const HoldRequest& request, const Palette& palette) {
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const StaticModel model(load_scene(request.common));
  if (!has_friction(model.scene())) expect_movable(model);
  expect_friction(model.scene());
  if (!request.common.with.empty() && request.vary.empty()) {
    throw InputError("--with: of a range that is held the ends get intervals; expected --vary NUMBER too");
  }
  OutputFiles files(request.common);
  HoldView view;
  view.at_rest = request.at_rest;
  const std::optional<PoseToHold> found = pose_of(model, request, progress);
  if (!found) {
    Result none;
    none.title = model.scene().title;
    none.verdict = bad("No equilibrium without friction found, at which friction was to hold.");
    return finish(request.common, none, &files, {}, false, progress, palette);
  }
  const std::vector<double>& x = found->x;
  view.radius = found->radius;
  progress.now("looking for friction that holds");
  HeldPose pose;
  VariedNumber varied;
  if (!request.vary.empty()) {
    varied = read_vary(request.vary, model.scene());
    view.number = varied.name;
    try {
      view.range = held_range(model, x, varied.name, varied.from, varied.to);
    } catch (const InputError& error) {
      throw InputError(std::string("--vary ") + error.what());
    }
    pose = view.range->now;
  } else {
    pose = held_pose(model, x);
  }
  Result result = hold_result(model, x, pose, view, request.common.settings);
  bool all_predicted = true;
  if (const std::optional<FittedNumbers> fit = load_fit(request.common, model.scene(), varied.name)) {
    all_predicted = add_held_predictions(result, *fit, request, model.scene(), varied, *view.range, progress);
  }
  const bool decided = pose.verdict != Holding::not_decided && pose.proved && (!view.range || view.range->why.empty());
  Pictures pictures;
  if (files.wants_svg()) pictures.svg = hold_picture(model, x, pose, result.verdict.text, decided);
  if (files.wants_html()) {
    pictures.figures = {view.range ? hold_figure(model, x, *view.range, view.number, result.verdict.text, decided)
                                   : hold_figure(model, x, pose, result.verdict.text, decided)};
  }
  return finish(request.common, result, &files, pictures, decided && all_predicted, progress, palette);
}

}  // namespace

Command hold_command() {
  const auto request = std::make_shared<HoldRequest>();
  Command command{"hold", "Whether friction holds a position, by what margin, and for which loads"};
  add_scene_options(command, request->common);
  command.add({"--vary", &request->vary, "NAME[=FROM..TO]",
               "The values of a number for which friction holds the position: load.P,\nbody.B.mass, "
               "slide.S.friction.coefficient; loads: a factor of all loads"});
  command.add(
      {"--at-rest", &request->at_rest, "", "In the equilibrium without friction, not in the position as drawn"});
  add_with_option(command, request->common);
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism in that position, with a mark where it slips\nfirst, into FILE"});
  command.run = [request](const Palette& palette) { return run_hold(*request, palette); };
  return command;
}

}  // namespace poise::app
