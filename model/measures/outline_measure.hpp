#pragma once

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "model/measures/component.hpp"
#include "model/measures/configuration.hpp"
#include "model/measures/position.hpp"
#include "model/outline.hpp"
#include "model/phasor_sum.hpp"

namespace poise {

/// A function F(x, y) of the place of a point in the frame of another body, which an outline of that body makes: the
/// clearance of the point from it, or the way of a circle along it (model/outline.hpp). x and y are components of the
/// vector from the outline's first point. With subscripts of x, y for derivatives along directions, and of F for those
/// by i, j, k = x, y, which are summed over,
///   g_u   = F_i i_u
///   g_uv  = F_i i_uv + F_ij i_u j_v
///   g_uvw = F_i i_uvw + F_ij (i_uv j_w + i_uw j_v + i_vw j_u) + F_ijk i_u j_v k_w.
template <class T>
class OutlineMeasure {
 public:
  using Component = std::variant<PositionMeasure<T>, ComponentMeasure<T>>;
  /// From the outline's first point to another one, as arms of its body.
  using Point = std::vector<Arm>;

  OutlineMeasure() = default;
  /// The components have one support. `along`: the way along the outline of a circle of this radius; without it the
  /// clearance.
  OutlineMeasure(const Phasors<T>& phasors, Component x, Component y, OutlineIn<T> outline, std::vector<Point> points,
                 bool along, const T& radius)
      : x_(std::move(x)),
        y_(std::move(y)),
        outline_(std::move(outline)),
        points_(std::move(points)),
        along_(along),
        radius_(radius),
        varies_(std::any_of(points_.begin(), points_.end(), [&](const Point& arms) {
          return std::any_of(arms.begin(), arms.end(), [&](const Arm& arm) { return phasors.varies(arm); });
        })) {
    take_points(phasors);
  }

  void set_numbers(const Phasors<T>& phasors) {
    std::visit([&](auto& x) { x.set_numbers(phasors); }, x_);
    std::visit([&](auto& y) { y.set_numbers(phasors); }, y_);
    if (varies_) take_points(phasors);
  }

  const std::vector<int>& support() const {
    return std::visit([](const auto& x) -> const std::vector<int>& { return x.support(); }, x_);
  }
  int scratch_size() const { return scratch_of_components() + static_cast<int>(support().size()); }

  T value(const Configuration<T>& at) const { return function(at).value; }
  /// (x, y).
  Planar<T> place(const Configuration<T>& at) const {
    const auto value = [&](const auto& component) { return component.value(at); };
    return {std::visit(value, x_), std::visit(value, y_)};
  }

  template <class Use>
  void gradient(const Configuration<T>& at, Use use) const {
    const PlaneValue<T> f = function(at);
    const Planar<T>* const d = gradients(at);
    for (int i = 0; i < size(); ++i) use(i, T(f.x * d[i].x + f.y * d[i].y));
  }

  template <class Add>
  void curvature(const Configuration<T>& at, const T& force, const T& slope, Add add) const {
    const PlaneValue<T> f = function(at);
    const Planar<T>* const d = gradients(at);
    for (int i = 0; i < size(); ++i) {
      const T by_x = force * (f.xx * d[i].x + f.xy * d[i].y), by_y = force * (f.xy * d[i].x + f.yy * d[i].y);
      const T by_i = slope * (f.x * d[i].x + f.y * d[i].y);
      for (int j = 0; j <= i; ++j) {
        add(i, j, T(by_x * d[j].x + by_y * d[j].y + by_i * (f.x * d[j].x + f.y * d[j].y)));
      }
    }
    std::visit([&](const auto& x) { x.curvature(at, T(force * f.x), T(0), add); }, x_);
    std::visit([&](const auto& y) { y.curvature(at, T(force * f.y), T(0), add); }, y_);
  }

  T second(const Configuration<T>& at, const T* u, const T* v) const {
    const PlaneValue<T> f = function(at);
    const Planar<T> d_u = along(at, u), d_v = along(at, v), d_uv = along(at, u, v);
    return f.x * d_uv.x + f.y * d_uv.y + bent(f, d_u, d_v);
  }

  T third(const Configuration<T>& at, const T* u, const T* v, const T* w) const {
    const PlaneValue<T> f = function(at);
    const Planar<T> d_u = along(at, u), d_v = along(at, v), d_w = along(at, w);
    const T d_uvw_x = std::visit([&](const auto& x) { return x.third(at, u, v, w); }, x_);
    const T d_uvw_y = std::visit([&](const auto& y) { return y.third(at, u, v, w); }, y_);
    const T x_x = d_u.x * d_v.x, x_y = d_u.x * d_v.y + d_u.y * d_v.x, y_y = d_u.y * d_v.y;
    return f.x * d_uvw_x + f.y * d_uvw_y + bent(f, along(at, u, v), d_w) + bent(f, along(at, u, w), d_v) +
           bent(f, along(at, v, w), d_u) + (f.xxx * x_x + f.xxy * x_y + f.xyy * y_y) * d_w.x +
           (f.xxy * x_x + f.xyy * x_y + f.yyy * y_y) * d_w.y;
  }

  template <class Use>
  void bend(const Configuration<T>& at, const T* u, Use use) const {
    const PlaneValue<T> f = function(at);
    const Planar<T> d_u = along(at, u);
    const Planar<T>* const d = gradients(at);
    for (int i = 0; i < size(); ++i) use(i, bent(f, d_u, d[i]));
    std::visit([&](const auto& x) { x.bend(at, u, [&](int i, const T& by) { use(i, T(f.x * by)); }); }, x_);
    std::visit([&](const auto& y) { y.bend(at, u, [&](int i, const T& by) { use(i, T(f.y * by)); }); }, y_);
  }

 private:
  int size() const { return static_cast<int>(support().size()); }
  int scratch_of_components() const {
    return std::visit([](const auto& x) { return x.scratch_size(); }, x_);
  }

  // In the frame of the body: turned back by the angle by which it is turned from the frame of its coordinate.
  void take_points(const Phasors<T>& phasors) {
    std::vector<Planar<T>> at;
    for (const Point& arms : points_) {
      Planar<T>& sum = at.emplace_back();
      for (const Arm& arm : arms) {
        const Planar<T> part = phasors.coefficient(arm);
        sum += arm.turn == 0 ? part : part * conj(phasors.turned(arm.turn));
      }
    }
    outline_.set_points(std::move(at));
  }

  PlaneValue<T> function(const Configuration<T>& at) const {
    return along_ ? outline_.along(place(at), radius_) : outline_.clearance(place(at));
  }

  // Gives the derivatives of both components by each slot, in the scratch behind that of the components.
  const Planar<T>* gradients(const Configuration<T>& at) const {
    Planar<T>* const d = at.scratch + scratch_of_components();
    std::fill(d, d + size(), Planar<T>{});
    std::visit([&](const auto& x) { x.gradient(at, [&](int i, const T& by) { d[i].x += by; }); }, x_);
    std::visit([&](const auto& y) { y.gradient(at, [&](int i, const T& by) { d[i].y += by; }); }, y_);
    return d;
  }

  Planar<T> along(const Configuration<T>& at, const T* u) const {
    const Planar<T>* const d = gradients(at);
    Planar<T> sum{};
    for (int i = 0; i < size(); ++i) sum += u[support()[static_cast<std::size_t>(i)]] * d[i];
    return sum;
  }
  Planar<T> along(const Configuration<T>& at, const T* u, const T* v) const {
    const auto second = [&](const auto& component) { return component.second(at, u, v); };
    return {std::visit(second, x_), std::visit(second, y_)};
  }

  // F_ij a_i b_j.
  static T bent(const PlaneValue<T>& f, const Planar<T>& a, const Planar<T>& b) {
    return (f.xx * a.x + f.xy * a.y) * b.x + (f.xy * a.x + f.yy * a.y) * b.y;
  }

  Component x_, y_;
  OutlineIn<T> outline_;
  std::vector<Point> points_;
  bool along_ = false;
  T radius_{};
  bool varies_ = false;
};

}  // namespace poise
