#include "exchange/private/joint_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_set>

#include <fmt/format.h>

#include "exchange/private/reading.hpp"

namespace poise {
namespace {

Vec2 turned(Vec2 v, double angle) { return angle == 0.0 ? v : v * unit(angle); }

// Which joints are in the tree first.
int rank_of(const Joint& joint) {
  switch (joint.kind) {
    case Joint::Kind::weld:
      return 0;
    case Joint::Kind::slide:
      return 1;
    case Joint::Kind::pin_in_slot:
      return 2;
    default:
      return 3;
  }
}

class Groups {
 public:
  explicit Groups(std::size_t count) : leader_(count) { std::iota(leader_.begin(), leader_.end(), 0); }

  int leader(int of) {
    while (leader_[static_cast<std::size_t>(of)] != of) {
      int& next = leader_[static_cast<std::size_t>(of)];
      next = leader_[static_cast<std::size_t>(next)];
      of = next;
    }
    return of;
  }
  // False where they are in one group already.
  bool join(int a, int b) {
    a = leader(a);
    b = leader(b);
    if (a == b) return false;
    leader_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    return true;
  }

 private:
  std::vector<int> leader_;
};

}  // namespace

JointTree::JointTree(const Scene& scene, const std::vector<BodyPose<double>>& poses)
    : poses_(poses), branches_(scene.bodies.size()), travel_of_(scene.joints.size(), -1) {
  grow(scene);
}

void JointTree::grow(const Scene& scene) {
  std::vector<int> joints;
  for (int j = 0; j < static_cast<int>(scene.joints.size()); ++j) {
    if (!scene.joints[static_cast<std::size_t>(j)].keeps_length()) joints.push_back(j);
  }
  std::stable_sort(joints.begin(), joints.end(), [&](int a, int b) {
    return rank_of(scene.joints[static_cast<std::size_t>(a)]) < rank_of(scene.joints[static_cast<std::size_t>(b)]);
  });
  Groups groups(scene.bodies.size());
  std::vector<std::vector<int>> at(scene.bodies.size());
  for (const int j : joints) {
    const Joint& joint = scene.joints[static_cast<std::size_t>(j)];
    if (!groups.join(joint.a.body, joint.b.body)) {
      closures_.push_back(j);
      continue;
    }
    at[static_cast<std::size_t>(joint.a.body)].push_back(j);
    at[static_cast<std::size_t>(joint.b.body)].push_back(j);
  }
  std::vector<bool> is_reached(scene.bodies.size(), false);
  const int count = static_cast<int>(scene.bodies.size());
  for (int root = 0; root < count; ++root) {
    if (is_reached[static_cast<std::size_t>(root)]) continue;
    is_reached[static_cast<std::size_t>(root)] = true;
    std::size_t next = order_.size();
    order_.push_back(root);
    if (root != 0) set_free(scene.bodies[static_cast<std::size_t>(root)].name, root);
    for (; next < order_.size(); ++next) {
      const int parent = order_[next];
      for (const int j : at[static_cast<std::size_t>(parent)]) {
        const Joint& joint = scene.joints[static_cast<std::size_t>(j)];
        const int child = joint.a.body == parent ? joint.b.body : joint.a.body;
        if (is_reached[static_cast<std::size_t>(child)]) continue;
        is_reached[static_cast<std::size_t>(child)] = true;
        hang(scene, child, parent, j);
        order_.push_back(child);
      }
    }
  }
}

int JointTree::add_coordinate(std::string name, bool slides, double value, Vec2 at, Vec2 axis) {
  coordinates_.push_back({std::move(name), slides, value, at, axis});
  return static_cast<int>(coordinates_.size()) - 1;
}

void JointTree::hang(const Scene& scene, int body, int parent, int index) {
  const Joint& joint = scene.joints[static_cast<std::size_t>(index)];
  TreeBranch& branch = branches_[static_cast<std::size_t>(body)];
  branch.parent = parent;
  branch.joint = index;
  branch.is_reversed = joint.a.body == body;
  const BodyPose<double>& pose = poses_[static_cast<std::size_t>(body)];
  const BodyPose<double>& of_parent = poses_[static_cast<std::size_t>(parent)];
  const double sense = branch.is_reversed ? -1.0 : 1.0;
  branch.angle = joint.keeps_angle() ? sense * joint.angle : pose.angle - of_parent.angle;
  const Vec2 a = scene.local(joint.a), b = scene.local(joint.b);
  const Vec2 direction = joint.direction();
  double travel = 0.0;
  if (joint.has_travel()) {
    const BodyPose<double>& of_a = poses_[static_cast<std::size_t>(joint.a.body)];
    const BodyPose<double>& of_b = poses_[static_cast<std::size_t>(joint.b.body)];
    travel = dot(of_b.world(b) - of_a.world(a), direction * unit(of_a.angle));
  }
  const Vec2 moved = a + travel * direction;  // where b is in the frame of the first body
  branch.at = branch.is_reversed ? b - turned(moved, branch.angle) : moved - turned(b, branch.angle);
  const auto add_turn = [&](const std::string& name) {
    branch.coordinates.push_back(add_coordinate(name, false, branch.angle, branch.is_reversed ? moved : b, {}));
  };
  const auto add_travel = [&] {
    const Vec2 axis = branch.is_reversed ? -direction : turned(direction, -branch.angle);
    travel_of_[static_cast<std::size_t>(index)] = add_coordinate(joint.name, true, travel, {}, axis);
    branch.coordinates.push_back(travel_of_[static_cast<std::size_t>(index)]);
  };
  if (joint.has_travel() && joint.keeps_angle()) {
    add_travel();
  } else if (joint.has_travel() && branch.is_reversed) {
    add_turn(joint.name + " turn");
    add_travel();
  } else if (joint.has_travel()) {
    add_travel();
    add_turn(joint.name + " turn");
  } else if (!joint.keeps_angle()) {
    add_turn(joint.name);
  }
}

void JointTree::set_free(const std::string& name, int body) {
  TreeBranch& branch = branches_[static_cast<std::size_t>(body)];
  const BodyPose<double>& pose = poses_[static_cast<std::size_t>(body)];
  branch.parent = 0;
  branch.at = pose.origin;
  branch.angle = pose.angle;
  branch.coordinates = {add_coordinate(name + " x", true, branch.at.x, {}, turned({1.0, 0.0}, -branch.angle)),
                        add_coordinate(name + " y", true, branch.at.y, {}, turned({0.0, 1.0}, -branch.angle)),
                        add_coordinate(name + " angle", false, branch.angle, {}, {})};
}

void JointTree::add_angle(int body, double factor, std::vector<double>& shares, double& constant) const {
  for (; body != 0; body = branch(body).parent) {
    const TreeBranch& at = branch(body);
    const auto turn = std::find_if(at.coordinates.begin(), at.coordinates.end(),
                                   [&](int c) { return !coordinates_[static_cast<std::size_t>(c)].slides; });
    if (turn == at.coordinates.end()) {
      constant += factor * at.angle;
    } else {
      shares[static_cast<std::size_t>(*turn)] += factor;
    }
  }
}

bool JointTree::add_measure(const Measure& measure, double factor, std::vector<double>& shares,
                            double& constant) const {
  switch (measure.kind) {
    case Measure::Kind::angle:
      add_angle(measure.body_b, factor, shares, constant);
      add_angle(measure.body_a, -factor, shares, constant);
      return true;
    case Measure::Kind::travel: {
      const int coordinate = travel_of_[static_cast<std::size_t>(measure.joint)];
      if (coordinate < 0) return false;
      shares[static_cast<std::size_t>(coordinate)] += factor;
      return true;
    }
    case Measure::Kind::sum:
      return std::all_of(measure.terms.begin(), measure.terms.end(), [&](const Measure::Term& term) {
        return term.profile == nullptr && add_measure(term.measure, factor * term.factor, shares, constant);
      });
    default:
      return false;
  }
}

std::optional<SumOfCoordinates> JointTree::linear(const Measure& measure) const {
  std::vector<double> shares(coordinates_.size(), 0.0);
  SumOfCoordinates out;
  if (!add_measure(measure, 1.0, shares, out.constant)) return std::nullopt;
  for (std::size_t c = 0; c < shares.size(); ++c) {
    if (shares[c] != 0.0) out.terms.emplace_back(static_cast<int>(c), shares[c]);
  }
  return out;
}

void CoordinateEffects::add_spring(double k, double at) {
  if (k == 0.0) return;
  free_value = stiffness == 0.0 ? at : (stiffness * free_value + k * at) / (stiffness + k);
  stiffness += k;
}

namespace {

// Gathers what acts on coordinates and lines, and refuses what no format of robots has.
class EffectReader {
 public:
  EffectReader(const JointTree& tree, const Scene& scene, const std::string& format)
      : tree_(tree), scene_(scene), format_(format) {
    out_.on_coordinates.resize(tree.coordinates().size());
  }

  TreeEffects effects() {
    refuse_loads();
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) add_joint(static_cast<int>(j));
    for (const Element& element : scene_.elements) add_element(element);
    for (const Stop& stop : scene_.stops) add_stop(stop);
    return std::move(out_);
  }

 private:
  [[noreturn]] void refuse(const std::string& family, const std::string& name, int line,
                           const std::string& message) const {
    fail_at(scene_.file, line, fmt::format("{} \"{}\"", family, name), fmt::format("{} has {}", format_, message));
  }

  void refuse_loads() const {
    for (const Drive& drive : scene_.drives) {
      refuse("drive", drive.name, drive.line, "no prescribed motion; leave it out of the scene");
    }
    for (const Blade& blade : scene_.blades) {
      refuse("blade", blade.name, blade.line, "no blades; leave it out of the scene");
    }
    for (const Force& force : scene_.forces) {
      refuse(force.to ? "distributed load" : "force", force.name, force.line, "no loads; leave it out of the scene");
    }
    for (const Torque& torque : scene_.torques) {
      refuse("torque", torque.name, torque.line, "no loads; leave it out of the scene");
    }
  }

  // A joint with constant friction acts on its measure, up to the bound.
  void add_joint(int index) {
    const Joint& joint = scene_.joints[static_cast<std::size_t>(index)];
    if (joint.keeps_length()) {
      LineEffects& bar = add_line("bar", joint.name, joint.line);
      bar.points = {joint.a, joint.b};
      bar.held = joint.length;
      return;
    }
    if (!joint.friction) return;
    const JointFriction& friction = *joint.friction;
    if (friction.coefficient > 0.0 && (joint.has_travel() || friction.radius > 0.0)) {
      refuse(std::string(joint.traits().key), joint.name, joint.line,
             "no friction that grows with the force in a joint; set its coefficient to 0");
    }
    const double bound = joint.has_travel() ? friction.force : friction.torque;
    if (bound == 0.0) return;
    const Measure on =
        joint.has_travel() ? Measure::travel_of(index) : Measure::angle_between(joint.a.body, joint.b.body);
    add_to(
        on, std::string(joint.traits().key), joint.name, joint.line,
        [&](CoordinateEffects& effects, double factor, double) { effects.friction += bound * std::abs(factor); },
        [&](LineEffects& effects) { effects.friction = bound; });
  }

  LineEffects& add_line(const std::string& family, const std::string& name, int line) {
    out_.on_lines.push_back({.item = fmt::format("{} \"{}\"", family, name), .name = name, .line = line});
    return out_.on_lines.back();
  }

  // An effect on one coordinate, with the factor and the constant of the measure, or on a line.
  template <class OnCoordinate, class OnLine>
  void add_to(const Measure& on, const std::string& family, const std::string& name, int line,
              OnCoordinate on_coordinate, OnLine on_line) {
    if (const std::optional<SumOfCoordinates> sum = tree_.linear(on)) {
      if (sum->terms.empty()) return;  // it cannot change
      if constexpr (!std::is_null_pointer_v<OnCoordinate>) {
        if (sum->terms.size() == 1) {
          const auto& [coordinate, factor] = sum->terms.front();
          on_coordinate(out_.on_coordinates[static_cast<std::size_t>(coordinate)], factor, sum->constant);
          return;
        }
      }
      LineEffects& effects = add_line(family, name, line);
      effects.sum = *sum;
      on_line(effects);
      return;
    }
    std::vector<PointRef> points = points_of(on);
    if (points.empty()) {
      refuse(family, name, line,
             "no such measure; expected an angle, a travel, a distance of points, or a sum of angles and travels");
    }
    LineEffects& effects = add_line(family, name, line);
    effects.points = std::move(points);
    on_line(effects);
  }

  static std::vector<PointRef> points_of(const Measure& measure) {
    if (measure.kind == Measure::Kind::distance) return {measure.a, measure.b};
    std::vector<PointRef> out;
    if (measure.kind != Measure::Kind::rope) return out;
    for (const RopeContact& contact : measure.contacts) {
      if (contact.radius != 0.0 || contact.friction) return {};
      out.push_back(contact.at);
    }
    return out;
  }

  void add_element(const Element& element) {
    const std::string family = element.family();
    const auto add = [&](auto on_coordinate, auto on_line) {
      add_to(element.on, family, element.name, element.line, on_coordinate, on_line);
    };
    const auto add_spring = [&](double k, double free) {
      add([&](CoordinateEffects& effects, double factor,
              double constant) { effects.add_spring(k * factor * factor, (free - constant) / factor); },
          [&](LineEffects& effects) {
            effects.stiffness = k;
            effects.slack_from = effects.slack_to = free - effects.sum.constant;
          });
    };
    if (const auto* spring = std::get_if<LinearSpring>(&element.law)) {
      if (spring->acts == SpringActs::both) return add_spring(spring->stiffness, spring->free_length);
      add(nullptr, [&](LineEffects& effects) {
        constexpr double far = 1e10;
        const bool pulls = spring->acts == SpringActs::tension;
        const double free = spring->free_length - effects.sum.constant;
        effects.stiffness = spring->stiffness;
        effects.slack_from = pulls ? (effects.points.empty() ? -far : 0.0) : free;
        effects.slack_to = pulls ? free : far;
      });
    } else if (const auto* preloaded = std::get_if<PreloadedSpring>(&element.law);
               preloaded != nullptr && preloaded->stiffness > 0.0) {
      add_spring(preloaded->stiffness, preloaded->length - preloaded->preload / preloaded->stiffness);
    } else if (const auto* damper = std::get_if<Damper>(&element.law);
               damper != nullptr && damper->acts == SpringActs::both) {
      add([&](CoordinateEffects& effects, double factor,
              double) { effects.damping += damper->coefficient * factor * factor; },
          [&](LineEffects& effects) { effects.damping = damper->coefficient; });
    } else if (const auto* friction = std::get_if<DryFriction>(&element.law);
               friction != nullptr && friction->sticks() && friction->falls == DryFriction::Falls::not_at_all) {
      add([&](CoordinateEffects& effects, double factor,
              double) { effects.friction += friction->force * std::abs(factor); },
          [&](LineEffects& effects) { effects.friction = friction->force; });
    } else if (friction != nullptr) {
      refuse(family, element.name, element.line,
             friction->sticks() ? "friction of one size only; leave out its static force"
                                : "friction that sticks only; set its width to 0");
    } else {
      refuse(family, element.name, element.line,
             "no such law; expected a linear spring, a damper that acts both ways or constant friction");
    }
  }

  void add_stop(const Stop& stop) {
    const auto hold = [&](LineEffects& effects) { effects.held = stop.min - effects.sum.constant; };
    if (stop.holds()) return add_to(stop.on, stop.family(), stop.name, stop.line, nullptr, hold);
    add_to(
        stop.on, stop.family(), stop.name, stop.line,
        [&](CoordinateEffects& effects, double factor, double constant) {
          const double a = (stop.min - constant) / factor, b = (stop.max - constant) / factor;
          effects.lower = std::max(effects.lower, std::min(a, b));
          effects.upper = std::min(effects.upper, std::max(a, b));
        },
        [&](LineEffects& effects) {
          effects.lower = stop.min - effects.sum.constant;
          effects.upper = stop.max - effects.sum.constant;
        });
  }

  const JointTree& tree_;
  const Scene& scene_;
  const std::string& format_;
  TreeEffects out_;
};

}  // namespace

TreeEffects effects_on(const JointTree& tree, const Scene& scene, const std::string& format) {
  return EffectReader(tree, scene, format).effects();
}

std::string shortest(double value) { return fmt::format("{}", value + 0.0); }

std::string in_space(Vec2 v) { return fmt::format("{} 0 {}", shortest(v.x), shortest(v.y)); }

}  // namespace poise
