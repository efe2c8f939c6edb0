#include "tests/identification/bench.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "model/scene.hpp"

namespace poise::test {

Bench::Bench(const std::string& experiment, const std::string& data, const std::string& slow) {
  folder_.write("scene.toml", bench_scene);
  if (!data.empty()) folder_.write("data.csv", data);
  if (!slow.empty()) folder_.write("slow.csv", slow);
  file_ = folder_.write("experiment.toml", experiment);
}

Experiment Bench::read(const ExperimentOptions& options) const { return read_experiment(file_, options); }

std::string Bench::error(const ExperimentOptions& options) const {
  try {
    read(options);
  } catch (const InputError& error) {
    std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    const std::string folder = std::filesystem::path(file_).parent_path().string() + "/";
    for (std::size_t at = 0; (at = message.find(folder)) != std::string::npos;) message.erase(at, folder.size());
    return message;
  }
  return "";
}

}  // namespace poise::test
