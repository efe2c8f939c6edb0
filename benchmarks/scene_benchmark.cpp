#include "benchmarks/scene_benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "benchmarks/baseline_scenes.hpp"
#include "benchmarks/known_answers.hpp"
#include "benchmarks/race.hpp"
#include "benchmarks/timing.hpp"
#include "solvers/ipopt.hpp"
#include "solvers/newton.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/reference.hpp"

namespace poise::benchmarks {
namespace {

// The first equilibrium of datasets/answers.json in scaled coordinates; what it does not name is not kept either.
std::vector<double> listed(const StaticModel& model, const nlohmann::json& equilibrium) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  std::vector<double> q = model.to_si(model.start());
  for (const Link& link : layout.links) {
    if (link.body <= 0 || link.frame < 0 || link.frame >= layout.kept) continue;
    q[link.frame] = equilibrium.at("angles").at(scene.bodies[link.body].name).get<double>() - link.turn;
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (layout.travel[j] < 0 || layout.travel[j] >= layout.kept) continue;
    q[layout.travel[j]] = equilibrium.at("travels").at(scene.joints[j].name).get<double>();
  }
  return model.from_si(q);
}

std::vector<double> refined(const StaticModel& model, const std::vector<double>& x, double off_at_most) {
  const Reference reference = refine(model, x);
  if (!reference.refined || !(reference.error <= off_at_most)) {
    throw std::runtime_error(model.scene().file + ": the known answer is none in 50 digits: " + reference.why);
  }
  return reference.x;
}

// Closed loops, or, where stops would then leave nothing to be solved, the start of the scene's file.
std::vector<double> origin(const StaticModel& model) {
  return model.problem().inequalities() == 0 ? assemble(model) : model.start();
}

constexpr int loosest = -4, tightest = -14;  // accuracies, powers of ten
constexpr double slow = 0.2;                 // seconds; what takes longer is tried less:
constexpr int patience = 3;                  // accuracies in a row that bring nothing, and not from nearby starts
constexpr RaceLength race_length{.seconds = 2.5, .fewest_turns = 3};
constexpr double confirmed = 1e-6;  // bounds of the check for answers from nearby starts

}  // namespace

std::vector<double> known_equilibrium(const StaticModel& model, const std::string& name) {
  std::ifstream file(POISE_SOURCE_DIR "/datasets/answers.json");
  const nlohmann::json answers = nlohmann::json::parse(file);
  if (answers.contains(name)) return refined(model, listed(model, answers.at(name).at("equilibria").front()), 1e-10);
  std::vector<double> x = refined(model, solve(model, {.seek = Seek::any}).x, 1e-10);
  if (!(chain_error(x) <= virtual_work_error)) throw std::runtime_error(name + ": not the chain of the references");
  return x;
}

double difference(const Layout& layout, const std::vector<double>& x, const std::vector<double>& truth) {
  double worst = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double by = x[k] - truth[k];
    const double off = std::abs(static_cast<int>(k) < layout.angles ? std::remainder(by, 2.0 * M_PI) : by);
    if (!(off <= worst)) worst = off;  // a NaN is kept
  }
  return worst;
}

SceneBenchmark::SceneBenchmark(const std::string& name, const std::vector<ExternalSolver*>& external_solvers)
    : model_(baseline_scene(name)), truth_(known_equilibrium(model_, name)), origin_(origin(model_)) {
  add_our_own();
  for (ExternalSolver* external : external_solvers) {
    if (external->take(name))
      add(*external);
    else
      left_out_.push_back(external->name() + ": " + external->why_not());
  }
}

void SceneBenchmark::add_our_own() {
  const auto newton = std::make_shared<solvers::Newton>(model_.problem());
  const auto by_newton = [this, newton](double, int times) -> std::optional<SolverAnswer> {
    const solvers::NewtonResult* found = nullptr;
    const double seconds = seconds_of([&] { found = &newton->solve(start_); }, times);
    return SolverAnswer{seconds, found->evaluations, found->end == solvers::NewtonEnd::converged, found->x};
  };
  const auto by_ipopt = [this](double accuracy, int times) -> std::optional<SolverAnswer> {
    solvers::SearchResult found;
    const auto once = [&] { found = solvers::solve_with_ipopt(model_.problem(), start_, {.tolerance = accuracy}); };
    const double seconds = seconds_of(once, times);
    return SolverAnswer{seconds, found.evaluations, found.claims_success, found.x};
  };
  solvers_.push_back({"Poise", "virtual work", false, by_newton});
  solvers_.push_back({"Ipopt", "", true, by_ipopt});
}

void SceneBenchmark::add(ExternalSolver& external) {
  external_.push_back(&external);
  for (std::size_t method = 0; method < external.methods().size(); ++method) {
    const auto solve_it = [&external, method](double accuracy, int times) {
      return external.solve(static_cast<int>(method), accuracy, times);
    };
    solvers_.push_back({external.name(), external.methods()[method], true, solve_it});
  }
}

void SceneBenchmark::start_from(const std::vector<double>& x) {
  start_ = x;
  for (ExternalSolver* external : external_) external->start_from(x);
}

std::vector<SolverResult> SceneBenchmark::run() {
  start_from(origin_);
  std::vector<SolverResult> results;
  for (const Solver& solver : solvers_) results.push_back(solve_from_start(solver));
  solve_nearby(results);
  start_from(origin_);
  time(results);
  return results;
}

SolverResult SceneBenchmark::solve_from_start(const Solver& solver) const {
  SolverResult best;
  best.solver = &solver;
  best.error = std::numeric_limits<double>::infinity();
  int in_vain = 0;
  for (int power = loosest; power >= tightest; --power) {
    const double accuracy = std::pow(10.0, power);
    const std::optional<SolverAnswer> answer = solver.solve(accuracy, 1);
    const double error = answer ? difference(model_.layout(), answer->x, truth_) : best.error;
    ++in_vain;
    if (error < best.error) {
      in_vain = 0;
      best.error = error;
      best.accuracy = accuracy;
      best.evaluations = answer->evaluations;
      best.seconds = answer->seconds;
    }
    best.arrives = best.error <= right_answer;
    if (best.error <= wanted_error || !solver.has_accuracy || (best.seconds > slow && in_vain == patience)) break;
  }
  return best;
}

void SceneBenchmark::solve_nearby(std::vector<SolverResult>& results) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> by(-nearby_reach, nearby_reach);
  for (SolverResult& result : results) {
    if (result.seconds > slow) result.nearby = -1;
  }
  for (int k = 0; k < nearby_starts; ++k) {
    std::vector<double> x = origin_;
    for (double& value : x) value += by(random);
    start_from(x);
    for (SolverResult& result : results) {
      if (!result.arrives || result.nearby < 0) continue;
      const std::optional<SolverAnswer> answer = result.solver->solve(result.accuracy, 1);
      if (!answer) continue;
      const bool right = check(model_, answer->x, {.closure = confirmed, .imbalance = confirmed}).is_equilibrium();
      if (right) ++result.nearby;
      if (answer->claimed && !right) result.false_claim = true;
    }
  }
}

void SceneBenchmark::time(std::vector<SolverResult>& results) const {
  std::vector<Turn> turns;
  std::vector<SolverResult*> racing;
  for (SolverResult& result : results) {
    if (!result.arrives) continue;
    racing.push_back(&result);
    turns.emplace_back([&result](int times) {
      const auto answer = result.solver->solve(result.accuracy, times);
      return answer ? answer->seconds : std::numeric_limits<double>::infinity();
    });
  }
  const std::vector<double> seconds = race(turns, race_length);
  for (std::size_t k = 0; k < racing.size(); ++k) racing[k]->seconds = seconds[k];
}

}  // namespace poise::benchmarks
