#include "statics/bodies/body_measures.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "model/couplings.hpp"
#include "statics/bodies/body_forces.hpp"

namespace poise {

template double value_of(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);
template std::vector<UnitEffort> unit_efforts(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);

namespace {

bool has_pulley(const Measure& on) {
  return std::any_of(on.contacts.begin(), on.contacts.end(),
                     [](const RopeContact& contact) { return contact.radius > 0.0; }) ||
         std::any_of(on.terms.begin(), on.terms.end(),
                     [](const Measure::Term& term) { return has_pulley(term.measure); });
}

}  // namespace

void refuse_contacts(const Scene& scene, std::string_view what) {
  const auto refuse = [&](const auto& item) {
    if (!has_pulley(item.on)) return;
    throw InputError(
        fmt::format("{}:{}: {} \"{}\": passes over a pulley, off which it may come: {} do not treat that; expected a "
                    "rope over points",
                    scene.file, item.line, item.family(), item.name, what));
  };
  std::for_each(scene.elements.begin(), scene.elements.end(), refuse);
  std::for_each(scene.stops.begin(), scene.stops.end(), refuse);
  for (const Stop& stop : scene.stops) {
    if (!stop.table.starts_with("rolling") || coupling_kind(stop)->row > 0) continue;
    throw InputError(fmt::format(
        "{}:{}: {} \"{}\": may lift off: {} do not treat that; expected a rack or a gear, which is held on both sides",
        scene.file, stop.line, stop.family(), stop.name, what));
  }
}

void refuse_blades(const Scene& scene, std::string_view what) {
  if (scene.blades.empty()) return;
  const Blade& blade = scene.blades.front();
  throw InputError(fmt::format(
      "{}:{}: blade \"{}\": {} do not treat blades, which hold rates and take forces at rest too; expected a scene "
      "without them",
      scene.file, blade.line, blade.name, what));
}

const RopeContact* untouched_pulley(const Scene& scene, const Measure& measure,
                                    const std::vector<BodyPose<double>>& poses) {
  // Where the rope is straight past a pulley it just touches it.
  constexpr double rounding = 1e-9;
  for (const Measure::Term& term : measure.terms) {
    if (const RopeContact* const found = untouched_pulley(scene, term.measure, poses)) return found;
  }
  const BodyForces bodies(scene, poses);
  Vec2 before{};
  for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
    const Vec2 along = bodies.rope_part(measure, k).along;
    const RopeContact& contact = measure.contacts[k];
    if (k > 0 && contact.radius > 0.0 && rope_wrap(before, along, contact.turn) < -rounding) return &contact;
    before = along;
  }
  return nullptr;
}

std::string rope_without_length(const Scene& scene, const std::vector<BodyPose<double>>& poses, double slack) {
  const BodyForces bodies(scene, poses);
  std::string out;
  const auto look_at = [&](const auto& item) {
    for (std::size_t k = 0; out.empty() && k + 1 < item.on.contacts.size(); ++k) {
      const RopeContact& a = item.on.contacts[k];
      const RopeContact& b = item.on.contacts[k + 1];
      const double rims = std::abs(b.turn * b.radius - a.turn * a.radius);
      const double apart = norm(bodies.world(b.at) - bodies.world(a.at));
      if (rims == 0.0 || apart > rims * (1 + slack)) continue;
      const bool first_inside = a.radius < b.radius;
      out = fmt::format("{} \"{}\" has no straight part: its {} \"{}\" reaches the rim of its pulley \"{}\"",
                        item.family(), item.name, std::min(a.radius, b.radius) > 0 ? "pulley" : "point",
                        scene.name_of(first_inside ? a.at : b.at), scene.name_of(first_inside ? b.at : a.at));
    }
  };
  std::for_each(scene.elements.begin(), scene.elements.end(), look_at);
  std::for_each(scene.stops.begin(), scene.stops.end(), look_at);
  return out;
}

}  // namespace poise
