#include "motion/bearing_loads.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include <ceres/jet.h>

#include "model/numbers.hpp"
#include "solvers/real50.hpp"
#include "statics/bodies/contact_loads.hpp"

namespace poise {

template <class T, class NumbersOfScene>
BearingLoads<T, NumbersOfScene>::BearingLoads(const NumbersOfScene& numbers, const Mechanism<T>& mechanism,
                                              const std::vector<int>& joints)
    : numbers_(numbers), phasors_(mechanism.phasors()) {
  const Scene& scene = numbers.scene();
  int holding = 0;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    if (!stop.holds()) continue;
    const int own = holding++;
    if (!loads_bearings(stop)) continue;
    const std::vector<int> loaded = loaded_joints(scene, stop);
    const auto first = std::find_first_of(joints.begin(), joints.end(), loaded.begin(), loaded.end());
    if (first == joints.end()) continue;
    contacts_.push_back({static_cast<int>(s), own, *first, separates(stop), contact_place(scene, stop)});
  }
  if (contacts_.empty()) return;
  const Layout& layout = mechanism.layout();
  std::size_t support = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Link& link = layout.links[b];
    Body body;
    body.origin = {phasors_, layout.path(0, {}, static_cast<int>(b), {})};
    body.turn = phasors_.turn(link.turn);
    if (link.frame >= layout.kept) body.turn += static_cast<T>(layout.coordinates[link.frame].start);
    body.frame = link.frame < layout.kept ? link.frame : -1;
    support = std::max(support, body.origin.support().size());
    bodies_.push_back(std::move(body));
  }
  poses_.resize(bodies_.size());
  derivative_.resize(support);
}

template <class T, class NumbersOfScene>
void BearingLoads<T, NumbersOfScene>::place(const T* q, const Planar<T>* pose) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    poses_[b] = {body.origin.at(pose), body.frame < 0 ? body.turn : T(body.turn + q[body.frame])};
  }
}

// The force at a point of the world is one at the origin and its moment about that.
template <class T, class NumbersOfScene>
void BearingLoads<T, NumbersOfScene>::act(int body, const Planar<T>& force, const Planar<T>& at, const Planar<T>* pose,
                                          T* g) const {
  const Body& on = bodies_[static_cast<std::size_t>(body)];
  on.origin.derivative(phasors_, pose, derivative_.data());
  for (int i = 0; i < on.origin.size(); ++i) g[on.origin.support()[i]] -= dot(force, derivative_[i]);
  if (on.frame >= 0) g[on.frame] -= cross(at - poses_[static_cast<std::size_t>(body)].origin, force);
}

template <class T, class NumbersOfScene>
bool BearingLoads<T, NumbersOfScene>::add(const Contact& contact, const T& effort, const T& size, const Planar<T>* pose,
                                          T* g) const {
  const std::optional<ContactLoad<T>> load = contact_load(BodyForces(numbers_, poses_), contact.stop, contact.place);
  if (!load) return false;
  const Planar<T> force = effort * load->force + size * load->separating;
  act(load->body_b, force, load->at, pose, g);
  act(load->body_a, -force, load->at, pose, g);
  return true;
}

template <class T, class NumbersOfScene>
void BearingLoads<T, NumbersOfScene>::add_change(const Contact& contact, const T& effort, const T& size,
                                                 const Planar<T>* pose, const T* dq, T* g) const {
  using Dual = ceres::Jet<T, 1>;
  const auto dual = [](const T& value, const T& change) {
    Dual out(value);
    out.v[0] = change;
    return out;
  };
  const auto value = [](const Planar<Dual>& p) { return Planar<T>{p.x.a, p.y.a}; };
  const auto change = [](const Planar<Dual>& p) { return Planar<T>{p.x.v[0], p.y.v[0]}; };
  std::vector<BodyPose<Dual>> poses(poses_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = bodies_[b];
    body.origin.derivative(phasors_, pose, derivative_.data());
    const Planar<T> moved = body.origin.along(derivative_.data(), dq);
    const BodyPose<T>& at = poses_[b];
    poses[b] = {{dual(at.origin.x, moved.x), dual(at.origin.y, moved.y)},
                dual(at.angle, body.frame < 0 ? T(0) : dq[body.frame])};
  }
  const ContactLoad<Dual> load = contact_load(BodyForces(numbers_.scene(), poses), contact.stop, contact.place).value();
  const Planar<Dual> whole = Dual(effort) * load.force + Dual(size) * load.separating;
  const auto add_to = [&](int index, const T& sign) {
    const Body& body = bodies_[static_cast<std::size_t>(index)];
    const Planar<Dual>& origin = poses[static_cast<std::size_t>(index)].origin;
    const Planar<T> force = sign * value(whole);
    const std::vector<int>& support = body.origin.support();
    body.origin.bend(
        phasors_, pose, dq, [&](const Planar<T>& v) { return dot(force, v); },
        [&](int i, const T& change_of_g) { g[support[i]] -= change_of_g; });
    if (body.frame >= 0) g[body.frame] -= cross(change(load.at) - change(origin), force);
    act(index, sign * change(whole), value(load.at), pose, g);
  };
  add_to(load.body_b, T(1));
  add_to(load.body_a, T(-1));
}

template class BearingLoads<double>;
template class BearingLoads<long double>;
template class BearingLoads<Real50>;

// Variations need no changes of changes.
using OfNumber = ceres::Jet<double, 1>;
template BearingLoads<OfNumber, Numbers<OfNumber>>::BearingLoads(const Numbers<OfNumber>&, const Mechanism<OfNumber>&,
                                                                 const std::vector<int>&);
template void BearingLoads<OfNumber, Numbers<OfNumber>>::place(const OfNumber*, const Planar<OfNumber>*);
template bool BearingLoads<OfNumber, Numbers<OfNumber>>::add(const Contact&, const OfNumber&, const OfNumber&,
                                                             const Planar<OfNumber>*, OfNumber*) const;

}  // namespace poise
