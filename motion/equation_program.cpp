#include "motion/private/equation_program.hpp"

#include <utility>

#include "motion/private/motion_terms.hpp"

namespace poise {
namespace {

/// Numbers for a part to begin with: nothing that is recorded depends on them.
std::vector<Recorded> input_array(const std::vector<double>& values) {
  std::vector<Recorded> out;
  for (const double value : values) out.push_back(Recorded::input(value));
  return out;
}

void refuse_decisions(const EquationsOfMotion& equations, const Recording& recording) {
  if (recording.guards.empty()) return;
  throw InputError(equations.scene.file +
                   ": the equation of motion cannot be written as code, for it decides by values that it computes; "
                   "expected measures and laws whose pieces are known");
}

}  // namespace

EquationProgram record_equations(const EquationsOfMotion& equations) {
  EquationProgram out;
  const auto n = static_cast<std::size_t>(equations.coordinates());
  const std::vector<double> still(n, 0.0);
  {
    EquationProgram::Part& part = out.closing;
    part.recording.keeps_all_pieces = true;
    const Recorder recorder(part.recording);
    MotionTerms<Recorded> terms(equations.scene, equations.layout, equations.begin);
    part.inputs = {"t", "q"};
    const Recorded t = Recorded::input(0.0);
    const std::vector<Recorded> q = input_array(equations.begin);
    terms.place(t, q.data());
    const auto rows = static_cast<std::size_t>(terms.rows());
    std::vector<Recorded> gap(rows), moving(rows), jacobian(rows * n);
    terms.close(gap.data(), moving.data(), jacobian.data());
    part.outputs = {{"g", std::move(gap)}, {"g_t", std::move(moving)}, {"J", std::move(jacobian)}};
    refuse_decisions(equations, part.recording);
  }
  {
    EquationProgram::Part& part = out.forces;
    part.recording.keeps_all_pieces = true;
    const Recorder recorder(part.recording);
    MotionTerms<Recorded> terms(equations.scene, equations.layout, equations.begin);
    part.inputs = {"t", "q", "v"};
    const Recorded t = Recorded::input(0.0);
    const std::vector<Recorded> q = input_array(equations.begin), v = input_array(still);
    terms.place(t, q.data());
    std::vector<Recorded> mass(n * n), velocity(n), potential(n), load(n), bend(static_cast<std::size_t>(terms.rows()));
    terms.forces(v.data(), mass.data(), velocity.data(), potential.data(), load.data(), bend.data());
    part.outputs = {{"M", std::move(mass)},
                    {"k", std::move(velocity)},
                    {"V_q", std::move(potential)},
                    {"Q_q", std::move(load)},
                    {"b", std::move(bend)}};
    refuse_decisions(equations, part.recording);
  }
  return out;
}

}  // namespace poise
