#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "model/named_measures.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"

namespace poise {

/// A number of the scene that is chosen within a range, SI.
struct FreeNumber {
  std::string path;
  ParameterPlace place;
  double min = 0.0, max = 0.0;
};

/// A range of an angle of a body in the world, or of a travel, rad or m.
struct BalancedRange {
  NamedMeasure of;
  double min = 0.0, max = 0.0;
};

/// A body that may carry a counterweight.
struct Counterweight {
  int body = -1;
  std::optional<double> radius;  ///< of its centre from the pin that joins the body to the ground, m; its mass is free
  std::optional<double> mass;    ///< kg; its place is free
};

/// What a table [balance] asks for.
struct BalanceProblem {
  enum class Of { weights, shaking };

  std::string file, title, source;
  Scene scene;
  Of of = Of::weights;
  std::vector<FreeNumber> stiffnesses;  ///< of springs
  std::vector<FreeNumber> coordinates;  ///< of points that springs are fixed to
  std::vector<BalancedRange> over;
  std::vector<Counterweight> counterweights;
  std::string drive;                        ///< name of the measure that is driven evenly, of shaking; empty for none
  double rate = 1.0;                        ///< its rate, rad/s or m/s
  double range_from = 0.0, range_to = 0.0;  ///< over this range, rad or m
  int line = 0;                             ///< of the table
};

/// Reads a design file with the table [balance] (TOML; grammar in docs/balance.md) and its scene. Throws InputError.
BalanceProblem read_balance(const std::filesystem::path& file);

}  // namespace poise
