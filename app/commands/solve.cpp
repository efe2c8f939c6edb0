#include "app/commands/session.hpp"
#include "app/interrupt.hpp"
#include "app/json_report.hpp"
#include "app/report/report.hpp"

namespace poise::app {

int run_solve(const Request& request, const Palette& palette) {
  SolveOptions options;
  options.method = request.method;
  options.seek = request.seek;

  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(load_scene(request));
  OutputFiles files(request);
  options.interrupt = &watch_for_interrupt();
  const Answer answer = search(model, options, progress);

  std::string written;
  if (answer.rest.status != Status::interrupted) {
    progress.now("writing the result");
    const bool drawn = files.wants_svg() && answer.readings;
    written = files.write(files.wants_json() ? solve_json(model, answer, request.settings) : "",
                          drawn ? picture(model, answer) : "");
  }
  progress.done();
  print(solve_report(model, answer, palette) + (written.empty() ? "" : "\n" + written));
  return answer.rest.found() ? solved : not_solved;
}

}  // namespace poise::app
