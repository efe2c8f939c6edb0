#pragma once

#include <string>

namespace poise {

/// A parameter of a scene that a file changes, as --set does.
struct ParameterChange {
  std::string path;    ///< of set_value: "load.P"
  double value = 0.0;  ///< in the scene's units
  int line = 0;
};

}  // namespace poise
