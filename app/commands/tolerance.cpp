#include "app/results/statics/tolerance.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "statics/many/simd.hpp"

namespace poise::app {
namespace {

struct ToleranceRequest {
  Request common;
  std::vector<std::string> of;
  std::string tolerances;
  int samples = 100'000, jobs = 0;
  std::uint64_t seed = 1;
};

int run_tolerance(const ToleranceRequest& request, const Palette& palette) {
  expect_between("--samples", request.samples, 0, 10'000'000);
  ToleranceOptions options;
  options.samples = static_cast<std::size_t>(request.samples);
  options.seed = request.seed;
  options.jobs = read_jobs(request.jobs);
  if (!request.common.svg.empty()) expect_plotter();
  simd_to_use();  // refuses what POISE_SIMD may say wrongly, before anything is done
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const StaticModel model(load_scene(request.common));
  const std::vector<SoughtQuantity> of = read_of_position("--of", request.of, model.scene());
  if (request.tolerances.empty() && request.common.with.empty()) {
    throw InputError("--tolerances is required, or --with FIT, or both");
  }
  std::vector<Tolerance> tolerances;
  if (!request.tolerances.empty()) tolerances = read_tolerances(request.tolerances, model.scene());
  const std::optional<FittedNumbers> fit = load_fit(request.common, model.scene());
  options.fitted = fit ? &*fit : nullptr;
  std::vector<std::string> read = {request.common.scene};
  if (!request.tolerances.empty()) read.push_back(request.tolerances);
  OutputFiles files(request.common, read);
  options.solve.interrupt = &request.common.interrupt();
  options.progress = [&](std::size_t done) {
    progress.now_and_then([&] { return fmt::format("{} of {} samples", done, options.samples); });
  };
  progress.now("solving");
  const ToleranceStudy study = tolerance_study(model, tolerances, of, options);
  Result result = tolerance_result(model.scene(), study, request.common.settings);
  if (fit) {
    for (const std::string& note : fit->notes) result.warnings.push_back(doubtful(note));
  }
  Pictures pictures;
  std::vector<Panel> panels;
  if (files.wants_svg() || files.wants_html()) panels = histogram_panels(model.scene(), study);
  if (files.wants_svg() && !panels.empty()) {
    progress.now("drawing");
    pictures.svg = draw_plot(panels);
  }
  if (files.wants_html()) pictures.figures = chart_figures("Samples", panels);
  const bool none_continues = study.samples > 0 && study.continued == 0;
  const bool all = study.why.empty() && !none_continues && !study.interrupted && study.disagreed == 0 &&
                   std::all_of(study.of.begin(), study.of.end(), [](const ToleranceBand& b) { return b.why.empty(); });
  return finish(request.common, result, &files, pictures, all, progress, palette);
}

}  // namespace

Command tolerance_command() {
  const auto request = std::make_shared<ToleranceRequest>();
  Command command{"tolerance", "What tolerances of dimensions, springs and loads do to an equilibrium"};
  add_scene_options(command, request->common);
  command
      .add({"--tolerances", &request->tolerances, "FILE",
            "Half widths of numbers: [tolerances] with lines like \"point.*\" = 0.1"})
      .reads("toml");
  add_with_option(command, request->common);
  add_quantities_option(command, request->of);
  command.add({"--samples", &request->samples, "N", "Draw N samples (100000); 0: first and second order only"});
  command.add({"--seed", &request->seed, "N", "Seed of the samples (1)"});
  add_jobs_option(command, request->jobs, "Threads; 0: all cores (the default). Results do not depend on it");
  add_output_options(
      command, request->common,
      {.svg = "Draw the histograms into FILE", .csv = "Write the histograms, one line for each bin, to FILE"});
  command.run = [request](const Palette& palette) { return run_tolerance(*request, palette); };
  return command;
}

}  // namespace poise::app
