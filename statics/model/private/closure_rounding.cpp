#include "statics/model/private/closure_rounding.hpp"

#include <cmath>

namespace poise {

std::vector<double> closure_rounding(const ScaledModel& model) {
  const Layout& layout = model.layout();
  std::vector<double> out;
  for (const Closure& closure : layout.closures) {
    const Joint& joint = model.scene().joints[closure.joint];
    double sum = joint.keeps_length() ? half_unit * model.scales().per_length() * joint.length : 0.0;
    for (const Arm& arm : closure.arms) {
      const Vec2 along = layout.is_length(arm.coordinate) ? direction<double>(arm.arm) : arm.arm;
      sum += arm.rounding.x + arm.rounding.y;
      const Turn& turn = layout.turns[arm.turn];
      double open = turn.open;
      for (const double part : turn.angle.parts()) open += half_unit * std::abs(part);
      sum += open * norm(along);
    }
    out.push_back(2 * sum);
  }
  return out;
}

std::vector<double> row_rounding(const ScaledModel& model) {
  const std::vector<double> of_closure = closure_rounding(model);
  std::vector<double> out(model.mechanism().constraints(), 2 * half_unit);
  for (const ConstraintBlock& block : model.mechanism().blocks()) {
    for (int r = 0; r < block.rows; ++r) out[block.first_row + r] = of_closure[block.closure];
  }
  return out;
}

}  // namespace poise
