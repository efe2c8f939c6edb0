#pragma once

// Tests of experiment files on one scene.

#include <string>

#include <gtest/gtest.h>

#include "identification/experiment/experiment.hpp"
#include "model/input_error.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::test {

/// A folder with a scene in "scene.toml", in which experiments are written and read.
class WrittenExperiment : public testing::Test {
 protected:
  explicit WrittenExperiment(const std::string& scene) { folder_.write("scene.toml", scene); }

  Experiment read(const std::string& text) const { return read_experiment(folder_.write("experiment.toml", text)); }

  /// What reading says of the text, without the folder's path; empty where it is fine.
  std::string error(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      std::string message = error.what();
      const std::string prefix = folder_.path("");
      for (std::size_t at = 0; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
      return message;
    }
    return "";
  }

  app_tests::TempFolder folder_;
};

}  // namespace poise::test
