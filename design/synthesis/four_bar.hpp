#pragma once

#include <array>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "model/planar.hpp"

namespace poise {

/// A four-bar linkage in the plane, lengths in m, angles in rad: input link from pivot `a`, output link from pivot `b`,
/// and a coupler between their pins with a point on it.
struct FourBar {
  Vec2 a{}, b{};                                    ///< pivots of the ground
  double input = 0.0, coupler = 0.0, output = 0.0;  ///< lengths between pins, > 0
  /// The coupler point in a frame at the pin of the input link with x towards the pin of the output link.
  Vec2 point{};
};

/// The way a four-bar closes: +1 where the turn from the diagonal (pin of the input to b) to the coupler is
/// counter-clockwise, else -1.
struct FourBarPose {
  Vec2 input_pin{}, output_pin{}, point{};
  double input_angle = 0.0, coupler_angle = 0.0, output_angle = 0.0;
};

/// The pose at an angle of the input link; empty where the links do not reach.
std::optional<FourBarPose> pose_of(const FourBar& linkage, double input_angle, int closure);

/// Which links can turn fully (Grashof): shortest + longest against the other two.
enum class GrashofKind {
  crank_rocker,   ///< the input turns fully
  double_crank,   ///< input and output do
  rocker_crank,   ///< the output does
  double_rocker,  ///< the coupler does
  triple_rocker,  ///< none does
  change_point    ///< shortest + longest equals the other two, to rounding
};
GrashofKind grashof_kind(const FourBar& linkage);
/// "crank-rocker", ...
std::string to_string(GrashofKind kind);

/// The two other four-bars whose coupler points draw the same curve (Roberts and Chebyshev): the left one from pivot
/// `a` and the third pivot, the right one from pivot `b` and the third pivot. Where the point is at a pin of the
/// coupler one of them has links of length 0.
std::array<FourBar, 2> roberts_cognates(const FourBar& linkage);

}  // namespace poise
