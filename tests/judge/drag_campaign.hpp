#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "statics/tracking/tracked_equilibrium.hpp"

namespace poise::judge {

struct DragTrial {
  int steps = 60;      ///< at least, of the run
  bool print = false;  ///< every step
  double slow = 1.0;   ///< s of a step that is too slow
};

/// What is wrong with a step.
enum class Fault {
  flip,         ///< followed to another equilibrium than small steps find, without a word
  unconfirmed,  ///< called an equilibrium, or stable, and is none
  other,        ///< an exception of another kind, say, or a state that was changed by an error
  lost,         ///< not found where small steps find an equilibrium
  jump,         ///< told and played, but needless, or not to where the scene settles
  short_way,    ///< a dragged point stops before the place that it could reach
  course,       ///< gaps in the motion that is played
  slow
};
std::string to_string(Fault fault);

/// What a random run of one scene found.
struct JudgedDrags {
  int bodies = 0;
  int steps = 0, confirmed = 0;
  std::array<int, 6> kinds{};  ///< by Transition::Kind
  int errors = 0;              ///< InputError, with everything as before
  int judged = 0;              ///< transitions compared with small steps, which could decide
  std::vector<std::string> undecided;
  struct Contradiction {
    Fault fault = Fault::other;
    std::string words;
  };
  std::vector<Contradiction> contradictions;
  struct Time {
    double seconds = 0.0;  ///< of the processor
    char action = 'd';     ///< d: drag, c: change of numbers, s: another structure, r: release and the like
    bool jumps = false;    ///< snapped or settled
    std::string words{};
  };
  std::vector<Time> times;
};

/// A random sequence of actions on the scene: drags of points, changes of numbers and structure, releases and returns.
/// Every step is compared with free bodies, a fresh certificate and small steps (tests/judge/small_steps.hpp).
JudgedDrags judge_drags(const Scene& scene, std::uint64_t seed, const DragTrial& trial = {});

/// The mechanism of a seed, from all generators in turn: linkages, mixed and planted mechanisms, chains of 2 to 20
/// links, and the kinds of tests/support/random_scenes.hpp. `kind`: its name.
Scene scene_to_drag(std::uint64_t seed, std::string& kind);

}  // namespace poise::judge
