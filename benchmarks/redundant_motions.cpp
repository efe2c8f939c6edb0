// Motions of mechanisms whose joints repeat each other in every position, where all rows of all constraints are watched
// at every step.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/timing.hpp"
#include "comparison/redundant_scenes.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/simulate.hpp"

namespace poise::benchmarks {
namespace {

constexpr std::uint64_t mechanisms = 500;

double seconds_to_watch(const MotionModel& model, const MotionState& start) {
  ReducedMotion<double> reduced(model.scaled_scene(), model.mechanism(), model.inertia());
  const std::vector<double> x = model.from_si(start.q);
  reduced.choose(0.0, x.data(), false);
  std::vector<double> z;
  for (const int i : reduced.independent()) z.push_back(x[static_cast<std::size_t>(i)]);
  reduced.expect(x.data());
  reduced.place(0.0, z.data());
  return seconds_of([&] { benchmark::DoNotOptimize(reduced.widest_gap().size); }, 1000);
}

// Half a second each, from rest; the scenes are read and assembled before. `watch` is the share of the time in which
// gaps are looked for at every node, per cent.
void move_redundant_mechanisms(benchmark::State& state) {
  std::deque<MotionModel> models;
  std::vector<MotionState> starts;
  std::vector<double> watch;
  for (std::uint64_t seed = 1; seed <= mechanisms; ++seed) {
    const MotionModel& model = models.emplace_back(comparison::redundant_scene(seed));
    starts.push_back(start_motion(model, {}));
    watch.push_back(seconds_to_watch(model, starts.back()));
  }
  MotionOptions options;
  options.duration = 0.5;
  long completed = 0, steps = 0;
  double watching = 0.0, moving = 0.0;
  for (auto _ : state) {
    completed = steps = 0;
    for (std::size_t k = 0; k < models.size(); ++k) {
      const Motion motion = simulate(models[k], starts[k], options);
      completed += motion.completed() ? 1 : 0;
      steps += motion.steps;
      watching += watch[k] * static_cast<double>(motion.trajectory.nodes());
      moving += motion.microseconds * 1e-6;
    }
  }
  state.counters["completed"] = static_cast<double>(completed);
  state.counters["steps"] = static_cast<double>(steps);
  state.counters["watch"] = 100 * watching / moving;
}
BENCHMARK(move_redundant_mechanisms)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace poise::benchmarks
