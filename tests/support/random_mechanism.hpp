#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "comparison/random.hpp"
#include "model/scene.hpp"

namespace poise::test {

using comparison::Random;

/// What a random mechanism should be made of. Bodies, pins, slides, pins in slots, welds, bars, springs of every kind,
/// masses, gravity and dead loads are always drawn.
struct Wish {
  int loops = 1;            ///< independent loops, redundant ones counted
  bool followers = false;   ///< one or two forces that follow a body
  bool stops = false;       ///< up to three stops, some of them active
  bool other_laws = false;  ///< curves, gas struts, preloaded springs and bump stops take the place of linear springs
  /// One or two of gears, belts, racks, couplings, cams and ropes, of which those that act on one side only press or
  /// not, and springs and stretching ropes upon such measures.
  bool couplings = false;
  bool pulleys = true;  ///< ropes pass over them, not over points alone
  /// Of the start: rad, or lengths over the length of a typical body. So little that, away from singular poses and
  /// neutral equilibria, the planted equilibrium is the nearest one.
  double disturbance = 0.02;
};

/// A random mechanism with a known equilibrium.
struct PlantedMechanism {
  Scene scene;           ///< its start is the equilibrium disturbed
  Scene in_equilibrium;  ///< the same, starting from the equilibrium itself
  /// Coordinates of the compiled model at the equilibrium and at the disturbed start, rad or m.
  std::vector<double> equilibrium, start;
  /// A body hangs on bars alone. A scene has no guess for them, so that Mechanism::start() is not `start`.
  bool hangs_on_bars = false;
  int loops = 0;
  int redundant = 0;          ///< scalar closure equations that repeat others
  int freedoms = 0;           ///< of the compiled model, 1 to 3
  std::vector<int> pressing;  ///< active stops: indices into Scene::stops
  /// Eigenvalues of the reduced Hessian (of the reduced stiffness where loads follow bodies) at the equilibrium, with
  /// active stops held, in the generator's own units. By finite differences along the motion the joints allow: of
  /// the energy seen in the places of the bodies, or of the forces where loads follow bodies.
  std::vector<std::complex<double>> curvature;
  /// Norm of the inverse of the equilibrium equations' Jacobian in the generator's units: how far unit errors of the
  /// residuals move the equilibrium.
  double sensitivity = 0.0;

  /// Curvatures with a negative real part.
  int falling() const;
};

/// The mechanism of a seed. A tree of bodies grows from the ground by joints of every kind and is closed by dyads,
/// bars, slots and slides drawn around a random pose, so that loops close in it to rounding. One load per remaining
/// freedom, a torque or a force, is then chosen such that the virtual work N^T Q of all loads vanishes in that pose.
/// Drawn again, from the same stream, is what comes near a singular pose or a neutral equilibrium: there a disturbed
/// start would not single out the planted equilibrium, nor would 16 digits hold 12.
PlantedMechanism plant_mechanism(std::uint64_t seed, const Wish& wish);

}  // namespace poise::test
