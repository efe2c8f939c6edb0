#include "motion/body_motion.hpp"

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
    motion.spin_up = angle.acceleration;
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
      Vec2 u = size * coefficient<double>(arm);
      if (frame >= 0) u = u * unit(turn.at);
      motion.velocity += Vec2{along.rate, turn.rate * along.at} * u;
      motion.acceleration += Vec2{along.acceleration - turn.rate * turn.rate * along.at,
                                  turn.acceleration * along.at + 2 * turn.rate * along.rate} *
                             u;
    }
  }
  return out;
}

double distance_rate(const Scene& scene, const std::vector<BodyMotion>& motions, const PointRef& a, const PointRef& b) {
  const BodyMotion& first = motions[a.body];
  const BodyMotion& second = motions[b.body];
  const Vec2 d = second.pose.world(scene.local(b)) - first.pose.world(scene.local(a));
  const double r = norm(d);
  if (r == 0.0) return 0.0;
  return dot(d, second.velocity_of(scene.local(b)) - first.velocity_of(scene.local(a))) / r;
}

}  // namespace poise
