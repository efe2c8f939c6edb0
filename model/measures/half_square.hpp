#pragma once

#include <utility>

#include "model/measures/configuration.hpp"
#include "model/phasor_sum.hpp"

namespace poise {

/// s = |d|^2 / 2,  d = p_b - p_a a sum of phasors: half the square of a distance. It is smooth where the points
/// coincide, so a spring of free length zero and stiffness k is compiled as the constant force k on it:
/// V = k s = k/2 |d|^2. Derivatives along directions:
///   s_u   = d.d_u
///   s_uv  = d_u.d_v + d.d_uv
///   s_uvw = d_u.d_vw + d_v.d_uw + d_w.d_uv + d.d_uvw
template <class T>
class HalfSquareMeasure {
 public:
  HalfSquareMeasure() = default;
  explicit HalfSquareMeasure(PhasorSum<T> d) : d_(std::move(d)) {}

  void set_numbers(const Phasors<T>& phasors) { d_.set_numbers(phasors); }

  const std::vector<int>& support() const { return d_.support(); }
  int scratch_size() const { return d_.size(); }

  T value(const Configuration<T>& at) const {
    const Planar<T> d = d_.at(at.pose);
    return dot(d, d) / T(2);
  }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    const Planar<T> d = d_.at(at.pose);
    d_.derivative(at.phasors, at.pose, at.scratch);
    for (int i = 0; i < d_.size(); ++i) use(i, dot(d, at.scratch[i]));
  }

  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    const Planar<T> d = d_.at(at.pose);
    d_.derivative(at.phasors, at.pose, at.scratch);
    for (int i = 0; i < d_.size(); ++i) {
      const T b_i = slope * dot(d, at.scratch[i]);
      for (int j = 0; j <= i; ++j) {
        add(i, j, T(force * dot(at.scratch[i], at.scratch[j]) + b_i * dot(d, at.scratch[j])));
      }
    }
    d_.second_derivative(at.phasors, at.pose,
                         [&](int i, int j, const Planar<T>& d_ij) { add(i, j, T(force * dot(d, d_ij))); });
  }

  T second(const Configuration<T>& at, const T* u, const T* v) const {
    const Planar<T> d = d_.at(at.pose);
    d_.derivative(at.phasors, at.pose, at.scratch);
    return dot(d_.along(at.scratch, u), d_.along(at.scratch, v)) + dot(d, d_.along(at.phasors, at.pose, u, v));
  }

  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    const Planar<T> d = d_.at(at.pose);
    d_.derivative(at.phasors, at.pose, at.scratch);
    const auto two = [&](const T* a, const T* b) { return d_.along(at.phasors, at.pose, a, b); };
    return dot(d_.along(at.scratch, u), two(v, w)) + dot(d_.along(at.scratch, v), two(u, w)) +
           dot(d_.along(at.scratch, w), two(u, v)) + dot(d, d_.along(at.phasors, at.pose, u, v, w));
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    const Planar<T> d = d_.at(at.pose);
    d_.derivative(at.phasors, at.pose, at.scratch);
    const Planar<T> d_u = d_.along(at.scratch, u);
    for (int i = 0; i < d_.size(); ++i) use(i, dot(d_u, at.scratch[i]));
    d_.bend(
        at.phasors, at.pose, u, [&](const Planar<T>& v) { return dot(d, v); }, use);
  }

 private:
  PhasorSum<T> d_;
};

}  // namespace poise
