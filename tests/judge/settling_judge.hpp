#pragma once

#include <cstdint>
#include <string>

namespace poise::judge {

/// A settled answer compared with slow motion (tests/support/slow_motion.hpp) from the same pose.
struct JudgedSettling {
  bool agrees = false;
  bool in_doubt = false;
  double margin = 0.0;
  int freedoms = 0;
  double solves = 0.0;  ///< its time over that of one Newton solve from the same start
  std::string words;    ///< what both found
};

/// Of the seed's mechanism with one freedom. Where they differ the steps of the slow motion are made smaller, up to a
/// factor of 100, before it is believed.
JudgedSettling judge_settling_of_one_freedom(std::uint64_t seed);
/// Of the seed's mechanism with two to five freedoms.
JudgedSettling judge_settling_of_several_freedoms(std::uint64_t seed);

}  // namespace poise::judge
