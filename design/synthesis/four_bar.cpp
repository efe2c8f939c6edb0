#include "design/synthesis/four_bar.hpp"

#include <algorithm>
#include <cmath>

namespace poise {
namespace {

using ComplexLength = std::complex<double>;

ComplexLength as_complex(const Vec2& a) { return {a.x, a.y}; }

Vec2 as_vector(const ComplexLength& a) { return {a.real(), a.imag()}; }

/// The four-bar that has its pins where the triangle (0, 1, `ratio`) on a link of the first one has its third corner.
/// `link` and `base` are the length of its first link and the vector from its coupler's first pin to the point, along
/// the real axis; `far` is the length of the link that its last one is parallel to.
FourBar cognate(const Vec2& a, const Vec2& b, const ComplexLength& ratio, double link, double base, double far) {
  const double stretch = std::abs(ratio);
  const ComplexLength turn = stretch > 0.0 ? std::conj(ratio) / stretch : ComplexLength(1.0);
  return {a, b, link, stretch * base, stretch * far, as_vector(base * turn)};
}

}  // namespace

std::optional<FourBarPose> pose_of(const FourBar& linkage, double input_angle, int closure) {
  FourBarPose pose;
  pose.input_angle = input_angle;
  pose.input_pin = linkage.a + linkage.input * unit(input_angle);
  const Vec2 diagonal = linkage.b - pose.input_pin;
  const double distance = norm(diagonal);
  if (distance == 0.0) return std::nullopt;
  const double along =
      (distance * distance + linkage.coupler * linkage.coupler - linkage.output * linkage.output) / (2 * distance);
  const double square = linkage.coupler * linkage.coupler - along * along;
  if (!(square >= 0.0)) return std::nullopt;
  const double across = std::copysign(std::sqrt(square), closure);
  const Vec2 direction = (1 / distance) * diagonal;
  const Vec2 coupler = along * direction + across * quarter_turn(direction);
  pose.output_pin = pose.input_pin + coupler;
  pose.coupler_angle = std::atan2(coupler.y, coupler.x);
  const Vec2 output = pose.output_pin - linkage.b;
  pose.output_angle = std::atan2(output.y, output.x);
  pose.point = pose.input_pin + (1 / linkage.coupler) * (coupler * linkage.point);
  return pose;
}

GrashofKind grashof_kind(const FourBar& linkage) {
  constexpr double rounding = 1e-12;
  const std::array<double, 4> lengths{norm(linkage.b - linkage.a), linkage.input, linkage.coupler, linkage.output};
  const auto [shortest, longest] = std::minmax_element(lengths.begin(), lengths.end());
  const double sum = lengths[0] + lengths[1] + lengths[2] + lengths[3];
  const double spare = sum - 2 * (*shortest + *longest);
  if (std::abs(spare) <= rounding * sum) return GrashofKind::change_point;
  if (spare < 0.0) return GrashofKind::triple_rocker;
  constexpr std::array by_shortest{GrashofKind::double_crank, GrashofKind::crank_rocker, GrashofKind::double_rocker,
                                   GrashofKind::rocker_crank};
  return by_shortest[static_cast<std::size_t>(shortest - lengths.begin())];
}

std::string to_string(GrashofKind kind) {
  switch (kind) {
    case GrashofKind::crank_rocker:
      return "crank-rocker";
    case GrashofKind::double_crank:
      return "double-crank";
    case GrashofKind::rocker_crank:
      return "rocker-crank";
    case GrashofKind::double_rocker:
      return "double-rocker";
    case GrashofKind::triple_rocker:
      return "triple-rocker";
    case GrashofKind::change_point:
      return "change-point";
  }
  return {};
}

std::array<FourBar, 2> roberts_cognates(const FourBar& linkage) {
  const ComplexLength left = as_complex(linkage.point) / linkage.coupler;
  const ComplexLength right = 1.0 - left;
  const Vec2 third = linkage.a + as_vector(left * as_complex(linkage.b - linkage.a));
  return {cognate(linkage.a, third, left, std::abs(left) * linkage.coupler, linkage.input, linkage.output),
          cognate(linkage.b, third, right, std::abs(right) * linkage.coupler, linkage.output, linkage.input)};
}

}  // namespace poise
