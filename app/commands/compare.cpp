#include "app/commands/compare.hpp"

#include <algorithm>
#include <memory>
#include <string>

#include "app/commands/session.hpp"
#include "app/commands/solve_options.hpp"
#include "app/interrupt.hpp"
#include "app/json_report.hpp"
#include "app/report/report.hpp"

namespace poise::app {
namespace {

/// The answer worth a picture: the first confirmed one, or else the first that reached any pose.
const Answer* best_of(const std::vector<Answer>& answers) {
  const Answer* best = nullptr;
  for (const Answer& answer : answers) {
    if (!answer.readings) continue;
    if (answer.rest.found()) return &answer;
    if (best == nullptr) best = &answer;
  }
  return best;
}

struct CompareRequest {
  Request common;
  std::string seek = "nearest";
};

int run_compare(const CompareRequest& words, const Palette& palette) {
  const Request& request = words.common;
  SolveOptions options;
  options.seek = read_seek(words.seek);

  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(load_scene(request));
  OutputFiles files(request);
  options.interrupt = &watch_for_interrupt();
  std::vector<Answer> answers;
  for (const Method method : {Method::virtual_work, Method::energy}) {
    options.method = method;
    answers.push_back(search(model, options, progress));
  }

  const auto status_is = [](Status status) { return [status](const Answer& a) { return a.rest.status == status; }; };
  std::string written;
  if (std::none_of(answers.begin(), answers.end(), status_is(Status::interrupted))) {
    progress.now("writing the result");
    const Answer* drawn = files.wants_svg() ? best_of(answers) : nullptr;
    written = files.write(files.wants_json() ? compare_json(model, answers, request.settings) : "",
                          drawn != nullptr ? picture(model, *drawn) : "");
  }
  progress.done();
  print(compare_report(model, answers, palette) + (written.empty() ? "" : "\n" + written));
  const bool all = std::all_of(answers.begin(), answers.end(), [](const Answer& answer) {
    return answer.rest.found() || answer.rest.status == Status::refused;
  });
  return all ? solved : not_solved;
}

}  // namespace

Command add_compare(CLI::App& app) {
  const auto request = std::make_shared<CompareRequest>();
  CLI::App& command = *app.add_subcommand("compare", "Find where it rests, by all methods side by side");
  add_solve_options(command, request->common, request->seek);
  return {&command, [request](const Palette& palette) { return run_compare(*request, palette); }};
}

}  // namespace poise::app
