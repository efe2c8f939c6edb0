#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "model/cam_geometry.hpp"
#include "model/measures/component.hpp"
#include "model/measures/configuration.hpp"
#include "model/measures/linear.hpp"
#include "model/measures/position.hpp"
#include "model/measures/sum.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// How far the edge of a cam's follower slips along the pitch curve, in the cam's frame, where a force T on this
/// measure is friction whose size over that of the normal force is |T| over the effort on the cam's measure.
///
/// With h the angle by which the cam has turned from the base, r(h) the pitch curve (the place of the edge from the
/// cam's axis, seen from the cam, while it touches), e(h) the direction in which the edge moves by l per unit of the
/// follower's measure (model/cam_geometry.hpp), and P the place where the edge is,
///
///   g = u(h).(P - r(h)) + int_0^h u.r',   u = -r' / (l r.e)
///
/// On the curve  Dg = u.DP,  in which u is along the curve, and by 1 / (l cos(pressure angle)) longer than a unit
/// vector: the normal force is longer than the effort by as much (statics/model/cam_contact.hpp). Derivatives are those
/// at P = r:  with the change h_v of the angle and those of P by directions v, w, x, as seen from the cam,
///
///   g_vw  = u.P_vw + u'.(h_v P_w + h_w P_v) - u'.r' h_v h_w
///   g_vwx = u.P_vwx + u'.(h_v P_wx + h_w P_vx + h_x P_vw) + u''.(h_v h_w P_x + h_v h_x P_w + h_w h_x P_v)
///           - (2 u''.r' + u'.r'') h_v h_w h_x
template <class T>
class CamSlipMeasure {
 public:
  using Component = std::variant<PositionMeasure<T>, ComponentMeasure<T>>;

  CamSlipMeasure() = default;
  /// `x`, `y`: components of P in the frame of the cam, of one support; `angle`: of the cam's measure, of the cam's
  /// angle h by the sense of the cam.
  CamSlipMeasure(Component x, Component y, LinearMeasure<T> angle, const CamGeometry& cam, int stop)
      : x_(std::move(x)), y_(std::move(y)), angle_(std::move(angle)), cam_(cam), stop_(stop) {
    support_ = of_place();
    support_.insert(support_.end(), angle_.support().begin(), angle_.support().end());
    std::sort(support_.begin(), support_.end());
    support_.erase(std::unique(support_.begin(), support_.end()), support_.end());
    place_slots_ = slots_in(support_, of_place());
    angle_slots_ = slots_in(support_, angle_.support());
  }

  void set_numbers(const Phasors<T>& phasors) {
    std::visit([&](auto& x) { x.set_numbers(phasors); }, x_);
    std::visit([&](auto& y) { y.set_numbers(phasors); }, y_);
    angle_.set_numbers(phasors);
  }
  /// Takes the shape of the cam and the places of its parts from the numbers of the scene.
  template <class NumbersOfScene>
  void set_shape(const NumbersOfScene& numbers) {
    const Measure& on = numbers.scene().stops[static_cast<std::size_t>(stop_)].on;
    const auto term = numbers.term(on, 1, stop_);
    lift_ = -term.factor;
    profile_ = term.profile();
    base_ = numbers.limit(stop_, false);
    const Planar<T> axis = numbers.point(cam_.axis);
    if (cam_.slide >= 0) {
      const Joint& slide = numbers.scene().joints[static_cast<std::size_t>(cam_.slide)];
      foot_ = numbers.point(slide.a) - axis;
      if (slide.keeps_angle()) {
        foot_ += (numbers.point(cam_.roller) - numbers.point(slide.b)) * unit(T(numbers.kept_by(cam_.slide)));
      }
      arm_ = numbers.axis(cam_.slide);
    } else {
      foot_ = numbers.point(cam_.pivot) - axis;
      arm_ = numbers.point(cam_.roller) - numbers.point(cam_.on_follower);
    }
  }
  int stop() const { return stop_; }

  const std::vector<int>& support() const { return support_; }
  int scratch_size() const { return scratch_of_components() + 2 * size(); }

  T value(const Configuration<T>& at) const {
    const T h = turned(at);
    const Curve curve = curve_at(h);
    return dot(curve.u[0], place(at) - curve.r[0]) + slipped(h);
  }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    const Curve curve = curve_at(turned(at));
    const T off = dot(curve.u[1], place(at) - curve.r[0]);
    const Slopes slopes = slopes_at(at);
    for (int i = 0; i < size(); ++i) use(i, T(dot(curve.u[0], slopes.place[i]) + off * slopes.angle[i].x));
  }

  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    const Curve curve = curve_at(turned(at));
    const Slopes slopes = slopes_at(at);
    const T bent = dot(curve.u[1], curve.r[1]);
    for (int i = 0; i < size(); ++i) {
      const T turn_i = dot(curve.u[1], slopes.place[i]), g_i = dot(curve.u[0], slopes.place[i]);
      for (int j = 0; j <= i; ++j) {
        const T turn_j = dot(curve.u[1], slopes.place[j]), g_j = dot(curve.u[0], slopes.place[j]);
        const T& h_i = slopes.angle[i].x;
        const T& h_j = slopes.angle[j].x;
        add(i, j, T(force * (h_i * turn_j + h_j * turn_i - bent * h_i * h_j) + slope * g_i * g_j));
      }
    }
    const auto of_component = [&](const auto& component, const T& by) {
      component.curvature(at, T(force * by), T(0), [&](int i, int j, const T& value) {
        const int a = place_slots_[static_cast<std::size_t>(i)], b = place_slots_[static_cast<std::size_t>(j)];
        add(std::max(a, b), std::min(a, b), value);
      });
    };
    std::visit([&](const auto& x) { of_component(x, curve.u[0].x); }, x_);
    std::visit([&](const auto& y) { of_component(y, curve.u[0].y); }, y_);
  }

  T second(const Configuration<T>& at, const T* v, const T* w) const {
    const Curve curve = curve_at(turned(at));
    const Planar<T> off = place(at) - curve.r[0];
    const T h_v = turn_along(at, v), h_w = turn_along(at, w);
    return dot(curve.u[0], along(at, v, w)) + dot(curve.u[1], h_v * along(at, w) + h_w * along(at, v)) +
           (dot(curve.u[2], off) - dot(curve.u[1], curve.r[1])) * h_v * h_w;
  }

  T third(const Configuration<T>& at, const T* v, const T* w, const T* x) const {
    const Curve curve = curve_at(turned(at));
    const T h_v = turn_along(at, v), h_w = turn_along(at, w), h_x = turn_along(at, x);
    const Planar<T> all{std::visit([&](const auto& c) { return c.third(at, v, w, x); }, x_),
                        std::visit([&](const auto& c) { return c.third(at, v, w, x); }, y_)};
    return dot(curve.u[0], all) +
           dot(curve.u[1], h_v * along(at, w, x) + h_w * along(at, v, x) + h_x * along(at, v, w)) +
           dot(curve.u[2], (h_v * h_w) * along(at, x) + (h_v * h_x) * along(at, w) + (h_w * h_x) * along(at, v)) -
           (T(2) * dot(curve.u[2], curve.r[1]) + dot(curve.u[1], curve.r[2])) * h_v * h_w * h_x;
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* v, Use use) const {
    const Curve curve = curve_at(turned(at));
    const Planar<T> off = place(at) - curve.r[0];
    const T h_v = turn_along(at, v);
    const T by_turn = dot(curve.u[1], along(at, v)) + (dot(curve.u[2], off) - dot(curve.u[1], curve.r[1])) * h_v;
    const Slopes slopes = slopes_at(at);
    for (int i = 0; i < size(); ++i) {
      use(i, T(h_v * dot(curve.u[1], slopes.place[i]) + by_turn * slopes.angle[i].x));
    }
    const auto of_component = [&](const auto& component, const T& by) {
      component.bend(at, v,
                     [&](int i, const T& part) { use(place_slots_[static_cast<std::size_t>(i)], T(by * part)); });
    };
    std::visit([&](const auto& x) { of_component(x, curve.u[0].x); }, x_);
    std::visit([&](const auto& y) { of_component(y, curve.u[0].y); }, y_);
  }

 private:
  // The pitch curve r and u, with their derivatives by h.
  struct Curve {
    std::array<Planar<T>, 4> r{};
    std::array<Planar<T>, 3> u{};
  };
  // Derivatives by each slot, of P and in x of h.
  struct Slopes {
    const Planar<T>* place;
    const Planar<T>* angle;
  };

  const std::vector<int>& of_place() const {
    return std::visit([](const auto& x) -> const std::vector<int>& { return x.support(); }, x_);
  }
  int size() const { return static_cast<int>(support_.size()); }
  int scratch_of_components() const {
    return std::visit([](const auto& x) { return x.scratch_size(); }, x_);
  }
  T turned(const Configuration<T>& at) const { return T(cam_.sense) * angle_.value(at); }
  Planar<T> place(const Configuration<T>& at) const {
    const auto value = [&](const auto& component) { return component.value(at); };
    return {std::visit(value, x_), std::visit(value, y_)};
  }

  // r = (foot + s arm) exp(-i h), or (foot + arm exp(+-i s)) exp(-i h), at the measure s(h) of a follower that touches.
  Curve curve_at(const T& h) const {
    const ProfileValue<T> p = profile_.at(T(T(cam_.sense) * h));
    const T turn(cam_.sense);
    const T s = base_ + lift_ * p.value, s1 = turn * lift_ * p.first, s2 = lift_ * p.second,
            s3 = turn * lift_ * p.third;
    // In the frame of the base: the place of the edge, and the direction in which it moves times l.
    std::array<Planar<T>, 4> place{};
    std::array<Planar<T>, 3> moves{};
    if (cam_.slide >= 0) {
      place = {foot_ + s * arm_, s1 * arm_, s2 * arm_, s3 * arm_};
      moves[0] = arm_;
    } else {
      const T sense(cam_.turn_sense);
      const Planar<T> arm = arm_ * unit(T(sense * s)), across = sense * quarter_turn(arm);
      place = {foot_ + arm, s1 * across, s2 * across - (s1 * s1) * arm,
               s3 * across - (T(3) * s1 * s2) * arm - (s1 * s1 * s1) * across};
      moves = {across, (-s1) * arm, (-s2) * arm - (s1 * s1) * across};
    }
    const Planar<T> back = unit(T(-h));
    Curve out;
    out.r = in_cam(place, back);
    const std::array<Planar<T>, 3> e = in_cam(moves, back);
    const std::array<Planar<T>, 4>& r = out.r;
    // With l e in place of e.
    const T d = dot(r[0], e[0]), d1 = dot(r[1], e[0]) + dot(r[0], e[1]),
            d2 = dot(r[2], e[0]) + T(2) * dot(r[1], e[1]) + dot(r[0], e[2]);
    const T by = T(-1) / d;
    out.u[0] = by * r[1];
    out.u[1] = by * (r[2] + d1 * out.u[0]);
    out.u[2] = by * (r[3] + (T(2) * d1) * out.u[1] + d2 * out.u[0]);
    return out;
  }

  // The derivatives by h of  z exp(-i h)  from those of z.
  template <std::size_t N>
  static std::array<Planar<T>, N> in_cam(const std::array<Planar<T>, N>& z, const Planar<T>& back) {
    const auto less = [](const Planar<T>& a) { return -quarter_turn(a); };
    std::array<Planar<T>, N> out{};
    out[0] = z[0] * back;
    out[1] = (z[1] + less(z[0])) * back;
    out[2] = (z[2] + T(2) * less(z[1]) - z[0]) * back;
    if constexpr (N > 3) out[3] = (z[3] + T(3) * less(z[2]) - T(3) * z[1] - less(z[0])) * back;
    return out;
  }

  // int_0^h u.r', by Gauss's rule of five points over the 32nds of a turn, and over what is left of the last. Sets of
  // numbers and lanes, in which no friction is held, have none.
  T slipped(const T& h) const {
    if constexpr (requires { static_cast<double>(without_derivatives(h)); }) {
      constexpr int cells = 32;
      const T cell = T(2) * pi_of<T>() / T(cells);
      const double before = std::floor(plain_value(h) / plain_value(cell));
      const double turns = std::floor(before / cells);
      const int within = static_cast<int>(before - turns * cells);
      const T start = T(turns) * T(2) * pi_of<T>();
      T sum(0);
      for (int k = 0; turns != 0.0 && k < cells; ++k) sum += over(T(k) * cell, T(k + 1) * cell);
      sum = T(turns) * sum;
      for (int k = 0; k < within; ++k) sum += over(start + T(k) * cell, start + T(k + 1) * cell);
      return sum + over(T(start + T(within) * cell), h);
    } else {
      return T(0);
    }
  }
  T over(const T& from, const T& to) const {
    constexpr std::array<double, 3> place{0.0, 0.53846931010568309104, 0.90617984593866399280};
    constexpr std::array<double, 3> weight{0.56888888888888888889, 0.47862867049936646804, 0.23692688505618908751};
    const T middle = (from + to) / T(2), half = (to - from) / T(2);
    const auto rate = [&](const T& h) {
      const Curve curve = curve_at(h);
      return dot(curve.u[0], curve.r[1]);
    };
    T sum = T(weight[0]) * rate(middle);
    for (std::size_t k = 1; k < place.size(); ++k) {
      sum += T(weight[k]) * (rate(T(middle - T(place[k]) * half)) + rate(T(middle + T(place[k]) * half)));
    }
    return half * sum;
  }

  Slopes slopes_at(const Configuration<T>& at) const {
    Planar<T>* const of_place = at.scratch + scratch_of_components();
    Planar<T>* const of_angle = of_place + size();
    std::fill(of_place, of_angle + size(), Planar<T>{});
    const auto slot = [&](int i) { return static_cast<std::size_t>(place_slots_[static_cast<std::size_t>(i)]); };
    std::visit([&](const auto& x) { x.gradient(at, [&](int i, const T& by) { of_place[slot(i)].x += by; }); }, x_);
    std::visit([&](const auto& y) { y.gradient(at, [&](int i, const T& by) { of_place[slot(i)].y += by; }); }, y_);
    angle_.gradient(
        at, [&](int i, const T& by) { of_angle[angle_slots_[static_cast<std::size_t>(i)]].x += T(cam_.sense) * by; });
    return {of_place, of_angle};
  }
  T turn_along(const Configuration<T>& at, const T* v) const {
    T sum(0);
    angle_.gradient(at, [&](int i, const T& by) { sum += by * v[angle_.support()[static_cast<std::size_t>(i)]]; });
    return T(cam_.sense) * sum;
  }
  Planar<T> along(const Configuration<T>& at, const T* v) const {
    const Slopes slopes = slopes_at(at);
    Planar<T> sum{};
    for (int i = 0; i < size(); ++i) sum += v[support_[static_cast<std::size_t>(i)]] * slopes.place[i];
    return sum;
  }
  Planar<T> along(const Configuration<T>& at, const T* v, const T* w) const {
    const auto second = [&](const auto& component) { return component.second(at, v, w); };
    return {std::visit(second, x_), std::visit(second, y_)};
  }

  Component x_, y_;
  LinearMeasure<T> angle_;
  CamGeometry cam_;
  int stop_ = -1;
  Planar<T> foot_{}, arm_{};
  T base_{}, lift_{};
  ProfileOf<T> profile_;
  std::vector<int> support_, place_slots_, angle_slots_;  // of the parts in the whole
};

}  // namespace poise
