#include "motion/motion_writer.hpp"

#include <algorithm>
#include <cmath>

namespace poise {

MotionWriter::MotionWriter(const MotionModel& model, const SensitivityColumns& columns,
                           const std::vector<double>& q_start, Motion& out)
    : model_(model),
      columns_(columns),
      unit_(columns.units()),
      q_start_(q_start),
      out_(out),
      n_(unit_.size()),
      reach_(n_, 0.0),
      speed_(n_, 0.0) {
  out_.trajectory.coordinates = static_cast<int>(n_);
  out_.trajectory.columns = columns.count();
  out_.drive_force.resize(model.scene().drives.size());
  out_.blade_force.resize(model.scene().blades.size());
}

void MotionWriter::add(double t, const ReducedMotion<double>& reduced, const MotionStep& step) {
  Trajectory& path = out_.trajectory;
  path.t.push_back(t);
  for (std::size_t i = 0; i < n_; ++i) {
    path.q.push_back(unit_[i] * reduced.q()[i]);
    path.v.push_back(unit_[i] * reduced.v()[i]);
    path.a.push_back(unit_[i] * reduced.a()[i]);
    reach_[i] = std::max(reach_[i], std::abs(reduced.q()[i] - q_start_[i]));
    speed_[i] = std::max(speed_[i], std::abs(reduced.v()[i]));
  }
  pivot_.push_back(reduced.pivot());
  add_energies(reduced, step);
  if (columns_.count() > 0) add_sensitivities(step);
}

void MotionWriter::add_energies(const ReducedMotion<double>& reduced, const MotionStep& step) {
  const double unit = model_.scales().energy();
  const double kinetic = reduced.kinetic_energy(), potential = reduced.potential_energy();
  energy_ = kinetic + potential;
  out_.kinetic.push_back(unit * kinetic);
  out_.potential.push_back(unit * potential);
  out_.work.push_back(unit * step.work());
  for (const double one : {out_.kinetic.back(), out_.potential.back() - out_.potential.front(), out_.work.back()}) {
    exchanged_ = std::max(exchanged_, std::abs(one) / unit);
  }
  for (int d = 0; d < static_cast<int>(out_.drive_force.size()); ++d) {
    const bool turns = model_.scene().drives[static_cast<std::size_t>(d)].on.is_angle();
    out_.drive_force[static_cast<std::size_t>(d)].push_back(reduced.drive_force(d) *
                                                            (turns ? unit : model_.scales().force));
  }
  for (std::size_t b = 0; b < out_.blade_force.size(); ++b) {
    out_.blade_force[b].push_back(reduced.blade_force(static_cast<int>(b)) * model_.scales().force);
  }
}

void MotionWriter::add_sensitivities(const MotionStep& step) {
  Trajectory& path = out_.trajectory;
  const auto width = static_cast<std::size_t>(columns_.count());
  const std::size_t first = path.q_p.size();
  for (auto* part : {&path.q_p, &path.v_p, &path.a_p}) part->resize(first + n_ * width);
  for (int c = 0; c < columns_.count(); ++c) {
    const double per = 1.0 / columns_.unit_of(c);
    step.changes_by(c, step.y, columns_.influence_of(c), changes_);
    for (std::size_t i = 0; i < n_; ++i) {
      const std::size_t at = first + i * width + static_cast<std::size_t>(c);
      path.q_p[at] = unit_[i] * per * changes_.q[i];
      path.v_p[at] = unit_[i] * per * changes_.v[i];
      path.a_p[at] = unit_[i] * per * changes_.a[i];
    }
  }
}

void MotionWriter::drop() {
  Trajectory& path = out_.trajectory;
  path.t.pop_back();
  for (auto* values : {&path.q, &path.v, &path.a}) values->resize(path.nodes() * n_);
  for (auto* values : {&path.q_p, &path.v_p, &path.a_p}) {
    values->resize(path.nodes() * n_ * static_cast<std::size_t>(columns_.count()));
  }
  for (auto* values : {&pivot_, &out_.kinetic, &out_.potential, &out_.work}) values->pop_back();
  for (std::vector<double>& forces : out_.drive_force) forces.pop_back();
  for (std::vector<double>& forces : out_.blade_force) forces.pop_back();
}

NodeValues MotionWriter::at(std::size_t node, std::size_t coordinate) const {
  const Trajectory& path = out_.trajectory;
  const std::size_t at = node * n_ + coordinate;
  const double unit = unit_[coordinate];
  return {path.t[node], path.q[at] / unit, path.v[at] / unit, path.a[at] / unit};
}

void MotionWriter::read(const std::vector<double>& by, std::size_t column, std::vector<double>& out) const {
  const std::size_t node = nodes() - 1;
  const double unit = columns_.unit_of(static_cast<int>(column));
  for (std::size_t i = 0; i < n_; ++i) {
    out[i] = by[(node * n_ + i) * static_cast<std::size_t>(columns_.count()) + column] * unit / unit_[i];
  }
}

void MotionWriter::read_sensitivities(const ReducedMotion<double>& reduced, MotionStep& step) const {
  const Trajectory& path = out_.trajectory;
  const int f = reduced.freedoms();
  for (int k = 0; k < f; ++k) {
    const auto i = static_cast<std::size_t>(reduced.independent()[k]);
    for (int c = 0; c < columns_.count(); ++c) {
      const std::size_t from =
          ((nodes() - 1) * n_ + i) * static_cast<std::size_t>(columns_.count()) + static_cast<std::size_t>(c);
      const double unit = columns_.unit_of(c) / unit_[i];
      step.y[step.sensitivity(k, c)] = path.q_p[from] * unit;
      step.y[step.sensitivity(f + k, c)] = path.v_p[from] * unit;
    }
  }
}

}  // namespace poise
