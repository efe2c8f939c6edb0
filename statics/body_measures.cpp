#include "statics/body_measures.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "statics/body_measures_impl.hpp"

namespace poise {

template double value_of(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);
template std::vector<UnitEffort> unit_efforts(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);

void refuse_pulleys(const Scene& scene, std::string_view what) {
  const auto refuse = [&](const std::string& family, const std::string& name, int line, const Measure& on) {
    const bool has_pulley = std::any_of(on.contacts.begin(), on.contacts.end(),
                                        [](const RopeContact& contact) { return contact.radius > 0.0; });
    if (!has_pulley) return;
    throw InputError(
        fmt::format("{}:{}: {} \"{}\": passes over a pulley, off which it may come: {} do not treat that; expected a "
                    "rope over points",
                    scene.file, line, family, name, what));
  };
  for (const Element& element : scene.elements) refuse(element.family(), element.name, element.line, element.on);
  for (const Stop& stop : scene.stops) refuse(stop.family(), stop.name, stop.line, stop.on);
}

const RopeContact* untouched_pulley(const Scene& scene, const Measure& measure,
                                    const std::vector<BodyPose<double>>& poses) {
  // Where the rope is straight past a pulley it just touches it.
  constexpr double rounding = 1e-9;
  for (const Measure::Term& term : measure.terms) {
    if (const RopeContact* const found = untouched_pulley(scene, term.measure, poses)) return found;
  }
  Vec2 before{};
  for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
    const Vec2 along = body_measures::rope_part(scene, measure, k, poses).along;
    const RopeContact& contact = measure.contacts[k];
    if (k > 0 && contact.radius > 0.0 && rope_wrap(before, along, contact.turn) < -rounding) return &contact;
    before = along;
  }
  return nullptr;
}

}  // namespace poise
