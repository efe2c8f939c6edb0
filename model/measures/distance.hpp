#pragma once

#include <utility>

#include "model/length_of.hpp"
#include "model/measures/configuration.hpp"
#include "model/phasor_sum.hpp"

namespace poise {

/// r = |d|,  d = p_b - p_a a sum of phasors. With subscripts for derivatives along directions,
///   r_u   = d.d_u / r
///   r_uv  = (d_u.d_v + d.d_uv - r_u r_v) / r
///   r_uvw = (d_u.d_vw + d_v.d_uw + d_w.d_uv + d.d_uvw - r_uv r_w - r_uw r_v - r_vw r_u) / r.
/// If the points coincide the distance has no direction: its gradient is set to zero. A force T(r) along it then acts
/// like a spring of free length zero and stiffness dT/dr.
template <class T>
class DistanceMeasure {
 public:
  DistanceMeasure() = default;
  explicit DistanceMeasure(PhasorSum<T> d) : d_(std::move(d)) {}

  void set_numbers(const Phasors<T>& phasors) { d_.set_numbers(phasors); }

  const std::vector<int>& support() const { return d_.support(); }
  int scratch_size() const { return d_.size(); }

  T value(const Configuration<T>& at) const { return length_of(d_.at(at.pose)); }
  /// d.
  Planar<T> place(const Configuration<T>& at) const { return d_.at(at.pose); }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    const Planar<T> d = d_.at(at.pose);
    const T r = length_of(d);
    const auto is_point = r == 0;
    if (all(is_point)) return;
    d_.derivative(at.phasors, at.pose, at.scratch);
    for (int i = 0; i < d_.size(); ++i) use(i, zero_where(is_point, T(dot(d, at.scratch[i]) / r)));
  }

  // With B_i = d.d_i and A_ij = d_i.d_j + d.d_ij:  force D2r + slope Dr Dr^T = w A + u B B^T.
  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    const Planar<T> d = d_.at(at.pose);
    const T r = length_of(d);
    const auto is_point = r == 0;
    const T w = choose(
        is_point, [&] { return slope; }, [&] { return T(force / r); });
    const T u = choose(
        is_point, [] { return T(0); }, [&] { return T((slope - w) / (r * r)); });
    d_.derivative(at.phasors, at.pose, at.scratch);
    for (int i = 0; i < d_.size(); ++i) {
      const T b_i = u * dot(d, at.scratch[i]);
      for (int j = 0; j <= i; ++j) {
        add(i, j, T(w * dot(at.scratch[i], at.scratch[j]) + b_i * dot(d, at.scratch[j])));
      }
    }
    d_.second_derivative(at.phasors, at.pose,
                         [&](int i, int j, const Planar<T>& d_ij) { add(i, j, T(w * dot(d, d_ij))); });
  }

  T second(const Configuration<T>& at, const T* u, const T* v) const {
    const Planar<T> d = d_.at(at.pose);
    const T r = length_of(d);
    const auto is_point = r == 0;
    if (all(is_point)) return T(0);
    d_.derivative(at.phasors, at.pose, at.scratch);
    return zero_where(is_point, second(at, d, r, d_.along(at.scratch, u), d_.along(at.scratch, v), u, v));
  }

  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    const Planar<T> d = d_.at(at.pose);
    const T r = length_of(d);
    const auto is_point = r == 0;
    if (all(is_point)) return T(0);
    d_.derivative(at.phasors, at.pose, at.scratch);
    const Planar<T> d_u = d_.along(at.scratch, u);
    const Planar<T> d_v = d_.along(at.scratch, v);
    const Planar<T> d_w = d_.along(at.scratch, w);
    const auto d_two = [&](const T* a, const T* b) { return d_.along(at.phasors, at.pose, a, b); };
    const T sum = dot(d_u, d_two(v, w)) + dot(d_v, d_two(u, w)) + dot(d_w, d_two(u, v)) +
                  dot(d, d_.along(at.phasors, at.pose, u, v, w)) - second(at, d, r, d_u, d_v, u, v) * dot(d, d_w) / r -
                  second(at, d, r, d_u, d_w, u, w) * dot(d, d_v) / r -
                  second(at, d, r, d_v, d_w, v, w) * dot(d, d_u) / r;
    return zero_where(is_point, T(sum / r));
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    const Planar<T> d = d_.at(at.pose);
    const T r = length_of(d);
    const auto is_point = r == 0;
    if (all(is_point)) return;
    d_.derivative(at.phasors, at.pose, at.scratch);
    const Planar<T> d_u = d_.along(at.scratch, u);
    const T by_length = dot(d, d_u) / (r * r * r);
    for (int i = 0; i < d_.size(); ++i) {
      use(i, zero_where(is_point, T(dot(d_u, at.scratch[i]) / r - by_length * dot(d, at.scratch[i]))));
    }
    d_.bend(
        at.phasors, at.pose, u, [&](const Planar<T>& v) { return zero_where(is_point, T(dot(d, v) / r)); }, use);
  }

 private:
  T second(const Configuration<T>& at, const Planar<T>& d, const T& r, const Planar<T>& d_u, const Planar<T>& d_v,
           const T* u, const T* v) const {
    return (dot(d_u, d_v) + dot(d, d_.along(at.phasors, at.pose, u, v)) - dot(d, d_u) * dot(d, d_v) / (r * r)) / r;
  }

  PhasorSum<T> d_;
};

}  // namespace poise
