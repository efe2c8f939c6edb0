#pragma once

#include <string>
#include <vector>

#include "statics/bodies/reaction.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// Bounds within which free-body statics calls a pose an equilibrium.
struct CheckTolerances {
  double closure = 1e-9;    ///< largest gap of a joint / size of the mechanism
  double imbalance = 1e-9;  ///< largest unbalanced force, or moment / size, of a body / largest force on any body
  double stop = 1e-8;       ///< stop overrun, rad or / size
};

/// Result of free-body statics, a second opinion beside the certificate: other mechanics, in other code, in double.
struct Check {
  double closure_error = 0.0;  ///< m: largest gap of any joint, from the poses of the bodies
  std::string worst_joint;
  double imbalance = 0.0;  ///< N: largest unbalanced force, or moment / size, of any body
  std::string worst_body;
  double largest_force = 0.0;   ///< N: largest load, spring force or reaction on any body
  double stop_violation = 0.0;  ///< rad, or m / size
  std::string worst_stop;
  bool closed = false;
  bool balanced = false;
  bool stops_kept = false;
  /// Every rope that carries a force lies on all of its pulleys, and every rolling wheel is pressed to its line or
  /// circle.
  bool keeps_contacts = false;
  std::vector<Reaction> reactions;
  std::vector<ElementForce> element_forces;  ///< per element of the scene
  int redundancy = 0;  ///< number of independent states of self-stress (degree of static indeterminacy)

  /// Closed, balanced, within its stops, on its pulleys and with its wheels on what they roll on.
  bool is_equilibrium() const { return closed && balanced && stops_kept && keeps_contacts; }
  /// Why it is not an equilibrium, one sentence; empty if it is.
  std::string objection;
  /// Stops (indices of Scene::stops) that would have to pull, so that they are left alone where a search goes on.
  std::vector<int> pulling;
};

/// Checks the scaled coordinates x of a model by vector statics:
///
/// closure    every joint of the scene, measured between the poses of its two bodies
/// balance    each body cut free under its loads and the reactions of its joints; the reactions are the least-squares
///            solution of all bodies' 3 equations, so what they cannot balance remains as imbalance
///
/// `active`: the stops that act (indices of Scene::stops), for example those of a certificate; without it those that x
/// touches. On the side at which it touches, a stop pushes only: the reactions are those of balance() of
/// statics/bodies/free_bodies.hpp, and where bodies could balance only if one pulled, that is the objection.
///
/// `sharing`: stops at their limit that may take a part of the load of active ones.
Check check(const StaticModel& model, const std::vector<double>& x, const CheckTolerances& tolerances = {},
            const std::vector<int>* active = nullptr, const std::vector<int>& sharing = {});

}  // namespace poise
