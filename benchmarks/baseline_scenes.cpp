#include "benchmarks/baseline_scenes.hpp"

#include <cstdio>

#include "comparison/series.hpp"

namespace poise::benchmarks {

Scene baseline_scene(const std::string& name) {
  int links = 0;
  if (std::sscanf(name.c_str(), "chain of %d links", &links) == 1) return comparison::hanging_chain_scene(links);
  return read_scene(POISE_SOURCE_DIR "/datasets/" + name);
}

}  // namespace poise::benchmarks
