#pragma once

// The inputs of runs: loads and drives that follow a column of a data file.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "identification/experiment/experiment.hpp"
#include "identification/experiment/private/run_data.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// An input of a run as written; its column is one of the run's source.
struct InputTable {
  RunInput input;
  double zero = 0.0, unit = 1.0;  // SI value, or what the load of the scene is multiplied by, = zero + unit column
  double noise = 0.0;             // 0: none given
  bool is_angle = false;
  std::optional<double> wraps{};  // as of Sensor
  TomlPlace place;
};

/// Reads  inputs = { "PATH" = "COLUMN", "PATH" = { column = "COLUMN", ... } }  of a run, where it has them; their
/// columns, and files of their own, are added to the source. A measured run begins at its sensors' readings, a
/// simulated one at those of its inputs.
std::vector<InputTable> read_inputs(const TomlTable& run, const std::filesystem::path& folder, const Scene& scene,
                                    bool measured, RunSource& source);

/// The input that follows its readings, SI: straight lines for a load, a smooth curve for a drive. Throws InputError
/// where there are too few, where they do not reach from the start of the run to its end, s, or where they scatter by
/// more than their noise.
RunInput input_of(const InputTable& table, Series series, const std::string& run, double end);

}  // namespace poise
