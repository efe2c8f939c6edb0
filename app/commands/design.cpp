#include "app/commands/design.hpp"

#include <chrono>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/results/motion/design.hpp"
#include "design/goals/design_kind.hpp"
#include "model/input_error.hpp"

namespace poise::app {

int run_guidance(const DesignRequest& request, const Palette& palette) {
  Progress progress(request.common.listener());
  progress.now("reading the design");
  const DesignProblem problem = read_design(request.common.scene);
  OutputFiles files(request.common, {problem.scene.file});
  DesignOptions options;
  options.seed = request.seed;
  options.starts = request.starts.value_or(300);
  options.interrupt = &request.common.interrupt();
  options.progress = [&](int start, double misfit) {
    progress.now(fmt::format("searching: start {} of {}, best misfit {:.3g}", start, options.starts, misfit));
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

namespace {

const std::vector<std::string> program_methods = {"slsqp", "mma", "auglag"};

solvers::ProgramMethod read_program_method(const std::string& word) {
  using solvers::ProgramMethod;
  constexpr ProgramMethod meanings[] = {ProgramMethod::slsqp, ProgramMethod::mma, ProgramMethod::auglag};
  return meanings[chosen("--method", word, program_methods)];
}

int run_design(const DesignRequest& request, const Palette& palette) {
  if (request.starts) expect_between("--starts", *request.starts, 1, 1'000'000);
  expect_between("--trade-off", request.trade_off, 0, 1000);
  DesignRequest read = request;
  read.method = read_program_method(request.method_word);
  const DesignKind kind = kind_of_design(request.common.scene);
  const auto refuse = [&](const char* option, bool is_given) {
    if (is_given && kind != DesignKind::goals) {
      throw InputError(fmt::format("{}: expected a design with [[goal]], of which alone it is an option", option));
    }
  };
  refuse("--trade-off", request.trade_off > 0);
  refuse("--method", request.method_word != "slsqp");
  refuse("--svg", !request.common.svg.empty());
  switch (kind) {
    case DesignKind::synthesis:
      return run_synthesis(read, palette);
    case DesignKind::balance:
      return run_balance(read, palette);
    case DesignKind::goals:
      return run_goals(read, palette);
    case DesignKind::guidance:
      break;
  }
  return run_guidance(request, palette);
}

}  // namespace

Command design_command() {
  const auto request = std::make_shared<DesignRequest>();
  request->common.kind = "design";
  Command command{"design", "Find numbers that meet the goals of a design file"};
  command.add({"DESIGN", &request->common.scene, "", "Design file (TOML)", Presence::required}).reads("toml");
  command.add({"--seed", &request->seed, "N", "Of the random starts (1)"});
  command.add({"--starts", &request->starts, "N", "Searches before it gives up (300; of [[goal]] 100)"});
  command.add({"--method", &request->method_word, "NAME", "Of aims: slsqp (the default), mma or auglag"}).choices =
      program_methods;
  command.add({"--trade-off", &request->trade_off, "N", "So many points of the trade-off of two aims"});
  command.add({"--scene", &request->common.written_scene, "FILE", "Write what was found to FILE, as a scene"})
      .writes("toml");
  add_jobs_option(command, request->jobs, "Threads of the search; the answer is the same for any number");
  add_output_options(command, request->common,
                     {.svg = "Draw the quantities over their ranges, before and after, into FILE"});
  command.run = [request](const Palette& palette) { return run_design(*request, palette); };
  return command;
}

}  // namespace poise::app
