#include "statics/closure_rounding.hpp"

#include <cmath>
#include <limits>

namespace poise {
namespace {

// In the last place.
double unit_of(double x) {
  if (x == 0.0 || !std::isfinite(x)) return 0.0;
  return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x);
}

double rounding_of(const Layout& layout, const Vec2& arm, int turn) {
  double angle = 0.0;
  for (const double part : layout.turns[turn].parts()) angle += unit_of(part);
  return unit_of(arm.x) + unit_of(arm.y) + norm(arm) * angle;
}

}  // namespace

std::vector<double> closure_rounding(const ScaledModel& model) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  const double per_length = model.scales().per_length();
  std::vector<double> out;
  for (const Closure& closure : layout.closures) {
    const Joint& joint = scene.joints[closure.joint];
    int a = joint.a.body;
    int b = joint.b.body;
    double sum = rounding_of(layout, per_length * scene.local(joint.a), layout.links[a].turn) +
                 rounding_of(layout, per_length * scene.local(joint.b), layout.links[b].turn);
    if (joint.keeps_length()) sum += unit_of(per_length * joint.length);
    if (joint.has_travel()) sum += rounding_of(layout, joint.axis, layout.links[a].turn);
    while (a != b) {
      int& lower = layout.links[a].depth > layout.links[b].depth ? a : b;
      for (const Arm& arm : layout.links[lower].arms) sum += rounding_of(layout, arm.arm, arm.turn);
      lower = layout.links[lower].parent;
    }
    out.push_back(sum);
  }
  return out;
}

std::vector<double> row_rounding(const ScaledModel& model) {
  const std::vector<double> of_closure = closure_rounding(model);
  std::vector<double> out(model.mechanism().constraints(), half_unit);
  for (const ConstraintBlock& block : model.mechanism().blocks()) {
    for (int r = 0; r < block.rows; ++r) out[block.first_row + r] = of_closure[block.closure];
  }
  return out;
}

}  // namespace poise
