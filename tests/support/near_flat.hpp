#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "solvers/real50.hpp"

namespace poise::test {

/// A point of a mechanism whose only freedoms are the angles t of its cranks:  w = w_0 + sum a exp(i sign t).
struct CrankPoint {
  struct Phasor {
    int freedom;
    int sign;
    Planar<Real50> arm;
  };
  Planar<Real50> constant{};
  std::vector<Phasor> phasors{};
};

/// A random mechanism with more bars than it needs, which moves nevertheless, near a pose in which it lies flat:
/// parallelograms of three to five cranks, ladders of two or three of these, and pairs of scissors under one platform.
/// Springs and loads balance it at a place 3e-4 to 0.05 rad from flat, and it starts beside it. Since its joints repeat
/// each other in every pose, its energy is a function of the angles of its cranks alone, in closed form.
struct NearFlat {
  std::string kind;
  Scene scene;
  std::vector<int> cranks;  ///< bodies: one of each freedom
  /// For each spring of the scene the vector from one end to the other.
  std::vector<CrankPoint> springs;
  CrankPoint push;              ///< of the scene's force, if it has one
  std::vector<double> torques;  ///< on the cranks
  double size = 0.0;            ///< m, of its cranks
  double flat = 0.0;            ///< rad: the angle at which cranks lie flat, up to half turns

  /// dV/dt and d2V/dt2 at the angles t of the cranks.
  struct Derivatives {
    Eigen::Matrix<Real50, Eigen::Dynamic, 1> first;
    Eigen::Matrix<Real50, Eigen::Dynamic, Eigen::Dynamic> second;
  };
  Derivatives derivatives(const std::vector<Real50>& t) const;
  /// Tension of a spring, N.
  Real50 tension(int spring, const std::vector<Real50>& t) const;
};

NearFlat near_flat(std::uint64_t seed);

}  // namespace poise::test
