#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "model/select.hpp"
#include "model/set_valued.hpp"

namespace poise {

/// Force T of a law on a measure g, positive if it tends to reduce g, with its derivatives by g and by the rate dg/dt:
/// N or N m; the power it absorbs is T dg/dt.
template <class S>
struct LawForce {
  S value{};
  S by_measure{};
  S by_rate{};
};

/// Of sets of forces.
template <class S>
LawForce<S> hull(const LawForce<S>& a, const LawForce<S>& b) {
  return {hull(a.value, b.value), hull(a.by_measure, b.by_measure), hull(a.by_rate, b.by_rate)};
}

/// Of scalars in lanes.
template <int N, class S>
LawForce<S> select(const Mask<N>& condition, const LawForce<S>& a, const LawForce<S>& b) {
  return {select(condition, a.value, b.value), select(condition, a.by_measure, b.by_measure),
          select(condition, a.by_rate, b.by_rate)};
}

/// A table of a scene file, [[key]], that declares a law, whether it is for angles only, and the key, on an angle
/// perhaps another one, that tells the law from others of that table; none for the law of tables without such a key.
struct LawTable {
  const char* key;
  bool angles_only = false;
  std::string_view told_by{};
  std::string_view told_on_angle_by{};

  std::string_view told_on(bool is_angle) const {
    return is_angle && !told_on_angle_by.empty() ? told_on_angle_by : told_by;
  }
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
//   damps_small_motion()   whether it is proportional to small rates
//   left_out          why statics leaves it out, if it stores no energy
// One that does both has the sum of both forces. And every law
//   with(p)             the law with the numbers p[k] of any scalar in place of numbers[k]
//   force_by(k, g, w)   dT / d numbers[k]
//   numbers             its numbers, see model/number.hpp
//   all_numbers()       (if not all laws of its kind have equally many) these and what a single one has beside them
//   affine_numbers      (if not all) how many of its numbers, the first ones, T is an affine function of
//   tables              the tables of a scene file that declare it
//   choices             (if any) see LawChoice
//   idle()              why it never acts, empty if it does
//   slack(g)            (if it acts on one side only) whether, or in which lanes, it has no force at g
//   measure_borders()   (if any) values of g, as many for all numbers, at which derivatives of T jump
//   rate_borders()      (if any) the same of w
//   rescale(m, e)       (if numbers alone do not make it) its measures times m, its forces times e: powers of two
// All functions are templates on the scalar S of the measure, and a law SpringOf<N> on the scalar N of its numbers:
// that of a scene is Spring = SpringOf<double>, which alone has those from `numbers` on. A double converts to N, an N
// to S.

}  // namespace poise
