#pragma once

// Steps along a curve of equilibria or folds (path_tracer.cpp, fold_tracer.cpp): rad, mechanism sizes, parts of the
// range.

namespace poise::tracing {

inline constexpr double shortest_step = 1e-9;
inline constexpr double largest_correction = 0.1;  ///< of a predicted point, in steps
inline constexpr double usual_correction = 0.02;
inline constexpr double largest_turn = 0.3;  ///< between the tangents at the ends of a step, rad
inline constexpr double usual_turn = 0.1;
inline constexpr double largest_deviation = 0.05;  ///< of points within a step from the interpolated ones, in steps
inline constexpr double overrun = 1e-12;           ///< of a stop or a free length, that is no event yet
inline constexpr double same_point = 1e-6;
inline constexpr double same_pose = 1e-9;   ///< of forces and measures after whole turns
inline constexpr double standstill = 1e-9;  ///< rate of the parameter below which it does not vary

}  // namespace poise::tracing
