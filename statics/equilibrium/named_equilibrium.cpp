#include "statics/equilibrium/named_equilibrium.hpp"

#include <utility>

#include <fmt/format.h>

#include "statics/proof/enclosed_reactions.hpp"

namespace poise {

NamedEquilibrium::NamedEquilibrium(const StaticModel& model, Equilibrium equilibrium)
    : NamedPose(model.scene(), model.poses(equilibrium.x)),
      equilibrium_(std::make_shared<Equilibrium>(std::move(equilibrium))) {}

double NamedEquilibrium::force(const std::string& element) const {
  const Element& found = find_element(element);
  const std::vector<ElementForce>& forces = result().check.element_forces;
  const auto place = static_cast<std::size_t>(&found - scene().elements.data());
  return shown(place < forces.size() ? forces[place].value : reading_of(found).force, found.on.effort_dimension());
}

Reaction NamedEquilibrium::reaction(const std::string& joint) const {
  const auto index = static_cast<int>(&find_joint(joint) - scene().joints.data());
  const std::optional<Reaction> found = find_reaction(&Reaction::joint, index);
  if (!found) {
    throw InputError(fmt::format("{}: expected an equilibrium, the result is \"{}\"; joint \"{}\" has no known force",
                                 scene().file, to_string(result().status), joint));
  }
  return *found;
}

Reaction NamedEquilibrium::stop_reaction(const std::string& stop) const {
  const auto index = static_cast<int>(&find_stop(stop) - scene().stops.data());
  return find_reaction(&Reaction::stop, index).value_or(Reaction{.name = stop, .kind = "stop", .stop = index});
}

std::optional<double> NamedEquilibrium::energy() const {
  if (!result().energy) return std::nullopt;
  return shown(*result().energy, dimension::torque);
}

NamedEquilibrium NamedEquilibrium::in(const Units& units) const {
  NamedEquilibrium other = *this;
  other.set_units(units);
  return other;
}

std::optional<Reaction> NamedEquilibrium::find_reaction(int Reaction::*index, int of) const {
  for (const Reaction& reaction : result().check.reactions) {
    if (reaction.*index != of) continue;
    Reaction converted = reaction;
    converted.at = shown(reaction.at, dimension::length);
    converted.force = shown(reaction.force, dimension::force);
    converted.moment = shown(reaction.moment, dimension::torque);
    converted.axial = shown(reaction.axial, dimension::force);
    converted.radius = force_radius_in_unit(reaction, dimension::force.unit(units()));
    converted.moment_radius = radius_in_unit(reaction.moment_radius, reaction.moment, dimension::torque.unit(units()));
    return converted;
  }
  return std::nullopt;
}

NamedEquilibrium solve(Scene scene, const SolveOptions& options) {
  const StaticModel model(std::move(scene));
  return {model, solve(model, options)};
}

}  // namespace poise
