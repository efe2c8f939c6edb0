#pragma once

// How formulas decide by the value of a scalar: one text for scalars that are one number, whose comparisons are bool,
// and for those that hold several at once in lanes (Pack), whose comparisons are true in some lanes only.

#include <cstddef>
#include <type_traits>

namespace poise {

/// What a comparison of scalars with N lanes is (model/pack.hpp).
template <int N>
class Mask;

/// Whether a scalar holds several numbers in lanes.
template <class T>
inline constexpr bool has_lanes = false;

/// What one lane of it is; of other scalars T itself.
template <class T>
struct LaneOfScalar {
  using Type = T;
};
template <class T>
using LaneOf = typename LaneOfScalar<T>::Type;

/// Whether a condition holds in all lanes, or in some.
inline bool all(bool condition) { return condition; }
inline bool any(bool condition) { return condition; }

/// a where the condition holds, b elsewhere.
template <class T>
T select(bool condition, const T& a, const T& b) {
  return condition ? a : b;
}

/// x, but zero where the condition holds.
template <class T>
T zero_where(bool condition, T x) {
  if (condition) return T(0);
  return x;
}

/// As select() of a() and b(), of which only those are evaluated that some lane needs.
template <class A, class B>
std::invoke_result_t<A> choose(bool condition, A a, B b) {
  if (condition) return a();
  return b();
}

/// piece(find(of)) with an index find(of), in which of(x) is what scalars and doubles x are in the lane that is sought:
/// a scalar without lanes has one. Evaluates each piece once that some lane is in.
template <class S, class Find, class Piece>
auto in_piece(Find find, Piece piece) {
  if constexpr (has_lanes<S>) {
    return in_pieces_of_lanes(S(), find, piece);
  } else {
    return piece(find([](const auto& x) -> const auto& { return x; }));
  }
}

}  // namespace poise
