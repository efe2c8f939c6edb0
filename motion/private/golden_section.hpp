#pragma once

namespace poise {

/// A value of a function of one variable, and its place.
struct ValueAt {
  double at = 0.0, value = 0.0;
};

/// The least value of f(x) between two places, between which it falls and then rises, by golden sections until these
/// are no farther apart than `width` or x cannot tell the sections apart.
template <class F>
ValueAt least_between(const F& f, double from, double to, double width) {
  constexpr double golden = 0.381966011250105;
  ValueAt low{from + golden * (to - from), 0.0}, high{to - golden * (to - from), 0.0};
  low.value = f(low.at);
  high.value = f(high.at);
  while (to - from > width && low.at < high.at) {
    if (low.value <= high.value) {
      to = high.at;
      high = low;
      low.at = from + golden * (to - from);
      low.value = f(low.at);
    } else {
      from = low.at;
      low = high;
      high.at = to - golden * (to - from);
      high.value = f(high.at);
    }
  }
  return low.value <= high.value ? low : high;
}

}  // namespace poise
