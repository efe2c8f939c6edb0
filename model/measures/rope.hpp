#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "model/length_of.hpp"
#include "model/measures/configuration.hpp"
#include "model/phasor_sum.hpp"

namespace poise {

/// The straight part of a rope from the rim of one pulley to that of the next, whose centres are d apart: its direction
/// t, a unit vector, and its length l. With radii counted positive where the rope passes counter-clockwise, and offset
/// the second less the first,  d = (l + i offset) t,  so  l^2 = |d|^2 - offset^2,  t = d (l - i offset) / |d|^2.
template <class T>
struct RopeSpan {
  RopeSpan(const Planar<T>& d, const T& offset) {
    using std::sqrt;
    const T square = dot(d, d);
    length = choose(
        offset == T(0), [&] { return length_of(d); }, [&] { return T(sqrt(T(square - offset * offset))); });
    along = T(1) / square * (d * Planar<T>{length, -offset});
  }

  Planar<T> along{};
  T length{};
};

/// The angle, rad, along which a rope lies on the rim of a pulley that it reaches along `in` and leaves along `out`,
/// counter-clockwise (turn = 1) or clockwise (-1): from -pi/2 to 3 pi/2, negative where it does not touch the rim.
template <class T>
T rope_wrap(const Planar<T>& in, const Planar<T>& out, int turn) {
  const Planar<T> turned = turn > 0 ? out * conj(in) : in * conj(out);
  return full_angle_of(quarter_turn(turned)) - pi_of<T>() / T(2);
}

/// Length of a taut rope over points and round pulleys:  L = sum l_k + sum r_j wrap_j  over its straight parts and the
/// pulleys in between. A small motion changes it by  dL = sum t_k.dd_k,  since what leaves one part is laid on the
/// rim: the rope is as long as the shortest way round. With n = i t and the derivatives of d_k along directions,
///   L_u   = sum t.d_u
///   L_uv  = sum (n.d_u n.d_v / l + t.d_uv)
///   L_uvw = sum (n.d_uv n.d_w + n.d_uw n.d_v + n.d_vw n.d_u) / l + t.d_uvw
///           - (t.d_u n.d_v n.d_w + n.d_u t.d_v n.d_w + n.d_u n.d_v t.d_w + offset n.d_u n.d_v n.d_w / l) / l^2.
/// A part whose ends coincide has no direction: it counts as a distance of zero does.
template <class T>
class RopeMeasure {
 public:
  struct Contact {
    T radius{};
    int turn = 1;
  };

  RopeMeasure() = default;
  /// One more contact than parts.
  RopeMeasure(std::vector<Contact> contacts, std::vector<PhasorSum<T>> parts) : contacts_(std::move(contacts)) {
    for (const PhasorSum<T>& d : parts) {
      support_.insert(support_.end(), d.support().begin(), d.support().end());
      scratch_ = std::max(scratch_, d.size());
    }
    std::sort(support_.begin(), support_.end());
    support_.erase(std::unique(support_.begin(), support_.end()), support_.end());
    const auto signed_radius = [&](std::size_t k) {
      return contacts_[k].turn > 0 ? contacts_[k].radius : T(-contacts_[k].radius);
    };
    for (std::size_t k = 0; k < parts.size(); ++k) {
      std::vector<int> slots = slots_in(support_, parts[k].support());
      parts_.push_back({std::move(parts[k]), signed_radius(k + 1) - signed_radius(k), std::move(slots)});
    }
  }

  void set_numbers(const Phasors<T>& phasors) {
    for (Part& part : parts_) part.d.set_numbers(phasors);
  }

  const std::vector<int>& support() const { return support_; }
  int scratch_size() const { return scratch_ + static_cast<int>(support_.size()); }

  T value(const Configuration<T>& at) const {
    T sum(0);
    Planar<T> before{};
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const RopeSpan<T> span = span_of(parts_[k], at);
      sum += span.length;
      const Contact& contact = contacts_[k];
      if (k > 0 && !all(contact.radius == 0)) sum += contact.radius * rope_wrap(before, span.along, contact.turn);
      before = span.along;
    }
    return sum;
  }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    const Planar<T>* total = whole_gradient(at);
    for (std::size_t i = 0; i < support_.size(); ++i) use(static_cast<int>(i), total[i].x);
  }

  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    const Planar<T>* total = whole_gradient(at);
    for (std::size_t i = 0; i < support_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        add(static_cast<int>(i), static_cast<int>(j), T(slope * total[i].x * total[j].x));
      }
    }
    for (const Part& part : parts_) {
      const RopeSpan<T> span = span_of(part, at);
      const auto is_point = span.length == 0;
      if (all(is_point)) continue;
      const auto put = [&](int i, int j, const T& value) {
        add(std::max(part.slots[i], part.slots[j]), std::min(part.slots[i], part.slots[j]), value);
      };
      const Planar<T> n = quarter_turn(span.along);
      part.d.derivative(at.phasors, at.pose, at.scratch);
      for (int i = 0; i < part.d.size(); ++i) {
        const T across = force * dot(n, at.scratch[i]) / span.length;
        for (int j = 0; j <= i; ++j) put(i, j, zero_where(is_point, T(across * dot(n, at.scratch[j]))));
      }
      part.d.second_derivative(at.phasors, at.pose, [&](int i, int j, const Planar<T>& d_ij) {
        put(i, j, zero_where(is_point, T(force * dot(span.along, d_ij))));
      });
    }
  }

  T second(const Configuration<T>& at, const T* u, const T* v) const {
    T sum(0);
    for (const Part& part : parts_) {
      const RopeSpan<T> span = span_of(part, at);
      const auto is_point = span.length == 0;
      if (all(is_point)) continue;
      const Planar<T> n = quarter_turn(span.along);
      part.d.derivative(at.phasors, at.pose, at.scratch);
      sum += zero_where(is_point,
                        T(dot(n, part.d.along(at.scratch, u)) * dot(n, part.d.along(at.scratch, v)) / span.length +
                          dot(span.along, part.d.along(at.phasors, at.pose, u, v))));
    }
    return sum;
  }

  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    T sum(0);
    for (const Part& part : parts_) {
      const RopeSpan<T> span = span_of(part, at);
      const auto is_point = span.length == 0;
      if (all(is_point)) continue;
      const T& l = span.length;
      const Planar<T>& t = span.along;
      const Planar<T> n = quarter_turn(t);
      part.d.derivative(at.phasors, at.pose, at.scratch);
      const Planar<T> d_u = part.d.along(at.scratch, u);
      const Planar<T> d_v = part.d.along(at.scratch, v);
      const Planar<T> d_w = part.d.along(at.scratch, w);
      const auto two = [&](const T* a, const T* b) { return dot(n, part.d.along(at.phasors, at.pose, a, b)); };
      const T n_u = dot(n, d_u), n_v = dot(n, d_v), n_w = dot(n, d_w);
      const T by_part = (two(u, v) * n_w + two(u, w) * n_v + two(v, w) * n_u) / l +
                        dot(t, part.d.along(at.phasors, at.pose, u, v, w)) -
                        (dot(t, d_u) * n_v * n_w + n_u * dot(t, d_v) * n_w + n_u * n_v * dot(t, d_w) +
                         part.offset * n_u * n_v * n_w / l) /
                            (l * l);
      sum += zero_where(is_point, by_part);
    }
    return sum;
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    for (const Part& part : parts_) {
      const RopeSpan<T> span = span_of(part, at);
      const auto is_point = span.length == 0;
      if (all(is_point)) continue;
      const Planar<T> n = quarter_turn(span.along);
      part.d.derivative(at.phasors, at.pose, at.scratch);
      const T across = dot(n, part.d.along(at.scratch, u)) / span.length;
      for (int i = 0; i < part.d.size(); ++i) {
        use(part.slots[i], zero_where(is_point, T(across * dot(n, at.scratch[i]))));
      }
      part.d.bend(
          at.phasors, at.pose, u, [&](const Planar<T>& v) { return zero_where(is_point, dot(span.along, v)); },
          [&](int i, const T& value) { use(part.slots[i], value); });
    }
  }

 private:
  struct Part {
    PhasorSum<T> d;
    T offset;
    std::vector<int> slots;  // of d's support in support_
  };

  static RopeSpan<T> span_of(const Part& part, const Configuration<T>& at) { return {part.d.at(at.pose), part.offset}; }

  // In the scratch behind that of the parts.
  const Planar<T>* whole_gradient(const Configuration<T>& at) const {
    Planar<T>* total = at.scratch + scratch_;
    std::fill(total, total + support_.size(), Planar<T>{});
    for (const Part& part : parts_) {
      const RopeSpan<T> span = span_of(part, at);
      const auto is_point = span.length == 0;
      if (all(is_point)) continue;
      part.d.derivative(at.phasors, at.pose, at.scratch);
      for (int i = 0; i < part.d.size(); ++i) {
        total[part.slots[i]].x += zero_where(is_point, dot(span.along, at.scratch[i]));
      }
    }
    return total;
  }

  std::vector<Contact> contacts_;
  std::vector<Part> parts_;
  std::vector<int> support_;
  int scratch_ = 0;
};

}  // namespace poise
