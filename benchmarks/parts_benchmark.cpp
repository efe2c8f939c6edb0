// The parts of a run of the program: reading, compiling, evaluating, analysis for solving, the independent check.

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>

#include <benchmark/benchmark.h>

#include "benchmarks/yardstick_inputs.hpp"
#include "comparison/series.hpp"
#include "solvers/newton.hpp"
#include "statics/model/check.hpp"
#include "statics/model/reference.hpp"
#include "statics/proof/certificate.hpp"
#include "statics/proof/enclosed_reactions.hpp"

namespace poise::benchmarks {
namespace {

using Make = Scene (*)();

Scene chain_100() { return comparison::hanging_chain_scene(100); }
Scene chain_1000() { return comparison::hanging_chain_scene(1000); }
Scene ladder_100() { return comparison::window_ladder_scene(100); }

std::string text_of(const std::string& dataset) {
  std::ifstream file(POISE_SOURCE_DIR "/datasets/" + dataset);
  return {std::istreambuf_iterator<char>(file), {}};
}

void parse(benchmark::State& state, const std::string& dataset) {
  const std::string text = text_of(dataset);
  for (auto _ : state) benchmark::DoNotOptimize(parse_scene(text, dataset));
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
}

void compile(benchmark::State& state, Make make) {
  const Scene scene = make();
  for (auto _ : state) {
    const StaticModel model(scene);
    benchmark::DoNotOptimize(model.mechanism().coordinates());
  }
}

void evaluate(benchmark::State& state, Make make) {
  const StaticModel model(make());
  solvers::Evaluation at = model.problem().make_evaluation();
  at.x = model.start();
  for (auto _ : state) {
    model.problem().evaluate(at);
    benchmark::DoNotOptimize(at.jacobian.data());
  }
  state.counters["coordinates"] = model.problem().variables();
}

void tangent(benchmark::State& state, Make make) {
  const StaticModel model(make());
  solvers::Evaluation at = model.problem().make_evaluation();
  at.x = model.start();
  model.problem().evaluate(at);
  const std::vector<double> multipliers(model.problem().constraints(), 0.5);
  std::vector<double> values(model.problem().tangent_pattern().size());
  for (auto _ : state) {
    model.problem().tangent(at, multipliers, values);
    benchmark::DoNotOptimize(values.data());
  }
}

void analyse(benchmark::State& state, Make make) {
  const StaticModel model(make());
  for (auto _ : state) {
    const solvers::Newton newton(model.problem());
    benchmark::DoNotOptimize(&newton);
  }
}

std::vector<double> equilibrium(const StaticModel& model) {
  return solvers::Newton(model.problem()).solve(model.start()).x;
}

void check_equilibrium(benchmark::State& state, Make make) {
  const StaticModel model(make());
  const std::vector<double> x = equilibrium(model);
  for (auto _ : state) benchmark::DoNotOptimize(check(model, x));
}

void certify_equilibrium(benchmark::State& state, Make make) {
  const StaticModel model(make());
  const std::vector<double> x = equilibrium(model);
  for (auto _ : state) benchmark::DoNotOptimize(certify(model, x));
}

void enclose_forces(benchmark::State& state, Make make) {
  const StaticModel model(make());
  const Certificate certificate = certify(model, equilibrium(model));
  const Check found = check(model, certificate.x, {}, &certificate.active_stops);
  for (auto _ : state) {
    Check enclosed = found;
    enclose_reactions(model, certificate, enclosed);
    benchmark::DoNotOptimize(enclosed);
  }
}

void fifty_digits(benchmark::State& state, Make make) {
  const StaticModel model(make());
  const std::vector<double> x = equilibrium(model);
  for (auto _ : state) benchmark::DoNotOptimize(refine(model, x));
}

BENCHMARK_CAPTURE(parse, four_bar, "thesis_four_bar.toml")->Name("parse/four_bar")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(parse, lift, "lift.toml")->Name("parse/lift")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(compile, four_bar, thesis_four_bar)->Name("compile/four_bar")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(compile, chain, chain_1000)->Name("compile/chain_1000")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(compile, ladder, ladder_100)->Name("compile/ladder_100")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, four_bar, thesis_four_bar)->Name("evaluate/four_bar");
BENCHMARK_CAPTURE(evaluate, chain, chain_1000)->Name("evaluate/chain_1000");
BENCHMARK_CAPTURE(evaluate, ladder, ladder_100)->Name("evaluate/ladder_100");
BENCHMARK_CAPTURE(tangent, four_bar, thesis_four_bar)->Name("tangent/four_bar");
BENCHMARK_CAPTURE(tangent, chain, chain_1000)->Name("tangent/chain_1000");
BENCHMARK_CAPTURE(tangent, ladder, ladder_100)->Name("tangent/ladder_100");
BENCHMARK_CAPTURE(analyse, four_bar, thesis_four_bar)->Name("analyse/four_bar");
BENCHMARK_CAPTURE(analyse, chain, chain_1000)->Name("analyse/chain_1000")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(check_equilibrium, four_bar, thesis_four_bar)->Name("check/four_bar")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(check_equilibrium, chain, chain_100)->Name("check/chain_100")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(certify_equilibrium, four_bar, thesis_four_bar)
    ->Name("certify/four_bar")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(certify_equilibrium, chain, chain_100)->Name("certify/chain_100")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(enclose_forces, four_bar, thesis_four_bar)->Name("enclose/four_bar")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(enclose_forces, chain, chain_100)->Name("enclose/chain_100")->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(fifty_digits, four_bar, thesis_four_bar)
    ->Name("fifty_digits/four_bar")
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace poise::benchmarks
