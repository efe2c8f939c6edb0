#include "statics/body_measures.hpp"

namespace poise {
namespace {

Vec2 world(const Scene& scene, const std::vector<BodyPose<double>>& poses, PointRef p) {
  return poses[p.body].world(scene.local(p));
}

Vec2 axis_of(const Joint& joint, const std::vector<BodyPose<double>>& poses) {
  return joint.direction() * unit(poses[joint.a.body].angle);
}

void add_efforts(const Scene& scene, const Measure& measure, const std::vector<BodyPose<double>>& poses, double factor,
                 std::vector<UnitEffort>& out) {
  switch (measure.kind) {
    case Measure::Kind::angle:
      out.push_back(
          {measure.body_a, measure.body_b, poses[measure.body_a].origin, poses[measure.body_b].origin, {}, factor});
      break;
    case Measure::Kind::distance: {
      const Vec2 a = world(scene, poses, measure.a);
      const Vec2 b = world(scene, poses, measure.b);
      const double r = norm(b - a);
      out.push_back({measure.a.body, measure.b.body, a, b, r > 0 ? (factor / r) * (b - a) : Vec2{}, 0.0});
      break;
    }
    case Measure::Kind::travel: {
      // Along the line of body a, at the point of body b that slides on it.
      const Joint& joint = scene.joints[measure.joint];
      const Vec2 at = world(scene, poses, joint.b);
      out.push_back({joint.a.body, joint.b.body, at, at, factor * axis_of(joint, poses), 0.0});
      break;
    }
    case Measure::Kind::x:
    case Measure::Kind::y: {
      const Vec2 at = world(scene, poses, measure.b);
      const Vec2 direction = measure.kind == Measure::Kind::x ? Vec2{factor, 0.0} : Vec2{0.0, factor};
      out.push_back({0, measure.b.body, at, at, direction, 0.0});
      break;
    }
    case Measure::Kind::sum:
      for (const Measure::Term& term : measure.terms) {
        add_efforts(scene, term.measure, poses, factor * term.factor, out);
      }
      break;
  }
}

}  // namespace

double value_of(const Scene& scene, const Measure& measure, const std::vector<BodyPose<double>>& poses) {
  switch (measure.kind) {
    case Measure::Kind::angle:
      return poses[measure.body_b].angle - poses[measure.body_a].angle;
    case Measure::Kind::distance:
      return norm(world(scene, poses, measure.b) - world(scene, poses, measure.a));
    case Measure::Kind::travel: {
      const Joint& joint = scene.joints[measure.joint];
      return dot(axis_of(joint, poses), world(scene, poses, joint.b) - world(scene, poses, joint.a));
    }
    case Measure::Kind::x:
      return world(scene, poses, measure.b).x - poses[0].origin.x;
    case Measure::Kind::y:
      return world(scene, poses, measure.b).y - poses[0].origin.y;
    case Measure::Kind::sum:
      break;
  }
  double sum = 0.0;
  for (const Measure::Term& term : measure.terms) sum += term.factor * value_of(scene, term.measure, poses);
  return sum;
}

std::vector<UnitEffort> unit_efforts(const Scene& scene, const Measure& measure,
                                     const std::vector<BodyPose<double>>& poses) {
  std::vector<UnitEffort> out;
  add_efforts(scene, measure, poses, 1.0, out);
  return out;
}

}  // namespace poise
