#include <chrono>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/design.hpp"
#include "app/commands/session.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/results/design/path_synthesis.hpp"
#include "design/synthesis/path_scene.hpp"
#include "design/synthesis/path_search.hpp"
#include "motion/design.hpp"
#include "motion/kinematics.hpp"

namespace poise::app {
namespace {

/// The linkage driven by the general kinematics, once round where its crank turns fully, else from the first of its
/// points to the last.
Figure figure_of_path(const Scene& scene, const PathSolution& solution) {
  const double from = solution.visits.front().angle;
  double to = from + 2 * std::numbers::pi;
  if (!solution.range.full()) {
    to = from;
    for (std::size_t i = 1; i < solution.visits.size(); ++i) {
      to += std::remainder(solution.visits[i].angle - solution.visits[i - 1].angle, 2 * std::numbers::pi);
    }
  }
  const std::vector<DriveRange> range{{"input", from, to}};
  const KinematicsResult swept = sweep(scene, range);
  Figure out = kinematics_figure(scene, swept, range, {"coupler.P"}, swept.complete && swept.singular.empty());
  out.title = "The linkage found";
  return out;
}

}  // namespace

int run_path_synthesis(const DesignRequest& request, const Palette& palette) {
  Progress progress(request.common.listener());
  progress.now("reading the design");
  const PathProblem problem = read_path_problem(request.common.scene);
  OutputFiles files(request.common, {problem.file});
  PathSearchOptions options;
  options.seed = request.seed;
  options.starts = request.starts.value_or(300);
  options.jobs = read_jobs(request.jobs);
  options.interrupt = &request.common.interrupt();
  options.progress = [&](std::size_t done) {
    progress.now_and_then([&] { return fmt::format("searching: {} of {} starts", done, options.starts); });
  };
  progress.now("searching");
  const auto begin = std::chrono::steady_clock::now();
  const PathAnswer answer = search_paths(problem, options);
  const double microseconds =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();

  progress.now("writing the result");
  const Result result = path_synthesis_result(problem, answer, options, microseconds);
  std::string geometry;
  Pictures pictures;
  if (const PathSolution* const best = path_to_build(answer)) {
    Scene scene = path_scene(problem, *best);
    scene.source = fmt::format("poise design {} --seed {}", problem.file, request.seed);
    geometry = geometry_text(scene);
    if (files.wants_html()) pictures.figures = {figure_of_path(scene, *best)};
  }
  const std::string written = files.write(result, pictures, geometry);
  progress.done();
  print(request.common, result, written, palette);
  return path_is_met(problem, answer) ? solved : not_solved;
}

}  // namespace poise::app
