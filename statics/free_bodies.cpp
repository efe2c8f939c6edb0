#include "statics/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/linear_algebra.hpp"
#include "statics/body_measures.hpp"
#include "statics/sparse_least_squares.hpp"

namespace poise {
namespace {

// Number of unknown reactions up to which a dense decomposition, which gives the minimum norm, is used.
constexpr int dense_limit = 250;

// A unit reaction: force and moment on body b at a point, the opposite on body a.
struct Unknown {
  int item;  // index into `items`
  int body_a, body_b;
  Vec2 at;
  Vec2 force;
  double moment;
  std::vector<Unknown> with;  // further terms of the same unknown, of a sum
};

// The joint, stop or drive that a set of unknowns belongs to.
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
    for (const Element& e : scene_.elements) {
      const double force = force_at_rest(e.law, value_of(scene_, e.on, poses_)).value;
      element_force_.push_back(0.0);
      if (force == 0.0) continue;
      for (const UnitEffort& effort : unit_efforts(scene_, e.on, poses_)) {
        if (effort.force == Vec2{} && effort.moment == 0.0) continue;
        element_force_.back() = force;
        push(effort.body_a, effort.a, force * effort.force, force * effort.moment);
        push(effort.body_b, effort.b, -force * effort.force, -force * effort.moment);
      }
    }
  }

  void add_joints() {
    items_.reserve(scene_.joints.size());
    unknowns_.reserve(2 * scene_.joints.size());
    for (const Joint& joint : scene_.joints) {
      const Vec2 a = world(joint.a);
      const Vec2 b = world(joint.b);
      const Vec2 axis = joint.direction() * unit(poses_[joint.a.body].angle);
      Item& item = items_.emplace_back();
      item.reaction.name = joint.name;
      item.reaction.kind = joint.traits().key;
      item.reaction.at = b - poses_[0].origin;
      const auto act = [&](Vec2 force, double moment) {
        unknowns_.push_back({static_cast<int>(items_.size()) - 1, joint.a.body, joint.b.body, b, force, moment, {}});
      };
      if (joint.keeps_length()) {
        const double r = norm(b - a);
        item.axis = r > 0 ? 1 / r * (b - a) : Vec2{1, 0};
        act(item.axis, 0);
      } else if (joint.has_travel()) {
        act(quarter_turn(axis), 0);
      } else {
        act({1, 0}, 0);
        act({0, 1}, 0);
      }
      if (joint.keeps_angle()) act({}, size_);
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
    add_measure(number, stop.on);
  }

  void add_drive(const Drive& drive) {
    Item item;
    item.reaction.name = drive.name;
    item.reaction.kind = "drive";
    items_.push_back(item);
    add_measure(static_cast<int>(items_.size()) - 1, drive.on);
  }

  // Least-squares reactions, of minimum norm if they are not unique (dense sizes). Returns the stop whose reaction has
  // the wrong sign by most, or -1.
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
      // One step of iterative refinement: the balance is checked to 1e-9 of the largest force.
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
    out.element_force = element_force_;
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
      // At a maximum the stop's effort may only reduce the measure, at a minimum only increase it.
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
  // The unknown effort on a measure, positive if it tends to increase it. The terms of a sum act together, each with
  // its factor.
  void add_measure(int number, const Measure& measure) {
    Item& item = items_[number];
    const std::vector<UnitEffort> efforts = unit_efforts(scene_, measure, poses_);
    for (const UnitEffort& effort : efforts) {
      Unknown unknown{number, effort.body_a, effort.body_b, effort.b, effort.force, size_ * effort.moment, {}};
      // If its points coincide a distance is taken along x.
      if (effort.force == Vec2{} && effort.moment == 0.0) unknown.force = {1.0, 0.0};
      if (!measure.is_angle()) item.axis = unknown.force;
      item.reaction.at = effort.b - poses_[0].origin;
      if (&effort == &efforts.front())
        unknowns_.push_back(unknown);
      else
        unknowns_.back().with.push_back(unknown);
    }
  }

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

  // Coefficients of all unknowns in the equilibrium equations of all moving bodies.
  Eigen::SparseMatrix<double> equations() const {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(4 * unknowns_.size());
    for (std::size_t u = 0; u < unknowns_.size(); ++u) {
      add_entries(static_cast<int>(u), unknowns_[u], entries);
      for (const Unknown& term : unknowns_[u].with) add_entries(static_cast<int>(u), term, entries);
    }
    Eigen::SparseMatrix<double> a(static_cast<Eigen::Index>(load_.size()), static_cast<Eigen::Index>(unknowns_.size()));
    a.setFromTriplets(entries.begin(), entries.end());
    return a;
  }

  void add_entries(int column, const Unknown& k, std::vector<Eigen::Triplet<double>>& entries) const {
    for (const double sign : {-1.0, 1.0}) {
      const int body = sign < 0.0 ? k.body_a : k.body_b;
      if (body == 0) continue;
      const int row = 3 * (body - 1);
      if (k.force.x != 0) entries.emplace_back(row, column, sign * k.force.x);
      if (k.force.y != 0) entries.emplace_back(row + 1, column, sign * k.force.y);
      const double turning = (cross(k.at - poses_[body].origin, k.force) + k.moment) / size_;
      if (turning != 0) entries.emplace_back(row + 2, column, sign * turning);
    }
  }

  const Scene& scene_;
  const std::vector<BodyPose<double>>& poses_;
  double size_;
  std::vector<double> load_;  // per moving body: force x, y, moment about its origin / size
  double largest_load_ = 0.0;
  double largest_applied_ = 0.0;
  std::vector<double> element_force_;
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
