#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/commands/design.hpp"
#include "app/commands/session.hpp"
#include "app/draw/chart/goals_chart.hpp"
#include "app/draw/goals_figures.hpp"
#include "app/results/design/goals.hpp"
#include "design/goals/design_search.hpp"
#include "model/input_error.hpp"
#include "model/named_files.hpp"

namespace poise::app {

int run_goals(const DesignRequest& request, const Palette& palette) {
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the design");
  const GoalProblem problem = read_goals(request.common.scene);
  std::vector<std::string> read{problem.scene_file.string()};
  read.insert(read.end(), problem.files.begin(), problem.files.end());
  expect_beside_files(problem.scene_text, problem.scene_file.string(), request.common.written_scene);
  const auto aims = std::count_if(problem.goals.begin(), problem.goals.end(),
                                  [](const DesignGoal& goal) { return !goal.is_limit(); });
  if (request.trade_off == 1) throw InputError("--trade-off 1: expected two points at least");
  if (request.trade_off > 0 && aims != 2) {
    throw InputError(fmt::format("--trade-off: expected a design with two aims, found {}", aims));
  }
  const bool has_range = std::any_of(problem.goals.begin(), problem.goals.end(), [&](const DesignGoal& goal) {
    const Sweep& sweep = problem.sweeps[static_cast<std::size_t>(goal.sweep)];
    return sweep.first != sweep.last && goal.kind != DesignGoal::Kind::passes && !goal.of.is_over_path();
  });
  if (!request.common.svg.empty() && !has_range && request.trade_off == 0) {
    throw InputError("--svg: there is nothing to draw; expected a goal over a range");
  }
  OutputFiles files(request.common, read);
  GoalSearchOptions options;
  options.seed = request.seed;
  options.starts = request.starts.value_or(100);
  options.jobs = read_jobs(request.jobs);
  options.method = request.method;
  options.trade_off = request.trade_off;
  options.interrupt = &request.common.interrupt();
  options.progress = [&](const std::string& what) { progress.now(what); };
  const auto begin = std::chrono::steady_clock::now();
  const GoalDesign found = design_for_goals(problem, options);
  const double microseconds =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  progress.now("writing the result");
  const Result result = goals_result(problem, found, request.seed, microseconds);
  Pictures pictures;
  if (files.wants_html()) pictures.figures = goals_figures(problem, found);
  if (files.wants_svg()) {
    std::vector<Panel> panels;
    for (GoalPanel& one : goals_panels(problem, found)) panels.push_back(std::move(one.panel));
    if (!panels.empty()) pictures.svg = draw_plot(panels);
  }
  return finish(request.common, result, &files, pictures, found.status == GoalDesign::Status::met, progress, palette,
                scene_text_of(problem, found));
}

}  // namespace poise::app
