// The hanging chain from an arc: time per link and iteration from 10 to 100 000 links, and the ladder of windows.

#include <benchmark/benchmark.h>

#include "benchmarks/bare_ipopt.hpp"
#include "benchmarks/hand_chain.hpp"
#include "benchmarks/known_answers.hpp"
#include "benchmarks/yardstick_inputs.hpp"
#include "comparison/series.hpp"
#include "solvers/ipopt.hpp"
#include "solvers/newton.hpp"

namespace poise::benchmarks {
namespace {

// Counters of a run that solved a chain once per benchmark iteration.
void report(benchmark::State& state, int iterations, const std::vector<double>& angles) {
  const double steps = static_cast<double>(state.iterations()) * static_cast<double>(state.range(0)) * iterations;
  state.counters["per_link_and_iteration"] =
      benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["iterations"] = iterations;
  state.counters["error"] = chain_error(angles);
  state.SetComplexityN(state.range(0));
}

int links_of(const benchmark::State& state) { return static_cast<int>(state.range(0)); }

void by_hand(benchmark::State& state) {
  HandChain chain(links_of(state));
  const std::vector<double> start = comparison::arc_start(links_of(state));
  for (auto _ : state) benchmark::DoNotOptimize(chain.solve(start));
  report(state, chain.iterations(), chain.angles());
}

void virtual_work(benchmark::State& state, solvers::Goal goal) {
  const StaticModel model(comparison::hanging_chain_scene(links_of(state)));
  solvers::Newton newton(model.problem(), {.goal = goal});
  const std::vector<double> start = model.start();
  for (auto _ : state) benchmark::DoNotOptimize(newton.solve(start));
  const solvers::NewtonResult& result = newton.solve(start);
  report(state, result.iterations, result.x);
}

void bare_energy(benchmark::State& state) {
  const StaticModel model(comparison::hanging_chain_scene(links_of(state)));
  const std::vector<double> start = model.start();
  BareIpoptResult result;
  for (auto _ : state) result = bare_ipopt_chain(start, chain_units(model));
  report(state, result.iterations, result.angles);
}

void energy(benchmark::State& state) {
  const StaticModel model(comparison::hanging_chain_scene(links_of(state)));
  const std::vector<double> start = model.start();
  solvers::SearchResult result;
  for (auto _ : state) result = solvers::solve_with_ipopt(model.problem(), start);
  report(state, result.iterations, result.x);
}

void ladder(benchmark::State& state) {
  const StaticModel model(comparison::window_ladder_scene(links_of(state)));
  solvers::Newton newton(model.problem(), {.goal = solvers::Goal::minimum});
  const std::vector<double> start = model.start();
  for (auto _ : state) benchmark::DoNotOptimize(newton.solve(start));
  const solvers::NewtonResult& result = newton.solve(start);
  if (result.end != solvers::NewtonEnd::converged) state.SkipWithError("did not converge");
  state.counters["iterations"] = result.iterations;
  state.SetComplexityN(state.range(0));
}

BENCHMARK(by_hand)->Name("chain/by_hand")->RangeMultiplier(10)->Range(10, 100000)->Complexity(benchmark::oN);
BENCHMARK_CAPTURE(virtual_work, nearest, solvers::Goal::stationary)
    ->Name("chain/virtual_work/nearest")
    ->RangeMultiplier(10)
    ->Range(10, 100000)
    ->Complexity(benchmark::oN);
BENCHMARK_CAPTURE(virtual_work, stable, solvers::Goal::minimum)
    ->Name("chain/virtual_work/stable")
    ->RangeMultiplier(10)
    ->Range(10, 100000)
    ->Complexity(benchmark::oN);
BENCHMARK(bare_energy)
    ->Name("chain/energy/bare_ipopt")
    ->RangeMultiplier(10)
    ->Range(10, 10000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(energy)->Name("chain/energy/poise")->RangeMultiplier(10)->Range(10, 10000)->Unit(benchmark::kMillisecond);
BENCHMARK(ladder)
    ->Name("window_ladder/virtual_work/stable")
    ->RangeMultiplier(10)
    ->Range(1, 10000)
    ->Complexity(benchmark::oN);

}  // namespace
}  // namespace poise::benchmarks
