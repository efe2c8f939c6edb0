#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace poise {

/// Force T of a law upon a measure g, positive where it tends to diminish g, with its derivatives by g and by the rate
/// dg/dt: N or N m; the power it takes is T dg/dt.
template <class S>
struct LawForce {
  S value{};
  S by_measure{};
  S by_rate{};
};

/// A table of a scene file, [[key]], in which a law is written, and whether it is one for angles only.
struct LawTable {
  const char* key;
  bool angles_only = false;
};

/// A key of that table with one of three words, the first where it is absent.
struct LawChoice {
  std::string_view key;
  std::array<std::string_view, 3> words;
  void (*set)(void* law, std::size_t word);
};

// What a law upon a measure provides. One that stores energy (a spring):
//   energy(g)      V(g)
//   at_rest(g)     LawForce: T = dV/dg, its slope; by_rate = 0
//   force_scale(d) size of the force where g has changed by d: sets the scale of a scene without loads
// One that only resists motion (a damper, friction):
//   resisting(g, w)   LawForce: T at the rate w = dg/dt
//   damps_small_motion   whether it is proportional to small rates
//   left_out          why statics leaves it out
// and in any case
//   force_by(k, g, w)   dT / d numbers[k]
//   numbers             its numbers, see model/number.hpp
//   tables              where it is written in a scene file
//   choices             (if any) see LawChoice
//   idle()              why it never acts, empty where it does
// All functions are templates on the scalar S.

}  // namespace poise
