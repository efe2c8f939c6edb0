#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "model/length_of.hpp"
#include "model/measure.hpp"
#include "model/planar.hpp"
#include "model/select.hpp"
#include "model/set_valued.hpp"

namespace poise {

/// A function of a place in the plane, with its derivatives by the coordinates x and y of the place.
template <class S>
struct PlaneValue {
  S value{};
  S x{}, y{};
  S xx{}, xy{}, yy{};
  S xxx{}, xxy{}, xyy{}, yyy{};
};

/// These are for scalars in lanes, and for sets of values.
template <class S, int N>
PlaneValue<S> select(const Mask<N>& condition, const PlaneValue<S>& a, const PlaneValue<S>& b) {
  const auto one = [&](const S& p, const S& q) { return select(condition, p, q); };
  return {one(a.value, b.value), one(a.x, b.x),     one(a.y, b.y),     one(a.xx, b.xx),   one(a.xy, b.xy),
          one(a.yy, b.yy),       one(a.xxx, b.xxx), one(a.xxy, b.xxy), one(a.xyy, b.xyy), one(a.yyy, b.yyy)};
}
template <class S>
PlaneValue<S> hull(const PlaneValue<S>& a, const PlaneValue<S>& b) {
  return {hull(a.value, b.value), hull(a.x, b.x),     hull(a.y, b.y),     hull(a.xx, b.xx),   hull(a.xy, b.xy),
          hull(a.yy, b.yy),       hull(a.xxx, b.xxx), hull(a.xxy, b.xxy), hull(a.xyy, b.xyy), hull(a.yyy, b.yyy)};
}

/// An edge of an outline: from a point, along a unit vector; and the way along the outline before it.
template <class S>
struct OutlineEdge {
  Planar<S> from{}, along{};
  S length{};
  S turned{};  ///< angle by which the outline has turned, clockwise, before it from its first edge
  S before{};  ///< sum of the lengths of the edges before it
};
template <class S, int N>
OutlineEdge<S> select(const Mask<N>& condition, const OutlineEdge<S>& a, const OutlineEdge<S>& b) {
  return {select(condition, a.from, b.from), select(condition, a.along, b.along), select(condition, a.length, b.length),
          select(condition, a.turned, b.turned), select(condition, a.before, b.before)};
}

/// An outline in the frame of its body, in the scalar S, and the two functions of a place that measures are made of
/// (model/measures/outline_measure.hpp). With n the unit vector to the left of the way and d the place less what is
/// nearest of the outline,
///
///   clearance    n.d of an edge; |d| of a corner, an end of an arc; |d| - R outside of an arc around its centre,
///                R - |d| inside of a hollow one
///   along        s of an edge, the way from the outline's first point; at a corner that of the corner and r times the
///                angle by which n.. d has turned clockwise; (R + r) a of an arc, (R - r) a of a hollow one, at its
///                angle a
///
/// Outside of the body the clearance has a derivative that is continuous. Of sets of places both enclose what they are
/// at all of them, with derivatives on all sides.
template <class S>
class OutlineIn {
 public:
  OutlineIn() = default;
  /// `local(point)` is a point in the frame of its body, in double: it decides whether an arc is more than half of its
  /// circle.
  template <class Local>
  OutlineIn(const Outline& outline, Local local) : form_(outline.form), backed_(outline.backed) {
    if (form_ == Outline::Form::polygon) return;
    is_full_ = outline.points[1] == outline.points[2];
    const Vec2 centre = local(outline.points[0]);
    const double sine = cross(local(outline.points[1]) - centre, local(outline.points[2]) - centre);
    is_wide_ = is_hollow() ? sine < 0.0 : sine > 0.0;
  }

  /// The points of the outline.
  void set_points(std::vector<Planar<S>> points) {
    points_ = std::move(points);
    if (form_ != Outline::Form::polygon) return;
    if (backed_) {
      const Planar<S> first = points_.front(), last = points_.back();
      points_.push_back(S(0.5) * (first + last - quarter_turn(last - first)));
    }
    edges_.resize(points_.size());
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      OutlineEdge<S>& edge = edges_[k];
      edge.from = points_[k];
      const Planar<S> whole = points_[(k + 1) % points_.size()] - edge.from;
      edge.length = norm(whole);
      edge.along = S(1) / edge.length * whole;
      if (k == 0) {
        edge.turned = edge.before = S(0);
        continue;
      }
      const OutlineEdge<S>& last = edges_[k - 1];
      edge.before = last.before + last.length;
      edge.turned = last.turned + angle_from(edge.along, last.along);
    }
  }

  PlaneValue<S> clearance(const Planar<S>& at) const {
    if (form_ == Outline::Form::polygon) {
      return at_edges(
          at,
          [&](const OutlineEdge<S>& edge, const Planar<S>& d) { return linear(cross(edge.along, d), left_of(edge)); },
          [&](const OutlineEdge<S>&, const Planar<S>& d) { return distance(d); });
    }
    const Planar<S> d = at - points_[0];
    return at_arc(
        d,
        [&] {
          PlaneValue<S> out = distance(d);
          out.value = out.value - norm(Planar<S>(points_[1] - points_[0]));
          return is_hollow() ? times(S(-1), out) : out;
        },
        [&](bool, const Planar<S>& from_end) { return distance(from_end); });
  }

  PlaneValue<S> along(const Planar<S>& at, const S& radius) const {
    if (form_ == Outline::Form::polygon) {
      return at_edges(
          at,
          [&](const OutlineEdge<S>& edge, const Planar<S>& d) {
            return linear(S(edge.before + radius * edge.turned + dot(edge.along, d)), edge.along);
          },
          [&](const OutlineEdge<S>& edge, const Planar<S>& d) {
            return plus(S(edge.before + radius * edge.turned), times(S(-radius), angle(d, left_of(edge))));
          });
    }
    const Planar<S> d = at - points_[0], begin = points_[1] - points_[0];
    const S sign(is_hollow() ? 1 : -1);
    const S arm = norm(begin) - sign * radius;
    // Its angle is counted on from where the arc begins, up to a full turn.
    const auto turned = [&](const Planar<S>& to) {
      return full_angle_of(is_hollow() ? to * conj(begin) : begin * conj(to));
    };
    return at_arc(
        d,
        [&] {
          PlaneValue<S> out = times(S(sign * arm), angle(d, begin));
          out.value = arm * turned(d);
          return out;
        },
        [&](bool last, const Planar<S>& from_end) {
          const Planar<S> end = (last ? points_[2] - points_[0] : begin);
          const PlaneValue<S> around = times(S(-radius), angle(from_end, is_hollow() ? -end : end));
          return last ? plus(S(arm * turned(end)), around) : around;
        });
  }

 private:
  bool is_hollow() const { return form_ == Outline::Form::hollow_arc; }
  static Planar<S> left_of(const OutlineEdge<S>& edge) { return quarter_turn(edge.along); }

  static PlaneValue<S> linear(const S& value, const Planar<S>& by) {
    PlaneValue<S> out{};
    out.value = value;
    out.x = by.x;
    out.y = by.y;
    return out;
  }
  static PlaneValue<S> plus(const S& constant, PlaneValue<S> of) {
    of.value = of.value + constant;
    return of;
  }
  static PlaneValue<S> times(const S& factor, const PlaneValue<S>& of) {
    return {factor * of.value, factor * of.x,   factor * of.y,   factor * of.xx,  factor * of.xy,
            factor * of.yy,    factor * of.xxx, factor * of.xxy, factor * of.xyy, factor * of.yyy};
  }

  // |d|, with u = d / |d| and w = i u:  D = u,  D2 = w w / |d|,  D3 = -(u w w + w u w + w w u) / |d|^2. Where d is zero
  // it has no direction, as a distance.
  static PlaneValue<S> distance(const Planar<S>& d) {
    const S r = length_of(d);
    const auto is_point = r == 0;
    if (all(is_point)) return {};
    const auto known = [&](const S& x) { return zero_where(is_point, x); };
    const S c = d.x / r, s = d.y / r;
    const S by_square = S(1) / (r * r);
    PlaneValue<S> out;
    out.value = r;
    out.x = known(c);
    out.y = known(s);
    out.xx = known(S(s * s / r));
    out.xy = known(S(-(c * s / r)));
    out.yy = known(S(c * c / r));
    out.xxx = known(S(S(-3) * c * s * s * by_square));
    out.xxy = known(S(s * (S(2) * c * c - s * s) * by_square));
    out.xyy = known(S(c * (S(2) * s * s - c * c) * by_square));
    out.yyy = known(S(S(-3) * c * c * s * by_square));
    return out;
  }

  // The angle of d from a direction, counter-clockwise, in [-pi, pi). With z = d as a complex number its derivatives
  // along complex numbers are the imaginary parts of 1 / z, -1 / z^2 and 2 / z^3 times these.
  static PlaneValue<S> angle(const Planar<S>& d, const Planar<S>& from) {
    const Planar<S> one = S(1) / dot(d, d) * conj(d);
    const Planar<S> two = -(one * one);
    const Planar<S> three = S(-2) * (two * one);
    return {angle_from(from, d), one.y, one.x, two.y, two.x, -two.y, three.y, three.x, -three.y, -three.x};
  }
  static S angle_from(const Planar<S>& from, const Planar<S>& to) {
    return full_angle_of(-(conj(from) * to)) - pi_of<S>();
  }

  // on(edge, d) or around(edge, d) with the place d from what is nearest on the outline: of the edge that the place is
  // highest above its edge, or one of its corners. For `around` the way before the edge, and how far it has turned, are
  // those of the corner, with the direction that of the edge.
  template <class On, class Around>
  PlaneValue<S> at_edges(const Planar<S>& at, On on, Around around) const {
    const auto height = [&](const OutlineEdge<S>& edge) { return cross(edge.along, Planar<S>(at - edge.from)); };
    const auto corner_behind = [](OutlineEdge<S> edge) {
      edge.before = edge.before + edge.length;
      return edge;
    };
    if constexpr (may_enclose_set<S>) {
      bool is_first = true;
      PlaneValue<S> out{};
      const auto add = [&](const PlaneValue<S>& part) {
        out = is_first ? part : hull(out, part);
        is_first = false;
      };
      for (const OutlineEdge<S>& edge : edges_) {
        const S h = height(edge);
        bool may_be_nearest = true;
        for (const OutlineEdge<S>& other : edges_) {
          if (&other != &edge && height(other) > h) may_be_nearest = false;
        }
        if (!may_be_nearest) continue;
        const Planar<S> d = at - edge.from;
        const S t = dot(edge.along, d);
        const bool may_be_outside = !(h < S(0)), may_be_inside = !(h > S(0));
        const bool is_beyond = t < S(0) || t > edge.length;
        if (may_be_inside || !is_beyond) add(on(edge, d));
        if (may_be_outside && !(t > S(0))) add(around(edge, d));
        if (may_be_outside && !(t < edge.length)) {
          add(around(corner_behind(edge), d - edge.length * edge.along));
        }
      }
      return out;
    } else {
      OutlineEdge<S> edge = edges_.front();
      S h = height(edge);
      for (std::size_t k = 1; k < edges_.size(); ++k) {
        const S other = height(edges_[k]);
        const auto is_higher = other > h;
        if (!any(is_higher)) continue;
        edge = select(is_higher, edges_[k], edge);
        h = select(is_higher, other, h);
      }
      const Planar<S> d = at - edge.from;
      const S t = dot(edge.along, d);
      const auto is_outside = h > S(0);
      return choose(
          t < S(0) && is_outside, [&]() -> PlaneValue<S> { return around(edge, d); },
          [&]() -> PlaneValue<S> {
            return choose(
                t > edge.length && is_outside,
                [&]() -> PlaneValue<S> { return around(corner_behind(edge), d - edge.length * edge.along); },
                [&]() -> PlaneValue<S> { return on(edge, d); });
          });
    }
  }

  // on() in the angle of the arc, seen from its centre; elsewhere around(is_last, place from the nearer of its ends).
  template <class On, class Around>
  PlaneValue<S> at_arc(const Planar<S>& d, On on, Around around) const {
    if (is_full_) return on();
    const Planar<S> begin = points_[1] - points_[0], towards = points_[2] - points_[0];
    const Planar<S> end = S(norm(begin) / norm(towards)) * towards;
    // Counter-clockwise from p to q.
    const Planar<S>&p = is_hollow() ? begin : end, q = is_hollow() ? end : begin;
    const S behind_p = is_wide_ ? cross(q, d) : cross(p, d), before_q = is_wide_ ? cross(d, p) : cross(d, q);
    const S nearer_to_end = dot(d, Planar<S>(end - begin));
    const auto at_end = [&] { return around(true, Planar<S>(d - end)); };
    const auto at_begin = [&] { return around(false, Planar<S>(d - begin)); };
    if constexpr (may_enclose_set<S>) {
      // Both products are positive inside of the narrow angle, or outside of a wide one.
      const bool may_be_both = !(behind_p < S(0)) && !(before_q < S(0));
      const bool may_be_other = !(behind_p > S(0)) || !(before_q > S(0));
      const bool may_be_on = is_wide_ ? may_be_other : may_be_both;
      const bool may_be_off = is_wide_ ? may_be_both : may_be_other;
      bool is_first = true;
      PlaneValue<S> out{};
      const auto add = [&](const PlaneValue<S>& part) {
        out = is_first ? part : hull(out, part);
        is_first = false;
      };
      if (may_be_on) add(on());
      if (may_be_off && !(nearer_to_end < S(0))) add(at_end());
      if (may_be_off && !(nearer_to_end > S(0))) add(at_begin());
      return out;
    } else {
      const auto is_both = is_wide_ ? behind_p > S(0) && before_q > S(0) : behind_p >= S(0) && before_q >= S(0);
      const auto off = [&]() -> PlaneValue<S> { return choose(nearer_to_end > S(0), at_end, at_begin); };
      if (is_wide_) return choose(is_both, off, on);
      return choose(is_both, on, off);
    }
  }

  Outline::Form form_ = Outline::Form::polygon;
  bool backed_ = false, is_wide_ = false, is_full_ = false;
  std::vector<Planar<S>> points_;
  std::vector<OutlineEdge<S>> edges_;
};

}  // namespace poise
