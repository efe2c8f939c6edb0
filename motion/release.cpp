#include "motion/release.hpp"

#include "motion/equilibrium_pose.hpp"

namespace poise {

MotionOrigin equilibrium_origin(const MotionModel& model, Seek seek, const std::atomic<bool>* interrupt) {
  const StaticModel statics(model.scene());
  if (statics.mechanism().coordinates() == 0) return {.kind = MotionOrigin::Kind::unloaded};
  SolveOptions options;
  options.seek = seek;
  options.interrupt = interrupt;
  const Equilibrium found = solve(statics, options);
  if (!found.found()) return {.kind = MotionOrigin::Kind::not_found, .why = found.why};
  return {.kind = MotionOrigin::Kind::equilibrium,
          .stability = found.certificate.stability,
          .q = model.to_si(motion_coordinates(model, statics, found.x))};
}

MotionState release(const MotionModel& model, const MotionOrigin& origin, const std::vector<Displacement>& displaced) {
  MotionState still = start_motion(model, {}, origin.q ? &*origin.q : nullptr);
  if (displaced.empty()) return still;
  std::vector<StartValue> wanted;
  for (const Displacement& d : displaced) {
    const double from = d.is_rate ? 0.0 : still.q[static_cast<std::size_t>(d.channel.coordinate)];
    wanted.push_back({d.channel.coordinate, d.is_rate, from + d.value});
  }
  return start_motion(model, wanted, &still.q);
}

}  // namespace poise
