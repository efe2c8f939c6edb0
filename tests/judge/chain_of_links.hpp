#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace poise::judge {

// Terms of the equations of motion of a chain of links that hangs on the ground,  M(q) q'' = Q(q, q'),  in the angles q
// of the links with the ground. Links have length, center (its distance from the pin before), mass and inertia (about
// their centres).

/// The first moment of a link about the pin before, with the masses of the links behind it at its end.
template <class Link>
double moment_of_chain(const std::vector<Link>& links, std::size_t k) {
  double behind = 0.0;
  for (std::size_t j = k + 1; j < links.size(); ++j) behind += links[j].mass;
  return links[k].mass * links[k].center + links[k].length * behind;
}

/// What couples the links i <= j: M_ij = coupling cos(q_j - q_i).
template <class Link>
double coupling_of_chain(const std::vector<Link>& links, std::size_t i, std::size_t j) {
  const Link& b = links[j];
  if (i != j) return links[i].length * moment_of_chain(links, j);
  double behind = 0.0;
  for (std::size_t k = j + 1; k < links.size(); ++k) behind += links[k].mass;
  return b.inertia + b.mass * b.center * b.center + b.length * b.length * behind;
}

template <class Square, class Link, class Coordinates>
Square mass_of_chain(const std::vector<Link>& links, const Coordinates& q) {
  Square out(q.size(), q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    for (Eigen::Index j = i; j < q.size(); ++j) {
      out(i, j) = out(j, i) =
          coupling_of_chain(links, static_cast<std::size_t>(i), static_cast<std::size_t>(j)) * std::cos(q[j] - q[i]);
    }
  }
  return out;
}

/// Takes the centrifugal terms of link i from its Q.
template <class Link, class Coordinates>
void take_centrifugal(const std::vector<Link>& links, Eigen::Index i, const Coordinates& q, const Coordinates& v,
                      double& force) {
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    const auto [low, high] = std::minmax(i, j);
    if (i == j) continue;
    force -= coupling_of_chain(links, static_cast<std::size_t>(low), static_cast<std::size_t>(high)) *
             std::sin(q[i] - q[j]) * v[j] * v[j];
  }
}

}  // namespace poise::judge
