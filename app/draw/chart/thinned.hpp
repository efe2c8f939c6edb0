#pragma once

#include <cstddef>
#include <vector>

namespace poise::app {

/// Which points of a curve to draw so that the drawing looks the same: of each of most/4 runs of equal length the
/// points with the least and largest x and the least and largest y, in their order; all where there are no more than
/// `most` (at least 4). What is not finite counts as a gap, and one of each run is kept.
std::vector<std::size_t> thinned(const std::vector<double>& x, const std::vector<double>& y, std::size_t most);

/// At most `most` of n points, evenly spaced: a cloud of points keeps its density where thinned() would keep its rim.
std::vector<std::size_t> every_kth(std::size_t n, std::size_t most);

}  // namespace poise::app
