#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "statics/all_equilibria/all_equilibria.hpp"

namespace poise::judge {

struct SetTrial {
  double work = 1e6;                   ///< AllEquilibriaOptions::work: about a second
  int starts = 10'000;                 ///< random starts, against which a complete set is held
  bool phc = false;                    ///< also against PHCpack, where the scene has polynomials
  bool paths = false;                  ///< also the sets at both ends of a load path against its ends
  bool couplings = false;              ///< a planted scene has gears, cams and other couplings
  bool starts_at_equilibrium = false;  ///< the scene's start is one: a complete set has it
};

/// A set of equilibria against other ways to them.
struct JudgedSet {
  poise::Claim claim = poise::Claim::sampled;
  std::string statement;
  int equilibria = 0;
  double seconds = 0.0;  ///< of all_equilibria()
  int sampled = 0;       ///< equilibria, each proved, that random starts led to; 0 where none were asked
  bool phc_ran = false;
  int phc_lost = 0;   ///< equilibria of the set that PHCpack does not find
  int path_ends = 0;  ///< proved ends of a path that were looked for in complete sets
  /// Sentences: proved equilibria that a complete set lacks.
  std::vector<std::string> contradictions;
};

/// The mechanism of a seed (tests/support/random_mechanism.hpp), starting at the equilibrium that it is drawn around;
/// where its start tells nothing of bodies that hang on bars, the trial says so.
Scene planted_scene(std::uint64_t seed, SetTrial& trial);

/// Throws InputError where the scene cannot be assembled.
JudgedSet judge_set(const Scene& scene, const SetTrial& trial);

}  // namespace poise::judge
