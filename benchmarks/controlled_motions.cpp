// Motions of a chain of ten links with a controller on each joint, against the same without controllers.

#include <array>
#include <cstddef>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "model/read_scene.hpp"
#include "motion/simulate.hpp"

namespace poise::benchmarks {
namespace {

constexpr std::array<const char*, 4> controllers{"", "proportional = 20\nderivative = 0.5\n",
                                                 "proportional = 20\nderivative = 0.5\nintegral = 5\n",
                                                 "proportional = 20\nderivative = 0.5\nintegral = 5\nfilter = 0.02\n"};

std::string chain(const std::string& controller) {
  constexpr int links = 10;
  std::string out = "gravity = [0, -9.81]\n[ground]\npoints = { B = [0, 0] }\n", start = "[start]\n";
  std::string last = "ground";
  for (int i = 0; i < links; ++i) {
    const std::string link = fmt::format("link{}", i);
    out += fmt::format(
        "[body.{0}]\npoints = {{ A = [0, 0], B = [0.3, 0] }}\nmass = 1\ncenter = [0.15, 0]\ninertia = 0.01\n"
        "[[pin]]\npoints = [\"{1}.B\", \"{0}.A\"]\n",
        link, last);
    if (!controller.empty()) {
      out += fmt::format("[[controller]]\nname = \"on {0}\"\nbodies = [\"{1}\", \"{0}\"]\n{2}", link, last, controller);
    }
    start += fmt::format("{} = {}\n", link, -0.3 - 0.05 * i);
    last = link;
  }
  return out + start;
}

// `evaluation`: of the equations of motion, microseconds, with all that a step needs besides.
void move_controlled_chain(benchmark::State& state) {
  const MotionModel model(parse_scene(chain(controllers[static_cast<std::size_t>(state.range(0))]), "chain"));
  const MotionState start = start_motion(model, {});
  MotionOptions options;
  options.duration = 0.5;
  options.sensitivities = state.range(1) != 0;
  double time = 0.0, evaluations = 0.0;
  for (auto _ : state) {
    const Motion motion = simulate(model, start, options);
    time += motion.microseconds;
    evaluations += static_cast<double>(motion.evaluations);
  }
  state.counters["evaluation"] = time / evaluations;
}
BENCHMARK(move_controlled_chain)->ArgNames({"controller", "sensitivities"})->ArgsProduct({{0, 1, 2, 3}, {0, 1}});

}  // namespace
}  // namespace poise::benchmarks
