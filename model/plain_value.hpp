#pragma once

#include <type_traits>
#include <utility>

#include "model/select.hpp"

namespace poise {

/// A scalar that carries derivatives: its value a and their vector v (ceres::Jet).
template <class T>
concept HasDerivatives = requires(const T& x) {
  x.a;
  x.v;
};

/// Of other scalars with derivatives, that specialise it: value(x), and is_constant(x), whether all its derivatives are
/// zero.
template <class T>
struct OtherDerivatives;
template <class T>
concept HasOtherDerivatives = requires(const T& x) {
  OtherDerivatives<T>::value(x);
};

/// Whether a scalar carries derivatives.
template <class T>
inline constexpr bool has_derivatives = HasDerivatives<T> || HasOtherDerivatives<T>;

/// What a scalar is without its derivatives.
template <class T>
const T& without_derivatives(const T& x) {
  return x;
}
template <HasDerivatives T>
const auto& without_derivatives(const T& x) {
  return without_derivatives(x.a);
}
template <HasOtherDerivatives T>
auto without_derivatives(const T& x) {
  return OtherDerivatives<T>::value(x);
}

/// Its type: double of dual numbers in double.
template <class T>
using PlainOf = std::remove_cvref_t<decltype(without_derivatives(std::declval<const T&>()))>;

/// The value of a scalar that is no set of numbers, rounded to double.
template <class T>
double plain_value(const T& x) {
  return static_cast<double>(without_derivatives(x));
}

/// Whether the value is zero, whatever it depends on; of a set of numbers whether it is the number zero, and of a
/// scalar in lanes in which of them.
template <class T>
auto is_zero(const T& x) {
  return without_derivatives(x) == PlainOf<T>(0);
}

/// Whether a scalar is this number and depends on no variable; of a set of numbers whether it is that number alone, and
/// of a scalar in lanes whether all of them are.
template <class T>
bool is_just(const T& x, double number) {
  if constexpr (HasDerivatives<T>) {
    for (int k = 0; k < static_cast<int>(x.v.size()); ++k) {
      if (!is_just(x.v[k], 0.0)) return false;
    }
    return is_just(x.a, number);
  } else if constexpr (HasOtherDerivatives<T>) {
    return OtherDerivatives<T>::is_constant(x) && without_derivatives(x) == number;
  } else {
    return all(x == T(number));
  }
}

}  // namespace poise
