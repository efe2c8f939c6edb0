#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace poise {

/// Force T of a law on a measure g, positive if it tends to reduce g, with its derivatives by g and by the rate dg/dt:
/// N or N m; the power it absorbs is T dg/dt.
template <class S>
struct LawForce {
  S value{};
  S by_measure{};
  S by_rate{};
};

/// For scalars that enclose sets of numbers, some of which may lie on each side of a limit; others know their side.
/// max(a, 0) of all numbers of the set, and the set with zero added.
template <class S>
S not_below_zero(const S& a) {
  return a;
}
template <class S>
S with_zero(const S& a) {
  return a;
}

/// A table of a scene file, [[key]], that declares a law, and whether it is for angles only.
struct LawTable {
  const char* key;
  bool angles_only = false;
};

/// A key of that table with one of three words; the first is the default.
struct LawChoice {
  std::string_view key;
  std::array<std::string_view, 3> words;
  void (*set)(void* law, std::size_t word);
};

// Members of a law on a measure. A law that stores energy (a spring):
//   energy(g)      V(g)
//     at_rest(g)     LawForce: static force T = dV/dg and its slope; by_rate = 0
//   force_scale(d) size of the force for a change d of g: sets the scale of a scene without loads
// A law that only resists motion (a damper, friction):
//   resisting(g, w)   LawForce: T at the rate w = dg/dt
//   damps_small_motion   whether it is proportional to small rates
//   left_out          why statics leaves it out
// and every law
//   force_by(k, g, w)   dT / d numbers[k]
//   numbers             its numbers, see model/number.hpp
//   tables              the tables of a scene file that declare it
//   choices             (if any) see LawChoice
//   idle()              why it never acts, empty if it does
// All functions are templates on the scalar S.

}  // namespace poise
