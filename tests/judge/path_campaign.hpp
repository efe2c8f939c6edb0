#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "statics/paths/path.hpp"

namespace poise::judge {

/// A load path of a random mechanism, compared with other ways to the same answers.
struct JudgedPath {
  bool traced = false;  ///< Path::Status::traced
  std::string ended;    ///< why not
  int points = 0;
  int unproved = 0;         ///< points that carry no proof
  bool retraced = true;     ///< ten times shorter steps give the same folds, branch points and end
  std::string differences;  ///< otherwise both, in words
  int connected = 0;        ///< equilibria at the last value that the path passes
  int elsewhere = 0;        ///< others that were found there from random starts
};

/// The path of the planted mechanism of a seed (tests/support/random_mechanism.hpp) from its planted equilibrium, over
/// one of its numbers or a factor of its loads, in turn with the seed. `starts`: random starts of the search at the
/// last value.
JudgedPath judge_path(std::uint64_t seed, bool followers, bool stops, int starts);

}  // namespace poise::judge
