#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/input_error.hpp"
#include "model/laws/curve_spring.hpp"
#include "model/laws/force_curve.hpp"
#include "model/laws/law_force.hpp"
#include "model/laws/one_way.hpp"
#include "model/number.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// Points of the curve of a damper as they are given: without (0, 0), and without those that mirror others.
struct DamperPoints {
  std::vector<double> rates, forces;

  bool is_odd() const { return rates.front() > 0.0; }
  std::size_t negative() const {
    std::size_t count = 0;
    while (count < rates.size() && rates[count] < 0.0) ++count;
    return count;
  }
  /// The index of a given point among all points of the curve.
  std::size_t place_of(std::size_t point) const {
    if (is_odd()) return rates.size() + 1 + point;
    return point < negative() ? point : point + 1;
  }
  std::size_t mirrored_place_of(std::size_t point) const {
    return is_odd() ? rates.size() - 1 - point : place_of(point);
  }
  template <class P>
  std::vector<P> all(const P* given) const {
    const std::size_t count = rates.size();
    std::vector<P> out((is_odd() ? 2 * count : count) + 1, P(0));
    for (std::size_t k = 0; k < count; ++k) {
      out[mirrored_place_of(k)] = -given[k];
      out[place_of(k)] = given[k];
    }
    return out;
  }
  std::vector<double> all_rates() const { return all(rates.data()); }
  void check() const {
    for (std::size_t k = 0; k < rates.size(); ++k) {
      if (forces[k] * rates[k] >= 0.0) continue;
      throw InputError("expected a force with the sign of its rate, for a damper resists; change its sign");
    }
    const ForceCurve curve(all_rates(), all(forces.data()));
    for (const double beyond : {2 * curve.x().front(), 2 * curve.x().back()}) {
      if (curve.force(beyond).second >= 0.0) continue;
      throw InputError(
          "expected a curve that does not fall at its ends, beyond which it goes on along its tangents; add a point");
    }
  }
};

/// Damper with a measured characteristic: T = c F(w), w = dg/dt, with a curve F (ForceCurve) through its points and
/// (0, 0). Where all points have positive rates F is odd: the damper resists both directions equally. The force of a
/// point has the sign of its rate. The factor c fits a curve of a catalogue to a specimen; the forces of the points are
/// numbers too where the scene file has the points.
template <class N>
class CurveDamperOf {
 public:
  using Acts = SpringActs;
  static constexpr std::size_t most_points = CurveSpringOf<double>::most_points;

  N scale = N(1);  ///< c
  Acts acts = Acts::both;

  CurveDamperOf() : CurveDamperOf({1.0}, {1.0}, true) {}
  /// Points of ascending rates (m/s or rad/s), none of them 0, with their forces (N or N m); `numbered`: at most
  /// most_points, each a number.
  CurveDamperOf(std::vector<double> rates, std::vector<double> forces, bool numbered)
      : points_(std::make_shared<const DamperPoints>(DamperPoints{std::move(rates), std::move(forces)})),
        curve_(std::make_shared<const ForceCurve>(points_->all_rates(), points_->all(points_->forces.data()))),
        numbered_(numbered) {}
  /// One with the points of another law, and with other forces where they are given.
  template <class M>
  CurveDamperOf(const N& c, const CurveDamperOf<M>& other, std::shared_ptr<const std::vector<N>> forces)
      : scale(c),
        acts(other.acts),
        points_(other.points_),
        curve_(other.curve_),
        forces_(std::move(forces)),
        numbered_(other.numbered_) {}

  template <class P>
  CurveDamperOf<P> with(const P* p) const {
    bool is_as_given = true;
    for (std::size_t k = 0; numbered_ && k < points(); ++k) {
      is_as_given = is_as_given && is_just(p[1 + k], points_->forces[k]);
    }
    if (is_as_given) return {p[0], *this, nullptr};
    if constexpr (std::is_same_v<P, double>) {
      CurveDamperOf<P> out(points_->rates, std::vector<double>(p + 1, p + 1 + points()), numbered_);
      out.scale = p[0];
      out.acts = acts;
      return out;
    } else {
      return {p[0], *this, std::make_shared<const std::vector<P>>(points_->all(p + 1))};
    }
  }

  std::size_t points() const { return points_->rates.size(); }
  std::span<const double> rates() const { return points_->rates; }
  std::span<const double> forces() const { return points_->forces; }
  /// All numbers, as they are.
  std::vector<N> values() const {
    std::vector<N> out{scale};
    for (std::size_t k = 0; numbered_ && k < points(); ++k) {
      out.push_back(forces_ != nullptr ? (*forces_)[points_->place_of(k)] : N(points_->forces[k]));
    }
    return out;
  }

  template <class S>
  LawForce<S> resisting(const S&, const S& rate) const {
    return while_it_acts(acts, rate, [&](const S& w) {
      const auto [value, slope] = force(w);
      return LawForce<S>{S(scale) * value, S(0), S(scale) * slope};
    });
  }

  template <class S>
  S force_by(int number, const S&, const S& rate) const {
    return while_it_acts(acts, rate, [&](const S& w) -> S {
      if (number == 0) return force(w).first;
      const auto point = static_cast<std::size_t>(number - 1);
      const std::size_t at = points_->place_of(point), mirrored = points_->mirrored_place_of(point);
      S by = curve_->force_by(at, w);
      if (mirrored != at) by -= curve_->force_by(mirrored, w);
      return S(scale) * by;
    });
  }

  std::vector<N> rate_borders() const {
    const std::vector<double> rates = points_->all_rates();
    return {rates.begin(), rates.end()};
  }

  std::string_view idle() const {
    if (scale == 0.0) return "its scale is zero";
    return curve_->largest() == 0.0 ? "its forces are zero" : "";
  }

  bool damps_small_motion() const { return acts == Acts::both; }
  static constexpr std::string_view left_out = "nothing moves in statics";

  void rescale(double measure, double effort) {
    DamperPoints other = *points_;
    for (double& rate : other.rates) rate *= measure;
    for (double& force : other.forces) force *= effort;
    set_points(std::move(other));
  }

  /// Throws InputError unless the force resists and that at the ends does not fall.
  void set_force(std::size_t point, double force) {
    if (points_->forces[point] == force) return;
    DamperPoints other = *points_;
    other.forces[point] = force;
    other.check();
    set_points(std::move(other));
  }
  /// Throws InputError unless all forces resist and those at the ends do not fall.
  void check() const { points_->check(); }

  static constexpr int affine_numbers = 1;
  static constexpr std::array tables{LawTable{"damper", false, "force", "torque"},
                                     LawTable{"torsion_damper", true, "force", "torque"}};
  /// The scale; all_numbers() has those of the points behind it.
  static const std::array<Number, 1> numbers;
  static const std::array<LawChoice, 1> choices;
  std::span<const Number> all_numbers() const;

 private:
  template <class>
  friend class CurveDamperOf;

  void set_points(DamperPoints other) {
    points_ = std::make_shared<const DamperPoints>(std::move(other));
    curve_ = std::make_shared<const ForceCurve>(points_->all_rates(), points_->all(points_->forces.data()));
  }

  // F and dF/dw; without rounding at rest.
  template <class S>
  std::pair<S, S> force(const S& rate) const {
    const auto [value, slope] = through_points(rate);
    return {select(rate == S(0), S(slope * rate), value), slope};
  }
  template <class S>
  std::pair<S, S> through_points(const S& rate) const {
    if constexpr (!std::is_same_v<N, double>) {
      if (forces_ != nullptr) return CurveThrough<N>(curve_->x(), forces_->data()).force(rate);
    }
    return curve_->force(rate);
  }

  // Shared by copies of the law.
  std::shared_ptr<const DamperPoints> points_;
  std::shared_ptr<const ForceCurve> curve_;
  std::shared_ptr<const std::vector<N>> forces_;  // of all points of the curve, where they are numbers
  bool numbered_ = true;
};

using CurveDamper = CurveDamperOf<double>;

namespace curve_numbers {

template <std::size_t Point>
constexpr Number damper_force_of_point() {
  Number F{force_keys[Point].view(), {}, Range::finite};
  F.angle_key = torque_keys[Point].view();
  F.effort_power = 1;
  F.get = [](const void* item) {
    return std::optional<double>(static_cast<const CurveDamper*>(item)->forces()[Point]);
  };
  F.set = [](void* item, double value) { static_cast<CurveDamper*>(item)->set_force(Point, value); };
  F.scale = [](void*, double) {};  // by CurveDamper::rescale, with the whole curve
  return F;
}

/// Scale, and the forces of all points there may be.
inline constexpr auto of_damper = []<std::size_t... Point>(std::index_sequence<Point...>) {
  return std::array{plain_number<&CurveDamper::scale>("scale", {}, Range::not_negative),
                    damper_force_of_point<Point>()...};
}
(std::make_index_sequence<CurveDamper::most_points>());

}  // namespace curve_numbers

template <>
inline constexpr std::array<LawChoice, 1> CurveDamperOf<double>::choices{acts_choice<CurveDamper>()};

template <>
inline constexpr std::array<Number, 1> CurveDamperOf<double>::numbers{curve_numbers::of_damper[0]};

template <>
inline std::span<const Number> CurveDamperOf<double>::all_numbers() const {
  return std::span(curve_numbers::of_damper).first(1 + (numbered_ ? points() : 0));
}

}  // namespace poise
