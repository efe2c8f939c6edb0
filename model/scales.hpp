#pragma once

namespace poise {

/// Units in which a mechanism's numbers are of order one. Powers of two, so that scaling is exact.
struct Scales {
  double length = 1.0;  ///< m: about the size of the mechanism
  double force = 1.0;   ///< N: about the sum of all loads, or, without loads, the largest spring force

  double energy() const { return length * force; }

  // Factors that turn SI into these units.
  double per_length() const { return 1.0 / length; }
  double per_force() const { return 1.0 / force; }
  double per_energy() const { return per_length() * per_force(); }
  double per_stiffness() const { return length * per_force(); }
};

}  // namespace poise
