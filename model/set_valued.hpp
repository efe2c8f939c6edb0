#pragma once

#include <cstddef>
#include <limits>

#include "model/plain_value.hpp"
#include "model/select.hpp"

namespace poise {

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

/// A number of a set near its middle.
template <class S>
S middle_of(const S& a) {
  return a;
}

/// Whether a scalar may enclose a set of numbers: it is none that the standard library knows the digits of, or carries
/// derivatives and is none without them.
template <class S>
inline constexpr bool may_enclose_set = !std::numeric_limits<PlainOf<S>>::is_specialized;

/// f(a) of a continuous function that is given by pieces, of which piece k reaches from borders[k - 1] to borders[k]
/// and the first and the last without end: piece(k, a). Borders ascend. Of a set, a set that contains f of all its
/// numbers; of a scalar in lanes each lane in its piece.
template <class S, class Borders, class Piece>
auto by_pieces(const S& a, const Borders& borders, Piece piece) {
  const auto borders_below = [&](const auto& of) {
    std::size_t first = 0;
    for (std::size_t count = borders.size(); count > 0;) {
      const std::size_t half = count / 2;
      const bool is_below = of(a) > of(S(borders[first + half]));
      first = is_below ? first + half + 1 : first;
      count = is_below ? count - half - 1 : half;
    }
    return first;
  };
  if constexpr (may_enclose_set<S>) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto part = [&](std::size_t k) {
      return within(a, k == 0 ? -infinity : borders[k - 1], k == borders.size() ? infinity : borders[k]);
    };
    const std::size_t first = borders_below([](const S& x) -> const S& { return x; });
    auto out = piece(first, part(first));
    for (std::size_t k = first; k < borders.size() && !(a < S(borders[k])); ++k) {
      out = hull(out, piece(k + 1, part(k + 1)));
    }
    return out;
  } else {
    return in_piece<S>(borders_below, [&](std::size_t k) { return piece(k, a); });
  }
}

}  // namespace poise
