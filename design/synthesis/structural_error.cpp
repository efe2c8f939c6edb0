#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "design/synthesis/function_generation.hpp"
#include "design/synthesis/private/ball_slope.hpp"
#include "model/expression_value.hpp"
#include "solvers/root.hpp"

namespace poise {
namespace {

using solvers::Ball;
using synthesis::BallSlope;

/// The error of a linkage as a function of x, in doubles and in balls.
class ErrorCurve {
 public:
  ErrorCurve(const FunctionLinkage& linkage, const WantedFunction& wanted)
      : linkage_(linkage), wanted_(wanted), y_from_(wanted.value(wanted.from)), y_to_(wanted.value(wanted.to)) {
    const double a = linkage.input / linkage.linkage.b.x, c = linkage.output / linkage.linkage.b.x;
    const double b = linkage.linkage.coupler / linkage.linkage.b.x;
    k1_ = 1 / a;
    k2_ = 1 / c;
    k3_ = (a * a - b * b + c * c + 1) / (2 * a * c);
    const double middle = 0.5 * (wanted.from + wanted.to), there = at(middle);
    for (const int side : {1, -1}) {
      side_ = side;
      if (std::abs(error_in(middle) - there) < 1e-6) return;
    }
  }

  double at(double x) const {
    const Vec2 turns = wanted_.turns_at(x);
    const double offset = linkage_.input < 0.0 ? std::numbers::pi : 0.0;
    const auto pose = pose_of(linkage_.linkage, linkage_.input_start + turns.x + offset, linkage_.closure);
    if (!pose) return NAN;
    const double psi = pose->output_angle - (linkage_.output < 0.0 ? std::numbers::pi : 0.0);
    return std::remainder(psi - linkage_.output_start - turns.y, 2 * std::numbers::pi);
  }

  /// Its derivative, by that of Freudenstein's equation.
  double slope_at(double x) const {
    const Vec2 turns = wanted_.turns_at(x);
    const double phi = linkage_.input_start + turns.x, psi = linkage_.output_start + turns.y + at(x);
    const double follows = (k2_ * std::sin(phi) + std::sin(phi - psi)) / (k1_ * std::sin(psi) + std::sin(phi - psi));
    const double rate = wanted_.y.slope(std::array{x}, std::array{1.0});
    return follows * wanted_.input_turn / (wanted_.to - wanted_.from) - wanted_.output_turn * rate / (y_to_ - y_from_);
  }

  /// The error in any scalar.
  template <class T>
  T error_in(const T& x) const {
    using std::atan2;
    using std::cos;
    using std::sin;
    using std::sqrt;
    const T phi =
        T(linkage_.input_start) + T(wanted_.input_turn) * (x - T(wanted_.from)) / (T(wanted_.to) - T(wanted_.from));
    const std::array<T, 1> numbers{x};
    const T y = wanted_.y.value_in<T>(std::span<const T>(numbers));
    const T psi = T(linkage_.output_start) + T(wanted_.output_turn) * (y - T(y_from_)) / (T(y_to_) - T(y_from_));
    // (K1 - cos phi) cos psi - sin phi sin psi = K2 cos phi - K3.
    const T p = T(k1_) - cos(phi), q = -sin(phi), r = T(k2_) * cos(phi) - T(k3_);
    const T s = T(side_) * sqrt(T(p * p + q * q - r * r));
    const T cosine = p * r - q * s, sine = q * r + p * s;
    const T c = cos(psi), d = sin(psi);
    return atan2(T(sine * c - cosine * d), T(cosine * c + sine * d));
  }

 private:
  const FunctionLinkage& linkage_;
  const WantedFunction& wanted_;
  double y_from_, y_to_;
  double k1_ = 0.0, k2_ = 0.0, k3_ = 0.0;
  int side_ = 1;
};

/// Proves that the error is nowhere larger than a little more than `largest`: |e| <= |e(m)| + |e'(X)| h on each part X
/// of the range, of the middle m and half the width h, which is halved until that suffices.
void prove(const ErrorCurve& curve, const WantedFunction& wanted, StructuralError& error) {
  constexpr double more = 1e-6, least = 1e-13;
  constexpr int most_parts = 20000;
  const Ball::Precision precision(64);
  error.bound = error.largest * (1 + more) + least;
  std::vector<Vec2> parts{{wanted.from, wanted.to}};
  for (int k = 0; k < most_parts && !parts.empty(); ++k) {
    const Vec2 part = parts.back();
    parts.pop_back();
    const double middle = 0.5 * (part.x + part.y);
    const BallSlope over = curve.error_in(BallSlope(Ball::of_both(Ball(part.x), Ball(part.y)), Ball(1)));
    const BallSlope at = curve.error_in(BallSlope(Ball(middle), Ball(1)));
    const double half = 0.5 * std::abs(part.y - part.x) * (1 + 1e-15);
    const bool known = at.value.is_finite() && over.slope.is_finite();
    if (known && at.value.greatest() + over.slope.greatest() * half <= error.bound) continue;
    parts.push_back({part.x, middle});
    parts.push_back({middle, part.y});
  }
  error.proved = parts.empty();
}

}  // namespace

std::optional<StructuralError> structural_error(const FunctionLinkage& linkage, const WantedFunction& wanted) {
  if (linkage.passage.defect != Defect::none) return std::nullopt;
  constexpr int places = 400;
  const ErrorCurve curve(linkage, wanted);
  StructuralError out;
  const auto see = [&](double x) {
    const double error = curve.at(x);
    if (std::isfinite(error) && std::abs(error) > out.largest) {
      out.largest = std::abs(error);
      out.at = x;
    }
    return error;
  };
  double before = 0.0;
  for (int k = 0; k <= places; ++k) {
    const double x = k == places ? wanted.to : wanted.from + (wanted.to - wanted.from) * k / places;
    out.curve.push_back({x, see(x)});
    const double slope = curve.slope_at(x);
    if (k > 0 && std::isfinite(before) && std::isfinite(slope) && (before > 0.0) != (slope > 0.0)) {
      solvers::Bracket bracket{out.curve[static_cast<std::size_t>(k) - 1].x, x};
      solvers::bisect(bracket,
                      [&](double& middle) { return std::optional((curve.slope_at(middle) > 0.0) == (before > 0.0)); });
      see(bracket.from);
    }
    before = slope;
  }
  prove(curve, wanted, out);
  return out;
}

}  // namespace poise
