#pragma once

#include <vector>

#include <Eigen/Core>

#include "statics/model/static_model.hpp"

namespace poise {

/// An equilibrium of one model: scaled coordinates, and multipliers of the rows that hold.
struct SegmentEnd {
  const StaticModel& model;
  const std::vector<double>& x;
  const Eigen::VectorXd& y;
};

/// Proves in interval arithmetic that an equilibrium of one model goes over into that of another. With z = (x, y) and
///   G_A(z) = (F + J^T y, c - b)
/// of the model A at the beginning, G_B of the other, both with the same rows c, of which some are stops at their
/// limits b, and with d = z_B - z_A: for every 0 <= t <= 1
///   (1 - t) G_A(z) + t G_B(z) = 0
/// has exactly one solution in z_A + t d + [-e, e], its derivative by z is regular there, the stops that hold press on
/// their side, and all others are between their limits. So the solutions are one smooth curve without a fold or branch
/// point, and as many directions are unstable at its end as at its beginning. Where numbers enter G affinely, these are
/// the equilibria of all numbers between. By Krawczyk's operator (R. E. Moore, R. B. Kearfott, M. J. Cloud,
/// "Introduction to Interval Analysis", 2009, section 8.3) with the derivatives D_A, D_B over the tube Z of these
/// boxes,
///   |C r| + |I - C D| e < e,   r in hull(G_A(z_A), G_B(z_B)) + [0, 1/4] (D_A(Z) - D_B(Z)) d,   D = hull(D_A, D_B)(Z),
/// since t (1 - t) is what the mean value theorem leaves of both residuals at z_A + t d.
///
/// `rows`: of the constraint vector; `side`: per stop -1 at its lower limit, 1 at the upper one, 0 free; `middle`:
/// d G / d z about half way, from which C is made. The models have the same coordinates, rows and scales. One-way
/// springs may become slack or act within the segment.
bool segment_is_proved(const SegmentEnd& begin, const SegmentEnd& end, const std::vector<int>& rows,
                       const std::vector<signed char>& side, const Eigen::MatrixXd& middle);

}  // namespace poise
