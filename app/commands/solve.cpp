#include "app/commands/solve.hpp"

#include <memory>
#include <string>

#include "app/commands/method_options.hpp"
#include "app/commands/session.hpp"
#include "app/commands/solve_options.hpp"
#include "app/interrupt.hpp"
#include "app/json_report.hpp"
#include "app/report/report.hpp"

namespace poise::app {
namespace {

struct SolveRequest {
  Request common;
  std::string method = "virtual-work", seek = "nearest";
};

int run_solve(const SolveRequest& words, const Palette& palette) {
  const Request& request = words.common;
  SolveOptions options;
  options.method = read_method("--method", words.method);
  options.seek = read_seek(words.seek);

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

}  // namespace

Command solve_command() {
  const auto request = std::make_shared<SolveRequest>();
  Command command{"solve", "Find where it rests, by one method"};
  add_solve_options(command, request->common, request->seek);
  command.add({"--method", &request->method, "METHOD", "One of these, the first by default\n" + method_help()});
  command.run = [request](const Palette& palette) { return run_solve(*request, palette); };
  return command;
}

}  // namespace poise::app
