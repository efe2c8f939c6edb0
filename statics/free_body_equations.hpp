#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "statics/contact_loads.hpp"

namespace poise {

/// The equations of equilibrium of a scene's bodies, each cut free, in the scalar of their poses:
///
///   A f = -load,
///
/// rows 3 (i - 1) ... of body i: force x and y, N, and moment about its origin over `size`, N; one column per unknown
/// effort of a joint, stop or drive. Poses may be measured from any point of the world.
template <class Pose>
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

  /// The joint, stop or drive that a set of unknowns belongs to.
  struct Item {
    const std::string* name;
    std::string_view kind;  ///< of a joint, a stop's table, or "drive"
    Planar<T> at{};
    bool axial = false;  ///< its unknown is a pressure: of bars, and of stops and drives on lengths
    int stop = -1;       ///< index of Scene::stops
    /// Of a stop: +1 where it acts at its max, only to reduce its measure, -1 at its min, only to increase it, 2 either
    /// way.
    int side = 0;
  };

  /// Keeps references to the scene and the poses.
  FreeBodyEquations(const Scene& scene, const std::vector<Pose>& poses, double size)
      : scene_(scene), poses_(poses), size_(size) {}

  int rows() const { return 3 * (static_cast<int>(scene_.bodies.size()) - 1); }
  const std::vector<Item>& items() const { return items_; }
  const std::vector<Unknown>& unknowns() const { return unknowns_; }

  /// Weights, forces and torques: calls push(body, at, force, moment).
  template <class Push>
  void push_loads(Push push) const {
    push_named_loads([&](std::string_view, const std::string&, int body, const Planar<T>& at, const Planar<T>& force,
                         const T& moment) { push(body, at, force, moment); });
  }

  /// The same with their sources: push(kind, name, body, at, force, moment), with "weight" of a body, "force",
  /// "torque".
  template <class Push>
  void push_named_loads(Push push) const {
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      if (body.mass == 0) continue;
      push("weight", body.name, static_cast<int>(i), poses_[i].world(body.center),
           T(body.mass) * planar_cast<T>(scene_.gravity), T(0));
    }
    for (const Force& f : scene_.forces) {
      Planar<T> force = planar_cast<T>(f.vector);
      if (f.follows >= 0) force = force * poses_[f.follows].direction();
      const Planar<T> share = scene_.template share_at_points<T>(f) * force;
      f.for_each_point([&](PointRef point) { push("force", f.name, point.body, world(point), share, T(0)); });
    }
    for (const Torque& t : scene_.torques) {
      push("torque", t.name, t.body, poses_[t.body].origin, Planar<T>{}, T(t.value));
    }
  }

  /// The same for the force elements. Returns the static force of each, 0 where it has no direction.
  template <class Push>
  std::vector<T> push_elements(Push push) const {
    std::vector<T> out;
    out.reserve(scene_.elements.size());
    for (const Element& e : scene_.elements) {
      const T force = force_at_rest(e.law, value_of(scene_, e.on, poses_)).value;
      out.push_back(T(0));
      if (force == T(0)) continue;
      for (const UnitEffortOf<T>& effort : unit_efforts(scene_, e.on, poses_)) {
        if (effort.force == Planar<T>{} && effort.moment == T(0)) continue;
        out.back() = force;
        push(effort.body_a, effort.a, force * effort.force, force * effort.moment);
        push(effort.body_b, effort.b, -(force * effort.force), -(force * effort.moment));
      }
    }
    return out;
  }

  /// Force and moment over `size` on body `body`, in the terms of its three equations.
  T turning(int body, const Planar<T>& at, const Planar<T>& force, const T& moment) const {
    return (cross(at - poses_[body].origin, force) + moment) / T(size_);
  }

  void add_joints() {
    items_.reserve(scene_.joints.size());
    unknowns_.reserve(2 * scene_.joints.size());
    for (const Joint& joint : scene_.joints) {
      const Planar<T> b = world(joint.b);
      Item& item = add_item(joint.name, joint.traits().key);
      item.at = from_world(b);
      const Planar<T> a = joint.keeps_length() ? world(joint.a) : b;
      const auto act = [&](const Planar<T>& force, const T& moment) {
        unknowns_.push_back({last_item(), joint.a.body, joint.b.body, a, b, force, moment});
      };
      if (joint.keeps_length()) {
        const Planar<T> along = b - a;
        const T r = norm(along);
        item.axial = true;
        act(r > 0 ? T(1) / r * along : Planar<T>{T(1), T(0)}, T(0));
      } else if (joint.has_travel()) {
        act(quarter_turn(body_measures::axis_of(joint, poses_)), T(0));
      } else {
        add_pin(joint.a, joint.b);
      }
      if (joint.keeps_angle()) act({}, T(size_));
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
      add_measure(stop.on);
    const std::optional<ContactLoad<T>> contact = contact_load(scene_, stop, poses_);
    if (!contact) return;
    unknowns_.back().is_replaced = true;
    unknowns_.back().with = {unknown_of(*contact, contact->force + sign * contact->separating, stop)};
  }

  /// What a unit of |effort| of a coupling's teeth pushes its wheels apart by: of the same item as add_stop() of it
  /// before.
  void add_separation(int index) {
    const Stop& stop = scene_.stops[index];
    if (const std::optional<ContactLoad<T>> contact = contact_load(scene_, stop, poses_)) {
      unknowns_.push_back(unknown_of(*contact, contact->separating, stop));
    }
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
    const std::vector<UnitEffortOf<T>> spans = unit_efforts(scene_, rope.on, poses_);
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
  Planar<T> world(PointRef p) const { return body_measures::world(scene_, poses_, p); }
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
    const Planar<T> at = world(b);
    items_.back().at = from_world(at);
    for (const Planar<T>& force : {Planar<T>{T(1), T(0)}, Planar<T>{T(0), T(1)}}) {
      unknowns_.push_back({last_item(), a.body, b.body, at, at, force, T(0)});
    }
  }

  // The unknown effort on a measure, positive if it tends to increase it. The terms of a sum act together, each with
  // its factor; that of the item is the first, of a rope the last of its parts. Distances of zero have no direction in
  // which anything could act; if there is nothing else, there is no unknown.
  void add_measure(const Measure& measure) {
    Item& item = items_.back();
    item.axial = !measure.is_angle();
    std::vector<UnitEffortOf<T>> efforts = unit_efforts(scene_, measure, poses_);
    std::reverse(efforts.begin(), efforts.begin() + static_cast<std::ptrdiff_t>(efforts_of_first(measure)));
    item.at = from_world(efforts.front().b);
    bool is_first = true;
    for (const UnitEffortOf<T>& effort : efforts) {
      if (effort.force == Planar<T>{} && effort.moment == T(0)) continue;
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
        if (value != T(0)) visit(at, opposite ? T(-value) : value);
      };
      entry(row, k.force.x);
      entry(row + 1, k.force.y);
      entry(row + 2, turning(body, k.at, k.force, k.moment));
    }
  }

  const Scene& scene_;
  const std::vector<Pose>& poses_;
  double size_;
  std::vector<Item> items_;
  std::vector<Unknown> unknowns_;
};

}  // namespace poise
