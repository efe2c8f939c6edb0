#include <optional>
#include <string>

#include "app/commands/design.hpp"
#include "app/commands/session.hpp"
#include "app/results/design/balance.hpp"
#include "design/balance/balance_problem.hpp"
#include "design/balance/near_balance.hpp"
#include "design/balance/shaking_balance.hpp"
#include "design/balance/weight_balance.hpp"
#include "model/rewritten_scene.hpp"
#include "model/text_file.hpp"

namespace poise::app {
namespace {

std::string scene_text_of(const BalanceProblem& problem, const Scene& found) {
  return rewritten_scene(read_text_file(problem.scene.file), problem.scene.file, found);
}

/// What was found, and the scene with it; empty where there is none.
struct BalanceFound {
  Result result;
  std::string scene;
  bool is_solved = false;
};

BalanceFound find_weights(const BalanceProblem& problem, const std::atomic<bool>& interrupt) {
  std::optional<WeightBalance> exact;
  std::optional<NearBalance> nearly;
  if (problem.over.empty() || may_be_exact(problem)) exact = balance_weights(problem);
  if (!problem.over.empty() && (!exact || !exact->balanced)) nearly = balance_nearly(problem, &interrupt);
  BalanceFound out{weight_balance_result(problem, exact, nearly), "", false};
  if (exact && exact->balanced) {
    out.scene = scene_text_of(problem, exact->scene);
  } else if (nearly && nearly->solved) {
    out.scene = scene_text_of(problem, nearly->scene);
  }
  out.is_solved = exact ? exact->balanced : nearly->solved;
  return out;
}

BalanceFound find_counterweights(const BalanceProblem& problem, const std::atomic<bool>& interrupt) {
  const ShakingBalance found = balance_shaking(problem, &interrupt);
  BalanceFound out{shaking_balance_result(problem, found), "", found.balanced};
  if (found.balanced || found.is_least) out.scene = scene_text_of(problem, found.scene);
  return out;
}

}  // namespace

int run_balance(const DesignRequest& request, const Palette& palette) {
  Progress progress(request.common.listener());
  progress.now("reading the design");
  const BalanceProblem problem = read_balance(request.common.scene);
  OutputFiles files(request.common, {problem.scene.file});
  progress.now("balancing");
  const std::atomic<bool>& interrupt = request.common.interrupt();
  const BalanceFound found = problem.of == BalanceProblem::Of::weights ? find_weights(problem, interrupt)
                                                                       : find_counterweights(problem, interrupt);
  return finish(request.common, found.result, &files, {}, found.is_solved, progress, palette, found.scene);
}

}  // namespace poise::app
