#include "app/commands/session.hpp"
#include "app/report/report.hpp"

namespace poise::app {

int run_check(const Request& request, const Palette& palette) {
  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(load_scene(request));
  progress.now("looking at its mobility");
  const Mobility mobility = analyse_mobility(model);
  progress.done();
  print(check_report(model, mobility, palette));
  if (mobility.assembled) return solved;
  assemble(model);  // throws the sentence that solve would end with
  return bad_input;
}

}  // namespace poise::app
