#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "design/synthesis/path_models.hpp"

namespace poise {

/// Which angles of the crank let a linkage close: those at which the cosine of the angle from `zero` is in
/// [least, greatest]. Of a four-bar from the line of its pivots, by its diagonal, which is from |coupler - output| to
/// coupler + output long; of a slider-crank from the line across that of the slider.
struct CrankRange {
  double zero = 0.0;  ///< rad
  double least = 0.0, greatest = 0.0;

  /// At all angles.
  bool full() const { return least <= -1.0 && greatest >= 1.0; }
  /// In two intervals, mirror images of each other, each of which is a circuit of its own.
  bool divided() const { return least > -1.0 && greatest < 1.0; }
};
CrankRange crank_range(PathLinkage linkage, std::span<const double> x);

/// How a linkage stands where its coupler point is at one of the points.
struct PathVisit {
  double angle = 0.0;  ///< of the crank, rad
  int closure = 1;     ///< as of FourBarPose
};

/// Where the coupler point of a linkage is nearest to places that are on its curve, by intersections of circles.
std::vector<PathVisit> visits_of(PathLinkage linkage, std::span<const double> x, std::span<const Vec2> places);

/// Why a linkage that passes all points still does not go from one to the next, driven by its crank.
struct PathDefects {
  bool circuit = false;       ///< it has to be taken apart and assembled anew between points
  bool branch = false;        ///< it passes a dead point of the crank between points
  bool order = false;         ///< it passes the points in another order
  bool turn = false;          ///< a full turn of the crank is wanted, but not possible
  bool transmission = false;  ///< its angle of transmission is smaller than wanted

  bool any() const { return circuit || branch || order || turn || transmission; }
};
/// Exact for the numbers of the linkage, as doubles: by the intervals of the crank's angle and the closures.
PathDefects defects_of(const CrankRange& range, std::span<const PathVisit> visits, bool order, bool full_turn);
/// "circuit, order"; "none".
std::string to_string(const PathDefects& defects);

/// The smallest angle between coupler and output link (of a slider-crank: between the coupler and the line across that
/// of the slider), as an angle up to a right one: in a full turn of the crank where that is possible, else at the
/// visits.
double least_transmission(PathLinkage linkage, std::span<const double> x, const CrankRange& range,
                          std::span<const PathVisit> visits);

/// So many ways a linkage stands, once round the circuit of a visit: spread evenly where the crank turns fully, denser
/// towards the ends of its interval, near which the coupler point is fast, where it does not.
std::vector<PathVisit> once_round(const CrankRange& range, const PathVisit& from, int count);

}  // namespace poise
