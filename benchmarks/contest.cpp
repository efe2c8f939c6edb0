#include "benchmarks/contest.hpp"

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
#include "statics/equilibrium.hpp"
#include "statics/reference.hpp"

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
  std::vector<double> x = refined(model, solve(model).x, 1e-10);
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

Contest::Contest(const std::string& name, const std::vector<Rival*>& rivals)
    : model_(baseline_scene(name)), truth_(known_equilibrium(model_, name)), closed_(assemble(model_)) {
  add_our_own();
  for (Rival* rival : rivals) {
    if (rival->take(name))
      add(*rival);
    else
      left_out_.push_back(rival->name() + ": " + rival->why_not());
  }
}

void Contest::add_our_own() {
  const auto newton = std::make_shared<solvers::Newton>(model_.problem());
  const auto by_newton = [this, newton](double, int times) -> std::optional<RivalAnswer> {
    const solvers::NewtonResult* found = nullptr;
    const double seconds = seconds_of([&] { found = &newton->solve(start_); }, times);
    return RivalAnswer{seconds, found->evaluations, found->outcome == solvers::Outcome::converged, found->x};
  };
  const auto by_ipopt = [this](double accuracy, int times) -> std::optional<RivalAnswer> {
    solvers::SearchResult found;
    const auto once = [&] { found = solvers::solve_with_ipopt(model_.problem(), start_, {.tolerance = accuracy}); };
    const double seconds = seconds_of(once, times);
    return RivalAnswer{seconds, found.evaluations, found.claims_success, found.x};
  };
  contenders_.push_back({"Poise", "virtual work", false, by_newton});
  contenders_.push_back({"Ipopt", "", true, by_ipopt});
}

void Contest::add(Rival& rival) {
  rivals_.push_back(&rival);
  for (std::size_t method = 0; method < rival.methods().size(); ++method) {
    const auto solve_it = [&rival, method](double accuracy, int times) {
      return rival.solve(static_cast<int>(method), accuracy, times);
    };
    contenders_.push_back({rival.name(), rival.methods()[method], true, solve_it});
  }
}

void Contest::start_from(const std::vector<double>& x) {
  start_ = x;
  for (Rival* rival : rivals_) rival->start_from(x);
}

std::vector<Standing> Contest::hold() {
  start_from(closed_);
  std::vector<Standing> standings;
  for (const Contender& contender : contenders_) standings.push_back(solve_from_start(contender));
  solve_nearby(standings);
  start_from(closed_);
  time(standings);
  return standings;
}

Standing Contest::solve_from_start(const Contender& contender) const {
  Standing best;
  best.contender = &contender;
  best.error = std::numeric_limits<double>::infinity();
  int in_vain = 0;
  for (int power = loosest; power >= tightest; --power) {
    const double accuracy = std::pow(10.0, power);
    const std::optional<RivalAnswer> answer = contender.solve(accuracy, 1);
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
    if (best.error <= wanted_error || !contender.has_accuracy || (best.seconds > slow && in_vain == patience)) break;
  }
  return best;
}

void Contest::solve_nearby(std::vector<Standing>& standings) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> by(-nearby_reach, nearby_reach);
  for (Standing& standing : standings) {
    if (standing.seconds > slow) standing.nearby = -1;
  }
  for (int k = 0; k < nearby_starts; ++k) {
    std::vector<double> x = closed_;
    for (double& value : x) value += by(random);
    start_from(x);
    for (Standing& standing : standings) {
      if (!standing.arrives || standing.nearby < 0) continue;
      const std::optional<RivalAnswer> answer = standing.contender->solve(standing.accuracy, 1);
      if (!answer) continue;
      const bool right = check(model_, answer->x, {.closure = confirmed, .imbalance = confirmed}).is_equilibrium();
      if (right) ++standing.nearby;
      if (answer->claimed && !right) standing.lied = true;
    }
  }
}

void Contest::time(std::vector<Standing>& standings) const {
  std::vector<Turn> turns;
  std::vector<Standing*> racing;
  for (Standing& standing : standings) {
    if (!standing.arrives) continue;
    racing.push_back(&standing);
    turns.emplace_back([&standing](int times) {
      const auto answer = standing.contender->solve(standing.accuracy, times);
      return answer ? answer->seconds : std::numeric_limits<double>::infinity();
    });
  }
  const std::vector<double> seconds = race(turns, race_length);
  for (std::size_t k = 0; k < racing.size(); ++k) racing[k]->seconds = seconds[k];
}

}  // namespace poise::benchmarks
