#pragma once

// The equations of equilibrium of a scene with all of its numbers as variables: for derivatives by the numbers, and for
// scenes that differ in numbers only. Bodies are cut free (statics/bodies/body_forces.hpp), so that every joint force
// is an unknown and every number of a scene file stands where it acts; equations of the compiled mechanism
// (model/mechanism.hpp) have sums of numbers.

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/number_list.hpp"
#include "model/numbers.hpp"
#include "statics/bodies/contact_loads.hpp"

namespace poise {

/// A stop that acts, on one side.
struct ActingStop {
  int stop = 0;  ///< index of Scene::stops
  bool upper = false;
};

/// The resultant of forces on the ground, about the origin of the world.
template <class T>
struct GroundForce {
  Planar<T> force{};
  T moment{};

  void add(const Planar<T>& at, const Planar<T>& of, const T& couple) {
    force += of;
    moment += cross(at, of) + couple;
  }
};

/// Unknowns z: origin x, y and angle of each body but the ground (3 (i - 1) of body i), then one multiplier per row of
/// the joints and of the stops that act. Residual R(z, p), of the same size:
///
///   balance of body i     sum of forces x, y; sum of moments about its origin,
///   joints                pin, weld: b - a = 0; slide, pin in slot: axis x (b - a) = 0; slide, weld: angle(b) -
///   angle(a)
///                         - angle = 0; bar: |b - a| - length = 0,
///   a stop that acts      g - bound = 0.
///
/// Multipliers are efforts on body b, their opposites on a: force x, y of a pin, force normal to the axis of a slide,
/// moment, pressure of a bar, and of a stop what tends to increase its measure. Numbers p are those of a NumberList of
/// the scene, which is measured in scales of its own (scaled()).
class NumberedEquations {
 public:
  template <class T>
  using Placed = PlacedBody<T>;
  template <class T>
  using Bodies = BodyForces<Placed<T>, Numbers<T>>;

  NumberedEquations(const Scene& scene, std::vector<ActingStop> acting);
  NumberedEquations(std::shared_ptr<const NumberList> list, std::vector<ActingStop> acting);

  const std::shared_ptr<const NumberList>& list() const { return list_; }
  const Scene& scene() const { return list_->scene(); }
  const std::vector<ParameterRow>& rows() const { return list_->rows(); }
  /// p of the scene.
  const std::vector<double>& numbers() const { return list_->values(); }
  const std::vector<ActingStop>& acting() const { return acting_; }
  int unknowns() const { return unknowns_; }
  int poses() const { return 3 * (static_cast<int>(scene().bodies.size()) - 1); }
  /// First multiplier of a joint, and that of an acting stop (place in acting()).
  int multiplier_of_joint(int joint) const { return joint_[static_cast<std::size_t>(joint)]; }
  int multiplier_of_stop(int acting) const { return stop_[static_cast<std::size_t>(acting)]; }
  /// Adds whole turns to the constant angles of joints, of which scenes leave them out, so that they fit z.
  void count_turns(const double* z);

  /// R(z, p); r has unknowns() values. Leaves the bodies at z in `placed`.
  template <class T>
  void residual(const T* numbers, const T* z, T* r, std::vector<Placed<T>>& placed) const;
  /// The bodies at z.
  template <class T>
  void place(const T* z, std::vector<Placed<T>>& placed) const;
  /// Measures and forces with these numbers where place() or residual() has left the bodies; refers to both.
  template <class T>
  Bodies<T> bodies(const T* numbers, const std::vector<Placed<T>>& placed) const {
    return {Numbers<T>(*list_, numbers), placed};
  }
  /// Generalized forces on the places of the bodies, poses() values: of an effort of 1 on the row of a multiplier,
  /// which is the derivative of that row; and of one on a measure, the same of that.
  template <class T>
  std::vector<T> row_gradient(int multiplier, const Bodies<T>& bodies, const std::vector<Placed<T>>& placed) const;
  template <class T>
  std::vector<T> measure_gradient(const Measure& on, const Bodies<T>& bodies,
                                  const std::vector<Placed<T>>& placed) const;
  /// What the mechanism exerts on the ground at z through joints, acting stops and elements: the resultant, with its
  /// moment about the origin of the world. Loads on the ground itself are left out.
  template <class T>
  GroundForce<T> on_ground(const Bodies<T>& bodies, const T* z) const;
  /// Adds those of all loads and elements to r.
  template <class T>
  void push_applied(const Bodies<T>& bodies, const std::vector<Placed<T>>& placed, T* r) const;
  /// A gear or rack that acts on a joint by |Q|, where Q is at most `nothing`, so that there are no derivatives; null
  /// without one.
  const Stop* idle_teeth(int joint, const std::vector<double>& z, double nothing) const;

 private:
  template <class T>
  void add_joint(int joint, const Bodies<T>& bodies, const std::vector<Placed<T>>& placed, const T* z, T* r) const;
  template <class T>
  void add_stop(int acting, const Bodies<T>& bodies, const std::vector<Placed<T>>& placed, const T* z, T* r) const;
  /// Calls visit(UnitEffortOf<T>) for all that an acting stop does with this effort on its measure.
  template <class T, class Visit>
  void for_each_stop_effort(int acting, const Bodies<T>& bodies, const T& effort, Visit visit) const;
  /// Adds a force at a point of the world, and a moment, on a body.
  template <class T>
  static void push(int body, const Planar<T>& at, const Planar<T>& force, const T& moment,
                   const std::vector<Placed<T>>& placed, T* r) {
    if (body == 0) return;
    T* row = r + 3 * (body - 1);
    row[0] += force.x;
    row[1] += force.y;
    row[2] += cross(at - placed[static_cast<std::size_t>(body)].origin, force) + moment;
  }
  /// Adds an effort on body b, and its opposite on a.
  template <class T>
  static void push(const UnitEffortOf<T>& effort, const std::vector<Placed<T>>& placed, T* r) {
    push(effort.body_a, effort.a, -effort.force, T(-effort.moment), placed, r);
    push(effort.body_b, effort.b, effort.force, effort.moment, placed, r);
  }

  std::shared_ptr<const NumberList> list_;
  std::vector<ActingStop> acting_;
  int unknowns_ = 0;
  std::vector<int> joint_, stop_;                     // first multipliers
  std::vector<std::optional<ContactPlace>> contact_;  // of each acting stop that loads bearings
  std::vector<double> turns_;                         // of each joint, rad
};

template <class T>
void NumberedEquations::place(const T* z, std::vector<Placed<T>>& placed) const {
  placed.resize(scene().bodies.size());
  for (std::size_t i = 1; i < placed.size(); ++i) {
    const T* at = z + 3 * (i - 1);
    placed[i].origin = {at[0], at[1]};
    placed[i].angle = at[2];
    placed[i].along = unit(at[2]);
  }
}

template <class T>
void NumberedEquations::add_joint(int joint, const Bodies<T>& bodies, const std::vector<Placed<T>>& placed, const T* z,
                                  T* r) const {
  const Joint& of = scene().joints[static_cast<std::size_t>(joint)];
  const UnitEffortOf<T> effort = bodies.joint_effort(joint, z + multiplier_of_joint(joint));
  push(effort, placed, r);
  T* gap = r + multiplier_of_joint(joint);
  const Planar<T> apart = effort.b - bodies.world(of.a);
  if (of.keeps_length()) {
    *gap = norm(apart) - bodies.numbers().kept_by(joint);
    return;
  }
  if (of.has_travel()) {
    *gap++ = cross(bodies.axis(joint), apart);
  } else {
    *gap++ = apart.x;
    *gap++ = apart.y;
  }
  if (!of.keeps_angle()) return;
  const T angle = placed[static_cast<std::size_t>(of.b.body)].angle - placed[static_cast<std::size_t>(of.a.body)].angle;
  *gap = angle - bodies.numbers().kept_by(joint) - T(turns_[static_cast<std::size_t>(joint)]);
}

template <class T, class Visit>
void NumberedEquations::for_each_stop_effort(int acting, const Bodies<T>& bodies, const T& effort, Visit visit) const {
  using std::abs;
  const int stop = acting_[static_cast<std::size_t>(acting)].stop;
  const std::optional<ContactPlace>& place = contact_[static_cast<std::size_t>(acting)];
  const std::optional<ContactLoad<T>> load = place ? contact_load(bodies, stop, *place) : std::nullopt;
  if (load) {
    const Planar<T> force = effort * load->force + T(abs(effort)) * load->separating;
    visit(UnitEffortOf<T>{load->body_a, load->body_b, load->at, load->at, force, T(0)});
  } else {
    bodies.for_each_effort(scene().stops[static_cast<std::size_t>(stop)].on, effort, visit, stop);
  }
}

template <class T>
void NumberedEquations::add_stop(int acting, const Bodies<T>& bodies, const std::vector<Placed<T>>& placed, const T* z,
                                 T* r) const {
  const auto [stop, upper] = acting_[static_cast<std::size_t>(acting)];
  const int row = multiplier_of_stop(acting);
  for_each_stop_effort(acting, bodies, z[row], [&](const UnitEffortOf<T>& on) { push(on, placed, r); });
  r[row] = bodies.overrun(stop, upper);
}

template <class T>
GroundForce<T> NumberedEquations::on_ground(const Bodies<T>& bodies, const T* z) const {
  GroundForce<T> out;
  const auto add = [&](const UnitEffortOf<T>& on) {
    if (on.body_a == 0) out.add(on.a, -on.force, T(-on.moment));
    if (on.body_b == 0) out.add(on.b, on.force, on.moment);
  };
  for (int j = 0; j < static_cast<int>(scene().joints.size()); ++j) {
    add(bodies.joint_effort(j, z + multiplier_of_joint(j)));
  }
  for (int h = 0; h < static_cast<int>(acting_.size()); ++h) {
    for_each_stop_effort(h, bodies, z[multiplier_of_stop(h)], add);
  }
  for (int e = 0; e < static_cast<int>(scene().elements.size()); ++e) {
    bodies.push_element(e, [&](int body, const Planar<T>& at, const Planar<T>& force, const T& moment) {
      if (body == 0) out.add(at, force, moment);
    });
  }
  return out;
}

template <class T>
std::vector<T> NumberedEquations::row_gradient(int multiplier, const Bodies<T>& bodies,
                                               const std::vector<Placed<T>>& placed) const {
  std::vector<T> out(static_cast<std::size_t>(poses()), T(0));
  for (std::size_t h = 0; h < acting_.size(); ++h) {
    if (stop_[h] != multiplier) continue;
    bodies.for_each_effort(
        scene().stops[static_cast<std::size_t>(acting_[h].stop)].on, T(1),
        [&](const UnitEffortOf<T>& on) { push(on, placed, out.data()); }, acting_[h].stop);
    return out;
  }
  std::size_t joint = joint_.size() - 1;
  while (joint_[joint] > multiplier) --joint;
  std::array<T, 3> unit{T(0), T(0), T(0)};
  unit[static_cast<std::size_t>(multiplier - joint_[joint])] = T(1);
  push(bodies.joint_effort(static_cast<int>(joint), unit.data()), placed, out.data());
  return out;
}

template <class T>
std::vector<T> NumberedEquations::measure_gradient(const Measure& on, const Bodies<T>& bodies,
                                                   const std::vector<Placed<T>>& placed) const {
  std::vector<T> out(static_cast<std::size_t>(poses()), T(0));
  bodies.for_each_effort(on, T(1), [&](const UnitEffortOf<T>& unit) { push(unit, placed, out.data()); });
  return out;
}

template <class T>
void NumberedEquations::push_applied(const Bodies<T>& bodies, const std::vector<Placed<T>>& placed, T* r) const {
  const auto push_on = [&](int body, const Planar<T>& at, const Planar<T>& force, const T& moment) {
    push(body, at, force, moment, placed, r);
  };
  bodies.push_loads([&](std::string_view, const std::string&, int body, const Planar<T>& at, const Planar<T>& force,
                        const T& moment) { push_on(body, at, force, moment); });
  for (int e = 0; e < static_cast<int>(scene().elements.size()); ++e) bodies.push_element(e, push_on);
}

template <class T>
void NumberedEquations::residual(const T* numbers, const T* z, T* r, std::vector<Placed<T>>& placed) const {
  place(z, placed);
  for (int i = 0; i < unknowns_; ++i) r[i] = T(0);
  const Bodies<T> bodies = this->bodies(numbers, placed);
  push_applied(bodies, placed, r);
  for (int j = 0; j < static_cast<int>(scene().joints.size()); ++j) add_joint(j, bodies, placed, z, r);
  for (int h = 0; h < static_cast<int>(acting_.size()); ++h) add_stop(h, bodies, placed, z, r);
}

}  // namespace poise
