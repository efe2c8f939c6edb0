#pragma once

#include <utility>

#include "model/measures/configuration.hpp"
#include "model/phasor_sum.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// World coordinate of a point along a fixed direction e:  g = e.p,  p a sum of phasors; e = (1, 0) for x, (0, 1) for
/// y.
template <class T>
class PositionMeasure {
 public:
  PositionMeasure() = default;
  PositionMeasure(PhasorSum<T> p, const Planar<T>& direction)
      : p_(std::move(p)), direction_(direction), e_(direction) {}
  /// The direction is that of a body that is turned by `turn`, an index into Layout::turns.
  PositionMeasure(const Phasors<T>& phasors, PhasorSum<T> p, const Planar<T>& direction, int turn)
      : PositionMeasure(std::move(p), direction) {
    turn_ = turn;
    take_turn(phasors);
  }

  void set_numbers(const Phasors<T>& phasors) {
    p_.set_numbers(phasors);
    take_turn(phasors);
  }

  const std::vector<int>& support() const { return p_.support(); }
  int scratch_size() const { return p_.size(); }

  T value(const Configuration<T>& at) const { return dot(e_, p_.at(at.pose)); }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    p_.derivative(at.phasors, at.pose, at.scratch);
    for (int i = 0; i < p_.size(); ++i) use(i, dot(e_, at.scratch[i]));
  }

  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    if (!is_just(slope, 0.0)) {
      p_.derivative(at.phasors, at.pose, at.scratch);
      for (int i = 0; i < p_.size(); ++i) {
        const T by = slope * dot(e_, at.scratch[i]);
        for (int j = 0; j <= i; ++j) add(i, j, T(by * dot(e_, at.scratch[j])));
      }
    }
    p_.second_derivative(at.phasors, at.pose,
                         [&](int i, int j, const Planar<T>& p_ij) { add(i, j, T(force * dot(e_, p_ij))); });
  }

  T second(const Configuration<T>& at, const T* u, const T* v) const {
    return dot(e_, p_.along(at.phasors, at.pose, u, v));
  }
  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    return dot(e_, p_.along(at.phasors, at.pose, u, v, w));
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    p_.bend(
        at.phasors, at.pose, u, [&](const Planar<T>& v) { return dot(e_, v); }, use);
  }

 private:
  void take_turn(const Phasors<T>& phasors) {
    if (turn_ != 0) e_ = direction_ * phasors.turned(turn_);
  }

  PhasorSum<T> p_;
  Planar<T> direction_{}, e_{};
  int turn_ = 0;
};

}  // namespace poise
