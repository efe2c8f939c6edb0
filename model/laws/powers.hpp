#pragma once

#include <cmath>

#include "model/select.hpp"
#include "model/set_valued.hpp"

namespace poise {

/// x^a for x >= 0 and a > 0.
template <class S>
S power_of(const S& x, const S& a) {
  using std::exp;
  using std::log;
  return choose(
      x == S(0), [] { return S(0); }, [&] { return S(exp(a * log(x))); });
}

/// log x where it is multiplied by a power of x, whose product is zero for x = 0.
template <class S>
S log_of(const S& x) {
  using std::log;
  return choose(
      x == S(0), [] { return S(0); }, [&] { return S(log(x)); });
}

}  // namespace poise
