#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/design.hpp"
#include "app/commands/session.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/results/design/synthesis.hpp"
#include "design/synthesis/four_bar_scene.hpp"
#include "motion/design.hpp"

namespace poise::app {
namespace {

/// The four-bar chosen, driven by the general kinematics.
struct DrivenFourBar {
  Scene scene;
  std::vector<DriveRange> range;
  KinematicsResult swept;
  bool confirmed = false;  ///< it came to the last position, where its point and coupler are as they were computed
};

DrivenFourBar driven(const SynthesisProblem& problem, const ChosenFourBar& chosen) {
  constexpr double near = 1e-7;
  DrivenFourBar out;
  out.scene = four_bar_scene(chosen.linkage, chosen.start, problem.title, problem.units);
  out.scene.source = fmt::format("poise design {}", problem.file);
  out.range = {{"input", chosen.from, chosen.to}};
  try {
    out.swept = sweep(out.scene, out.range);
  } catch (const InputError&) {
    return out;  // it cannot be driven, which the answer says
  }
  if (!out.swept.complete || !out.swept.singular.empty() || out.swept.samples.empty()) return out;
  // The coupler's closure at the end is that of the start, since no dead point was passed.
  const Vec2 diagonal = chosen.linkage.b - chosen.start.input_pin;
  const int closure = cross(diagonal, chosen.start.output_pin - chosen.start.input_pin) < 0.0 ? -1 : 1;
  const auto last = pose_of(chosen.linkage, chosen.to, closure);
  const auto& coupler = out.swept.samples.back().bodies[2].pose;
  const double size = norm(chosen.linkage.b - chosen.linkage.a) + chosen.linkage.coupler;
  out.confirmed = last && norm(coupler.world(chosen.linkage.point) - last->point) < near * size &&
                  std::abs(std::remainder(coupler.angle - last->coupler_angle, 2 * std::numbers::pi)) < near;
  return out;
}

/// Writes and prints what was found; returns the exit code.
int show_synthesis(const DesignRequest& request, OutputFiles& files, const Result& result,
                   const std::optional<DrivenFourBar>& best, std::vector<Panel> panels, Progress& progress,
                   const Palette& palette) {
  Pictures pictures;
  if (files.wants_html()) {
    if (best && !best->swept.samples.empty()) {
      pictures.figures = {kinematics_figure(best->scene, best->swept, best->range, {"coupler.P"}, best->confirmed)};
      pictures.figures.front().title = "The linkage found";
    }
    for (Figure& figure : chart_figures("Charts", std::move(panels))) pictures.figures.push_back(std::move(figure));
  }
  const std::string geometry = best ? geometry_text(best->scene) : "";
  return finish(request.common, result, &files, pictures, best && best->confirmed, progress, palette, geometry);
}

}  // namespace

int run_synthesis(const DesignRequest& request, const Palette& palette) {
  if (synthesis_kind(request.common.scene) == SynthesisKind::path) return run_path_synthesis(request, palette);
  Progress progress(request.common.listener());
  progress.now("reading the design");
  const SynthesisProblem problem = read_synthesis(request.common.scene);
  OutputFiles files(request.common, {problem.file});
  progress.now("searching");
  std::optional<DrivenFourBar> best;
  const auto drive = [&](const std::optional<ChosenFourBar>& chosen) {
    if (chosen) best = driven(problem, *chosen);
    return best && best->confirmed;
  };
  if (const auto* const task = std::get_if<PoseTask>(&problem.task)) {
    const Guidance guidance = guide(*task, &request.common.interrupt());
    const auto chosen = chosen_of(guidance);
    const bool confirmed = drive(chosen);
    return show_synthesis(request, files, guidance_result(problem, *task, guidance, chosen, confirmed), best,
                          guidance_panels(problem, guidance), progress, palette);
  }
  const auto& task = std::get<FunctionSynthesis>(problem.task);
  const FunctionAnswer answer = generate(task);
  const auto chosen = chosen_of(answer);
  const bool confirmed = drive(chosen);
  return show_synthesis(request, files, function_result(problem, task, answer, chosen, confirmed), best,
                        function_panels(answer), progress, palette);
}

}  // namespace poise::app
