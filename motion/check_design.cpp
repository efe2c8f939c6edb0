#include <algorithm>
#include <cmath>
#include <numbers>

#include "motion/design.hpp"
#include "motion/extent.hpp"
#include "motion/kinematics.hpp"

namespace poise {
namespace {

constexpr int most_positions = 400;
constexpr double same_travel = 1e-6;

}  // namespace

DesignCheck check_design(const DesignProblem& problem, const DesignResult& result) {
  const Scene& scene = result.scene;
  DesignCheck out;
  SweepOptions options;
  options.steps = most_positions;
  const KinematicsResult swept = sweep(scene, {{scene.bodies[problem.driver].name, result.from, result.to}}, options);
  if (!swept.complete || !swept.singular.empty()) {
    out.why = swept.complete ? swept.singular.front().text : swept.why;
    return out;
  }
  const DesignModel model(problem);
  const auto place = [&](const KinematicSample& at, PointRef p) {
    return at.bodies[p.body].pose.world(scene.local(p));
  };
  const KinematicSample& first = swept.samples.front();
  const Vec2 begin = place(first, problem.guided);
  Extent x{begin.x, begin.x}, y{begin.y, begin.y};
  Extent angle{first.bodies[problem.level].pose.angle, first.bodies[problem.level].pose.angle};
  out.closeness = first.closeness_to_singular;
  out.facts = result.facts;  // sizes of bodies do not depend on the pose
  std::fill(out.facts.transmission.begin(), out.facts.transmission.end(), std::numbers::pi / 2);
  for (auto& stroke : out.facts.strokes) stroke = {1e300, 0.0, 1e300};
  for (const KinematicSample& at : swept.samples) {
    const Vec2 p = place(at, problem.guided);
    x.add(p.x);
    y.add(p.y);
    angle.add(at.bodies[problem.level].pose.angle);
    out.closeness = std::min(out.closeness, at.closeness_to_singular);
    for (std::size_t i = 0; i < out.facts.transmission.size(); ++i) {
      const Dyad& d = model.chain().dyads()[i];
      const Vec2 one = place(at, d.first_anchor) - place(at, d.first_tip);
      const Vec2 other = place(at, d.second_anchor) - place(at, d.second_tip);
      const double between = std::atan2(std::abs(cross(one, other)), std::abs(dot(one, other)));
      out.facts.transmission[i] = std::min(out.facts.transmission[i], between);
    }
    for (std::size_t i = 0; i < problem.actuators.size(); ++i) {
      const Actuator& jack = problem.actuators[i];
      const Vec2 d = place(at, jack.b) - place(at, jack.a);
      // Driven at 1 rad/s, rates are derivatives by the angle.
      const double lever = std::abs(rate_of(scene, at.bodies, Measure::distance_between(jack.a, jack.b)));
      DesignFacts::Stroke& stroke = out.facts.strokes[i];
      stroke = {std::min(stroke.shortest, norm(d)), std::max(stroke.longest, norm(d)),
                std::min(stroke.least_lever, lever)};
    }
  }
  out.facts.travel = y.max - y.min;
  out.facts.drift = x.max - x.min;
  out.facts.inclination = 0.5 * (angle.max - angle.min);
  out.facts.gap = 0.0;
  if (std::abs(out.facts.travel - problem.travel) > same_travel * problem.travel) {
    out.why = "the travel differs";
  } else if (model.misfit(out.facts) > 0.0) {
    out.why = "a limit is exceeded between the positions that the search evaluated";
  }
  out.met = out.why.empty();
  return out;
}

}  // namespace poise
