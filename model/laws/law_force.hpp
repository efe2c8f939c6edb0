#pragma once

#include <array>
#include <cstddef>
#include <limits>
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

/// A set that contains both sets; the numbers of a set between two limits, or a set that contains them.
template <class S>
S hull(const S& a, const S&) {
  return a;
}
template <class S>
S within(const S& a, double, double) {
  return a;
}
template <class S>
LawForce<S> hull(const LawForce<S>& a, const LawForce<S>& b) {
  return {hull(a.value, b.value), hull(a.by_measure, b.by_measure), hull(a.by_rate, b.by_rate)};
}

/// Whether a scalar may enclose a set of numbers: it is none that the standard library knows the digits of.
template <class S>
inline constexpr bool may_enclose_set = !std::numeric_limits<S>::is_specialized;

/// f(a) of a continuous function that is given by pieces, of which piece k reaches from borders[k - 1] to borders[k]
/// and the first and the last without end: piece(k, a). Borders ascend. Of a set, a set that contains f of all its
/// numbers.
template <class S, class Borders, class Piece>
auto by_pieces(const S& a, const Borders& borders, Piece piece) {
  std::size_t first = 0;
  for (std::size_t count = borders.size(); count > 0;) {  // borders below a
    const std::size_t half = count / 2;
    const bool is_below = a > S(borders[first + half]);
    first = is_below ? first + half + 1 : first;
    count = is_below ? count - half - 1 : half;
  }
  if constexpr (may_enclose_set<S>) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto part = [&](std::size_t k) {
      return within(a, k == 0 ? -infinity : borders[k - 1], k == borders.size() ? infinity : borders[k]);
    };
    auto out = piece(first, part(first));
    for (std::size_t k = first; k < borders.size() && !(a < S(borders[k])); ++k) {
      out = hull(out, piece(k + 1, part(k + 1)));
    }
    return out;
  } else {
    return piece(first, a);
  }
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
//   damps_small_motion   whether it is proportional to small rates
//   left_out          why statics leaves it out
// and every law
//   force_by(k, g, w)   dT / d numbers[k]
//   numbers             its numbers, see model/number.hpp
//   all_numbers()       (if not all laws of its kind have equally many) these and what a single one has beside them
//   affine_numbers      (if not all) how many of its numbers, the first ones, T is an affine function of
//   tables              the tables of a scene file that declare it
//   choices             (if any) see LawChoice
//   idle()              why it never acts, empty if it does
//   slack(g)            (if it acts on one side only) whether it has no force at g
//   rescale(m, e)       (if numbers alone do not make it) its measures times m, its forces times e: powers of two
// All functions are templates on the scalar S.

}  // namespace poise
