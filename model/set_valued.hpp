#pragma once

namespace poise {

// Scalars that enclose sets of numbers: their comparisons hold only if they hold for all numbers of both. Such scalars
// specialise all of these.

/// Whether S may hold more than one number.
template <class S>
inline constexpr bool is_set_valued = false;

/// All numbers of both; of plain numbers, which are in one piece of a function only, the second.
template <class S>
S hull_of(const S& /*a*/, const S& b) {
  return b;
}

/// All numbers from those of a to those of b.
template <class S>
S joined_range(const S& a, const S& /*b*/) {
  return a;
}

/// Those numbers of a that may lie between numbers of `from` and `to`; one that is known to lie there itself.
template <class S>
S restricted(const S& a, const S& /*from*/, const S& /*to*/) {
  return a;
}

}  // namespace poise
