#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/indexed_key.hpp"
#include "model/laws/force_curve.hpp"
#include "model/laws/law_force.hpp"
#include "model/number.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// Spring with a measured characteristic: T = c F(g - s), V = c W(g - s), with a curve F and its integral W from the
/// first point on (ForceCurve). The factor c and the shift s fit a curve of a catalogue to a specimen; the forces of
/// the points are numbers too where the scene file has the points, and the curve comes from no other file.
template <class N>
class CurveSpringOf {
 public:
  /// As many points have numbers of their own.
  static constexpr std::size_t most_points = 64;

  N scale = N(1);  ///< c
  N shift = N(0);  ///< s: m or rad

  CurveSpringOf() : CurveSpringOf({0.0, 1.0}, {0.0, 1.0}, true) {}
  /// Points of ascending x (m or rad) with their forces (N or N m); `numbered`: at most most_points, each a number.
  CurveSpringOf(std::vector<double> x, std::vector<double> forces, bool numbered)
      : curve_(std::make_shared<const ForceCurve>(std::move(x), std::move(forces))), numbered_(numbered) {}
  /// Through the points of a curve, with `forces` instead of its own where they are given.
  CurveSpringOf(const N& c, const N& s, std::shared_ptr<const ForceCurve> curve, bool numbered, const N* forces)
      : scale(c), shift(s), curve_(std::move(curve)), forces_(forces), numbered_(numbered) {}

  /// In other scalars than double it refers to p.
  template <class P>
  CurveSpringOf<P> with(const P* p) const {
    const P* const forces = p + 2;
    bool is_as_given = true;
    for (std::size_t k = 0; numbered_ && k < curve_->points(); ++k) {
      is_as_given = is_as_given && is_just(forces[k], curve_->forces()[k]);
    }
    if (is_as_given) return {p[0], p[1], curve_, numbered_, nullptr};
    if constexpr (std::is_same_v<P, double>) {
      std::vector<double> x(curve_->x().begin(), curve_->x().end()), other(forces, forces + curve_->points());
      return {p[0], p[1], std::make_shared<const ForceCurve>(std::move(x), std::move(other)), numbered_, nullptr};
    } else {
      return {p[0], p[1], curve_, numbered_, forces};
    }
  }

  const ForceCurve& curve() const { return *curve_; }
  bool has_numbered_points() const { return numbered_; }

  template <class S>
  S energy(const S& g) const {
    return along(S(g - S(shift)), [&](const auto& curve, const S& x) { return S(S(scale) * curve.work(x)); });
  }

  template <class S>
  LawForce<S> at_rest(const S& g) const {
    return along(S(g - S(shift)), [&](const auto& curve, const S& x) {
      const auto [value, slope] = curve.force(x);
      return LawForce<S>{S(scale) * value, S(scale) * slope, S(0)};
    });
  }

  template <class S>
  S force_by(int number, const S& g, const S&) const {
    const S x = g - S(shift);
    if (number == 0) return curve_->force(x).first;
    if (number == 1) return -S(scale) * curve_->force(x).second;
    return S(scale) * curve_->force_by(static_cast<std::size_t>(number - 2), x);
  }

  std::vector<N> measure_borders() const {
    std::vector<N> out;
    for (const double x : curve_->x()) out.push_back(N(x) + shift);
    return out;
  }

  double force_scale(double) const { return (scale < 0.0 ? -scale : scale) * curve_->largest(); }

  std::string_view idle() const {
    if (scale == 0.0) return "its scale is zero";
    return curve_->largest() == 0.0 ? "its forces are zero" : "";
  }

  void rescale(double measure, double effort) {
    curve_ = std::make_shared<const ForceCurve>(curve_->rescaled(measure, effort));
  }

  void set_force(std::size_t point, double force) {
    if (curve_->forces()[point] == force) return;
    curve_ = std::make_shared<const ForceCurve>(curve_->with_force(point, force));
  }

  static constexpr int affine_numbers = 1;
  static constexpr std::array tables{LawTable{"spring", false, "force", "torque"},
                                     LawTable{"torsion_spring", true, "force", "torque"}};
  /// Scale and shift; all_numbers() has those of the points behind them.
  static const std::array<Number, 2> numbers;
  std::span<const Number> all_numbers() const;

 private:
  // use(curve, x) with the curve through the forces that are numbers, or as given.
  template <class S, class Use>
  auto along(const S& x, Use use) const {
    if constexpr (!std::is_same_v<N, double>) {
      if (forces_ != nullptr) return use(CurveThrough<N>(curve_->x(), forces_), x);
    }
    return use(*curve_, x);
  }

  // Shared by copies of the law: scenes are copied, curves seldom change.
  std::shared_ptr<const ForceCurve> curve_;
  const N* forces_ = nullptr;
  bool numbered_ = true;
};

using CurveSpring = CurveSpringOf<double>;

namespace curve_numbers {

inline constexpr auto force_keys = indexed_keys<CurveSpring::most_points>("force");
inline constexpr auto torque_keys = indexed_keys<CurveSpring::most_points>("torque");

template <std::size_t Point>
constexpr Number force_of_point() {
  Number F{force_keys[Point].view(), {}, Range::finite};
  F.angle_key = torque_keys[Point].view();
  F.effort_power = 1;
  F.get = [](const void* item) {
    return std::optional<double>(static_cast<const CurveSpring*>(item)->curve().forces()[Point]);
  };
  F.set = [](void* item, double value) { static_cast<CurveSpring*>(item)->set_force(Point, value); };
  F.scale = [](void*, double) {};  // by CurveSpring::rescale, with the whole curve
  return F;
}

/// Scale, shift, and the forces of all points there may be.
inline constexpr auto all = []<std::size_t... Point>(std::index_sequence<Point...>) {
  Number c = plain_number<&CurveSpring::scale>("scale", {});
  Number s = plain_number<&CurveSpring::shift>("shift", {});
  s.measure_power = 1;
  return std::array{c, s, force_of_point<Point>()...};
}
(std::make_index_sequence<CurveSpring::most_points>());

}  // namespace curve_numbers

template <>
inline constexpr std::array<Number, 2> CurveSpringOf<double>::numbers{curve_numbers::all[0], curve_numbers::all[1]};

template <>
inline std::span<const Number> CurveSpringOf<double>::all_numbers() const {
  return std::span(curve_numbers::all).first(2 + (numbered_ ? curve_->points() : 0));
}

}  // namespace poise
