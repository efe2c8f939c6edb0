// The thesis four-bar from its printed pose: virtual work and energy, each next to its yardstick.

#include <benchmark/benchmark.h>

#include "benchmarks/bare_ipopt.hpp"
#include "benchmarks/hand_four_bar.hpp"
#include "benchmarks/known_answers.hpp"
#include "benchmarks/yardstick_inputs.hpp"
#include "solvers/ipopt.hpp"
#include "solvers/newton.hpp"

namespace poise::benchmarks {
namespace {

void by_hand(benchmark::State& state) {
  const StaticModel model(thesis_four_bar());
  const std::array<double, 3> start = four_bar_start(model);
  HandFourBarResult result;
  for (auto _ : state) benchmark::DoNotOptimize(result = solve_four_bar_by_hand(start));
  state.counters["iterations"] = result.iterations;
  state.counters["error"] = four_bar_error(result.angles.data());
}

void virtual_work(benchmark::State& state, solvers::Goal goal) {
  const StaticModel model(thesis_four_bar());
  solvers::Newton newton(model.problem(), {.goal = goal});
  const std::vector<double> start = model.start();
  for (auto _ : state) benchmark::DoNotOptimize(newton.solve(start));
  const solvers::NewtonResult& result = newton.solve(start);
  state.counters["iterations"] = result.iterations;
  state.counters["error"] = four_bar_error(result.x.data());
}

void bare_energy(benchmark::State& state) {
  const StaticModel model(thesis_four_bar());
  const std::array<double, 3> start = four_bar_start(model);
  BareIpoptResult result;
  for (auto _ : state) result = bare_ipopt_four_bar(start, four_bar_units(model));
  state.counters["iterations"] = result.iterations;
  state.counters["error"] = four_bar_error(result.angles.data());
}

void energy(benchmark::State& state) {
  const StaticModel model(thesis_four_bar());
  const std::vector<double> start = model.start();
  solvers::SearchResult result;
  for (auto _ : state) result = solvers::solve_with_ipopt(model.problem(), start);
  state.counters["iterations"] = result.iterations;
  state.counters["error"] = four_bar_error(result.x.data());
}

BENCHMARK(by_hand)->Name("four_bar/virtual_work/by_hand");
BENCHMARK_CAPTURE(virtual_work, nearest, solvers::Goal::stationary)->Name("four_bar/virtual_work/nearest");
BENCHMARK_CAPTURE(virtual_work, stable, solvers::Goal::minimum)->Name("four_bar/virtual_work/stable");
BENCHMARK(bare_energy)->Name("four_bar/energy/bare_ipopt")->Unit(benchmark::kMicrosecond);
BENCHMARK(energy)->Name("four_bar/energy/poise")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace poise::benchmarks
