#include "app/results/motion/design.hpp"

#include <chrono>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/terminal/interrupt.hpp"

namespace poise::app {
namespace {

struct DesignRequest {
  Request common;  // `scene` is the design file
  std::uint64_t seed = 1;
  int starts = 300;
};

int run_design(const DesignRequest& request, const Palette& palette) {
  expect_between("--starts", request.starts, 1, 1'000'000);
  Progress progress;
  progress.now("reading the design");
  const DesignProblem problem = read_design(request.common.scene);
  OutputFiles files(request.common, {problem.scene.file});
  DesignOptions options;
  options.seed = request.seed;
  options.starts = request.starts;
  options.interrupt = &watch_for_interrupt();
  options.progress = [&](int start, double misfit) {
    progress.now(fmt::format("searching: start {} of {}, best misfit {:.3g}", start, request.starts, misfit));
  };
  progress.now("searching");
  const auto begin = std::chrono::steady_clock::now();
  DesignResult best = design(problem, options);
  const double microseconds =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
  const DesignCheck check = best.values.empty() ? DesignCheck{} : check_design(problem, best);

  progress.now("writing the result");
  const Result result = design_result(problem, best, check, request.seed, microseconds);
  std::string geometry;
  if (!best.values.empty()) {
    best.scene.title = problem.title;
    best.scene.source = fmt::format("poise design {} --seed {}", problem.file, request.seed);
    geometry = geometry_text(best.scene);
  }
  Pictures pictures;
  if (files.wants_html() && !best.values.empty()) {
    pictures.figures = {design_figure(problem, best, best.met && check.met)};
  }
  const std::string written = files.write(result, pictures, geometry);
  progress.done();
  print(request.common, result, written, palette);
  return best.met && check.met ? solved : not_solved;
}

}  // namespace

Command design_command() {
  const auto request = std::make_shared<DesignRequest>();
  request->common.kind = "design";
  Command command{"design", "Find dimensions that meet the goals of a design file"};
  command.add({"DESIGN", &request->common.scene, "", "Design file (TOML)", Presence::required});
  command.add({"--seed", &request->seed, "N", "Of the random starts (1)"});
  command.add({"--starts", &request->starts, "N", "Searches before it gives up (300)"});
  command.add({"--scene", &request->common.written_scene, "FILE", "Write the geometry found to FILE, as a scene"});
  add_output_options(command, request->common, {});
  command.run = [request](const Palette& palette) { return run_design(*request, palette); };
  return command;
}

}  // namespace poise::app
