#include "tests/judge/equilibria_campaign.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "statics/all_equilibria/private/loop_turns.hpp"
#include "statics/all_equilibria/turns.hpp"
#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"
#include "tests/support/phc.hpp"
#include "tests/support/random_mechanism.hpp"

namespace poise::judge {
namespace {

constexpr double same_as_sampled = 1e-6;  // rad or mechanism sizes
constexpr int phc_seconds = 60;

EquilibriumSet proved_set(const StaticModel& model, const SetTrial& trial) {
  AllEquilibriaOptions options;
  options.work = trial.work;
  options.starts = 1;
  options.settling = false;
  return all_equilibria(model, options);
}

// Whether the claim of the set is about the place for certain: rounds of loops are counted from poses of assembly modes
// that may be some turns away from the start.
bool is_meant(const StaticModel& model, const EquilibriumSet& set, const Turns& turns, const std::vector<double>& x) {
  constexpr double rounds = 2.0 * M_PI * (LoopTurns::most_rounds - 3);
  const bool has_rounds = set.statement.find("rounds") != std::string::npos;
  const double within = set.angles_within.value_or(has_rounds ? rounds : std::numeric_limits<double>::infinity());
  const std::vector<double> start = assemble(model);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (turns.count(static_cast<int>(i)) && std::abs(x[i] - start[i]) > within) return false;
  }
  return true;
}

bool holds(const EquilibriumSet& set, const Turns& turns, const std::vector<double>& x) {
  return std::any_of(set.equilibria.begin(), set.equilibria.end(),
                     [&](const Equilibrium& e) { return turns.distance(x, e.x) < same_as_sampled; });
}

void hold_against_starts(const StaticModel& model, const SetTrial& trial, const EquilibriumSet& set, JudgedSet& out) {
  AllEquilibriaOptions options;
  options.seconds = 0.0;
  options.starts = trial.starts;
  options.settling = false;
  const Turns turns(model);
  for (const Equilibrium& e : all_equilibria(model, options).equilibria) {
    if (e.certificate.outcome != Outcome::proved) continue;
    ++out.sampled;
    if (is_meant(model, set, turns, e.x) && !holds(set, turns, e.x))
      out.contradictions.emplace_back("random starts find another equilibrium");
  }
}

void hold_against_start(const StaticModel& model, const EquilibriumSet& set, JudgedSet& out) {
  const std::vector<double> start = assemble(model);
  const Turns turns(model);
  if (is_meant(model, set, turns, start) && !holds(set, turns, start))
    out.contradictions.emplace_back("the set lacks the equilibrium that the mechanism was drawn around");
}

void hold_against_phc(const StaticModel& model, const EquilibriumSet& set, JudgedSet& out) {
  if (!test::polynomials(model).why_not.empty()) return;
  const test::PhcSolutions found = test::solve_with_phc(model, false, phc_seconds);
  out.phc_ran = found.ran;
  if (!found.ran) return;
  // It can lose solutions; those of the set are each proved.
  out.phc_lost = static_cast<int>(set.equilibria.size()) - static_cast<int>(found.real.size());
  const Turns turns(model);
  for (const auto& x : found.real) {
    if (!holds(set, turns, x)) out.contradictions.emplace_back("PHCpack finds another equilibrium");
  }
}

// Halves the weight.
void hold_against_path(const Scene& scene, const SetTrial& trial, JudgedSet& out) {
  const VariedScene varied(scene, "gravity.y", scene.gravity.y, 0.5 * scene.gravity.y);
  PathOptions options;
  options.from = PathOptions::From::equilibrium;
  options.spacing = 0.1;
  const Path found = path(varied, options);
  if (found.branches.empty()) return;
  const PathBranch& branch = found.branches.front();
  const auto hold = [&](const PathPoint& point) {
    if (point.proof != PointProof::proved) return;
    const std::unique_ptr<StaticModel> model = varied.model_at(point.parameter);
    const EquilibriumSet set = proved_set(*model, trial);
    if (set.claim != poise::Claim::complete) return;
    ++out.path_ends;
    const Turns turns(*model);
    if (is_meant(*model, set, turns, point.x) && !holds(set, turns, point.x)) {
      out.contradictions.push_back(fmt::format("a path ends elsewhere at gravity.y = {}", point.parameter));
    }
  };
  if (branch.points.empty()) return;
  hold(branch.points.front());
  if (branch.end == PathBranch::End::range) hold(branch.points.back());
}

}  // namespace

Scene planted_scene(std::uint64_t seed, SetTrial& trial) {
  test::Wish wish;
  wish.loops = static_cast<int>(seed % 3);
  wish.stops = seed % 2 == 1;
  wish.followers = seed % 5 == 4;
  wish.couplings = trial.couplings;
  wish.pulleys = false;
  const test::PlantedMechanism planted = test::plant_mechanism(seed, wish);
  trial.starts_at_equilibrium = !planted.hangs_on_bars;
  return planted.in_equilibrium;
}

JudgedSet judge_set(const Scene& scene, const SetTrial& trial) {
  const StaticModel model(scene);
  const EquilibriumSet set = proved_set(model, trial);
  JudgedSet out;
  out.claim = set.claim;
  out.statement = set.statement;
  out.equilibria = static_cast<int>(set.equilibria.size());
  out.seconds = set.microseconds * 1e-6;
  if (set.claim == poise::Claim::complete) {
    if (trial.starts > 0) hold_against_starts(model, trial, set, out);
    if (trial.phc) hold_against_phc(model, set, out);
    if (trial.starts_at_equilibrium) hold_against_start(model, set, out);
  }
  if (trial.paths) hold_against_path(scene, trial, out);
  return out;
}

}  // namespace poise::judge
