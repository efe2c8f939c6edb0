#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "statics/paths/path.hpp"
#include "statics/paths/varied_pair.hpp"

namespace poise {

/// A fold: two equilibria meet there, and there are none of both on one side of the curve.
struct FoldPoint {
  double first = 0.0, second = 0.0;  ///< the numbers, SI
  std::vector<double> x;             ///< scaled coordinates of VariedPair::model_at()
  /// w^T (R_uu v v), J: how the force along the direction v in which the equilibria meet grows with the square of the
  /// way. v has length 1 in rad and mechanism sizes. Without follower loads it is the third derivative of the energy
  /// along the closed poses. Its sign is that of v, which is the same all along a curve; zero at cusps.
  double coefficient = 0.0;
  /// Directions, besides v, in which both equilibria are unstable: 0 where one of them is stable; -1 with follower
  /// loads, where they are not counted.
  int unstable_directions = 0;
  std::vector<int> active_stops;   ///< indices of Scene::stops, a driven measure left out
  std::vector<int> slack_springs;  ///< indices of Scene::elements: one-way springs that do not act
};

/// Where two folds meet and end, three equilibria merging in one.
struct FoldCusp {
  FoldPoint at;
  /// Distance of the numbers from the exact ones for the scene as written, and what the rounding of the scene's own
  /// numbers leaves open, both to first order and as parts of the numbers' ranges, the larger of both: from enclosures
  /// e of the equations' residuals at the point, |dp| <= |l^T e|, with l the rows for p and q of the inverse of the
  /// matrix of FoldSystem. Where the curve's place is uncertain along itself does not count: p and q stand still there.
  double error = std::numeric_limits<double>::infinity();
  double rounding_effect = 0.0;

  /// Decimal digits of the ranges that are known: of `error` and of `rounding_effect`, at most 16.
  int digits() const;
};

/// A connected piece of the curve of folds.
struct FoldBranch {
  enum class End {
    range,   ///< one of both numbers reached an end of its range
    closed,  ///< back at the first point, perhaps after whole turns of bodies
    piece,   ///< a stop or a one-way spring comes on or off; beyond it the equilibria do not meet smoothly
    stuck,   ///< no step succeeds, as where a spring has no length and no direction, or the mechanism runs away
    limit,   ///< FoldCurveOptions::most_points
    interrupted,
  };
  std::vector<FoldPoint> points;  ///< in the order of the curve
  std::vector<int> cusps;         ///< on it, indices of FoldCurve::cusps, in that order
  /// How it ends before the first and behind the last point; both `closed` if it does.
  std::array<End, 2> end{End::range, End::range};
  std::array<std::string, 2> why;  ///< one phrase each, for ends but `range` and `closed`
};

struct FoldCurveOptions {
  PathOptions::From from = PathOptions::From::settle;
  /// Values of each number, evenly spaced with both ends of its range, at which path() of the other looks for folds; at
  /// least 2. Folds that no such path meets are not found.
  int slices = 9;
  double spacing = 0.02;     ///< largest distance of neighbouring points: parts of the ranges, rad, mechanism sizes
  int most_points = 10'000;  ///< of all curves
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(double first, double second, int points)> progress{};
};

/// The folds of a scene as two of its numbers change.
struct FoldCurve {
  enum class Status {
    not_started,
    traced,      ///< every curve ended at a range's end, at a change of pieces, or closed
    incomplete,  ///< some curve ended otherwise
    no_fold,     ///< equilibria were found, but no fold of theirs
    no_start,    ///< at no slice was an equilibrium found
    too_large,   ///< more than solvers::Curve::spectrum_limit unknowns
    interrupted
  };
  Status status = Status::not_started;
  std::string why;  ///< one sentence, empty if traced
  std::vector<FoldBranch> curves;
  std::vector<FoldCusp> cusps;
  /// Folds of the slices where a stop or a one-way spring comes on or off, so that the parameter turns at a kink.
  /// Their curves are not followed.
  int kinks = 0;
  /// Branch points of the slices that neither number disturbs, as by symmetry. Their curves are not followed.
  int symmetric = 0;
  /// Other folds and branch points of the slices from which no curve could be begun, as where several meet.
  int failed = 0;
  int slices_without_start = 0;
  int steps = 0;
  double microseconds = 0.0;
};

/// The curve of folds in the plane of two numbers of a scene,
///
///   F(x, p, q) + J^T y = 0,   c(x, p, q) = 0,   g_s = bound of each active stop s,   and their derivative by (x, y)
///   singular,
///
/// followed by pseudo-arclength in (x, p, q) through its cusps, from the folds and branch points that path() meets at
/// some values of either number (solvers/fold_system.hpp). Throws nothing: every failure is a status.
FoldCurve fold_curve(const VariedPair& pair, const FoldCurveOptions& options = {});

}  // namespace poise
