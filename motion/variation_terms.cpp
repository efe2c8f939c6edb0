#include "motion/variation_terms.hpp"

#include <algorithm>

#include "model/inertia_impl.hpp"
#include "model/joint_friction.hpp"
#include "model/mechanism_impl.hpp"
#include "motion/motion_input_impl.hpp"

namespace poise {

VariationTerms::VariationTerms(const Variation& variation, const std::vector<MotionInput>& inputs,
                               const std::vector<Touch>& touching, const std::vector<int>& held,
                               const std::vector<GripOf>& grips, const std::vector<int>& growing)
    : variation_(variation),
      input_forces_(variation.compiled().mechanism()),
      bearing_loads_(variation.compiled().numbers(), variation.compiled().mechanism(), growing) {
  const VariedModel& compiled = variation.compiled();
  const Scene& scene = compiled.scene();
  const Mechanism<Dual>& m = compiled.mechanism();
  const Numbers<Dual> numbers = compiled.numbers();
  int scratch = 0;
  const auto add_row = [&](const Measure& on, int stop, const Dual& limit) {
    rows_.push_back({compiled.measure(on, stop), limit});
    scratch = std::max(scratch, rows_.back().on.scratch_size());
  };
  for (const Drive& drive : scene.drives) add_row(drive.on, -1, Dual(0.0));
  first_stop_ = rows_.size();
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const int stop = static_cast<int>(s);
    if (scene.stops[s].holds()) add_row(scene.stops[s].on, stop, numbers.limit(stop, true));
  }
  for (const Touch& touch : touching) {
    add_row(scene.stops[static_cast<std::size_t>(touch.stop)].on, touch.stop, numbers.limit(touch.stop, touch.upper));
  }
  for (const int e : held) add_row(scene.elements[static_cast<std::size_t>(e)].on, -1, Dual(0.0));
  for (std::size_t b = 0; b < scene.blades.size(); ++b) {
    const Blade& blade = scene.blades[b];
    blades_.emplace_back(compiled.measure(blade.turn()), compiled.measure(blade.x()), compiled.measure(blade.y()),
                         numbers.blade_angle(static_cast<int>(b)));
    scratch = std::max(scratch, blades_.back().scratch_size());
  }
  for (auto* each : {&blade_rate_, &blade_}) each->resize(blades_.size());
  input_forces_.set_inputs(numbers, inputs);
  for (std::size_t i = 0; i < grips.size(); ++i) {
    const auto [joint, stop] = grips[i];
    if (stop >= 0) {
      const auto element = static_cast<std::size_t>(stop_friction_element(scene, stop));
      rubs_.push_back({i, compiled.measure(scene.elements[element].on)});
      scratch = std::max(scratch, rubs_.back().on.scratch_size());
      factors_.push_back(numbers.stop_friction(stop).v[0]);
      axes_.push_back({});
      continue;
    }
    const Joint& of = scene.joints[static_cast<std::size_t>(joint)];
    factors_.push_back(of.friction ? grip_factor(numbers, joint).v[0] : 0.0);  // else its force is read
    const Planar<Dual> axis = numbers.axis(joint) * m.phasors().turned(m.layout().links[of.a.body].turn);
    axes_.push_back({axis.x.v[0], axis.y.v[0]});
  }
  const auto n = static_cast<std::size_t>(m.coordinates());
  const std::size_t rows = static_cast<std::size_t>(m.equalities()) + rows_.size();
  pose_size_ = static_cast<std::size_t>(m.pose_size() + scratch);
  for (auto* each : {&gap_, &rate_, &acceleration_}) each->resize(rows);
  force_.resize(n);
  jacobian_.resize(m.jacobian_row().size());
  resistances_.resize(static_cast<std::size_t>(m.resistances_size()));
  work_.resize(n);
}

void VariationTerms::evaluate(VariedState& state) {
  add_forces(state);
  if (!gap_.empty()) add_rows(state);
  add_blades(state);
}

void VariationTerms::add_blades(VariedState& state) {
  const Mechanism<Dual>& m = variation_.compiled().mechanism();
  Planar<Dual>* pose = state.pose.data();
  const Configuration<Dual> here{m.phasors(), pose, pose + m.pose_size()};
  for (std::size_t b = 0; b < blades_.size(); ++b) {
    blade_rate_[b] = blades_[b].along(here, state.v.data());
    blade_[b] = blades_[b].acceleration(here, state.v.data(), state.a.data());
    blades_[b].add(here, state.blade_multipliers[b], force_.data());
  }
}

void VariationTerms::add_forces(VariedState& state) {
  const Mechanism<Dual>& m = variation_.compiled().mechanism();
  const Inertia<Dual>& inertia = variation_.compiled().inertia();
  Planar<Dual>* pose = state.pose.data();
  Dual* g = force_.data();
  if (state.jumps) {
    std::fill(force_.begin(), force_.end(), Dual(0.0));
  } else {
    m.negative_force(state.q.data(), pose, g);
    input_forces_.set(state.t, state.near);
    input_forces_.set_reactions(state.reactions.empty() ? nullptr : state.reactions.data());
    m.resist(pose, state.v.data(), state.sliding, resistances_.data(), input_forces_.in_time());
    m.add_resistance(resistances_.data(), g);
    input_forces_.add(pose, g);
    const Configuration<Dual> here{m.phasors(), pose, pose + m.pose_size()};
    for (const Rub& rub : rubs_) rub.on.add_gradient(here, state.grip_efforts[rub.grip], g);
  }
  inertia.weigh(state.second.data(), work_.data());
  m.phasors().add_projection(pose, work_.data(), g);
  for (std::size_t i = 0; i < force_.size(); ++i) g[i] += inertia.moment(static_cast<int>(i)) * state.a[i];
}

void VariationTerms::add_rows(VariedState& state) {
  const Mechanism<Dual>& m = variation_.compiled().mechanism();
  Planar<Dual>* pose = state.pose.data();
  const Configuration<Dual> here{m.phasors(), pose, pose + m.pose_size()};
  const int equalities = m.equalities();
  // constraint() fills the rows of stops too.
  jacobian_.resize(std::max(jacobian_.size(), static_cast<std::size_t>(m.constraints())));
  m.constraint(state.q.data(), pose, jacobian_.data());
  std::copy(jacobian_.begin(), jacobian_.begin() + equalities, gap_.begin());
  m.phasors().first(pose, state.v.data(), work_.data());
  m.closures_of(work_.data(), rate_.data());
  m.closures_of(state.second.data(), acceleration_.data());
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const CompiledMeasure<Dual>& on = rows_[k].on;
    const std::size_t row = static_cast<std::size_t>(equalities) + k;
    gap_[row] = on.value(here) - rows_[k].limit;
    rate_[row] = on.along(here, state.v.data());
    acceleration_[row] = on.second(here, state.v.data(), state.v.data()) + on.along(here, state.a.data());
    on.add_gradient(here, state.drive_multipliers[k], force_.data());
  }
  m.jacobian(pose, jacobian_.data());
  for (std::size_t e = 0; e < m.jacobian_row().size(); ++e) {
    const int row = m.jacobian_row()[e];
    if (row < equalities) force_[m.jacobian_column()[e]] += state.multipliers[row] * jacobian_[e];
  }
  if (state.contact_efforts.empty()) return;
  bearing_loads_.place(state.q.data(), pose);
  for (std::size_t c = 0; c < state.contact_efforts.size(); ++c) {
    const Dual& effort = state.contact_efforts[c];
    const auto& contact = bearing_loads_.contacts()[c];
    rows_[first_stop_ + static_cast<std::size_t>(contact.holding)].on.add_gradient(here, effort, force_.data());
    bearing_loads_.add(contact, effort, abs(effort), pose, force_.data());
  }
}

}  // namespace poise
