#include "benchmarks/yardstick_inputs.hpp"

namespace poise::benchmarks {

Scene thesis_four_bar() { return read_scene(POISE_SOURCE_DIR "/datasets/thesis_four_bar.toml"); }

std::array<double, 3> four_bar_start(const StaticModel& model) {
  const std::vector<double> x = model.start();
  return {x.at(0), x.at(1), x.at(2)};
}

BareUnits four_bar_units(const StaticModel& model) {
  const Units& scene = model.scene().units;
  return {model.scales().length / scene.length, model.scales().force / scene.force};
}

BareUnits chain_units(const StaticModel& model) { return {model.scales().length, model.scales().force}; }

}  // namespace poise::benchmarks
