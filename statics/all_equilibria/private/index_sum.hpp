#pragma once

#include <optional>

#include "statics/model/static_model.hpp"

namespace poise {

/// The sum over all equilibria of (-1)^(number of unstable directions), where it is known and they are not degenerate:
/// by the theorem of Poincare and Hopf the Euler characteristic of the space of all poses, where that is a closed
/// manifold and the force is continuous on it.
///
/// Known of mechanisms of angles alone, without stops, without springs that tell turns apart, and without forces along
/// distances that could vanish, in which every loop is a polygon of its own: with edges l_1 .. l_n (of which one may be
/// fixed) that no choice of signs lets add up to zero the poses of a polygon form a closed manifold of dimension n - 3
/// with the Betti numbers  b_k = a_k + a_(n-3-k),  a_k the number of sets of k + 1 edges, the longest among them, that
/// are shorter together than the others (M. Farber, D. Schuetz, "Homology of planar polygon spaces", 2007). An angle
/// outside all loops adds a circle, and the sum is 0: of an open chain, say.
std::optional<long> index_sum(const StaticModel& model);

}  // namespace poise
