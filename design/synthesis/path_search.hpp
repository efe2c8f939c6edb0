#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "design/synthesis/path_motion.hpp"
#include "design/synthesis/path_problem.hpp"

namespace poise {

struct PathSearchOptions {
  std::uint64_t seed = 1;
  int starts = 300;
  int jobs = 0;           ///< threads; 0: as many as there are cores. The answer is the same for any number.
  std::size_t kept = 40;  ///< linkages at most, the best
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(std::size_t done)> progress{};  ///< after every start; by one thread at a time
};

/// A linkage whose coupler point passes the points, or comes near to them. SI.
struct PathSolution {
  PathVector x{};
  std::vector<PathVisit> visits{};  ///< at the points
  CrankRange range{};
  double largest = 0.0, rms = 0.0;  ///< distances of the coupler point from the points
  /// Of a curve: distances of places on it from the coupler curve, and of places on that from the curve, both together.
  double curve_largest = 0.0, curve_rms = 0.0;
  bool converged = true;  ///< the fit ended; one that did not, in a flat valley, could come nearer still
  PathDefects defects{};
  double transmission = 0.0;  ///< least_transmission()
};

struct PathAnswer {
  /// Those without a defect first, then by their error (those within the tolerance have none), then by the angle of
  /// transmission, the largest first, then by the sum of their links. Linkages that draw the same curve (Roberts) are
  /// listed once where their pivots are not given: as the one of the six (with either link as the crank) that is best
  /// in this order, of those that keep the angles of their cranks where these are given. Fits that did not end are left
  /// out behind the best one that did.
  std::vector<PathSolution> solutions{};
  int starts = 0;     ///< searches made
  int converged = 0;  ///< fits that ended at a linkage that keeps the limits: a minimum, or all points passed
  int within = 0;     ///< different linkages that pass all points within the tolerance
  bool interrupted = false;
};

/// Searches from random starts by least squares. That no others exist is not known.
PathAnswer search_paths(const PathProblem& problem, const PathSearchOptions& options);

/// The six ways to draw the same curve by a four-bar: itself and its two cognates, and these with the output link as
/// the crank.
std::vector<FourBar> same_curve(const FourBar& linkage);

}  // namespace poise
