// poise_baselines: alternatives to Poise on the same small mechanisms in the same run: Ipopt, SciPy on Poise's model
// and on equations written in NumPy, Simbody and MuJoCo, each with the loosest sufficient tolerance. Programs that are
// not installed are listed as left out. Times of wrong answers are not printed. Exit code 1 if an answer of Poise is
// wrong; times do not affect it.

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "benchmarks/known_answers.hpp"
#include "benchmarks/scene_benchmark.hpp"
#include "benchmarks/timing.hpp"

namespace poise::benchmarks {
namespace {

constexpr const char* scenes[] = {"thesis_four_bar.toml", "toggle_clamp.toml",   "four_bar_gravity.toml",
                                  "heaton_timme.toml",    "toggle_press.toml",   "vertical_slider_crank.toml",
                                  "thesis_chain.toml",    "pendulum_chain.toml", "chain of 10 links",
                                  "chain of 100 links"};

// Required speed of Poise relative to theirs, on mechanisms of at most `small` coordinates, at an error that is not
// larger than theirs, or rounding.
const std::map<std::string, double> promises = {{"Ipopt", 500.0}, {"SciPy", 50.0}, {"Simbody", 300.0}};
constexpr int small = 20;
constexpr double rounding = 1e-14;

struct Promise {
  double least = INFINITY;
  std::string scene;
  int missed = 0, kept = 0, nobody = 0;
};

class Table {
 public:
  void add(const std::string& scene, SceneBenchmark& benchmark) {
    const std::vector<SolverResult> results = benchmark.run();
    const Layout& layout = benchmark.model().layout();
    fmt::print("\n{}: {} coordinates, {} closures\n", scene, layout.kept, 2 * layout.closures.size());
    const SolverResult& ours = results.front();
    for (const SolverResult& result : results) {
      const bool is_best = &result == fastest(results, result.solver->family);
      const bool is_promised =
          is_best && promises.count(result.solver->family) > 0 && ours.arrives && layout.kept <= small;
      fmt::print("{}{}\n", line(result, ours), is_promised ? check_promise(scene, result, ours) : "");
      check_answer(result);
    }
    if (layout.kept <= small) note_absent(results);
    for (const std::string& why : benchmark.left_out()) fmt::print("  left out: {}\n", why);
  }

  void head() const {
    fmt::print("{:<36}{:>9}{:>8}{:>10}{:>13}{:>11}{:>10}\n", "", "accuracy", "nearby", "error", "evaluations", "time",
               "Poise is");
  }

  void sum_up() const {
    fmt::print("\nPromised, on mechanisms of at most {} coordinates\n", small);
    for (const auto& [family, limit] : promises) {
      const auto found = kept_.find(family);
      if (found == kept_.end()) {
        fmt::print("  {:<8} >= {:>3} x  not measured\n", family, limit);
        continue;
      }
      const Promise& promise = found->second;
      fmt::print("  {:<8} >= {:>3} x  {:<6}  least {:.0f} x ({})", family, limit,
                 promise.missed == 0 ? "met" : "MISSED", promise.least, promise.scene);
      if (promise.missed > 0) fmt::print("; missed in {} of {}", promise.missed, promise.missed + promise.kept);
      if (promise.nobody > 0) fmt::print("; no method converges in {} more", promise.nobody);
      fmt::print("\n");
    }
  }

  bool all_right() const { return all_right_; }

 private:
  static const SolverResult* fastest(const std::vector<SolverResult>& results, const std::string& family) {
    const SolverResult* best = nullptr;
    for (const SolverResult& s : results) {
      if (s.solver->family != family || !s.arrives) continue;
      if (best == nullptr || s.seconds < best->seconds) best = &s;
    }
    return best;
  }

  static std::string line(const SolverResult& s, const SolverResult& ours) {
    const std::string name = s.solver->family + " " + s.solver->method;
    if (!s.arrives) {
      const std::string how = std::isinf(s.error) ? "it fails" : fmt::format("error {:.1e}", s.error);
      return fmt::format("  {:<34}does not converge: {}", name, how);
    }
    const std::string accuracy = s.solver->has_accuracy ? fmt::format("{:.0e}", s.accuracy) : "-";
    const std::string nearby = s.nearby < 0 ? "-" : fmt::format("{}/{}", s.nearby, nearby_starts);
    const std::string ratio = &s == &ours || !ours.arrives ? "" : fmt::format("{:>8.0f} x", s.seconds / ours.seconds);
    return fmt::format("  {:<34}{:>9}{:>8}{:>10.1e}{:>13}{:>11}{}", name, accuracy, nearby, s.error, s.evaluations,
                       in_units(s.seconds), ratio);
  }

  std::string check_promise(const std::string& scene, const SolverResult& theirs, const SolverResult& ours) {
    const double limit = promises.at(theirs.solver->family);
    Promise& promise = kept_[theirs.solver->family];
    const double ratio = theirs.seconds / ours.seconds;
    if (ratio < promise.least) {
      promise.least = ratio;
      promise.scene = scene;
    }
    const bool as_exact = ours.error <= std::max(theirs.error, rounding);
    const bool met = as_exact && ratio >= limit;
    ++(met ? promise.kept : promise.missed);
    return fmt::format("  >= {} {}{}", limit, met ? "met" : "MISSED", as_exact ? "" : ", ours is less exact");
  }

  // Families that took part without a method that converges.
  void note_absent(const std::vector<SolverResult>& results) {
    std::set<std::string> took_part;
    for (const SolverResult& s : results) took_part.insert(s.solver->family);
    for (const std::string& family : took_part) {
      if (promises.count(family) > 0 && fastest(results, family) == nullptr) ++kept_[family].nobody;
    }
  }

  // Methods of Poise are virtual work and the adapter to Ipopt; the latter is run at the loosest sufficient tolerance.
  void check_answer(const SolverResult& s) {
    const bool by_virtual_work = s.solver->family == "Poise";
    if (!by_virtual_work && s.solver->family != "Ipopt") return;
    const bool false_claim = by_virtual_work && s.false_claim;
    if (s.error <= (by_virtual_work ? virtual_work_error : energy_error) && !false_claim) return;
    fmt::print("  WRONG: {}\n",
               false_claim ? "Poise claimed an answer that is no equilibrium" : "ours is not exact enough");
    all_right_ = false;
  }

  std::map<std::string, Promise> kept_;
  bool all_right_ = true;
};

// Empty for a program that was not found when Poise was configured.
std::vector<std::string> scipy_command() {
#ifdef POISE_SCIPY_PYTHON
  return {POISE_SCIPY_PYTHON, POISE_SOURCE_DIR "/benchmarks/scipy_baseline.py", POISE_EVALUATE_SCENE};
#else
  return {};
#endif
}

std::vector<std::string> numpy_command() {
#ifdef POISE_SCIPY_PYTHON
  return {POISE_SCIPY_PYTHON, POISE_SOURCE_DIR "/benchmarks/numpy_baseline.py"};
#else
  return {};
#endif
}

std::vector<std::string> simbody_command() {
#ifdef POISE_SIMBODY_BASELINE
  return {POISE_SIMBODY_BASELINE};
#else
  return {};
#endif
}

std::vector<std::string> mujoco_command() {
#ifdef POISE_MUJOCO_BASELINE
  return {POISE_MUJOCO_BASELINE};
#else
  return {};
#endif
}

std::vector<std::unique_ptr<ExternalSolver>> find_external_solvers() {
  std::vector<std::unique_ptr<ExternalSolver>> present;
  const auto admit = [&](const char* name, const std::vector<std::string>& command) {
    std::string why = "not found when Poise was configured";
    if (!command.empty()) {
      auto external = std::make_unique<ExternalSolver>(name, command);
      why = external->why_absent();
      if (why.empty()) present.push_back(std::move(external));
    }
    if (!why.empty()) fmt::print("{}: left out, {}; cmake/setup.sh baselines installs it\n", name, why);
  };
  admit("SciPy", scipy_command());
  admit("NumPy", numpy_command());
  admit("Simbody", simbody_command());
  admit("MuJoCo", mujoco_command());
  return present;
}

bool measure() {
  const std::vector<std::unique_ptr<ExternalSolver>> present = find_external_solvers();
  std::vector<ExternalSolver*> external_solvers;
  for (const auto& external : present) external_solvers.push_back(external.get());
  Table table;
  table.head();
  for (const char* scene : scenes) {
    SceneBenchmark benchmark(scene, external_solvers);
    table.add(scene, benchmark);
    std::fflush(stdout);
  }
  table.sum_up();
  fmt::print(
      "\naccuracy: asked for, the loosest of 1e-4, 1e-5, ... 1e-14 whose error is below {:.0e}, else that with the "
      "least\n"
      "error. nearby: of {} starts with every coordinate moved by up to {}, those that lead to an equilibrium. error: "
      "from\n"
      "the known equilibrium, rad or over the size. All start from closed loops, the clamp from its file; promises are "
      "judged against the "
      "fastest\n"
      "method that arrives. SciPy's callbacks are Poise's compiled model, NumPy's are SciPy's on equations\n"
      "written by hand; root gets multipliers to start with. MuJoCo's closures are soft: its error is what they "
      "give.\n",
      wanted_error, nearby_starts, nearby_reach);
  for (ExternalSolver* external : external_solvers) {
    const std::optional<double> idle = external->idle();
    if (idle) fmt::print("{} takes {} at least, where there is nothing to solve.\n", external->name(), in_units(*idle));
  }
  return table.all_right();
}

}  // namespace
}  // namespace poise::benchmarks

int main() {
  try {
    return poise::benchmarks::measure() ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
