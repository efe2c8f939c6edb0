#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "model/controllers.hpp"
#include "model/couplings.hpp"
#include "model/gas_struts.hpp"
#include "model/mechanism.hpp"
#include "model/plain_value.hpp"
#include "model/scene_numbers.hpp"

namespace poise {

template <class T>
Mechanism<T>::Mechanism(const Scene& scene, Purpose purpose) : Mechanism(scene, lay_out(scene, purpose), purpose) {}

template <class T>
Mechanism<T>::Mechanism(const Scene& scene, Layout layout, Purpose purpose)
    : layout_(std::move(layout)),
      phasors_(layout_,
               !scene.elements.empty() || !scene.stops.empty() || !scene.drives.empty() || !scene.blades.empty()) {
  load_.assign(coordinates(), {});
  torque_.assign(coordinates(), T(0));
  const bool moves = std::any_of(scene.time_functions.begin(), scene.time_functions.end(),
                                 [](const TimeFunction& one) { return one.of == TimeFunction::Of::frame; });
  if (moves && purpose == Purpose::dynamics) first_moment_.assign(coordinates(), {});
  set_loads(SceneNumbers<T>(scene));
  compile_closures();
  compile_elements(scene, purpose);
  compile_followers(scene);
  compile_stops(scene);
  if (purpose == Purpose::dynamics) compile_load_derivatives(scene);
  size_resistances();
  find_what_varies(scene);
  make_jacobian_pattern();
  make_tangent_pattern();
}

template <class T>
Mechanism<T>::Mechanism(const Mechanism&) = default;

template <class T>
Mechanism<T>::Mechanism(Mechanism&&) noexcept = default;

template <class T>
Mechanism<T>& Mechanism<T>::operator=(const Mechanism&) = default;

template <class T>
Mechanism<T>& Mechanism<T>::operator=(Mechanism&&) noexcept = default;

template <class T>
Mechanism<T>::~Mechanism() = default;

// --- compilation ----------------------------------------------------------------------------------------------------

template <class T>
void Mechanism<T>::need_scratch(int size) {
  scratch_size_ = std::max(scratch_size_, size);
}

// From the world's origin, the sum over all points of the force.
template <class T>
PhasorSum<T> Mechanism<T>::path_to(const Scene& scene, const Force& force) const {
  return {phasors_, layout_.paths_to(scene, force)};
}

template <class T>
Arm Mechanism<T>::arm_to(const Scene& scene, PointRef point) const {
  const Link& link = layout_.links[point.body];
  const LinkPoint place = layout_.place_of(scene, point);
  return {link.frame, place.at, link.turn, place.vector};
}

// The layout is made of a scene's own numbers: its arm has them with their rounding.
template <class T>
template <class NumbersOfScene>
Planar<T> Mechanism<T>::coefficient_of(const NumbersOfScene& numbers, PointRef point) const {
  return phasors_.coefficient(arm_to(numbers.scene(), point));
}

// What acts at each of the points of a force, in the frame of what it follows.
template <class T>
template <class NumbersOfScene>
Planar<T> Mechanism<T>::force_at_points(const NumbersOfScene& numbers, int force) {
  const Planar<T> vector = numbers.force(force);
  return numbers.scene().forces[force].to ? share_at_points(numbers, force) * vector : vector;
}

// Masses are summed over the tree as weights are, without gravity.
template <class T>
template <class NumbersOfScene>
void Mechanism<T>::set_first_moments(const NumbersOfScene& numbers) {
  const Scene& scene = numbers.scene();
  std::fill(first_moment_.begin(), first_moment_.end(), Planar<T>{});
  std::vector<T> carried(layout_.links.size(), T(0));
  const auto add_at = [&](int coordinate, const Planar<T>& coefficient, const T& mass) {
    if (coordinate >= 0 && coordinate < coordinates()) first_moment_[coordinate] += mass * coefficient;
  };
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const int body = static_cast<int>(i);
    if (scene.bodies[i].mass == 0 && !layout_.varying.has_mass(body)) continue;
    const Link& link = layout_.links[i];
    carried[i] += numbers.mass(body);
    add_at(link.frame, numbers.center(body) * phasors_.turned(link.turn), numbers.mass(body));
  }
  for (auto it = layout_.tree_order.rbegin(); it != layout_.tree_order.rend(); ++it) {
    const Link& link = layout_.links[*it];
    if (link.parent < 0) continue;
    for (const Arm& arm : link.arms) add_at(arm.coordinate, phasors_.coefficient(arm), carried[*it]);
    carried[link.parent] += carried[*it];
  }
}

// Every dead force F at p does the work Re(conj(F) p): summed over the tree, all of them become one number per phasor.
template <class T>
template <class NumbersOfScene>
void Mechanism<T>::set_loads(const NumbersOfScene& numbers) {
  const Scene& scene = numbers.scene();
  std::fill(load_.begin(), load_.end(), Planar<T>{});
  std::fill(torque_.begin(), torque_.end(), T(0));
  carried_.assign(layout_.links.size(), {});
  const auto add_at = [&](int coordinate, const Planar<T>& coefficient, const Planar<T>& force) {
    if (coordinate < 0 || coordinate >= coordinates()) return;
    load_[coordinate] += conj(force) * coefficient;
  };
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const int body = static_cast<int>(i);
    if (scene.bodies[i].mass == 0 && !layout_.varying.has_mass(body)) continue;
    const Planar<T> weight = T(numbers.mass(body)) * numbers.gravity();
    const Link& link = layout_.links[i];
    carried_[i] += weight;
    if (layout_.varying.has_center(body)) {
      add_at(link.frame, numbers.center(body) * phasors_.turned(link.turn), weight);
    } else {
      add_at(link.frame, phasors_.coefficient({link.frame, scene.bodies[i].center, link.turn}), weight);
    }
  }
  for (std::size_t f = 0; f < scene.forces.size(); ++f) {
    const Force& force = scene.forces[f];
    if (force.follows >= 0) continue;
    const Planar<T> share = force_at_points(numbers, static_cast<int>(f));
    force.for_each_point([&](PointRef point) {
      carried_[point.body] += share;
      add_at(layout_.links[point.body].frame, coefficient_of(numbers, point), share);
    });
  }
  for (auto it = layout_.tree_order.rbegin(); it != layout_.tree_order.rend(); ++it) {
    const Link& link = layout_.links[*it];
    if (link.parent < 0) continue;
    for (const Arm& arm : link.arms) add_at(arm.coordinate, phasors_.coefficient(arm), carried_[*it]);
    carried_[link.parent] += carried_[*it];
  }
  if (!first_moment_.empty()) set_first_moments(numbers);
  for (std::size_t t = 0; t < scene.torques.size(); ++t) {
    const int k = layout_.links[scene.torques[t].body].frame;
    if (k < 0 || k >= coordinates()) continue;
    torque_[k] += T(numbers.torque(static_cast<int>(t)));
    has_torque_ = true;
  }
}

template <class T>
void Mechanism<T>::compile_closures() {
  closure_first_.push_back(0);
  for (const Closure& closure : layout_.closures) {
    std::vector<Arm> arms = closure.arms;
    std::stable_sort(arms.begin(), arms.end(), [](const Arm& l, const Arm& r) { return l.coordinate < r.coordinate; });
    const PhasorSum<T> gap(phasors_, arms);
    if (gap.varies()) varying_closures_.emplace_back(closures(), gap);
    closure_constant_.push_back(gap.constant());
    const int first = static_cast<int>(jacobian_row_.size());
    const int row = equalities_;
    blocks_.push_back({closures() - 1, row, 2});
    closure_row_.push_back(row);
    equalities_ += 2;
    for (int t : gap.support()) {
      jacobian_row_.insert(jacobian_row_.end(), {row, row + 1});
      jacobian_column_.insert(jacobian_column_.end(), {t, t});
    }
    for (const auto& term : gap.terms()) {
      closure_coordinate_.push_back(term.coordinate);
      closure_coefficient_.push_back(term.coefficient);
      closure_own_.push_back(first + 2 * term.own_slot);
      closure_frame_.push_back(term.frame_slot < 0 ? -1 : first + 2 * term.frame_slot);
    }
    closure_first_.push_back(static_cast<int>(closure_coordinate_.size()));
  }
}

// In statics a spring of free length zero is smooth where its points coincide; derivatives by its numbers, which motion
// needs, are those of the distance.
template <class T>
typename Mechanism<T>::ForceElement Mechanism<T>::compiled_element(const Scene& scene, int index,
                                                                   Purpose purpose) const {
  const Element& element = scene.elements[index];
  const auto* spring = std::get_if<LinearSpring>(&element.law);
  const bool is_half_square = purpose == Purpose::statics && spring != nullptr &&
                              element.on.kind == Measure::Kind::distance && spring->free_length == 0.0 &&
                              spring->acts != LinearSpring::Acts::compression &&
                              !layout_.varying.has({Owner::element, index, 0, 1});
  if (is_half_square) {
    return {CompiledMeasure<T>::half_square(scene, layout_, phasors_, element.on),
            law_in<T>(ConstantForce{spring->stiffness}),
            {},
            index,
            true};
  }
  return {{scene, layout_, phasors_, element.on}, law_in<T>(element.law), {}, index, false};
}

template <class T>
void Mechanism<T>::compile_elements(const Scene& scene, Purpose purpose) {
  for (std::size_t k = 0; k < scene.elements.size(); ++k) {
    const Element& element = scene.elements[k];
    const int index = static_cast<int>(k);
    ForceElement compiled = compiled_element(scene, index, purpose);
    const bool may_act = idle(element.law).empty() || layout_.varying.has_any(Owner::element, index);
    const bool acts = stores_energy(element.law) && may_act && !compiled.on.support().empty();
    if (!acts && purpose == Purpose::statics) continue;
    need_scratch(compiled.on.scratch_size());
    if (resists_motion(element.law)) resisting_.push_back(elements());
    if (element.feedback) {
      controls_.push_back(compiled_control(scene, element));
      need_scratch(controls_.back().reads.scratch_size());
    }
    elements_.push_back(std::move(compiled));
  }
}

template <class T>
typename Mechanism<T>::Control Mechanism<T>::compiled_control(const Scene& scene, const Element& element) const {
  Control out;
  const Feedback& feedback = *element.feedback;
  out.element = elements();
  if (feedback.acts) out.on = out.element;
  if (feedback.sets && feedback.sets->of == TimeFunction::Of::element) {
    out.on = feedback.sets->item;
    out.sets = feedback.sets->number;
  } else if (feedback.sets && feedback.sets->of == TimeFunction::Of::force) {
    out.load = feedback.sets->item;
  } else if (feedback.sets) {
    const bool drives = feedback.sets->of == TimeFunction::Of::drive;
    const int turned = layout_.links[drives ? feedback.course : scene.torques[feedback.sets->item].body].frame;
    if (turned >= 0 && turned < coordinates()) out.turns.push_back(turned);
  }
  out.follows = feedback.follows;
  out.reads_from = feedback.reads_from;
  out.reads_force = feedback.reads_force;
  out.reads_reaction = feedback.reads_reaction();
  if (out.reads_force >= 0) out.force_set_by = controller_that_sets(scene, out.reads_force);
  out.reads = {scene, layout_, phasors_, feedback.reads};
  const auto angle_of = [&](int body) -> CompiledMeasure<T> {
    if (body < 0) return {};
    return {scene, layout_, phasors_, Measure::angle_between(0, body)};
  };
  out.integral = angle_of(feedback.integral);
  out.filter = angle_of(feedback.filter);
  for (std::size_t k = 0; k < out.held.size(); ++k) out.held[k] = angle_of(feedback.held[k]);
  for (const int body : feedback.states()) out.inertia = T(scene.bodies[static_cast<std::size_t>(body)].inertia);
  if (feedback.course >= 0) out.turned_by = out.inertia / T(controller_of(element.law)->effort_unit);
  return out;
}

template <class T>
void Mechanism<T>::size_resistances() {
  for (const int r : resisting_) resistances_size_ += 3 + static_cast<int>(elements_[r].on.support().size());
  for (const Control& control : controls_) resistances_size_ += 3 + static_cast<int>(pushed(control).size());
}

template <class T>
void Mechanism<T>::compile_followers(const Scene& scene) {
  const SceneNumbers<T> numbers(scene);
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    const Force& f = scene.forces[k];
    const int index = static_cast<int>(k);
    const bool acts = f.vector.x != 0 || f.vector.y != 0 || layout_.varying.has_any(Owner::force, index);
    if (f.follows < 0 || !acts) continue;
    const Link& carrier = layout_.links[f.follows];
    const Planar<T> share = force_at_points(numbers, index);
    Follower follower{path_to(scene, f), {}, share * phasors_.turned(carrier.turn), index, carrier.frame, {}};
    need_scratch(follower.path.size());
    followers_.push_back(std::move(follower));
    follower_names_.push_back(f.name);
  }
}

template <class T>
void Mechanism<T>::compile_stops(const Scene& scene) {
  for (const Stop& s : scene.stops) {
    stops_.push_back({{scene, layout_, phasors_, s.on}, {}, {}});
    need_scratch(stops_.back().on.scratch_size());
    lower_.push_back(static_cast<T>(s.min));
    upper_.push_back(static_cast<T>(s.max));
  }
}

// Sums without numbers that vary leave set_numbers() nothing to do.
template <class T>
void Mechanism<T>::find_what_varies(const Scene& scene) {
  const VaryingNumbers& varying = layout_.varying;
  if (varying.empty()) {
    carried_ = std::vector<Planar<T>>();
    return;
  }
  for (const Owner owner : {Owner::scene, Owner::force, Owner::torque, Owner::body, Owner::point, Owner::joint}) {
    loads_vary_ = loads_vary_ || varying.has_some(owner);
  }
  loads_vary_ = loads_vary_ || !layout_.vectors.empty();
  for (const ForceElement& e : elements_) varying_laws_.push_back(varying.has_any(Owner::element, e.element));
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    const int index = static_cast<int>(s);
    const CouplingKind* const kind = coupling_kind(stop);
    const int strut = strut_of(scene, stop);
    // Factors of a sum belong to the stop itself, whose other numbers may be those of a coupling or of a gas strut.
    const bool varies = varying.has_any(Owner::stop, index) ||
                        (kind != nullptr && varying.has_any(Owner::coupling, index - kind->row)) ||
                        (strut >= 0 && varying.has_any(Owner::element, strut));
    if (varies) varying_stops_.push_back(index);
  }
}

template <class T>
template <class NumbersOfScene>
void Mechanism<T>::set_numbers(const NumbersOfScene& numbers) {
  if (layout_.varying.empty()) return;
  const Scene& scene = numbers.scene();
  phasors_.set_numbers(numbers);
  if (loads_vary_) set_loads(numbers);
  for (auto& [closure, gap] : varying_closures_) {
    gap.set_numbers(phasors_);
    closure_constant_[closure] = gap.constant();
    auto coefficient = closure_coefficient_.begin() + closure_first_[closure];
    for (const auto& term : gap.terms()) *coefficient++ = term.coefficient;
  }
  for (std::size_t k = 0; k < elements_.size(); ++k) {
    ForceElement& e = elements_[k];
    e.on.set_numbers(phasors_);
    if (!varying_laws_[k]) continue;
    e.on.set_terms(numbers, scene.elements[e.element].on, -1);
    numbers.with_law(e.element, [&](const auto& law) {
      if constexpr (requires { law.stiffness; }) {
        if (e.is_half_square) {
          e.law = ConstantForceOf<NumberOfLaw<T>>{law.stiffness};
          return;
        }
      }
      e.law = law;
    });
  }
  for (Control& control : controls_) control.reads.set_numbers(phasors_);
  for (Follower& follower : followers_) {
    follower.path.set_numbers(phasors_);
    follower.force = force_at_points(numbers, follower.load) *
                     phasors_.turned(layout_.links[scene.forces[follower.load].follows].turn);
  }
  for (Limit& stop : stops_) stop.on.set_numbers(phasors_);
  for (const int s : varying_stops_) {
    stops_[s].on.set_terms(numbers, scene.stops[s].on, s);
    lower_[s] = numbers.limit(s, false);
    upper_[s] = numbers.limit(s, true);
  }
}

// A force of zero without a direction of its own has the derivative zero.
template <class T>
void Mechanism<T>::compile_load_derivatives(const Scene& scene) {
  for (const Force& f : scene.forces) {
    Planar<T> along = scene.share_at_points<T>(f) * planar_cast<T>(f.unit_or_zero());
    int frame = -1;
    if (f.follows >= 0) {
      along = along * phasors_.turned(layout_.links[f.follows].turn);
      frame = layout_.links[f.follows].frame;
    }
    loads_.push_back({path_to(scene, f), along, frame});
    need_scratch(loads_.back().path.size());
  }
  for (const Torque& t : scene.torques) torque_coordinate_.push_back(layout_.links[t.body].frame);
}

template <class T>
void Mechanism<T>::make_jacobian_pattern() {
  for (int s = 0; s < stops(); ++s) {
    Limit& stop = stops_[s];
    for (int t : stop.on.support()) {
      stop.entry.push_back(static_cast<int>(jacobian_row_.size()));
      jacobian_row_.push_back(stop_row(s));
      jacobian_column_.push_back(t);
    }
  }
}

template <class T>
void Mechanism<T>::make_tangent_pattern() {
  std::unordered_map<std::uint64_t, int> known;
  const auto entry = [&](int i, int j) {
    const auto key = static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(j);
    const auto [at, fresh] = known.try_emplace(key, static_cast<int>(tangent_row_.size()));
    if (fresh) {
      tangent_row_.push_back(i);
      tangent_column_.push_back(j);
    }
    return at->second;
  };
  const bool full = has_follower_loads();
  const auto lower = [&](int i, int j) { return entry(std::max(i, j), std::min(i, j)); };
  const auto above = [&](int i, int j) { return full ? entry(std::min(i, j), std::max(i, j)) : -1; };
  if (full) {
    for (int i = 0; i < coordinates(); ++i) entry(i, i);
  } else {
    for (int i = 0; i < coordinates(); ++i) tangent_row_.push_back(i);
    tangent_column_ = tangent_row_;
  }
  const auto diagonal_or = [&](int i, int j) { return i == j ? i : lower(i, j); };
  slide_entry_.assign(coordinates() - angles(), -1);
  slide_transposed_ = slide_entry_;
  for (int t = angles(); t < coordinates(); ++t) {
    if (frame(t) < 0) continue;
    slide_entry_[t - angles()] = lower(t, frame(t));
    slide_transposed_[t - angles()] = above(t, frame(t));
  }
  const auto complete = [&](const std::vector<int>& s, TangentBlock& block) {
    for (std::size_t i = 0; i < s.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        block.entry.push_back(diagonal_or(s[i], s[j]));
        if (full) block.transposed.push_back(i == j ? -1 : above(s[i], s[j]));
      }
    }
  };
  for (ForceElement& element : elements_) {
    if (stores_energy(element.law)) complete(element.on.support(), element.block);
  }
  for (Limit& stop : stops_) complete(stop.on.support(), stop.block);
  for (Follower& follower : followers_) {
    complete(follower.path.support(), follower.block);
    for (int i : follower.path.support()) {
      if (follower.frame >= 0) follower.frame_entry.push_back(entry(i, follower.frame));
    }
  }
}

// --- evaluation -----------------------------------------------------------------------------------------------------

template <class T>
std::vector<T> Mechanism<T>::start() const {
  std::vector<T> q;
  for (int i = 0; i < coordinates(); ++i) q.push_back(static_cast<T>(layout_.coordinates[i].start));
  return q;
}

template <class T>
T Mechanism<T>::energy(const T* q, Planar<T>* pose) const {
  T v(0);
  for (int t = 0; t < coordinates(); ++t) v -= load_[t].x * pose[t].x - load_[t].y * pose[t].y;
  if (has_torque_) {
    for (int k = 0; k < angles(); ++k) v -= torque_[k] * q[k];
  }
  for (const ForceElement& e : elements_) v += poise::energy(e.law, e.on.value(at(pose)));
  return v;
}

template <class T>
void Mechanism<T>::negative_force(const T*, Planar<T>* pose, T* g) const {
  const int n = coordinates();
  // d/dq of -Re(a phi): Im(a phi) for an angle; -Re(a exp(i theta_f)) for a length and Im(a phi) for its frame.
  for (int k = 0; k < angles(); ++k) g[k] = load_[k].x * pose[k].y + load_[k].y * pose[k].x - torque_[k];
  for (int t = angles(); t < n; ++t) {
    const Planar<T>& along = line_direction(pose, t);
    g[t] = load_[t].y * along.y - load_[t].x * along.x;
    if (frame(t) >= 0) g[frame(t)] += load_[t].x * pose[t].y + load_[t].y * pose[t].x;
  }
  const Configuration<T> here = at(pose);
  for (const ForceElement& e : elements_) {
    if (!stores_energy(e.law)) continue;
    e.on.add_gradient(here, force_at_rest(e.law, e.on.value(here)).value, g);
  }
  for (const Follower& f : followers_) {
    const Planar<T> force = world_force(f.force, f.frame, pose);
    f.path.derivative(phasors_, pose, here.scratch);
    for (int i = 0; i < f.path.size(); ++i) g[f.path.support()[i]] -= dot(force, here.scratch[i]);
  }
}

// As of dead loads, of which the work is  -Re(conj(A) sum_t m c_t phi_t)  with the acceleration A.
template <class T>
void Mechanism<T>::add_frame(const Planar<T>& acceleration, const Planar<T>* pose, T* g) const {
  for (int t = 0; t < coordinates(); ++t) {
    const Planar<T> f = conj(first_moment_[t]) * acceleration;
    if (t < angles()) {
      g[t] += cross(pose[t], f);
      continue;
    }
    g[t] += dot(line_direction(pose, t), f);
    if (frame(t) >= 0) g[frame(t)] += cross(pose[t], f);
  }
}

template <class T>
void Mechanism<T>::add_frame_change(const Planar<T>& acceleration, const Planar<T>* pose, const T* dq, T* g) const {
  for (int t = 0; t < coordinates(); ++t) {
    const Planar<T> f = conj(first_moment_[t]) * acceleration;
    if (t < angles()) {
      g[t] -= dot(pose[t], f) * dq[t];
      continue;
    }
    const int k = frame(t);
    if (k < 0) continue;
    const T mixed = cross(line_direction(pose, t), f);
    g[t] += mixed * dq[k];
    g[k] += mixed * dq[t] - dot(pose[t], f) * dq[k];
  }
}

template <class T>
void Mechanism<T>::constraint(const T*, Planar<T>* pose, T* c) const {
  for (int l = 0; l < closures(); ++l) {
    Planar<T> gap = closure_constant_[l];
    for (int e = closure_first_[l]; e < closure_first_[l + 1]; ++e) {
      gap += closure_coefficient_[e] * pose[closure_coordinate_[e]];
    }
    c[closure_row_[l]] = gap.x;
    c[closure_row_[l] + 1] = gap.y;
  }
  for (int s = 0; s < stops(); ++s) c[stop_row(s)] = stops_[s].on.value(at(pose));
}

template <class T>
void Mechanism<T>::jacobian(Planar<T>* pose, T* values) const {
  std::fill(values, values + jacobian_row_.size(), T(0));
  for (std::size_t e = 0; e < closure_coordinate_.size(); ++e) {
    const int t = closure_coordinate_[e];
    const Planar<T> c_phi = closure_coefficient_[e] * pose[t];
    if (t < angles()) {
      values[closure_own_[e]] -= c_phi.y;
      values[closure_own_[e] + 1] += c_phi.x;
      continue;
    }
    const Planar<T> along = closure_coefficient_[e] * line_direction(pose, t);
    values[closure_own_[e]] += along.x;
    values[closure_own_[e] + 1] += along.y;
    if (closure_frame_[e] < 0) continue;
    values[closure_frame_[e]] -= c_phi.y;
    values[closure_frame_[e] + 1] += c_phi.x;
  }
  for (const Limit& stop : stops_) {
    stop.on.gradient(at(pose), [&](int i, const T& by) { values[stop.entry[i]] = by; });
  }
}

template <class T>
void Mechanism<T>::tangent(Planar<T>* pose, const T* multiplier, T* values) const {
  const int n = coordinates();
  const int n_angles = angles();
  std::fill(values + n_angles, values + tangent_row_.size(), T(0));
  // Loads and closures are both linear in the phasors: Re(b phi) has the second derivatives -Re(b phi) in an angle,
  // -Im(b exp(i theta_f)) between a length and its frame.
  for (int k = 0; k < n_angles; ++k) values[k] = load_[k].x * pose[k].x - load_[k].y * pose[k].y;
  const auto bend_length = [&](int t, const Planar<T>& b) {
    if (frame(t) < 0) return;
    values[frame(t)] += b.y * pose[t].y - b.x * pose[t].x;
    const Planar<T>& along = line_direction(pose, t);
    const T mixed = -(b.x * along.y + b.y * along.x);
    values[slide_entry_[t - n_angles]] += mixed;
    if (slide_transposed_[t - n_angles] >= 0) values[slide_transposed_[t - n_angles]] += mixed;
  };
  for (int t = n_angles; t < n; ++t) bend_length(t, -load_[t]);
  for (int l = 0; l < closures(); ++l) {
    const Planar<T> pull = {multiplier[closure_row_[l]], -multiplier[closure_row_[l] + 1]};
    for (int e = closure_first_[l]; e < closure_first_[l + 1]; ++e) {
      const int t = closure_coordinate_[e];
      const Planar<T> b = pull * closure_coefficient_[e];
      if (t < n_angles)
        values[t] += b.y * pose[t].y - b.x * pose[t].x;
      else
        bend_length(t, b);
    }
  }
  const Configuration<T> here = at(pose);
  for (const ForceElement& e : elements_) {
    if (!stores_energy(e.law)) continue;
    const LawForce<T> force = force_at_rest(e.law, e.on.value(here));
    if (is_just(force.value, 0.0) && is_just(force.by_measure, 0.0)) continue;
    e.on.curvature(here, force.value, force.by_measure,
                   [&](int i, int j, const T& value) { e.block.add(i, j, value, values); });
  }
  for (int s = 0; s < stops(); ++s) {
    const Limit& stop = stops_[s];
    const T& push = multiplier[stop_row(s)];
    if (is_just(push, 0.0)) continue;
    stop.on.curvature(here, push, T(0), [&](int i, int j, const T& value) { stop.block.add(i, j, value, values); });
  }
  for (const Follower& f : followers_) {
    const Planar<T> force = world_force(f.force, f.frame, pose);
    f.path.second_derivative(
        phasors_, pose, [&](int i, int j, const Planar<T>& d_ij) { f.block.add(i, j, -dot(force, d_ij), values); });
    if (f.frame < 0) continue;
    f.path.derivative(phasors_, pose, here.scratch);
    for (int i = 0; i < f.path.size(); ++i) {
      values[f.frame_entry[i]] -= dot(quarter_turn(force), here.scratch[i]);
    }
  }
}

template <class T>
std::vector<BodyPose<T>> Mechanism<T>::poses(const T* q, const Vec2& from) const {
  const auto value = [&](int t) { return t < coordinates() ? q[t] : static_cast<T>(layout_.coordinates[t].start); };
  std::vector<Planar<T>> turned;  // each angle's, which several arms share
  for (int k = 0; k < layout_.angles; ++k) turned.push_back(unit(q[k]));
  std::vector<BodyPose<T>> out(layout_.links.size());
  out[0].origin = -planar_cast<T>(from);
  for (int i : layout_.tree_order) {
    const Link& link = layout_.links[i];
    out[i].angle = layout_.turns[link.turn].template to<T>() + (link.frame < 0 ? T(0) : value(link.frame));
    if (link.parent >= 0) out[i].origin = out[link.parent].origin;
    for (const Arm& arm : link.arms) {
      Planar<T> term = phasors_.coefficient(arm);
      if (arm.coordinate >= 0) {
        const bool is_angle = layout_.coordinates[arm.coordinate].kind == Coordinate::Kind::angle;
        const int f = is_angle ? arm.coordinate : layout_.coordinates[arm.coordinate].frame;
        if (f >= 0) term = term * (f < layout_.angles ? turned[f] : unit(value(f)));
        if (!is_angle) term = value(arm.coordinate) * term;
      }
      out[i].origin += term;
    }
  }
  return out;
}

}  // namespace poise

#include "model/mechanism_motion_impl.hpp"
