#include "motion/body_motion.hpp"

#include "statics/bodies/body_measures.hpp"

namespace poise {

std::vector<BodyMotion> body_motions(const MotionModel& model, const std::vector<double>& x,
                                     const std::vector<double>& v, const std::vector<double>& a) {
  const Layout& layout = model.layout();
  const double size = model.scales().length;
  const std::vector<BodyPose<double>> poses = model.poses(x);
  // Value, rate and acceleration of a coordinate.
  struct Moving {
    double at = 0.0, rate = 0.0, acceleration = 0.0;
  };
  const auto moving = [&](int t) -> Moving {
    if (t < 0) return {};
    if (t >= layout.kept) return {layout.coordinates[t].start, 0.0, 0.0};
    return {x[t], v[t], a[t]};
  };
  std::vector<BodyMotion> out(layout.links.size());
  for (int i : layout.tree_order) {
    const Link& link = layout.links[i];
    BodyMotion& motion = out[i];
    motion.pose = poses[i];
    const Moving angle = moving(link.frame);
    motion.rate = angle.rate;
    motion.angular_acceleration = angle.acceleration;
    if (link.parent >= 0) {
      motion.velocity = out[link.parent].velocity;
      motion.acceleration = out[link.parent].acceleration;
    }
    for (const Arm& arm : link.arms) {
      if (arm.coordinate < 0) continue;
      const Coordinate& c = layout.coordinates[arm.coordinate];
      const bool is_angle = c.kind == Coordinate::Kind::angle;
      const int frame = is_angle ? arm.coordinate : c.frame;
      const Moving turn = moving(frame);
      const Moving along = is_angle ? Moving{1.0, 0.0, 0.0} : moving(arm.coordinate);
      // The arm s u with u' = i w u:  velocity  (s' + i w s) u,  acceleration  (s'' - w^2 s + i (w' s + 2 w s')) u.
      Vec2 u = size * model.mechanism().phasors().coefficient(arm);
      if (frame >= 0) u = u * unit(turn.at);
      motion.velocity += Vec2{along.rate, turn.rate * along.at} * u;
      motion.acceleration += Vec2{along.acceleration - turn.rate * turn.rate * along.at,
                                  turn.acceleration * along.at + 2 * turn.rate * along.rate} *
                             u;
    }
  }
  return out;
}

std::vector<BodyPose<double>> poses_of(const std::vector<BodyMotion>& motions) {
  std::vector<BodyPose<double>> poses;
  poses.reserve(motions.size());
  for (const BodyMotion& motion : motions) poses.push_back(motion.pose);
  return poses;
}

// The power of a unit effort on the measure.
double rate_of(const Scene& scene, const std::vector<BodyMotion>& motions, const Measure& measure) {
  double rate = 0.0;
  for (const UnitEffort& effort : unit_efforts(scene, measure, poses_of(motions))) {
    const BodyMotion& a = motions[effort.body_a];
    const BodyMotion& b = motions[effort.body_b];
    rate += dot(effort.force, b.velocity_at(effort.b) - a.velocity_at(effort.a)) + effort.moment * (b.rate - a.rate);
  }
  return rate;
}

}  // namespace poise
