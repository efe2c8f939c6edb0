#include "benchmarks/hand_four_bar.hpp"

#include <algorithm>
#include <cmath>

namespace poise::benchmarks {
namespace {

constexpr double link4 = 4.0, link6 = 6.0, link7 = 7.0, ground = 11.515108;  // in
constexpr double push4 = -13.29, lift6 = 50.0, push7 = 10.0;                 // lbf
constexpr double step_tolerance = 1e-9;
constexpr int most_steps = 50;

}  // namespace

HandFourBarResult solve_four_bar_by_hand(const std::array<double, 3>& start) {
  HandFourBarResult result;
  double t4 = start[0], t6 = start[1], t7 = start[2];
  while (result.iterations < most_steps && !result.converged) {
    const double c4 = std::cos(t4), s4 = std::sin(t4);
    const double c6 = std::cos(t6), s6 = std::sin(t6);
    const double c7 = std::cos(t7), s7 = std::sin(t7);
    // N and its derivatives need only sines and cosines of differences.
    const double n4 = s7 * c6 - c7 * s6, n6 = s4 * c7 - c4 * s7, n7 = s6 * c4 - c6 * s4;
    const double m4 = c7 * c6 + s7 * s6, m6 = c4 * c7 + s4 * s7, m7 = c6 * c4 + s6 * s4;
    // Generalized forces over link lengths, and their derivatives.
    const double q4 = lift6 * c4 - 0.5 * push4 * s4, p4 = -lift6 * s4 - 0.5 * push4 * c4;
    const double q6 = 0.5 * lift6 * c6, p6 = -0.5 * lift6 * s6;
    const double q7 = 0.5 * push7 * s7, p7 = 0.5 * push7 * c7;

    const double gap_x = link4 * c4 + link6 * c6 + link7 * c7 - ground;
    const double gap_y = link4 * s4 + link6 * s6 + link7 * s7;
    const double work = n4 * q4 + n6 * q6 + n7 * q7;
    const double x4 = -link4 * s4, x6 = -link6 * s6, x7 = -link7 * s7;
    const double y4 = link4 * c4, y6 = link6 * c6, y7 = link7 * c7;
    const double w4 = n4 * p4 + m6 * q6 - m7 * q7;
    const double w6 = n6 * p6 + m7 * q7 - m4 * q4;
    const double w7 = n7 * p7 + m4 * q4 - m6 * q6;

    // Cramer's rule by cross products of the rows (x), (y), (w).
    const double z4 = x6 * y7 - x7 * y6, z6 = x7 * y4 - x4 * y7, z7 = x4 * y6 - x6 * y4;
    const double scale = -1.0 / (z4 * w4 + z6 * w6 + z7 * w7);
    const double d4 = scale * (gap_x * (y6 * w7 - y7 * w6) + gap_y * (w6 * x7 - w7 * x6) + work * z4);
    const double d6 = scale * (gap_x * (y7 * w4 - y4 * w7) + gap_y * (w7 * x4 - w4 * x7) + work * z6);
    const double d7 = scale * (gap_x * (y4 * w6 - y6 * w4) + gap_y * (w4 * x6 - w6 * x4) + work * z7);
    t4 += d4;
    t6 += d6;
    t7 += d7;
    ++result.iterations;
    result.converged = std::max({std::abs(d4), std::abs(d6), std::abs(d7)}) <= step_tolerance;
  }
  result.angles = {t4, t6, t7};
  return result;
}

}  // namespace poise::benchmarks
