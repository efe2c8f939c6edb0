#include "statics/body_measures.hpp"

#include "statics/body_measures_impl.hpp"

namespace poise {

template double value_of(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);
template std::vector<UnitEffort> unit_efforts(const Scene&, const Measure&, const std::vector<BodyPose<double>>&);

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
