#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "model/measures/configuration.hpp"
#include "model/phasor_sum.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// Component of a vector along a direction that turns with a frame:  g = e.d,  e = c exp(i theta_f),  d = p_b - p_a a
/// sum of phasors. With e' = i e and v_f the part of a direction v along theta_f,
///   g_v   = e.d_v + v_f e'.d
///   g_vw  = e.d_vw + v_f e'.d_w + w_f e'.d_v - v_f w_f e.d
///   g_uvw = e.d_uvw + (u_f e'.d_vw + v_f e'.d_uw + w_f e'.d_uv)
///           - (u_f v_f e.d_w + u_f w_f e.d_v + v_f w_f e.d_u) - u_f v_f w_f e'.d.
template <class T>
class ComponentMeasure {
 public:
  ComponentMeasure() = default;
  /// `direction`: c, that of a body that is turned by `turn` from a kept angle, `frame`; an index into Layout::turns.
  ComponentMeasure(const Phasors<T>& phasors, PhasorSum<T> d, const Planar<T>& direction, int turn, int frame)
      : d_(std::move(d)),
        direction_(direction),
        c_(turn == 0 ? direction : direction * phasors.turned(turn)),
        turn_(turn),
        frame_(frame),
        support_(d_.support()) {
    const auto at = std::lower_bound(support_.begin(), support_.end(), frame);
    if (at == support_.end() || *at != frame) support_.insert(at, frame);
    slots_ = slots_in(support_, d_.support());
    frame_slot_ = slots_in(support_, {frame}).front();
  }

  void set_numbers(const Phasors<T>& phasors) {
    d_.set_numbers(phasors);
    if (turn_ != 0) c_ = direction_ * phasors.turned(turn_);
  }

  const std::vector<int>& support() const { return support_; }
  int scratch_size() const { return d_.size(); }

  T value(const Configuration<T>& at) const { return dot(along(at), d_.at(at.pose)); }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    const Planar<T> e = along(at);
    d_.derivative(at.phasors, at.pose, at.scratch);
    const T turning = dot(quarter_turn(e), d_.at(at.pose));
    bool is_frame_used = false;
    for (int i = 0; i < d_.size(); ++i) {
      const bool is_frame = slots_[i] == frame_slot_;
      is_frame_used = is_frame_used || is_frame;
      use(slots_[i], is_frame ? T(dot(e, at.scratch[i]) + turning) : dot(e, at.scratch[i]));
    }
    if (!is_frame_used) use(frame_slot_, turning);
  }

  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    const Planar<T> e = along(at);
    const Planar<T> turned = quarter_turn(e);
    const Planar<T> d = d_.at(at.pose);
    const auto put = [&](int a, int b, const T& value) { add(std::max(a, b), std::min(a, b), value); };
    d_.derivative(at.phasors, at.pose, at.scratch);
    const T turning = dot(turned, d);
    if (!is_just(slope, 0.0)) {
      const int n = d_.size();
      // The derivative by slot i of d, and last that by the frame.
      const auto by = [&](int i) { return i < n ? dot(e, at.scratch[i]) : turning; };
      const auto slot = [&](int i) { return i < n ? slots_[i] : frame_slot_; };
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= i; ++j) {
          T value = slope * by(i) * by(j);
          // Both orders of a pair of different parts that share a slot.
          if (i != j && slot(i) == slot(j)) value = T(2) * value;
          put(slot(i), slot(j), value);
        }
      }
    }
    d_.second_derivative(at.phasors, at.pose, [&](int i, int j, const Planar<T>& d_ij) {
      put(slots_[i], slots_[j], T(force * dot(e, d_ij)));
    });
    for (int i = 0; i < d_.size(); ++i) {
      const T mixed = force * dot(turned, at.scratch[i]);
      put(slots_[i], frame_slot_, slots_[i] == frame_slot_ ? T(T(2) * mixed) : mixed);
    }
    put(frame_slot_, frame_slot_, T(-(force * dot(e, d))));
  }

  T second(const Configuration<T>& at, const T* v, const T* w) const {
    const Planar<T> e = along(at);
    const Planar<T> turned = quarter_turn(e);
    d_.derivative(at.phasors, at.pose, at.scratch);
    return dot(e, d_.along(at.phasors, at.pose, v, w)) + v[frame_] * dot(turned, d_.along(at.scratch, w)) +
           w[frame_] * dot(turned, d_.along(at.scratch, v)) - v[frame_] * w[frame_] * dot(e, d_.at(at.pose));
  }

  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    const Planar<T> e = along(at);
    const Planar<T> turned = quarter_turn(e);
    d_.derivative(at.phasors, at.pose, at.scratch);
    const T& u_f = u[frame_];
    const T& v_f = v[frame_];
    const T& w_f = w[frame_];
    const auto one = [&](const T* a) { return dot(e, d_.along(at.scratch, a)); };
    const auto two = [&](const T* a, const T* b) { return dot(turned, d_.along(at.phasors, at.pose, a, b)); };
    return dot(e, d_.along(at.phasors, at.pose, u, v, w)) + u_f * two(v, w) + v_f * two(u, w) + w_f * two(u, v) -
           u_f * v_f * one(w) - u_f * w_f * one(v) - v_f * w_f * one(u) - u_f * v_f * w_f * dot(turned, d_.at(at.pose));
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    const Planar<T> e = along(at);
    const Planar<T> turned = quarter_turn(e);
    d_.derivative(at.phasors, at.pose, at.scratch);
    const Planar<T> d_u = d_.along(at.scratch, u);
    const T& u_f = u[frame_];
    for (int i = 0; i < d_.size(); ++i) use(slots_[i], T(u_f * dot(turned, at.scratch[i])));
    use(frame_slot_, T(dot(turned, d_u) - u_f * dot(e, d_.at(at.pose))));
    d_.bend(
        at.phasors, at.pose, u, [&](const Planar<T>& v) { return dot(e, v); },
        [&](int i, const T& value) { use(slots_[i], value); });
  }

 private:
  Planar<T> along(const Configuration<T>& at) const { return c_ * at.pose[frame_]; }

  PhasorSum<T> d_;
  Planar<T> direction_{}, c_{};
  int turn_ = 0, frame_ = 0;
  std::vector<int> support_, slots_;  // of d's support in it
  int frame_slot_ = 0;
};

}  // namespace poise
