#pragma once

#include <string>
#include <vector>

#include "statics/equilibrium.hpp"

namespace poise::app {

/// What was asked for on the command line.
struct Request {
  std::string scene;                     ///< file
  std::string kind = "scene";            ///< what that file is
  std::vector<std::string> settings;     ///< "load.P=40"
  std::string json, svg, csv, markdown;  ///< files to write, empty for none
  bool quiet = false, verbose = false;   ///< what text shows: verdict and warnings alone; everything
};

/// Exit codes of the command line.
enum ExitCode : int {
  solved = 0,      ///< found and confirmed
  not_solved = 1,  ///< not found, or not confirmed
  bad_input = 2    ///< the scene, the command line or a file to write
};

}  // namespace poise::app
