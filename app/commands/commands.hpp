#pragma once

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "statics/equilibrium.hpp"

namespace poise::app {

/// What was asked for on the command line.
struct Request {
  std::string scene;                  ///< file
  std::vector<std::string> settings;  ///< "load.P=40"
  Method method = Method::virtual_work;
  Seek seek = Seek::nearest;
  std::string json, svg;  ///< files to write, empty for none
};

/// Exit codes of the command line.
enum ExitCode : int {
  solved = 0,      ///< found and confirmed
  not_solved = 1,  ///< not found, or not confirmed
  bad_input = 2    ///< the scene, the command line or a file to write
};

// The commands. Each prints its report on standard output in the palette, writes the files asked for and returns the
// exit code. Bad input is thrown as InputError.

/// What the scene is: bodies, joints, mobility. bad_input where it cannot be assembled.
int run_check(const Request& request, const Palette& palette);
/// One method.
int run_solve(const Request& request, const Palette& palette);
/// All methods. solved where every method that does not refuse the scene is confirmed.
int run_compare(const Request& request, const Palette& palette);

}  // namespace poise::app
