#include "app/commands/check.hpp"

#include <memory>

#include "app/commands/scene_options.hpp"
#include "app/commands/session.hpp"
#include "app/report/report.hpp"

namespace poise::app {
namespace {

int run_check(const Request& request, const Palette& palette) {
  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(load_scene(request));
  progress.now("looking at its mobility");
  const Mobility mobility = analyse_mobility(model);
  progress.done();
  print(check_report(model, mobility, palette));
  // Where solve would refuse the scene, its sentence ends the check too. A scene without loads is fine to look at.
  if (model.mechanism().coordinates() > 0) assemble(model);
  return solved;
}

}  // namespace

Command check_command() {
  const auto request = std::make_shared<Request>();
  Command command{"check", "Tell what a scene is: bodies, joints, mobility, what the model keeps"};
  add_scene_options(command, *request);
  command.run = [request](const Palette& palette) { return run_check(*request, palette); };
  return command;
}

}  // namespace poise::app
