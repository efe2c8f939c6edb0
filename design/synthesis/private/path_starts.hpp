#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "design/synthesis/path_models.hpp"
#include "solvers/random_stream.hpp"

namespace poise {

/// A linkage with the angles of its crank at the points: where a fit begins.
struct PathStart {
  PathVector x{};
  std::vector<double> t{};
  std::vector<int> closures{};
  double misfit = 0.0;  ///< sum of squares of the distances
};

/// The best of so many random linkages, each moved, turned and scaled so that its coupler point is near to the points
/// at random angles of the crank that follow each other, or at those given. The points of `task` have the size 1. Empty
/// where none reached them.
std::optional<PathStart> drawn_start(const PathFit::Task& task, const std::vector<double>& crank,
                                     solvers::RandomStream& random, int draws);

/// Closed curves by their Fourier descriptors (C. T. Zahn, R. Z. Roskies, "Fourier descriptors for plane closed
/// curves", IEEE Trans. Comput. 21, 1972, in the form of complex coefficients). Both curves are read at places spread
/// evenly by length; with c_k the coefficients of one and d_k those of the other the least sum of squares over moves,
/// turns, scales and begins is
///
///   sum |c_k|^2 - max over tau of |sum c_k conj(d_k) e^(-i k tau)|^2 / sum |d_k|^2.
///
/// Of `linkages` random linkages, the same for a seed, those `kept` whose coupler curves fit best, best first, moved
/// onto the curve. The points of `task` are spread evenly over the curve.
std::vector<PathStart> curve_starts(const PathFit::Task& task, std::uint64_t seed, int linkages, int kept);

}  // namespace poise
