#include "app/results/statics/sensitivity.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/results/statics/quantities.hpp"

namespace poise::app {
namespace {

struct SensitivityRequest {
  Request common;
  std::vector<std::string> of;
  int top = 12;
};

int run_sensitivity(const SensitivityRequest& request, const Palette& palette) {
  expect_between("--top", request.top, 0, 1'000'000);
  SensitivityOptions options;
  options.others = other_quantity;
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const StaticModel model(load_scene(request.common));
  const std::vector<SoughtQuantity> of = read_of_position("--of", request.of, model.scene());
  OutputFiles files(request.common);
  options.solve.interrupt = &request.common.interrupt();
  progress.now("solving");
  const Sensitivities found = sensitivities(model, of, options);
  const Result result = sensitivity_result(model.scene(), found, request.top, request.common.settings);
  const bool all = found.why.empty() && std::all_of(found.of.begin(), found.of.end(),
                                                    [](const QuantitySensitivity& one) { return one.why.empty(); });
  const bool interrupted = found.equilibrium.status == Status::interrupted;
  return finish(request.common, result, interrupted ? nullptr : &files, {}, all, progress, palette);
}

}  // namespace

Command sensitivity_command() {
  const auto request = std::make_shared<SensitivityRequest>();
  Command command{"sensitivity", "How much each number of a scene moves positions, forces and loads at folds"};
  add_scene_options(command, request->common);
  add_quantities_option(command, request->of);
  command.add({"--top", &request->top, "N", "Show the N numbers that move it most (12); 0 shows all"});
  add_output_options(command, request->common, {.csv = "Write all derivatives, one line each, to FILE"});
  command.run = [request](const Palette& palette) { return run_sensitivity(*request, palette); };
  return command;
}

}  // namespace poise::app
