#include "statics/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/linear_algebra.hpp"
#include "statics/sparse_least_squares.hpp"

namespace poise {
namespace {

// Unknown reactions up to which a dense decomposition, which gives the minimum norm, is used.
constexpr int dense_limit = 250;

// A unit reaction: force and moment on body b at a point, the opposite on body a.
struct Unknown {
  int item;  // index into `items`
  int body_a, body_b;
  Vec2 at;
  Vec2 force;
  double moment;
};

// What a set of unknowns belongs to.
struct Item {
  Reaction reaction;
  int stop = -1;
  int side = 0;
  Vec2 axis{};
};

class Statics {
 public:
  Statics(const Scene& scene, const std::vector<BodyPose<double>>& poses, double size)
      : scene_(scene), poses_(poses), size_(size), load_(3 * (scene.bodies.size() - 1), 0.0) {}

  void apply_loads(const std::vector<BodyLoad>& additions) {
    for (std::size_t i = 1; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      if (body.mass != 0) push(static_cast<int>(i), poses_[i].world(body.center), body.mass * scene_.gravity, 0.0);
    }
    for (const Force& f : scene_.forces) {
      const Vec2 force = f.follows < 0 ? f.vector : f.vector * unit(poses_[f.follows].angle);
      push(f.at.body, world(f.at), force, 0.0);
    }
    for (const Torque& t : scene_.torques) push(t.body, poses_[t.body].origin, {}, t.value);
    for (const BodyLoad& load : additions) push(load.body, load.at, load.force, load.moment);
    largest_applied_ = largest_load_;
    for (const Spring& s : scene_.springs) {
      const Vec2 a = world(s.a);
      const Vec2 b = world(s.b);
      const double r = norm(b - a);
      const double tension = s.stiffness * (r - s.free_length);
      const bool slack =
          (s.acts == Spring::Acts::tension && tension < 0) || (s.acts == Spring::Acts::compression && tension > 0);
      spring_tension_.push_back(r == 0 || slack ? 0.0 : tension);
      if (r == 0 || slack) continue;
      const Vec2 pull = tension / r * (b - a);
      push(s.a.body, a, pull, 0.0);
      push(s.b.body, b, -pull, 0.0);
    }
    for (const TorsionSpring& s : scene_.torsion_springs) {
      const double torque = s.stiffness * (poses_[s.b].angle - poses_[s.a].angle - s.free_angle);
      spring_moment_.push_back(-torque);
      push(s.a, poses_[s.a].origin, {}, torque);
      push(s.b, poses_[s.b].origin, {}, -torque);
    }
  }

  void add_joints() {
    items_.reserve(scene_.joints.size());
    unknowns_.reserve(2 * scene_.joints.size());
    for (const Joint& joint : scene_.joints) {
      const Vec2 a = world(joint.a);
      const Vec2 b = world(joint.b);
      const Vec2 axis = joint.axis * unit(poses_[joint.a.body].angle);
      const auto item = [&](const char* kind) {
        Reaction& reaction = items_.emplace_back().reaction;
        reaction.name = joint.name;
        reaction.kind = kind;
        reaction.at = b;
      };
      const auto act = [&](Vec2 force, double moment) {
        unknowns_.push_back({static_cast<int>(items_.size()) - 1, joint.a.body, joint.b.body, b, force, moment});
      };
      switch (joint.kind) {
        case Joint::Kind::pin:
          item("pin");
          act({1, 0}, 0);
          act({0, 1}, 0);
          break;
        case Joint::Kind::weld:
          item("weld");
          act({1, 0}, 0);
          act({0, 1}, 0);
          act({}, size_);
          break;
        case Joint::Kind::slide:
          item("slide");
          act(quarter_turn(axis), 0);
          act({}, size_);
          break;
        case Joint::Kind::pin_in_slot:
          item("pin_in_slot");
          act(quarter_turn(axis), 0);
          break;
        case Joint::Kind::bar: {
          item("bar");
          const double r = norm(b - a);
          items_.back().axis = r > 0 ? 1 / r * (b - a) : Vec2{1, 0};
          act(items_.back().axis, 0);
          break;
        }
      }
    }
  }

  void add_stop(int index, int side) {
    const Stop& stop = scene_.stops[index];
    Item item;
    item.reaction.name = stop.name;
    item.reaction.kind = "stop";
    item.stop = index;
    item.side = side;
    items_.push_back(item);
    const int number = static_cast<int>(items_.size()) - 1;
    Reaction& reaction = items_.back().reaction;
    if (stop.kind == Stop::Kind::angle) {
      reaction.at = poses_[stop.body_b].origin;
      unknowns_.push_back({number, stop.body_a, stop.body_b, reaction.at, {}, size_});
    } else if (stop.kind == Stop::Kind::distance) {
      const Vec2 along = world(stop.b) - world(stop.a);
      reaction.at = world(stop.b);
      items_.back().axis = norm(along) > 0 ? 1 / norm(along) * along : Vec2{1, 0};
      unknowns_.push_back({number, stop.a.body, stop.b.body, reaction.at, items_.back().axis, 0});
    } else {
      const Joint& joint = scene_.joints[stop.joint];
      reaction.at = world(joint.b);
      items_.back().axis = joint.axis * unit(poses_[joint.a.body].angle);
      unknowns_.push_back({number, joint.a.body, joint.b.body, reaction.at, items_.back().axis, 0});
    }
  }

  void add_drive(const Drive& drive) {
    Item item;
    item.reaction.name = drive.name;
    item.reaction.kind = "drive";
    const int number = static_cast<int>(items_.size());
    if (drive.kind == Drive::Kind::angle) {
      item.reaction.at = poses_[drive.body_b].origin;
      unknowns_.push_back({number, drive.body_a, drive.body_b, item.reaction.at, {}, size_});
    } else {
      const Joint& joint = scene_.joints[drive.joint];
      item.reaction.at = world(joint.b);
      item.axis = joint.axis * unit(poses_[joint.a.body].angle);
      unknowns_.push_back({number, joint.a.body, joint.b.body, item.reaction.at, item.axis, 0});
    }
    items_.push_back(item);
  }

  // Least-squares reactions, minimum norm where they are not unique (dense sizes). Returns the stop that pulls
  // hardest, or -1.
  int solve(FreeBodies& out) {
    const int rows = static_cast<int>(load_.size());
    const int count = static_cast<int>(unknowns_.size());
    const Eigen::SparseMatrix<double> a = equations();
    const Eigen::Map<const Eigen::VectorXd> load(load_.data(), rows);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(count);
    std::vector<bool> free(count, false);
    if (count > 0 && count <= dense_limit) {
      const solvers::LeastSquares<double> reactions(Eigen::MatrixXd(a), solvers::known_to::solution);
      f = reactions.solve(-load);
      // One step of refinement: the balance is judged to 1e-9 of the largest force.
      f += reactions.solve(-load - a * f);
      out.redundancy = count - static_cast<int>(reactions.rank());
      if (out.redundancy > 0) {
        const Eigen::MatrixXd null = reactions.null_space();
        for (int u = 0; u < count; ++u) free[u] = null.row(u).norm() > 1e-8;
      }
    } else if (count > 0) {
      SparseLeastSquares factored(a);
      f = factored.solve(-load);
      const NullSpace self_stress = factored.null_space();
      free = self_stress.touches;
      out.redundancy = self_stress.dimension;
    }
    const Eigen::VectorXd left = load + a * f;
    Eigen::Index worst = 0;
    out.imbalance = rows > 0 ? left.cwiseAbs().maxCoeff(&worst) : 0.0;
    out.worst_body = static_cast<int>(worst) / 3 + 1;
    out.is_moment = worst % 3 == 2;
    out.largest_load = largest_load_;
    out.largest_applied = largest_applied_;
    out.spring_tension = spring_tension_;
    out.spring_moment = spring_moment_;
    out.largest_force = std::max(largest_load_, count > 0 ? f.cwiseAbs().maxCoeff() : 0.0);
    int pulling = -1;
    double hardest = 1e-9 * out.largest_force;
    for (Item& item : items_) {
      item.reaction.force = {};
      item.reaction.moment = item.reaction.axial = 0.0;
      item.reaction.determined = true;
    }
    for (int u = 0; u < count; ++u) {
      Item& item = items_[unknowns_[u].item];
      item.reaction.force += f[u] * unknowns_[u].force;
      item.reaction.moment += f[u] * unknowns_[u].moment;
      if (free[u]) item.reaction.determined = false;
      if (item.reaction.kind == "bar" || item.axis != Vec2{}) item.reaction.axial = -f[u];
      // At a maximum the stop may only reduce what it limits, at a minimum only increase it.
      if (item.stop >= 0 && std::abs(item.side) == 1 && item.side * f[u] > hardest) {
        hardest = item.side * f[u];
        pulling = item.stop;
      }
    }
    out.reactions.clear();
    out.pressing.clear();
    out.reactions.reserve(items_.size());
    for (Item& item : items_) {
      const double pressure = std::max(norm(item.reaction.force), std::abs(item.reaction.moment) / size_);
      if (item.stop >= 0 && pressure > 1e-10 * out.largest_force) out.pressing.push_back(item.stop);
      out.reactions.push_back(std::move(item.reaction));
    }
    return pulling;
  }

 private:
  Vec2 world(PointRef p) const { return poses_[p.body].world(scene_.local(p)); }

  void push(int body, Vec2 at, Vec2 force, double moment) {
    if (body == 0) return;
    double* row = &load_[3 * (body - 1)];
    row[0] += force.x;
    row[1] += force.y;
    const double turning = (cross(at - poses_[body].origin, force) + moment) / size_;
    row[2] += turning;
    largest_load_ = std::max({largest_load_, norm(force), std::abs(turning)});
  }

  // What every unknown does to every moving body.
  Eigen::SparseMatrix<double> equations() const {
    const auto count = static_cast<Eigen::Index>(unknowns_.size());
    Eigen::SparseMatrix<double> a(static_cast<Eigen::Index>(load_.size()), count);
    a.reserve(4 * count);
    for (Eigen::Index u = 0; u < count; ++u) {
      const Unknown& k = unknowns_[u];
      a.startVec(u);
      const bool in_order = k.body_a < k.body_b;
      add_to_body(a, u, in_order ? k.body_a : k.body_b, k, in_order ? -1.0 : 1.0);
      add_to_body(a, u, in_order ? k.body_b : k.body_a, k, in_order ? 1.0 : -1.0);
    }
    a.finalize();
    return a;
  }

  void add_to_body(Eigen::SparseMatrix<double>& a, Eigen::Index column, int body, const Unknown& k, double sign) const {
    if (body == 0) return;
    const int row = 3 * (body - 1);
    if (k.force.x != 0) a.insertBack(row, column) = sign * k.force.x;
    if (k.force.y != 0) a.insertBack(row + 1, column) = sign * k.force.y;
    const double turning = (cross(k.at - poses_[body].origin, k.force) + k.moment) / size_;
    if (turning != 0) a.insertBack(row + 2, column) = sign * turning;
  }

  const Scene& scene_;
  const std::vector<BodyPose<double>>& poses_;
  double size_;
  std::vector<double> load_;  // per moving body: force x, y, moment about its origin / size
  double largest_load_ = 0.0;
  double largest_applied_ = 0.0;
  std::vector<double> spring_tension_, spring_moment_;
  std::vector<Unknown> unknowns_;
  std::vector<Item> items_;
};

}  // namespace

FreeBodies balance(const Scene& scene, const std::vector<BodyPose<double>>& poses, const std::vector<int>& touching,
                   double size, const Additions& additions) {
  std::vector<int> sides = touching;
  for (;;) {
    FreeBodies out;
    Statics statics(scene, poses, size);
    statics.apply_loads(additions.loads);
    statics.add_joints();
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (sides[i] != 0) statics.add_stop(static_cast<int>(i), sides[i]);
    }
    for (const Drive& drive : additions.drives) statics.add_drive(drive);
    const int pulling = statics.solve(out);
    if (pulling < 0) return out;
    sides[pulling] = 0;
  }
}

}  // namespace poise
