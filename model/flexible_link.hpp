#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// Nodes and weights of an element of a flexible link, on 0 .. 1.
namespace beam_element {
inline constexpr int nodes = 4;
inline const std::array<double, nodes> place{0.0, 0.5 - 0.5 / std::sqrt(5.0), 0.5 + 0.5 / std::sqrt(5.0), 1.0};
inline constexpr std::array<double, nodes> weight{1.0 / 12, 5.0 / 12, 5.0 / 12, 1.0 / 12};
inline const std::array<double, 3> gauss_place{0.5 - std::sqrt(15.0) / 10, 0.5, 0.5 + std::sqrt(15.0) / 10};
inline constexpr std::array<double, 3> gauss_weight{5.0 / 18, 8.0 / 18, 5.0 / 18};

/// The polynomial of Lagrange that is 1 at node k and 0 at the others, and its derivative.
double lagrange(int k, double x);
double lagrange_slope(int k, double x);
}  // namespace beam_element

/// A flexible link that takes the place of one body of a scene. Its joints and springs are to be added to the scene
/// after all others, so that those of a scene file keep their places.
struct FlexibleChain {
  FlexibleLink link;             ///< its springs are not known yet
  std::vector<PointRef> points;  ///< where the points of the body are now, in their order
  std::vector<Joint> joints;     ///< pins between neighbouring bodies
  std::vector<Element> springs;
};

/// Makes a body with a section, whose points are all on its line, flexible: an inextensible beam of Euler and Bernoulli
/// that turns by phi(s) against its straight shape, of any size ("elastica").
///
/// The line is cut into elements between its points, `elements` in all where there are so many or more than stretches.
/// Over each, of length h, phi is the cubic through its values at the four nodes of Gauss and Lobatto, xi = 0,
/// (1 -+ 1/sqrt 5)/2, 1 with the weights w = 1/12, 5/12, 5/12, 1/12. Neighbours share the node between them.
///
///   place      r(h) - r(0) = sum_k w_k h d exp(i phi_k),  d the direction of the line
///     so that each node is a rigid body of length w_k h, and neighbours are pinned together: a chain.
///   weight     integral of r over the element = h r(0) + h^2 sum_k w_k (1 - xi_k) d exp(i phi_k)
///     which the bodies have with masses in proportion to w_k and centres of mass h (1 - xi_k - sum_{j > k} w_j) behind
///     their beginning, and moments of inertia, in proportion to w_k too, with which a straight element turns as a bar.
///   energy     E I / 2 integral of phi'^2 ds, exact by three points of Gauss: a spring on each of
///     sum_k l_k'(xi) phi_k, l_k the polynomials of Lagrange, with the stiffness E I w / h, w and xi on 0 .. 1.
///
/// Ends of elements and what acts there converge as h^6, frequencies as h^4. The first body has its place and direction
/// at the first point of the line, and bodies of the chain are not turned against each other where the link is
/// straight.
FlexibleChain make_flexible(Scene& scene, int body, int elements);

}  // namespace poise
