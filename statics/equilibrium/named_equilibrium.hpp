#pragma once

#include <memory>
#include <optional>
#include <string>

#include "statics/equilibrium/equilibrium.hpp"
#include "statics/model/named_pose.hpp"

namespace poise {

/// An equilibrium read by the names of the scene, in SI or, after in() and in_scene_units(), in other units:
///
///   const NamedEquilibrium rest = solve(scene, {.seek = Seek::stable});
///   if (rest.found()) std::printf("%g deg\n", rest.in({.angle = "deg"}).angle("arm"));
///
/// Where nothing was found the values are those of the pose at which the search ended.
class NamedEquilibrium : public NamedPose {
 public:
  NamedEquilibrium(const StaticModel& model, Equilibrium equilibrium);

  /// Status, stability, residuals and all else of the solver and the check; SI.
  const Equilibrium& result() const { return *equilibrium_; }
  bool found() const { return equilibrium_->found(); }

  /// T of a force element in equilibrium, named as in measure(): positive where it tends to diminish its measure. The
  /// tension of a spring between points, N; for an angle the opposite of the torque on its second body, N m. 0 for what
  /// resists motion only.
  double force(const std::string& element) const;
  /// What a joint or bar transmits: force (N, world directions) and moment (N m) on the body of its second point, at
  /// the point `at` (m); the opposite acts on the body of its first point. Axial force of a bar (N): tension positive.
  Reaction reaction(const std::string& joint) const;
  /// The same of a stop; zero while it is not in contact.
  Reaction stop_reaction(const std::string& stop) const;
  /// Potential energy V, J; dead loads count from an arbitrary zero. Empty with follower loads, which have none.
  std::optional<double> energy() const;

  NamedEquilibrium in(const UnitNames& names) const { return in(units_of(names)); }
  NamedEquilibrium in(const Units& units) const;
  NamedEquilibrium in_scene_units() const { return in(scene().units); }

 private:
  /// The reaction so called, in units(); empty where the check has none.
  std::optional<Reaction> find_reaction(int Reaction::*index, int of) const;

  std::shared_ptr<const Equilibrium> equilibrium_;
};

/// Finds an equilibrium from the scene's start, and checks it. Throws InputError where the scene contradicts itself, or
/// where the mechanism cannot be assembled or has no degree of freedom left; that a search failed is the result's
/// status.
NamedEquilibrium solve(Scene scene, const SolveOptions& options = {});

}  // namespace poise
