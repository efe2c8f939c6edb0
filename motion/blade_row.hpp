#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/measures/measures.hpp"

namespace poise {

/// The condition of a blade, compiled: of the rates v of all coordinates, with the place (x, y) of its point and the
/// angle phi of its edge in the frame of the body on which it stands (Blade), c = cos(phi), s = sin(phi),
///   A v = c Dy[v] - s Dx[v] = 0,
/// and of accelerations its time derivative
///   h = A a + DA[v] v = c (Dy[a] + D2y[v, v]) - s (Dx[a] + D2x[v, v]) - Dphi[v] (c Dx[v] + s Dy[v]) = 0.
/// A unit force across the edge, to its left, on the body of the point has the generalized force A.
template <class T>
class BladeRow {
 public:
  /// `turn` is phi - angle, linear in the coordinates.
  BladeRow(CompiledMeasure<T> turn, CompiledMeasure<T> x, CompiledMeasure<T> y, T angle)
      : turn_(std::move(turn)), x_(std::move(x)), y_(std::move(y)), angle_(std::move(angle)) {}

  int scratch_size() const { return std::max({turn_.scratch_size(), x_.scratch_size(), y_.scratch_size()}); }

  /// A v.
  T along(const Configuration<T>& at, const T* v) const {
    const Planar<T> e = edge(at);
    return e.x * y_.along(at, v) - e.y * x_.along(at, v);
  }
  /// The sum of the sizes of all terms of the rates Dx[v] and Dy[v]: what rounds in A v.
  T terms(const Configuration<T>& at, const T* v) const {
    using std::abs;
    T sum(0);
    for (const CompiledMeasure<T>* of : {&x_, &y_}) {
      of->gradient(at, [&](int i, const T& by) { sum += abs(by * v[of->support()[i]]); });
    }
    return sum;
  }
  /// out += factor A, n values.
  void add(const Configuration<T>& at, const T& factor, T* out) const {
    const Planar<T> e = edge(at);
    y_.add_gradient(at, factor * e.x, out);
    x_.add_gradient(at, -factor * e.y, out);
  }
  /// out += factor DA[dq]: the change of that along dq.
  void add_change(const Configuration<T>& at, const T* dq, const T& factor, T* out) const {
    const Planar<T> e = edge(at);
    const T turned = factor * turn_.along(at, dq);
    y_.add_bend(at, dq, factor * e.x, out);
    x_.add_bend(at, dq, -factor * e.y, out);
    y_.add_gradient(at, -turned * e.y, out);
    x_.add_gradient(at, -turned * e.x, out);
  }
  /// h.
  T acceleration(const Configuration<T>& at, const T* v, const T* a) const {
    const Planar<T> e = edge(at);
    return e.x * (y_.along(at, a) + y_.second(at, v, v)) - e.y * (x_.along(at, a) + x_.second(at, v, v)) -
           turn_.along(at, v) * (e.x * x_.along(at, v) + e.y * y_.along(at, v));
  }
  /// The change of h along dq, none if null, and dv at constant a.
  T acceleration_change(const Configuration<T>& at, const T* v, const T* a, const T* dq, const T* dv) const {
    const Planar<T> e = edge(at);
    const T p = turn_.along(at, v), xv = x_.along(at, v), yv = y_.along(at, v);
    T out = T(2) * (e.x * y_.second(at, v, dv) - e.y * x_.second(at, v, dv)) -
            turn_.along(at, dv) * (e.x * xv + e.y * yv) - p * (e.x * x_.along(at, dv) + e.y * y_.along(at, dv));
    if (dq == nullptr) return out;
    const T turned = turn_.along(at, dq);
    out -= turned * (e.y * (y_.along(at, a) + y_.second(at, v, v)) + e.x * (x_.along(at, a) + x_.second(at, v, v)));
    out +=
        e.x * (y_.second(at, a, dq) + y_.third(at, v, v, dq)) - e.y * (x_.second(at, a, dq) + x_.third(at, v, v, dq));
    out -= p * (turned * (e.x * yv - e.y * xv) + e.x * x_.second(at, v, dq) + e.y * y_.second(at, v, dq));
    return out;
  }

 private:
  // (c, s).
  Planar<T> edge(const Configuration<T>& at) const {
    using std::cos;
    using std::sin;
    const T phi = turn_.value(at) + angle_;
    return {cos(phi), sin(phi)};
  }

  CompiledMeasure<T> turn_, x_, y_;
  T angle_;
};

}  // namespace poise
