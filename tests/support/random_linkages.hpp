#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise::test {

/// Kinds of linkages with one degree of freedom:
///
/// four_bar    two pivots, crank, coupler, rocker
/// watt        a four-bar whose rocker drives another four-bar (Watt's six-bar of the second kind)
/// stephenson  a four-bar with a dyad from a point of its coupler to a third pivot (Stephenson's of the third kind)
const std::vector<std::string>& linkage_kinds();

/// What acts on a random linkage besides gravity, which is always there.
struct LinkageLoads {
  int springs = 1;           ///< between a ground point and a point of a body
  bool free_lengths = true;  ///< of springs; false: free length zero, so that forces are linear in places
  int torsion_springs = 0;   ///< in pins, on relative angles
  double one_way = 0.0;      ///< share of springs that act in tension only
};

/// The linkage of a seed, SI, assembled at its start; the same on every machine. Its points are uniform in a square of
/// 4 m, with bodies no shorter than 0.3 m and of 1 kg per metre. Throws std::invalid_argument for an unknown kind.
Scene random_linkage(const std::string& kind, std::uint64_t seed, const LinkageLoads& loads);

}  // namespace poise::test
