#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "statics/bodies/contact_loads.hpp"

namespace poise {

/// The equations of equilibrium of a scene's bodies, each cut free, in the scalar of their poses and of the scene's
/// numbers (BodyForces):
///
///   A f = -load,
///
/// rows 3 (i - 1) ... of body i: force x and y, N, and moment about its origin over `size`, N; one column per unknown
/// effort of a joint, stop, blade or drive. Poses may be measured from any point of the world.
template <class Pose, class NumbersOfScene = SceneNumbers<ScalarOf<Pose>>>
class FreeBodyEquations {
 public:
  using T = ScalarOf<Pose>;

  /// A unit of an unknown effort: force, N, and moment, N m, on body b at a point, the opposite on body a.
  struct Unknown {
    int item;  ///< index into items(), or -1
    int body_a, body_b;
    Planar<T> at_a, at;  ///< the same line of action, where there is no moment
    Planar<T> force;
    T moment;
    std::vector<Unknown> with{};  ///< further terms of the same unknown, of a sum
    bool is_replaced = false;     ///< only the further terms act: the force of a coupling where its parts touch
  };

  /// The joint, stop, blade or drive that a set of unknowns belongs to.
  struct Item {
    const std::string* name;
    std::string_view kind;  ///< of a joint, a stop's table, "blade" or "drive"
    Planar<T> at{};
    bool axial = false;  ///< its unknown is a pressure: of bars, and of stops and drives on lengths
    int joint = -1;      ///< index of Scene::joints
    int stop = -1;       ///< index of Scene::stops
    /// Of a stop: +1 where it acts at its max, only to reduce its measure, -1 at its min, only to increase it, 2 either
    /// way.
    int side = 0;
  };

  /// Keeps references to the scene and the poses.
  FreeBodyEquations(const Scene& scene, const std::vector<Pose>& poses, double size)
      : FreeBodyEquations(BodyForces<Pose>(scene, poses), poses, size) {}
  FreeBodyEquations(const BodyForces<Pose, NumbersOfScene>& bodies, const std::vector<Pose>& poses, double size)
      : bodies_(bodies), scene_(bodies.scene()), poses_(poses), size_(size) {}

  int rows() const { return 3 * (static_cast<int>(scene_.bodies.size()) - 1); }
  const std::vector<Item>& items() const { return items_; }
  const std::vector<Unknown>& unknowns() const { return unknowns_; }

  /// Weights, forces and torques: calls push(body, at, force, moment).
  template <class Push>
  void push_loads(Push push) const {
    bodies_.push_loads([&](std::string_view, const std::string&, int body, const Planar<T>& at, const Planar<T>& force,
                           const T& moment) { push(body, at, force, moment); });
  }

  /// The same for the force elements. Returns the static force of each, 0 where it has no direction.
  template <class Push>
  std::vector<T> push_elements(Push push) const {
    std::vector<T> out;
    out.reserve(scene_.elements.size());
    for (int e = 0; e < static_cast<int>(scene_.elements.size()); ++e) out.push_back(bodies_.push_element(e, push));
    return out;
  }

  /// Force and moment over `size` on body `body`, in the terms of its three equations.
  T turning(int body, const Planar<T>& at, const Planar<T>& force, const T& moment) const {
    return (cross(at - poses_[body].origin, force) + moment) / T(size_);
  }

  void add_joints() {
    items_.reserve(scene_.joints.size());
    unknowns_.reserve(2 * scene_.joints.size());
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const Joint& joint = scene_.joints[j];
      Item& item = add_item(joint.name, joint.traits().key);
      item.axial = joint.keeps_length();
      item.joint = static_cast<int>(j);
      bodies_.for_each_joint_effort(static_cast<int>(j), [&](const UnitEffortOf<T>& effort) {
        item.at = from_world(effort.b);
        unknowns_.push_back(
            {last_item(), effort.body_a, effort.body_b, effort.a, effort.b, effort.force, T(size_) * effort.moment});
      });
    }
  }

  /// A stop that acts on the side of an Item. A distance that is at most zero is a pin: it holds its points together by
  /// a force in any direction. Of a coupling that loads bearings its contact force acts where it touches, of teeth that
  /// push their wheels apart by `sign` times that: the sign of the effort on its measure.
  void add_stop(int index, int side, const T& sign = T(0)) {
    const Stop& stop = scene_.stops[index];
    const bool is_pin = stop.on.kind == Measure::Kind::distance && stop.max <= 0.0;
    Item& item = add_item(stop.name, stop.table);
    item.stop = index;
    item.side = is_pin ? 2 : side;
    if (is_pin)
      add_pin(stop.on.a, stop.on.b);
    else
      add_measure(stop.on, index);
    const std::optional<ContactLoad<T>> contact = contact_load(bodies_, index);
    if (!contact) return;
    unknowns_.back().is_replaced = true;
    unknowns_.back().with = {unknown_of(*contact, contact->force + sign * contact->separating, stop)};
  }

  /// What a unit of |effort| of a coupling's teeth pushes its wheels apart by: of the same item as add_stop() of it
  /// before.
  void add_separation(int index) {
    const Stop& stop = scene_.stops[index];
    if (const std::optional<ContactLoad<T>> contact = contact_load(bodies_, index)) {
      unknowns_.push_back(unknown_of(*contact, contact->separating, stop));
    }
  }

  /// The force across the edge of a blade, to its left, on the body of its point.
  void add_blade(int index) {
    using std::cos;
    using std::sin;
    const Blade& blade = scene_.blades[static_cast<std::size_t>(index)];
    const T angle = bodies_.numbers().blade_angle(index);
    const Planar<T> edge = Planar<T>{cos(angle), sin(angle)} * poses_[blade.at.body].direction();
    const Planar<T> at = bodies_.world(blade.at);
    add_item(blade.name, "blade").at = from_world(at);
    unknowns_.push_back({last_item(), blade.on, blade.at.body, at, at, quarter_turn(edge), T(0)});
  }

  void add_drive(const Drive& drive) {
    add_item(drive.name, "drive");
    add_measure(drive.on);
  }

  /// An effort that is no reaction: the scene has no joint or stop for it.
  void add_effort(const UnitEffortOf<T>& effort) {
    unknowns_.push_back(unknown_of(effort, true));
    unknowns_.back().item = -1;
  }

  /// The part of a rope behind one of its contacts, that point included: what pulls more, or less, by friction on it. A
  /// reaction of its own.
  void add_rope_behind(const Stop& rope, int contact) {
    Item& item = add_item(rope.name, rope.table);
    item.axial = true;
    bool is_first = true;
    const std::vector<UnitEffortOf<T>> spans = efforts_on(rope.on);
    for (std::size_t k = static_cast<std::size_t>(contact); k < spans.size(); ++k) {
      if (is_first)
        unknowns_.push_back(unknown_of(spans[k], false));
      else
        unknowns_.back().with.push_back(unknown_of(spans[k], false));
      is_first = false;
    }
  }

  /// Calls act(body, at, force, moment) for what a unit of an unknown does to each body, the ground too, at each point.
  template <class Act>
  void for_each_action(const Unknown& unknown, Act act) const {
    const auto of = [&](const Unknown& term) {
      act(term.body_b, from_world(term.at), term.force, term.moment);
      act(term.body_a, from_world(term.at_a), Planar<T>{} - term.force, T(0) - term.moment);
    };
    if (!unknown.is_replaced) of(unknown);
    for (const Unknown& term : unknown.with) of(term);
  }

  /// Calls visit(row, value) for the entries of A in the column of an unknown, several for a row in case.
  template <class Visit>
  void for_each_entry(const Unknown& unknown, Visit visit) const {
    if (!unknown.is_replaced) add_entries(unknown, visit);
    for (const Unknown& term : unknown.with) add_entries(term, visit);
  }

 private:
  int last_item() const { return static_cast<int>(items_.size()) - 1; }
  Item& add_item(const std::string& name, std::string_view kind) { return items_.emplace_back(Item{&name, kind}); }
  std::vector<UnitEffortOf<T>> efforts_on(const Measure& measure, int stop = -1) const {
    std::vector<UnitEffortOf<T>> out;
    bodies_.for_each_effort(
        measure, T(1), [&](const UnitEffortOf<T>& effort) { out.push_back(effort); }, stop);
    return out;
  }
  Planar<T> from_world(const Planar<T>& at) const { return at - poses_[0].origin; }

  // In N: of an effort on an angle its moment over the size, and what forces belong to it in a sum. In a sum of angles
  // and lengths moments belong to a force.
  Unknown unknown_of(const UnitEffortOf<T>& effort, bool is_torque) const {
    const T scale = is_torque ? T(size_) : T(1);
    return {last_item(), effort.body_a, effort.body_b, effort.a, effort.b, scale * effort.force, scale * effort.moment};
  }

  // In N, as that of the effort on the stop's measure.
  Unknown unknown_of(const ContactLoad<T>& contact, const Planar<T>& force, const Stop& stop) const {
    const T unit(stop.on.is_angle() ? size_ : 1.0);
    return {last_item(), contact.body_a, contact.body_b, contact.at, contact.at, unit * force, T(0)};
  }

  void add_pin(PointRef a, PointRef b) {
    const Planar<T> at = bodies_.world(b);
    items_.back().at = from_world(at);
    for (const Planar<T>& force : {Planar<T>{T(1), T(0)}, Planar<T>{T(0), T(1)}}) {
      unknowns_.push_back({last_item(), a.body, b.body, at, at, force, T(0)});
    }
  }

  // The unknown effort on a measure, positive if it tends to increase it. The terms of a sum act together, each with
  // its factor; that of the item is the first, of a rope the last of its parts. Distances of zero have no direction in
  // which anything could act; if there is nothing else, there is no unknown, and in some lanes of several a zero one.
  void add_measure(const Measure& measure, int stop = -1) {
    Item& item = items_.back();
    item.axial = !measure.is_angle();
    std::vector<UnitEffortOf<T>> efforts = efforts_on(measure, stop);
    std::reverse(efforts.begin(), efforts.begin() + static_cast<std::ptrdiff_t>(efforts_of_first(measure)));
    item.at = from_world(efforts.front().b);
    bool is_first = true;
    for (const UnitEffortOf<T>& effort : efforts) {
      if (body_forces::is_nothing(effort.force, effort.moment)) continue;
      if (is_first) {
        item.at = from_world(effort.b);
        unknowns_.push_back(unknown_of(effort, measure.is_angle()));
      } else {
        unknowns_.back().with.push_back(unknown_of(effort, measure.is_angle()));
      }
      is_first = false;
    }
  }

  // How many unit efforts belong to the measure, or to the first of a sum.
  static std::size_t efforts_of_first(const Measure& measure) {
    if (measure.kind == Measure::Kind::rope) return measure.contacts.size() - 1;
    return measure.kind == Measure::Kind::sum ? efforts_of_first(measure.terms.front().measure) : 1;
  }

  template <class Visit>
  void add_entries(const Unknown& k, Visit visit) const {
    for (const bool opposite : {true, false}) {
      const int body = opposite ? k.body_a : k.body_b;
      if (body == 0) continue;
      const int row = 3 * (body - 1);
      const auto entry = [&](int at, const T& value) {
        if (any(value != T(0))) visit(at, opposite ? T(-value) : value);
      };
      entry(row, k.force.x);
      entry(row + 1, k.force.y);
      entry(row + 2, turning(body, k.at, k.force, k.moment));
    }
  }

  BodyForces<Pose, NumbersOfScene> bodies_;
  const Scene& scene_;
  const std::vector<Pose>& poses_;
  double size_;
  std::vector<Item> items_;
  std::vector<Unknown> unknowns_;
};

template <class Pose>
FreeBodyEquations(const Scene&, const std::vector<Pose>&, double) -> FreeBodyEquations<Pose>;

}  // namespace poise
